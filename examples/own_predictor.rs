//! A predictor of one's own: the quadratic formula of the textbooks, for grains
//! that fly straight as seen from each other. It shows what a predictor has to be
//! careful about, by not being so.
//!
//! cargo run --release --example own_predictor

use std::hint::black_box;
use std::time::Instant;

use grainfall::boundary::{Cuboid, Side};
use grainfall::collide::Restitution;
use grainfall::dynamics::{ForceFree, Straight};
use grainfall::engine::{Limits, Simulation};
use grainfall::model::{Approach, Encounter, Flight, Forecast, Parts, Predictor, Wall};
use grainfall::policy::Never;
use grainfall::predict::Polynomial;
use grainfall::setup::{Gas, seeded};
use grainfall::{SetupError, Vector};
use rand::RngExt;

/// Contacts of straight flights, from the quadratic formula in plain numbers.
#[derive(Clone, Copy, Debug, Default)]
struct Textbook;

impl<const D: usize> Predictor<D, Straight<D>> for Textbook {
    fn pair(&self, approach: &Approach<D, Straight<D>>) -> Forecast {
        let (first, second) = (approach.first, approach.second);
        let apart = second.position + approach.shift - first.position;
        let velocity = second.velocity - first.velocity;
        let closing = apart.dot(&velocity);
        if closing >= 0.0 {
            return Forecast::Never;
        }
        let squared = velocity.norm_squared();
        let outside = apart.norm_squared() - approach.distance * approach.distance;
        let discriminant = closing * closing - squared * outside;
        if discriminant < 0.0 {
            return Forecast::Never;
        }
        let time = (-closing - discriminant.sqrt()) / squared;
        if time < 0.0 {
            return Forecast::Never;
        }
        Forecast::Contact(time)
    }

    fn wall<W: Wall<D>>(&self, encounter: &Encounter<'_, D, Straight<D>, W>) -> Forecast {
        // One part of a predictor may be another's.
        Polynomial.wall(encounter)
    }
}

/// Two grains, the second coming along the first axis.
fn approach<const D: usize>(place: Vector<D>, velocity: Vector<D>) -> Approach<D, Straight<D>> {
    Approach {
        first: Straight {
            position: Vector::zeros(),
            velocity: Vector::zeros(),
        },
        second: Straight {
            position: place,
            velocity,
        },
        shift: Vector::zeros(),
        distance: 1.0,
        growth: 0.0,
        touching: false,
        horizon: f64::INFINITY,
    }
}

/// What two predictors say of the same pairs.
#[derive(Clone, Copy, Debug, Default)]
struct Tally {
    /// Contacts that the built-in one finds.
    contacts: u32,
    /// Those of them that the textbook's does not.
    missed: u32,
    /// Contacts that only the textbook's finds.
    invented: u32,
    /// The deepest the grains overlap at the time that each says, in d.
    overlap: [f64; 2],
}

/// How deep two grains overlap, in d, `after` the start: from the smallest of the
/// terms, so that it is known better than the time.
fn overlap<const D: usize>(approach: &Approach<D, Straight<D>>, after: f64) -> f64 {
    let apart = approach.second.position(after) - approach.first.position(after);
    1.0 - apart.norm()
}

/// Pairs of a kind, by the thousand.
fn compare<const D: usize>(count: u32, kind: impl Fn(&mut Draw) -> [Vector<D>; 2]) -> Tally {
    let mut draw = Draw(seeded(1));
    let mut tally = Tally::default();
    for _ in 0..count {
        let [place, velocity] = kind(&mut draw);
        let pair = approach(place, velocity);
        match (Polynomial.pair(&pair), Textbook.pair(&pair)) {
            (Forecast::Contact(time), plain) => {
                tally.contacts += 1;
                tally.overlap[0] = tally.overlap[0].max(overlap(&pair, time));
                match plain {
                    Forecast::Contact(plain) => {
                        tally.overlap[1] = tally.overlap[1].max(overlap(&pair, plain));
                    }
                    _ => tally.missed += 1,
                }
            }
            (_, Forecast::Contact(_)) => tally.invented += 1,
            _ => {}
        }
    }
    tally
}

/// Random numbers.
struct Draw(rand_chacha::ChaCha8Rng);

impl Draw {
    fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.0.random::<f64>()
    }

    fn vector<const D: usize>(&mut self, size: f64) -> Vector<D> {
        Vector::from_fn(|_, _| self.between(-size, size))
    }

    fn direction<const D: usize>(&mut self) -> Vector<D> {
        loop {
            let vector: Vector<D> = self.vector(1.0);
            if vector.norm() > 0.1 {
                return vector.normalize();
            }
        }
    }
}

/// As neighbours in a gas: a gap up to 2 d, and any velocity.
fn neighbours<const D: usize>(draw: &mut Draw) -> [Vector<D>; 2] {
    let away = draw.between(1.0, 3.0);
    [draw.direction() * away, draw.vector(1.0)]
}

/// Touching, to the last digit, and closing: as after a collision with a third.
fn touching<const D: usize>(draw: &mut Draw) -> [Vector<D>; 2] {
    let place: Vector<D> = draw.direction();
    let velocity: Vector<D> = draw.vector(1.0);
    let closing = velocity.dot(&place);
    [place, if closing < 0.0 { velocity } else { -velocity }]
}

/// Grazing, 10⁻¹⁷ … 10⁻⁸ d deep or as much apart.
fn grazing<const D: usize>(draw: &mut Draw) -> [Vector<D>; 2] {
    let ahead: Vector<D> = draw.direction();
    let aside: Vector<D> = draw.direction();
    let aside = (aside - ahead * ahead.dot(&aside)).normalize();
    let depth = libm::exp10(draw.between(-17.0, -8.0)) * draw.between(-1.0, 1.0).signum();
    let away = draw.between(1.5, 3.0);
    [ahead * away + aside * (1.0 - depth), -ahead]
}

/// From far away, fast.
fn far<const D: usize>(draw: &mut Draw) -> [Vector<D>; 2] {
    let away: Vector<D> = draw.direction() * draw.between(1.0e4, 1.0e5);
    let aim: Vector<D> = draw.vector(0.5);
    [away, (aim - away) * 1.0e-2]
}

/// A gas of 1000 grains under a predictor: seconds that 200 000 collisions take, and
/// the deepest overlap, in d.
fn gas<P, const D: usize>(predictor: P, restitution: f64) -> Result<(f64, f64), SetupError>
where
    P: Predictor<D, Straight<D>>,
{
    let (grains, lengths) = Gas::<D> {
        packing_fraction: 0.45,
        ..Gas::default()
    }
    .grains(&mut seeded(1))?;
    let model = Parts {
        dynamics: ForceFree,
        predictor,
        collision_rule: Restitution {
            elastic_speed: 1.0e-3,
            ..Restitution::constant(restitution)
        },
        state_policy: Never,
        boundary: Cuboid::new(std::array::from_fn(|axis| Side::periodic(lengths[axis])))?,
    };
    let mut simulation = Simulation::new(model, grains)?;
    let begun = Instant::now();
    simulation.run(&Limits::events(200_000), &mut ());
    Ok((begun.elapsed().as_secs_f64(), simulation.max_overlap()))
}

/// Nanoseconds that a predictor takes for a pair of neighbours.
fn pace<P: Predictor<3, Straight<3>>>(predictor: P) -> f64 {
    let mut draw = Draw(seeded(2));
    let pairs: Vec<_> = (0..1000)
        .map(|_| {
            let [place, velocity] = neighbours(&mut draw);
            approach(place, velocity)
        })
        .collect();
    let begun = Instant::now();
    for _ in 0..1000 {
        for pair in &pairs {
            black_box(predictor.pair(black_box(pair)));
        }
    }
    begun.elapsed().as_nanos() as f64 / 1.0e6
}

fn main() -> Result<(), SetupError> {
    println!(
        "100 000 pairs of each kind    contacts  missed  invented   overlap: certified, plain"
    );
    let rows = [
        ("neighbours in a gas, 2D", compare::<2>(100_000, neighbours)),
        ("neighbours in a gas, 3D", compare::<3>(100_000, neighbours)),
        ("touching and closing, 2D", compare::<2>(100_000, touching)),
        ("touching and closing, 3D", compare::<3>(100_000, touching)),
        ("grazing, 3D", compare::<3>(100_000, grazing)),
        ("from far away, 3D", compare::<3>(100_000, far)),
    ];
    for (name, tally) in rows {
        println!(
            "{name:28}  {:8}  {:6}  {:8}   {:9.1e} d  {:9.1e} d",
            tally.contacts, tally.missed, tally.invented, tally.overlap[0], tally.overlap[1]
        );
    }
    println!(
        "a question: {:.0} ns certified, {:.0} ns plain",
        pace(Polynomial),
        pace(Textbook)
    );
    println!("a gas in space, φ = 0.45, 200 000 collisions: time, deepest overlap");
    for restitution in [1.0, 0.6] {
        let (time, deepest) = gas::<_, 3>(Polynomial, restitution)?;
        println!("  certified, α = {restitution}: {time:6.2} s  {deepest:.1e} d");
        let (time, deepest) = gas::<_, 3>(Textbook, restitution)?;
        println!("  plain,     α = {restitution}: {time:6.2} s  {deepest:.1e} d");
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn of_neighbours_both_say_the_same() {
        let mut draw = Draw(seeded(3));
        let mut contacts = 0;
        for _ in 0..20_000 {
            let [place, velocity] = neighbours::<3>(&mut draw);
            let pair = approach(place, velocity);
            let (certified, plain) = (Polynomial.pair(&pair), Textbook.pair(&pair));
            if let (Forecast::Contact(certified), Forecast::Contact(plain)) = (certified, plain) {
                contacts += 1;
                let digits = 1.0e-9 * certified.max(1.0);
                assert!((certified - plain).abs() < digits, "{certified} {plain}");
            } else {
                assert_eq!(certified, plain);
            }
        }
        assert!(contacts > 1000);
    }

    /// Half of all grains that touch overlap by a rounding; if they close, they are
    /// in contact now, and the first root is a hair before.
    #[test]
    fn the_textbook_lets_grains_that_touch_pass_through_each_other() {
        let place = Vector::<2>::new(1.0 - 2.0 * f64::EPSILON, 0.0);
        let pair = approach(place, Vector::<2>::new(-1.0, 0.0));
        assert_eq!(Textbook.pair(&pair), Forecast::Never);
        assert_eq!(Polynomial.pair(&pair), Forecast::Contact(0.0));
        let tally = compare::<3>(10_000, touching);
        assert_eq!(tally.contacts, 10_000);
        assert!(tally.missed > 1000, "{tally:?}");
    }

    #[test]
    fn of_grazes_it_misses_some_that_the_certified_one_finds() {
        let tally = compare::<3>(20_000, grazing);
        assert!(tally.contacts > 5000, "{tally:?}");
        assert!(tally.missed > 10 && tally.invented > 10, "{tally:?}");
        assert!(tally.overlap[0] < 1.0e-15, "{tally:?}");
    }
}
