//! Axes: they map values to positions and choose ticks.

use geobench_export::picture::nice;
use geobench_export::svg::width_of;

/// Pixels between the extreme values and the ends of the axis.
const MARGIN: f64 = 6.0;

/// The least distance between the labels of two ticks.
const GAP: f64 = 6.0;

/// The quantity of an axis and its scale.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Axis {
    /// The quantity, with its unit.
    pub(crate) label: String,
    /// Whether the scale is logarithmic. Values of 0 or less are then left out.
    pub(crate) log: bool,
}

impl Axis {
    /// A linear axis.
    pub(crate) fn linear(label: impl Into<String>) -> Self {
        let label = label.into();
        Self { label, log: false }
    }

    /// A logarithmic axis.
    pub(crate) fn log(label: impl Into<String>) -> Self {
        let label = label.into();
        Self { label, log: true }
    }

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

/// The mapping from a range of values to a range of positions, in pixels.
#[derive(Clone, Debug)]
pub(crate) struct Scale {
    log: bool,
    values: [f64; 2],
    /// The positions of `values`.
    places: [f64; 2],
    /// The ends of the axis line, [`MARGIN`] beyond `places`, so that all markers are inside.
    ends: [f64; 2],
    /// The values that are drawn, sorted; the axis has a tick near each cluster of them.
    drawn: Vec<f64>,
    /// The distance between ticks on a linear scale.
    step: f64,
}

impl Scale {
    /// A scale between the positions `places` that covers all of `values` that `axis` can show.
    /// With `from_zero`, it starts at 0 without a margin, as bars need.
    pub(crate) fn new(
        axis: &Axis,
        values: impl IntoIterator<Item = f64>,
        places: [f64; 2],
        from_zero: bool,
    ) -> Self {
        let shown = |v: &f64| v.is_finite() && (!axis.log || *v > 0.0);
        let mut drawn: Vec<f64> = values.into_iter().filter(shown).collect();
        drawn.sort_by(f64::total_cmp);
        let (mut low, mut high) = match drawn[..] {
            [] => (1.0, 10.0),
            [low, .., high] => (low, high),
            [one] => (one, one),
        };
        let ends = places;
        let inset = MARGIN * (ends[1] - ends[0]).signum();
        // Bars start on the axis line.
        let places = [
            if from_zero { ends[0] } else { ends[0] + inset },
            ends[1] - inset,
        ];
        if axis.log {
            // The range is extended by 12 % at both ends, and covers a factor of at least two.
            (low, high) = (low / 1.12, high * 1.12);
            if high < 2.0 * low {
                let middle = (low * high).sqrt();
                (low, high) = (middle / 2_f64.sqrt(), middle * 2_f64.sqrt());
            }
            return Self {
                log: true,
                values: [low, high],
                places,
                ends,
                drawn,
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
            // The tolerance keeps a rounding error in a sum of parts from lengthening the axis by a
            // step.
            values: [
                (low / step + 1e-9).floor() * step,
                (high / step - 1e-9).ceil() * step,
            ],
            places,
            ends,
            drawn,
            step,
        }
    }

    /// The position of a value, if it is on the axis.
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
        self.ends[0]
    }

    /// The end of the axis.
    pub(crate) const fn end(&self) -> f64 {
        self.ends[1]
    }

    /// The position of a value, clamped to the axis.
    pub(crate) fn clamped(&self, value: f64) -> f64 {
        let [low, high] = self.values;
        self.place(value.clamp(low, high)).unwrap_or(self.places[0])
    }

    /// The values of major ticks, which have labels, and of minor ticks.
    pub(crate) fn ticks(&self) -> (Vec<f64>, Vec<f64>) {
        let [low, high] = self.values;
        if !self.log {
            let count = ((high - low) / self.step).round() as i64;
            let first = (low / self.step).round();
            let ticks = (0..=count).map(|i| (first + i as f64) * self.step);
            let ticks: Vec<f64> = ticks.collect();
            let every = self.spacing(&ticks);
            return (ticks.into_iter().step_by(every).collect(), Vec::new());
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
        let every = (decades / 6.0).ceil() as usize;
        let mut step = if decades > 7.0 { every } else { 1 };
        // Labels at all of 1 to 9 would be crowded.
        let finer: [(f64, &[f64]); 2] = [
            (1.0, &[1.0, 1.5, 2.0, 3.0, 4.0, 5.0, 7.0]),
            (2.4, &[1.0, 2.0, 5.0]),
        ];
        let finer = finer.iter().filter(|(most, _)| decades < *most);
        let mut finer = finer.map(|(_, factors)| times(factors));
        if let Some(ticks) = finer.find(|ticks| self.has_room(ticks)) {
            major = ticks;
        } else {
            let thinned = |step| major.iter().copied().step_by(step).collect::<Vec<_>>();
            while step < major.len() && !self.has_room(&thinned(step)) {
                step += 1;
            }
            major = thinned(step);
        }
        self.add_for_clusters(&mut major);
        (major, minor)
    }

    /// Whether the labels of ascending `ticks` do not overlap.
    fn has_room(&self, ticks: &[f64]) -> bool {
        // On a vertical axis, labels are stacked.
        self.places[0] > self.places[1]
            || ticks.windows(2).all(|pair| {
                let widths = pair.iter().map(|tick| width_of(&label(*tick)));
                let apart = self.clamped(pair[1]) - self.clamped(pair[0]);
                0.5 * widths.sum::<f64>() + GAP <= apart
            })
    }

    /// The number of ticks of a linear scale from one whose label has room to the next.
    fn spacing(&self, ticks: &[f64]) -> usize {
        let [from, to] = self.places;
        // On a vertical axis, labels are stacked.
        if from > to {
            return 1;
        }
        let widths = ticks.iter().map(|tick| width_of(&label(*tick)));
        let widest = widths.fold(0.0, f64::max) + GAP;
        let apart = (to - from) / ticks.len().saturating_sub(1).max(1) as f64;
        ((widest / apart).ceil() as usize).max(1)
    }

    /// Adds a tick with two significant digits for each cluster of values that has no tick near it,
    /// if there is room for its label.
    fn add_for_clusters(&self, ticks: &mut Vec<f64>) {
        // Pixels between two labels. On a vertical axis, labels are stacked and need less.
        let room = if self.ends[0] < self.ends[1] {
            36.0
        } else {
            16.0
        };
        let place = |value: f64| self.place(value).unwrap_or(f64::INFINITY);
        let apart = |a: f64, b: f64| (place(a) - place(b)).abs();
        for cluster in self.drawn.chunk_by(|a, b| apart(*a, *b) <= room) {
            let (low, high) = (cluster[0], cluster[cluster.len() - 1]);
            let is_near = |tick: &f64| {
                (low..=high).contains(tick) || apart(*tick, low).min(apart(*tick, high)) <= room
            };
            if ticks.iter().any(is_near) {
                continue;
            }
            let middle = (low * high).sqrt();
            let digit = libm::exp10(libm::log10(middle).floor() - 1.0);
            let tick = (middle / digit).round() * digit;
            if self.place(tick).is_some() && ticks.iter().all(|other| apart(*other, tick) > room) {
                ticks.push(tick);
            }
        }
        ticks.sort_by(f64::total_cmp);
    }
}

/// The label of a tick, with `k`, `M` or `G` for large values; very large and very small ones have
/// an exponent.
pub(crate) fn label(value: f64) -> String {
    let size = value.abs();
    let (scaled, unit) = match size {
        _ if size >= 1e9 => (value / 1e9, "G"),
        _ if size >= 1e6 => (value / 1e6, "M"),
        _ if size >= 1e4 => (value / 1e3, "k"),
        _ => (value, ""),
    };
    let trimmed = |digits: &str| {
        let digits = digits.trim_end_matches('0');
        digits.trim_end_matches('.').to_owned()
    };
    if size >= 1e12 || size > 0.0 && size < 1e-4 {
        let text = format!("{value:.2e}");
        let (digits, exponent) = text.split_once('e').unwrap_or((text.as_str(), "0"));
        return format!("{}e{exponent}", trimmed(digits));
    }
    trimmed(&format!("{scaled:.7}")) + unit
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ticks(log: bool, values: [f64; 2]) -> String {
        let axis = Axis {
            label: String::new(),
            log,
        };
        // So wide that the labels of a linear scale have room.
        let end = if log { 100.0 } else { 400.0 };
        let scale = Scale::new(&axis, values, [0.0, end], false);
        let labels: Vec<String> = scale.ticks().0.into_iter().map(label).collect();
        labels.join(" ")
    }

    #[test]
    fn labels_do_not_overlap() {
        let labels = |places: [f64; 2]| -> Vec<String> {
            let scale = Scale::new(&Axis::linear(""), [0.000_241, 0.000_269], places, false);
            scale.ticks().0.into_iter().map(label).collect()
        };
        assert_eq!(labels([0.0, 100.0]), ["0.00024", "0.00026"]);
        let all = ["0.00024", "0.00025", "0.00026", "0.00027"];
        assert_eq!(labels([0.0, 400.0]), all);
        // On a vertical axis, labels are stacked.
        assert_eq!(labels([100.0, 0.0]), all);
        let labels = |end: f64| -> Vec<String> {
            let scale = Scale::new(&Axis::log(""), [0.01, 0.9], [0.0, end], false);
            scale.ticks().0.into_iter().map(label).collect()
        };
        assert_eq!(labels(100.0), ["0.01", "0.1", "1"]);
        let all = ["0.01", "0.02", "0.05", "0.1", "0.2", "0.5", "1"];
        assert_eq!(labels(300.0), all);
        assert_eq!([2e9, 1e14, 1.5e-7].map(label), ["2G", "1e14", "1.5e-7"]);
    }

    #[test]
    fn every_cluster_has_a_tick() {
        let axis = Axis::log("");
        let labels = |values: &[f64]| -> Vec<String> {
            let scale = Scale::new(&axis, values.iter().copied(), [0.0, 400.0], false);
            scale.ticks().0.into_iter().map(label).collect()
        };
        assert_eq!(
            labels(&[324.0, 325.0, 5120.0, 81_920.0]),
            ["320", "1000", "5100", "10k", "82k"]
        );
        // A cluster that has a tick gets no other one.
        assert_eq!(labels(&[1.0, 10.0, 1000.0]), ["1", "10", "100", "1000"]);
    }

    #[test]
    fn ticks_are_round_numbers() {
        assert_eq!(ticks(false, [0.0, 1.0]), "0 0.2 0.4 0.6 0.8 1");
        assert_eq!(ticks(false, [96.0, 104.0]), "96 98 100 102 104");
        assert_eq!(
            ticks(false, [2.02e-5, 2.38e-5]),
            "2e-5 2.1e-5 2.2e-5 2.3e-5 2.4e-5"
        );
        assert_eq!(ticks(true, [0.0012, 0.9]), "0.01 0.1 1");
        assert_eq!(ticks(true, [0.01, 0.9]), "0.01 0.1 1");
        assert_eq!(ticks(true, [1.1, 4.0]), "1 2 4");
        assert_eq!(ticks(true, [2e4, 3e9]), "100k 100M");
        assert_eq!(ticks(true, [1e-6, 1e-3]), "1e-6 0.0001");
    }

    #[test]
    fn every_range_of_values_has_an_axis() {
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
        assert_eq!(scale.clamped(1e9), 100.0 - MARGIN);
        assert_eq!([scale.start(), scale.end()], [0.0, 100.0]);
        assert!(!Axis::fitting("x", [0.0, 100.0]).log);
        assert!(!Axis::fitting("x", [30.0, 100.0]).log);
    }
}
