//! How long two grains certainly stay near each other.

use crate::engine::body::World;
use crate::model::{Flight, Model};

/// Bounds on speeds are asked for no longer than this ahead, in √(d/g).
const WINDOW: f64 = 0.25;

/// Longer than this, in √(d/g), is long: it is told as it is found.
const LONG: f64 = 0.1;

/// Nearer to the limit than this part of it is there.
const ARRIVED: f64 = 1.0e-13;

/// Most steps towards the limit.
const STEPS: usize = 64;

impl<const D: usize> World<D> {
    /// How long the centres of two grains certainly stay nearer than `range` times
    /// their distance at contact, if both fly on as now: in steps that no two
    /// grains of their speeds can make too long. 0 if they are as far apart
    /// already. It may be too short, but short times are told well: to ask again
    /// at the end of the time tells, after a few times, the instant at which they
    /// get so far.
    pub(super) fn stays_near<M: Model<D>>(
        &self,
        model: &M,
        one: u32,
        other: u32,
        range: f64,
    ) -> f64 {
        let flight = |particle: u32| {
            let after = self.clock - self.bodies[particle as usize].since;
            self.flight(model, particle).advanced(after)
        };
        let (first, second) = (
            self.particle_now(model, one),
            self.particle_now(model, other),
        );
        let offset = self.displacement(model, &first, &second);
        let (from, to) = (flight(one), flight(other));
        // The image in question.
        let image = offset - (to.start() - from.start());
        let limit = range * 0.5 * (first.diameter + second.diameter);
        let (mut time, mut window) = (0.0, WINDOW);
        for _ in 0..STEPS {
            let apart = to.position(time) - from.position(time) + image;
            let gap = limit - apart.norm_squared().sqrt();
            if gap <= ARRIVED * limit {
                break;
            }
            let speed =
                from.advanced(time).speed_bound(window) + to.advanced(time).speed_bound(window);
            let step = if speed * window > gap {
                gap / speed
            } else {
                window
            };
            time += step;
            if time >= LONG {
                break;
            }
            // The shorter the window the lower the bound.
            window = (2.0 * step).min(WINDOW);
        }
        time
    }
}
