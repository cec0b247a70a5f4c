//! Algorithms that take whole lists of windows across the faces around a vertex or a face.

use geobench_vtp::{
    EdgeBased, FastOptions, Ftp, Opftp, Opvtp, Pvtp, Vtp, VtpExhaustive, VtpFast, VtpNoRule1,
    VtpNoRules23, VtpTrimming,
};
use geobench_window::Counter;

use super::parameter::{SIMD, THREADS, THRESHOLD, threshold_width};
use super::{Algorithm, Parameter, Values};

pub(super) const FAMILY: &[Algorithm] = &[
    Algorithm {
        name: "ftp",
        family: "vtp-family",
        paper: "Qin et al. 2016, section 5.1",
        exact: true,
        summary: "whole lists cross one face at a time; rules 1, 2 and 3",
        complexity: "time O(n^2), space O(n)",
        keeps: "the windows of the wavefront",
        choose: "to compare schedules: as many windows as vtp, in some more time",
        memory_counter: Counter::PeakWindows,
        comfortable_faces: None,
        parameters: &[THRESHOLD],
        build: |mesh, values| {
            Box::new(
                Ftp::new(mesh)
                    .with_threshold(threshold_width(mesh, values))
                    .with_instructions(values.instructions()),
            )
        },
    },
    Algorithm {
        name: "opftp",
        family: "vtp-family",
        paper: "Qin et al. 2016, section 5.1",
        exact: true,
        summary: "ftp with late windows merged in order",
        complexity: "time O(n^2), space O(n)",
        keeps: "the windows of the wavefront",
        choose: "to repeat the paper's comparison with ftp",
        memory_counter: Counter::PeakWindows,
        comfortable_faces: None,
        parameters: &[THRESHOLD],
        build: |mesh, values| {
            Box::new(
                Opftp::new(mesh)
                    .with_threshold(threshold_width(mesh, values))
                    .with_instructions(values.instructions()),
            )
        },
    },
    Algorithm {
        name: "vtp",
        family: "vtp-family",
        paper: "Qin et al. 2016, sections 4 and 5.2",
        exact: true,
        summary: "whole lists cross around the nearest vertex; rules 1, 2 and 3",
        complexity: "time O(n^2), space O(n)",
        keeps: "the windows of the wavefront, in one list for each half-edge on it",
        choose: "to compare with the papers; for distances at vertices, vtp-fast is faster",
        memory_counter: Counter::PeakWindows,
        comfortable_faces: None,
        parameters: &[THRESHOLD],
        build: |mesh, values| {
            Box::new(
                Vtp::new(mesh)
                    .with_threshold(threshold_width(mesh, values))
                    .with_instructions(values.instructions()),
            )
        },
    },
    Algorithm {
        name: "opvtp",
        family: "vtp-family",
        paper: "Qin et al. 2016, sections 5.1 and 5.2",
        exact: true,
        summary: "vtp with late windows merged in order",
        complexity: "time O(n^2), space O(n)",
        keeps: "the windows of the wavefront",
        choose: "to repeat the paper's comparison with vtp",
        memory_counter: Counter::PeakWindows,
        comfortable_faces: None,
        parameters: &[THRESHOLD],
        build: |mesh, values| {
            Box::new(
                Opvtp::new(mesh)
                    .with_threshold(threshold_width(mesh, values))
                    .with_instructions(values.instructions()),
            )
        },
    },
    Algorithm {
        name: "vtp-exhaustive",
        family: "vtp-family",
        paper: "Qin et al. 2016, sections 3 and 6.2",
        exact: true,
        summary: "vtp with every pair of windows of a face checked",
        complexity: "time O(n^3), space O(n)",
        keeps: "the windows of the wavefront and one length for each half-edge",
        choose: "to see how little pruning there is left: hardly fewer windows, several times the time",
        memory_counter: Counter::PeakWindows,
        comfortable_faces: None,
        parameters: &[THRESHOLD],
        build: |mesh, values| {
            Box::new(
                VtpExhaustive::new(mesh)
                    .with_threshold(threshold_width(mesh, values))
                    .with_instructions(values.instructions()),
            )
        },
    },
    Algorithm {
        name: "vtp-trimming",
        family: "vtp-family",
        paper: "Qin et al. 2016, section 6.2",
        exact: true,
        summary: "vtp with neighbours cut at their tie points",
        complexity: "time O(n^2), space O(n)",
        keeps: "the windows of the wavefront",
        choose: "to weigh trimming against pruning: some windows fewer, half as much time again",
        memory_counter: Counter::PeakWindows,
        comfortable_faces: None,
        parameters: &[THRESHOLD],
        build: |mesh, values| {
            Box::new(
                VtpTrimming::new(mesh)
                    .with_threshold(threshold_width(mesh, values))
                    .with_instructions(values.instructions()),
            )
        },
    },
    Algorithm {
        name: "vtp-no-rule1",
        family: "vtp-family",
        paper: "Qin et al. 2016, section 6.2",
        exact: true,
        summary: "vtp with every window tried on both exits",
        complexity: "time O(n^2), space O(n)",
        keeps: "the windows of the wavefront",
        choose: "to see what rule 1 does",
        memory_counter: Counter::PeakWindows,
        comfortable_faces: None,
        parameters: &[THRESHOLD],
        build: |mesh, values| {
            Box::new(
                VtpNoRule1::new(mesh)
                    .with_threshold(threshold_width(mesh, values))
                    .with_instructions(values.instructions()),
            )
        },
    },
    Algorithm {
        name: "vtp-no-rules23",
        family: "vtp-family",
        paper: "Qin et al. 2016, section 6.2",
        exact: true,
        summary: "vtp without comparing windows with each other",
        complexity: "time O(n^2), space O(n)",
        keeps: "the windows of the wavefront, half as many again as vtp",
        choose: "to see what rules 2 and 3 do",
        memory_counter: Counter::PeakWindows,
        comfortable_faces: None,
        parameters: &[THRESHOLD],
        build: |mesh, values| {
            Box::new(
                VtpNoRules23::new(mesh)
                    .with_threshold(threshold_width(mesh, values))
                    .with_instructions(values.instructions()),
            )
        },
    },
    Algorithm {
        name: "edge-based",
        family: "vtp-family",
        paper: "Qin et al. 2016, the report that came before it, chapter 5",
        exact: true,
        summary: "the earlier form of vtp",
        complexity: "time O(n^2), space O(n)",
        keeps: "the windows of the wavefront and one length for each half-edge",
        choose: "to repeat the report's comparison",
        memory_counter: Counter::PeakWindows,
        comfortable_faces: None,
        parameters: &[THRESHOLD],
        build: |mesh, values| {
            Box::new(
                EdgeBased::new(mesh)
                    .with_threshold(threshold_width(mesh, values))
                    .with_instructions(values.instructions()),
            )
        },
    },
];

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

pub(super) const FAST: &[Algorithm] = &[
    Algorithm {
        name: "vtp-fast",
        family: "vtp-family",
        paper: "Qin et al. 2016, with improvements of our own",
        exact: true,
        summary: "vtp with every improvement that keeps it exact",
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
        summary: "vtp-fast on several threads",
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
