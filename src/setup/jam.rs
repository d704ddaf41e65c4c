//! Random packings grown until they jam.

use rand_chacha::ChaCha8Rng;

use crate::analysis::ball_volume;
use crate::boundary::{Cuboid, Side};
use crate::collide::Restitution;
use crate::dynamics::{ForceFree, Growing};
use crate::engine::{Guards, Limits, Settings, Simulation};
use crate::error::SetupError;
use crate::model::Parts;
use crate::observe::CollisionalTransfer;
use crate::particle::{Particle, Vector};
use crate::policy::Never;
use crate::predict::Polynomial;
use crate::setup::velocities::set_temperature;
use crate::setup::{Gas, Sizes, require};

/// Collisions of each grain between two looks at the pressure, after which the
/// heat of compression is taken out.
const EACH: u64 = 20;
/// Looks after which a packing that does not jam is given up.
const MOST_LOOKS: usize = 100_000;
/// Where growth begins.
const SPARSE: f64 = 0.3;

/// A jammed random packing of equal grains by growth at a constant rate:
/// Lubachevsky & Stillinger 1990, doi:10.1007/BF01025983. Elastic grains fly in a
/// periodic cube (square) while their diameters grow, until the pressure says
/// that nothing has room to move.
///
/// The slower the growth, the more order there is time for; random close packing
/// is what intermediate rates tend to (Torquato, Truskett & Debenedetti 2000,
/// doi:10.1103/PhysRevLett.84.2064).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Jam {
    /// How many grains.
    pub count: usize,
    /// Growth of a diameter in the time in which a grain at thermal speed √(T/m)
    /// crosses it.
    pub rate: f64,
    /// The compressibility P V/N T at which it counts as jammed, such as 10⁵: then
    /// the packing fraction is the final one but for its share of D over that.
    pub compressibility: f64,
}

/// A packing that has jammed.
#[derive(Clone, Debug)]
pub struct Jammed<const D: usize> {
    /// Its packing fraction.
    pub packing_fraction: f64,
    /// P V/N T at the end.
    pub compressibility: f64,
    /// The grains, of diameter 1.
    pub grains: Vec<Particle<D>>,
    /// Edges of the periodic box from the origin, in d.
    pub lengths: Vector<D>,
}

impl Jam {
    /// Grows a packing.
    ///
    /// # Errors
    ///
    /// When a number is out of range, or it does not jam.
    pub fn packing<const D: usize>(
        &self,
        random: &mut ChaCha8Rng,
    ) -> Result<Jammed<D>, SetupError> {
        require(
            (1.0e-6..=1.0).contains(&self.rate),
            "rate",
            self.rate,
            "1e-6 … 1 is allowed",
        )?;
        require(
            (100.0..=1.0e9).contains(&self.compressibility),
            "compressibility",
            self.compressibility,
            "100 … 1e9 is allowed",
        )?;
        let gas = Gas::<D> {
            count: self.count,
            sizes: Sizes::default(),
            packing_fraction: SPARSE,
            temperature: 1.0,
            aspect: Vector::<D>::repeat(1.0),
        };
        let (mut grains, lengths) = gas.grains(random)?;
        let sides = std::array::from_fn(|axis| Side::periodic(lengths[axis]));
        let boundary = Cuboid::new(sides)?;
        let masses = vec![1.0; self.count];
        for _ in 0..MOST_LOOKS {
            let diameter = grains[0].diameter;
            // Thermal speed is one diameter per unit of time.
            let temperature = diameter * diameter;
            let mut velocities: Vec<Vector<D>> =
                grains.iter().map(|grain| grain.velocity).collect();
            set_temperature(&mut velocities, &masses, temperature);
            for (grain, velocity) in grains.iter_mut().zip(velocities) {
                grain.velocity = velocity;
            }
            let model = Parts {
                dynamics: Growing::new(ForceFree, self.rate),
                predictor: Polynomial,
                collision_rule: Restitution::elastic(),
                state_policy: Never,
                boundary: boundary.clone(),
            };
            let settings = Settings {
                guards: Guards::none(),
                ..Settings::default()
            };
            let mut simulation = Simulation::with_settings(model, grains, settings)?;
            let before = simulation.kinetic_energy();
            let mut transfer = CollisionalTransfer::new(simulation.time());
            let limits = Limits::events(EACH * self.count as u64);
            simulation.run(&limits, &mut transfer);
            let energy = 0.5 * (before + simulation.kinetic_energy());
            let volume: f64 = lengths.iter().product();
            let pressure = transfer.pressure::<D>(simulation.time(), energy, volume);
            let compressibility = pressure * volume * D as f64 / (2.0 * energy);
            grains = simulation.snapshot();
            if compressibility >= self.compressibility {
                let solid = self.count as f64 * ball_volume::<D>(0.5 * grains[0].diameter);
                return Ok(scaled(grains, lengths, solid / volume, compressibility));
            }
        }
        Err(SetupError::NoRoom {
            placed: 0,
            wanted: self.count,
            reason: "it has not jammed; faster growth or fewer grains would help",
        })
    }
}

/// The packing in units of its diameter.
fn scaled<const D: usize>(
    mut grains: Vec<Particle<D>>,
    lengths: Vector<D>,
    packing_fraction: f64,
    compressibility: f64,
) -> Jammed<D> {
    let unit = grains[0].diameter;
    for grain in &mut grains {
        grain.position /= unit;
        grain.velocity /= unit;
        grain.diameter = 1.0;
    }
    Jammed {
        packing_fraction,
        compressibility,
        grains,
        lengths: lengths / unit,
    }
}
