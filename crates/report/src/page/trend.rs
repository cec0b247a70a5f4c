//! The HTML page of a history: what changed, in words; the figures of every cell over the commits,
//! all charts with the same commits on their axes; the commits.

use geobench_export::escape::xml as escape;
use geobench_export::svg;
use geobench_harness::figures::capitalised;
use geobench_harness::measure::number::{counted, with_unit};
use geobench_harness::measure::statistics::range_of;

use super::chart::{Axis, PlottedCommit, Trend};
use super::html::{STYLE, head};
use crate::history::compare::{exact, percent};
use crate::history::order::OrderedHistory;
use crate::history::records::Record;
use crate::history::trend::{ChangePoint, TrendSeries};
use crate::table::group::by_key;
use crate::table::{self, Column, Entry, Table, table_of_changes};

/// The most cells that a sentence names.
const MOST_NAMED: usize = 3;

/// The page of a history.
pub fn page(history: &OrderedHistory, series: &[TrendSeries], found: &[ChangePoint]) -> String {
    let commits = by_key(&history.records, |record| record.commit.as_str());
    let commits: Vec<&Record> = commits
        .into_iter()
        .filter_map(|(_, own)| {
            let named = own.iter().find(|record| record.subject.is_some());
            named.or(own.first()).copied()
        })
        .collect();
    let most = (MOST_POINTS / series.len().max(1)).clamp(60, 320);
    let mut html = head("Trend of run times", "", [svg::STYLE, STYLE]);
    let places = by_key(series, |one| (&one.machine, &one.suite, &one.cell));
    html += "<nav aria-label=\"Contents\"><ul>\n<li class=\"top\"><a href=\"#changes\">What changed</a></li>\n";
    for (number, ((.., cell), _)) in places.iter().enumerate() {
        html += &format!(
            "<li><a href=\"#cell-{number}\">{}</a></li>\n",
            escape(&cell.to_string())
        );
    }
    html += "<li class=\"top\"><a href=\"#change-points\">Change points</a></li>\n\
             <li class=\"top\"><a href=\"#commits\">Commits</a></li>\n</ul></nav>\n<main>\n";
    let ends = [commits.first(), commits.last()];
    let ends = ends.map(|record| record.map_or_else(|| "none".to_owned(), |r| named(r)));
    html += &format!(
        "<p>{} of {}, from {} to {}.</p>\n",
        counted(history.records.len(), "record"),
        counted(commits.len(), "commit"),
        escape(&ends[0]),
        escape(&ends[1])
    );
    for note in &history.notes {
        html += &format!("<p>{}.</p>\n", escape(&capitalised(note)));
    }
    changes(&mut html, &commits, found);
    html += "<p>In the charts, commits are at equal distances, at the same place in each. A dashed line is \
             a change of level; whiskers are 95 % intervals.";
    if series
        .iter()
        .any(|one| drawn(one, most).len() < one.points.len())
    {
        html += " Long lines are thinned: the least and the greatest value of each stretch, without \
                 intervals.";
    }
    html += "</p>\n";
    for (number, ((machine, suite, cell), own)) in places.into_iter().enumerate() {
        let suite = suite.as_ref().map(|suite| format!("suite {suite}; "));
        html += &format!(
            "<section id=\"cell-{number}\">\n<h2>{}</h2>\n<p>{}{}</p>\n<div class=\"plots\">\n",
            escape(&cell.to_string()),
            escape(&suite.unwrap_or_default()),
            escape(machine)
        );
        for (k, one) in own.into_iter().enumerate() {
            html += &chart(one, &commits, most, &format!("cell-{number}-{k}"));
        }
        html += "</div>\n</section>\n";
    }
    tables(&mut html, &commits, found);
    html += "</main>\n<footer><p>Made by <code>geobench trend</code> ";
    html += env!("CARGO_PKG_VERSION");
    html += ".</p></footer>\n</body>\n</html>\n";
    html
}

/// The day of a commit.
fn day(record: &Record) -> &str {
    record.time().get(..10).unwrap_or_default()
}

/// A commit by its day, hash and subject.
fn named(record: &Record) -> String {
    let subject = record
        .subject
        .iter()
        .map(|subject| format!(", \u{201c}{subject}\u{201d}"));
    let subject: String = subject.collect();
    format!("{} {}{subject}", day(record), record.short())
}

/// What changed, in words: the newest commit first.
fn changes(html: &mut String, commits: &[&Record], found: &[ChangePoint]) {
    html.push_str("<section id=\"changes\">\n<h2>What changed</h2>\n");
    if found.is_empty() {
        html.push_str("<p>No figure has changed its level.</p>\n");
    }
    for record in commits.iter().rev() {
        let own = found
            .iter()
            .filter(|change| change.commit == record.short());
        let own = by_key(own, |change| (change.figure, change.ratio > 1.0));
        if own.is_empty() {
            continue;
        }
        *html += &format!(
            "<h4>{}</h4>\n<ul class=\"prose\">\n",
            escape(&named(record))
        );
        for ((figure, _), alike) in own {
            *html += &format!("<li>{}.</li>\n", escape(&in_words(figure, &alike)));
        }
        html.push_str("</ul>\n");
    }
    html.push_str("</section>\n");
}

/// Changes of one figure at one commit in the same direction, as a sentence.
fn in_words(figure: &str, alike: &[&ChangePoint]) -> String {
    let sizes = alike
        .iter()
        .map(|change| 100.0 * (change.ratio - 1.0).abs());
    let [low, high] = range_of(sizes).unwrap_or_default().map(|size| match size {
        size if size < 9.95 => format!("{size:.1}"),
        _ => format!("{size:.0}"),
    });
    let more = alike.iter().any(|change| change.ratio > 1.0);
    let how = match (figure, more) {
        ("time", true) => "longer",
        ("time", false) => "shorter",
        (_, true) => "more",
        (_, false) => "less",
    };
    let name = name(figure);
    if let [one] = alike {
        let [before, after] = [one.before, one.after].map(|v| self::figure(figure, v));
        return format!(
            "{name}, {}: {high} % {how}, from {before} to {after}",
            one.cell
        );
    }
    let size = if low == high {
        high
    } else {
        format!("{low} to {high}")
    };
    let cells = alike.iter().take(MOST_NAMED);
    let cells: Vec<String> = cells.map(|change| format!("({})", change.cell)).collect();
    let others = match alike.len().saturating_sub(MOST_NAMED) {
        0 => String::new(),
        n => format!(" and {}", counted(n, "other")),
    };
    let count = counted(alike.len(), "cell");
    format!(
        "{name} of {count}: {size} % {how}: {}{others}",
        cells.join(", ")
    )
}

/// The change points with their values, and the commits.
fn tables(html: &mut String, commits: &[&Record], found: &[ChangePoint]) {
    html.push_str("<section id=\"change-points\">\n<h2>Change points</h2>\n");
    let changes = Table {
        id: "changes-table".to_owned(),
        caption:
            "The first commits of new levels. Each figure by the medians of the level before and \
                  of the new one."
                .to_owned(),
        ..table_of_changes(found, figure)
    };
    table::html::table(html, &changes);
    html.push_str("</section>\n<section id=\"commits\">\n<h2>Commits</h2>\n");
    let rows = commits.iter().rev().map(|record| {
        let subject = record.subject.clone().unwrap_or_default();
        [day(record).to_owned(), record.short().to_owned(), subject]
            .map(Entry::new)
            .into()
    });
    let table = Table {
        id: "commits-table".to_owned(),
        caption: "The commits with records, the newest first.".to_owned(),
        ..Table::new(
            Column::of(["Date", "Commit", "Subject"], [""; 0]),
            rows.collect(),
        )
    };
    table::html::table(html, &table);
    html.push_str("</section>\n");
}

/// The name of a figure in words.
fn name(figure: &str) -> String {
    match figure {
        "heap_peak_bytes" => "Peak heap".to_owned(),
        "propagated" | "kept" => format!("Windows {figure}"),
        _ => capitalised(&figure.replace('_', " ")),
    }
}

/// A value of a figure with its unit.
fn figure(name: &str, value: f64) -> String {
    match name {
        "time" => with_unit(value),
        "heap_peak_bytes" => {
            let (unit, size) = unit(name, value);
            format!("{:.2} {unit}", value / size)
        }
        _ => exact(value),
    }
}

/// The unit in which values of a figure up to `largest` are shown; empty for counts.
fn unit(figure: &str, largest: f64) -> (&'static str, f64) {
    let units: &[(&str, f64)] = match figure {
        "time" => &[("s", 1.0), ("ms", 1e-3), ("\u{b5}s", 1e-6), ("ns", 1e-9)],
        "heap_peak_bytes" => &[("GB", 1e9), ("MB", 1e6), ("kB", 1e3), ("B", 1.0)],
        _ => &[("", 1.0)],
    };
    let fits = units.iter().find(|(_, size)| largest >= *size);
    *fits.unwrap_or(&units[units.len() - 1])
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

/// The chart of a series, with at most about `most` points.
fn chart(series: &TrendSeries, commits: &[&Record], most: usize, id: &str) -> String {
    let points = &series.points;
    let largest = points.iter().map(|point| point.value).fold(0.0, f64::max);
    let (unit, size) = unit(series.figure, largest);
    let drawn = drawn(series, most);
    let is_thinned = drawn.len() < points.len();
    let mark = |i: usize| {
        let point = &points[i];
        let value = figure(series.figure, point.value);
        PlottedCommit {
            place: point.place,
            value: point.value / size,
            interval: point
                .interval
                .filter(|_| !is_thinned)
                .map(|ends| ends.map(|end| end / size)),
            text: format!("{} {}: {value}", day(commits[point.place]), point.commit),
        }
    };
    let change = |change: &crate::history::changes::LevelChange| {
        // Between the last commit of the old level and the first of the new one.
        let [before, after] = [change.index - 1, change.index].map(|i| points[i].place as f64);
        (f64::midpoint(before, after), percent(change.ratio()))
    };
    let label = |place: Option<usize>| place.map_or("", |place| day(commits[place])).to_owned();
    let last = commits.len().saturating_sub(1);
    let middle = Some(last / 2).filter(|_| last > 1 && last.is_multiple_of(2));
    let title = match unit {
        "" => name(series.figure),
        unit => format!("{} ({unit})", name(series.figure)),
    };
    let end = points.last();
    let end = end.map_or_else(String::new, |p| figure(series.figure, p.value));
    let caption = format!("{}; the newest: {end}.", counted(points.len(), "commit"));
    let description = series.changes.iter().fold(caption.clone(), |text, change| {
        let commit = &points[change.index].commit;
        format!("{text} {} from {commit}.", percent(change.ratio()))
    });
    let chart = Trend {
        y: Axis::linear(&title),
        commits: commits.len(),
        labels: [
            label(Some(0)),
            label(middle),
            label(Some(last).filter(|last| *last > 0)),
        ],
        points: drawn.into_iter().map(mark).collect(),
        changes: series.changes.iter().map(change).collect(),
    };
    format!(
        "<figure id=\"{id}\">\n<figcaption><b>{}</b> {}</figcaption>\n{}</figure>\n",
        escape(&title),
        escape(&caption),
        chart.draw(id, &title, &description)
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::history::trend::tests::history;
    use crate::history::trend::{change_points, series};

    #[test]
    fn every_cell_has_its_charts_and_changes_are_named() {
        let mut records = history();
        records[12].subject = Some("Sort <windows>".to_owned());
        let all = series(&records);
        let history = OrderedHistory {
            records,
            ..OrderedHistory::default()
        };
        let html = page(&history, &all, &change_points(&all));
        assert_eq!(html.matches("<svg ").count(), all.len());
        assert!(html.contains(">00000000000c</th><td>horse, vtp, source 0</td><td>time</td>"));
        assert_eq!(html.matches("class=\"one\"").count(), 3);
        assert!(!html.contains("NaN") && !html.contains("inf"));
        assert!(!html.contains("http://www.w3.org/1999") && !html.contains("<script"));
        // What changed, in words, the newest commit first.
        let words = [
            "<h4>2025-03-13 00000000000c, \u{201c}Sort &lt;windows&gt;\u{201d}</h4>",
            "<li>Time, horse, vtp, source 0: 15 % longer, from ",
            "<h4>2025-03-09 000000000008</h4>",
            "<li>Windows propagated of 2 cells: 50 % more: (horse, mmp, source 0), (horse, vtp, source 0).</li>",
        ];
        let places = words.map(|words| html.find(words).unwrap_or_else(|| panic!("{words}")));
        assert!(places.is_sorted());
        // Units and dates.
        for text in ["<b>Time (", ">2025-03-01</text>", ">2025-03-20</text>"] {
            assert!(html.contains(text), "{text}");
        }
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
        let slowest = format!("{:012x}: 9.00 s", 777);
        assert_eq!(html.matches(&slowest).count(), 12);
        assert_eq!(
            found
                .iter()
                .filter(|change| change.figure == "time")
                .count(),
            12
        );
    }

    /// A commit is at the same place in every chart, also if a cell lacks some.
    #[test]
    fn charts_share_their_commits() {
        let mut records = history();
        for record in &mut records[..10] {
            record.cells.remove(0);
        }
        let all = series(&records);
        let times: Vec<&TrendSeries> = all.iter().filter(|one| one.figure == "time").collect();
        let place = |one: &TrendSeries| one.points.last().unwrap().place;
        assert_eq!([times[0], times[1]].map(place), [19, 19]);
        assert_eq!(times[1].points.len(), 10);
    }
}
