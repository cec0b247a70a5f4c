//! The colour scale of a picture, and its letters where a picture has pixels only.

use super::numbers::{short, step};
use super::raster::{Image, LineStyle};
use crate::distances;
use crate::svg::{Svg, px};

/// The width of a picture, in units of the drawing.
pub(super) const WIDTH: f64 = 480.0;

/// The height of the scale with its numbers and its caption, in units of the drawing.
pub(super) const HEIGHT: f64 = 70.0;

/// What the numbers are.
const CAPTION: &str = "distance (model units)";

/// The number of stripes of the bar.
const STRIPES: usize = 64;

/// The ends of the bar, its top below the picture, and its height.
const ENDS: [f64; 2] = [60.0, WIDTH - 60.0];
const TOP: f64 = 8.0;
const THICKNESS: f64 = 10.0;

/// The baselines of the numbers and of the caption.
const NUMBERS: f64 = 40.0;
const WORDS: f64 = 62.0;

/// The size of the font. A picture in a column of 336 pixels has letters of 12 pixels.
const FONT: f64 = 18.0;

/// The colour of letters on transparent pixels: readable on light and on dark pages.
const GREY: [u8; 3] = [112; 3];

/// A colour bar from distance 0 to the largest, with numbers at levels.
#[derive(Clone, Debug)]
pub(super) struct ColourBar {
    /// The horizontal position of each level, and its number if there is room.
    marks: Vec<(f64, Option<String>)>,
    /// Whether the levels are those of isolines, which are marked on the bar.
    has_isolines: bool,
}

impl ColourBar {
    /// The scale up to `farthest`, with numbers at `levels`, or at round distances if there are
    /// none.
    pub(super) fn new(farthest: f64, levels: &[f64]) -> Self {
        let every = step(farthest, 4.0);
        let round: Vec<f64> = (0..8).map(|k| f64::from(k) * every).collect();
        let chosen = if levels.is_empty() { &round } else { levels };
        let mut last = f64::NEG_INFINITY;
        let inside = chosen.iter().filter(|&&level| level <= farthest * 1.0001);
        let marks = inside.map(|&level| {
            let share = if farthest > 0.0 {
                level / farthest
            } else {
                0.0
            };
            let x = ENDS[0] + (ENDS[1] - ENDS[0]) * share;
            let text = short(level);
            // The letters of `glyph` are wider than most fonts.
            let half = 0.5 * ADVANCE * text.len() as f64 + 3.0;
            let has_room = x - half > last;
            if has_room {
                last = x + half;
            }
            (x, has_room.then_some(text))
        });
        Self {
            marks: marks.collect(),
            has_isolines: !levels.is_empty(),
        }
    }

    /// The ends of each stripe from left to right, and its colour.
    fn stripes() -> impl Iterator<Item = ([f64; 2], [u8; 3])> {
        let end = |k: usize| ENDS[0] + (ENDS[1] - ENDS[0]) * k as f64 / STRIPES as f64;
        (0..STRIPES).map(move |k| {
            let share = k as f64 / (STRIPES - 1) as f64;
            ([end(k), end(k + 1)], distances::colour(share))
        })
    }

    /// Top and bottom of a mark.
    fn mark(&self) -> [f64; 2] {
        [
            TOP + if self.has_isolines { 0.0 } else { THICKNESS },
            TOP + THICKNESS + 4.0,
        ]
    }

    /// Draws the scale below a picture whose lower end is at `y`.
    pub(super) fn draw(&self, svg: &mut Svg, y: f64) {
        for ([left, right], [r, g, b]) in Self::stripes() {
            // Stripes overlap, so that no background shows between them.
            let overlap = if right < ENDS[1] { 1.0 } else { 0.0 };
            svg.leaf(
                "rect",
                &[
                    ("x", px(left)),
                    ("y", px(y + TOP)),
                    ("width", px(right - left + overlap)),
                    ("height", px(THICKNESS)),
                    ("fill", format!("#{r:02x}{g:02x}{b:02x}")),
                ],
            );
        }
        let [top, bottom] = self.mark();
        for (x, text) in &self.marks {
            svg.line("axis", [*x, y + top], [*x, y + bottom]);
            if let Some(text) = text {
                write(svg, [*x, y + NUMBERS], text);
            }
        }
        write(svg, [0.5 * WIDTH, y + WORDS], CAPTION);
    }

    /// Draws the scale into an image, below a picture whose lower end is at `y`. `density` is in
    /// pixels per unit.
    pub(super) fn paint(&self, image: &mut Image, y: f64, density: f64) {
        for ([left, right], colour) in Self::stripes() {
            let ends = [left, y + TOP, right, y + TOP + THICKNESS];
            image.rectangle(ends.map(|x| x * density), colour);
        }
        let [top, bottom] = self.mark();
        let marks = self.marks.iter();
        let ticks = marks.map(|(x, _)| vec![[*x, y + top], [*x, y + bottom]]);
        let mut letters = letters(CAPTION, [0.5 * WIDTH, y + WORDS]);
        for (x, text) in &self.marks {
            let text = text.as_deref().unwrap_or_default();
            letters.extend(self::letters(text, [*x, y + NUMBERS]));
        }
        for (mut lines, half_width) in [(ticks.collect(), 0.4), (letters, 0.7)] {
            let points = lines.iter_mut().flat_map(|line: &mut Vec<[f64; 2]>| line);
            points.for_each(|point| *point = point.map(|x| x * density));
            let half_width = half_width * density;
            let colour = GREY;
            image.draw(&lines, LineStyle { half_width, colour });
        }
    }
}

/// A text, centred on a point of its baseline.
fn write(svg: &mut Svg, [x, y]: [f64; 2], text: &str) {
    let attributes = [
        ("class", "m".to_owned()),
        ("x", px(x)),
        ("y", px(y)),
        ("font-size", px(FONT)),
    ];
    svg.holding("text", &attributes, text);
}

/// The width and height of the grid on which letters are drawn, in units, and their distance.
const CELL: f64 = 0.1125 * FONT;
const ADVANCE: f64 = 5.6 * CELL;

/// The strokes of a text, centred on a point of its baseline.
fn letters(text: &str, [middle, baseline]: [f64; 2]) -> Vec<Vec<[f64; 2]>> {
    let width = ADVANCE * text.chars().count() as f64;
    let left = middle - 0.5 * (width - ADVANCE + 4.0 * CELL);
    let places = text.chars().enumerate();
    let strokes = places.flat_map(|(k, letter)| {
        let left = left + ADVANCE * k as f64;
        let strokes = glyph(letter).split('/').filter(|stroke| !stroke.is_empty());
        strokes.map(move |stroke| {
            let digit = |byte: u8| f64::from(byte - b'0');
            let points = stroke.as_bytes().chunks_exact(2);
            let at = |xy: &[u8]| {
                [
                    left + CELL * digit(xy[0]),
                    baseline + CELL * (digit(xy[1]) - 6.0),
                ]
            };
            points.map(at).collect()
        })
    });
    strokes.collect()
}

/// A letter as strokes on a grid: pairs of digits, x from the left and y from the top; the baseline
/// is 6. Has the letters of numbers and of the caption.
fn glyph(letter: char) -> &'static str {
    match letter {
        '0' => "103041453616050110",
        '1' => "112026/1636",
        '2' => "01103041420646",
        '3' => "0110304142331333/334445361605",
        '4' => "36300444",
        '5' => "400003324345361605",
        '6' => "3011020516364544331304",
        '7' => "004016",
        '8' => "13020110304142331304051636454433",
        '9' => "1635444130100102133342",
        '.' => "2626",
        '-' => "0343",
        '+' => "0343/2125",
        'a' => "12324346/441405163645",
        'c' => "4332120305163645",
        'd' => "4046/4332120305163645",
        'e' => "04444332120305163645",
        'i' => "2226/2020",
        'l' => "2026",
        'm' => "0206/03122326/23324346",
        'n' => "0206/0312324346",
        'o' => "123243453616050312",
        's' => "43321203143445361605",
        't' => "10152636/0232",
        'u' => "0205163645/4246",
        '(' => "30212536",
        ')' => "10212516",
        _ => "",
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn letters_are_on_the_grid() {
        for letter in CAPTION.chars().chain("0123456789.-+e".chars()) {
            let strokes = letters(&letter.to_string(), [0.0, 0.0]);
            assert_eq!(strokes.is_empty(), letter == ' ', "{letter}");
            for [x, y] in strokes.iter().flatten() {
                assert!(
                    x.abs() <= 2.0 * CELL && (-6.0 * CELL..=0.0).contains(y),
                    "{letter}"
                );
            }
            assert!(
                glyph(letter).split('/').all(|stroke| stroke.len() % 2 == 0),
                "{letter}"
            );
        }
    }

    #[test]
    fn every_level_is_marked_and_numbers_do_not_overlap() {
        let scale = ColourBar::new(10.0, &[1.0, 1.01, 5.0, 11.0]);
        let texts: Vec<Option<&str>> = scale.marks.iter().map(|(_, t)| t.as_deref()).collect();
        assert_eq!(texts, [Some("1"), None, Some("5")]);
        assert_eq!(ColourBar::new(0.0, &[]).marks[0].1.as_deref(), Some("0"));
    }

    #[test]
    fn letters_are_larger_than_those_of_charts() {
        let mut svg = Svg::default();
        ColourBar::new(10.0, &[]).draw(&mut svg, 0.0);
        let text = svg.finish();
        assert_eq!(
            text.matches("<text").count(),
            text.matches("font-size=\"18\"").count()
        );
    }
}
