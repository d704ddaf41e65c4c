//! Answers of the predictor against exact integers.

use crate::exact::{Exact, Verdict};
use crate::{KINDS, across, direction, input, magnitude, parabolas, uniform};
use grainfall::boundary::Plane;
use grainfall::dynamics::{Parabola, Straight};
use grainfall::model::{Approach, Encounter, Forecast, PolynomialFlight, Predictor};
use grainfall::predict::{
    Arithmetic, Descent, GapPolynomial, Polynomial, Relative, pair, quartic_descent,
};
use grainfall::{Time, Vector};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

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
fn after_all<const D: usize>(gap: &GapPolynomial<f64>) -> f64 {
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

struct Case<'a, F> {
    exact: &'a Exact,
    /// S, f′ and the size of f″/2 at a time.
    size: F,
    sigma: f64,
    horizon: f64,
    last: f64,
}

/// Panics if a contact was missed, came late, or is none.
fn judge<F: Fn(f64) -> [f64; 3]>(
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
fn check<const D: usize, F: PolynomialFlight<D> + std::fmt::Debug>(
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

/// Moves a pair to some place in a box, the second by a period.
fn displaced<const D: usize>(
    approach: Approach<D, Parabola<D>>,
    rng: &mut ChaCha8Rng,
) -> Approach<D, Parabola<D>> {
    let mut moved = approach;
    let size = magnitude(rng, 0.0, 3.0);
    let base = direction::<D>(rng) * size;
    let drift = direction::<D>(rng) * magnitude(rng, -3.0, 1.0);
    if rng.random::<f64>() < 0.7 {
        moved.shift[0] = if rng.random() { size } else { -size };
    }
    for flight in [&mut moved.first, &mut moved.second] {
        flight.position += base;
        flight.velocity += drift;
    }
    moved.second.position -= moved.shift;
    moved
}

const MORE_KINDS: usize = KINDS + 6;

/// One of the inputs of the other tests, or a nastier one.
fn nasty<const D: usize>(kind: usize, rng: &mut ChaCha8Rng) -> Approach<D, Parabola<D>> {
    let up = Vector::<D>::from_fn(|axis, _| if axis + 1 == D { 1.0 } else { 0.0 });
    let plain = |relative: &Relative<D>, touching| parabolas(relative, touching, f64::INFINITY);
    if kind < KINDS {
        let (relative, touching) = input::<D>(kind, rng);
        return plain(&relative, touching);
    }
    match kind - KINDS {
        // Far from the origin, through a periodic side.
        0 => {
            let (relative, touching) = input::<D>(rng.random_range(0..KINDS), rng);
            displaced(plain(&relative, touching), rng)
        }
        // Huge and tiny speeds.
        1 => {
            let (mut relative, touching) = input::<D>(rng.random_range(0..KINDS), rng);
            let factor = magnitude(rng, -24.0, 24.0);
            relative.velocity *= factor;
            relative.growth *= factor;
            if rng.random() {
                relative.acceleration *= factor;
            }
            plain(&relative, touching)
        }
        // A double root: the distance is the closest approach, to a few digits.
        2 => {
            let (mut relative, _) = input::<D>(2, rng);
            let (r, v, a) = (relative.offset, relative.velocity, relative.acceleration);
            let place = |t: f64| (r + (v + a * (0.5 * t)) * t).norm();
            let (mut low, mut high) = (0.0, 6.0);
            for _ in 0..200 {
                let (one, two) = (low + (high - low) * 0.45, low + (high - low) * 0.55);
                if place(one) < place(two) {
                    high = two;
                } else {
                    low = one;
                }
            }
            relative.distance = place(low);
            for _ in 0..rng.random_range(0..5) {
                relative.distance = if rng.random() {
                    relative.distance.next_up()
                } else {
                    relative.distance.next_down()
                };
            }
            plain(&relative, false)
        }
        // Near a root of order four: over the top with the curvature of the grain.
        3 => {
            let distance = uniform(rng, 0.5, 1.5);
            let normal = direction::<D>(rng);
            let sideways = across(&normal, rng);
            let mut small =
                |low, high| magnitude(rng, low, high) * if rng.random() { 1.0 } else { -1.0 };
            let speed = distance.sqrt() * (1.0 + small(-17.0, -4.0));
            let relative = Relative {
                offset: normal * (distance * (1.0 + small(-18.0, -8.0))),
                velocity: sideways * speed + normal * small(-18.0, -6.0),
                acceleration: -normal,
                distance,
                growth: 0.0,
            };
            plain(&relative, rng.random())
        }
        // Round numbers: exact ties, grazes and contacts at whole times.
        4 => {
            let mut whole = |n: i32| f64::from(rng.random_range(-n..=n));
            let mut vector = |n: i32| Vector::<D>::from_fn(|_, _| whole(n) / 4.0);
            let relative = Relative {
                offset: vector(12),
                velocity: vector(8),
                acceleration: vector(3),
                distance: 1.25,
                growth: 0.0,
            };
            plain(&relative, rng.random::<f64>() < 0.3)
        }
        // Nearly the same acceleration.
        _ => {
            let (mut relative, touching) = input::<D>(rng.random_range(0..KINDS), rng);
            relative.acceleration = direction::<D>(rng) * magnitude(rng, -18.0, -3.0);
            if rng.random() {
                relative.velocity = up * magnitude(rng, -6.0, 0.0);
            }
            plain(&relative, touching)
        }
    }
}

fn straight<const D: usize>(approach: &Approach<D, Parabola<D>>) -> Approach<D, Straight<D>> {
    let of = |flight: &Parabola<D>| Straight {
        position: flight.position,
        velocity: flight.velocity,
    };
    Approach {
        first: of(&approach.first),
        second: of(&approach.second),
        shift: approach.shift,
        distance: approach.distance,
        growth: approach.growth,
        touching: approach.touching,
        horizon: approach.horizon,
    }
}

/// Pairs of one kind, from the generator's stream of that number.
pub(crate) fn pairs<const D: usize>(kind: usize, seed: u64, count: u64) -> Tally {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    rng.set_stream(kind as u64);
    let mut tally = Tally::default();
    for _ in 0..count {
        let approach = nasty::<D>(kind, &mut rng);
        let horizon = magnitude(&mut rng, -6.0, 3.0);
        let relative = Relative::of(&approach);
        if relative.acceleration == Vector::<D>::zeros() && rng.random() {
            check(&straight(&approach), horizon, &mut tally);
        } else {
            check(&approach, horizon, &mut tally);
        }
    }
    tally
}

/// Flat walls, across an axis or aslant.
pub(crate) fn walls<const D: usize>(seed: u64, count: u64) -> Tally {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let mut tally = Tally::default();
    let rng = &mut rng;
    for _ in 0..count {
        tally.inputs += 1;
        let mut normal = direction::<D>(rng);
        if rng.random::<f64>() < 0.7 {
            normal = Vector::zeros();
            normal[rng.random_range(0..D)] = if rng.random() { 1.0 } else { -1.0 };
        }
        let offset = uniform(rng, -1.0, 1.0) * magnitude(rng, -1.0, 3.0);
        let radius = uniform(rng, 0.25, 1.0);
        let growth = if rng.random::<f64>() < 0.2 {
            uniform(rng, 0.0, 0.5)
        } else {
            0.0
        };
        let gap = if rng.random() {
            uniform(rng, 0.0, 2.0)
        } else {
            magnitude(rng, -18.0, 1.0)
        };
        let gap = if rng.random::<f64>() < 0.15 {
            -gap
        } else {
            gap
        };
        let mut velocity = direction::<D>(rng) * magnitude(rng, -9.0, 2.0);
        let mut acceleration = direction::<D>(rng);
        match rng.random_range(0..4) {
            0 => acceleration = Vector::zeros(),
            // Away from the wall, turning round at it but for a hair.
            1 => {
                acceleration = normal * uniform(rng, 0.5, 1.5);
                let pull = acceleration.norm();
                let hair = 1.0 + uniform(rng, -4.0, 4.0) * f64::EPSILON;
                velocity -=
                    normal * (velocity.dot(&normal) + (2.0 * gap.abs() * pull).sqrt() * hair);
            }
            2 => acceleration = -normal * magnitude(rng, -3.0, 1.0),
            _ => {}
        }
        let place = across(&normal, rng) * magnitude(rng, -1.0, 3.0);
        let flight = Parabola {
            position: normal * (offset + radius + gap) + place,
            velocity,
            acceleration,
        };
        let wall = Plane {
            normal,
            offset,
            restitution: 1.0,
        };
        let touching = rng.random::<f64>() < 0.2;
        let exact = Exact::plane(&flight, &normal, [offset, radius, growth], touching);
        let scales = [
            flight.position.norm() + offset.abs() + radius,
            velocity.norm() + growth,
            acceleration.norm(),
        ];
        let slope = |t: f64| normal.dot(&(velocity + acceleration * t)) - growth;
        for horizon in [f64::INFINITY, magnitude(rng, -6.0, 3.0)] {
            let encounter = Encounter {
                flight,
                wall: &wall,
                since: Time::ZERO,
                radius,
                growth,
                touching,
                horizon,
            };
            let answer = match Polynomial.wall(&encounter) {
                Forecast::Never => None,
                Forecast::Contact(time) => Some(time),
                Forecast::AskAgain(_) => panic!("a flat wall can always be settled"),
            };
            let case = Case {
                exact: &exact,
                size: |t: f64| {
                    let size = scales[0] + t * (scales[1] + t * scales[2]);
                    [size, slope(t), 0.5 * scales[2]]
                },
                // A gap of lengths, not of squares.
                sigma: 0.5,
                horizon,
                last: 1.0e12,
            };
            judge(&case, answer, &mut tally, &|| {
                format!("{flight:?} {wall:?} {radius} {growth} {touching} {horizon}: {answer:?}")
            });
        }
    }
    tally
}

/// So many of every kind in two and three dimensions, and of walls.
fn all(seed: u64, each: u64) {
    let mut total = Tally::default();
    let show = |name: &str, tally: &Tally| {
        println!(
            "{name:>12} {:>9} contacts {:>9} wide {:>7.3} % ties {:>6} gap {:.2e} ulp(σ), beyond time {:.1e}, late {:.1} ulp(t), wide {:.2}",
            tally.inputs,
            tally.contacts,
            100.0 * tally.wide as f64 / tally.inputs as f64,
            tally.ties,
            tally.gap,
            tally.gap_beyond_time,
            tally.late,
            tally.late_wide
        );
    };
    for kind in 0..MORE_KINDS {
        let mut tally = pairs::<3>(kind, seed, each);
        tally.add(&pairs::<2>(kind, seed, each / 2));
        show(&format!("kind {kind}"), &tally);
        total.add(&tally);
    }
    let mut tally = walls::<3>(seed, each);
    tally.add(&walls::<2>(seed, each));
    show("walls", &tally);
    total.add(&tally);
    show("all", &total);
}

#[test]
fn no_contact_is_missed_in_exact_integers() {
    all(1, 3000);
}

/// cargo test --release --test predict_reference -- --ignored --nocapture
#[test]
#[ignore = "ten million inputs take many minutes"]
fn no_contact_is_missed_in_ten_million() {
    all(2, 450_000);
}

/// A quartic that comes down to a double root, or nearly, and then falls at
/// another: what a search loses that takes the sign of rounding for the truth.
fn two_dips(rng: &mut ChaCha8Rng) -> GapPolynomial<f64> {
    let mut times = [0.0; 3].map(|_| magnitude(rng, -2.0, 1.0));
    times.sort_by(f64::total_cmp);
    let [graze, hit, out] = times;
    let lift = match rng.random_range(0..4) {
        0 => 0.0,
        1 => magnitude(rng, -18.0, -12.0),
        2 => -magnitude(rng, -18.0, -12.0),
        _ => magnitude(rng, -12.0, 0.0),
    };
    // ((t − graze)² + lift) (t − hit) (t − out), times something.
    let first = [graze * graze + lift, -2.0 * graze, 1.0];
    let second = [hit * out, -(hit + out), 1.0];
    let mut c = [0.0; 5];
    for (i, a) in first.iter().enumerate() {
        for (j, b) in second.iter().enumerate() {
            c[i + j] += a * b;
        }
    }
    let strength = magnitude(rng, -2.0, 2.0);
    let c = c.map(|c| c * strength);
    // Sizes of which such coefficients can be made.
    let motion = (c[3] * c[3] / (4.0 * c[4])).max(c[2].abs());
    GapPolynomial {
        coefficients: c,
        place_scale: c[0].abs().max(c[1] * c[1] / (4.0 * motion)),
        motion_scale: motion,
    }
}

/// The search itself, before anything is refined: f of a margin more has no
/// contact up to the time found.
#[test]
fn the_search_passes_no_contact() {
    let mut rng = ChaCha8Rng::seed_from_u64(3);
    let mut found = 0;
    for _ in 0..40_000 {
        let gap = two_dips(&mut rng);
        let horizon = magnitude(&mut rng, -1.0, 3.0);
        let (end, answer) = match quartic_descent(&gap, false, horizon) {
            Descent::Never => (horizon, None),
            Descent::At(time) => (time, Some(time)),
            // Asked again with more digits.
            Descent::NotBefore(time) => (time, None),
        };
        let lifted = |by: f64| Exact::of_coefficients(gap.coefficients, by * gap.rounding(end));
        let context = || format!("{answer:?} within {horizon} of {gap:?}");
        assert_ne!(
            lifted(4.0).contact_until(end),
            Verdict::Contact,
            "passed one: {}",
            context()
        );
        if let Some(time) = answer {
            found += 1;
            assert!(lifted(-4.0).value(time) <= 0.0, "not there: {}", context());
        }
    }
    assert!(found > 20_000, "{found}");
}
