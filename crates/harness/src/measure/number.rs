//! Formats numbers for tables and messages.

/// Number of decimals for a row of values: enough for three significant digits of the smallest
/// positive one, and at most `most`.
pub fn decimals(values: impl IntoIterator<Item = f64>, most: u8) -> usize {
    let smallest = values
        .into_iter()
        .filter(|v| *v > 0.0)
        .fold(f64::INFINITY, f64::min);
    let shows_three = |decimals: &u8| smallest * 10_f64.powi(i32::from(*decimals)) >= 100.0;
    usize::from((0..most).find(shows_three).unwrap_or(most))
}

/// Seconds with three significant digits, and at most `most` decimals.
pub fn seconds(seconds: f64, most: u8) -> String {
    if seconds <= 0.0 {
        return "0".to_owned();
    }
    let decimals = decimals([seconds], most);
    format!("{seconds:.decimals$}")
}

/// A time with three significant digits and its unit, from nanoseconds to seconds.
pub fn with_unit(seconds: f64) -> String {
    const UNITS: [(&str, f64); 4] = [("s", 1.0), ("ms", 1e-3), ("\u{b5}s", 1e-6), ("ns", 1e-9)];
    if seconds <= 0.0 {
        return "0 s".to_owned();
    }
    // The bounds are those of rounding: 0.9996 ms is 1.00 ms.
    let mut units = UNITS.into_iter();
    let unit = units.find(|(_, size)| seconds >= 0.9995 * size);
    let (unit, size) = unit.unwrap_or(UNITS[UNITS.len() - 1]);
    let value = seconds / size;
    let bounds = [99.95, 9.995, 0.9995];
    let decimals = bounds.iter().filter(|bound| value < **bound).count();
    format!("{value:.decimals$} {unit}")
}

/// A count with thousands separators.
pub fn grouped(count: u64) -> String {
    group(&count.to_string())
}

/// Inserts thousands separators into a string of `digits`.
pub fn group(digits: &str) -> String {
    let mut text = String::with_capacity(digits.len() + digits.len() / 3);
    for (i, digit) in digits.chars().enumerate() {
        if i > 0 && (digits.len() - i).is_multiple_of(3) {
            text.push(',');
        }
        text.push(digit);
    }
    text
}

/// Ascending numbers with ranges for consecutive ones, such as `1-3,7`.
pub(crate) fn ranges(numbers: &[usize]) -> String {
    let runs = numbers.chunk_by(|a, b| a + 1 == *b);
    let runs = runs.map(|run| match run {
        [first, .., last] => format!("{first}-{last}"),
        _ => run[0].to_string(),
    });
    runs.collect::<Vec<_>>().join(",")
}

/// A ratio with two decimals; without decimals from 100.
pub fn ratio(ratio: f64) -> String {
    if ratio < 99.5 {
        format!("{ratio:.2}")
    } else {
        format!("{ratio:.0}")
    }
}

/// A number in scientific notation with one decimal; 0 as `0`.
pub fn scientific(value: f64) -> String {
    if value == 0.0 {
        "0".to_owned()
    } else {
        format!("{value:.1e}")
    }
}

/// The shortest digits that read back exactly, with an exponent below 1e-6 and from 1e21.
pub fn shortest(value: f64) -> String {
    let is_usual = (1e-6..1e21).contains(&value.abs()) || value == 0.0 || !value.is_finite();
    if is_usual {
        value.to_string()
    } else {
        format!("{value:e}")
    }
}

/// A number with its noun: `1 loop`, `2 loops`, `2 vertices`.
pub fn counted(count: usize, thing: &str) -> String {
    match (count, thing.strip_suffix("ex")) {
        (1, _) => format!("1 {thing}"),
        (_, Some(stem)) => format!("{count} {stem}ices"),
        (_, None) => format!("{count} {thing}s"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn decimals_show_three_digits_of_the_smallest() {
        assert_eq!(decimals([0.329, 1.2], 6), 3);
        assert_eq!(decimals([0.002_13, 0.1], 6), 5);
        assert_eq!(decimals([12.3, 456.0], 6), 1);
        assert_eq!(decimals([1234.0], 6), 0);
        assert_eq!(decimals([1e-9], 6), 6);
        assert_eq!(decimals([0.0], 6), 0);
        assert_eq!(decimals([], 6), 0);
    }

    #[test]
    fn tiny_and_huge_numbers_have_an_exponent() {
        let all = [0.0, 1.0, 2.5, 1e-6, 1e20, f64::INFINITY].map(shortest);
        assert_eq!(
            all,
            ["0", "1", "2.5", "0.000001", "100000000000000000000", "inf"]
        );
        let all = [9e-7, 1e-300, -1.5e-12, 1e21].map(shortest);
        assert_eq!(all, ["9e-7", "1e-300", "-1.5e-12", "1e21"]);
    }

    #[test]
    fn numbers_have_nouns() {
        assert_eq!(counted(1, "face"), "1 face");
        assert_eq!(counted(0, "face"), "0 faces");
        assert_eq!(counted(1, "Voronoi vertex"), "1 Voronoi vertex");
        assert_eq!(counted(2, "vertex"), "2 vertices");
    }

    #[test]
    fn seconds_have_three_digits() {
        assert_eq!(
            [0.0, 1.5e-7, 0.001_234, 0.1, 5.0, 99.94, 1234.7].map(|s| seconds(s, 9)),
            [
                "0",
                "0.000000150",
                "0.00123",
                "0.100",
                "5.00",
                "99.9",
                "1235"
            ]
        );
    }

    #[test]
    fn units_leave_three_digits() {
        assert_eq!(
            [
                0.0, 2.5e-10, 1.5e-7, 0.001_234, 0.099_99, 0.999_6, 99.94, 1234.7
            ]
            .map(with_unit),
            [
                "0 s", "0.250 ns", "150 ns", "1.23 ms", "100 ms", "1.00 s", "99.9 s", "1235 s"
            ]
        );
    }

    #[test]
    fn consecutive_numbers_are_ranges() {
        assert_eq!(ranges(&[1, 2, 3, 7, 9, 10]), "1-3,7,9-10");
        assert_eq!(ranges(&[4]), "4");
        assert_eq!(ranges(&[]), "");
    }

    #[test]
    fn thousands_are_apart() {
        assert_eq!(grouped(0), "0");
        assert_eq!(grouped(999), "999");
        assert_eq!(grouped(1000), "1,000");
        assert_eq!(grouped(68_553_846), "68,553,846");
    }
}
