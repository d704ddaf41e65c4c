//! Judges an answer by exact integers.

use crate::exact::{Exact, Verdict};
use grainfall::model::{Approach, Forecast, PolynomialFlight};
use grainfall::predict::{Arithmetic, GapPolynomial, pair};

/// A contact is late by no more than the last digit of its time, and what
/// double-double can't see of the gap: 2⁻⁹⁶ of its size S.
const WIDE: f64 = 1.262_177_448_353_619e-29;

/// Gap at the reported contact, in last digits of the contact distance, beside
/// what the grains cover in half the last digit of the time.
const MOST_GAP: f64 = 1.0e-6;

/// What a run has seen.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Tally {
    pub(crate) inputs: u64,
    pub(crate) contacts: u64,
    pub(crate) wide: u64,
    pub(crate) ties: u64,
    /// Largest |gap| in ulp(σ) at a contact of two that were apart before and
    /// have come nearer by σ or less at the speed of the contact.
    pub(crate) gap: f64,
    /// Of all that were apart, less what an ulp of time makes of it.
    pub(crate) gap_beyond_time: f64,
    /// Largest lateness, in ulp(t).
    pub(crate) late: f64,
    /// Latest answers that are late by more than two ulp(t): by how much of
    /// what is allowed.
    pub(crate) late_wide: f64,
}

impl Tally {
    pub(crate) fn add(&mut self, other: &Tally) {
        self.inputs += other.inputs;
        self.contacts += other.contacts;
        self.wide += other.wide;
        self.ties += other.ties;
        self.gap = self.gap.max(other.gap);
        self.gap_beyond_time = self.gap_beyond_time.max(other.gap_beyond_time);
        self.late = self.late.max(other.late);
        self.late_wide = self.late_wide.max(other.late_wide);
    }
}

/// A time after which no root of f can lie, nearly always far after it.
pub(crate) fn after_all<const D: usize>(gap: &GapPolynomial<f64>) -> f64 {
    let [.., c4] = gap.coefficients;
    let (place, motion) = (gap.place_scale, gap.motion_scale);
    let bound = if c4 > 0.0 {
        libm::cbrt(motion / c4).max((motion / c4).sqrt()) + (place / c4).sqrt().sqrt()
    } else if motion > 0.0 {
        1.0e4 * (place / motion).sqrt()
    } else {
        1.0
    };
    (1.0e3 * bound).clamp(1.0e-30, 1.0e60)
}

pub(crate) struct Case<'a, F> {
    pub(crate) exact: &'a Exact,
    /// S, f′ and the size of f″/2 at a time.
    pub(crate) size: F,
    pub(crate) sigma: f64,
    pub(crate) horizon: f64,
    pub(crate) last: f64,
}

/// Panics if a contact was missed, came late, or is none.
pub(crate) fn judge<F: Fn(f64) -> [f64; 3]>(
    case: &Case<'_, F>,
    answer: Option<f64>,
    tally: &mut Tally,
    context: &dyn Fn() -> String,
) {
    let exact = case.exact;
    let Some(t) = answer else {
        let end = case.horizon.min(case.last);
        match exact.contact_until(end) {
            Verdict::Free => {}
            Verdict::Tie => tally.ties += 1,
            Verdict::Contact => panic!("missed: {}", context()),
        }
        return;
    };
    tally.contacts += 1;
    let [size, slope, bend] = (case.size)(t);
    // Near a double root f is flat over a time of √(f/f″).
    let flat = (WIDE * size * bend).sqrt();
    let allowed = WIDE * size / slope.abs().max(flat).max(f64::MIN_POSITIVE);
    let ulp = t.next_up() - t;
    // How late is it?
    let mut late = 0.0;
    let free = |end: f64, tally: &mut Tally| {
        end <= 0.0
            || match exact.contact_until(end) {
                Verdict::Free => true,
                Verdict::Contact => false,
                Verdict::Tie => {
                    tally.ties += 1;
                    true
                }
            }
    };
    while !free(t - late, tally) {
        late = if late == 0.0 { ulp } else { 2.0 * late };
        assert!(
            late <= 2.0 * (ulp + allowed),
            "late by {late:e}, {ulp:e} and {allowed:e} are allowed: {}",
            context()
        );
    }
    if late <= 2.0 * ulp {
        tally.late = tally.late.max(late / ulp);
    } else {
        tally.late_wide = tally.late_wide.max(late / (ulp + allowed));
    }
    // And is it one? The gap is zero to the last digits …
    let digit = case.sigma.next_up() - case.sigma;
    let gap = exact.value(t).abs() / (2.0 * case.sigma);
    let by_time = slope.abs() * ulp / (2.0 * case.sigma);
    let beyond = ((gap - by_time) / digit).max(0.0);
    // (An overlap at the start is not the predictor's doing.)
    let start = exact.value(0.0).min(0.0).abs() / (2.0 * case.sigma);
    if start == 0.0 {
        tally.gap_beyond_time = tally.gap_beyond_time.max(beyond);
        if slope.abs() * t <= 2.0 * case.sigma * case.sigma {
            tally.gap = tally.gap.max(gap / digit);
        }
    }
    assert!(
        gap <= by_time + MOST_GAP * digit + start + WIDE * size,
        "gap {gap:e} of which {by_time:e} by time: {}",
        context()
    );
    // … and closing next to it.
    let soon = t + 4.0 * (ulp + allowed);
    match exact.contact_until(soon) {
        Verdict::Contact => {}
        Verdict::Tie => tally.ties += 1,
        Verdict::Free => panic!("no contact next to {t:e}: {}", context()),
    }
}

/// Checks one approach, with an open and with a finite horizon.
pub(crate) fn check<const D: usize, F: PolynomialFlight<D> + std::fmt::Debug>(
    approach: &Approach<D, F>,
    horizon: f64,
    tally: &mut Tally,
) {
    tally.inputs += 1;
    let exact = Exact::pair(approach);
    let gap = GapPolynomial::<f64>::between(approach);
    for horizon in [f64::INFINITY, horizon] {
        let approach = Approach {
            horizon,
            ..*approach
        };
        let (forecast, arithmetic) = pair(&approach);
        let answer = match forecast {
            Forecast::Never => None,
            Forecast::Contact(time) => Some(time),
            Forecast::AskAgain(_) => panic!("a pair can always be settled: {approach:?}"),
        };
        if horizon == f64::INFINITY && arithmetic == Arithmetic::Wide {
            tally.wide += 1;
        }
        let case = Case {
            exact: &exact,
            size: |t| [gap.size(t), gap.slope(t), gap.half_curvature(t).abs()],
            sigma: approach.distance,
            horizon,
            last: after_all::<D>(&gap),
        };
        judge(&case, answer, tally, &|| {
            format!("{approach:?} answered {answer:?}")
        });
    }
}
