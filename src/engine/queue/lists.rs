//! Lists of ids in one pool of memory: added to, and emptied.

const NONE: u32 = u32::MAX;
/// Ids kept together, so that they fill half a cache line with the rest.
const FEW: usize = 6;

/// Some of the ids on a list.
#[derive(Clone, Copy, Debug)]
#[repr(align(32))]
struct Leaf {
    ids: [u32; FEW],
    count: u32,
    /// Where those are that were added before.
    next: u32,
}

/// Some of the ids that were on a list.
#[derive(Clone, Copy, Debug)]
pub(super) struct Few(Leaf);

impl Few {
    #[inline]
    pub(super) fn ids(&self) -> &[u32] {
        self.0.ids.get(..self.0.count as usize).unwrap_or_default()
    }
}

/// Lists of ids.
#[derive(Clone, Debug)]
pub(super) struct Lists {
    /// The leaf of each list that was added last.
    heads: Vec<u32>,
    leaves: Vec<Leaf>,
    /// The first of the leaves that are not in use.
    free: u32,
}

/// What is left of a list that has been emptied.
#[derive(Clone, Copy, Debug)]
pub(super) struct Rest(u32);

impl Lists {
    /// So many, all of them empty.
    pub(super) fn new(count: usize) -> Self {
        Lists {
            heads: vec![NONE; count],
            leaves: Vec::new(),
            free: NONE,
        }
    }

    /// How many lists there are.
    #[inline]
    pub(super) fn len(&self) -> usize {
        self.heads.len()
    }

    /// How many leaves there are, in use or not.
    #[inline]
    pub(super) fn leaves(&self) -> usize {
        self.leaves.len()
    }

    #[inline]
    pub(super) fn add(&mut self, list: u32, id: u32) {
        let head = self.heads[list as usize];
        if let Some(leaf) = self.leaves.get_mut(head as usize)
            && let Some(room) = leaf.ids.get_mut(leaf.count as usize)
        {
            *room = id;
            leaf.count += 1;
            return;
        }
        let mut leaf = Leaf {
            ids: [NONE; FEW],
            count: 1,
            next: head,
        };
        leaf.ids[0] = id;
        if let Some(place) = self.leaves.get_mut(self.free as usize) {
            self.heads[list as usize] = self.free;
            self.free = place.next;
            *place = leaf;
        } else {
            self.heads[list as usize] = self.leaves.len() as u32;
            self.leaves.push(leaf);
        }
    }

    /// All ids on a list.
    pub(super) fn each(&self, list: u32) -> impl Iterator<Item = u32> {
        let leaf = |place: u32| self.leaves.get(place as usize);
        let leaves =
            std::iter::successors(leaf(self.heads[list as usize]), move |it| leaf(it.next));
        leaves.flat_map(|leaf| leaf.ids[..leaf.count as usize].iter().copied())
    }

    /// Empties a list: what was on it is told by [`next`](Self::next).
    #[inline]
    pub(super) fn take(&mut self, list: u32) -> Rest {
        Rest(std::mem::replace(&mut self.heads[list as usize], NONE))
    }

    /// Some of the ids that were on a list.
    #[inline]
    pub(super) fn next(&mut self, rest: &mut Rest) -> Option<Few> {
        let leaf = self.leaves.get_mut(rest.0 as usize)?;
        let few = Few(*leaf);
        let place = std::mem::replace(&mut rest.0, leaf.next);
        leaf.next = std::mem::replace(&mut self.free, place);
        Some(few)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        /// Against a vector for each, and in no more room than they need at most.
        #[test]
        fn ids_come_back(steps in proptest::collection::vec((0u32..4, 0u32..9), 1..300)) {
            let mut lists = Lists::new(4);
            let mut plain = vec![Vec::new(); 4];
            let mut most = 0;
            for (id, (list, kind)) in (0..).zip(steps) {
                if kind == 0 {
                    let mut rest = lists.take(list);
                    let mut ids: Vec<u32> = Vec::new();
                    while let Some(few) = lists.next(&mut rest) {
                        ids.extend(few.ids());
                    }
                    ids.sort_unstable();
                    prop_assert_eq!(ids, std::mem::take(&mut plain[list as usize]));
                } else {
                    lists.add(list, id);
                    plain[list as usize].push(id);
                }
                for (list, plain) in (0..).zip(&plain) {
                    let mut ids = lists.each(list).collect::<Vec<u32>>();
                    ids.sort_unstable();
                    prop_assert_eq!(&ids, plain);
                }
                most = most.max(plain.iter().map(|ids| ids.len().div_ceil(FEW)).sum());
                prop_assert!(lists.leaves.len() <= most);
            }
        }
    }
}
