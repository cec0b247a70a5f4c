//! Axes: they map values to places and choose ticks.

/// The quantity of an axis and its scale.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Axis {
    /// With its unit.
    pub(crate) label: String,
    /// Whether the scale is logarithmic. Values of 0 and less are then left out.
    pub(crate) log: bool,
}

impl Axis {
    /// The scale in words, for captions.
    pub(crate) fn scale(&self) -> &'static str {
        if self.log {
            "Logarithmic scale."
        } else {
            "Linear scale."
        }
    }

    /// A logarithmic scale if all values are above 0 and the largest is more than four times the
    /// smallest; else a linear one.
    pub(crate) fn fitting(label: &str, values: impl IntoIterator<Item = f64>) -> Self {
        let (mut low, mut high) = (f64::INFINITY, 0.0_f64);
        for value in values {
            low = low.min(value);
            high = high.max(value);
        }
        Self {
            label: label.to_owned(),
            log: low > 0.0 && high > 4.0 * low,
        }
    }
}

/// An axis over a range of values and places.
#[derive(Clone, Debug)]
pub(crate) struct Scale {
    log: bool,
    values: [f64; 2],
    places: [f64; 2],
    /// Distance of ticks on a linear scale.
    step: f64,
}

impl Scale {
    /// An axis between two places that covers all of `values` that its scale can show.
    pub(crate) fn new(
        axis: &Axis,
        values: impl IntoIterator<Item = f64>,
        places: [f64; 2],
        from_zero: bool,
    ) -> Self {
        let shown = |v: &f64| v.is_finite() && (!axis.log || *v > 0.0);
        let (mut low, mut high) = values
            .into_iter()
            .filter(shown)
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), v| {
                (low.min(v), high.max(v))
            });
        if low > high {
            (low, high) = (1.0, 10.0);
        }
        if axis.log {
            // A little room at both ends, and never less than a factor of two.
            (low, high) = (low / 1.12, high * 1.12);
            if high < 2.0 * low {
                let middle = (low * high).sqrt();
                (low, high) = (middle / 2_f64.sqrt(), middle * 2_f64.sqrt());
            }
            return Self {
                log: true,
                values: [low, high],
                places,
                step: 0.0,
            };
        }
        if from_zero || (low >= 0.0 && low < 0.5 * high) {
            low = low.min(0.0);
        }
        if high - low <= 1e-12 * high.abs() {
            high = if high == 0.0 {
                1.0
            } else {
                high + high.abs() / 2.0
            };
        }
        let step = nice((high - low) / 5.0);
        Self {
            log: false,
            values: [(low / step).floor() * step, (high / step).ceil() * step],
            places,
            step,
        }
    }

    /// The place of a value, if it is on the axis.
    pub(crate) fn place(&self, value: f64) -> Option<f64> {
        let [low, high] = self.values;
        let share = if self.log {
            libm::log(value / low) / libm::log(high / low)
        } else {
            (value - low) / (high - low)
        };
        let [from, to] = self.places;
        (share.is_finite() && (-0.001..=1.001).contains(&share))
            .then_some(from + share * (to - from))
    }

    /// The start of the axis.
    pub(crate) const fn start(&self) -> f64 {
        self.places[0]
    }

    /// The end of the axis.
    pub(crate) const fn end(&self) -> f64 {
        self.places[1]
    }

    /// The place of a value, clamped to the axis.
    pub(crate) fn clamped(&self, value: f64) -> f64 {
        let [low, high] = self.values;
        self.place(value.clamp(low, high)).unwrap_or(self.places[0])
    }

    /// Values of ticks with labels, and of ticks without.
    pub(crate) fn ticks(&self) -> (Vec<f64>, Vec<f64>) {
        let [low, high] = self.values;
        if !self.log {
            let count = ((high - low) / self.step).round() as i64;
            let first = (low / self.step).round();
            let ticks = (0..=count).map(|i| (first + i as f64) * self.step);
            return (ticks.collect(), Vec::new());
        }
        let (first, last) = (
            libm::log10(low).floor() as i32,
            libm::log10(high).ceil() as i32,
        );
        let within = |v: &f64| *v >= low && *v <= high;
        let times = |factors: &[f64]| -> Vec<f64> {
            (first..=last)
                .flat_map(|e| factors.iter().map(move |f| f * 10_f64.powi(e)))
                .filter(within)
                .collect()
        };
        let minor = times(&[2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0, 9.0]);
        let decades = libm::log10(high / low);
        let mut major = times(&[1.0]);
        if decades > 7.0 {
            let every = (decades / 6.0).ceil() as usize;
            major = major.into_iter().step_by(every).collect();
        } else if decades < 1.0 {
            // Ticks from 1 to 9 would be crowded, so only as many as have room.
            major = times(&[1.0, 1.5, 2.0, 3.0, 4.0, 5.0, 7.0]);
        } else if decades < 2.4 {
            major = times(&[1.0, 2.0, 5.0]);
        }
        (major, minor)
    }
}

/// The smallest of 1, 2, 2.5 and 5 times a power of ten that is not below `step`.
pub(crate) fn nice(step: f64) -> f64 {
    let power = libm::exp10(libm::log10(step).floor());
    [1.0, 2.0, 2.5, 5.0, 10.0]
        .into_iter()
        .map(|factor| factor * power)
        .find(|nice| *nice >= step * (1.0 - 1e-9))
        .unwrap_or(10.0 * power)
}

/// The short label of a tick.
pub(crate) fn label(value: f64) -> String {
    let size = value.abs();
    let (scaled, unit) = match size {
        _ if size >= 1e9 => (value / 1e9, "G"),
        _ if size >= 1e6 => (value / 1e6, "M"),
        _ if size >= 1e4 => (value / 1e3, "k"),
        _ => (value, ""),
    };
    if size > 0.0 && size < 1e-4 {
        return format!("{value:.0e}");
    }
    let text = format!("{scaled:.6}");
    let text = text.trim_end_matches('0').trim_end_matches('.');
    format!("{text}{unit}")
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ticks(log: bool, values: [f64; 2]) -> String {
        let axis = Axis {
            label: String::new(),
            log,
        };
        let scale = Scale::new(&axis, values, [0.0, 100.0], false);
        let labels: Vec<String> = scale.ticks().0.into_iter().map(label).collect();
        labels.join(" ")
    }

    #[test]
    fn ticks_are_round_numbers() {
        assert_eq!(ticks(false, [0.0, 1.0]), "0 0.2 0.4 0.6 0.8 1");
        assert_eq!(ticks(false, [96.0, 104.0]), "96 98 100 102 104");
        assert_eq!(ticks(true, [0.0012, 0.9]), "0.01 0.1 1");
        assert_eq!(ticks(true, [0.01, 0.9]), "0.01 0.02 0.05 0.1 0.2 0.5 1");
        assert_eq!(ticks(true, [1.1, 4.0]), "1 1.5 2 3 4");
        assert_eq!(ticks(true, [2e4, 3e9]), "100k 1M 10M 100M 1G");
        assert_eq!(ticks(true, [1e-6, 1e-3]), "1e-6 1e-5 0.0001 0.001");
    }

    #[test]
    fn whatever_the_values_there_is_an_axis() {
        for log in [false, true] {
            for values in [
                [0.0, 0.0],
                [5.0, 5.0],
                [-1.0, 2.0],
                [f64::NAN, f64::INFINITY],
                [1e-300, 1e300],
            ] {
                assert!(!ticks(log, values).is_empty(), "{log} {values:?}");
            }
        }
    }

    #[test]
    fn places_are_proportional() {
        let axis = Axis::fitting("x", [1.0, 100.0]);
        assert!(axis.log);
        let scale = Scale::new(&axis, [1.0, 100.0], [0.0, 100.0], false);
        let middle = scale.place(10.0).unwrap();
        assert!((middle - 50.0).abs() < 1e-9, "{middle}");
        assert_eq!(scale.place(0.0), None);
        assert_eq!(scale.place(1e9), None);
        assert_eq!(scale.clamped(1e9), 100.0);
        assert!(!Axis::fitting("x", [0.0, 100.0]).log);
        assert!(!Axis::fitting("x", [30.0, 100.0]).log);
    }
}
