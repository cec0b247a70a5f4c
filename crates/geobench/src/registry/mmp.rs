//! Algorithms that keep windows on edges and trim them against each other.

use geobench_mmp::{mmp, mmp_edge};
use geobench_window::Counter;

use super::Algorithm;
use super::threshold::{self, THRESHOLD};

pub(super) const FAMILY: &[Algorithm] = &[
    Algorithm {
        name: "mmp",
        family: "mmp-family",
        paper: "Mitchell, Mount, Papadimitriou 1987; Surazhsky et al. 2005, section 3",
        exact: true,
        summary: "windows kept on half-edges, overlaps trimmed at tie points, nearest first",
        complexity: "time O(n^2 log n), space O(n^2)",
        keeps: "every window until the end, about n^1.5 of them on scanned models",
        choose: "as the reference; when distances are wanted everywhere on edges, not only at vertices",
        memory_counter: Counter::StoredWindows,
        comfortable_faces: None,
        parameters: &[THRESHOLD],
        build: |mesh, values| Box::new(mmp(mesh).with_threshold(threshold::width(mesh, values))),
    },
    Algorithm {
        name: "mmp-edge",
        family: "mmp-family",
        paper: "Liu 2013; Mitchell, Mount, Papadimitriou 1987",
        exact: true,
        summary: "MMP with the windows of both sides of an edge trimmed against each other",
        complexity: "time O(n^2 log n), space O(n^2)",
        keeps: "every window until the end, a tenth to a half fewer than mmp",
        choose: "instead of mmp where memory is short",
        memory_counter: Counter::StoredWindows,
        comfortable_faces: None,
        parameters: &[THRESHOLD],
        build: |mesh, values| {
            Box::new(mmp_edge(mesh).with_threshold(threshold::width(mesh, values)))
        },
    },
];
