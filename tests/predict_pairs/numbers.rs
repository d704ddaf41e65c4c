//! Numbers of all sizes, and meetings made of them.

use grainfall::Vector;
use grainfall::predict::Relative;

/// A sequence of numbers between -1 and 1 from a seed.
pub(crate) struct Numbers(pub(crate) u64);

impl Numbers {
    pub(crate) fn next(&mut self) -> f64 {
        // Splitmix.
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^= z >> 31;
        (z >> 11) as f64 / (1u64 << 52) as f64 - 1.0
    }

    pub(crate) fn vector<const D: usize>(&mut self) -> Vector<D> {
        Vector::<D>::from_fn(|_, _| self.next())
    }

    pub(crate) fn pick(&mut self, of: usize) -> usize {
        ((self.next() + 1.0) * 0.5 * of as f64) as usize
    }

    pub(crate) fn coin(&mut self) -> bool {
        self.next() > 0.0
    }

    /// Between 10^least and 1.
    pub(crate) fn small(&mut self, least: f64) -> f64 {
        libm::exp10(least * 0.5 * (1.0 + self.next()))
    }

    pub(crate) fn direction<const D: usize>(&mut self) -> Vector<D> {
        loop {
            let v = self.vector::<D>();
            if v.norm() > 0.1 {
                return v.normalize();
            }
        }
    }
}

/// Two grains: how the second moves as the first sees it, and when about they
/// meet. Most meet, or graze, or touch already; a few miss.
pub(crate) fn meeting<const D: usize>(
    numbers: &mut Numbers,
    pull: Vector<D>,
    growth: f64,
) -> (Relative<D>, f64) {
    let distance = match numbers.pick(4) {
        0 => 0.05 + 0.01 * numbers.next(),
        1 => 20.0,
        _ => 1.0,
    };
    let growth = growth * distance;
    let time = match numbers.pick(6) {
        0 => 0.0,
        1 => numbers.small(-16.0),
        2 => 30.0 * numbers.small(-2.0),
        _ => numbers.small(-4.0),
    };
    let normal: Vector<D> = numbers.direction();
    let mut along: Vector<D> = numbers.vector();
    along *= match numbers.pick(4) {
        0 => 100.0 * numbers.small(-14.0),
        _ => 2.0,
    };
    let closing = match numbers.pick(4) {
        0 => 0.0,
        1 => numbers.small(-16.0),
        2 => -numbers.small(-16.0),
        _ => numbers.next(),
    };
    let then = along - normal * (normal.dot(&along) + closing - growth);
    let gap = match numbers.pick(3) {
        0 => distance * 1.0e-4 * numbers.next() * numbers.small(-13.0),
        _ => 0.0,
    };
    let velocity = then - pull * time;
    let place = normal * (distance + growth * time + gap);
    let relative = Relative {
        offset: place - velocity * time - pull * (0.5 * time * time),
        velocity,
        acceleration: pull,
        distance,
        growth,
    };
    (relative, time)
}
