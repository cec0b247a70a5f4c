//! Algorithms that store windows on edges and trim them against each other.

use geobench_fwp::{vtp_mmp, vtp_mmp_batched};
use geobench_mesh::Mesh;
use geobench_mmp::{
    Batched, Carrier, NearestLists, Retention, Trimming, mmp_batched, mmp_fast, mmp_from,
};
use geobench_window::continuous::Continuous;
use geobench_window::queue::{Discipline, Fifo};
use geobench_window::{Counter, Solver, VertexFilter};

use super::parameter::{self, THRESHOLD, threshold_width, with_queue};
use super::{Algorithm, Parameter, Values, single};

/// The unit of propagation.
pub(crate) const TURN: Parameter = Parameter::word(
    "turn",
    &["window", "list"],
    "`window` takes one window at a time, as in the paper; `list` takes the windows of a half-edge together, as far as the queue allows",
);

const SLACK: Parameter = Parameter::real(
    "slack",
    NearestLists::SLACK,
    0.0..=1e6,
    "windows at most so many mean edge lengths farther than the nearest one of their half-edge are taken with it; fewer of a list of more than 256",
)
.only_with(TURN.name, &["list"]);

/// Filter before windows are compared. Single windows are never filtered.
pub(crate) const FILTER: Parameter = Parameter::word(
    "filter",
    &["none", "vertices"],
    "`none` compares all windows with those of their edge, as in the paper; `vertices` first drops those that a path through an end of their edge beats, by two of the three tests of ich",
)
.only_with(TURN.name, &["list"]);

/// Which windows are stored.
pub(crate) const LISTS: Parameter = Parameter::word(
    "lists",
    &["keep", "evict"],
    "`keep` stores all windows that trimming leaves until the end, as in the paper; `evict` evicts those of an edge once the wavefront has passed it",
);

/// [`parameter::QUEUE`], or first in, first out.
const QUEUE: Parameter = Parameter::word(
    "queue",
    &["heap", "heap4", "calendar", "fifo"],
    "`heap` takes the nearest window first, from a binary heap as in the paper; `heap4` from a heap of four children a node; `calendar` from buckets by distance, each sorted when it is due; the order and all counts are the same in all three; `fifo` takes windows first in, first out; lists wait in a calendar queue",
)
.formerly("priority", "calendar")
.only_with(TURN.name, &["window"]);

/// [`LISTS`] of `mmp`. In first-in, first-out order no distance tells that the wavefront has passed
/// an edge. Evicted lists would be reopened again and again, which makes windows wind around
/// needles.
const LISTS_BY_DISTANCE: Parameter = LISTS.only_with(QUEUE.name, &["heap", "heap4", "calendar"]);

/// Whether windows are taken in lists.
pub(crate) fn is_batched(values: &Values) -> bool {
    values.word(&TURN) == Some("list")
}

fn retention(values: &Values) -> Retention {
    match values.word(&LISTS) {
        Some("evict") => Retention::Wavefront,
        _ => Retention::All,
    }
}

/// A solver that takes single windows, with [`LISTS`] and [`THRESHOLD`].
pub(crate) fn stored<Q>(
    solver: Continuous<Trimming, Q>,
    mesh: &Mesh,
    values: &Values,
) -> Box<dyn Solver>
where
    Q: Discipline,
    Continuous<Trimming, Q>: Solver + 'static,
{
    let solver = solver.map_policy(|policy| policy.retaining(retention(values)));
    single(solver, mesh, values)
}

/// A solver that takes lists of windows, with [`FILTER`], [`LISTS`] and [`THRESHOLD`]. It has
/// scalar code only.
pub(crate) fn batched<Q>(solver: Batched<Q>, mesh: &Mesh, values: &Values) -> Box<dyn Solver>
where
    Q: Discipline,
    Batched<Q>: Solver + 'static,
{
    let filter = match values.word(&FILTER) {
        Some("vertices") => VertexFilter::On,
        _ => VertexFilter::Off,
    };
    let solver = solver.filtering(filter).retaining(retention(values));
    Box::new(solver.with_threshold(threshold_width(mesh, values)))
}

pub(crate) const FAMILY: &[Algorithm] = &[
    Algorithm {
        name: "mmp",
        family: "mmp-family",
        paper: "Mitchell, Mount, Papadimitriou 1987; Surazhsky et al. 2005, section 3",
        summary: "windows stored on half-edges, trimmed at tie points, nearest first",
        departs: "drops no narrow windows (threshold); filters windows beside thin faces",
        complexity: "time O(n^2 log n), space O(n^2); about n^1.5 windows in practice",
        keeps: "every window until the end",
        choose: "to compare with published figures of MMP; mmp-fast is faster and needs less memory",
        memory_counter: Counter::StoredWindows,
        parameters: &[TURN, QUEUE, SLACK, FILTER, LISTS_BY_DISTANCE, THRESHOLD],
        crosses_junctions: true,
        build: |mesh, values| {
            if is_batched(values) {
                batched(mmp_batched(mesh, values.real(&SLACK)), mesh, values)
            } else if values.word(&QUEUE) == Some("fifo") {
                let policy = Trimming::new(mesh, Carrier::HalfEdge);
                stored(Continuous::new(mesh, policy, Fifo::default()), mesh, values)
            } else {
                let half_edge = Carrier::HalfEdge;
                with_queue!(&QUEUE, mesh, values, |queue| {
                    stored(mmp_from(mesh, half_edge, queue), mesh, values)
                })
            }
        },
        ..Algorithm::EXACT
    },
    Algorithm {
        name: "mmp-edge",
        family: "mmp-family",
        paper: "Liu 2013; Mitchell, Mount, Papadimitriou 1987",
        summary: "mmp with the windows of both sides of an edge trimmed together",
        departs: "as mmp",
        complexity: "time O(n^2 log n), space O(n^2)",
        keeps: "as mmp, a tenth to a half fewer windows",
        choose: "instead of mmp, if few windows matter more than time",
        memory_counter: Counter::StoredWindows,
        parameters: &[parameter::QUEUE, LISTS, THRESHOLD],
        crosses_junctions: true,
        build: |mesh, values| {
            with_queue!(&parameter::QUEUE, mesh, values, |queue| {
                stored(mmp_from(mesh, Carrier::Edge, queue), mesh, values)
            })
        },
        ..Algorithm::EXACT
    },
];

pub(crate) const FAST: &[Algorithm] = &[Algorithm {
    name: "mmp-fast",
    fast: true,
    family: "mmp-family",
    queue: "calendar",
    crossing: "list",
    paper: "Surazhsky et al. 2005, with improvements of our own",
    summary: "mmp with every improvement that keeps it exact",
    departs: "mmp{turn=list,filter=vertices,lists=evict}: takes lists with a slack, filters windows and evicts those behind the wavefront",
    complexity: "time without a proven bound, space O(n^2)",
    keeps: "the windows around the wavefront",
    choose: "as the reference of checks: it is fast and shares no pruning rule with vtp-fast",
    parameters: &[THRESHOLD],
    crosses_junctions: true,
    build: |mesh, values| Box::new(mmp_fast(mesh).with_threshold(threshold_width(mesh, values))),
    ..Algorithm::EXACT
}];

/// MMP in the order of VTP, which the papers count as a variant of VTP.
pub(crate) const VERTEX_ORDER: Algorithm = Algorithm {
    name: "vtp-mmp",
    family: "vtp-family",
    paper: "Qin et al. 2016, section 6.2",
    summary: "mmp in the order of vtp",
    departs: "as mmp",
    complexity: "time O(n^2 log n), space O(n^2)",
    keeps: "as mmp; in the queue the vertices of the wavefront",
    choose: "to separate the effect of VTP's order from that of its rules",
    memory_counter: Counter::StoredWindows,
    parameters: &[TURN, FILTER, LISTS, THRESHOLD],
    crosses_junctions: true,
    build: |mesh, values| {
        if is_batched(values) {
            batched(vtp_mmp_batched(mesh), mesh, values)
        } else {
            stored(vtp_mmp(mesh), mesh, values)
        }
    },
    ..Algorithm::EXACT
};
