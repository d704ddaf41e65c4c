//! Built-in state policies: the paper's, and none.

mod never;
mod slow_descent;
mod supports;

pub use never::Never;
pub use slow_descent::{
    Comparison, DescentRead, EnergyStore, Remembered, SlowDescent, SpeedRead, StoreAt, WakeRead,
};
pub use supports::{CheckDue, Phase, SelfCheck};
