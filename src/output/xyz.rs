mod read;

pub use read::XyzReader;

use std::io::{self, Write};

use crate::model::{Boundary, Shape, Wall};
use crate::particle::{Particle, Vector};
use crate::time::Time;

/// One frame of an extended XYZ file: all grains at an instant, and the box.
///
/// Two-dimensional frames are written with z = 0, so that every viewer can show
/// them, and say `dimension=2`. Numbers have as many digits as it takes to read
/// back the same bits. The column of the modes is called `type`, for that is what
/// viewers tell grains apart by.
#[derive(Clone, Debug, PartialEq)]
pub struct Frame {
    /// 2 or 3.
    pub dimension: usize,
    /// When.
    pub time: Time,
    /// Lower corner of the box, in d.
    pub origin: [f64; 3],
    /// Lengths of the box, in d; along an open axis, as far as there are grains.
    pub lengths: [f64; 3],
    /// Which axes are periodic.
    pub periodic: [bool; 3],
    /// The grains, by id.
    pub grains: Vec<Particle<3>>,
}

/// Why an XYZ file could not be read.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum XyzError {
    /// The file itself.
    #[error(transparent)]
    Io(#[from] io::Error),
    /// Something in it.
    #[error("line {line} of the XYZ file: {field} is `{found}`; {wanted}")]
    Malformed {
        /// The line, from 1.
        line: usize,
        /// What is wrong.
        field: &'static str,
        /// What stands there.
        found: String,
        /// What is wanted.
        wanted: &'static str,
    },
    /// It ends too early.
    #[error("the XYZ file ends after line {line}, in the middle of a frame")]
    Truncated {
        /// The last line.
        line: usize,
    },
    /// It holds no frame.
    #[error("the XYZ file is empty")]
    Empty,
}

impl Frame {
    /// All of `particles`, which are in the order of their ids, at `time`.
    #[must_use]
    pub fn new<const D: usize>(
        particles: &[Particle<D>],
        time: Time,
        boundary: &impl Boundary<D>,
    ) -> Self {
        let mut frame = Frame {
            dimension: D,
            time,
            origin: [0.0, 0.0, -0.5],
            lengths: [1.0; 3],
            periodic: [false; 3],
            grains: particles.iter().map(in_space).collect(),
        };
        for axis in 0..D {
            let period = boundary.period(axis);
            let (low, high) = period.map_or_else(
                || extent(particles, boundary, axis),
                |period| (period.origin, period.origin + period.length),
            );
            frame.origin[axis] = low;
            frame.lengths[axis] = match period {
                Some(period) => period.length,
                // Of grains as far apart as numbers go, the box cannot say more.
                None if high > low => (high - low).min(f64::MAX),
                None => 1.0,
            };
            frame.periodic[axis] = period.is_some();
        }
        frame
    }

    /// The grains in `D` dimensions, which has to be this frame's number.
    #[must_use]
    pub fn particles<const D: usize>(&self) -> Vec<Particle<D>> {
        let part = |vector: &Vector<3>| Vector::from_fn(|axis, _| vector[axis]);
        self.grains
            .iter()
            .map(|grain| Particle {
                position: part(&grain.position),
                velocity: part(&grain.velocity),
                diameter: grain.diameter,
                mass: grain.mass,
                mode: grain.mode,
            })
            .collect()
    }

    /// Writes the frame.
    ///
    /// # Errors
    ///
    /// When `out` cannot be written to.
    pub fn write(&self, out: &mut impl Write) -> io::Result<()> {
        let [a, b, c] = self.lengths;
        let [x, y, z] = self.origin;
        let [p, q, r] = self.periodic.map(|yes| if yes { 'T' } else { 'F' });
        writeln!(out, "{}", self.grains.len())?;
        writeln!(
            out,
            "Lattice=\"{a:?} 0.0 0.0 0.0 {b:?} 0.0 0.0 0.0 {c:?}\" Origin=\"{x:?} {y:?} {z:?}\" \
             pbc=\"{p} {q} {r}\" \
             Properties=id:I:1:pos:R:3:velo:R:3:radius:R:1:mass:R:1:type:S:1 \
             Time={} dimension={}",
            self.time, self.dimension
        )?;
        for (id, grain) in self.grains.iter().enumerate() {
            let (p, v) = (&grain.position, &grain.velocity);
            writeln!(
                out,
                "{id} {:?} {:?} {:?} {:?} {:?} {:?} {:?} {:?} {}",
                p[0],
                p[1],
                p[2],
                v[0],
                v[1],
                v[2],
                grain.radius(),
                grain.mass,
                grain.mode.name()
            )?;
        }
        Ok(())
    }
}

fn in_space<const D: usize>(particle: &Particle<D>) -> Particle<3> {
    let embed = |vector: &Vector<D>| {
        Vector::<3>::from_fn(|axis, _| vector.get(axis).copied().unwrap_or(0.0))
    };
    Particle {
        position: embed(&particle.position),
        velocity: embed(&particle.velocity),
        diameter: particle.diameter,
        mass: particle.mass,
        mode: particle.mode,
    }
}

/// Where an axis that is not periodic begins and ends: at flat walls across it,
/// else where the grains do.
fn extent<const D: usize>(
    particles: &[Particle<D>],
    boundary: &impl Boundary<D>,
    axis: usize,
) -> (f64, f64) {
    let mut low = f64::INFINITY;
    let mut high = f64::NEG_INFINITY;
    for particle in particles {
        low = low.min(particle.position[axis] - particle.radius());
        high = high.max(particle.position[axis] + particle.radius());
    }
    if low > high {
        (low, high) = (0.0, 1.0);
    }
    for wall in boundary.walls() {
        if let Shape::Plane { normal, offset } = wall.shape() {
            if normal[axis] == 1.0 {
                low = offset;
            } else if normal[axis] == -1.0 {
                high = -offset;
            }
        }
    }
    (low.max(f64::MIN), high.min(f64::MAX))
}
