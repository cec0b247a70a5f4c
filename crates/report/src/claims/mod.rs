//! Judges the papers' claims by our results.
//!
//! `bench-configs/papers/claims` has a file of claims for each paper; `docs/claims.md` defines its
//! keys. A claim has one or more tests. A test has one or more *cases*: a value for one algorithm
//! (or a ratio of two) on one model, or over all models. [`judge`] computes all cases of a claim,
//! and from them its verdict.

// Counts are never negative here, and writing a page is not a hot loop.
#![allow(clippy::cast_sign_loss, clippy::format_push_string)]

use std::collections::BTreeMap;

pub use crate::page::Input;
use crate::table::group::distinct;
use geobench_harness::schema::ResultFile;
use geobench_registry::UsageError;

mod cases;
mod expression;
mod file;
mod judged;
pub(crate) mod page;
#[cfg(test)]
mod tests;
mod topics;

use self::cases::{JudgedPrograms, Results, is_authors};
use self::file::path;
pub use self::file::{ClaimsFile, PaperClaim};
pub use self::judged::{
    ClaimCase, ClaimCause, ClaimVerdict, ClaimsReport, JudgedClaim, JudgedPaper,
};
pub use self::page::ClaimsFormat;

/// The name and the content of a file of `bench-configs/papers/claims`.
macro_rules! file {
    ($name:literal) => {
        (
            $name,
            include_str!(concat!("../../papers/claims/", $name, ".toml")),
        )
    };
}

const FILES: &[(&str, &str)] = &[
    file!("000"),
    file!("001"),
    file!("002"),
    file!("003"),
    file!("004"),
];

/// The claims of the papers, which are compiled into the program.
///
/// # Errors
///
/// Never: a test parses every file.
pub fn known() -> Result<Vec<ClaimsFile>, geobench_harness::DocumentError> {
    let files = FILES.iter();
    files
        .map(|(name, text)| {
            let mut file = ClaimsFile::parse(&path(name), text)?;
            file.is_of_paper = true;
            Ok(file)
        })
        .collect()
}

/// Judges the claims of `files` by `results`.
///
/// # Errors
///
/// When two results are of the same suite, unless one of them is at the sizes of the papers.
pub fn judge(files: &[ClaimsFile], results: &[Input]) -> Result<ClaimsReport, UsageError> {
    // By suite, and whether at the sizes of the papers.
    let mut of_suite: BTreeMap<(String, bool), &Input> = BTreeMap::new();
    let (mut notes, mut authors) = (Vec::new(), Vec::new());
    let wanted = |suite: &String| {
        let mut claims = files.iter().flat_map(ClaimsFile::claims);
        claims.any(|claim| claim.suite.as_ref() == Some(suite))
    };
    for input in results {
        let shown = input.path.display();
        let has_authors = input.result.cells.iter().any(is_authors);
        if has_authors {
            authors.push(&input.result);
        }
        let Some(suite) = input.result.suite().filter(|suite| wanted(suite)) else {
            if !has_authors {
                notes.push(format!("{shown}: no claim is decided by its suite"));
            }
            continue;
        };
        if input.result.suite_with_its_models().is_none() {
            notes.push(format!(
                "{shown}: its models are not those of the suite, so that it decides no claim of a paper"
            ));
        }
        let is_full = input.result.command.iter().any(|word| word == "--full");
        if let Some(other) = of_suite.insert((suite.clone(), is_full), input) {
            return Err(UsageError(format!(
                "{} and {shown} are both results of the suite {suite}; give one of them",
                other.path.display()
            )));
        }
    }
    // Suites that ran on one machine with one program share a line.
    let mut sources: BTreeMap<String, Vec<&str>> = BTreeMap::new();
    for ((suite, _), input) in &of_suite {
        sources
            .entry(source(&input.result))
            .or_default()
            .push(suite);
    }
    let sources = sources.into_iter();
    let sources = sources.map(|(source, suites)| format!("{source}: {}", suites.join(", ")));
    let sources = sources.collect();
    let papers = files.iter().map(|file| JudgedPaper {
        paper: file.paper.clone(),
        title: file.title.clone(),
        claims: file
            .claims()
            .map(|claim| {
                // A record at the sizes of the paper comes first, unless it does not decide.
                let suite = claim.suite.clone().unwrap_or_default();
                let found = [true, false].map(|is_full| {
                    let found = of_suite.get(&(suite.clone(), is_full));
                    let has_its_models = |input: &&&Input| {
                        !file.is_of_paper || input.result.suite_with_its_models().is_some()
                    };
                    found.filter(has_its_models)
                });
                let judge = |input: Option<&&Input>| {
                    judged(
                        &file.paper,
                        claim,
                        input.map(|input| &input.result),
                        &authors,
                    )
                };
                let of_full = found[0].map(|input| judge(Some(input)));
                let decides = |claim: &JudgedClaim| claim.verdict != ClaimVerdict::Unjudged;
                match (of_full, found[1]) {
                    (Some(claim), None) => claim,
                    (Some(claim), _) if decides(&claim) => claim,
                    (_, input) => judge(input),
                }
            })
            .collect(),
    });
    Ok(ClaimsReport {
        papers: papers.collect(),
        sources,
        notes,
    })
}

/// The origin of a result: date, commit and machine, in one line.
fn source(result: &ResultFile) -> String {
    let commit = result.tool.commit.as_deref().unwrap_or("unknown");
    let cpu = result.host.cpu.as_deref().unwrap_or("unknown processor");
    let processors = match result.host.cores {
        1 => "1 processor".to_owned(),
        count => format!("{count} processors"),
    };
    format!(
        "{}, commit {}, {cpu}, {processors}, vectors up to {}",
        result.started.get(..10).unwrap_or(&result.started),
        commit.get(..12).unwrap_or(commit),
        result.host.simd.as_deref().unwrap_or("unknown"),
    )
}

fn judged(
    paper: &str,
    claim: &PaperClaim,
    result: Option<&ResultFile>,
    authors: &[&ResultFile],
) -> JudgedClaim {
    let (mut cases, mut others) = (Vec::new(), None);
    let mut unjudged = None;
    match (&claim.awaits, &claim.suite, result) {
        (Some(what), _, _) => unjudged = Some(format!("not available yet: {what}")),
        (None, suite, None) => {
            let suite = suite.as_deref().unwrap_or_default();
            unjudged = Some(format!("there is no result of the suite {suite}"));
        }
        (None, _, Some(result)) => {
            cases = cases_with(JudgedPrograms::Named, claim, result);
            let named = |test| Results {
                result,
                test,
                programs: JudgedPrograms::Named,
            };
            if claim.tests().any(|test| named(test).rests_on_the_queue()) {
                others = Some(cases_with(JudgedPrograms::SecondHeap, claim, result));
            }
        }
    }
    let (mut verdict, mut reason) = match unjudged {
        Some(reason) => (ClaimVerdict::Unjudged, reason),
        None => verdict_on(&cases),
    };
    if let Some(others) = others.filter(|cases| cases.iter().any(|case| case.holds.is_some())) {
        let (second, _) = verdict_on(&others);
        if ![verdict, second].contains(&ClaimVerdict::Unjudged) && second != verdict {
            reason = format!(
                "it rests on the queue: {} with a binary heap, {} with one of four children a node",
                verdict.in_words(),
                second.in_words()
            );
            verdict = ClaimVerdict::Unjudged;
        }
    }
    let by_authors = cases_by_authors(claim, authors);
    let cause = matches!(verdict, ClaimVerdict::Not | ClaimVerdict::DirectionOnly)
        .then(|| cause(claim, &by_authors));
    let mut values = BTreeMap::new();
    for case in &cases {
        let mut name = format!("{}, {}", case.of, case.on);
        if values.contains_key(&name) {
            name = format!("{name}, {}", case.figure);
        }
        values.insert(name, case.clone());
    }
    JudgedClaim {
        id: claim.id().to_owned(),
        paper: paper.to_owned(),
        place: claim.place.clone(),
        claim: claim.claim.clone(),
        quote: claim.quote.clone(),
        verdict,
        cause,
        values,
        reason,
        suite: claim.suite.clone(),
        printed: page::printed(claim.tests()),
        authors: page::cases(&by_authors),
        shown: page::cases(&cases),
        remark: claim.remark.clone(),
        counting: claim.counting.clone(),
        takes: claim
            .takes
            .clone()
            .filter(|_| verdict == ClaimVerdict::Unjudged),
    }
}

/// The cases of all tests of a claim.
fn cases_with(programs: JudgedPrograms, claim: &PaperClaim, result: &ResultFile) -> Vec<ClaimCase> {
    let of = |test| Results {
        result,
        test,
        programs,
    };
    claim.tests().flat_map(|test| of(test).cases()).collect()
}

/// The cases that results of the authors' programs decide.
fn cases_by_authors(claim: &PaperClaim, authors: &[&ResultFile]) -> Vec<ClaimCase> {
    let all = authors.iter().flat_map(|&result| {
        let of = move |test| Results {
            result,
            test,
            programs: JudgedPrograms::Authors,
        };
        let checked = claim.tests().filter(move |test| of(test).can_be_checked());
        checked.flat_map(move |test| of(test).cases())
    });
    all.filter(|case| case.holds.is_some()).collect()
}

/// Why a claim does not hold, or not in size. `by_authors`: its cases with the authors' programs.
fn cause(claim: &PaperClaim, by_authors: &[ClaimCase]) -> ClaimCause {
    if claim.counting.is_some() {
        return ClaimCause::Counting;
    }
    match verdict_on(by_authors).0 {
        _ if by_authors.is_empty() => ClaimCause::Open,
        ClaimVerdict::Confirmed => ClaimCause::Implementation,
        _ => ClaimCause::Paper,
    }
}

/// The verdict on a claim from all its cases, and the reason.
fn verdict_on(cases: &[ClaimCase]) -> (ClaimVerdict, String) {
    let held: Vec<&ClaimCase> = cases.iter().filter(|c| c.holds == Some(true)).collect();
    let failed: Vec<&ClaimCase> = cases.iter().filter(|c| c.holds == Some(false)).collect();
    let open: Vec<&ClaimCase> = cases.iter().filter(|c| c.holds.is_none()).collect();
    let off: Vec<&ClaimCase> = held
        .iter()
        .copied()
        .filter(|c| c.fits == Some(false))
        .collect();
    let verdict = if open.len() >= held.len() + failed.len() {
        ClaimVerdict::Unjudged
    } else if failed.len() >= held.len() {
        ClaimVerdict::Not
    } else if !failed.is_empty() || !open.is_empty() {
        ClaimVerdict::Partly
    } else if off.is_empty() {
        ClaimVerdict::Confirmed
    } else {
        ClaimVerdict::DirectionOnly
    };
    let mut reasons = Vec::new();
    let mut push = |what: &str, named: &[&ClaimCase]| {
        if !named.is_empty() {
            reasons.push(format!("{what}{}", page::names(named, cases)));
        }
    };
    let fails = if failed.len() == cases.len() {
        "it holds in no case"
    } else {
        "it does not hold for"
    };
    push(fails, &failed);
    if matches!(verdict, ClaimVerdict::Partly | ClaimVerdict::DirectionOnly) {
        push("sizes unlike the paper's", &off);
    }
    // First the undecided cases by their reasons, then those that another figure decided.
    for wanted in [None, Some(())] {
        let others = cases
            .iter()
            .filter(|case| case.holds.is_some() == wanted.is_some() && case.reason.is_some());
        let why = distinct(others.clone().map(|case| case.reason.as_deref()));
        for why in why {
            let own: Vec<&ClaimCase> = others
                .clone()
                .filter(|c| c.reason.as_deref() == why)
                .collect();
            push(why.unwrap_or_default(), &own);
        }
    }
    if cases.is_empty() {
        reasons.push("no model of the result is one that the claim is about".to_owned());
    }
    (verdict, reasons.join("; "))
}
