//! Algorithms that keep the windows from which geodesic Voronoi diagrams are extracted.

use geobench_fwp::{BucketOptions, Buckets};
use geobench_mesh::Mesh;
use geobench_voronoi::{Lct11, Removal, WindowVtp, WindowVtpOptions};
use geobench_window::{Counter, VertexFilter};

use super::parameter::with_queue;
use super::{Algorithm, Parameter, Values};

const REMOVAL: Parameter = Parameter::word(
    "rwr",
    &["on", "off"],
    "`on` deletes redundant windows, those around which all comes from one source, once the wave has passed; `off` keeps all",
);

const FILTER: Parameter = Parameter::word(
    "filter",
    &["none", "vertices"],
    "`none` compares all windows with those of their edge, as in the paper; `vertices` first drops those that a path through an end of their edge beats",
);

const QUEUE: Parameter = Parameter::word(
    "queue",
    &["heap", "heap4", "calendar", "buckets"],
    "`heap`, `heap4` and `calendar` take the nearest window, as in mmp; `buckets` takes those of a round of fwp-mmp",
);

const PERIOD: Parameter = Parameter::real(
    "c",
    1.0,
    1e-3..=1e6,
    "propagations between two searches for redundant windows, per face of the mesh",
);

fn filter(values: &Values) -> VertexFilter {
    match values.word(&FILTER) {
        Some("vertices") => VertexFilter::On,
        _ => VertexFilter::Off,
    }
}

fn window_vtp(mesh: &Mesh, values: &Values) -> WindowVtp {
    let removal = match values.word(&REMOVAL) {
        Some("off") => Removal::Off,
        _ => Removal::Continuous,
    };
    let filter = filter(values);
    WindowVtp::with_options(mesh, WindowVtpOptions { removal, filter })
}

fn xls14(mesh: &Mesh, values: &Values) -> WindowVtp {
    let c = values.real(&PERIOD);
    let removal = Removal::Periodic { c };
    let filter = filter(values);
    WindowVtp::with_options(mesh, WindowVtpOptions { removal, filter })
}

/// The constructor of `lct11` with its queue.
macro_rules! lct11 {
    () => {
        |mesh, values| {
            if values.word(&QUEUE) == Some("buckets") {
                let buckets = Buckets::new(mesh, BucketOptions::default());
                return Box::new(Lct11::in_order(mesh, buckets, filter(values)));
            }
            with_queue!(&QUEUE, mesh, values, |queue| {
                Box::new(Lct11::in_order(mesh, queue, filter(values)))
            })
        }
    };
}

/// Defaults of the algorithms of this file.
const ALGORITHM: Algorithm = Algorithm {
    family: "voronoi-family",
    complexity: "time O(n^2 log n), space O(n^2)",
    ends_early: false,
    ..Algorithm::EXACT
};

pub(crate) const FAMILY: &[Algorithm] = &[
    Algorithm {
        name: "window-vtp",
        crossing: "list",
        paper: "Qin, Yu, Zhang 2017, sections 3 and 4",
        summary: "vtp's order, windows stored on edges and trimmed, redundant ones deleted",
        departs: "gives an edge up only if both its faces are beyond the wave, counts their vertices, and closes it: the printed procedure loses windows of cell borders; filters windows beside thin faces and takes them nearest first",
        keeps: "the windows around the wavefront and at the borders of cells",
        choose: "for Voronoi diagrams (geobench voronoi)",
        memory_counter: Counter::PeakWindows,
        parameters: &[REMOVAL, FILTER],
        build: |mesh, values| Box::new(window_vtp(mesh, values)),
        field: Some(|mesh, values| Box::new(window_vtp(mesh, values))),
        ..ALGORITHM
    },
    Algorithm {
        name: "lct11",
        paper: "Liu, Chen, Tang 2011, stage 1",
        summary: "mmp from several sources, with the source of every window",
        departs: "trims the windows of both directions of an edge together; filters windows beside thin faces",
        keeps: "every window until the end",
        choose: "to compare with window-vtp",
        memory_counter: Counter::StoredWindows,
        parameters: &[QUEUE, FILTER],
        build: lct11!(),
        field: Some(lct11!()),
        ..ALGORITHM
    },
    Algorithm {
        name: "xls14",
        crossing: "list",
        paper: "Xu et al. 2014, with the propagation of Qin, Yu, Zhang 2017, section 6.2",
        summary: "window-vtp with a periodic search of all faces for redundant windows",
        departs: "as window-vtp",
        keeps: "as window-vtp, and the windows that have become redundant since the last search",
        choose: "to compare with window-vtp",
        memory_counter: Counter::PeakWindows,
        parameters: &[PERIOD, FILTER],
        build: |mesh, values| Box::new(xls14(mesh, values)),
        field: Some(|mesh, values| Box::new(xls14(mesh, values))),
        ..ALGORITHM
    },
];
