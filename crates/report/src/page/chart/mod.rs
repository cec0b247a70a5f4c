//! Charts, drawn as SVG for a page or for a file of its own.
//!
//! Text is drawn as text. Lines have the colour of the surrounding text, so that charts fit light
//! and dark pages. Colour is never the only distinction: every algorithm also has a marker, and
//! every part of a bar a pattern.

use geobench_export::svg::{self, Svg, fitted, px, width_of};
use geobench_harness::measure::number::grouped;

use super::picture::ModelPicture;
use crate::table::group::Estimate;

mod axis;
mod bars;
mod dots;
mod lines;
mod trend;

pub(crate) use axis::Axis;
use axis::Scale;
pub(crate) use bars::{Bar, BarGroup, Bars};
pub(crate) use dots::{Band, Dots, Lane, MOST_LANES};
pub(crate) use lines::{Fit, LinePoint, Lines, Series, front};
pub(crate) use trend::{PlottedCommit, Trend};

/// Width of all charts, in pixels at their natural size: that of a phone in portrait mode, so that
/// text has 12 px there.
pub(crate) const WIDTH: f64 = 336.0;

/// The most rows of a chart and the most markers of a series, which bound the size of a page. The
/// data of the chart has all.
const MOST_ROWS: usize = 300;

/// The label of the axis of a chart with the first `drawn` of `all` models.
fn label_of_part(label: &str, drawn: usize, all: usize) -> String {
    if drawn < all {
        format!("first {drawn} of {} models; {label}", grouped(all as u64))
    } else {
        label.to_owned()
    }
}

/// Height of a line of text.
pub(super) const LINE: f64 = 16.0;

/// The greatest width of the names of lanes and bars.
pub(super) const WIDEST_NAME: f64 = 130.0;

/// A chart. `assets/charts.js` hides the parts of hidden models and algorithms.
#[derive(Clone, Debug)]
pub(crate) enum Chart {
    Dots(Dots),
    Bars(Bars),
    Lines(Lines),
    Picture(Box<ModelPicture>),
}

/// A value that is drawn with the marker of an algorithm.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct ChartPoint {
    /// The style of the algorithm.
    pub(crate) style: usize,
    /// The name of the value.
    pub(crate) name: String,
    /// The model, by which the page filters.
    pub(crate) model: Option<String>,
    /// The algorithm, by which the page filters, unless it is that of the lane.
    pub(crate) algorithm: Option<String>,
    pub(crate) value: Estimate,
    /// Whether only the outline of the marker is drawn.
    pub(crate) hollow: bool,
}

/// A row of the data of a chart.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Datum {
    /// The band or the group of bars, such as a model; empty in charts of lines.
    pub(crate) of: String,
    /// The name of the marker, line or part of a bar.
    pub(crate) series: String,
    /// The value on the x-axis, if the chart has two axes.
    pub(crate) x: Option<f64>,
    pub(crate) value: Option<f64>,
    pub(crate) interval: Option<[f64; 2]>,
    /// The text in place of a value.
    pub(crate) absent: Option<String>,
}

impl Chart {
    /// The drawing as an `svg` element with a title and a description for screen readers, whose ids
    /// start with `id`. If `alone`, it is a file of its own: it has a size and includes the style
    /// sheet.
    pub(crate) fn draw(&self, id: &str, title: &str, description: &str, alone: bool) -> String {
        let mut inside = Svg::default();
        let [width, height] = match self {
            Self::Dots(dots) => [WIDTH, dots.draw(&mut inside)],
            Self::Bars(bars) => [WIDTH, bars.draw(&mut inside, id)],
            Self::Lines(lines) => [WIDTH, lines.draw(&mut inside)],
            Self::Picture(picture) => picture.flat.draw(&mut inside),
        };
        svg::drawing(
            id,
            title,
            description,
            [width, height],
            &inside.finish(),
            alone,
        )
    }

    /// The data of the chart; empty for a picture.
    pub(crate) fn data(&self) -> Vec<Datum> {
        match self {
            Self::Dots(dots) => dots.data(),
            Self::Bars(bars) => bars.data(),
            Self::Lines(lines) => lines.data(),
            Self::Picture(_) => Vec::new(),
        }
    }
}

/// Starts a group of elements that the page hides together with an algorithm or a model.
fn open_group(svg: &mut Svg, algorithm: Option<&str>, model: Option<&str>) {
    let algorithm = algorithm.map(|name| ("data-algorithm", name.to_owned()));
    let model = model.map(|name| ("data-model", name.to_owned()));
    let attributes: Vec<_> = algorithm.into_iter().chain(model).collect();
    svg.open("g", &attributes);
}

/// A marker with a name in a legend, and the algorithm with which the page hides it.
type LegendEntry<'a> = (usize, bool, &'a str, Option<&'a str>);

/// Draws a legend: markers with names, in lines of at most `width` with the top left corner at
/// `at`. Returns its height.
fn legend(svg: &mut Svg, at: [f64; 2], width: f64, names: &[LegendEntry<'_>]) -> f64 {
    let [mut x, mut y] = at;
    for (style, hollow, name, algorithm) in names {
        let name = &fitted(name, width - 26.0);
        let wide = width_of(name) + 26.0;
        if x > at[0] && x + wide > at[0] + width {
            x = at[0];
            y += LINE;
        }
        open_group(svg, *algorithm, None);
        draw_marker(svg, *style, *hollow, [x + 6.0, y + 7.5]);
        svg.text([x + 15.0, y + 11.5], "t", name);
        svg.close();
        x += wide;
    }
    if names.is_empty() {
        0.0
    } else {
        y + LINE + 4.0 - at[1]
    }
}

/// Draws an interval between two points, with a cap at each end.
fn draw_whisker(svg: &mut Svg, style: usize, [low, high]: [[f64; 2]; 2]) {
    let [along, down] = [0, 1].map(|i| (high[i] - low[i]).abs());
    // A short whisker would be hidden by the marker and blur it.
    if along + down <= 8.0 {
        return;
    }
    let class = format!("whisker {}", marker_class(style));
    let [dx, dy] = if along > down { [0.0, 3.0] } else { [3.0, 0.0] };
    svg.line(&class, low, high);
    for [x, y] in [low, high] {
        svg.line(&class, [x - dx, y - dy], [x + dx, y + dy]);
    }
}

/// Draws the grid lines of an axis and the labels of its major ticks. For the position of a tick,
/// `ends` returns the ends of its grid line and `label` the position of its label.
fn draw_ticks(
    svg: &mut Svg,
    scale: &Scale,
    ends: impl Fn(f64) -> [[f64; 2]; 2],
    class: &str,
    label: impl Fn(f64) -> [f64; 2],
) {
    let (major, minor) = scale.ticks();
    for place in minor.into_iter().filter_map(|tick| scale.place(tick)) {
        let [from, to] = ends(place);
        svg.line("minor", from, to);
    }
    for tick in major {
        if let Some(place) = scale.place(tick) {
            let [from, to] = ends(place);
            svg.line("grid", from, to);
            let (text, [x, y]) = (axis::label(tick), label(place));
            // A centred label at an end of the axis stays in the chart.
            let half = width_of(&text) / 2.0;
            let x = if class == "m" { x.min(WIDTH - half) } else { x };
            svg.text([x, y], class, &text);
        }
    }
}

/// Draws the x-axis below a chart, with grid lines from `top` to `bottom`.
fn axis_below(svg: &mut Svg, scale: &Scale, label: &str, [top, bottom]: [f64; 2]) {
    let ends = |x| [[x, top], [x, bottom]];
    draw_ticks(svg, scale, ends, "m", |x| [x, bottom + 13.0]);
    svg.line("axis", [scale.start(), bottom], [scale.end(), bottom]);
    let middle = f64::midpoint(scale.start(), scale.end());
    // A label that is longer than the axis stays in the chart.
    let (label, most) = (&fitted(label, WIDTH - 8.0), WIDTH - 4.0);
    let half = width_of(label) / 2.0;
    svg.text(
        [middle.clamp(4.0 + half, most - half), bottom + 28.0],
        "m",
        label,
    );
}

/// Draws a line through points.
fn polyline(svg: &mut Svg, class: &str, points: impl Iterator<Item = [f64; 2]>) {
    let points: Vec<String> = points
        .map(|[x, y]| format!("{},{}", px(x), px(y)))
        .collect();
    svg.leaf(
        "polyline",
        &[("class", class.to_owned()), ("points", points.join(" "))],
    );
}

/// The number of colours that `chart.css` defines.
pub(crate) const COLOURS: usize = 8;

/// The number of marker shapes. It is coprime to the number of colours, so only styles that are 72
/// apart share both.
const SHAPES: usize = 9;

/// The CSS class with the colour of a style.
pub(crate) fn marker_class(style: usize) -> String {
    format!("s{}", style % COLOURS)
}

/// Draws the marker of a style at a point.
fn draw_marker(svg: &mut Svg, style: usize, hollow: bool, at: [f64; 2]) {
    let [x, y] = at;
    let body = if hollow { "open" } else { "mark" };
    let class = ("class", format!("{body} {}", marker_class(style)));
    let corners = corners(style);
    if corners.is_empty() {
        svg.leaf(
            "circle",
            &[class, ("cx", px(x)), ("cy", px(y)), ("r", px(3.6))],
        );
        return;
    }
    let points: Vec<String> = corners
        .iter()
        .map(|[dx, dy]| format!("{},{}", px(x + dx), px(y + dy)))
        .collect();
    svg.leaf("polygon", &[class, ("points", points.join(" "))]);
}

/// The corners of a marker shape relative to its centre; empty for the circle.
fn corners(style: usize) -> &'static [[f64; 2]] {
    match style % SHAPES {
        0 => &[],
        // Square.
        1 => &[[-3.2, -3.2], [3.2, -3.2], [3.2, 3.2], [-3.2, 3.2]],
        // Triangle that points up. Shapes 4 and 7 point down and to the right.
        2 => &[[0.0, -4.2], [4.2, 3.2], [-4.2, 3.2]],
        // Diamond.
        3 => &[[0.0, -4.7], [4.7, 0.0], [0.0, 4.7], [-4.7, 0.0]],
        4 => &[[0.0, 4.2], [4.2, -3.2], [-4.2, -3.2]],
        // Plus.
        5 => &[
            [-1.3, -4.5],
            [1.3, -4.5],
            [1.3, -1.3],
            [4.5, -1.3],
            [4.5, 1.3],
            [1.3, 1.3],
            [1.3, 4.5],
            [-1.3, 4.5],
            [-1.3, 1.3],
            [-4.5, 1.3],
            [-4.5, -1.3],
            [-1.3, -1.3],
        ],
        // Cross.
        6 => &[
            [0.0, -1.8],
            [2.3, -4.1],
            [4.1, -2.3],
            [1.8, 0.0],
            [4.1, 2.3],
            [2.3, 4.1],
            [0.0, 1.8],
            [-2.3, 4.1],
            [-4.1, 2.3],
            [-1.8, 0.0],
            [-4.1, -2.3],
            [-2.3, -4.1],
        ],
        7 => &[[4.2, 0.0], [-3.2, -4.2], [-3.2, 4.2]],
        // Upright bar.
        _ => &[[-2.0, -4.5], [2.0, -4.5], [2.0, 4.5], [-2.0, 4.5]],
    }
}
