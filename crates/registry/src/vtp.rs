//! Algorithms that propagate whole lists of windows across the faces around a vertex, or one face.

use geobench_vtp::{
    EdgeBased, FastOptions, Ftp, Opftp, Opvtp, Pvtp, Vtp, VtpExhaustive, VtpFast, VtpNoRule1,
    VtpNoRules23, VtpTrimming,
};

use super::parameter::{SIMD, THREADS, threshold_width};
use super::{Algorithm, Parameter, Values};

/// The constructor of a variant of list propagation.
macro_rules! list_propagation {
    ($solver:ident) => {
        |mesh, values| {
            Box::new(
                $solver::new(mesh)
                    .with_threshold(threshold_width(mesh, values))
                    .with_instructions(values.instructions()),
            )
        }
    };
}

pub(crate) const FAMILY: &[Algorithm] = &[
    Algorithm {
        name: "ftp",
        family: "vtp-family",
        crossing: "list",
        paper: "Qin et al. 2016, section 5.1",
        summary: "whole lists cross one face at a time; rules 1, 2 and 3",
        departs: "as vtp",
        complexity: "time O(n^2), apart from the queue of faces; space O(n^2)",
        choose: "to compare schedules: as many windows as vtp, in some more time",
        build: list_propagation!(Ftp),
        ..Algorithm::EXACT
    },
    Algorithm {
        name: "opftp",
        family: "vtp-family",
        crossing: "list",
        paper: "Qin et al. 2016, section 5.1",
        summary: "ftp with late windows merged in order",
        departs: "as vtp; the place of a late window is found by a linear scan, not by binary search",
        complexity: "as ftp, and O(k) to put a window into a list of k",
        choose: "to repeat the paper's comparison; ftp is faster",
        build: list_propagation!(Opftp),
        ..Algorithm::EXACT
    },
    Algorithm {
        name: "vtp",
        family: "vtp-family",
        crossing: "list",
        paper: "Qin et al. 2016, sections 4 and 5.2",
        summary: "whole lists cross around the nearest vertex; rules 1, 2 and 3",
        departs: "rule 1 has a safe form, because the printed one loses distances; case 12 has two of its three tests; rules are applied when a list crosses, so that lists of interior edges merge while they wait, and to all neighbours at once; lists beside thin faces cross nearest first",
        keeps: "the windows of the wavefront, in one list for each half-edge on it",
        complexity: "time O(n^2), apart from the queue of vertices; space O(n^2)",
        choose: "to compare with the papers; for distances at vertices, vtp-fast is faster",
        build: list_propagation!(Vtp),
        ..Algorithm::EXACT
    },
    Algorithm {
        name: "opvtp",
        family: "vtp-family",
        crossing: "list",
        paper: "Qin et al. 2016, sections 5.1 and 5.2",
        summary: "vtp with late windows merged in order",
        departs: "as opftp",
        complexity: "as vtp, and O(k) to put a window into a list of k",
        choose: "to repeat the paper's comparison; vtp is faster",
        build: list_propagation!(Opvtp),
        ..Algorithm::EXACT
    },
    Algorithm {
        name: "vtp-exhaustive",
        family: "vtp-family",
        crossing: "list",
        paper: "Qin et al. 2016, sections 3 and 6.2",
        summary: "vtp with every pair of windows of a face checked",
        departs: "as vtp; cases 8 and 10 have the safe form of rule 1",
        complexity: "time O(k^2) for a list of k windows, O(n^3) in all; space O(n^2)",
        keeps: "the windows of the wavefront and one length for each half-edge",
        choose: "to measure full pairwise pruning: 2 to 7 % fewer windows, 2 to 5 times the time",
        build: list_propagation!(VtpExhaustive),
        ..Algorithm::EXACT
    },
    Algorithm {
        name: "vtp-trimming",
        family: "vtp-family",
        crossing: "list",
        paper: "Qin et al. 2016, section 6.2",
        summary: "vtp with neighbours cut at their tie points",
        departs: "as vtp",
        choose: "to compare trimming with pruning: some windows fewer, half as much time again",
        build: list_propagation!(VtpTrimming),
        ..Algorithm::EXACT
    },
    Algorithm {
        name: "vtp-no-rule1",
        family: "vtp-family",
        crossing: "list",
        paper: "Qin et al. 2016, section 6.2",
        summary: "vtp with every window tried on both exits",
        departs: "as vtp",
        choose: "to measure the effect of rule 1",
        build: list_propagation!(VtpNoRule1),
        ..Algorithm::EXACT
    },
    Algorithm {
        name: "vtp-no-rules23",
        family: "vtp-family",
        crossing: "list",
        paper: "Qin et al. 2016, section 6.2",
        summary: "vtp without comparing windows with each other",
        departs: "as vtp",
        keeps: "the windows of the wavefront, at the peak 1.5 times as many as vtp",
        choose: "to measure the effect of rules 2 and 3",
        build: list_propagation!(VtpNoRules23),
        ..Algorithm::EXACT
    },
    Algorithm {
        name: "edge-based",
        family: "vtp-family",
        crossing: "list",
        paper: "Qin et al. 2016, the report that came before it, chapter 5",
        summary: "the earlier form of vtp",
        departs: "strategy II has the safe form of rule 1 of vtp; windows are filtered by vertices, without which they need not end",
        keeps: "the windows of the wavefront and one length for each half-edge",
        complexity: "time O(n^2), the report's O(n log n) rests on a measured factor; space O(n^2)",
        choose: "to repeat the report's comparison",
        build: list_propagation!(EdgeBased),
        ..Algorithm::EXACT
    },
];

const PAIRS: Parameter = Parameter::integer(
    "pairs",
    8,
    0..=1_000_000,
    "N: rules 2 and 3 run on every N-th long list; 1: all; 0: none",
);

const BUCKET: Parameter = Parameter::real(
    "bucket",
    0.25,
    0.001..=1e6,
    "bucket width in mean edge lengths; the vertices of a bucket are processed together",
);

const STAY: Parameter = Parameter::integer(
    "stay",
    80,
    0..=1_000_000,
    "N: from a mean of N windows a list on, they stay in an unfolded plane; 0: never",
);

const SPAWN_WEDGE: Parameter = Parameter::word(
    "spawn_wedge",
    &["on", "off"],
    "a vertex spawns windows only into the wedge behind the path that reached it",
);

const MERGE_SPLIT: Parameter = Parameter::word(
    "merge_split",
    &["on", "off"],
    "merges windows split at a flat vertex; active if 1/8 of the vertices are flat",
);

const RENUMBER: Parameter = Parameter::word(
    "renumber",
    &["on", "off"],
    "renumbers vertices and faces breadth first",
);

pub(crate) const FAST: &[Algorithm] = &[
    Algorithm {
        name: "vtp-fast",
        fast: true,
        family: "vtp-family",
        queue: "buckets",
        crossing: "list",
        paper: "Qin et al. 2016, with improvements of our own",
        summary: "vtp with every improvement that keeps it exact",
        departs: "vertices come in buckets, both sides of a face share a list and fewer pairs are compared, so that counts are not those of the paper",
        keeps: "the windows of the wavefront, 40 bytes each, and 160 bytes for each face",
        choose: "for distances at vertices: it is the fastest, with little memory",
        parameters: &[
            SIMD,
            PAIRS,
            BUCKET,
            STAY,
            SPAWN_WEDGE,
            MERGE_SPLIT,
            RENUMBER,
        ],
        build: |mesh, values| {
            let stay = values.integer(&STAY) as u32;
            let options = FastOptions {
                stay,
                ..options(values)
            };
            Box::new(VtpFast::with_options(mesh, options))
        },
        ..Algorithm::EXACT
    },
    Algorithm {
        name: "pvtp",
        fast: true,
        family: "vtp-family",
        queue: "buckets",
        crossing: "list",
        paper: "Qin et al. 2016, made parallel by us",
        summary: "vtp-fast on several threads",
        departs: "as vtp-fast; the paper has one thread",
        keeps: "as vtp-fast; in addition 16 bytes per face and 37 bytes per vertex for each thread, and 12 bytes per vertex for positions",
        choose: "for large models on a machine with idle processors (--threads)",
        ends_early: false,
        parameters: &[
            THREADS,
            SIMD,
            PAIRS,
            BUCKET,
            SPAWN_WEDGE,
            MERGE_SPLIT,
            RENUMBER,
        ],
        build: |mesh, values| {
            let options = options(values);
            Box::new(Pvtp::with_options(mesh, values.threads(), options))
        },
        ..Algorithm::EXACT
    },
];

fn options(values: &Values) -> FastOptions {
    FastOptions {
        instructions: values.instructions(),
        pairs: values.integer(&PAIRS) as u32,
        bucket: values.real(&BUCKET),
        stay: 0,
        spawn_wedge: values.word(&SPAWN_WEDGE) == Some("on"),
        coalesce: values.word(&MERGE_SPLIT) == Some("on"),
        renumber: values.word(&RENUMBER) == Some("on"),
    }
}
