//! Tables and plots in LaTeX, with booktabs and pgfplots. The files contain the numbers, so that a
//! paper typesets them in its own font.

use std::borrow::Cow;
use std::fmt::Write;

use geobench_export::escape::printable;

use super::chart::{Axis, Bars, Chart, ChartPoint, Dots, Lines, pgf_mark};
use super::document::Plot;
use crate::table::Table;
use crate::table::group::{Estimate, distinct};
use crate::table::latex::{self, escape};

/// A `tabular` under its caption.
pub(super) fn table(table: &Table) -> String {
    let caption = remark(&table.caption);
    format!("% {caption}\n{}{}", latex::NEEDS, latex::tabular(table))
}

/// `text` in one line, for a comment.
fn remark(text: &str) -> Cow<'_, str> {
    printable(text)
}

/// A `tikzpicture`, or the command that includes the PNG file of a picture.
pub(super) fn plot(plot: &Plot) -> String {
    let head = format!("% {}. {}\n", remark(&plot.title), remark(&plot.caption));
    let body = match &plot.chart {
        Chart::Dots(chart) => dots(chart),
        Chart::Bars(chart) => bars(chart),
        Chart::Lines(chart) => lines(chart),
        Chart::Picture(_) => {
            return format!(
                "{head}% Needs \\usepackage{{graphicx}}.\n\\includegraphics[width=\\linewidth]{{{}.png}}\n",
                plot.id
            );
        }
    };
    format!("{head}% Needs \\usepackage{{pgfplots}} and \\pgfplotsset{{compat=1.18}}.\n{body}")
}

fn axis_of(name: char, axis: &Axis) -> String {
    let mode = if axis.log { "log" } else { "linear" };
    format!(
        "  {name}mode={mode}, {name}label={{{}}},\n",
        escape(&axis.label)
    )
}

/// Axis options that put a label at each integer of the y-axis, from 0 at the top.
fn rows(labels: &[String]) -> String {
    let places: Vec<String> = (0..labels.len()).map(|i| i.to_string()).collect();
    let labels: Vec<String> = labels
        .iter()
        .map(|label| format!("{{{}}}", escape(label)))
        .collect();
    format!(
        "  y dir=reverse, ymin=-0.7, ymax={:.1}, height={:.1}cm,\n  ytick={{{}}}, yticklabels={{{}}},\n",
        labels.len() as f64 - 0.3,
        2.2 + 0.42 * labels.len() as f64,
        places.join(","),
        labels.join(",")
    )
}

/// The label of a lane. Only the first lane of a model has its name.
fn label(band: &str, lane: &str, first: bool) -> String {
    if first && !band.is_empty() {
        format!("{band}: {lane}")
    } else {
        lane.to_owned()
    }
}

fn dots(chart: &Dots) -> String {
    let mut labels = Vec::new();
    let mut points: Vec<(usize, &ChartPoint)> = Vec::new();
    let mut absent = String::new();
    for band in &chart.bands {
        for (i, lane) in band.lanes.iter().enumerate() {
            if let Some(text) = &lane.absent {
                let _ = writeln!(
                    absent,
                    "% {}, {}: {}",
                    remark(&band.title),
                    remark(&lane.label),
                    remark(text)
                );
            }
            points.extend(lane.points.iter().map(|point| (labels.len(), point)));
            labels.push(label(&band.title, &lane.label, i == 0));
        }
    }
    let mut tex = format!(
        "{absent}\\begin{{tikzpicture}}\n\\begin{{axis}}[\n  width=\\linewidth, only marks, xmajorgrids,\n{}{}]\n",
        axis_of('x', &chart.axis),
        rows(&labels)
    );
    if let Some(place) = chart.reference {
        let _ = writeln!(
            tex,
            "\\draw[dashed] ({{axis cs:{place},0}} |- {{rel axis cs:0,0}}) -- ({{axis cs:{place},0}} |- {{rel axis cs:0,1}});"
        );
    }
    let lanes = chart.bands.iter().flat_map(|band| &band.lanes).enumerate();
    let samples =
        lanes.flat_map(|(y, lane)| lane.samples.iter().map(move |x| format!("({x},{y})")));
    let samples: Vec<String> = samples.collect();
    if !samples.is_empty() {
        let _ = writeln!(
            tex,
            "\\addplot[mark=*, mark size=0.6pt, gray, forget plot] coordinates {{\n  {}\n}};",
            samples.join("\n  ")
        );
    }
    let series = points.iter().map(|(_, point)| (point.style, point.hollow));
    for (style, hollow) in distinct(series) {
        let of = points
            .iter()
            .filter(|(_, p)| (p.style, p.hollow) == (style, hollow));
        let coordinates = of.map(|(y, p)| {
            let at = format!("({},{y})", p.value.value);
            at + &errors(p.value, |error| format!("({error},0)"))
        });
        tex += &addplot(style, hollow, &["x"], coordinates);
        let mut names = chart.legend.iter();
        if let Some((.., name)) = names.find(|(s, h, _)| (*s, *h) == (style, hollow)) {
            let _ = writeln!(tex, "\\addlegendentry{{{}}}", escape(name));
        }
    }
    tex + "\\end{axis}\n\\end{tikzpicture}\n"
}

/// The error bars of an interval, in pgfplots syntax.
fn errors(value: Estimate, at: impl Fn(f64) -> String) -> String {
    value.interval.map_or_else(String::new, |[low, high]| {
        let (up, down) = ((high - value.value).max(0.0), (value.value - low).max(0.0));
        format!(" += {} -= {}", at(up), at(down))
    })
}

/// A plot with error bars along the axes `along`.
fn addplot(
    style: usize,
    hollow: bool,
    along: &[&str],
    coordinates: impl Iterator<Item = String>,
) -> String {
    let mut bars = String::new();
    for axis in along {
        bars += &format!(", {axis} dir=both, {axis} explicit");
    }
    format!(
        "\\addplot+[mark={}, mark options={{solid}}, error bars/.cd{bars}] coordinates {{\n  {}\n}};\n",
        pgf_mark(style, hollow),
        coordinates.collect::<Vec<_>>().join("\n  ")
    )
}

fn bars(chart: &Bars) -> String {
    let mut labels = Vec::new();
    let mut parts: [Vec<String>; super::chart::PARTS] = Default::default();
    for group in &chart.groups {
        for (i, bar) in group.bars.iter().enumerate() {
            for (coordinates, length) in parts.iter_mut().zip(bar.parts) {
                coordinates.push(format!("({length},{})", labels.len()));
            }
            let name = format!("{} ({})", bar.label, bar.note);
            labels.push(label(&group.title, &name, i == 0));
        }
    }
    let mut tex = format!(
        "\\begin{{tikzpicture}}\n\\begin{{axis}}[\n  xbar stacked, width=\\linewidth, xmin=0, bar width=6pt, xmajorgrids,\n  \
         legend style={{at={{(0.5,1.02)}}, anchor=south, legend columns=-1, draw=none}},\n{}{}]\n",
        axis_of('x', &chart.axis),
        rows(&labels)
    );
    for (name, coordinates) in chart.parts.iter().zip(parts) {
        let _ = writeln!(
            tex,
            "\\addplot+[mark=none] coordinates {{ {} }};\n\\addlegendentry{{{}}}",
            coordinates.join(" "),
            escape(name)
        );
    }
    tex + "\\end{axis}\n\\end{tikzpicture}\n"
}

fn lines(chart: &Lines) -> String {
    let joined = chart.series.iter().any(|series| series.joined);
    let mut tex = format!(
        "\\begin{{tikzpicture}}\n\\begin{{axis}}[\n  width=\\linewidth, grid=major, legend pos=outer north east,{}\n{}{}]\n",
        if joined { "" } else { " only marks," },
        axis_of('x', &chart.x),
        axis_of('y', &chart.y)
    );
    if let Some(place) = chart.reference {
        let _ = writeln!(
            tex,
            "\\draw[dashed] ({{rel axis cs:0,0}} |- {{axis cs:1,{place}}}) -- ({{rel axis cs:1,0}} |- {{axis cs:1,{place}}});"
        );
    }
    for series in &chart.series {
        let is_mean = series.points.iter().any(|point| point.deviation.is_some());
        let coordinates = series.points.iter().map(|point| {
            let at = format!("({},{})", point.x, point.value.value);
            let of_mean = point.deviation.filter(|_| point.value.interval.is_none());
            match of_mean {
                Some(deviation) => format!("{at} +- ({deviation},0)"),
                None => at + &errors(point.value, |error| format!("(0,{error})")),
            }
        });
        let along: &[&str] = if is_mean { &["x"] } else { &["y"] };
        tex += &addplot(series.style, series.hollow, along, coordinates);
        let _ = writeln!(tex, "\\addlegendentry{{{}}}", escape(&series.name));
        if let Some(fit) = series.fit {
            let ([from, to], factor, exponent) = (fit.ends, fit.factor, fit.exponent);
            let _ = writeln!(
                tex,
                "\\addplot[dashed, forget plot, domain={from}:{to}] {{{factor} * x^{exponent}}};"
            );
        }
    }
    for (_, front) in chart.fronts() {
        let places: Vec<String> = front.iter().map(|[x, y]| format!("({x},{y})")).collect();
        let _ = writeln!(
            tex,
            "\\addplot[const plot, dotted, mark=none, forget plot] coordinates {{ {} }};",
            places.join(" ")
        );
    }
    tex + "\\end{axis}\n\\end{tikzpicture}\n"
}
