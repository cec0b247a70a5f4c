//! Writes comparisons of two result files as tables, Markdown and JSON.

use std::collections::{HashMap, HashSet};

use geobench_export::escape::{markdown as escape, markdown_line, printable};
use geobench_export::{FileFormat, json_lines};
use geobench_harness::figures::capitalised;
use geobench_harness::measure::number::{counted, decimals};
use geobench_harness::schema::Status;

use crate::history::compare::{
    BaselineComparisons, CellChange, CellKey, ComparedFile, FigureChange, FileComparison,
    ImprovedFigure, Regression, TimeMethod, exact, percent,
};
use crate::table::group::distinct;
use crate::table::markdown;
use crate::table::model::{Column, Entry, Mark, Table};
use crate::table::terminal::{self, Look};

/// An output format of comparisons.
#[derive(Default, Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub enum ComparisonFormat {
    /// A table for the terminal.
    #[default]
    Table,
    /// For a comment on a pull request: a summary, a table, and everything else folded away.
    Markdown,
    /// Everything.
    Json,
}

impl FileFormat for ComparisonFormat {
    const CONTENT: &'static str = "results";
    const ENDINGS: &'static [(&'static str, Self)] = &[
        ("json", Self::Json),
        ("md", Self::Markdown),
        ("txt", Self::Table),
    ];
}

impl ComparisonFormat {
    /// A comparison in this format, ending in a line break. `look` is the style of tables.
    ///
    /// # Errors
    ///
    /// Only if a number cannot be represented, which does not occur in comparisons.
    pub fn render(self, comparison: &FileComparison, look: Look) -> anyhow::Result<String> {
        Ok(match self {
            Self::Table => in_terminal(comparison, look),
            Self::Markdown => in_markdown(comparison),
            Self::Json => json_lines(comparison)?,
        })
    }

    /// Several comparisons with one baseline in this format, with a column for each file.
    ///
    /// # Errors
    ///
    /// As [`render`](Self::render).
    pub fn render_several(
        self,
        several: &BaselineComparisons,
        look: Look,
    ) -> anyhow::Result<String> {
        let table = ratios(several);
        let sides = several.comparisons.iter().map(|c| &c.new);
        let sides: Vec<&ComparedFile> = several
            .comparisons
            .first()
            .map(|c| &c.old)
            .into_iter()
            .chain(sides)
            .collect();
        let worse: Vec<String> = several
            .comparisons
            .iter()
            .flat_map(|c| {
                let name = &c.new.file;
                worse(c)
                    .into_iter()
                    .map(move |line| format!("{name}: {line}"))
            })
            .collect();
        let notes = several.comparisons.iter().flat_map(|c| {
            let name = &c.new.file;
            c.notes.iter().map(move |note| format!("{name}: {note}"))
        });
        let notes: Vec<String> = worse.into_iter().chain(notes).collect();
        Ok(match self {
            Self::Json => json_lines(several)?,
            Self::Table => {
                let line = |indent, text: &str| terminal::line_in(look, indent, &printable(text));
                let mut lines: Vec<String> = sides.iter().map(|s| line("", &side(s))).collect();
                lines.push(String::new());
                lines.push(terminal::grid(&table, &table.parts[0].rows, look));
                lines.extend(notes.iter().map(|note| line("  ", note)));
                lines.join("\n") + "\n"
            }
            Self::Markdown => {
                let mut lines = markdown::grid(&table);
                lines.push(String::new());
                let remarks = sides.iter().map(|s| side(s)).chain(notes);
                lines.extend(remarks.map(|text| format!("- {}", markdown_line(&text))));
                lines.join("\n") + "\n"
            }
        })
    }
}

/// A row for each cell that the baseline and another file have: the time in the baseline, and the
/// ratio of the time in every other file to it.
fn ratios(several: &BaselineComparisons) -> Table {
    let changes = several.comparisons.iter().flat_map(|c| &c.cells);
    let mut known = HashSet::new();
    let cells = changes.filter(|change| known.insert(change.cell.identity()));
    let cells: Vec<&CellChange> = cells.collect();
    let by_cell: Vec<HashMap<CellKey, &CellChange>> = (several.comparisons.iter())
        .map(|c| {
            c.cells
                .iter()
                .rev()
                .map(|c| (c.cell.identity(), c))
                .collect()
        })
        .collect();
    let baseline = several.comparisons.first().map(|c| c.old.file.as_str());
    let files = several.comparisons.iter().map(|c| c.new.file.as_str());
    let names = baseline.into_iter().chain(files);
    let rows = cells.iter().map(|cell| {
        let identity = cell.cell.identity();
        let of = |changes: &HashMap<CellKey, &CellChange>| {
            let Some(change) = changes.get(&identity) else {
                return Entry::new("-");
            };
            let broken = !change.regressions.is_empty();
            match &change.time {
                Some(time) => {
                    let interval = time
                        .ci95
                        .map_or_else(String::new, |[low, high]| format!(" [{low:.2}, {high:.2}]"));
                    marked(format!("{:.2}{interval}", time.ratio), broken)
                }
                None => marked(change.status[1].in_words(), broken),
            }
        };
        let mut changes = by_cell.iter().filter_map(|changes| changes.get(&identity));
        let first = changes.find_map(|change| Some(change.time.as_ref()?.medians[0]));
        let first = first.map_or_else(
            || "-".to_owned(),
            |median| format!("1 ({median:.*} s)", decimals([median], 9)),
        );
        let entries = by_cell.iter().map(of);
        let head = [Entry::new(cell.cell.to_string()), Entry::new(first)];
        head.into_iter().chain(entries).collect()
    });
    let columns = Column::of(["Time relative to the first"], names);
    Table::new(columns, rows.collect())
}

/// Figures that the table shows even without a rule on them, if a cell has them.
const USUAL: [&str; 3] = ["propagated", "instructions", "heap_peak_bytes"];

fn in_terminal(comparison: &FileComparison, look: Look) -> String {
    let table = changes(comparison);
    let line = |text: String| terminal::line_in(look, "", &printable(&text));
    let mut text = format!(
        "{}\n{}\n{}\n\n{}\n",
        line(format!("old: {}", side(&comparison.old))),
        line(format!("new: {}", side(&comparison.new))),
        line(method(comparison)),
        terminal::grid(&table, &table.parts[0].rows, look)
    );
    for (title, lines) in [
        ("worse", worse(comparison)),
        ("better", better(comparison)),
        ("only in the old file", listed(&comparison.missing)),
        ("only in the new file", listed(&comparison.added)),
        ("to know", comparison.notes.clone()),
    ] {
        if !lines.is_empty() {
            let lines = lines.iter();
            let lines = lines.map(|line| terminal::line_in(look, "  ", &printable(line)));
            let lines: Vec<String> = lines.collect();
            text += &[title, ":\n", &lines.join("\n"), "\n"].concat();
        }
    }
    text + &line(summary(comparison)) + "\n"
}

fn in_markdown(comparison: &FileComparison) -> String {
    let mut lines = vec![
        format!("### geobench: {}", escape(&summary(comparison))),
        String::new(),
    ];
    let bullets = |lines: &[String]| -> Vec<String> {
        lines
            .iter()
            .map(|line| format!("- {}", markdown_line(line)))
            .collect()
    };
    let worse = worse(comparison);
    if !worse.is_empty() {
        lines.extend(bullets(&worse));
        lines.push(String::new());
    }
    lines.extend(markdown::grid(&changes(comparison)));
    lines.push(String::new());
    lines.push(format!(
        "Old: {}. New: {}. {}.",
        escape(&side(&comparison.old)),
        escape(&side(&comparison.new)),
        escape(&method(comparison))
    ));
    lines.push(String::new());
    if !comparison.notes.is_empty() {
        lines.extend(bullets(&comparison.notes));
        lines.push(String::new());
    }
    let mut fold = |title: String, contents: Vec<String>| {
        lines.extend([
            format!("<details><summary>{title}</summary>"),
            String::new(),
        ]);
        lines.extend(contents);
        lines.extend([String::new(), "</details>".to_owned(), String::new()]);
    };
    fold(
        "Times, and all other figures that differ".to_owned(),
        markdown::grid(&figures(comparison)),
    );
    let better = better(comparison);
    if !better.is_empty() {
        fold(format!("Better: {}", better.len()), bullets(&better));
    }
    for (which, keys) in [("old", &comparison.missing), ("new", &comparison.added)] {
        if !keys.is_empty() {
            let title = format!("Only in the {which} file: {}", keys.len());
            fold(title, bullets(&listed(keys)));
        }
    }
    lines.join("\n").trim_end().to_owned() + "\n"
}

fn summary(comparison: &FileComparison) -> String {
    let cells = comparison.cells.len();
    let compared = match comparison.regressions {
        0 => format!("none of {cells} cells is worse"),
        1 => format!("1 of {cells} cells is worse"),
        worse => format!("{worse} of {cells} cells are worse"),
    };
    let better = comparison.cells.iter();
    let better = better.filter(|c| c.regressions.is_empty() && !c.improvements.is_empty());
    let better = match better.count() {
        0 => None,
        1 => Some("1 is better".to_owned()),
        better => Some(format!("{better} are better")),
    };
    let overall = comparison
        .overall
        .iter()
        .map(|regression| regression.what.clone());
    std::iter::once(compared)
        .chain(better)
        .chain(overall)
        .collect::<Vec<String>>()
        .join("; ")
}

fn side(side: &ComparedFile) -> String {
    // As many digits as git shows.
    let short = |commit: &String| commit.get(..12).unwrap_or(commit).to_owned();
    let built = side.commit.as_ref().map(short);
    let measured = match (&side.repository, built) {
        (Some(commit), built) => {
            let built = built.unwrap_or_else(|| side.version.clone());
            format!("commit {}, by geobench {built}", short(commit))
        }
        (None, Some(built)) => format!("commit {built}"),
        (None, None) => format!("version {}", side.version),
    };
    format!("{} ({measured}, {})", side.file, side.started)
}

fn method(comparison: &FileComparison) -> String {
    let times = if comparison.paired {
        "times are compared pair by pair, of runs that took turns, with 95 % intervals"
    } else {
        "times are compared as wholes, for the runs did not take turns, with 95 % intervals"
    };
    let rules = match comparison.rules.join(",") {
        rules if rules.is_empty() => "no rules, so that no figure is judged".to_owned(),
        rules => format!("rules: {rules} (! is worse)"),
    };
    format!("{rules}; {times}")
}

fn worse(comparison: &FileComparison) -> Vec<String> {
    let with_rule = |regression: &Regression| {
        let rule = regression.rule.as_ref();
        let rule = rule.map_or_else(String::new, |rule| format!(" [{rule}]"));
        format!("{}{rule}", regression.what)
    };
    let of_cell = |change: &CellChange| {
        let regressions = change.regressions.iter();
        let lines =
            regressions.map(|regression| format!("{}: {}", change.cell, with_rule(regression)));
        lines.collect::<Vec<String>>()
    };
    let of_cells = comparison.cells.iter().flat_map(of_cell);
    of_cells
        .chain(comparison.overall.iter().map(with_rule))
        .collect()
}

fn better(comparison: &FileComparison) -> Vec<String> {
    let of_cell = |change: &CellChange| {
        let improvements = change.improvements.iter();
        let line = |improved: &ImprovedFigure| {
            format!("{}: {} [{}]", change.cell, improved.what, improved.rule)
        };
        improvements.map(line).collect::<Vec<String>>()
    };
    comparison.cells.iter().flat_map(of_cell).collect()
}

fn listed(keys: &[CellKey]) -> Vec<String> {
    keys.iter().map(ToString::to_string).collect()
}

/// The names of cells in tables. Group and source are left out if all cells share them.
fn names(comparison: &FileComparison) -> impl Fn(&CellKey) -> String {
    let mut keys = comparison.cells.iter().map(|change| &change.cell);
    let first = keys.next();
    let differ = |(groups, sources): (bool, bool), key: &CellKey| {
        let group = first.is_some_and(|first| first.group != key.group);
        let source = first.is_some_and(|first| first.source != key.source);
        (groups || group, sources || source)
    };
    let (groups, sources) = keys.fold((false, false), differ);
    move |key| key.among(groups, sources)
}

/// A row for each cell: how its time and the most important figures have changed.
fn changes(comparison: &FileComparison) -> Table {
    let ruled = |name: &str| {
        let rule = |rule: &String| rule.split('=').next() == Some(name);
        comparison.rules.iter().any(rule)
    };
    let figures = comparison.cells.iter().flat_map(|c| &c.figures);
    let names = figures.map(|figure| figure.name);
    let names = distinct(names.filter(|name| USUAL.contains(name) || ruled(name)));
    let numbers = std::iter::once("Time").chain(names.iter().copied());
    let columns = Column::of(["Cell"], numbers.map(heading));
    let name = self::names(comparison);
    let row = |change: &CellChange| {
        let mut row = vec![Entry::new(name(&change.cell)), time(change)];
        row.extend(names.iter().map(|name| {
            let figure = change.figures.iter().find(|f| f.name == *name);
            figure.map_or_else(|| Entry::new("-"), |figure| entry(change, figure))
        }));
        row
    };
    Table::new(columns, comparison.cells.iter().map(row).collect())
}

/// The name of a figure as a heading.
fn heading(name: &str) -> String {
    capitalised(&name.trim_end_matches("_bytes").replace('_', " "))
}

/// Whether a rule on the figure `name` is broken in `change`.
fn is_broken(change: &CellChange, name: &str) -> bool {
    let rules = change.regressions.iter().filter_map(|r| r.rule.as_deref());
    rules
        .filter_map(|rule| rule.split('=').next())
        .any(|n| n == name)
}

/// A text, marked with `!` if its rule is broken.
fn marked(text: String, broken: bool) -> Entry {
    if broken {
        Entry::marked(text + " !", Mark::Failed)
    } else {
        Entry::new(text)
    }
}

fn time(change: &CellChange) -> Entry {
    match (&change.time, change.status) {
        (Some(time), _) => {
            let text = match time.p {
                Some(p) => format!("{}, p {p:.2}", time.in_words()),
                None => time.in_words(),
            };
            marked(text, is_broken(change, "time"))
        }
        (None, [Status::Ok, Status::Ok]) if is_broken(change, "time") => {
            marked("missing".to_owned(), true)
        }
        (None, [Status::Ok, Status::Ok]) => Entry::new("-"),
        (None, [old, new]) => {
            let [from, to] = [old, new].map(Status::in_words);
            marked(
                if old == new {
                    to
                } else {
                    format!("{from} -> {to}")
                },
                old == Status::Ok,
            )
        }
    }
}

fn entry(change: &CellChange, figure: &FigureChange) -> Entry {
    let text = match (figure.ratio(), figure.old, figure.new) {
        (Some(ratio), _, _) => percent(ratio),
        (None, Some(_), _) => "gone".to_owned(),
        (None, None, Some(_)) => "new".to_owned(),
        (None, None, None) => "missing".to_owned(),
    };
    marked(text, is_broken(change, figure.name))
}

/// Old and new values: the times of all cells, and all other figures that differ.
fn figures(comparison: &FileComparison) -> Table {
    let mut rows = Vec::new();
    let name = names(comparison);
    for change in &comparison.cells {
        let mut push = |figure: String, [old, new]: [String; 2], change_in_words: String| {
            let cell = name(&change.cell);
            rows.push(
                [cell, figure, old, new, change_in_words]
                    .map(Entry::new)
                    .into(),
            );
        };
        if let Some(time) = &change.time {
            let digits = decimals(time.medians, 9);
            let how = match (time.method, time.p) {
                (TimeMethod::Paired, _) => counted(time.samples[0], "pair"),
                (_, Some(p)) => format!("p {p:.4}"),
                (_, None) => String::new(),
            };
            push(
                "Time (s)".to_owned(),
                time.medians.map(|seconds| format!("{seconds:.digits$}")),
                format!("{}; {how}", time.in_words()),
            );
        }
        for figure in change.figures.iter().filter(|f| f.old != f.new) {
            let shown = |value: Option<f64>| value.map_or_else(|| "-".to_owned(), exact);
            push(
                heading(figure.name),
                [shown(figure.old), shown(figure.new)],
                figure.ratio().map_or_else(String::new, percent),
            );
        }
    }
    Table::new(
        Column::of(["Cell", "Figure"], ["Old", "New", "Change"]),
        rows,
    )
}
