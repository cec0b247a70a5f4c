//! Every algorithm of the suite, in one table, and how users ask for them.
//!
//! This is the only place that knows which algorithms exist. The rest of the program reaches a
//! solver through [`Selection::build`] and the [`Solver`](geobench_window::Solver) trait. The
//! table has a file for each family; adding an algorithm is one entry in one of these files, and
//! adding a family is a file and a line in [`algorithms`].

mod algorithm;
mod ch;
mod fwp;
mod hidden;
mod mmp;
mod outside;
mod parameter;
mod program;
mod select;
pub(crate) mod simd;
mod threshold;
mod vtp;
mod vtp_fast;

use std::sync::LazyLock;

pub use algorithm::Algorithm;
pub use hidden::VARIABLE as HIDDEN_ALGORITHMS;
pub use parameter::{Allowed, MOST_THREADS, Numbers, Parameter, Value, Values};
pub(crate) use program::{Call, PLACEHOLDERS};
pub use program::{Keeping, Program, Programs, UnknownProgram};
pub(crate) use select::nearest;
pub use select::{SelectError, Selection, select, select_one};

/// Every algorithm, in the order in which tables show them.
pub fn algorithms() -> &'static [Algorithm] {
    static ALL: LazyLock<Vec<Algorithm>> = LazyLock::new(|| {
        [
            mmp::FAMILY,
            ch::FAMILY,
            fwp::FAMILY,
            vtp::FAMILY,
            vtp_fast::FAMILY,
        ]
        .concat()
    });
    &ALL
}
