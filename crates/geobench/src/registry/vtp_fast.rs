//! VTP for speed, on one thread and on several, with their switches.

use geobench_vtp::{FastOptions, Pvtp, VtpFast};
use geobench_window::Counter;

use super::parameter::THREADS;
use super::simd::SIMD;
use super::{Algorithm, Parameter, Values};

const PAIRS: Parameter = Parameter::integer(
    "pairs",
    8,
    0..=1_000_000,
    "applies rules 2 and 3 to one in so many of the longer lists; to all lists if 1, to none if 0",
);

const BUCKET: Parameter = Parameter::real(
    "bucket",
    0.25,
    0.001..=1e6,
    "lets vertices have their turns together whose distances are within so many mean edge lengths",
);

const SHADOW: Parameter = Parameter::word(
    "shadow",
    &["on", "off"],
    "sends windows from a vertex only into the shadow of the path that reached it",
);

const REUNITE: Parameter = Parameter::word(
    "reunite",
    &["on", "off"],
    "makes one window again of those that a flat vertex has parted, if an eighth of the vertices is flat",
);

const RENUMBER: Parameter = Parameter::word(
    "renumber",
    &["on", "off"],
    "puts vertices and faces into an order of its own, breadth first",
);

pub(super) const FAMILY: &[Algorithm] = &[
    Algorithm {
        name: "vtp-fast",
        family: "vtp-family",
        paper: "Qin et al. 2016, with improvements of our own",
        exact: true,
        summary: "vtp with every improvement that keeps it exact: vector instructions, vertices in buckets, fewer checks",
        complexity: "time O(n^2), space O(n)",
        keeps: "the windows of the wavefront, in one list for each half-edge on it",
        choose: "for distances at vertices, always: it is the fastest, with little memory",
        memory_counter: Counter::PeakWindows,
        comfortable_faces: None,
        parameters: &[SIMD, PAIRS, BUCKET, SHADOW, REUNITE, RENUMBER],
        build: |mesh, values| Box::new(VtpFast::with_options(mesh, options(values))),
    },
    Algorithm {
        name: "pvtp",
        family: "vtp-family",
        paper: "Qin et al. 2016, made parallel by us",
        exact: true,
        summary: "vtp-fast on several threads: each takes a part of the wavefront; the same distances but for rounding",
        complexity: "time O(n^2), space O(n)",
        keeps: "the windows of the wavefront, in one list for each half-edge on it",
        choose: "for large models on a machine with idle processors (--threads)",
        memory_counter: Counter::PeakWindows,
        comfortable_faces: None,
        parameters: &[THREADS, SIMD, PAIRS, BUCKET, SHADOW, REUNITE, RENUMBER],
        build: |mesh, values| {
            let options = options(values);
            Box::new(Pvtp::with_options(mesh, threads(values), options))
        },
    },
];

fn threads(values: &Values) -> usize {
    values.integer_or_word(&THREADS).unwrap_or(1) as usize
}

fn options(values: &Values) -> FastOptions {
    FastOptions {
        instructions: values.instructions(),
        pairs: values.integer(&PAIRS) as u32,
        bucket: values.real(&BUCKET),
        shadow: values.word(&SHADOW) == Some("on"),
        reunite: values.word(&REUNITE) == Some("on"),
        renumber: values.word(&RENUMBER) == Some("on"),
    }
}
