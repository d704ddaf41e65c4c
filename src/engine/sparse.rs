//! Tables with room for those grains alone that have something to keep.
//!
//! In a heap hardly anybody moves: what only a grain that moves needs is kept for those,
//! and of all others no more than that there is nothing. Room is made and given back for
//! a few grains of consecutive ids together, so that hardly more than the entry itself
//! has to be looked up: numbered along a curve in space they move and rest at about the
//! same time.

use std::ops::Index;

/// Grains of a page, as many as a set of its members has bits.
const PAGE: u32 = u32::BITS;
/// Where pages without entries of their own find them.
const COMMON: u32 = 0;

/// A few grains of consecutive ids.
#[derive(Clone, Copy, Debug)]
struct Page {
    /// What to add to an id to get the place of its entry, wrapping around.
    offset: u32,
    /// Who of them has an entry of their own, one bit each.
    members: u32,
}

impl Page {
    /// The page of a grain, if its entries begin at this place.
    fn at(start: u32, particle: u32) -> Self {
        Page {
            offset: start.wrapping_sub(particle - particle % PAGE),
            members: 0,
        }
    }

    #[inline]
    fn place(self, particle: u32) -> usize {
        self.offset.wrapping_add(particle) as usize
    }

    #[inline]
    fn has(self, particle: u32) -> bool {
        self.members >> (particle % PAGE) & 1 != 0
    }
}

/// An entry for each of some grains, named by index; all others have the same.
#[derive(Clone, Debug)]
pub(super) struct Sparse<T> {
    count: u32,
    pages: Vec<Page>,
    /// Page by page; the first is that of all who have none of their own, and never
    /// written to.
    entries: Vec<T>,
    /// Places at which the entries of a page could be.
    vacant: Vec<u32>,
}

impl<T: Clone> Sparse<T> {
    /// For so many grains, all of which have this.
    pub(super) fn new(count: usize, common: T) -> Self {
        let mut sparse = Sparse {
            count: 0,
            pages: Vec::with_capacity(count / PAGE as usize + 1),
            entries: vec![common; PAGE as usize],
            vacant: Vec::new(),
        };
        for _ in 0..count {
            sparse.push();
        }
        sparse
    }

    /// How many grains there are, with an entry of their own or not.
    pub(super) fn len(&self) -> usize {
        self.count as usize
    }

    /// Adds a grain without an entry.
    pub(super) fn push(&mut self) {
        if self.count.is_multiple_of(PAGE) {
            self.pages.push(Page::at(COMMON, self.count));
        }
        self.count += 1;
    }

    /// Takes back the grain that was added last.
    pub(super) fn pop(&mut self) {
        if let Some(last) = self.count.checked_sub(1) {
            self.clear(last);
            self.count = last;
            if last.is_multiple_of(PAGE) {
                self.pages.pop();
            }
        }
    }

    /// What all have who have nothing of their own.
    fn common(&self) -> &T {
        &self.entries[COMMON as usize]
    }

    #[inline]
    fn page(&self, particle: u32) -> Page {
        self.pages[(particle / PAGE) as usize]
    }

    /// Whether a grain has an entry of its own.
    #[inline]
    pub(super) fn has(&self, particle: u32) -> bool {
        self.page(particle).has(particle)
    }

    /// The entry of a grain, if it has one of its own.
    #[inline]
    pub(super) fn own(&mut self, particle: u32) -> Option<&mut T> {
        let page = self.page(particle);
        if page.has(particle) {
            self.entries.get_mut(page.place(particle))
        } else {
            None
        }
    }

    /// The entry of a grain, which has one of its own from now on.
    #[inline]
    pub(super) fn make(&mut self, particle: u32) -> &mut T {
        let mut page = self.page(particle);
        if !page.has(particle) {
            page = self.give(particle);
        }
        &mut self.entries[page.place(particle)]
    }

    /// Makes room for a grain.
    #[cold]
    #[inline(never)]
    fn give(&mut self, particle: u32) -> Page {
        let mut page = self.page(particle);
        if page.members == 0 {
            let start = self.vacant.pop().unwrap_or_else(|| {
                let end = self.entries.len();
                self.entries.extend_from_within(..PAGE as usize);
                end as u32
            });
            page = Page::at(start, particle);
        }
        page.members |= 1 << (particle % PAGE);
        self.pages[(particle / PAGE) as usize] = page;
        page
    }

    /// Takes the entry of a grain away, if it has one of its own.
    pub(super) fn clear(&mut self, particle: u32) {
        let mut page = self.page(particle);
        if !page.has(particle) {
            return;
        }
        self.entries[page.place(particle)] = self.common().clone();
        page.members &= !(1 << (particle % PAGE));
        if page.members == 0 {
            self.vacant
                .push(page.place(particle - particle % PAGE) as u32);
            page = Page::at(COMMON, particle);
        }
        self.pages[(particle / PAGE) as usize] = page;
    }

    /// Who has an entry of their own, in order, and what.
    pub(super) fn each(&self) -> impl Iterator<Item = (u32, &T)> {
        let pages = (0..).step_by(PAGE as usize).zip(&self.pages);
        let used = pages.filter(|(_, page)| page.members != 0);
        let all = used.flat_map(|(first, _)| first..first + PAGE);
        all.filter(|particle| *particle < self.count && self.has(*particle))
            .map(|particle| (particle, &self[particle]))
    }

    /// As it is saved: who has an entry of their own, in order, and what.
    pub(super) fn save(&self) -> Vec<(u32, T)> {
        self.each().map(|(id, entry)| (id, entry.clone())).collect()
    }

    /// As it was saved, for so many grains.
    ///
    /// # Errors
    ///
    /// If it names somebody who is not there, or one twice.
    pub(super) fn restore(
        saved: Vec<(u32, T)>,
        count: usize,
        common: T,
    ) -> Result<Self, &'static str> {
        let mut restored = Sparse::new(count, common);
        for (particle, entry) in saved {
            if particle as usize >= count || restored.has(particle) {
                return Err("a table names a grain that is not there, or one twice");
            }
            *restored.make(particle) = entry;
        }
        Ok(restored)
    }
}

impl<T> Index<u32> for Sparse<T> {
    type Output = T;

    #[inline]
    fn index(&self, particle: u32) -> &T {
        debug_assert!(particle < self.count, "there is no grain {particle}");
        let page = self.pages[(particle / PAGE) as usize];
        &self.entries[page.place(particle)]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        /// Against a table with room for everybody.
        #[test]
        fn nobody_is_mistaken(steps in proptest::collection::vec((0u32..99, 0u32..5), 1..200)) {
            let mut sparse = Sparse::new(70, 0);
            let mut plain = vec![0; 70];
            for (step, (id, kind)) in (1..).zip(steps) {
                let id = id % plain.len() as u32;
                match kind {
                    0 => {
                        sparse.clear(id);
                        plain[id as usize] = 0;
                    }
                    1 => {
                        *sparse.make(id) = step;
                        plain[id as usize] = step;
                    }
                    2 => {
                        prop_assert_eq!(sparse.own(id).is_some(), plain[id as usize] != 0);
                        if let Some(own) = sparse.own(id) {
                            *own += 1;
                            plain[id as usize] += 1;
                        }
                    }
                    3 if plain.len() > 60 => {
                        sparse.pop();
                        plain.pop();
                    }
                    _ => {
                        sparse.push();
                        plain.push(0);
                    }
                }
                let count = plain.len();
                prop_assert_eq!(sparse.len(), count);
                let all: Vec<i32> = (0..count as u32).map(|id| sparse[id]).collect();
                prop_assert_eq!(&all, &plain);
                let again = Sparse::restore(sparse.save(), count, 0).map_err(TestCaseError::fail)?;
                prop_assert_eq!(again.save(), sparse.save());
                // No more room than for everybody.
                let pages = count.div_ceil(PAGE as usize);
                prop_assert!(sparse.entries.len() <= (pages + 2) * PAGE as usize);
            }
            for id in 0..plain.len() as u32 {
                sparse.clear(id);
            }
            prop_assert_eq!(sparse.each().count(), 0);
            prop_assert_eq!((sparse.vacant.len() + 1) * PAGE as usize, sparse.entries.len());
        }
    }

    #[test]
    fn a_table_that_does_not_fit_is_refused() {
        for (ids, fits) in [(&[0, 2][..], true), (&[3], false), (&[1, 1], false)] {
            let saved = ids.iter().map(|id| (*id, 1.0)).collect();
            assert_eq!(Sparse::restore(saved, 3, 0.0).is_ok(), fits);
        }
    }
}
