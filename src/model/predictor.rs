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

/// Finds the first contact of two flights, or of a flight and a wall.
///
/// A contact is the first time the gap is zero **and closing**. An overlap by
/// rounding that closes is a contact at once, one that opens is none. The
/// horizon may only spare work: *it must not change the bits of a contact that
/// is found*, because the engine asks with whatever horizon its book-keeping
/// gives, and the trajectory must not depend on that. Contacts after the
/// horizon may be reported or not.
///
/// The generic type names are: `D` the dimension, `F` the flight.
#[diagnostic::on_unimplemented(
    message = "`{Self}` cannot predict contacts along `{F}` in {D} dimensions",
    note = "a predictor solves one family of flights: choose the one that fits the dynamics"
)]
pub trait Predictor<const D: usize, F: Flight<D>> {
    /// First contact of two grains.
    fn pair(&self, approach: &Approach<D, F>) -> Forecast;

    /// First contact of a grain with a wall.
    fn wall<W: Wall<D>>(&self, encounter: &Encounter<'_, D, F, W>) -> Forecast;
}
