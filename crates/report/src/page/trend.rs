//! The HTML page of a history: the figures of every cell over the commits, with change points.

use geobench_export::escape::xml as escape;
use geobench_export::svg::Svg;
use geobench_harness::measure::statistics::range_of;

use super::html::{STYLE, head};
use crate::history::compare::{exact, percent};
use crate::history::order::OrderedHistory;
use crate::history::records::Record;
use crate::history::trend::{ChangePoint, TrendSeries};
use crate::table::{self, Table, table_of_changes};

/// The style sheet of the charts. Lines have the colour of the text.
const CHARTS: &str = "
svg.trend { width: 100%; height: auto; max-width: 60rem; color: inherit; }
svg.trend path { fill: none; stroke: currentColor; stroke-width: 1; }
svg.trend circle { fill: currentColor; }
svg.trend .interval { stroke: currentColor; stroke-width: 1; opacity: 0.5; }
svg.trend .change { stroke: #c0392b; stroke-width: 1.5; stroke-dasharray: 4 3; }
svg.trend text { fill: currentColor; font: 11px sans-serif; }
";

const WIDTH: f64 = 720.0;
const HEIGHT: f64 = 150.0;
const LEFT: f64 = 90.0;
const RIGHT: f64 = 12.0;
const TOP: f64 = 14.0;
const BOTTOM: f64 = 26.0;

/// The page of a history: a table of the change points, then a chart for each series.
pub fn page(history: &OrderedHistory, series: &[TrendSeries], found: &[ChangePoint]) -> String {
    let mut html = head("Trend of run times", "", [STYLE, CHARTS]) + "<main>\n";
    let records = &history.records;
    let ends = [records.first(), records.last()].map(|r| r.map_or("none", Record::short));
    html += &format!(
        "<p>{} records, from commit {} to {}. Dashed lines are change points: the first commits of \
         a new level.</p>\n",
        records.len(),
        escape(ends[0]),
        escape(ends[1])
    );
    for note in &history.notes {
        html += &format!("<p>{}</p>\n", escape(note));
    }
    html += "<section id=\"changes\">\n<h2>Change points</h2>\n";
    if found.is_empty() {
        html += "<p>No figure has changed its level.</p>\n";
    } else {
        let table = Table {
            id: "changes-table".to_owned(),
            caption: "Each figure by the medians of the level before and of the new one."
                .to_owned(),
            ..table_of_changes(found, figure)
        };
        table::html::table(&mut html, &table);
    }
    html += "</section>\n";
    let mut last = None;
    for one in series {
        let place = (&one.machine, &one.suite, one.cell.to_string());
        if last.as_ref() != Some(&place) {
            let suite = match &one.suite {
                Some(suite) => format!("suite {suite}; "),
                None => String::new(),
            };
            html += &format!(
                "<h2>{}</h2>\n<p>{}{}</p>\n",
                escape(&place.2),
                escape(&suite),
                escape(&one.machine)
            );
            last = Some(place);
        }
        html += &chart(one);
    }
    html += "</main>\n<footer><p>Made by <code>geobench trend</code> ";
    html += env!("CARGO_PKG_VERSION");
    html += ".</p></footer>\n</body>\n</html>\n";
    html
}

/// A value of a figure with its unit.
fn figure(name: &str, value: f64) -> String {
    match name {
        "time" => format!("{value:.6} s"),
        _ => exact(value),
    }
}

/// The SVG chart of a series. The y-axis covers the range of the values and intervals, with a
/// margin of 10 %.
fn chart(series: &TrendSeries) -> String {
    let points = &series.points;
    let ends = points
        .iter()
        .flat_map(|p| p.interval.unwrap_or([p.value; 2]));
    let ends = ends.chain(points.iter().map(|p| p.value));
    let [low, high] = range_of(ends).unwrap_or_default();
    let margin = ((high - low) * 0.1)
        .max(high.abs() * 1e-3)
        .max(f64::MIN_POSITIVE);
    let (low, high) = ((low - margin).max(0.0), high + margin);
    let steps = points.len().saturating_sub(1).max(1) as f64;
    let x = |place: f64| LEFT + (WIDTH - LEFT - RIGHT) * place / steps;
    let y = |value: f64| TOP + (HEIGHT - TOP - BOTTOM) * (high - value) / (high - low);
    let mut svg = Svg::default();
    let mut label = format!(
        "{}: {} commits, the last at {}",
        series.figure,
        points.len(),
        points
            .last()
            .map_or_else(String::new, |p| figure(series.figure, p.value))
    );
    for change in &series.changes {
        label += &format!(
            "; {} from {}",
            percent(change.ratio()),
            points[change.index].commit
        );
    }
    svg.open(
        "svg",
        &[
            ("class", "trend".to_owned()),
            ("xmlns", "http://www.w3.org/2000/svg".to_owned()),
            ("viewBox", format!("0 0 {WIDTH} {HEIGHT}")),
            ("role", "img".to_owned()),
            ("aria-label", label),
        ],
    );
    svg.text([4.0, TOP], "name", series.figure);
    for value in [low, high] {
        svg.text(
            [4.0, y(value).clamp(2.0 * TOP, HEIGHT - BOTTOM)],
            "tick",
            &short(value),
        );
    }
    for change in &series.changes {
        // The line lies between the last commit of the old level and the first of the new one.
        let at = x(change.index as f64 - 0.5);
        svg.line("change", [at, TOP], [at, HEIGHT - BOTTOM]);
        svg.text([at + 3.0, TOP], "commit", &points[change.index].commit);
    }
    let path: Vec<String> = points
        .iter()
        .enumerate()
        .map(|(i, p)| format!("{:.1} {:.1}", x(i as f64), y(p.value)))
        .collect();
    svg.leaf("path", &[("d", format!("M{}", path.join(" L")))]);
    for (i, point) in points.iter().enumerate() {
        let at = x(i as f64);
        if let Some([low, high]) = point.interval {
            svg.line("interval", [at, y(low)], [at, y(high)]);
        }
        svg.open(
            "circle",
            &[
                ("cx", format!("{at:.1}")),
                ("cy", format!("{:.1}", y(point.value))),
                ("r", "2".to_owned()),
            ],
        );
        let text = format!("{}: {}", point.commit, figure(series.figure, point.value));
        svg.holding("title", &[], &text);
        svg.close();
    }
    svg.text([LEFT, HEIGHT - 8.0], "commit", &points[0].commit);
    if let [_, .., last] = &points[..] {
        let right = [WIDTH - RIGHT - 80.0, HEIGHT - 8.0];
        svg.text(right, "commit", &last.commit);
    }
    svg.finish()
}

/// A number in few characters, for labels.
fn short(value: f64) -> String {
    match value.abs() {
        size if size == 0.0 || (1e-3..1e4).contains(&size) => {
            let digits = if size < 1.0 { 4 } else { 2 };
            format!("{value:.digits$}")
        }
        _ => format!("{value:.3e}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::history::trend::tests::history;
    use crate::history::trend::{change_points, series};

    #[test]
    fn every_cell_has_its_charts_and_changes_are_named() {
        let records = history();
        let all = series(&records);
        let history = OrderedHistory {
            records,
            ..OrderedHistory::default()
        };
        let html = page(&history, &all, &change_points(&all));
        assert_eq!(html.matches("<svg class=\"trend\"").count(), all.len());
        assert!(html.contains(">00000000000c</th><td>horse, vtp, source 0</td><td>time</td>"));
        assert_eq!(html.matches("class=\"change\"").count(), 3);
        assert!(!html.contains("NaN") && !html.contains("inf"));
        assert!(!html.contains("http://www.w3.org/1999") && !html.contains("<script"));
    }
}
