//! Approximate algorithms, for comparison with exact ones.

use geobench_approx::{Boundary, Dijkstra, Fmm, FmmUntidy, Heat, HeatOptions, Vsp};

use super::parameter::THREADS;
use super::{Algorithm, Parameter, Values};

const UNFOLD: Parameter = Parameter::word(
    "unfold",
    &["on", "off"],
    "splits obtuse corners by unfolding the faces opposite to them",
);

const BUCKET: Parameter = Parameter::real(
    "bucket",
    0.1,
    0.001..=1e6,
    "width of a bucket in mean edge lengths",
);

const TIME: Parameter = Parameter::real(
    "t",
    1.0,
    1e-3..=1e6,
    "time of heat flow, in squares of the mean edge length; larger values give smoother distances, less accurate on good meshes",
);

const BOUNDARY: Parameter = Parameter::word(
    "boundary",
    &["average", "neumann", "dirichlet"],
    "`neumann`: no heat crosses the boundary; `dirichlet`: the boundary is cold; `average`: the mean of both",
);

const DELAUNAY: Parameter = Parameter::word(
    "delaunay",
    &["on", "off"],
    "flips inner edges first, until no two opposite angles sum to more than pi; without, distances on thin triangles may be negative or far off",
);

const SHIFT: Parameter = Parameter::real(
    "shift",
    0.0,
    0.0..=1.0,
    "added to the diagonal of the Laplace matrix in place of fixing a vertex; geometry-central, the library behind potpourri3d, adds 1e-6",
);

pub(crate) const FAMILY: &[Algorithm] = &[
    Algorithm {
        name: "dijkstra",
        paper: "Dijkstra 1959",
        summary: "shortest paths along edges",
        departs: "in nothing",
        complexity: "time O(n log n), space O(n)",
        keeps: "one distance for each vertex",
        choose: "as the baseline of approximations: never too short, and no better on finer meshes",
        crosses_junctions: true,
        build: |mesh, _| Box::new(Dijkstra::new(mesh)),
        ..Algorithm::APPROXIMATE
    },
    Algorithm {
        name: "fmm",
        paper: "Kimmel, Sethian 1998",
        summary: "fast marching on triangles",
        departs: "at most 100 faces are unfolded for an obtuse corner",
        complexity: "time O(n log n), space O(n)",
        keeps: "one distance for each vertex, and two to four triangles for each face",
        choose: "for one source and an error of about a percent, in a little more time than dijkstra",
        parameters: &[UNFOLD],
        build: |mesh, values| Box::new(Fmm::new(mesh, is_on(values, &UNFOLD))),
        ..Algorithm::APPROXIMATE
    },
    Algorithm {
        name: "fmm-untidy",
        queue: "buckets",
        paper: "Yatziv, Bartesaghi, Sapiro 2006",
        summary: "fmm with a queue of buckets",
        departs: "as fmm; the paper is on grids",
        complexity: "time O(n), space O(n)",
        keeps: "as fmm",
        choose: "to measure the cost and the benefit of the exact order of fmm",
        ends_early: false,
        parameters: &[BUCKET, UNFOLD],
        build: |mesh, values| {
            let unfold = is_on(values, &UNFOLD);
            Box::new(FmmUntidy::new(mesh, unfold, values.real(&BUCKET)))
        },
        ..Algorithm::APPROXIMATE
    },
    Algorithm {
        name: "vsp",
        queue: "buckets",
        paper: "Trettner, Bommes, Kobbelt 2021",
        summary: "virtual source propagation: one unfolded source for each face; on several threads",
        departs: "a face keeps the place of its source, not three squared distances; what a face sees depends on saddles; sources move in rounds, so that threads do not change distances",
        complexity: "time O(n) in practice, 2.1 to 2.7 crossings for each face; space O(n), 80 bytes for each face",
        keeps: "one virtual source for each face",
        choose: "for a mean error of some 0.2 % in a fraction of the time of any exact algorithm",
        ends_early: false,
        crosses_junctions: true,
        parameters: &[THREADS],
        build: |mesh, values| Box::new(Vsp::new(mesh, values.threads())),
        ..Algorithm::APPROXIMATE
    },
    Algorithm {
        name: "heat",
        queue: "none",
        paper: "Crane, Weischedel, Wardetzky 2013",
        summary: "the heat method: directions of heat, integrated",
        departs: "flips edges to intrinsic Delaunay first (delaunay); edges are made a little longer where faces have no area",
        complexity: "set-up O(n^1.5), then O(n log n) for each source; space O(n log n)",
        keeps: "the factors of two sparse matrices, or of three if there is a boundary",
        choose: "for many sources on one mesh, or where smoothness matters more than an error of about a percent",
        ends_early: false,
        parameters: &[TIME, BOUNDARY, DELAUNAY, SHIFT],
        build: |mesh, values| Box::new(Heat::new(mesh, heat_options(values))),
        ..Algorithm::APPROXIMATE
    },
];

fn is_on(values: &Values, parameter: &Parameter) -> bool {
    values.word(parameter) == Some("on")
}

fn heat_options(values: &Values) -> HeatOptions {
    HeatOptions {
        time: values.real(&TIME),
        boundary: match values.word(&BOUNDARY) {
            Some("neumann") => Boundary::Insulated,
            Some("dirichlet") => Boundary::Cold,
            _ => Boundary::Average,
        },
        delaunay: is_on(values, &DELAUNAY),
        shift: values.real(&SHIFT),
    }
}
