//! Walking over the images of a periodic box.

/// Calls `visit` for all numbers of periods from `low` to `high` along each axis, the
/// first axis fastest; for none if an axis has none.
pub(super) fn for_each_turns<const D: usize>(
    low: [i32; D],
    high: [i32; D],
    mut visit: impl FnMut([i32; D]),
) {
    if (0..D).any(|axis| low[axis] > high[axis]) {
        return;
    }
    let mut turns = low;
    loop {
        visit(turns);
        let mut axis = 0;
        while axis < D && turns[axis] == high[axis] {
            turns[axis] = low[axis];
            axis += 1;
        }
        if axis == D {
            return;
        }
        turns[axis] += 1;
    }
}
