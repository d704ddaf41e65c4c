//! The mean number of normal grains while a deposit grows.

use serde::{Deserialize, Serialize};

use crate::model::{Observer, Occurrence, OccurrenceKind, Surroundings};
use crate::particle::{Mode, Particle};
use crate::time::Time;

/// The mean is taken up to this share of the last landing.
const UP_TO: f64 = 0.8;
/// It begins at this share of the last landing if nothing else is asked for.
const FROM: f64 = 0.25;

/// Integrates the number of normal grains over time and keeps the integral at
/// each landing, that is, at the first collision of each falling grain.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(super) struct NormalMean {
    /// By id: still falling.
    falling: Vec<bool>,
    left: usize,
    normal: i64,
    since: Time,
    integral: f64,
    /// Times and integrals.
    landings: Vec<(f64, f64)>,
}

impl NormalMean {
    pub(super) fn new<const D: usize>(grains: &[Particle<D>], now: Time) -> Self {
        let mut mean = NormalMean {
            falling: Vec::with_capacity(grains.len()),
            left: 0,
            normal: 0,
            since: now,
            integral: 0.0,
            landings: vec![(now.units(), 0.0)],
        };
        for grain in grains {
            mean.add(grain, now);
        }
        mean
    }

    /// One more grain, from now on.
    pub(super) fn add<const D: usize>(&mut self, grain: &Particle<D>, now: Time) {
        let falls = grain.mode == Mode::Falling;
        self.falling.push(falls);
        self.left += usize::from(falls);
        if grain.mode == Mode::Normal {
            self.change(1, now);
        }
    }

    /// Whether this can be a mean over `grains` grains; one that was read from a
    /// file may be anything.
    pub(super) fn is_of(&self, grains: usize) -> bool {
        let falling = self.falling.iter().filter(|falls| **falls).count();
        self.falling.len() == grains
            && self.left == falling
            && self.normal.unsigned_abs() <= grains as u64
            && !self.landings.is_empty()
    }

    /// How many grains have landed.
    pub(super) fn landed(&self) -> usize {
        self.landings.len() - 1
    }

    fn change(&mut self, by: i64, now: Time) {
        self.integral += self.normal as f64 * (now - self.since);
        self.since = now;
        self.normal += by;
    }

    fn land(&mut self, id: usize, now: Time) {
        if std::mem::replace(&mut self.falling[id], false) {
            self.change(1, now);
            self.left -= 1;
            self.landings.push((now.units(), self.integral));
        }
    }

    /// The mean from `from`, or from a quarter of the last landing, up to 0.8
    /// of the last landing; `None` if nothing has fallen, not everything has
    /// landed, or no time lies between.
    pub(super) fn mean(&self, from: Option<f64>) -> Option<f64> {
        let (last, _) = *self.landings.last()?;
        let from = from.unwrap_or(FROM * last);
        let to = UP_TO * last;
        if self.left > 0 || self.landed() == 0 || to <= from {
            return None;
        }
        Some((self.integral_at(to) - self.integral_at(from)) / (to - from))
    }

    /// The integral at a time, interpolated between landings.
    fn integral_at(&self, time: f64) -> f64 {
        let after = self
            .landings
            .partition_point(|(landing, _)| *landing <= time)
            .clamp(1, self.landings.len() - 1);
        let (earlier, low) = self.landings[after - 1];
        let (later, high) = self.landings[after];
        if later <= earlier {
            return high;
        }
        low + (high - low) * ((time - earlier) / (later - earlier)).clamp(0.0, 1.0)
    }
}

impl<const D: usize> Observer<D> for NormalMean {
    fn observe<S: Surroundings<D>>(&mut self, event: &Occurrence<D>, _: &S) {
        match event.kind {
            OccurrenceKind::Guard => {}
            OccurrenceKind::Sleep => self.change(-1, event.time),
            OccurrenceKind::CheckWake => self.change(1, event.time),
            OccurrenceKind::Wake => {
                self.land(event.particle.index(), event.time);
                self.change(1, event.time);
            }
            OccurrenceKind::Pair | OccurrenceKind::Frozen | OccurrenceKind::Wall => {
                self.land(event.particle.index(), event.time);
                if let (OccurrenceKind::Pair, Some(other)) = (event.kind, event.other) {
                    self.land(other.index(), event.time);
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::particle::Vector;

    fn grains(count: usize) -> Vec<Particle<2>> {
        let falling = Particle::new(Vector::<2>::zeros(), Vector::<2>::zeros());
        vec![falling.with_mode(Mode::Falling); count]
    }

    #[test]
    fn one_landing_a_unit_of_time() {
        // With n grains landed at times 1 … 10 and none asleep the integral is
        // that of a staircase: between 2.5 and 8 it is 0.5·2 + 3 + 4 + 5 + 6 + 7.
        let mut mean = NormalMean::new(&grains(10), Time::ZERO);
        assert_eq!(mean.mean(None), None);
        for id in 0..10 {
            mean.land(id, Time::from_units(id as f64 + 1.0));
        }
        assert_eq!(mean.landed(), 10);
        assert!((mean.mean(None).unwrap() - 26.0 / 5.5).abs() < 1.0e-12);
        assert!((mean.mean(Some(5.0)).unwrap() - 18.0 / 3.0).abs() < 1.0e-12);
        assert_eq!(mean.mean(Some(9.0)), None);
    }

    #[test]
    fn without_rain_there_is_no_mean() {
        let normal = [Particle::new(Vector::<2>::zeros(), Vector::<2>::zeros())];
        let mut mean = NormalMean::new(&normal, Time::ZERO);
        mean.change(-1, Time::from_units(3.0));
        assert_eq!(mean.mean(None), None);
    }
}
