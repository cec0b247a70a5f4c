//! Algorithms that split and filter windows and store none.

use geobench_ich::{Pch, ch, ich_fast, ich_from, ich1};

use super::parameter::{QUEUE, SIMD, THREADS, THRESHOLD, with_queue};
use super::{Algorithm, Parameter, single};

const BUCKET: Parameter = Parameter::real(
    "bucket",
    Pch::BUCKET,
    0.001..=1e6,
    "width of a bucket in mean edge lengths; 1e6 takes all waiting windows, level by level",
);

pub(crate) const FAMILY: &[Algorithm] = &[
    Algorithm {
        name: "ch",
        family: "ch-family",
        queue: "fifo",
        paper: "Chen, Han 1990; Xin, Wang 2009, sections 2 and 3.1",
        summary: "sequence tree, level by level, one angle one split, no filter",
        departs: "keeps and trims windows beside thin faces and at junctions; drops no narrow ones",
        complexity: "time O(n^2), space O(n)",
        keeps: "one level of the tree and one record for each angle",
        choose: "to study the origin of the other CH kinds, on models of up to about 10,000 faces",
        comfortable_faces: Some(10_000),
        crosses_junctions: true,
        build: |mesh, values| single(ch(mesh), mesh, values),
        ..Algorithm::EXACT
    },
    Algorithm {
        name: "ich1",
        family: "ch-family",
        queue: "fifo",
        paper: "Xin, Wang 2009, section 3.2",
        summary: "ch with windows filtered by vertex distances",
        departs: "as ich",
        complexity: "time O(n^2), space O(n)",
        keeps: "the windows in the queue and one record for each angle",
        choose: "to see the effect of the filter without a priority queue",
        crosses_junctions: true,
        build: |mesh, values| single(ich1(mesh), mesh, values),
        ..Algorithm::EXACT
    },
    Algorithm {
        name: "ich",
        family: "ch-family",
        paper: "Xin, Wang 2009, sections 3.2 and 3.3; Chen, Han 1990",
        summary: "ich1 with the nearest windows first",
        departs: "the margin of the filter is relative, so that rounding never deletes one of two equal paths; keeps and trims windows beside thin faces and at junctions; drops no narrow windows",
        complexity: "time O(n^2 log n), space O(n^2)",
        keeps: "the windows in the queue and one record for each angle",
        choose: "to compare with published figures of ICH; ich-fast takes the same windows in half the time",
        parameters: &[QUEUE, THRESHOLD],
        crosses_junctions: true,
        build: |mesh, values| {
            with_queue!(&QUEUE, mesh, values, |queue| {
                single(ich_from(mesh, queue), mesh, values)
            })
        },
        ..Algorithm::EXACT
    },
    Algorithm {
        name: "pch",
        family: "ch-family",
        queue: "buckets",
        paper: "Ying, Xin, He 2014; Xu et al. 2015, section 7.3",
        summary: "ich in rounds of windows that cross at once, on several threads",
        departs: "runs on the threads of the processor; takes all windows of a bucket where the paper selects the k nearest; as ich",
        complexity: "time without a proven bound: none is known on the windows of a round; space proportional to the waiting windows",
        keeps: "the windows of the wavefront and one record for each angle",
        choose: "to compare pvtp with the parallel algorithm of the papers",
        parameters: &[THREADS, BUCKET],
        crosses_junctions: true,
        build: |mesh, values| {
            let bucket = values.real(&BUCKET);
            Box::new(Pch::with_bucket(mesh, values.threads(), bucket))
        },
        ..Algorithm::EXACT
    },
];

pub(crate) const FAST: &[Algorithm] = &[Algorithm {
    name: "ich-fast",
    fast: true,
    family: "ch-family",
    paper: "Xin, Wang 2009, with improvements of our own",
    summary: "ich with every improvement of time",
    departs: "a calendar queue in place of a heap; windows cross eight at a time, by vector instructions; the same windows in the same order as ich",
    complexity: "time O(n^2 log n), space O(n^2)",
    queue: "calendar",
    crossing: "joint",
    keeps: "the windows in the queue and one record for each angle",
    choose: "to measure what queue and vector code save without any change of the windows",
    parameters: &[SIMD, THRESHOLD],
    crosses_junctions: true,
    build: |mesh, values| single(ich_fast(mesh), mesh, values),
    ..Algorithm::EXACT
}];
