//! The markers of algorithms: a colour and a shape for each.

use crate::report::svg::{Svg, px};

/// How many colours there are; `chart.css` has them.
pub(crate) const COLOURS: usize = 8;

/// How many shapes there are. One more than colours, so that it is long until both come again.
const SHAPES: usize = 9;

/// The class that gives a style its colour.
pub(crate) fn class(style: usize) -> String {
    format!("s{}", style % COLOURS)
}

/// Draws the marker of a style at a point.
pub(super) fn draw(svg: &mut Svg, style: usize, hollow: bool, at: [f64; 2]) {
    let [x, y] = at;
    let body = if hollow { "open" } else { "mark" };
    let class = ("class", format!("{body} {}", class(style)));
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

/// The corners of a shape around its middle; none of the circle.
fn corners(style: usize) -> &'static [[f64; 2]] {
    match style % SHAPES {
        0 => &[],
        // Square.
        1 => &[[-3.2, -3.2], [3.2, -3.2], [3.2, 3.2], [-3.2, 3.2]],
        // Triangles upwards and, below, downwards and to the right.
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

/// The name of a marker in pgfplots.
pub(crate) fn pgf(style: usize, hollow: bool) -> &'static str {
    match (style % SHAPES, hollow) {
        (0, false) => "*",
        (0, true) => "o",
        (1, false) => "square*",
        (1, true) => "square",
        (2, false) => "triangle*",
        (2, true) => "triangle",
        (3, false) => "diamond*",
        (3, true) => "diamond",
        (4, false) => "pentagon*",
        (4, true) => "pentagon",
        (5, _) => "+",
        (6, _) => "x",
        (7, _) => "asterisk",
        (_, _) => "|",
    }
}
