//! Line charts and scatter plots over two axes, such as times over the numbers of faces.

use std::collections::HashSet;

use geobench_export::svg::{Svg, fitted, width_of};

use super::axis::{Axis, Scale, label};
use super::dots::significant;
use super::{
    Datum, LINE, MOST_ROWS, WIDTH, axis_below, draw_marker, draw_ticks, draw_whisker, legend,
    marker_class, open_group, polyline,
};
use crate::table::group::{Estimate, by_key};

/// Height of the plotting area.
const HEIGHT: f64 = 200.0;

/// The most markers on a line.
const MOST_MARKERS: usize = 25;

/// A line chart.
#[derive(Clone, Debug)]
pub(crate) struct Lines {
    pub(crate) x: Axis,
    pub(crate) y: Axis,
    /// A value marked by a horizontal line.
    pub(crate) reference: Option<f64>,
    /// Whether the Pareto front of each model is drawn. Less is better on both axes.
    pub(crate) front: bool,
    pub(crate) series: Vec<Series>,
}

/// A line with markers, or markers alone.
#[derive(Clone, Debug)]
pub(crate) struct Series {
    pub(crate) style: usize,
    pub(crate) name: String,
    /// The algorithm, by which the page filters.
    pub(crate) algorithm: String,
    /// Whether neighbouring points are joined by a line.
    pub(crate) joined: bool,
    /// Whether markers are outlines.
    pub(crate) hollow: bool,
    /// From left to right.
    pub(crate) points: Vec<LinePoint>,
    /// The power law fitted to the points.
    pub(crate) fit: Option<Fit>,
}

/// A point over two axes.
#[derive(Clone, Debug)]
pub(crate) struct LinePoint {
    pub(crate) x: f64,
    pub(crate) value: Estimate,
    /// Standard deviation of `x`, if it is a mean.
    pub(crate) deviation: Option<f64>,
    /// The model, by which the page filters; empty if the point belongs to none or to several.
    pub(crate) model: String,
}

impl LinePoint {
    pub(crate) fn new(x: f64, value: impl Into<Estimate>, model: &str) -> Self {
        Self {
            x,
            value: value.into(),
            deviation: None,
            model: model.to_owned(),
        }
    }
}

/// The power law `factor * x ^ exponent`, drawn between the two x-values `ends`.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Fit {
    pub(crate) exponent: f64,
    pub(crate) factor: f64,
    pub(crate) ends: [f64; 2],
}

impl Fit {
    /// Its value at `x`.
    fn at(&self, x: f64) -> f64 {
        self.factor * libm::pow(x, self.exponent)
    }
}

impl Lines {
    /// A chart without a reference line and without Pareto fronts.
    pub(crate) fn new(x: Axis, y: Axis, series: Vec<Series>) -> Self {
        Self {
            x,
            y,
            reference: None,
            front: false,
            series,
        }
    }

    /// Draws the chart and returns its height.
    pub(super) fn draw(&self, svg: &mut Svg) -> f64 {
        let names = self.series.iter().map(|series| {
            let algorithm = Some(series.algorithm.as_str());
            (series.style, series.hollow, series.name.as_str(), algorithm)
        });
        let names: Vec<_> = names.collect();
        let top = 24.0 + legend(svg, [4.0, 2.0], WIDTH - 8.0, &names);
        let bottom = top + HEIGHT;
        let points = || self.series.iter().flat_map(|s| &s.points);
        let ys = points().flat_map(|point| {
            let value = point.value;
            let [low, high] = value.interval.unwrap_or([value.value; 2]);
            [low, value.value, high]
        });
        let y = Scale::new(&self.y, ys.chain(self.reference), [bottom, top], false);
        let labels = y.ticks().0.into_iter().map(|tick| width_of(&label(tick)));
        let left = labels.fold(46.0, f64::max);
        let x = Scale::new(
            &self.x,
            points().map(|point| point.x),
            [left + 6.0, WIDTH - 14.0],
            false,
        );
        svg.text([4.0, top - 9.0], "t", &fitted(&self.y.label, WIDTH - 8.0));
        let ends = |place| [[x.start(), place], [x.end(), place]];
        draw_ticks(svg, &y, ends, "e", |place| [left, place + 3.8]);
        svg.line("axis", [x.start(), top], [x.start(), bottom]);
        if let Some(place) = self.reference.and_then(|value| y.place(value)) {
            svg.line("one", [x.start(), place], [x.end(), place]);
        }
        axis_below(svg, &x, &self.x.label, [top, bottom]);
        let fronts = self.fronts();
        let mut names = Names::default();
        for (model, front) in &fronts {
            let corners: Vec<[f64; 2]> = stairs(front)
                .iter()
                .map(|[at, value]| [x.clamped(*at), y.clamped(*value)])
                .collect();
            let (Some(first), Some(last)) = (corners.first(), corners.last()) else {
                continue;
            };
            let ends = [[first[0], top], [x.end(), last[1]]];
            let all = [ends[0]].into_iter().chain(corners.iter().copied());
            let is_one = fronts.len() == 1;
            let class = ("class", "fronts".to_owned());
            let of = (!is_one).then(|| ("data-model", (*model).to_owned()));
            svg.open("g", &[class].into_iter().chain(of).collect::<Vec<_>>());
            polyline(svg, "front", all.chain([ends[1]]));
            if (2..=MOST_NAMED).contains(&fronts.len()) {
                let name = fitted(model, WIDTH / 3.0);
                svg.text(names.place(&name, [first[0], top]), "q", &name);
            }
            svg.close();
        }
        for series in &self.series {
            self.draw_series(svg, series, &x, &y);
        }
        bottom + 34.0
    }

    /// The name and the Pareto front of each model, from left to right; empty if none are drawn.
    fn fronts(&self) -> Vec<(&str, Vec<[f64; 2]>)> {
        let points = self.series.iter().flat_map(|series| &series.points);
        let models = by_key(points.filter(|_| self.front), |point| point.model.as_str());
        let front = |own: Vec<&LinePoint>| {
            let points = own.into_iter();
            front(points.map(|point| [point.x, point.value.value]))
        };
        let models = models.into_iter();
        models.map(|(model, own)| (model, front(own))).collect()
    }

    pub(super) fn data(&self) -> Vec<Datum> {
        let datum = |series: String, x: f64, value: f64| Datum {
            of: self.x.label.clone(),
            series,
            x: Some(x),
            value: Some(value),
            ..Datum::default()
        };
        let mut data = Vec::new();
        for series in &self.series {
            for point in &series.points {
                data.push(Datum {
                    interval: point.value.interval,
                    ..datum(series.name.clone(), point.x, point.value.value)
                });
            }
            let deviations = series
                .points
                .iter()
                .filter_map(|p| Some((p.x, p.deviation?)));
            data.extend(
                deviations.map(|(x, value)| datum(format!("{}: deviation", series.name), x, value)),
            );
            if let Some(fit) = series.fit {
                let ends = fit
                    .ends
                    .map(|x| datum(format!("{}: fit", series.name), x, fit.at(x)));
                data.extend(ends);
            }
        }
        for (model, front) in self.fronts() {
            let points = front.into_iter();
            data.extend(points.map(|[x, value]| datum(format!("{model}: front"), x, value)));
        }
        data
    }

    fn draw_series(&self, svg: &mut Svg, series: &Series, x: &Scale, y: &Scale) {
        let class = marker_class(series.style);
        open_group(svg, Some(&series.algorithm), None);
        let places = series
            .points
            .iter()
            .filter_map(|point| Some(([x.place(point.x)?, y.place(point.value.value)?], point)));
        let places: Vec<([f64; 2], &LinePoint)> = places.collect();
        if let Some(fit) = series.fit {
            let [from, to] = fit.ends.map(|at| [x.clamped(at), y.clamped(fit.at(at))]);
            svg.line(&format!("fit {class}"), from, to);
        }
        if series.joined && places.len() > 1 {
            let points = places.iter().map(|(at, _)| *at);
            polyline(svg, &format!("curve {class}"), points);
        }
        // Markers on all points would hide a long line.
        let every = if series.joined {
            places.len().div_ceil(MOST_MARKERS).max(1)
        } else {
            1
        };
        let is_crowded = places.len() > MOST_ROWS;
        let mut taken = HashSet::new();
        for (i, (at, point)) in places.into_iter().enumerate() {
            // Of many markers, one is drawn of those that cover each other.
            let covers = 4.0;
            let square = at.map(|place| (place / covers) as i64);
            let is_hidden = is_crowded && !series.joined && !taken.insert(square);
            let has_marker = i % every == 0 && !is_hidden;
            let interval = point.value.interval.filter(|_| has_marker || !is_crowded);
            if !has_marker && interval.is_none() {
                continue;
            }
            let model = Some(point.model.as_str()).filter(|model| !model.is_empty());
            open_group(svg, None, model);
            if has_marker {
                svg.holding("title", &[], &self.spoken(series, point));
            }
            if let Some(deviation) = point.deviation.filter(|_| has_marker) {
                let ends = [-deviation, deviation].map(|d| [x.clamped(point.x + d), at[1]]);
                draw_whisker(svg, series.style, ends);
            }
            if let Some(ends) = interval {
                let ends = ends.map(|end| [at[0], y.clamped(end)]);
                draw_whisker(svg, series.style, ends);
            }
            if has_marker {
                draw_marker(svg, series.style, series.hollow, at);
            }
            svg.close();
        }
        svg.close();
    }

    /// The tooltip of a point.
    fn spoken(&self, series: &Series, point: &LinePoint) -> String {
        let name = match point.model.as_str() {
            "" => series.name.clone(),
            model => format!("{model}, {}", series.name),
        };
        let mut text = format!("{name}: {}", significant(point.value.value));
        if let Some([low, high]) = point.value.interval {
            text += &format!(" ({} to {})", significant(low), significant(high));
        }
        text += &format!(" at {} {}", self.x.label, significant(point.x));
        if let Some(fit) = series.fit {
            text += &format!("; grows with the power {:.2}", fit.exponent);
        }
        text
    }
}

/// The Pareto front of `points`, from left to right: the points that no other point dominates. A
/// point dominates another if it is less on one axis and not more on the other.
pub(crate) fn front(points: impl IntoIterator<Item = [f64; 2]>) -> Vec<[f64; 2]> {
    let mut points: Vec<[f64; 2]> = points.into_iter().collect();
    points.sort_by(|a, b| a[0].total_cmp(&b[0]).then(a[1].total_cmp(&b[1])));
    let mut least = f64::INFINITY;
    points.retain(|point| {
        let is_on = point[1] < least;
        least = least.min(point[1]);
        is_on
    });
    points
}

/// The corners of the staircase through the points of a front.
fn stairs(front: &[[f64; 2]]) -> Vec<[f64; 2]> {
    let steps = front.windows(2).flat_map(|pair| {
        let [from, to] = [pair[0], pair[1]];
        [[to[0], from[1]], to]
    });
    front.first().copied().into_iter().chain(steps).collect()
}

/// Places the names of vertical lines beside their tops, stacked where they would overlap. Holds
/// the left end, right end and y-position of each name.
#[derive(Default)]
struct Names(Vec<[f64; 3]>);

/// Fronts of more models have no names, which would cover each other.
const MOST_NAMED: usize = 40;

impl Names {
    /// The position of `name` beside a line with this x-position and top.
    fn place(&mut self, name: &str, [x, top]: [f64; 2]) -> [f64; 2] {
        let width = width_of(name);
        let left = (x + 4.0).min(WIDTH - 14.0 - width);
        let mut y = top + 11.0;
        let meets = |y: f64, [from, to, at]: &[f64; 3]| {
            *at == y && left < to + 4.0 && left + width + 4.0 > *from
        };
        while self.0.iter().any(|other| meets(y, other)) {
            y += LINE;
        }
        self.0.push([left, left + width, y]);
        [left, y]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_front_holds_the_points_that_no_other_beats() {
        let points = [[3.0, 1.0], [1.0, 9.0], [2.0, 9.0], [2.0, 4.0], [4.0, 1.0]];
        let on = front(points);
        assert_eq!(on, [[1.0, 9.0], [2.0, 4.0], [3.0, 1.0]]);
        assert_eq!(
            stairs(&on),
            [[1.0, 9.0], [2.0, 9.0], [2.0, 4.0], [3.0, 4.0], [3.0, 1.0]]
        );
        assert!(front([]).is_empty() && stairs(&[]).is_empty());
    }

    #[test]
    fn names_of_lines_that_are_close_stand_below_each_other() {
        let mut names = Names::default();
        let [a, b, c] = [100.0, 110.0, 300.0].map(|x| names.place("horse", [x, 20.0]));
        assert_eq!([a[1], b[1], c[1]], [31.0, 31.0 + LINE, 31.0]);
    }
}
