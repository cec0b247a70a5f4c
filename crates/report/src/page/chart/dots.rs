//! Dot plots: one band for each model, with one lane for each algorithm. If there are too many
//! lanes, the algorithms of a band share one.

use geobench_export::svg::{Svg, fitted, px, width_of};

use super::axis::{Axis, Scale};
use super::{
    ChartPoint, Datum, LINE, MOST_ROWS, WIDEST_NAME, WIDTH, axis_below, draw_marker, draw_whisker,
    label_of_part, legend, marker_class, open_group,
};
use crate::table::group::distinct;

/// The most lanes of a chart. With more, the algorithms of a band share one lane.
pub(crate) const MOST_LANES: usize = 48;

/// A dot plot.
#[derive(Clone, Debug)]
pub(crate) struct Dots {
    pub(crate) axis: Axis,
    /// A value marked by a line, such as 1 in a chart of ratios.
    pub(crate) reference: Option<f64>,
    pub(crate) bands: Vec<Band>,
    /// The legend of markers that the names of lanes do not explain: style, hollow, name.
    pub(crate) legend: Vec<(usize, bool, String)>,
}

/// A group of lanes, such as the algorithms on one model.
#[derive(Clone, Debug)]
pub(crate) struct Band {
    pub(crate) title: String,
    pub(crate) lanes: Vec<Lane>,
}

/// A row of points.
#[derive(Clone, Debug, Default)]
pub(crate) struct Lane {
    pub(crate) label: String,
    /// The algorithm, by which the page filters.
    pub(crate) algorithm: Option<String>,
    /// The model, by which the page filters, unless it is that of the band.
    pub(crate) model: Option<String>,
    pub(crate) points: Vec<ChartPoint>,
    /// Samples, drawn as a strip of small dots behind the points.
    pub(crate) samples: Vec<f64>,
    /// The text that explains missing points.
    pub(crate) absent: Option<String>,
}

impl Lane {
    /// Its points, each with the algorithm of the lane.
    fn points_of_its_own(&self) -> Vec<ChartPoint> {
        let point = |point: &ChartPoint| ChartPoint {
            algorithm: self.algorithm.clone(),
            ..point.clone()
        };
        self.points.iter().map(point).collect()
    }
}

impl Dots {
    /// A chart without a legend, because the names of lanes explain all markers.
    pub(crate) fn new(axis: Axis, reference: Option<f64>, bands: Vec<Band>) -> Self {
        Self {
            axis,
            reference,
            bands,
            legend: Vec::new(),
        }
    }

    /// Draws the chart and returns its height.
    pub(super) fn draw(&self, svg: &mut Svg) -> f64 {
        let lanes: usize = self.bands.iter().map(|band| band.lanes.len()).sum();
        if lanes > MOST_LANES && self.bands.len() > 1 {
            return self.merged().draw(svg);
        }
        let names = || {
            self.bands
                .iter()
                .flat_map(|b| &b.lanes)
                .map(|l| l.label.as_str())
        };
        let widest = names().map(width_of).fold(0.0, f64::max).min(WIDEST_NAME);
        let left = widest + 12.0;
        let legends = self.legend.iter();
        let legends = legends.map(|(style, hollow, name)| (*style, *hollow, name.as_str(), None));
        let legends: Vec<_> = legends.collect();
        let top = 4.0 + legend(svg, [4.0, 2.0], WIDTH - 8.0, &legends);
        let reference = self.reference;
        let values = self.points().flat_map(|p| {
            let [low, high] = p.value.interval.unwrap_or([p.value.value; 2]);
            [low, p.value.value, high]
        });
        let samples = self.bands.iter().flat_map(|band| &band.lanes);
        let samples = samples.flat_map(|lane| lane.samples.iter().copied());
        let scale = Scale::new(
            &self.axis,
            values.chain(samples).chain(reference),
            [left, WIDTH - 14.0],
            false,
        );
        let height = |band: &Band| {
            let title = if band.title.is_empty() {
                0.0
            } else {
                LINE + 2.0
            };
            title + LINE * band.lanes.len() as f64 + 5.0
        };
        let bottom = top + self.bands.iter().map(height).sum::<f64>();
        axis_below(svg, &scale, &self.axis.label, [top, bottom]);
        if let Some(place) = reference.and_then(|value| scale.place(value)) {
            svg.line("one", [place, top], [place, bottom]);
        }
        let mut y = top;
        for band in &self.bands {
            let title = Some(band.title.as_str()).filter(|title| !title.is_empty());
            open_group(svg, None, title);
            if title.is_some() {
                svg.text([4.0, y + 12.0], "b", &fitted(&band.title, WIDTH - 20.0));
                y += LINE + 2.0;
            }
            for lane in &band.lanes {
                draw_lane(svg, lane, title, &scale, y + LINE / 2.0);
                y += LINE;
            }
            svg.close();
            y += 5.0;
        }
        bottom + 34.0
    }

    /// The same chart with one lane for each of the first bands, and a legend of the markers.
    /// Samples are left out.
    fn merged(&self) -> Self {
        let lanes = self.bands.iter().take(MOST_ROWS).map(|band| {
            let absent: Vec<String> = band
                .lanes
                .iter()
                .filter_map(|l| Some(format!("{} {}", l.label, l.absent.as_ref()?)))
                .collect();
            Lane {
                label: band.title.clone(),
                points: band
                    .lanes
                    .iter()
                    .flat_map(Lane::points_of_its_own)
                    .collect(),
                model: Some(band.title.clone()),
                absent: (!absent.is_empty()).then(|| absent.join(", ")),
                ..Lane::default()
            }
        });
        let names = self.points().map(|p| (p.style, p.hollow, p.name.clone()));
        let lanes: Vec<Lane> = lanes.collect();
        Self {
            axis: Axis {
                label: label_of_part(&self.axis.label, lanes.len(), self.bands.len()),
                ..self.axis.clone()
            },
            reference: self.reference,
            bands: vec![Band {
                title: String::new(),
                lanes,
            }],
            legend: distinct(self.legend.iter().cloned().chain(names)),
        }
    }

    fn points(&self) -> impl Iterator<Item = &ChartPoint> {
        let lanes = self.bands.iter().flat_map(|band| &band.lanes);
        lanes.flat_map(|lane| &lane.points)
    }

    pub(super) fn data(&self) -> Vec<Datum> {
        let mut data = Vec::new();
        for band in &self.bands {
            let datum = |series: String| Datum {
                of: band.title.clone(),
                series,
                ..Datum::default()
            };
            for lane in &band.lanes {
                data.extend(lane.points.iter().map(|point| Datum {
                    value: Some(point.value.value),
                    interval: point.value.interval,
                    ..datum(point.name.clone())
                }));
                data.extend(lane.samples.iter().map(|sample| Datum {
                    value: Some(*sample),
                    ..datum(format!("{}: sample", lane.label))
                }));
                data.extend(lane.absent.iter().map(|absent| Datum {
                    absent: Some(absent.clone()),
                    ..datum(lane.label.clone())
                }));
            }
        }
        data
    }
}

fn draw_lane(svg: &mut Svg, lane: &Lane, model: Option<&str>, scale: &Scale, y: f64) {
    open_group(svg, lane.algorithm.as_deref(), lane.model.as_deref());
    let (left, right) = (scale.start(), scale.end());
    svg.text(
        [left - 8.0, y + 3.8],
        "e",
        &fitted(&lane.label, WIDEST_NAME),
    );
    svg.line("lane", [left, y], [right, y]);
    if let Some(point) = lane.points.first() {
        draw_samples(svg, &lane.samples, point.style, scale, y);
    }
    for point in &lane.points {
        let Some(place) = scale.place(point.value.value) else {
            continue;
        };
        open_group(svg, point.algorithm.as_deref(), point.model.as_deref());
        svg.holding("title", &[], &spoken(point, model.unwrap_or(&lane.label)));
        if let Some(ends) = point.value.interval {
            let ends = ends.map(|end| [scale.clamped(end), y]);
            draw_whisker(svg, point.style, ends);
        }
        draw_marker(svg, point.style, point.hollow, [place, y]);
        svg.close();
    }
    if let Some(absent) = &lane.absent {
        let farthest = lane
            .points
            .iter()
            .filter_map(|p| scale.place(p.value.value))
            .fold(left, f64::max);
        // The text is placed after the points if there is room, else at the start of the lane.
        let at = if farthest + 12.0 + width_of(absent) < right {
            farthest + 8.0
        } else {
            left + 4.0
        };
        svg.text([at, y + 3.8], "f", &fitted(absent, right - at));
    }
    svg.close();
}

/// Draws a strip of small dots, shifted vertically so that equal values do not overlap.
fn draw_samples(svg: &mut Svg, samples: &[f64], style: usize, scale: &Scale, y: f64) {
    // Multiples of the golden ratio modulo 1 are spread evenly for any number of dots.
    let shift = |i: usize| 9.0 * ((i as f64 * 0.618_034).fract() - 0.5);
    let places = samples.iter().enumerate();
    let places = places.filter_map(|(i, value)| Some((scale.place(*value)?, y + shift(i))));
    let mut path = String::new();
    for (x, y) in places {
        path += &format!("M{} {}h0", px(x), px(y));
    }
    if !path.is_empty() {
        let class = format!("sample {}", marker_class(style));
        svg.leaf("path", &[("class", class), ("d", path)]);
    }
}

/// The tooltip of a marker on the lane or in the band `of`.
fn spoken(point: &ChartPoint, of: &str) -> String {
    let name = format!("{of}, {}", point.name);
    let text = format!("{name}: {}", significant(point.value.value));
    match point.value.interval {
        Some([low, high]) => format!("{text} ({} to {})", significant(low), significant(high)),
        None => text,
    }
}

/// A number with four significant digits.
pub(super) fn significant(value: f64) -> String {
    let size = value.abs();
    if size == 0.0 || !size.is_finite() {
        return format!("{value}");
    }
    if size >= 1e4 && value.fract() == 0.0 {
        return format!("{value:.0}");
    }
    if size < 1e-4 {
        return format!("{value:.3e}");
    }
    let decimals = (3 - libm::log10(size).floor() as i32).clamp(0, 9);
    format!("{value:.*}", usize::try_from(decimals).unwrap_or(0))
}
