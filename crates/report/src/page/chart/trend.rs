//! A figure over the commits of a history.

use geobench_export::svg::{self, Svg, px, width_of};

use super::axis::{Axis, Scale};
use super::{LINE, WIDTH, draw_ticks, draw_whisker, marker_class, polyline};

/// Height of the plotting area.
const HEIGHT: f64 = 120.0;

/// Left end of the x-axis.
const LEFT: f64 = 52.0;

/// A figure over the commits of a history. Commits are at equal distances.
#[derive(Clone, Debug)]
pub(crate) struct Trend {
    pub(crate) y: Axis,
    /// Number of commits on the x-axis.
    pub(crate) commits: usize,
    /// The labels of the first, the middle and the last commit.
    pub(crate) labels: [String; 3],
    /// From left to right.
    pub(crate) points: Vec<PlottedCommit>,
    /// Places between two commits where the level changes, with labels.
    pub(crate) changes: Vec<(f64, String)>,
}

/// A value at a commit.
#[derive(Clone, Debug)]
pub(crate) struct PlottedCommit {
    /// The number of the commit.
    pub(crate) place: usize,
    pub(crate) value: f64,
    pub(crate) interval: Option<[f64; 2]>,
    /// The tooltip.
    pub(crate) text: String,
}

impl Trend {
    /// The drawing as an `svg` element; see [`Chart::draw`](super::Chart::draw).
    pub(crate) fn draw(&self, id: &str, title: &str, description: &str) -> String {
        let mut inside = Svg::default();
        let size = [WIDTH, self.draw_inside(&mut inside)];
        svg::drawing(id, title, description, size, &inside.finish(), false)
    }

    /// Draws the chart and returns its height.
    fn draw_inside(&self, svg: &mut Svg) -> f64 {
        let (top, bottom) = (LINE + 4.0, LINE + 4.0 + HEIGHT);
        let ends = self.points.iter().flat_map(|point| {
            let [low, high] = point.interval.unwrap_or([point.value; 2]);
            [low, point.value, high]
        });
        let y = Scale::new(&self.y, ends, [bottom, top], false);
        let right = WIDTH - 14.0;
        let steps = self.commits.saturating_sub(1).max(1) as f64;
        let x = |place: f64| LEFT + 6.0 + (right - LEFT - 12.0) * place / steps;
        let line = |place| [[LEFT, place], [right, place]];
        draw_ticks(svg, &y, line, "e", |place| [LEFT - 6.0, place + 3.8]);
        svg.line("axis", [LEFT, top], [LEFT, bottom]);
        svg.line("axis", [LEFT, bottom], [right, bottom]);
        let places = [LEFT, f64::midpoint(LEFT, right), WIDTH - 4.0];
        for ((text, class), at) in self.labels.iter().zip(["t", "m", "e"]).zip(places) {
            svg.text([at, bottom + LINE], class, text);
        }
        let mut free = 0.0;
        for (place, text) in &self.changes {
            let at = x(*place);
            svg.line("one", [at, top], [at, bottom]);
            let width = width_of(text);
            let left = (at - width / 2.0).clamp(LEFT, right - width);
            // Labels that would overlap are left out; the page names every change.
            if left >= free {
                svg.text([left, top - 5.0], "t", text);
                free = left + width;
            }
        }
        let class = marker_class(0);
        let at = |point: &PlottedCommit| [x(point.place as f64), y.clamped(point.value)];
        polyline(svg, &format!("curve {class}"), self.points.iter().map(at));
        for point in &self.points {
            let [x, place] = at(point);
            if let Some(ends) = point.interval {
                draw_whisker(svg, 0, ends.map(|end| [x, y.clamped(end)]));
            }
            let circle = [
                ("class", format!("mark {class}")),
                ("cx", px(x)),
                ("cy", px(place)),
                ("r", "2".to_owned()),
            ];
            svg.open("circle", &circle);
            svg.holding("title", &[], &point.text);
            svg.close();
        }
        bottom + LINE + 8.0
    }
}
