//! Who is near whom.

/// A grain in a cell nearby, and in which image: that of the grid, or one some
/// periods away.
///
/// Images count from the places at which the two are filed, not from where they
/// are stored: so nothing changes when periods are taken off a position.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::engine) struct Link<const D: usize>(u64);

impl<const D: usize> Link<D> {
    /// Each axis has so many binary digits of the image.
    const BITS: u32 = u32::BITS / D as u32;
    const REST: u32 = u32::BITS - Self::BITS;

    #[inline]
    pub(in crate::engine) fn new(particle: u32, image: u32) -> Self {
        Link(u64::from(image) << 32 | u64::from(particle))
    }

    #[inline]
    pub(in crate::engine) fn particle(self) -> u32 {
        self.0 as u32
    }

    /// Zero for the image that lies in the grid.
    #[inline]
    pub(in crate::engine) fn image(self) -> u32 {
        (self.0 >> 32) as u32
    }

    /// How `particle`, next to which this was found, is found next to this.
    #[inline]
    pub(in crate::engine) fn seen_from(self, particle: u32) -> Self {
        let image = match self.image() {
            0 => 0,
            image => Self::image_of(&Self::turns_of(image).map(|turns| -turns)),
        };
        Link::new(particle, image)
    }

    /// The periods to add along each axis.
    #[inline]
    pub(in crate::engine) fn turns_of(image: u32) -> [i32; D] {
        if image == 0 {
            return [0; D];
        }
        std::array::from_fn(|axis| {
            let above = Self::REST - Self::BITS * axis as u32;
            (image << above) as i32 >> Self::REST
        })
    }

    /// The image that many periods away: no list reaches as far as the 2⁹ along
    /// each axis, in space, that have a name.
    #[inline]
    pub(in crate::engine) fn image_of(turns: &[i32; D]) -> u32 {
        (0..D).fold(0, |image, axis| {
            image | Self::part(turns[axis]) << (Self::BITS * axis as u32)
        })
    }

    /// The digits for so many periods along the first axis.
    #[inline]
    pub(in crate::engine) fn part(turns: i32) -> u32 {
        turns as u32 & (u32::MAX >> Self::REST)
    }

    /// Where the digits of an axis begin.
    #[inline]
    pub(in crate::engine) fn place(axis: usize) -> u32 {
        Self::BITS * axis as u32
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn check<const D: usize>(most: i32) {
        for step in 0..2000 {
            let turns: [i32; D] = std::array::from_fn(|axis| {
                (step * (17 + 10 * axis as i32)).rem_euclid(2 * most + 1) - most
            });
            let image = Link::<D>::image_of(&turns);
            assert_eq!(Link::<D>::turns_of(image), turns);
            let back = Link::<D>::new(3, image).seen_from(7);
            assert_eq!(back.particle(), 7);
            assert_eq!(Link::<D>::turns_of(back.image()), turns.map(|x| -x));
            assert_eq!(back.seen_from(3), Link::new(3, image));
        }
    }

    #[test]
    fn an_image_says_where() {
        check::<1>(100_000);
        check::<2>(30_000);
        check::<3>(511);
    }
}
