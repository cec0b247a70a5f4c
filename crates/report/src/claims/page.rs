//! Writes verdicts as Markdown, JSON, CSV and text.

use geobench_export::{FileFormat, json_lines};
use geobench_harness::measure::number::{counted, grouped};
use geobench_harness::measure::statistics::range_of;
use toml::Spanned;

use super::file::{Paper, Test};
use super::judged::{ClaimCase, ClaimCause, ClaimVerdict, ClaimsReport, JudgedClaim, JudgedPaper};
use super::topics::topics;
use crate::table::group::distinct;
use crate::table::terminal::listing;
use crate::table::{Column, Entry, Look, Mark, Table, csv, markdown};

/// An output format of verdicts.
#[derive(Default, Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub enum ClaimsFormat {
    /// A page in Markdown.
    #[default]
    Markdown,
    /// A list for the terminal.
    Text,
    /// All claims with the numbers of their cases.
    Json,
    /// One row for each claim.
    Csv,
}

impl FileFormat for ClaimsFormat {
    const CONTENT: &'static str = "verdicts";
    const ENDINGS: &'static [(&'static str, Self)] = &[
        ("md", Self::Markdown),
        ("json", Self::Json),
        ("csv", Self::Csv),
        ("txt", Self::Text),
    ];
}

/// The most cases of one expression that are listed one by one. More are shown as a range.
const MOST_SHOWN: usize = 4;

/// The most models of an expression that a reason names.
const MOST_NAMED: usize = 6;

const HOW_TO_READ: &str = "\
A verdict is computed from the results. [The rules](../docs/claims.md), in short:

- **confirmed**: the claim holds in every case, and the sizes agree: our range over the models meets \
the paper's; counts on the paper's own models are within 5 %.
- **direction only**: it holds in every case; sizes differ.
- **partly**: it holds in most cases; others fail or are open.
- **not**: it holds in at most half of the cases.
- **cannot be judged**: at least half of the cases are open; or the verdicts with the two kinds of heap \
differ; or models and sizes are unlike the paper's. The page says what it would take.

The cause of *not* and *direction only*, by rule: **counting** if the claim's file says what the paper \
counts otherwise; else, where results of the authors' programs are given, **paper** if these do not \
confirm the claim either, **implementation** if they do; else **open**. The last column has the cases \
computed with them.

A case is one algorithm, or one ratio of two, on one model, or over all models. A value of times \
decides only if its 95 % interval, in parentheses, lies on one side of the limit. Times of different \
machines are never compared; ratios are. `no` marks a case for which the claim does not hold, `open` one that is not decided.
";

impl ClaimsFormat {
    /// Verdicts in this format, ending in a line break. `look` is the style of text.
    ///
    /// # Errors
    ///
    /// Only if a number cannot be represented, which does not occur in verdicts.
    pub fn render(self, report: &ClaimsReport, look: Look) -> anyhow::Result<String> {
        Ok(match self {
            Self::Text => text(report, look),
            Self::Markdown => in_markdown(report),
            Self::Json => {
                let claims = report.papers.iter().flat_map(|paper| &paper.claims);
                json_lines(&claims.collect::<Vec<_>>())?
            }
            Self::Csv => csv::table(&rows(report))?,
        })
    }
}

/// The claims that the results say something of, and how many are left out.
fn text(report: &ClaimsReport, look: Look) -> String {
    let mut report = report.clone();
    let count = |report: &ClaimsReport| report.papers.iter().map(|p| p.claims.len()).sum::<usize>();
    let all = count(&report);
    for paper in &mut report.papers {
        let says = |claim: &JudgedClaim| {
            claim.verdict != ClaimVerdict::Unjudged || !claim.values.is_empty()
        };
        paper.claims.retain(says);
    }
    report.papers.retain(|paper| !paper.claims.is_empty());
    let left_out = match all - count(&report) {
        0 => String::new(),
        n => format!(
            "\n{} without results; --format markdown has them.\n",
            counted(n, "claim")
        ),
    };
    let paper = |paper: &JudgedPaper| {
        let table = Table::new(
            Column::of(["Claim", "Verdict", "Here", "Why"], [""; 0]),
            paper
                .claims
                .iter()
                .map(|claim| {
                    [
                        format!("{}: {}", claim.id, claim.claim),
                        with_cause(claim),
                        claim.shown.clone(),
                        why(claim),
                    ]
                    .map(Entry::new)
                    .into()
                })
                .collect(),
        );
        format!(
            "{}: {}\n\n{}\n",
            paper.paper,
            paper.title,
            listing(&table, look)
        )
    };
    let papers: String = report.papers.iter().map(paper).collect();
    papers + &listing(&summary(&report, |paper| paper.paper.clone()), look) + &left_out
}

/// What holds, what does not, and why it matters: a line for each topic.
fn digest(report: &ClaimsReport) -> String {
    let claims: Vec<&JudgedClaim> = report
        .papers
        .iter()
        .flat_map(|paper| &paper.claims)
        .collect();
    let topics = topics();
    let of = |claim: &JudgedClaim| topics.iter().position(|topic| topic.is_of(&claim.id));
    let lines = topics.iter().enumerate().filter_map(|(place, topic)| {
        let own: Vec<&&JudgedClaim> = claims
            .iter()
            .filter(|claim| of(claim) == Some(place))
            .collect();
        let all = own.len();
        let counts = ClaimVerdict::ALL.into_iter().filter_map(|verdict| {
            let with: Vec<_> = own
                .iter()
                .filter(|claim| claim.verdict == verdict)
                .collect();
            (!with.is_empty()).then(|| format!("{} {}", with.len(), verdict.in_words()))
        });
        let counts = counts.collect::<Vec<_>>().join(", ");
        let failed = own
            .iter()
            .filter(|claim| claim.verdict == ClaimVerdict::Not);
        let failed = distinct(failed.map(|claim| format!("{} {}", claim.paper, claim.place)));
        let failed = match failed.len() {
            0 => String::new(),
            _ => format!(" Not: {}.", failed.join("; ")),
        };
        let (number, says, matters) = (place + 1, &topic.says, &topic.matters);
        (all > 0).then(|| format!("{number}. **{says}**: of {all}, {counts}.{failed} {matters}\n"))
    });
    lines.collect()
}

fn in_markdown(report: &ClaimsReport) -> String {
    let mut page = format!(
        "# The papers' claims, one by one\n\nWhat holds, by topic, and why it matters. The papers \
         are named below the list.\n\n{}\n{}\n\n{HOW_TO_READ}\n",
        digest(report),
        markdown::table(&summary(report, |paper| format!(
            "{}: {}",
            paper.paper, paper.title
        )))
        .trim_end()
    );
    page +=
        "Made by `geobench claims` from these results, whose suites are in `bench-configs`:\n\n";
    if report.sources.is_empty() {
        page += "- none\n";
    }
    for source in &report.sources {
        page += &format!("- {source}\n");
    }
    for paper in &report.papers {
        let heads = ["claim", "place", "paper", "here", "verdict", "why"];
        let row = |claim: &JudgedClaim| {
            let quote = format!("\u{201c}{}\u{201d}", claim.quote);
            let paper = [quote.as_str(), &claim.printed];
            let paper: Vec<&str> = paper.into_iter().filter(|text| !text.is_empty()).collect();
            vec![
                Entry::new(&claim.claim),
                Entry::new(&claim.place),
                Entry::new(paper.join(" ")),
                Entry::new(&claim.shown),
                Entry::marked(
                    with_cause(claim),
                    match claim.verdict {
                        ClaimVerdict::Not => Mark::Best,
                        _ => Mark::None,
                    },
                ),
                Entry::new(why(claim)),
            ]
        };
        let table = Table {
            title: format!("{}: {}", paper.paper, paper.title),
            ..Table::new(
                Column::of(heads, [""; 0]),
                paper.claims.iter().map(row).collect(),
            )
        };
        page += &format!("\n{}", markdown::table(&table).trim_end());
        page += "\n";
    }
    page
}

/// A row for each claim.
fn rows(report: &ClaimsReport) -> Table {
    let heads = [
        "id", "paper", "place", "claim", "quote", "printed", "suite", "verdict", "cause", "values",
        "reason",
    ];
    let row = |claim: &JudgedClaim| {
        [
            claim.id.as_str(),
            &claim.paper,
            &claim.place,
            &claim.claim,
            &claim.quote,
            &claim.printed,
            claim.suite.as_deref().unwrap_or_default(),
            claim.verdict.in_words(),
            claim.cause.map_or("", ClaimCause::in_words),
            &claim.shown,
            &claim.reason,
        ]
        .map(Entry::new)
        .into()
    };
    let claims = report.papers.iter().flat_map(|paper| &paper.claims);
    Table::new(Column::of(heads, [""; 0]), claims.map(row).collect())
}

/// The number of claims with each verdict, for each paper by its `name` and in total.
fn summary(report: &ClaimsReport, name: fn(&JudgedPaper) -> String) -> Table {
    let count = |claims: &[&JudgedClaim], title: String| -> Vec<Entry> {
        let with = |verdict| claims.iter().filter(move |claim| claim.verdict == verdict);
        let counts = ClaimVerdict::ALL.map(|verdict| with(verdict).count().to_string());
        let entries = std::iter::once(title).chain(counts);
        entries.map(Entry::new).collect()
    };
    let mut rows: Vec<Vec<Entry>> = Vec::new();
    for paper in &report.papers {
        let claims: Vec<&JudgedClaim> = paper.claims.iter().collect();
        rows.push(count(&claims, name(paper)));
    }
    let all: Vec<&JudgedClaim> = report
        .papers
        .iter()
        .flat_map(|paper| &paper.claims)
        .collect();
    rows.push(count(&all, "all".to_owned()));
    let verdicts = ClaimVerdict::ALL.map(ClaimVerdict::in_words);
    Table::new(Column::of(["claims of"], verdicts), rows)
}

/// The verdict, with the cause if it has one.
pub(crate) fn with_cause(claim: &JudgedClaim) -> String {
    let cause = claim.cause.map(|cause| format!(" ({})", cause.in_words()));
    format!("{}{}", claim.verdict.in_words(), cause.unwrap_or_default())
}

/// The reason and what explains it, as sentences.
pub(crate) fn why(claim: &JudgedClaim) -> String {
    let takes = claim
        .takes
        .as_ref()
        .map(|takes| format!("it would take {takes}"));
    let authors = (!claim.authors.is_empty())
        .then(|| format!("with the authors' programs {}", claim.authors));
    let texts = [
        Some(claim.reason.as_str()),
        authors.as_deref(),
        takes.as_deref(),
        claim.counting.as_deref(),
        claim.remark.as_deref(),
    ];
    let texts = texts.into_iter().flatten().filter(|text| !text.is_empty());
    let texts: Vec<String> = texts
        .map(|text| format!("{}.", text.trim().trim_end_matches('.')))
        .collect();
    texts.join(" ")
}

/// The paper's numbers in words.
pub(super) fn printed<'t>(tests: impl Iterator<Item = &'t Test>) -> String {
    let mut parts = Vec::new();
    for test in tests {
        for operand in &test.of {
            let mut printed = test.printed(operand);
            if test.to.is_none() && !test.models.is_empty() {
                let wanted = |name: &String| test.models.iter().any(|model| model.contains(name));
                printed.retain(|of| of.place.as_ref().is_none_or(|(name, _)| wanted(name)));
            }
            let numbers = printed.into_iter().map(|number| number.value);
            let Some([least, most]) = range_of(numbers) else {
                continue;
            };
            let name = match test.paper.as_ref().map(Spanned::get_ref) {
                Some(Paper::Table(_)) => format!("{} ", operand.in_words()),
                _ => String::new(),
            };
            let range = if least == most {
                number(least)
            } else {
                format!("{} to {}", number(least), number(most))
            };
            parts.push(format!("{name}{range}"));
        }
    }
    distinct(parts).join("; ")
}

/// The cases in words: one by one, or as a range if an expression has many.
pub(super) fn cases(cases: &[ClaimCase]) -> String {
    let several = distinct(cases.iter().map(|case| &case.figure)).len() > 1;
    let kinds = distinct(cases.iter().map(|case| (&case.of, &case.figure)));
    let mut parts = Vec::new();
    for (of, figure) in kinds {
        let own: Vec<&ClaimCase> = cases
            .iter()
            .filter(|case| (&case.of, &case.figure) == (of, figure) && case.value.is_some())
            .collect();
        let figure = if several {
            format!(" ({figure})")
        } else {
            String::new()
        };
        if own.is_empty() {
            continue;
        }
        let values = if own.len() <= MOST_SHOWN {
            let each = own.iter().map(|case| {
                let mark = match case.holds {
                    Some(true) => "",
                    Some(false) => " (no)",
                    None => " (open)",
                };
                format!("{} {}{mark}", place(case), value(case))
            });
            each.collect::<Vec<_>>().join(", ")
        } else {
            let values = own.iter().filter_map(|case| case.value);
            let [least, most] = range_of(values).unwrap_or_default();
            let marked = |holds| own.iter().filter(|case| case.holds == holds).count();
            let counts = [(Some(false), "no"), (None, "open")].map(|(holds, mark)| {
                let count = marked(holds);
                (count > 0).then(|| format!(", {count} {mark}"))
            });
            format!(
                "{} to {} ({} cases{})",
                number(least),
                number(most),
                own.len(),
                counts.into_iter().flatten().collect::<String>()
            )
        };
        parts.push(format!("{of}{figure}: {values}"));
    }
    parts.join("; ")
}

/// The model of a case, with the range of the axis for a growth.
fn place(case: &ClaimCase) -> String {
    match case.range {
        None => short(&case.on),
        Some([low, high]) => format!("{} from {} to {}", case.on, number(low), number(high)),
    }
}

fn value(case: &ClaimCase) -> String {
    let text = case.value.map_or_else(|| "-".to_owned(), number);
    match case.ci95 {
        None => text,
        Some([low, high]) => format!("{text} ({} to {})", number(low), number(high)),
    }
}

/// Lists the cases `named` after a colon; empty if they are all of `all`. If `named` has every case
/// of an expression, the models of the expression are left out.
pub(super) fn names(named: &[&ClaimCase], all: &[ClaimCase]) -> String {
    if named.len() == all.len() {
        return String::new();
    }
    let mut texts = Vec::new();
    for (of, figure) in distinct(named.iter().map(|case| (&case.of, &case.figure))) {
        let is_own = |case: &ClaimCase| (&case.of, &case.figure) == (of, figure);
        let own: Vec<&&ClaimCase> = named.iter().filter(|case| is_own(case)).collect();
        if own.len() == all.iter().filter(|case| is_own(case)).count() {
            texts.push(of.clone());
            continue;
        }
        let models = own.iter().take(MOST_NAMED).map(|case| short(&case.on));
        let more = match own.len().saturating_sub(MOST_NAMED) {
            0 => String::new(),
            more => format!(" and {more} more"),
        };
        texts.push(format!(
            "{of} on {}{more}",
            models.collect::<Vec<_>>().join(", ")
        ));
    }
    format!(": {}", distinct(texts).join("; "))
}

/// The name of a generated model without `bump` and `seed`, which are the same throughout a suite.
fn short(name: &str) -> String {
    let words = name.split(',');
    let told = words.filter(|word| !word.starts_with("bump=") && !word.starts_with("seed="));
    told.collect::<Vec<_>>().join(" ")
}

/// A number with about three significant digits. From 1,000 on, it is rounded to a whole number.
fn number(value: f64) -> String {
    let size = value.abs();
    if size >= 1000.0 {
        let whole = grouped(size.round() as u64);
        return if value < 0.0 {
            format!("-{whole}")
        } else {
            whole
        };
    }
    let decimals = match size {
        size if size >= 100.0 => 0,
        size if size >= 10.0 => 1,
        size if size >= 0.1 || size == 0.0 => 2,
        size if size >= 1e-4 => 4,
        _ => return format!("{value:.1e}"),
    };
    format!("{value:.decimals$}")
}
