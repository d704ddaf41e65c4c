//! When two flights meet.

use crate::model::{Flight, Wall};
use crate::particle::Vector;
use crate::time::Time;

/// Two grains in flight, both counted from the same instant.
#[derive(Clone, Copy, Debug)]
pub struct Approach<const D: usize, F> {
    /// The flight of the one grain.
    pub first: F,
    /// The flight of the other.
    pub second: F,
    /// What to add to the other's position to get the periodic image in
    /// question, in d.
    pub shift: Vector<D>,
    /// Distance of the centres at contact, σ₁₂ = (σ₁ + σ₂)/2, at the start; in d.
    pub distance: f64,
    /// How fast that distance grows, in √(gd); 0 for grains of constant size.
    pub growth: f64,
    /// The two have just collided with each other: the gap is zero now, and
    /// that root is known and has to be divided out, not searched for.
    pub touching: bool,
    /// How far ahead the answer matters, in √(d/g); may be infinite.
    pub horizon: f64,
}

/// A grain in flight and a wall.
#[derive(Clone, Copy, Debug)]
pub struct Encounter<'a, const D: usize, F, W> {
    /// The flight of the grain.
    pub flight: F,
    /// The wall.
    pub wall: &'a W,
    /// The instant the flight starts; walls may move.
    pub since: Time,
    /// Radius of the grain at the start, in d.
    pub radius: f64,
    /// How fast the radius grows, in √(gd).
    pub growth: f64,
    /// The grain has just collided with this wall.
    pub touching: bool,
    /// How far ahead the answer matters, in √(d/g); may be infinite.
    pub horizon: f64,
}

/// How many grains are looked at together.
pub const LANES: usize = 4;

/// What is common to a grain in flight and a few around it.
#[derive(Clone, Copy, Debug)]
pub struct Crowd<const D: usize> {
    /// How long ago the others' flights have begun, in √(d/g).
    pub after: [f64; LANES],
    /// What to add to each other's position to get the image in question, in d;
    /// nothing if all are in the image they are stored in.
    pub shifts: Option<[Vector<D>; LANES]>,
    /// Distances of the centres at contact, now; in d.
    pub distances: [f64; LANES],
    /// How fast these distances grow, over themselves, in √(g/d).
    pub growth: f64,
    /// How far off any of these positions may be, in d.
    pub blur: f64,
    /// How far ahead the answer matters, in √(d/g); may be infinite.
    pub horizon: f64,
}

/// A few grains at rest, as they lie around a point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Resting<const D: usize> {
    /// From the point to their centres, axis by axis, in d.
    pub places: [[f64; LANES]; D],
    /// Their distances of the centres at contact with the grain in question, at
    /// t = 0; in d.
    pub distances: [f64; LANES],
}

/// A grain in flight among grains at rest.
#[derive(Clone, Copy, Debug)]
pub struct Nook<'a, const D: usize, F> {
    /// The flight of the grain.
    pub own: &'a F,
    /// Its centre at the start, from the same point as those of the others.
    pub place: Vector<D>,
    /// The others; at the end, some may be fill-ins whose answers nobody reads.
    pub resting: &'a Resting<D>,
    /// Distances at the start over those at t = 0.
    pub scale: f64,
    /// How fast these distances grow, over themselves, in √(g/d).
    pub growth: f64,
    /// How far off any of these positions may be, in d.
    pub blur: f64,
    /// How far ahead the answer matters, in √(d/g); may be infinite.
    pub horizon: f64,
}

/// The answer to "when is the first contact?". Times count from the start of
/// the flights.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Forecast {
    /// No contact up to the horizon.
    Never,
    /// The first instant at which the gap is zero and closing.
    Contact(f64),
    /// No contact up to this time, which is positive; beyond it the predictor
    /// can't tell yet and wants to be asked again then.
    AskAgain(f64),
}

/// Covers the rounding of a few operations.
const ROUND: f64 = 1.0e-12;

/// How long it takes at least until two centres are that near.
fn wait<const D: usize>(apart: &Vector<D>, distance: f64, closing: f64) -> f64 {
    let gap = apart.norm_squared().sqrt() * (1.0 - ROUND) - distance;
    let wait = gap / closing * (1.0 - ROUND);
    // Not certain of NaN either.
    if wait > 0.0 { wait } else { 0.0 }
}

/// Finds the first contact of two flights, or of a flight and a wall.
///
/// A contact is the first time the gap is zero **and closing**. An overlap by
/// rounding that closes is a contact at once, one that opens is none. The
/// horizon may only spare work: *it must not change the bits of a contact that
/// is found*, because the engine asks with whatever horizon its book-keeping
/// gives, and the trajectory must not depend on that. Contacts after the
/// horizon may be reported or not.
///
/// `examples/own_predictor.rs` shows how to write one; one for other flights is in
/// `examples/own_dynamics.rs`.
///
/// The generic type names are: `D` the dimension, `F` the flight.
#[diagnostic::on_unimplemented(
    message = "`{Self}` cannot predict contacts along `{F}` in {D} dimensions",
    note = "a predictor solves one family of flights: choose the one that fits the dynamics"
)]
pub trait Predictor<const D: usize, F: Flight<D>> {
    /// First contact of two grains.
    fn pair(&self, approach: &Approach<D, F>) -> Forecast;

    /// For each of a few grains a time before which a grain certainly does not
    /// meet it; one beyond the horizon says that it does not up to there.
    ///
    /// Only work depends on the answer, never a trajectory: whoever may come
    /// first is asked for by [`pair`](Predictor::pair), in the order of these
    /// times. So zero is always right. What is provided holds for every flight:
    /// nobody comes nearer than both fly at their highest speeds.
    ///
    /// `own` is the flight of the grain from now on, `other(lane)` that of each
    /// other from its last event on. In the last lot some may be fill-ins whose
    /// answers nobody reads.
    fn not_before(&self, own: &F, other: impl Fn(usize) -> F, crowd: &Crowd<D>) -> [f64; LANES] {
        let own_speed = own.speed_bound(crowd.horizon);
        let here = own.position(0.0);
        std::array::from_fn(|lane| {
            let other = other(lane).advanced(crowd.after[lane]);
            let mut apart = other.position(0.0) - here;
            if let Some(shifts) = &crowd.shifts {
                apart += shifts[lane];
            }
            let distance = crowd.distances[lane];
            let closing = own_speed + other.speed_bound(crowd.horizon) + distance * crowd.growth;
            wait(&apart, distance + crowd.blur, closing)
        })
    }

    /// A time before which a grain that has just collided with one at rest
    /// certainly does not come back to it. Zero, which is provided, is always
    /// right. `own` is its flight from the collision on; `place`, in d, the
    /// centre of the other as seen from its own, then.
    fn not_back_before(&self, _own: &F, _place: &Vector<D>) -> f64 {
        0.0
    }

    /// The acceleration, in g, of a frame in which this flight is uniform, at all
    /// times before and after its start, if there is one: any two flights of one
    /// frame then move uniformly as seen from each other, and the engine tells
    /// bounds on them itself. `None`, which is provided, is always right.
    ///
    /// It must follow from the flight's acceleration alone, and
    /// [`Flight::advanced`] must go back in time as well.
    fn frame(&self, _flight: &F) -> Option<Vector<D>> {
        None
    }

    /// The same as [`not_before`](Predictor::not_before) for grains at rest.
    fn not_before_resting(&self, nook: &Nook<'_, D, F>) -> [f64; LANES] {
        let own_speed = nook.own.speed_bound(nook.horizon);
        std::array::from_fn(|lane| {
            let place = |axis: usize, _| nook.resting.places[axis][lane] - nook.place[axis];
            let distance = nook.resting.distances[lane] * nook.scale;
            let closing = own_speed + distance * nook.growth;
            wait(&Vector::<D>::from_fn(place), distance + nook.blur, closing)
        })
    }

    /// First contact of a grain with a wall.
    fn wall<W: Wall<D>>(&self, encounter: &Encounter<'_, D, F, W>) -> Forecast;
}
