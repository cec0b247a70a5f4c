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
    let most = (MOST_POINTS / series.len().max(1)).clamp(60, 720);
    let ends = [records.first(), records.last()].map(|r| r.map_or("none", Record::short));
    html += &format!(
        "<p>{} records, from commit {} to {}. Dashed lines are change points: the first commits of \
         a new level.</p>\n",
        records.len(),
        escape(ends[0]),
        escape(ends[1])
    );
    let thinned = series
        .iter()
        .any(|one| drawn(one, most).len() < one.points.len());
    if thinned {
        html += "<p>Long lines are thinned: the least and the greatest value of each stretch, without \
                 intervals.</p>\n";
    }
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
        html += &chart(one, most);
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

/// The most points that the charts of a page draw together, so that a page of 2,000 commits has at
/// most 5 MB. A chart of few series draws as many as it has pixels.
const MOST_POINTS: usize = 30_000;

/// The indices of the points that are drawn: all, or of equal stretches of the series the least and
/// the greatest value. The ends of levels and of the series are always drawn.
fn drawn(series: &TrendSeries, most: usize) -> Vec<usize> {
    let points = &series.points;
    if points.len() <= most {
        return (0..points.len()).collect();
    }
    let stretch = (2 * points.len()).div_ceil(most);
    let mut drawn: Vec<usize> = vec![0, points.len() - 1];
    for start in (0..points.len()).step_by(stretch) {
        let own = || start..(start + stretch).min(points.len());
        let value = |i: &usize, j: &usize| points[*i].value.total_cmp(&points[*j].value);
        drawn.extend(own().min_by(value));
        // A level without noise is one point.
        drawn.extend(
            own()
                .max_by(value)
                .filter(|&i| points[i].value != points[start].value),
        );
    }
    let ends = series.changes.iter().flat_map(|c| [c.index - 1, c.index]);
    drawn.extend(ends);
    drawn.sort_unstable();
    drawn.dedup();
    drawn
}

/// The SVG chart of a series, with at most about this number of points. The y-axis covers the range
/// of the values and intervals, with a margin of 10 %.
fn chart(series: &TrendSeries, most: usize) -> String {
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
    let drawn = drawn(series, most);
    let is_thinned = drawn.len() < points.len();
    let path = drawn
        .iter()
        .map(|&i| format!("{:.1} {:.1}", x(i as f64), y(points[i].value)));
    let path: Vec<String> = path.collect();
    svg.leaf("path", &[("d", format!("M{}", path.join(" L")))]);
    for i in drawn {
        let (at, point) = (x(i as f64), &points[i]);
        if let Some([low, high]) = point.interval.filter(|_| !is_thinned) {
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

    /// A page of 2,000 commits is usable in a browser.
    #[test]
    fn long_lines_are_thinned_and_keep_their_extremes() {
        let record = history().swap_remove(0);
        let mut records = Vec::new();
        for i in 0..2000 {
            let mut record = record.clone();
            record.commit = format!("{i:012x}");
            let slow = if i >= 1500 { 1.3 } else { 1.0 };
            let cell = record.cells[0].clone();
            let copy = |number: usize| {
                let mut cell = cell.clone();
                cell.cell.model = format!("model {number}");
                cell.cell.sha256 = None;
                for (j, sample) in cell.samples.iter_mut().enumerate() {
                    *sample *= slow * (1.0 + ((i * 7 + j) % 11) as f64 / 1000.0);
                }
                if i == 777 {
                    cell.samples.fill(9.0);
                }
                cell
            };
            record.cells = (0..12).map(copy).collect();
            records.push(record);
        }
        let all = series(&records);
        let found = change_points(&all);
        let history = OrderedHistory {
            records,
            ..OrderedHistory::default()
        };
        let html = page(&history, &all, &found);
        assert!(html.len() < 5_000_000, "{}", html.len());
        assert!(html.contains("Long lines are thinned"));
        let slowest = format!("{:012x}: 9.000000 s", 777);
        assert_eq!(html.matches(&slowest).count(), 12);
        assert_eq!(
            found
                .iter()
                .filter(|change| change.figure == "time")
                .count(),
            12
        );
    }
}
