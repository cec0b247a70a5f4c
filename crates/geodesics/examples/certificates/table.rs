//! A record of certificates, and its tables.

use std::fmt::Write as _;

use serde::{Deserialize, Serialize};

/// The largest error that passes, as a fraction of each distance.
pub(crate) const TOLERANCE: f64 = 1e-9;

#[derive(Serialize, Deserialize)]
pub(crate) struct Record {
    pub(crate) schema: String,
    pub(crate) tolerance: f64,
    pub(crate) certificates: Vec<Line>,
}

/// One certificate.
#[derive(Serialize, Deserialize)]
pub(crate) struct Line {
    /// `models`, `zoo` or `slivers`.
    pub(crate) set: String,
    pub(crate) name: String,
    pub(crate) vertices: usize,
    pub(crate) faces: usize,
    pub(crate) source: Vec<u32>,
    pub(crate) pieces: usize,
    pub(crate) certified: bool,
    /// The greatest distance of a vertex.
    pub(crate) farthest: f64,
    /// By how much a distance may be wrong; null if nothing is proven.
    pub(crate) absolute: Option<f64>,
    /// The same as a fraction of the distance, together and in each direction.
    pub(crate) relative: Option<f64>,
    pub(crate) too_long: Option<f64>,
    pub(crate) too_short: Option<f64>,
    /// The worst place, if it is not certified.
    pub(crate) worst: Option<String>,
    /// Seconds of mmp, and of mmp with its proof.
    pub(crate) solve_seconds: f64,
    pub(crate) seconds: f64,
}

/// Why `failed` are not certified: which of both directions is not proven to a fraction of each
/// distance, and whether all distances are right to that fraction of the farthest one.
fn causes(failed: &[&Line]) -> String {
    let fails = |bound: Option<f64>| bound.is_none_or(|bound| bound > TOLERANCE);
    let is_close = |line: &Line| {
        let limit = TOLERANCE * line.farthest;
        line.absolute.is_some_and(|absolute| absolute <= limit)
    };
    let mut text = String::from(
        "\n| not proven | right to 1e-9 of the farthest distance | zoo | slivers |\n|---|---|--:|--:|\n",
    );
    for close in [true, false] {
        for (name, long, short) in [
            ("not too long", true, false),
            ("not too short", false, true),
            ("both", true, true),
        ] {
            let is_one = |line: &&&Line| {
                is_close(line) == close
                    && fails(line.too_long) == long
                    && fails(line.too_short) == short
            };
            let [zoo, slivers] = ["zoo", "slivers"].map(|set| {
                let of_set = failed.iter().filter(|line| line.set == set);
                of_set.filter(is_one).count()
            });
            if zoo + slivers > 0 {
                let close = if close { "yes" } else { "no" };
                let _ = writeln!(text, "| {name} | {close} | {zoo} | {slivers} |");
            }
        }
    }
    text
}

/// The tables of `results/certificates.md`.
pub(crate) fn table(record: &Record) -> String {
    let shown = |x: Option<f64>| x.map_or("none".to_owned(), |x| format!("{x:.1e}"));
    let mut text = String::from(
        "| model | faces | pieces | too long | too short | time / mmp |\n|---|--:|--:|--:|--:|--:|\n",
    );
    let lines = || record.certificates.iter();
    for line in lines().filter(|line| line.set == "models") {
        let _ = writeln!(
            text,
            "| {} | {} | {} | {} | {} | {:.1} |",
            line.name,
            line.faces,
            line.pieces,
            shown(line.too_long),
            shown(line.too_short),
            line.seconds / line.solve_seconds,
        );
    }
    text.push_str(
        "\n| set | meshes | certified | to 1e-9 of the farthest distance | median error | largest certified |\n|---|--:|--:|--:|--:|--:|\n",
    );
    for set in ["models", "zoo", "slivers"] {
        let all: Vec<&Line> = lines().filter(|line| line.set == set).collect();
        let bound = |line: &&Line| line.relative.unwrap_or(f64::INFINITY);
        let mut errors: Vec<f64> = all.iter().map(bound).collect();
        errors.sort_by(f64::total_cmp);
        let good: Vec<&&Line> = all.iter().filter(|line| line.certified).collect();
        let largest = good.iter().map(|line| bound(line)).fold(0.0, f64::max);
        let median = errors.get(errors.len() / 2).copied();
        let close = all.iter().filter(|line| {
            let absolute = line.absolute.unwrap_or(f64::INFINITY);
            absolute <= TOLERANCE * line.farthest
        });
        let _ = writeln!(
            text,
            "| {set} | {} | {} | {} | {} | {largest:.1e} |",
            all.len(),
            good.len(),
            close.count(),
            shown(median),
        );
    }
    let rest: Vec<&Line> = lines().filter(|line| !line.certified).collect();
    if rest.is_empty() {
        return text;
    }
    text.push_str(&causes(&rest));
    text.push_str("\n| not certified | too long | too short | worst place |\n|---|--:|--:|---|\n");
    for line in rest {
        let _ = writeln!(
            text,
            "| {} ({}) | {} | {} | {} |",
            line.name,
            line.set,
            shown(line.too_long),
            shown(line.too_short),
            line.worst.as_deref().unwrap_or(""),
        );
    }
    text
}
