//! Who is in each cell, laid out to be looked at eight at once.
//!
//! Places within a cell are kept with seven digits, rounded so that nobody is
//! overlooked.

use wide::f32x8;

use crate::particle::Vector;

/// Grains kept together.
const LANES: usize = 8;
const NONE: u32 = u32::MAX;
/// Where nobody is; its square is infinite.
const NOWHERE: f32 = 1.0e30;
/// Places farther from the corner of a cell than this, over its edge, are not
/// told with so few digits.
const FAR: f64 = 8.0;
/// Covers rounding, over the longest edge and the reach.
const ROUND: f64 = 4.0e-6;

/// Up to eight grains in a cell, and where more are.
#[derive(Clone, Copy, Debug)]
struct Block<const D: usize> {
    places: [[f32; LANES]; D],
    reaches: [f32; LANES],
    ids: [u32; LANES],
    next: u32,
}

/// Who is in each cell.
#[derive(Clone, Debug)]
pub(super) struct Rooms<const D: usize> {
    /// The first block of each cell.
    heads: Vec<u32>,
    blocks: Vec<Block<D>>,
    /// The first of the blocks that are not in use.
    free: u32,
    /// Longest edge of a cell, in d.
    edge: f64,
}

/// A grain's place from the corner of a cell, and how far it reaches.
#[derive(Clone, Copy, Debug)]
pub(super) struct Guest<const D: usize> {
    place: [f32; D],
    reach: f32,
}

impl<const D: usize> Block<D> {
    const EMPTY: Self = Block {
        places: [[NOWHERE; LANES]; D],
        reaches: [0.0; LANES],
        ids: [NONE; LANES],
        next: NONE,
    };

    /// The lanes in which somebody is, one bit each.
    #[cold]
    fn taken(&self) -> u32 {
        let ids = self.ids.iter().enumerate();
        ids.fold(0, |taken, (lane, id)| {
            taken | u32::from(*id != NONE) << lane
        })
    }

    fn guest(&self, lane: usize) -> Guest<D> {
        Guest {
            place: std::array::from_fn(|axis| self.places[axis][lane]),
            reach: self.reaches[lane],
        }
    }

    fn put(&mut self, lane: usize, particle: u32, guest: &Guest<D>) {
        self.ids[lane] = particle;
        self.reaches[lane] = guest.reach;
        for axis in 0..D {
            self.places[axis][lane] = guest.place[axis];
        }
    }
}

impl<const D: usize> Rooms<D> {
    pub(super) fn new(cells: usize, edge: f64) -> Self {
        Rooms {
            heads: vec![NONE; cells],
            blocks: Vec::new(),
            free: NONE,
            edge,
        }
    }

    /// The same cells without some of the grains, and the room that those had.
    pub(super) fn without(&self, left_out: impl Fn(u32) -> bool) -> Self {
        let mut rooms = Rooms::new(self.heads.len(), self.edge);
        let mut chain = Vec::new();
        for (cell, &head) in self.heads.iter().enumerate() {
            let mut block = head;
            while block != NONE {
                let this = &self.blocks[block as usize];
                chain.push(this);
                block = this.next;
            }
            for block in chain.drain(..).rev() {
                for (lane, &id) in block.ids.iter().enumerate() {
                    if id != NONE && !left_out(id) {
                        rooms.enter(cell, id, &block.guest(lane));
                    }
                }
            }
        }
        rooms
    }

    /// A place from the corner of a cell; what is too far away to be told is near
    /// everybody.
    #[inline]
    pub(super) fn told(&self, along: f64) -> f32 {
        if along.abs() < FAR * self.edge {
            along as f32
        } else {
            f32::NAN
        }
    }

    /// A reach with room for rounding.
    #[inline]
    pub(super) fn told_reach(&self, reach: f64) -> f32 {
        (reach + ROUND * (self.edge + reach)) as f32
    }

    /// How much farther away than `reach`, in d, somebody may be who is told to be nearer.
    pub(super) fn told_error(&self, reach: f64) -> f64 {
        4.0 * ROUND * (self.edge + reach)
    }

    #[inline]
    pub(super) fn guest(&self, from_corner: &Vector<D>, reach: f64) -> Guest<D> {
        Guest {
            place: std::array::from_fn(|axis| self.told(from_corner[axis])),
            reach: self.told_reach(reach),
        }
    }

    /// Who is in a cell, in order.
    pub(super) fn each(&self, cell: usize, mut visit: impl FnMut(u32)) {
        let mut block = self.heads[cell];
        while block != NONE {
            let this = &self.blocks[block as usize];
            this.ids
                .iter()
                .filter(|id| **id != NONE)
                .for_each(|id| visit(*id));
            block = this.next;
        }
    }

    /// Calls `visit` for everybody in a cell who is nearer to a place than both reaches, and
    /// for some who are farther away: certainly not by more than the
    /// [error](Self::told_error), or perhaps.
    #[inline(always)]
    pub(super) fn near(
        &self,
        cell: usize,
        here: &[f32; D],
        reach: f32,
        mut visit: impl FnMut(u32, bool),
    ) {
        let mut block = self.heads[cell];
        while block != NONE {
            let this = &self.blocks[block as usize];
            let mut squared = f32x8::ZERO;
            for (places, &here) in this.places.iter().zip(here) {
                let apart = f32x8::new(*places) - here;
                squared += apart * apart;
            }
            let both = f32x8::new(this.reaches) + reach;
            let excess = squared - both * both;
            let mut lanes = !excess.simd_gt(f32x8::ZERO).to_bitmask() & 0xff;
            if lanes != 0 {
                // Those whose places, or what they are beside, are not told.
                let unknown = excess.simd_ne(excess).to_bitmask();
                if unknown != 0 {
                    lanes &= this.taken();
                }
                while lanes != 0 {
                    let lane = lanes.trailing_zeros() as usize;
                    lanes &= lanes - 1;
                    visit(this.ids[lane], unknown >> lane & 1 == 0);
                }
            }
            block = this.next;
        }
    }

    /// Everybody, cell by cell, in an order in which they can be put there again
    /// so that all is as it was.
    pub(super) fn all(&self) -> Vec<u32> {
        let mut all = Vec::new();
        let mut chain = Vec::new();
        for &head in &self.heads {
            let mut block = head;
            while block != NONE {
                chain.push(block);
                block = self.blocks[block as usize].next;
            }
            for block in chain.drain(..).rev() {
                let ids = &self.blocks[block as usize].ids;
                all.extend(ids.iter().filter(|id| **id != NONE));
            }
        }
        all
    }

    /// Puts a grain into a cell: the first block alone has room.
    pub(super) fn enter(&mut self, cell: usize, particle: u32, guest: &Guest<D>) {
        let head = self.heads[cell];
        if let Some(first) = self.blocks.get_mut(head as usize)
            && let Some(lane) = first.ids.iter().position(|id| *id == NONE)
        {
            first.put(lane, particle, guest);
            return;
        }
        let mut made = Block {
            next: head,
            ..Block::EMPTY
        };
        made.put(0, particle, guest);
        if let Some(place) = self.blocks.get_mut(self.free as usize) {
            self.heads[cell] = self.free;
            self.free = place.next;
            *place = made;
        } else {
            self.heads[cell] = self.blocks.len() as u32;
            self.blocks.push(made);
        }
    }

    /// The block and the lane of a grain in a cell.
    fn find(&self, cell: usize, particle: u32) -> Option<(u32, usize)> {
        let mut block = self.heads[cell];
        while block != NONE {
            let this = &self.blocks[block as usize];
            if let Some(lane) = this.ids.iter().position(|id| *id == particle) {
                return Some((block, lane));
            }
            block = this.next;
        }
        None
    }

    pub(super) fn holds(&self, cell: usize, particle: u32) -> bool {
        self.find(cell, particle).is_some()
    }

    /// Moves a grain within its cell; false if it is not there.
    pub(super) fn shift(&mut self, cell: usize, particle: u32, guest: &Guest<D>) -> bool {
        let found = self.find(cell, particle);
        if let Some((block, lane)) = found {
            self.blocks[block as usize].put(lane, particle, guest);
        }
        found.is_some()
    }

    /// Takes a grain out of a cell; who came last takes its place.
    pub(super) fn leave(&mut self, cell: usize, particle: u32) {
        let Some((block, lane)) = self.find(cell, particle) else {
            return;
        };
        let head = self.heads[cell];
        let first = &mut self.blocks[head as usize];
        let vacant = first.ids.iter().position(|id| *id == NONE);
        let last = vacant.unwrap_or(LANES) - 1;
        let moved = first.ids[last];
        let guest = first.guest(last);
        let nobody = Guest {
            place: [NOWHERE; D],
            reach: 0.0,
        };
        first.put(last, NONE, &nobody);
        if last == 0 {
            self.heads[cell] = std::mem::replace(&mut first.next, self.free);
            self.free = head;
        }
        if moved != particle {
            self.blocks[block as usize].put(lane, moved, &guest);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        /// Against a plain list, whose last takes the place of who leaves.
        #[test]
        fn they_come_and_go(steps in proptest::collection::vec((0usize..3, 0u32..20), 1..200)) {
            let mut rooms = Rooms::<2>::new(3, 1.0);
            let mut plain = vec![Vec::new(); 3];
            let at = |id: u32| Vector::<2>::new(0.04 * f64::from(id), 0.5);
            for (cell, id) in steps {
                let list: &mut Vec<u32> = &mut plain[cell];
                if let Some(place) = list.iter().position(|there| *there == id) {
                    rooms.leave(cell, id);
                    list.swap_remove(place);
                } else {
                    rooms.enter(cell, id, &rooms.guest(&at(id), 0.1));
                    list.push(id);
                }
                prop_assert_eq!(rooms.all(), plain.concat());
                for (cell, list) in plain.iter().enumerate() {
                    let mut near = Vec::new();
                    let here = [rooms.told(0.2), rooms.told(0.5)];
                    rooms.near(cell, &here, rooms.told_reach(0.1), |id, certain| {
                        assert!(certain);
                        near.push(id);
                    });
                    near.sort_unstable();
                    let in_reach = |id: &&u32| (0.04 * f64::from(**id) - 0.2).abs() < 0.2001;
                    let mut expected: Vec<u32> = list.iter().filter(in_reach).copied().collect();
                    expected.sort_unstable();
                    prop_assert_eq!(near, expected);
                    // Somewhere that cannot be told is near everybody.
                    let mut all = 0;
                    rooms.near(cell, &[rooms.told(1.0e9), 0.0], 0.1, |id, certain| {
                        assert!(id != NONE && !certain);
                        all += 1;
                    });
                    prop_assert_eq!(all, list.len());
                }
            }
        }
    }
}
