//! Every algorithm in one table, by name and parameter.
//!
//! This is the only place that knows which algorithms exist. The rest of the program reaches a
//! solver through [`Selection::build`] and the [`Solver`] trait. The
//! table has a file for each family; adding an algorithm is one entry in one of these files, and
//! adding a family is a file and a line in [`algorithms`].

use std::sync::LazyLock;

use geobench_mesh::Mesh;
use geobench_window::{Counter, Solver};

mod ch;
#[cfg(feature = "failing-algorithms")]
mod failing;
mod fwp;
mod mmp;
mod parameter;
mod program;
mod select;
mod vtp;

pub use parameter::{Allowed, MOST_THREADS, Numbers, Parameter, Value, Values};
pub(crate) use parameter::{instructions_named, next_narrower};
pub(crate) use program::{Call, PLACEHOLDERS};
pub use program::{ProcessLifetime, Program, Programs};
pub use select::{Selection, select, select_one};

/// Every algorithm, in the order in which tables show them.
pub fn algorithms() -> &'static [Algorithm] {
    static ALL: LazyLock<Vec<Algorithm>> =
        LazyLock::new(|| [mmp::FAMILY, ch::FAMILY, fwp::FAMILY, vtp::FAMILY, vtp::FAST].concat());
    &ALL
}

/// Algorithms that fail, for tests; selected by name only.
const fn failing() -> &'static [Algorithm] {
    #[cfg(feature = "failing-algorithms")]
    return failing::FAMILY;
    #[cfg(not(feature = "failing-algorithms"))]
    &[]
}

/// A registered algorithm.
#[derive(Clone, Copy, Debug)]
pub struct Algorithm {
    /// Its name, in lower case.
    pub name: &'static str,
    /// The group that `--algo` can ask for as a whole, such as `vtp-family`.
    pub family: &'static str,
    /// Where it is described: authors, year, section.
    pub paper: &'static str,
    /// Whether its distances are exact up to rounding (as long as its parameters are the defaults).
    pub exact: bool,
    /// What it does, in one line.
    pub summary: &'static str,
    /// Worst-case time and space; n is the number of faces.
    pub complexity: &'static str,
    /// Data that it keeps in memory during the run and at the end.
    pub keeps: &'static str,
    /// When to choose it.
    pub choose: &'static str,
    /// The counter of windows that the papers charge to its memory: those stored at the end for
    /// algorithms that keep every window, those alive at the peak for the others.
    pub memory_counter: Counter,
    /// For an algorithm that is slower by orders of magnitude: the number of faces that it solves
    /// in about a minute. `verify` skips it on larger models unless it is named.
    pub comfortable_faces: Option<u64>,
    /// Its parameters, in the order of labels, `name{key=value}`.
    pub parameters: &'static [Parameter],
    /// Sets it up for a mesh with these values of its parameters. Set-up is not part of the time of
    /// a solve.
    pub build: fn(&Mesh, &Values) -> Box<dyn Solver>,
}

impl Algorithm {
    /// Defaults of an exact algorithm that keeps the windows of the wavefront only; for the tables
    /// of this module.
    const EXACT: Self = Self {
        name: "",
        family: "",
        paper: "",
        exact: true,
        summary: "",
        complexity: "time O(n^2), space O(n)",
        keeps: "the windows of the wavefront",
        choose: "",
        memory_counter: Counter::PeakWindows,
        comfortable_faces: None,
        parameters: &[parameter::THRESHOLD],
        build: |_, _| panic!("this algorithm has no solver"),
    };

    /// Sets the algorithm up for `mesh`, every parameter at its default.
    pub fn build_default(&self, mesh: &Mesh) -> Box<dyn Solver> {
        (self.build)(mesh, &Values::default())
    }

    /// In what it is not its paper's algorithm unless parameters say so; `docs/algorithms` has
    /// more. Nothing is said of an algorithm that has no paper.
    pub fn departs(&self) -> &'static str {
        match self.name {
            "mmp" => {
                "takes windows of a half-edge together (turn=window: one at a time, without a filter), filters them (filter=none: not) and gives up those behind the wavefront (lists=keep: not); drops no narrow ones"
            }
            "mmp-edge" => {
                "gives up windows behind the wavefront (lists=keep: not); drops no narrow ones"
            }
            "ch" => "keeps and trims windows beside thin faces; drops no narrow ones",
            "ich1" | "ich" => {
                "the margin of the filter is relative, so that rounding never deletes one of two equal paths; drops no narrow windows"
            }
            "fwp-mmp" => {
                "as mmp; a round empties its buckets when it begins instead of marking births, and takes whole lists (turn=window: windows)"
            }
            "fwp-ch" => {
                "as ich; a round empties its buckets when it begins instead of marking births"
            }
            "lc-mmp" | "lc-ch" => {
                "as mmp and ich; the papers print neither beta nor how the threshold follows the distances, so that both are ours; large label last rotates at most once"
            }
            "vtp-mmp" => "lists cross together, never single windows; filter and storage as in mmp",
            "vtp-ch" => "as ich",
            "ftp" | "opftp" | "vtp" | "opvtp" | "vtp-trimming" | "vtp-no-rule1"
            | "vtp-no-rules23" => {
                "rule 1 has a safe form, because that of the paper loses distances; rules are applied when a list crosses, and neighbours compared all at once"
            }
            "vtp-exhaustive" => "as vtp; cases 8 and 10 have the safe form of rule 1",
            "edge-based" => {
                "strategy II has the safe form of rule 1 of vtp; windows are filtered, without which they need not end"
            }
            "vtp-fast" => {
                "as vtp; vertices come in buckets, both sides of a face share a list and fewer pairs are compared, so that counts are not those of the paper"
            }
            "pvtp" => "as vtp-fast; the paper has one thread",
            _ => "",
        }
    }
}
