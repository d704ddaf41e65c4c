//! Whether the lists' book-keeping holds.

use crate::engine::cells::Link;
use crate::engine::images::for_each_turns;
use crate::engine::neighbours::Neighbours;
use crate::particle::Vector;

/// Leaves room for rounding.
const ROUND: f64 = 1.0 - 1.0e-9;

impl<const D: usize> Neighbours<D> {
    /// Whether those who look around find a grain.
    pub(in crate::engine) fn is_found(&self, particle: u32) -> bool {
        self.cells.is_found(particle)
    }

    /// A grain that is now at `position` has to be in its cell, on its leash if it has one,
    /// and on the list of everybody on its own.
    pub(in crate::engine) fn check_tie(
        &self,
        particle: u32,
        position: &Vector<D>,
    ) -> Result<(), String> {
        let tie = &self.ties[particle];
        self.cells
            .check_seat(particle, &self.home(particle, position))?;
        if !self.is_tied(particle) {
            return Ok(());
        }
        let strayed = (position - self.anchor(particle)).norm();
        // Rounding of the place itself, far from the origin.
        let rounding = 1.0e-12 * (self.largest + position.norm());
        if strayed > tie.leash + rounding {
            return Err(format!(
                "grain {particle} is {strayed} from its anchor, on a leash of {}",
                tie.leash
            ));
        }
        for (place, link) in tie.list.iter().enumerate() {
            if link.particle() as usize >= self.ties.len() {
                return Err(format!("grain {particle} lists {link:?}, who is not there"));
            }
            let other = &self.ties[link.particle()];
            if tie.list[..place].contains(link) {
                return Err(format!("grain {particle} lists {link:?} twice"));
            }
            if other.leash > 0.0 && !other.list.contains(&link.seen_from(particle)) {
                return Err(format!(
                    "grain {particle} lists {link:?}, who does not list it"
                ));
            }
        }
        Ok(())
    }

    /// Whoever two leashes let touch has to be on the list of a grain, but for those
    /// that nobody is to find.
    pub(in crate::engine) fn check_complete(
        &self,
        particle: u32,
        stored: impl Fn(u32) -> (Vector<D>, f64),
    ) -> Result<(), String> {
        let tie = &self.ties[particle];
        if tie.leash == 0.0 {
            return Ok(());
        }
        for other in 0..self.ties.len() as u32 {
            if other == particle || !self.is_found(other) {
                continue;
            }
            let ((_, own), (there, theirs)) = (stored(particle), stored(other));
            let apart = self.home(other, &there) - tie.home;
            let contact = own + theirs;
            let reach = ROUND * (contact + tie.leash + self.ties[other].leash);
            let mut absent = None;
            self.for_each_image(&apart, reach, |turns| {
                if !tie
                    .list
                    .contains(&Link::new(other, Link::<D>::image_of(&turns)))
                {
                    absent = Some((other, turns));
                }
            });
            if let Some(absent) = absent {
                return Err(format!("grain {particle} does not list {absent:?}"));
            }
        }
        Ok(())
    }

    /// Calls `visit` for every image of a vector that is shorter than `reach`.
    fn for_each_image(&self, apart: &Vector<D>, reach: f64, mut visit: impl FnMut([i32; D])) {
        let mut low = [0; D];
        let mut high = [0; D];
        let periods = self.cells.shift([1; D]);
        for axis in 0..D {
            let period = periods[axis];
            if period > 0.0 {
                low[axis] = libm::ceil((-reach - apart[axis]) / period) as i32;
                high[axis] = libm::floor((reach - apart[axis]) / period) as i32;
            } else if apart[axis].abs() >= reach {
                return;
            }
        }
        for_each_turns(low, high, |turns| {
            let image = apart + self.cells.shift(turns);
            if image.norm_squared() < reach * reach {
                visit(turns);
            }
        });
    }
}

#[cfg(test)]
impl<const D: usize> Neighbours<D> {
    /// Plants a fault: a grain forgets the first on its list; told who it was.
    pub(in crate::engine) fn forget_first(&mut self, particle: u32) -> u32 {
        let list = &mut self.ties.make(particle).list;
        list.swap_remove(0).particle()
    }

    /// Plants a fault: a grain is not on the list of another.
    pub(in crate::engine) fn forget(&mut self, particle: u32, other: u32) {
        let list = &mut self.ties.make(particle).list;
        list.retain(|link| link.particle() != other);
    }

    /// Plants a fault: a grain is filed in another cell than its own.
    pub(in crate::engine) fn misfile(&mut self, particle: u32, position: &Vector<D>) {
        self.cells.refile(particle, position, self.reach(particle));
    }
}
