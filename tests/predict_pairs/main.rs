//! What the predictor says of pairs: contacts, and bounds on them.

mod bounds;
mod by_hand;
mod numbers;
