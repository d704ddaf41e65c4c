//! A half-filled drum.

use rand_chacha::ChaCha8Rng;

use crate::boundary::{Cuboid, Side};
use crate::collide::Restitution;
use crate::dynamics::UniformGravity;
use crate::engine::{Limits, Simulation};
use crate::error::SetupError;
use crate::model::Parts;
use crate::particle::{Mode, Particle, Vector};
use crate::policy::{Criterion, SlowDescent};
use crate::predict::Polynomial;
use crate::setup::insertion::insert;
use crate::setup::region::Region;
use crate::setup::require;
use crate::time::Time;

/// Free length beside a grain that is put next to the wall, in d.
const MARGIN: f64 = 1.0e-6;
/// A filling that has not come to rest by then never will, in √(d/g).
const LATEST: f64 = 1000.0;

/// A drum and its filling (the paper's section 4): a cylinder of fixed grains in
/// regular rings, its axis horizontal, with equal grains that have fallen in and
/// come to rest.
///
/// The axis of the drum goes through the origin. In three dimensions it is the
/// second one and periodic, and the drum turns in the plane of the other two; in
/// the plane the drum is one ring. The filling is made by the model itself: grains at random
/// places of the whole drum fall under constant gravity, with α = 0.7,
/// α_frozen = 0.4, V_sleep = V_wakeup = 0.1 and V_c = 10⁻³, until all are asleep;
/// those whose centres lie above `level` are then taken away.
#[derive(Clone, Debug, PartialEq)]
pub struct Drum {
    /// From the axis to the centres of the wall's grains, in d; 25 in the paper.
    pub radius: f64,
    /// How many rings of grains make the wall; 5 in the paper, and 1 in the plane.
    pub rings: usize,
    /// Distance of the rings, in d; 1.05 in the paper.
    pub ring_spacing: f64,
    /// Distance of the grains along a ring, in d, at least: as many as fit in are
    /// spread evenly. 1.0 in the paper, which makes 157 grains of a ring.
    pub arc_spacing: f64,
    /// Up to which height above the axis it is filled, in d.
    pub level: f64,
}

impl Default for Drum {
    /// The paper's.
    fn default() -> Self {
        Drum {
            radius: 25.0,
            rings: 5,
            ring_spacing: 1.05,
            arc_spacing: 1.0,
            level: 0.0,
        }
    }
}

impl Drum {
    /// The period along the axis in three dimensions, in d.
    #[must_use]
    pub fn length(&self) -> f64 {
        self.rings as f64 * self.ring_spacing
    }

    /// The same drum, if its numbers are in range.
    ///
    /// # Errors
    ///
    /// When one is not.
    pub fn validated<const D: usize>(&self) -> Result<&Self, SetupError> {
        require(
            (2.5..=1.0e4).contains(&self.radius),
            "radius",
            self.radius,
            "2.5 … 10000 is allowed",
        )?;
        for (field, spacing) in [
            ("ring_spacing", self.ring_spacing),
            ("arc_spacing", self.arc_spacing),
        ] {
            // No grain may slip through.
            let allowed = "1 … 1.3 is allowed";
            require((1.0..=1.3).contains(&spacing), field, spacing, allowed)?;
        }
        let rings = self.rings as f64;
        if D == 2 {
            require(self.rings == 1, "rings", rings, "1 is allowed in the plane")?;
        } else {
            let allowed = "2 … 10000 is allowed";
            require((2..=10_000).contains(&self.rings), "rings", rings, allowed)?;
        }
        Ok(self)
    }

    /// The wall, all [`Mode::Fixed`], ring by ring.
    ///
    /// # Errors
    ///
    /// When a number is out of range.
    pub fn wall<const D: usize>(&self) -> Result<Vec<Particle<D>>, SetupError> {
        self.validated::<D>()?;
        let turn = 2.0 * core::f64::consts::PI;
        let each = libm::floor(turn * self.radius / self.arc_spacing) as usize;
        let mut wall = Vec::with_capacity(each * self.rings);
        for ring in 0..self.rings {
            for place in 0..each {
                let (sin, cos) = libm::sincos(turn * place as f64 / each as f64);
                let mut position = Vector::<D>::zeros();
                position[0] = self.radius * cos;
                if D > 2 {
                    position[1] = (ring as f64 + 0.5) * self.ring_spacing;
                }
                position[D - 1] = self.radius * sin;
                wall.push(Particle::fixed(position));
            }
        }
        Ok(wall)
    }

    /// The wall and the filling, which is asleep.
    ///
    /// # Errors
    ///
    /// When a number is out of range.
    pub fn grains<const D: usize>(
        &self,
        random: &mut ChaCha8Rng,
    ) -> Result<Vec<Particle<D>>, SetupError> {
        let mut grains = self.wall::<D>()?;
        let wall = grains.len();
        grains.extend(self.cloud::<D>(random)?);
        let mut sides = [Side::Open; D];
        if D > 2 {
            sides[1] = Side::periodic(self.length());
        }
        let model = Parts {
            dynamics: UniformGravity::<D>::down(),
            predictor: Polynomial,
            collision_rule: Restitution {
                elastic_speed: 1.0e-3,
                ..Restitution::default()
            },
            // The type with which the program is compiled anyway.
            state_policy: Criterion::SlowDescent(SlowDescent::with_threshold(0.1)),
            boundary: Cuboid::new(sides)?,
        };
        let mut simulation = Simulation::new(model, grains)?;
        let limits = Limits {
            time: Time::from_units(LATEST),
            all_frozen: true,
            ..Limits::default()
        };
        simulation.run(&limits, &mut ());
        let mut settled = simulation.snapshot();
        let filling = settled.split_off(wall);
        let below =
            |grain: &Particle<D>| grain.mode == Mode::Frozen && grain.position[D - 1] <= self.level;
        settled.extend(filling.into_iter().filter(below));
        Ok(settled)
    }

    /// Grains at rest at random places of the drum: enough to fill it a little
    /// higher than half, once they have settled.
    fn cloud<const D: usize>(
        &self,
        random: &mut ChaCha8Rng,
    ) -> Result<Vec<Particle<D>>, SetupError> {
        let fraction = if D == 2 { 0.5 } else { 0.33 };
        let inner = self.radius - 1.0 - MARGIN;
        let mut region = Region {
            origin: Vector::<D>::repeat(-inner - 0.5),
            lengths: Vector::<D>::repeat(2.0 * inner + 1.0),
            periodic: [false; D],
        };
        if D > 2 {
            region.origin[1] = 0.0;
            region.lengths[1] = self.length();
            region.periodic[1] = true;
        }
        // Where centres may be.
        let room = |axis: usize| region.lengths[axis] - f64::from(u8::from(!region.periodic[axis]));
        let volume: f64 = (0..D).map(room).product();
        let count = fraction * volume / crate::analysis::ball_volume::<D>(0.5);
        let places = insert(&region, &vec![1.0; count as usize], random)?;
        let inside = |place: &Vector<D>| {
            let (x, z) = (place[0], place[D - 1]);
            x * x + z * z <= inner * inner
        };
        let places = places.into_iter().filter(inside);
        Ok(places
            .map(|place| Particle::new(place, Vector::<D>::zeros()))
            .collect())
    }
}
