//! Who looks at a run from outside and knows no more than is public.

use grainfall::boundary::Cuboid;
use grainfall::dynamics::{Parabola, UniformGravity};
use grainfall::engine::{Counts, Limits, Simulation, StopReason};
use grainfall::model::{
    Approach, Boundary, Dynamics, Encounter, Flight, Forecast, Motion, Occurrence,
    OccurrenceKind as Kind, Predictor,
};
use grainfall::policy::SlowDescent;
use grainfall::predict::Polynomial;
use grainfall::{Mode, Particle, ParticleId, Time, Vector, WallId};
use proptest::prelude::*;

use crate::common;

/// Overlaps and gaps up to this are rounding, in d.
const ROUNDING: f64 = 1.0e-9;
/// How far ahead contacts are foreseen, in √(d/g).
const AHEAD: f64 = 5.0;

pub(crate) type Heap<const D: usize> = Simulation<common::Heavy<SlowDescent, D>, D>;

/// The gap that a pair or a grain and a wall are to close, and when.
#[derive(Clone, Copy)]
struct Foreseen<const D: usize> {
    time: Time,
    one: usize,
    other: Option<(usize, Vector<D>)>,
    wall: Option<usize>,
}

/// What an outsider knows of a run.
struct Auditor<const D: usize> {
    boundary: Cuboid<D>,
    dynamics: UniformGravity<D>,
    tally: Counts,
    /// Kinetic energy that each grain lost when it fell asleep.
    stored: Vec<f64>,
}

impl<const D: usize> Auditor<D> {
    fn flight(&self, id: usize, grain: &Particle<D>, now: Time) -> Parabola<D> {
        let motion = Motion {
            id: ParticleId(id as u32),
            position: grain.position,
            velocity: grain.velocity,
            mode: grain.mode,
        };
        self.dynamics.flight(&motion, now)
    }

    /// The vectors to the periodic images next to the primary cell.
    fn images(&self) -> Vec<Vector<D>> {
        let mut images = vec![Vector::zeros()];
        for axis in 0..D {
            let Some(period) = self.boundary.period(axis) else {
                continue;
            };
            let mut more = Vec::new();
            for image in &images {
                for turns in [-1.0, 0.0, 1.0] {
                    let mut image: Vector<D> = *image;
                    image[axis] = turns * period.length;
                    more.push(image);
                }
            }
            images = more;
        }
        images
    }

    /// All contacts that lie ahead of grains whose gap is not zero by rounding.
    fn foresee(&self, grains: &[Particle<D>], now: Time) -> Vec<Foreseen<D>> {
        let images = self.images();
        let mut all = Vec::new();
        for (i, one) in grains.iter().enumerate() {
            let first = self.flight(i, one, now);
            for (j, two) in grains.iter().enumerate().skip(i + 1) {
                if one.mode.is_static() && two.mode.is_static() {
                    continue;
                }
                let distance = one.radius() + two.radius();
                for &shift in &images {
                    let apart = (two.position + shift - one.position).norm();
                    if apart < distance + ROUNDING {
                        continue;
                    }
                    let forecast = Polynomial.pair(&Approach {
                        first,
                        second: self.flight(j, two, now),
                        shift,
                        distance,
                        growth: 0.0,
                        touching: false,
                        horizon: AHEAD,
                    });
                    if let Forecast::Contact(after) = forecast {
                        all.push(Foreseen {
                            time: now + after,
                            one: i,
                            other: Some((j, shift)),
                            wall: None,
                        });
                    }
                }
            }
            for (place, wall) in self.boundary.walls().iter().enumerate() {
                let gap = wall.normal.dot(&one.position) - wall.offset - one.radius();
                if one.mode.is_static() || gap < ROUNDING {
                    continue;
                }
                let forecast = Polynomial.wall(&Encounter {
                    flight: first,
                    wall,
                    since: now,
                    radius: one.radius(),
                    growth: 0.0,
                    touching: false,
                    horizon: AHEAD,
                });
                if let Forecast::Contact(after) = forecast {
                    all.push(Foreseen {
                        time: now + after,
                        one: i,
                        other: None,
                        wall: Some(place),
                    });
                }
            }
        }
        all
    }

    /// How deep two would have gone into each other by `time` without an event.
    fn depth(&self, contact: &Foreseen<D>, from: (&[Particle<D>], Time), time: Time) -> f64 {
        let (grains, now) = from;
        let one = &grains[contact.one];
        let place = |id: usize| self.flight(id, &grains[id], now).position(time - now);
        match (contact.other, contact.wall) {
            (Some((other, shift)), _) => {
                let apart = place(other) + shift - place(contact.one);
                one.radius() + grains[other].radius() - apart.norm()
            }
            (None, Some(wall)) => {
                let wall = &self.boundary.walls()[wall];
                one.radius() + wall.offset - wall.normal.dot(&place(contact.one))
            }
            (None, None) => f64::NEG_INFINITY,
        }
    }

    /// Nothing that was foreseen may have been passed over until `time`.
    fn nothing_missed(
        &self,
        foreseen: &[Foreseen<D>],
        from: (&[Particle<D>], Time),
        time: Time,
    ) -> Result<(), TestCaseError> {
        for contact in foreseen.iter().filter(|contact| contact.time < time) {
            let late = f64::min(time - contact.time, 1.0);
            for step in 1..=32 {
                let then = contact.time + late * f64::from(step) / 32.0;
                let depth = self.depth(contact, from, then);
                prop_assert!(
                    depth < ROUNDING,
                    "{} met {:?} or wall {:?} at {}, and nothing happened until {time}",
                    contact.one,
                    contact.other,
                    contact.wall,
                    contact.time
                );
            }
        }
        Ok(())
    }

    fn nobody_overlaps(&self, grains: &[Particle<D>]) -> Result<(), TestCaseError> {
        for (i, one) in grains.iter().enumerate() {
            for (j, two) in grains.iter().enumerate().skip(i + 1) {
                if one.mode == Mode::Fixed && two.mode == Mode::Fixed {
                    continue;
                }
                let apart = self.boundary.displacement(&one.position, &two.position);
                let depth = one.radius() + two.radius() - apart.norm();
                prop_assert!(depth < ROUNDING, "{i} and {j} overlap by {depth:e}");
            }
            for (place, wall) in self.boundary.walls().iter().enumerate() {
                let depth = one.radius() + wall.offset - wall.normal.dot(&one.position);
                prop_assert!(depth < ROUNDING, "{i} is {depth:e} in wall {place}");
            }
        }
        Ok(())
    }

    /// Counts an event and checks what it says of itself; returns the energy
    /// that it may have added.
    fn note(
        &mut self,
        event: &Occurrence<D>,
        grains: &[Particle<D>],
    ) -> Result<f64, TestCaseError> {
        if event.kind == Kind::Guard {
            // Not counted among the events; what a guard may add is allowed for
            // elsewhere.
            prop_assert!(event.velocity.iter().all(|v| v.is_finite()));
            prop_assert!(event.other.is_none() && event.wall.is_none());
            return Ok(0.0);
        }
        let count = match event.kind {
            Kind::Guard => unreachable!("it has been dealt with"),
            Kind::Pair => &mut self.tally.pair,
            Kind::Frozen => &mut self.tally.frozen,
            Kind::Wake => &mut self.tally.wake,
            Kind::Wall => &mut self.tally.wall,
            Kind::Sleep => &mut self.tally.sleep,
            Kind::CheckWake => &mut self.tally.check_wake,
        };
        *count += 1;
        self.tally.elastic += u64::from(event.elastic);
        let id = event.particle.index();
        let one = &grains[id];
        prop_assert!(event.velocity.iter().all(|v| v.is_finite()));
        let collides = !matches!(event.kind, Kind::Sleep | Kind::CheckWake);
        // One that wakes exactly at contact meets it at 0, or at a rounding of 0.
        prop_assert!(event.impact_speed > -1.0e-15, "{event:?}");
        prop_assert!(collides || event.impact_speed == 0.0);
        let with_wall = event.kind == Kind::Wall;
        prop_assert_eq!(event.wall.is_some(), with_wall);
        prop_assert_eq!(event.other.is_some(), collides && !with_wall);
        if let Some(WallId(wall)) = event.wall {
            prop_assert!(usize::from(wall) < self.boundary.walls().len());
        }
        if let Some(other) = event.other {
            prop_assert!(other.index() < grains.len());
            prop_assert!(event.kind != Kind::Pair || event.particle < other);
            let two = &grains[other.index()];
            let apart = self.boundary.displacement(&two.position, &one.position);
            let gap = apart.norm() - one.radius() - two.radius();
            prop_assert!(gap.abs() < ROUNDING, "{event:?} with a gap of {gap:e}");
        }
        Ok(match event.kind {
            Kind::Sleep => {
                self.stored[id] = 0.5 * event.impulse.norm_squared() / one.mass;
                0.0
            }
            Kind::CheckWake => self.stored[id],
            Kind::Wake => self.stored[event.other.map_or(id, ParticleId::index)],
            _ => 0.0,
        })
    }
}

fn energy<const D: usize>(simulation: &Heap<D>) -> f64 {
    simulation.kinetic_energy() + simulation.potential_energy()
}

/// Runs a system event by event and audits it after each.
pub(crate) fn audit<const D: usize>(
    mut simulation: Heap<D>,
    events: u64,
) -> Result<(), TestCaseError> {
    let mut grains = simulation.snapshot();
    let mut auditor = Auditor {
        boundary: simulation.model().boundary.clone(),
        dynamics: simulation.model().dynamics,
        tally: Counts::default(),
        stored: vec![0.0; grains.len()],
    };
    let mass: f64 = grains.iter().map(|grain| grain.mass).sum();
    let mut before = energy(&simulation);
    loop {
        let now = simulation.time();
        let foreseen = auditor.foresee(&grains, now);
        let guards = simulation.counts().guard;
        let mut seen = Vec::new();
        let limits = Limits {
            time: Time::from_units(60.0),
            events: simulation.counts().total() + 1,
            all_frozen: false,
        };
        let why = simulation.run(&limits, &mut |event: &Occurrence<D>| seen.push(*event));
        prop_assert!(simulation.time() >= now, "the clock went back");
        auditor.nothing_missed(&foreseen, (&grains, now), simulation.time())?;
        grains = simulation.snapshot();
        auditor.nobody_overlaps(&grains)?;
        let mut allowed = 1.0e-12 * (1.0 + before.abs());
        for event in &seen {
            prop_assert_eq!(event.time, simulation.time());
            allowed += auditor.note(event, &grains)?;
        }
        // A guard may add its exit speed, ten times at most, to any grain.
        let guarded = (simulation.counts().guard - guards) as f64;
        let fastest = grains.iter().map(|grain| grain.velocity.norm());
        let fastest = fastest.fold(0.0, f64::max);
        allowed += guarded * mass * 1.0e-4 * (fastest + 1.0e-4);
        let after = energy(&simulation);
        prop_assert!(
            after - before <= allowed,
            "energy rose from {before} to {after}, allowed {allowed:e}: {seen:?}"
        );
        before = after;

        let tally = Counts {
            check: simulation.counts().check,
            support: simulation.counts().support,
            transfer: simulation.counts().transfer,
            guard: simulation.counts().guard,
            ..auditor.tally
        };
        prop_assert_eq!(&tally, simulation.counts());
        let modes = simulation.mode_counts();
        for (mode, counted) in [
            (Mode::Normal, modes.normal),
            (Mode::Falling, modes.falling),
            (Mode::Frozen, modes.frozen),
            (Mode::Fixed, modes.fixed),
        ] {
            let found = grains.iter().filter(|grain| grain.mode == mode).count();
            prop_assert_eq!(found, counted);
        }
        match why {
            StopReason::Events if simulation.counts().total() < events => {}
            StopReason::Events | StopReason::Time => return Ok(()),
            other => return Err(TestCaseError::fail(format!("{other:?}"))),
        }
    }
}
