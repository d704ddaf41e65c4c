use crate::output::Frame;
use crate::particle::{Mode, Particle};

/// Red, green, blue.
pub(super) type Colour = [u8; 3];

/// Shades for normal grains, from slow to fast.
const NORMAL: [Colour; 6] = [
    [0x1d, 0x4f, 0xb8],
    [0x1f, 0x6a, 0xd6],
    [0x2a, 0x86, 0xee],
    [0x1f, 0xa4, 0xf6],
    [0x22, 0xc3, 0xf5],
    [0x4f, 0xe0, 0xf2],
];
const FIXED: Colour = [0x7d, 0x3c, 0x98];
const FROZEN: Colour = [0x1c, 0x24, 0x5e];
const FALLING: Colour = [0xb9, 0xdd, 0xf7];

/// Which colours a frame takes.
#[derive(Clone, Debug)]
pub(super) struct Palette {
    /// The least and the greatest kinetic energy that are told apart, in mgd.
    energies: Option<(f64, f64)>,
}

impl Palette {
    /// Tells normal grains apart between the 5th and the 95th percentile of
    /// their kinetic energies, by its logarithm.
    pub(super) fn of(frame: &Frame) -> Self {
        let mut energies: Vec<f64> = frame
            .grains
            .iter()
            .filter(|grain| grain.mode == Mode::Normal)
            .map(Particle::kinetic_energy)
            .filter(|&energy| energy > 0.0)
            .collect();
        energies.sort_by(f64::total_cmp);
        let at = |share: usize| energies.get(share * energies.len() / 100).copied();
        Palette {
            energies: at(5).zip(at(95)),
        }
    }

    /// The range of kinetic energies, in mgd.
    pub(super) fn energies(&self) -> Option<(f64, f64)> {
        self.energies
    }

    /// The number of a grain's shade in [`Palette::shades`].
    pub(super) fn shade(&self, grain: &Particle<3>) -> usize {
        match grain.mode {
            Mode::Fixed => 0,
            Mode::Frozen => 1,
            Mode::Falling => 2,
            Mode::Normal => 3 + self.level(grain.kinetic_energy()),
        }
    }

    fn level(&self, energy: f64) -> usize {
        let Some((low, high)) = self.energies else {
            return 0;
        };
        if energy <= low || low >= high {
            return 0;
        }
        let share = libm::log(energy / low) / libm::log(high / low);
        ((share * NORMAL.len() as f64) as usize).min(NORMAL.len() - 1)
    }

    /// All colours: fixed, frozen, falling, then normal from slow to fast.
    pub(super) fn shades() -> impl Iterator<Item = Colour> {
        [FIXED, FROZEN, FALLING].into_iter().chain(NORMAL)
    }

    /// The shades of a mode.
    pub(super) fn shades_of(mode: Mode) -> std::ops::Range<usize> {
        match mode {
            Mode::Fixed => 0..1,
            Mode::Frozen => 1..2,
            Mode::Falling => 2..3,
            Mode::Normal => 3..3 + NORMAL.len(),
        }
    }
}

/// A colour nearer to white (`towards` = 255) or black (0) by `share`.
pub(super) fn mixed(colour: Colour, towards: u8, share: f64) -> Colour {
    colour.map(|part| {
        let (part, towards) = (f64::from(part), f64::from(towards));
        (part + (towards - part) * share).round() as u8
    })
}

/// A colour as SVG writes it.
pub(super) fn hex([red, green, blue]: Colour) -> String {
    format!("#{red:02x}{green:02x}{blue:02x}")
}
