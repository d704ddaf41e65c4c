//! Colours that can be told apart by people who see fewer of them.

/// Red, green, blue.
pub type Colour = [u8; 3];

/// Colours of the series of a chart, one after the other: those of Okabe & Ito,
/// *Color Universal Design*, 2008, without yellow, which is too pale for lines.
pub const SERIES_COLOURS: [Colour; 7] = [
    [0x00, 0x72, 0xb2],
    [0xd5, 0x5e, 0x00],
    [0x00, 0x9e, 0x73],
    [0xcc, 0x79, 0xa7],
    [0x56, 0xb4, 0xe9],
    [0xe6, 0x9f, 0x00],
    [0x22, 0x22, 0x22],
];

/// What lies on the way from dark to light, at equal distances.
const SEQUENCE: [Colour; 9] = [
    [0x0b, 0x10, 0x3d],
    [0x2c, 0x1e, 0x70],
    [0x44, 0x3c, 0x99],
    [0x3f, 0x68, 0xae],
    [0x35, 0x8f, 0xaf],
    [0x3d, 0xb2, 0x9f],
    [0x79, 0xcf, 0x7d],
    [0xbf, 0xe2, 0x66],
    [0xfb, 0xf2, 0x8a],
];

/// The colour of a share from 0 (dark) to 1 (light) of the way; what lies
/// outside, or is not a number, has the colour of the nearer end or of 0.
#[must_use]
pub fn sequential(share: f64) -> Colour {
    let last = SEQUENCE.len() - 1;
    let place = share.clamp(0.0, 1.0) * last as f64;
    // Not a number becomes 0.
    let below = (place as usize).min(last - 1);
    let part = if place.is_nan() {
        0.0
    } else {
        place - below as f64
    };
    std::array::from_fn(|channel| {
        let from = f64::from(SEQUENCE[below][channel]);
        let to = f64::from(SEQUENCE[below + 1][channel]);
        (from + (to - from) * part).round() as u8
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_sequence_grows_lighter_all_the_way() {
        // Relative luminance, without the gamma: green counts most.
        let light = |share| {
            let [red, green, blue] = sequential(share).map(f64::from);
            0.299 * red + 0.587 * green + 0.114 * blue
        };
        for step in 0..100 {
            let share = f64::from(step) / 100.0;
            assert!(light(share + 0.01) > light(share), "{share}");
        }
        assert_eq!(sequential(-3.0), SEQUENCE[0]);
        assert_eq!(sequential(f64::NAN), SEQUENCE[0]);
        assert_eq!(sequential(7.0), SEQUENCE[8]);
        assert_eq!(sequential(0.125), SEQUENCE[1]);
    }
}
