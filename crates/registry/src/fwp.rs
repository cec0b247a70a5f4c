//! Algorithms that take windows, or lists of them, in an order cheaper than a priority queue.

use geobench_fwp::{
    BatchSize, BucketOptions, LabelCorrectingOptions, fwp_ch, fwp_mmp, fwp_mmp_batched, lc_ch,
    lc_mmp, lc_mmp_batched, vtp_ch,
};
use geobench_window::Counter;

use super::mmp::{FILTER, LISTS, TURN, VERTEX_ORDER, batched, is_batched, stored};
use super::parameter::THRESHOLD;
use super::{Algorithm, Parameter, Value, Values, single};

const BUCKET: Parameter = Parameter::real(
    "bucket",
    1.0,
    1e-3..=1e6,
    "width of a bucket as a multiple of h/sqrt(n), for mean edge length h and n vertices",
);

const K: Parameter = Parameter::integer(
    "k",
    1,
    1..=1_000_000_000,
    "least number of windows per round; `adaptive` follows the wavefront",
)
.or_words(&["adaptive"])
.with_default(Value::Word("adaptive"));

const K_MAX: Parameter = Parameter::integer(
    "kmax",
    20_000,
    1..=1_000_000_000,
    "the largest value of an adaptive k",
);

const BETA: Parameter = Parameter::real(
    "beta",
    0.5,
    0.01..=1e6,
    "threshold between the least waiting distance (0) and their mean (1); `none` lets all pass",
)
.or_words(&["none"]);

const BUCKET_PARAMETERS: &[Parameter] = &[BUCKET, K, K_MAX, THRESHOLD];

const BUCKET_AND_LIST_PARAMETERS: &[Parameter] =
    &[BUCKET, K, K_MAX, TURN, FILTER, LISTS, THRESHOLD];

/// The options of the buckets.
fn buckets(values: &Values) -> BucketOptions {
    // The ranges above are within 32 bits.
    let size = |n| u32::try_from(n).unwrap_or(u32::MAX);
    let batch = match values.integer_or_word(&K) {
        Some(k) => BatchSize::Fixed(size(k)),
        None => BatchSize::Adaptive {
            max: size(values.integer(&K_MAX)),
        },
    };
    BucketOptions {
        width: values.real(&BUCKET),
        batch,
    }
}

fn label_correcting(values: &Values) -> LabelCorrectingOptions {
    LabelCorrectingOptions {
        beta: values.real_or_word(&BETA).unwrap_or(f64::INFINITY),
    }
}

pub(crate) const FAMILY: &[Algorithm] = &[
    Algorithm {
        name: "fwp-mmp",
        family: "fwp-family",
        queue: "buckets",
        paper: "Xu et al. 2015, section 4",
        summary: "mmp in buckets, some thousands of windows a round",
        departs: "as mmp; K counts the children of one round (algorithm 1 never resets the counts)",
        complexity: "time O(n^2 log n), space O(n^2)",
        keeps: "as mmp; in the queue 24 bytes per waiting window or list and 12 per bucket that the wavefront spans",
        choose: "to compare buckets with the priority queue of mmp, on nearly the same windows",
        memory_counter: Counter::StoredWindows,
        parameters: BUCKET_AND_LIST_PARAMETERS,
        crosses_junctions: true,
        build: |mesh, values| {
            if is_batched(values) {
                batched(fwp_mmp_batched(mesh, buckets(values)), mesh, values)
            } else {
                stored(fwp_mmp(mesh, buckets(values)), mesh, values)
            }
        },
        ..Algorithm::EXACT
    },
    Algorithm {
        name: "fwp-ch",
        family: "fwp-family",
        queue: "buckets",
        paper: "Xu et al. 2015, section 4; Xin, Wang 2009, section 3.2",
        summary: "ich in buckets, some thousands of windows a round",
        departs: "as ich; K counts the children of one round (algorithm 1 never resets the counts)",
        keeps: "the windows in the buckets and one record for each angle",
        choose: "instead of ich: the same windows in less time",
        parameters: BUCKET_PARAMETERS,
        crosses_junctions: true,
        build: |mesh, values| single(fwp_ch(mesh, buckets(values)), mesh, values),
        ..Algorithm::EXACT
    },
    Algorithm {
        name: "lc-mmp",
        family: "lc-family",
        queue: "label-correcting",
        paper: "Bertsekas 1993; Xu et al. 2015, section 7.4",
        summary: "mmp in a label correcting queue",
        departs: "as mmp; the papers print neither beta nor how the threshold follows the distances, so that both are ours; large label last rotates at most once",
        complexity: "time without a useful bound, space O(n^2)",
        keeps: "as mmp; in the queue 16 bytes per waiting window or list",
        choose: "to compare with fwp-mmp",
        memory_counter: Counter::StoredWindows,
        parameters: &[BETA, TURN, FILTER, LISTS, THRESHOLD],
        crosses_junctions: true,
        build: |mesh, values| {
            if is_batched(values) {
                batched(lc_mmp_batched(mesh, label_correcting(values)), mesh, values)
            } else {
                stored(lc_mmp(mesh, label_correcting(values)), mesh, values)
            }
        },
        ..Algorithm::EXACT
    },
    Algorithm {
        name: "lc-ch",
        family: "lc-family",
        queue: "label-correcting",
        paper: "Bertsekas 1993; Xu et al. 2015, section 7.4; Xin, Wang 2009, section 3.2",
        summary: "ich in a label correcting queue",
        departs: "as ich; beta, threshold and rotation as in lc-mmp",
        complexity: "time and space without a useful bound; in practice the waiting windows",
        keeps: "the windows in the queue and one record for each angle",
        choose: "to compare with fwp-ch",
        parameters: &[BETA, THRESHOLD],
        crosses_junctions: true,
        build: |mesh, values| single(lc_ch(mesh, label_correcting(values)), mesh, values),
        ..Algorithm::EXACT
    },
    VERTEX_ORDER,
    Algorithm {
        name: "vtp-ch",
        family: "vtp-family",
        paper: "Qin et al. 2016, section 6.2; Xin, Wang 2009, section 3.2",
        summary: "ich in the order of vtp",
        departs: "as ich",
        keeps: "the windows of the wavefront and one record for each angle",
        choose: "to separate the effect of VTP's order from that of its rules",
        crosses_junctions: true,
        build: |mesh, values| single(vtp_ch(mesh), mesh, values),
        ..Algorithm::EXACT
    },
];
