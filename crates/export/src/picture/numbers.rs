//! Round numbers for scales.

/// A round distance, about `parts` of which make up `farthest`.
pub fn step(farthest: f64, parts: f64) -> f64 {
    if farthest <= 0.0 {
        return 1.0;
    }
    nice(farthest / parts)
}

/// The smallest of 1, 2, 2.5 and 5 times a power of ten that is not below `step`.
pub fn nice(step: f64) -> f64 {
    let power = libm::exp10(libm::log10(step).floor());
    [1.0, 2.0, 2.5, 5.0, 10.0]
        .into_iter()
        .map(|factor| factor * power)
        .find(|nice| *nice >= step * (1.0 - 1e-9))
        .unwrap_or(10.0 * power)
}

/// A round number in few characters.
pub fn short(value: f64) -> String {
    if value != 0.0 && !(1e-3..1e6).contains(&value) {
        return format!("{value:.1e}");
    }
    let text = format!("{value:.6}");
    text.trim_end_matches('0').trim_end_matches('.').to_owned()
}
