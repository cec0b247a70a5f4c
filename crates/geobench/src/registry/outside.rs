//! What the table says of outside programs: nothing, until a file describes them
//! ([`crate::exec::outside`]).

use geobench_window::Counter;

use super::Algorithm;

/// What names of outside programs begin with.
pub(super) const PREFIX: &str = "ext:";

/// Stands for every outside program.
pub(super) static OUTSIDE: Algorithm = Algorithm {
    name: "ext",
    family: "ext",
    paper: "its own",
    exact: false,
    summary: "an outside program",
    complexity: "its own",
    keeps: "its own",
    choose: "to compare with",
    memory_counter: Counter::StoredWindows,
    comfortable_faces: None,
    parameters: &[],
    build: |_, _| panic!("an outside program has no solver in this one"),
};
