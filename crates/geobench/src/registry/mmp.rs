//! Algorithms that keep windows on edges and trim them against each other.

use geobench_mmp::{Keep, NearLists, mmp_by_window, mmp_edge, mmp_with_slack};
use geobench_window::{Counter, VertexFilter};

use super::parameter::{THRESHOLD, threshold_width};
use super::{Algorithm, Parameter, Values};

/// Whether windows of edges behind the wavefront are kept.
pub(super) const LISTS: Parameter = Parameter::word(
    "lists",
    &["forget", "keep"],
    "`forget` gives up the windows of an edge once the wave is past it; `keep` stores all that are left until the end, with filter=none as in the paper",
);

/// The value of [`LISTS`].
pub(super) fn keep(values: &Values) -> Keep {
    match values.word(&LISTS) {
        Some("keep") => Keep::All,
        _ => Keep::Wavefront,
    }
}

/// Filter before windows are compared.
pub(super) const FILTER: Parameter = Parameter::word(
    "filter",
    &["vertices", "none"],
    "`vertices` drops windows that a path through an end of their edge beats, by two of the three tests of ich; `none` compares all with those of the edge, as in the paper",
);

/// The value of [`FILTER`].
pub(super) fn filter(values: &Values) -> VertexFilter {
    match values.word(&FILTER) {
        Some("none") => VertexFilter::Off,
        _ => VertexFilter::On,
    }
}

/// [`FILTER`] for algorithms with the parameter `turn`: single windows are never filtered, as in
/// the papers.
pub(super) const LIST_FILTER: Parameter = FILTER.only_with(TURN.name, "list");

/// What is propagated at once.
const TURN: Parameter = Parameter::word(
    "turn",
    &["list", "window"],
    "`list` takes the nearest window and others of its half-edge with it; `window` one at a time, strictly nearest first, as in the paper",
);

const SLACK: Parameter = Parameter::real(
    "slack",
    NearLists::SLACK,
    0.0..=1e6,
    "with turn=list, how much further than the nearest one these may be, in mean edge lengths",
)
.only_with(TURN.name, "list");

pub(super) const FAMILY: &[Algorithm] = &[
    Algorithm {
        name: "mmp",
        family: "mmp-family",
        paper: "Mitchell, Mount, Papadimitriou 1987; Surazhsky et al. 2005, section 3",
        summary: "windows kept on half-edges, trimmed at tie points, nearest first",
        complexity: "time O(n^2 log n) with turn=window, space O(n^2)",
        keeps: "the windows around the wavefront; with lists=keep every window until the end, about n^1.5 of them",
        choose: "as the reference; with filter=none,lists=keep it stores as much as the papers' programs do, with turn=window it keeps to their order and has no filter",
        memory_counter: Counter::StoredWindows,
        parameters: &[TURN, SLACK, LIST_FILTER, LISTS, THRESHOLD],
        build: |mesh, values| {
            let threshold = threshold_width(mesh, values);
            if values.word(&TURN) == Some("window") {
                let solver = mmp_by_window(mesh).map_policy(|policy| policy.keeping(keep(values)));
                return Box::new(solver.with_threshold(threshold));
            }
            let solver = mmp_with_slack(mesh, values.real(&SLACK));
            let solver = solver.filtering(filter(values)).keeping(keep(values));
            Box::new(solver.with_threshold(threshold))
        },
        ..Algorithm::EXACT
    },
    Algorithm {
        name: "mmp-edge",
        family: "mmp-family",
        paper: "Liu 2013; Mitchell, Mount, Papadimitriou 1987",
        summary: "mmp with the windows of both sides of an edge trimmed together",
        complexity: "time O(n^2 log n), space O(n^2)",
        keeps: "as mmp; of all windows there are a tenth to a half fewer",
        choose: "instead of mmp where few windows matter more than time; it takes them one by one, so compare it with mmp{turn=window}",
        memory_counter: Counter::StoredWindows,
        parameters: &[LISTS, THRESHOLD],
        build: |mesh, values| {
            let solver = mmp_edge(mesh).map_policy(|policy| policy.keeping(keep(values)));
            Box::new(solver.with_threshold(threshold_width(mesh, values)))
        },
        ..Algorithm::EXACT
    },
];
