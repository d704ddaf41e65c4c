//! A boundary of one's own that moves: a floor that is shaken up and down.
//!
//! cargo run --release --example own_shaken_floor

use std::f64::consts::TAU;

use grainfall::collide::Restitution;
use grainfall::dynamics::UniformGravity;
use grainfall::engine::{Limits, Simulation};
use grainfall::model::{Boundary, Model, Occurrence, Parts, Period, Shape, Wall};
use grainfall::policy::Never;
use grainfall::predict::Polynomial;
use grainfall::{Particle, SetupError, Time, Vector, along};

/// Period of the world sideways, in d.
const WIDTH: f64 = 11.0;

/// A flat floor that moves as A sin(2π t/T).
#[derive(Clone, Copy, Debug)]
struct Shaker {
    /// A, in d.
    amplitude: f64,
    /// T, in √(d/g).
    period: f64,
    /// Coefficient of restitution.
    restitution: f64,
}

impl Shaker {
    /// ω = 2π/T, in √(g/d).
    fn rate(&self) -> f64 {
        TAU / self.period
    }

    /// ωt, counted from the start of the present period: late in a run, too, it is
    /// known to the last digit.
    fn phase(&self, time: Time) -> f64 {
        let begun = libm::floor(time.units() / self.period) * self.period;
        self.rate() * (time - Time::from_units(begun))
    }
}

impl<const D: usize> Wall<D> for Shaker {
    fn distance(&self, position: &Vector<D>, time: Time) -> f64 {
        position[D - 1] - self.amplitude * libm::sin(self.phase(time))
    }

    fn normal(&self, _position: &Vector<D>, _time: Time) -> Vector<D> {
        along(D - 1, 1.0)
    }

    fn velocity(&self, _position: &Vector<D>, time: Time) -> Vector<D> {
        let most = self.amplitude * self.rate();
        along(D - 1, most * libm::cos(self.phase(time)))
    }

    fn restitution(&self) -> f64 {
        self.restitution
    }

    fn shape(&self) -> Shape<D> {
        let speed = self.amplitude * self.rate();
        Shape::General {
            curvature: 0.0,
            speed,
            acceleration: speed * self.rate(),
        }
    }
}

/// Nothing but the floor.
#[derive(Clone, Copy, Debug)]
struct Shaken([Shaker; 1]);

impl<const D: usize> Boundary<D> for Shaken {
    type Wall = Shaker;

    fn period(&self, axis: usize) -> Option<Period> {
        // Sideways the world closes on itself.
        (axis + 1 < D).then_some(Period {
            origin: -0.5 * WIDTH,
            length: WIDTH,
        })
    }

    fn walls(&self) -> &[Shaker] {
        &self.0
    }

    fn validate(&self) -> Result<(), SetupError> {
        let Shaker { period, .. } = self.0[0];
        if period > 0.0 && period.is_finite() {
            return Ok(());
        }
        Err(SetupError::Parameter {
            field: "period",
            value: period,
            allowed: "a positive number is allowed",
        })
    }
}

/// Grains over a shaken floor. Nobody sleeps: a floor that moves does not wake
/// those that lie on it.
fn shaken<const D: usize>(
    shaker: Shaker,
    rule: Restitution,
    grains: Vec<Particle<D>>,
) -> Result<Simulation<impl Model<D>, D>, SetupError> {
    let model = Parts {
        dynamics: UniformGravity::<D>::down(),
        predictor: Polynomial,
        collision_rule: rule,
        state_policy: Never,
        boundary: Shaken([shaker]),
    };
    Simulation::new(model, grains)
}

/// When a grain that is in step with the floor hits it for the first time: the phase
/// over ω, at which the floor moves up at w = (g T/2) (1 − ε)/(1 + ε).
fn in_step(shaker: Shaker) -> f64 {
    let speed = 0.5 * shaker.period * (1.0 - shaker.restitution) / (1.0 + shaker.restitution);
    libm::acos(speed / (shaker.amplitude * shaker.rate())) / shaker.rate()
}

/// A grain that hits the floor first at `first`, with −g T/2, and how much after
/// `first`, `first` + T, `first` + 2 T … it does so; in √(d/g).
fn out_of_step<const D: usize>(
    shaker: Shaker,
    first: f64,
    impacts: u64,
) -> Result<Vec<f64>, SetupError> {
    // Followed backwards to time 0.
    let arrives = -0.5 * shaker.period;
    let mut place = Vector::zeros();
    place[D - 1] = 0.5 + shaker.amplitude * libm::sin(shaker.rate() * first)
        - arrives * first
        - 0.5 * first * first;
    let grain = Particle::new(place, along(D - 1, arrives + first));
    let mut ball = shaken(shaker, Restitution::constant(1.0), vec![grain])?;
    let mut late = Vec::new();
    let mut due = Time::from_units(first);
    ball.run(&Limits::events(impacts), &mut |event: &Occurrence<D>| {
        late.push(event.time - due);
        due = due + shaker.period;
    });
    Ok(late)
}

/// A bed of grains on the floor: the mean height of their centres, in d, from 10 to
/// 20 periods on, and the work that the floor has done, in mgd a period.
fn bed<const D: usize>(shaker: Shaker, count: usize) -> Result<(f64, f64), SetupError> {
    let place = |grain: usize| {
        let mut site = grain;
        let mut place = Vector::zeros();
        for axis in 0..D - 1 {
            // Nine side by side, not quite in line.
            place[axis] = 1.2 * (site % 9) as f64 + 0.02 * (grain % (5 + axis)) as f64;
            site /= 9;
        }
        place[D - 1] = 1.0 + 1.2 * site as f64;
        place
    };
    let grains = (0..count)
        .map(|grain| Particle::new(place(grain), Vector::zeros()))
        .collect();
    let rule = Restitution {
        elastic_speed: 1.0e-2,
        ..Restitution::constant(0.9)
    };
    let mut bed = shaken::<D>(shaker, rule, grains)?;
    let (mut heights, mut samples) = (0.0, 0);
    for sample in 0..=200 {
        let time = Time::from_units(0.1 * f64::from(sample) * shaker.period);
        bed.run(&Limits::until(time), &mut ());
        if sample >= 100 {
            let sum: f64 = bed
                .snapshot()
                .iter()
                .map(|grain| grain.position[D - 1])
                .sum();
            heights += sum / count as f64;
            samples += 1;
        }
    }
    let work = bed.energy_ledger().moving / 20.0;
    Ok((heights / f64::from(samples), work))
}

fn main() -> Result<(), SetupError> {
    let shaker = Shaker {
        amplitude: 0.1,
        period: 2.0,
        restitution: 0.6,
    };
    let first = in_step(shaker);
    println!("one grain, in step with the floor or 0.01 √(d/g) early: out of step by");
    let exact = out_of_step::<2>(shaker, first, 100)?;
    let early = out_of_step::<3>(shaker, first - 0.01, 100)?;
    for impact in [1, 2, 5, 10, 20, 50, 100] {
        println!(
            "  impact {impact:3}: {:8.1e} (2D), {:8.1e} (3D)",
            exact[impact - 1],
            early[impact - 1] - 0.01
        );
    }
    println!("a bed of grains, ε = 0.9: mean height, work of the floor a period");
    for amplitude in [0.15, 0.2, 0.3] {
        let shaker = Shaker {
            amplitude,
            restitution: 0.9,
            ..shaker
        };
        let (plane, work) = bed::<2>(shaker, 50)?;
        let (space, more) = bed::<3>(shaker, 200)?;
        let peak = amplitude * shaker.rate() * shaker.rate();
        println!(
            "  A ω² = {peak:.2} g: {plane:.2} d, {work:.1} mgd (2D); {space:.2} d, {more:.1} mgd (3D)"
        );
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    const SHAKER: Shaker = Shaker {
        amplitude: 0.1,
        period: 2.0,
        restitution: 0.6,
    };

    /// The orbit of period T is an exact one, and it attracts, for A ω² sin φ = 0.6 g is
    /// less than 2 (1 + ε²)/(1 + ε)² g: what rounding does to it dies out.
    fn stays_in_step<const D: usize>() {
        let first = in_step(SHAKER);
        for (impact, late) in out_of_step::<D>(SHAKER, first, 300)
            .unwrap()
            .iter()
            .enumerate()
        {
            assert!(late.abs() < 1.0e-13, "{impact}: {late:e}");
        }
        let late = out_of_step::<D>(SHAKER, first - 0.01, 300).unwrap();
        assert!((late[299] - 0.01).abs() < 1.0e-12, "{:e}", late[299]);
    }

    #[test]
    fn a_grain_stays_in_step_with_the_floor() {
        stays_in_step::<2>();
        stays_in_step::<3>();
    }

    #[test]
    fn the_work_of_the_floor_explains_the_energy() {
        let mut grains = Vec::new();
        for site in 0..8 {
            let place = Vector::<2>::new(1.2 * f64::from(site), 1.0 + 0.1 * f64::from(site % 3));
            grains.push(Particle::new(place, Vector::zeros()));
        }
        // Thrown up by more than its weight; the cut-off lets nobody creep.
        let shaker = Shaker {
            amplitude: 0.2,
            ..SHAKER
        };
        let rule = Restitution {
            elastic_speed: 1.0e-2,
            ..Restitution::constant(0.9)
        };
        let mut bed = shaken::<2>(shaker, rule, grains).unwrap();
        bed.run(&Limits::until(Time::from_units(20.0)), &mut ());
        let ledger = bed.energy_ledger();
        assert!(ledger.moving > 1.0 && ledger.wall < -0.5, "{ledger:?}");
        assert!(ledger.relative_error().abs() < 1.0e-12, "{ledger:?}");
        assert!(bed.audit().missed.is_empty());
        assert!(bed.max_overlap() < 1.0e-12);
    }

    #[test]
    fn a_period_of_zero_is_refused() {
        let still = Shaker {
            period: 0.0,
            ..SHAKER
        };
        let refused = shaken::<2>(still, Restitution::elastic(), vec![]);
        let said = refused.err().map(|error| error.to_string());
        assert_eq!(
            said.as_deref(),
            Some("period is 0; a positive number is allowed")
        );
    }
}
