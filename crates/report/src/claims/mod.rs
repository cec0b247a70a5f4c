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
mod page;
#[cfg(test)]
mod tests;

use self::cases::Results;
use self::file::path;
pub use self::file::{ClaimsFile, PaperClaim};
pub use self::judged::{ClaimCase, ClaimVerdict, ClaimsReport, JudgedClaim, JudgedPaper};
pub use self::page::ClaimsFormat;

/// The name and the content of a file of `bench-configs/papers/claims`.
macro_rules! file {
    ($name:literal) => {
        (
            $name,
            include_str!(concat!(
                "../../../../bench-configs/papers/claims/",
                $name,
                ".toml"
            )),
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
        .map(|(name, text)| ClaimsFile::parse(&path(name), text))
        .collect()
}

/// Judges the claims of `files` by `results`.
///
/// # Errors
///
/// When two results are of the same suite.
pub fn judge(files: &[ClaimsFile], results: &[Input]) -> Result<ClaimsReport, UsageError> {
    let mut of_suite: BTreeMap<String, &Input> = BTreeMap::new();
    let mut notes = Vec::new();
    let wanted = |suite: &String| {
        let mut claims = files.iter().flat_map(ClaimsFile::claims);
        claims.any(|claim| claim.suite.as_ref() == Some(suite))
    };
    for input in results {
        let shown = input.path.display();
        let Some(suite) = input.result.suite().filter(|s| wanted(s)) else {
            notes.push(format!("{shown}: no claim is decided by its suite"));
            continue;
        };
        if let Some(other) = of_suite.insert(suite.clone(), input) {
            return Err(UsageError(format!(
                "{} and {shown} are both results of the suite {suite}; give one of them",
                other.path.display()
            )));
        }
    }
    // Suites that ran on one machine with one program share a line.
    let mut sources: BTreeMap<String, Vec<&str>> = BTreeMap::new();
    for (suite, input) in &of_suite {
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
                let input = claim.suite.as_ref().and_then(|suite| of_suite.get(suite));
                judged(&file.paper, claim, input.map(|input| &input.result))
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

fn judged(paper: &str, claim: &PaperClaim, result: Option<&ResultFile>) -> JudgedClaim {
    let mut cases = Vec::new();
    let mut unjudged = None;
    match (&claim.awaits, &claim.suite, result) {
        (Some(what), _, _) => unjudged = Some(format!("not available yet: {what}")),
        (None, suite, None) => {
            let suite = suite.as_deref().unwrap_or_default();
            unjudged = Some(format!("there is no result of the suite {suite}"));
        }
        (None, _, Some(result)) => {
            for test in claim.tests() {
                cases.extend(Results { result, test }.cases());
            }
        }
    }
    let (verdict, reason) = match unjudged {
        Some(reason) => (ClaimVerdict::Unjudged, reason),
        None => verdict(&cases),
    };
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
        values,
        reason,
        suite: claim.suite.clone(),
        printed: page::printed(claim.tests()),
        shown: page::cases(&cases),
        remark: claim.remark.clone(),
    }
}

/// The verdict on a claim from all its cases, and the reason.
fn verdict(cases: &[ClaimCase]) -> (ClaimVerdict, String) {
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
    } else if failed.is_empty() && open.is_empty() && off.is_empty() {
        ClaimVerdict::Confirmed
    } else {
        ClaimVerdict::Partly
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
    if verdict == ClaimVerdict::Partly {
        push("sizes beyond a third of the paper's", &off);
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
