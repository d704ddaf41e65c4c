//! How much is computed.

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Effort {
    /// Seconds: for the tests.
    #[cfg_attr(not(test), expect(dead_code, reason = "for the tests"))]
    Short,
    /// About a minute.
    Quick,
    /// What stands in the book.
    Full,
}

impl Effort {
    pub(super) fn pick<T>(self, short: T, quick: T, full: T) -> T {
        match self {
            Effort::Short => short,
            Effort::Quick => quick,
            Effort::Full => full,
        }
    }
}
