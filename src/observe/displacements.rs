use crate::model::{Observer, Occurrence, OccurrenceKind, Surroundings};
use crate::particle::{Particle, Vector};
use crate::time::Time;

/// How far each grain has come since the start, through periodic faces and all.
///
/// Positions are wrapped into the primary cell; so the flights are added up, from
/// event to event, from the velocities at their two ends. That is exact for
/// grains without a force and for constant gravity. Grains that are inserted
/// later are left out.
#[derive(Clone, Debug)]
pub struct Displacements<const D: usize> {
    tracks: Vec<Track<D>>,
}

#[derive(Clone, Debug)]
struct Track<const D: usize> {
    /// End of the last flight.
    since: Time,
    /// Velocity then.
    velocity: Vector<D>,
    /// Displacement then.
    displacement: Vector<D>,
}

impl<const D: usize> Track<D> {
    /// The displacement at the end of a flight.
    fn at(&self, now: Time, arriving: &Vector<D>) -> Vector<D> {
        self.displacement + (self.velocity + arriving) * (0.5 * (now - self.since))
    }

    fn fly(&mut self, now: Time, arriving: &Vector<D>, leaving: &Vector<D>) {
        self.displacement = self.at(now, arriving);
        self.velocity = *leaving;
        self.since = now;
    }
}

impl<const D: usize> Displacements<D> {
    /// None has moved yet: `grains` as they are `now`, by id.
    #[must_use]
    pub fn new(now: Time, grains: &[Particle<D>]) -> Self {
        let tracks = grains
            .iter()
            .map(|grain| Track {
                since: now,
                velocity: grain.velocity,
                displacement: Vector::zeros(),
            })
            .collect();
        Displacements { tracks }
    }

    /// Displacements, in d, by id, of `grains` as they are `now`.
    #[must_use]
    pub fn at(&self, now: Time, grains: &[Particle<D>]) -> Vec<Vector<D>> {
        self.tracks
            .iter()
            .zip(grains)
            .map(|(track, grain)| track.at(now, &grain.velocity))
            .collect()
    }
}

impl<const D: usize> Observer<D> for Displacements<D> {
    fn observe<S: Surroundings<D>>(&mut self, occurrence: &Occurrence<D>, after: &S) {
        let now = occurrence.time;
        if let Some(track) = self.tracks.get_mut(occurrence.particle.index()) {
            let mass = after.particle(occurrence.particle).mass;
            let arriving = occurrence.velocity - occurrence.impulse / mass;
            track.fly(now, &arriving, &occurrence.velocity);
        }
        let moved = matches!(occurrence.kind, OccurrenceKind::Pair | OccurrenceKind::Wake);
        if let Some(other) = occurrence.other.filter(|_| moved)
            && let Some(track) = self.tracks.get_mut(other.index())
        {
            let arriving = match occurrence.kind {
                // It was at rest, or carried along.
                OccurrenceKind::Wake => track.velocity,
                _ => occurrence.other_velocity + occurrence.impulse / after.particle(other).mass,
            };
            track.fly(now, &arriving, &occurrence.other_velocity);
        }
    }
}
