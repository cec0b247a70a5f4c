//! `geobench algos`.

use anyhow::bail;
use clap::Args;
use geobench_export::json_lines;
use geobench_registry::{self as registry, Algorithm, Parameter, Selection, Value};
use geobench_report::table::terminal::listing;
use geobench_report::table::{Column, Entry, Look, Table};
use geobench_window::{Counter, Counters};
use serde::Serialize;

use crate::args::{FormatOption, ListFormat};
use crate::terminal;
use crate::verdict::Verdict;
use geobench_harness::plan::suite::options::Algorithms;

#[derive(Args, Debug)]
pub(crate) struct AlgosOptions {
    /// Algorithms to describe in full: by name, by family, or exact, or all; separated by commas.
    /// Without any, one line for each of all, and which one to take
    #[arg(value_name = "LIST")]
    pub(crate) list: Option<Algorithms>,

    /// List the counters of result files instead, each with its definition
    #[arg(long, conflicts_with = "list")]
    pub(crate) counters: bool,

    #[command(flatten)]
    pub(crate) format: FormatOption<ListFormat>,
}

/// The recommended algorithm for each use; `docs/algorithms` has the same table.
pub(crate) const ADVICE: [(&str, &str); 9] = [
    (
        "distances, as fast as possible",
        "vtp-fast; on several idle processors pvtp",
    ),
    (
        "distances from many sources",
        "vtp-fast, by geobench distance --each --threads N; approximately heat or svg",
    ),
    ("a Voronoi diagram", "window-vtp, by geobench voronoi"),
    ("a reference for checks", "mmp-fast"),
    (
        "a comparison of the papers' algorithms",
        "mmp, ich, fwp-mmp, fwp-ch, vtp",
    ),
    ("the least memory", "vtp-fast or vtp, then ich"),
    (
        "an approximation from one source",
        "vsp, some 0.2 % off in the mean; with a bound avtp",
    ),
    (
        "a comparison of approximations",
        "geobench run --suite approximate",
    ),
    (
        "the effect of one part of VTP",
        "vtp-no-rule1, vtp-no-rules23, vtp-mmp, vtp-ch, ftp, opvtp",
    ),
];

/// Width in columns of the output if that is not a terminal.
const WIDTH: usize = 80;

pub(crate) fn algos(options: &AlgosOptions, look: Look) -> anyhow::Result<Verdict> {
    let mut listed = options.list.iter().flat_map(|list| &list.0);
    if let Some(outside) = listed.find(|one| one.outside_name().is_some()) {
        bail!(
            "{} is an outside program: its table, in a file for --ext, says what it is",
            outside.label()
        );
    }
    let show = |table: &Table, width| {
        let width = look.width.or(width);
        listing(table, Look { width, ..look })
    };
    let text = match (options.counters, options.format.chosen(), &options.list) {
        (false, ListFormat::Table, None) => {
            let advice = show(&advice(), Some(WIDTH));
            let all = show(&overview(registry::algorithms()), Some(WIDTH));
            format!(
                "{all}\nWhich one to take (`geobench algos NAME` tells all about one):\n\n{advice}"
            )
        }
        (false, ListFormat::Table, Some(_)) => show(&facts(&chosen(options)), None),
        (false, ListFormat::Json, _) => json_lines(&chosen(options))?,
        (true, ListFormat::Table, _) => {
            let rows = counters().into_iter().map(|c| [c.name, c.definition]);
            show(&plain(["", ""], rows.collect()), None)
        }
        (true, ListFormat::Json, _) => json_lines(&counters())?,
    };
    terminal::print_rendered(&text)?;
    Ok(Verdict::Passed)
}

/// The algorithms of the list, each once even if listed with several parameters. All algorithms
/// without a list.
fn chosen(options: &AlgosOptions) -> Vec<&Algorithm> {
    let Some(list) = &options.list else {
        return registry::algorithms().iter().collect();
    };
    let mut algorithms: Vec<&Algorithm> = list.0.iter().map(Selection::algorithm).collect();
    let mut seen = Vec::new();
    algorithms.retain(|algorithm| {
        let is_new = !seen.contains(&algorithm.name);
        seen.push(algorithm.name);
        is_new
    });
    algorithms
}

/// A counter in JSON.
#[derive(Serialize)]
pub(crate) struct CounterEntry {
    pub(crate) name: &'static str,
    pub(crate) definition: &'static str,
}

/// Every counter of result files, including the one that is sampled.
pub(crate) fn counters() -> Vec<CounterEntry> {
    let counted = Counter::ALL.iter().map(|c| (c.key(), c.definition()));
    let sampled = (
        Counters::WAVEFRONT_DEVIATION,
        Counters::WAVEFRONT_DEVIATION_DEFINITION,
    );
    counted
        .chain([sampled])
        .map(|(name, definition)| CounterEntry {
            name,
            definition: definition.trim(),
        })
        .collect()
}

/// A row for each algorithm.
fn overview(algorithms: &[Algorithm]) -> Table {
    let row = |algorithm: &Algorithm| {
        // A default of `none` means that the parameter is off; such parameters are not listed.
        let defaults = algorithm.parameters.iter();
        let defaults = defaults.filter(|p| p.default != Value::Word("none"));
        let defaults: Vec<String> = defaults
            .map(|p| format!("{}={}", p.name, p.default))
            .collect();
        let what = match defaults.join(", ") {
            none if none.is_empty() => algorithm.summary.to_owned(),
            defaults => format!("{}\n{{{defaults}}}", algorithm.summary),
        };
        let exact = if algorithm.exact { "yes" } else { "no" };
        let [name, exact] = [algorithm.name, exact].map(str::to_owned);
        [name, exact, short(algorithm.paper), what]
    };
    let heads = ["Name", "Exact", "Paper", "What {parameters and defaults}"];
    plain(heads, algorithms.iter().map(row).collect())
}

/// The first paper of a citation in short form: authors and year. If there are more than two
/// authors, only the first is named: `Mitchell et al. 1987`.
fn short(paper: &str) -> String {
    let first = paper.split(';').next().unwrap_or_default();
    let is_digit = |c: char| c.is_ascii_digit();
    let Some(year) = first.find(is_digit) else {
        return first.to_owned();
    };
    let (names, rest) = first.split_at(year);
    let year = rest.split(|c| !is_digit(c)).next().unwrap_or_default();
    match names.trim_end().split(", ").collect::<Vec<_>>()[..] {
        [first, _, _, ..] => format!("{first} et al. {year}"),
        _ => format!("{names}{year}"),
    }
}

fn advice() -> Table {
    plain(
        ["You want", "Take"],
        ADVICE.map(|(want, take)| [want, take]).into(),
    )
}

/// The facts about each algorithm, as a block of rows.
fn facts(algorithms: &[&Algorithm]) -> Table {
    let mut rows: Vec<[String; 2]> = Vec::new();
    for algorithm in algorithms {
        if !rows.is_empty() {
            rows.push(Default::default());
        }
        let exact = if algorithm.exact {
            "exact"
        } else {
            "approximate"
        };
        rows.push([
            algorithm.name.to_owned(),
            format!("{exact}, {}", algorithm.family),
        ]);
        let facts = [
            ("what", algorithm.summary),
            ("source", algorithm.paper),
            ("departs", algorithm.departs),
            ("cost", algorithm.complexity),
            ("keeps", algorithm.keeps),
            ("choose it", algorithm.choose),
        ];
        let facts = facts.iter().filter(|(_, fact)| !fact.is_empty());
        rows.extend(facts.map(|(label, fact)| [format!("  {label}"), (*fact).to_owned()]));
        rows.extend(algorithm.parameters.iter().map(|parameter| {
            let Parameter {
                name,
                meaning,
                allowed,
                default,
                ..
            } = parameter;
            [
                format!("  {{{name}}}"),
                format!("{meaning}; {allowed}, default {default}"),
            ]
        }));
    }
    plain(["", ""], rows)
}

/// A table whose entries are plain text.
fn plain<const N: usize>(heads: [&str; N], rows: Vec<[impl Into<String>; N]>) -> Table {
    let row = |row: [_; N]| row.map(Entry::new).into();
    Table::new(
        Column::of(heads, [""; 0]),
        rows.into_iter().map(row).collect(),
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn papers_are_short() {
        for (paper, expected) in [
            (
                "Mitchell, Mount, Papadimitriou 1987; Surazhsky et al. 2005",
                "Mitchell et al. 1987",
            ),
            ("Xin, Wang 2009, sections 2 and 3.1", "Xin, Wang 2009"),
            ("Qin et al. 2016, made parallel by us", "Qin et al. 2016"),
            ("none", "none"),
        ] {
            assert_eq!(short(paper), expected);
        }
    }

    #[test]
    fn advised_algorithms_exist() {
        for (_, take) in ADVICE {
            let words = take
                .split([' ', ';'])
                .map(|word| word.trim_end_matches(','));
            let is_name = |word: &&str| word.contains(['-', '{']) && !word.starts_with("--");
            for name in words.filter(is_name) {
                registry::select(name).unwrap();
            }
        }
    }
}
