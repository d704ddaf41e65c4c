//! Integrals by quadrature, for tests.

/// ∫ f(u) du from 0 to 1 by Simpson's rule, with an even number of steps.
pub(super) fn simpson(steps: u32, f: impl Fn(f64) -> f64) -> f64 {
    let sum: f64 = (0..=steps)
        .map(|step| {
            let weight = match step {
                0 => 1.0,
                s if s == steps => 1.0,
                s if s % 2 == 1 => 4.0,
                _ => 2.0,
            };
            weight * f(f64::from(step) / f64::from(steps))
        })
        .sum();
    sum / (3.0 * f64::from(steps))
}
