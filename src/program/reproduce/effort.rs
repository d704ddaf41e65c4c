//! How much is simulated.

/// Sizes and lengths of runs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Effort {
    pub(super) quick: bool,
    /// Grains of a deposit.
    pub(super) grains: usize,
    /// V_c of deposits.
    pub(super) elastic_speed: f64,
    /// V_t of the deposits.
    pub(super) thresholds: &'static [f64],
    pub(super) seeds: u64,
    /// From when on the mean number of normal grains is taken.
    pub(super) normal_from: f64,
    /// What is allowed for the packing fraction beside errors, and for exponents:
    /// small deposits are not the paper's.
    pub(super) fraction_allowed: f64,
    pub(super) exponent_allowed: f64,
    /// Grains dropped one by one.
    pub(super) drops: usize,
    /// Grains of a deposit whose cost is followed, and until when without sleep and
    /// with it.
    pub(super) growing: (usize, f64, f64),
    /// Grains of packings made by growth, and rates.
    pub(super) packed: (usize, &'static [f64]),
}

impl Effort {
    /// A few minutes.
    pub(super) fn quick(seeds: Option<u64>) -> Self {
        Effort {
            quick: true,
            grains: 400,
            elastic_speed: 1.0e-3,
            thresholds: &[0.1, 0.05, 0.025],
            seeds: seeds.unwrap_or(2),
            normal_from: 6.0,
            fraction_allowed: 0.03,
            exponent_allowed: 0.4,
            drops: 150,
            growing: (600, 10.0, 24.0),
            packed: (300, &[0.05, 0.02]),
        }
    }

    /// About two hours on two cores.
    pub(super) fn full(seeds: Option<u64>) -> Self {
        Effort {
            quick: false,
            grains: 1500,
            elastic_speed: 1.0e-4,
            thresholds: &[0.1, 0.075, 0.05, 0.035, 0.02, 0.01],
            seeds: seeds.unwrap_or(5),
            normal_from: 20.0,
            fraction_allowed: 0.0,
            exponent_allowed: 0.1,
            drops: 1200,
            growing: (1500, 30.0, 60.0),
            packed: (1000, &[0.1, 0.03, 0.01, 0.003]),
        }
    }
}
