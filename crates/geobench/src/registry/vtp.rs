//! Algorithms that take whole lists of windows across the faces around a vertex or a face.

use geobench_vtp::Vtp;
use geobench_window::Counter;

use super::Algorithm;

pub(super) const FAMILY: &[Algorithm] = &[Algorithm {
    name: "vtp",
    family: "vtp-family",
    paper: "Qin et al. 2016, sections 4 and 5.2",
    exact: true,
    summary: "all windows around the nearest vertex cross its triangles together, pruned by rules 1, 2 and 3",
    complexity: "time O(n^2), space O(n)",
    keeps: "the windows of the wavefront, in one list for each half-edge on it",
    choose: "for distances at vertices: it is the fastest here and takes the least memory",
    memory_counter: Counter::PeakWindows,
    parameters: &[],
    build: |mesh, _| Box::new(Vtp::new(mesh)),
}];
