//! What an entry of the table says.

use geobench_mesh::Mesh;
use geobench_window::{Counter, Solver};

use super::parameter::{Parameter, Values};

/// What the suite knows about an algorithm.
#[derive(Clone, Copy, Debug)]
pub struct Algorithm {
    /// The name by which users ask for it, in lower case.
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
    /// What it keeps in memory while it runs, and what is left at the end.
    pub keeps: &'static str,
    /// When to choose it.
    pub choose: &'static str,
    /// The counter of windows that the papers charge to its memory: those stored at the end for
    /// algorithms that keep every window, those alive at the peak for the others.
    pub memory_counter: Counter,
    /// The most faces with which it ends within a minute or so, for one that is slower by orders of
    /// magnitude than the others; `verify` leaves it out beyond that, unless it is named.
    pub comfortable_faces: Option<u64>,
    /// What can be set, as in `name{key=value}`, in the order in which labels show it.
    pub parameters: &'static [Parameter],
    /// Sets it up for a mesh with these values of its parameters; this is not part of the time
    /// reported for it.
    pub build: for<'m> fn(&'m Mesh, &Values) -> Box<dyn Solver + 'm>,
}

impl Algorithm {
    /// Sets the algorithm up for `mesh`, every parameter at its default.
    pub fn build_default<'m>(&self, mesh: &'m Mesh) -> Box<dyn Solver + 'm> {
        (self.build)(mesh, &Values::default())
    }
}
