//! What a list that is made anew has gained and lost.

use crate::engine::cells::Link;

/// Places in a table of those on a list.
const TABLE: usize = 256;
/// Nobody.
const NONE: u8 = u8::MAX;

/// Finds out who is on one of two lists alone, in their order.
#[derive(Clone, Debug)]
pub(super) struct Changes<const D: usize> {
    /// On the new list alone.
    pub(super) come: Vec<Link<D>>,
    /// On the old list alone.
    pub(super) gone: Vec<Link<D>>,
}

impl<const D: usize> Changes<D> {
    pub(super) const NONE: Self = Changes {
        come: Vec::new(),
        gone: Vec::new(),
    };

    /// Nobody is on a list twice.
    pub(super) fn find(&mut self, old: &[Link<D>], new: &[Link<D>]) {
        self.come.clear();
        self.gone.clear();
        if old.len() >= usize::from(NONE) {
            self.come
                .extend(new.iter().filter(|link| !old.contains(link)));
            self.gone
                .extend(old.iter().filter(|link| !new.contains(link)));
            return;
        }
        // Where those of an id that ends like this are on the old list: the first of them.
        let mut table = [NONE; TABLE];
        let row = |link: Link<D>| link.particle() as usize % TABLE;
        for (place, link) in (0..).zip(old) {
            let first = &mut table[row(*link)];
            *first = place.min(*first);
        }
        let mut stays = [false; TABLE];
        for link in new {
            let first = table[row(*link)];
            if first == NONE {
                self.come.push(*link);
                continue;
            }
            let first = usize::from(first);
            let rest = old.get(first..).unwrap_or_default();
            match rest.iter().position(|other| other == link) {
                Some(place) => stays[first + place] = true,
                None => self.come.push(*link),
            }
        }
        let all = old.iter().zip(stays);
        self.gone
            .extend(all.filter(|(_, stays)| !stays).map(|(link, _)| link));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// Few ids, so that many end alike, or are there in two images.
    fn list(most: usize) -> impl Strategy<Value = Vec<Link<2>>> {
        proptest::collection::vec((0u32..4, 0u32..200, 0u32..2), 0..most).prop_map(|ids| {
            let mut list = Vec::new();
            for (page, id, image) in ids {
                let link = Link::new(256 * page + id, image);
                if !list.contains(&link) {
                    list.push(link);
                }
            }
            list
        })
    }

    fn on_one_alone(one: &[Link<2>], other: &[Link<2>]) -> Vec<Link<2>> {
        let alone = |link: &&Link<2>| !other.contains(link);
        one.iter().filter(alone).copied().collect()
    }

    proptest! {
        #[test]
        fn who_has_come_and_gone(
            short in list(40), long in list(600), part in 0usize..40, other in list(40),
        ) {
            let mut changes = Changes::NONE;
            let mixed: Vec<_> = short.iter().rev().take(part).chain(
                other.iter().filter(|link| !short.contains(link))).copied().collect();
            for (old, new) in [(&short, &mixed), (&mixed, &short), (&long, &short), (&short, &long), (&long, &long)] {
                changes.find(old, new);
                prop_assert_eq!(&changes.come, &on_one_alone(new, old));
                prop_assert_eq!(&changes.gone, &on_one_alone(old, new));
            }
        }
    }
}
