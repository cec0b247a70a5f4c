//! Stacked bars, such as the time of each algorithm by phase.

use geobench_export::svg::{Svg, fitted, px, width_of};

use super::axis::{Axis, Scale};
use super::dots::significant;
use super::{Datum, LINE, MOST_ROWS, WIDEST_NAME, WIDTH, axis_below, label_of_part, open_group};

/// The number of parts of a bar, each with its own pattern.
pub(crate) const PARTS: usize = 3;

/// A chart of stacked bars.
#[derive(Clone, Debug)]
pub(crate) struct Bars {
    pub(crate) axis: Axis,
    /// Names of the parts.
    pub(crate) parts: [String; PARTS],
    pub(crate) groups: Vec<BarGroup>,
}

/// Bars that belong together, such as the algorithms on one model.
#[derive(Clone, Debug)]
pub(crate) struct BarGroup {
    pub(crate) title: String,
    pub(crate) bars: Vec<Bar>,
}

/// A bar, or the reason why it is missing.
#[derive(Clone, Debug)]
pub(crate) struct Bar {
    pub(crate) label: String,
    /// The algorithm, by which the page filters.
    pub(crate) algorithm: String,
    /// Lengths of the parts, in the unit of the axis.
    pub(crate) parts: [f64; PARTS],
    /// The text after the bar: its total with unit, or the reason why the bar is missing.
    pub(crate) note: String,
    /// Whether `note` reports a failure.
    pub(crate) failed: bool,
}

impl Bars {
    /// Draws the chart and returns its height. `id` makes the ids of patterns unique in the page.
    pub(super) fn draw(&self, svg: &mut Svg, id: &str) -> f64 {
        patterns(svg, id);
        let mut rows = 0;
        let groups = self.groups.iter().take_while(|group| {
            rows += group.bars.len();
            rows <= MOST_ROWS
        });
        // The first group is drawn, however many bars it has.
        let drawn = groups.count().max(1);
        let groups = &self.groups[..drawn.min(self.groups.len())];
        let bars = || groups.iter().flat_map(|group| &group.bars);
        let widest = bars().map(|bar| width_of(&bar.label)).fold(0.0, f64::max);
        let left = widest.min(WIDEST_NAME) + 12.0;
        let notes = bars()
            .filter(|bar| !bar.failed)
            .map(|bar| width_of(&bar.note))
            .fold(0.0, f64::max);
        let sums = bars().map(|bar| bar.parts.iter().sum());
        let scale = Scale::new(&self.axis, sums, [left, WIDTH - notes - 12.0], true);
        let mut x = 4.0;
        for (k, name) in self.parts.iter().enumerate() {
            part(svg, id, k, [x, 5.0], [12.0, 9.0]);
            svg.text([x + 17.0, 13.5], "t", name);
            x += width_of(name) + 26.0;
        }
        let top = 24.0;
        let height = |group: &BarGroup| LINE + 7.0 + LINE * group.bars.len() as f64;
        let bottom = top + groups.iter().map(height).sum::<f64>();
        let label = label_of_part(&self.axis.label, groups.len(), self.groups.len());
        axis_below(svg, &scale, &label, [top, bottom]);
        let mut y = top;
        for group in groups {
            open_group(svg, None, Some(&group.title));
            svg.text([4.0, y + 12.0], "b", &fitted(&group.title, WIDTH - 20.0));
            y += LINE + 2.0;
            for bar in &group.bars {
                open_group(svg, Some(&bar.algorithm), None);
                let end = self.draw_bar(svg, id, &group.title, bar, &scale, y);
                let class = if bar.failed { "f" } else { "t" };
                svg.text(
                    [end + 5.0, y + 11.3],
                    class,
                    &fitted(&bar.note, WIDTH - end - 5.0),
                );
                svg.close();
                y += LINE;
            }
            svg.close();
            y += 5.0;
        }
        bottom + 34.0
    }

    /// Draws a bar and returns the x-position of its end.
    fn draw_bar(
        &self,
        svg: &mut Svg,
        id: &str,
        model: &str,
        bar: &Bar,
        scale: &Scale,
        y: f64,
    ) -> f64 {
        svg.text(
            [scale.start() - 8.0, y + 11.3],
            "e",
            &fitted(&bar.label, WIDEST_NAME),
        );
        let (mut sum, mut from) = (0.0, scale.start());
        let whole: f64 = bar.parts.iter().sum();
        for (k, length) in bar.parts.into_iter().enumerate() {
            sum += length;
            let to = scale.clamped(sum);
            if to > from {
                svg.open("g", &[]);
                let (label, name) = (&bar.label, &self.parts[k]);
                let share = significant(100.0 * length / whole);
                let text = format!("{model}, {label}: {name} {share} % of {}", bar.note);
                svg.holding("title", &[], &text);
                part(svg, id, k, [from, y + 2.5], [to - from, LINE - 5.0]);
                svg.close();
            }
            from = to;
        }
        from
    }

    pub(super) fn data(&self) -> Vec<Datum> {
        let mut data = Vec::new();
        for group in &self.groups {
            for bar in &group.bars {
                let datum = |series: String| Datum {
                    of: group.title.clone(),
                    series,
                    ..Datum::default()
                };
                if bar.failed {
                    data.push(Datum {
                        absent: Some(bar.note.clone()),
                        ..datum(bar.label.clone())
                    });
                    continue;
                }
                data.extend(
                    self.parts
                        .iter()
                        .zip(bar.parts)
                        .map(|(name, length)| Datum {
                            value: Some(length),
                            ..datum(format!("{}: {name}", bar.label))
                        }),
                );
            }
        }
        data
    }
}

/// The CSS classes of the parts, which are the colours of three marker styles.
const CLASSES: [&str; PARTS] = ["s0", "s4", "s2"];

/// A rectangle in the colour and the pattern of part `k`.
fn part(svg: &mut Svg, id: &str, k: usize, at: [f64; 2], size: [f64; 2]) {
    let attributes = [
        ("class", CLASSES[k].to_owned()),
        ("x", px(at[0])),
        ("y", px(at[1])),
        ("width", px(size[0])),
        ("height", px(size[1])),
        (
            "fill",
            match k {
                0 => "currentColor".to_owned(),
                _ => format!("url(#{id}-p{k})"),
            },
        ),
        ("stroke", "currentColor".to_owned()),
        ("stroke-width", "0.8".to_owned()),
    ];
    svg.leaf("rect", &attributes);
}

/// Defines the patterns: the first part is filled, the second hatched, the third dotted.
fn patterns(svg: &mut Svg, id: &str) {
    svg.open("defs", &[]);
    for (k, (size, d, width)) in [
        (5.0, "M-1 1l2 -2M0 5l5 -5M4 6l2 -2", "1.4"),
        (4.0, "M1 1h1.3M3 3h1.3", "1.3"),
    ]
    .into_iter()
    .enumerate()
    {
        let k = k + 1;
        svg.open(
            "pattern",
            &[
                ("id", format!("{id}-p{k}")),
                ("class", CLASSES[k].to_owned()),
                ("width", px(size)),
                ("height", px(size)),
                ("patternUnits", "userSpaceOnUse".to_owned()),
            ],
        );
        svg.leaf(
            "path",
            &[
                ("d", d.to_owned()),
                ("stroke", "currentColor".to_owned()),
                ("stroke-width", width.to_owned()),
                ("fill", "none".to_owned()),
            ],
        );
        svg.close();
    }
    svg.close();
}
