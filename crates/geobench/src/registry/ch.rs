//! Algorithms that split and filter windows and keep none.

use geobench_ich::ich;
use geobench_window::Counter;

use super::Algorithm;

pub(super) const FAMILY: &[Algorithm] = &[Algorithm {
    name: "ich",
    family: "ch-family",
    paper: "Chen, Han 1990; Xin, Wang 2009, sections 3.2 and 3.3",
    exact: true,
    summary: "windows filtered by vertex distances and not kept, nearest first",
    complexity: "time O(n^2 log n), space O(n)",
    keeps: "the windows in the queue and one record for each angle",
    choose: "to compare with published figures of ICH; when memory is short and simplicity counts",
    memory_counter: Counter::PeakWindows,
    parameters: &[],
    build: |mesh, _| Box::new(ich(mesh)),
}];
