//! Algorithms that take windows, or lists of them, in an order that costs less than a priority
//! queue.

use geobench_fwp::{
    BatchSize, BucketOptions, LabelCorrectingOptions, fwp_ch, fwp_mmp, fwp_mmp_by_window, lc_ch,
    lc_mmp, lc_mmp_by_window, vtp_ch, vtp_mmp,
};
use geobench_window::Counter;

use super::mmp::{FILTER, LIST_FILTER, LISTS, filter, keep};
use super::parameter::{THRESHOLD, threshold_width};
use super::{Algorithm, Parameter, Value, Values};

const BUCKET: Parameter = Parameter::real(
    "bucket",
    1.0,
    1e-3..=1e6,
    "width of a bucket as a multiple of h/sqrt(n), for h the mean edge length and n the vertices",
);

const K: Parameter = Parameter::integer(
    "k",
    1,
    1..=1_000_000_000,
    "least number of windows for each round; `adaptive` lets it follow the wavefront",
)
.or_words(&["adaptive"])
.with_default(Value::Word("adaptive"));

const K_MAX: Parameter = Parameter::integer(
    "kmax",
    20_000,
    1..=1_000_000_000,
    "the most that an adaptive k grows to",
);

const BETA: Parameter = Parameter::real(
    "beta",
    0.5,
    0.01..=1e6,
    "threshold between the least waiting distance (0) and their mean (1); `none` lets all pass",
)
.or_words(&["none"]);

const BUCKET_PARAMETERS: &[Parameter] = &[BUCKET, K, K_MAX, THRESHOLD];

/// What is propagated at once.
const TURN: Parameter = Parameter::word(
    "turn",
    &["list", "window"],
    "`list` takes the windows of a half-edge together, as far as the queue does not part them; `window` one at a time",
);

const BUCKET_AND_LIST_PARAMETERS: &[Parameter] =
    &[BUCKET, K, K_MAX, TURN, LIST_FILTER, LISTS, THRESHOLD];

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

pub(super) const FAMILY: &[Algorithm] = &[
    Algorithm {
        name: "fwp-mmp",
        family: "fwp-family",
        paper: "Xu et al. 2015, section 4",
        summary: "mmp in buckets, some thousands of windows a round",
        complexity: "time O(n^2 log n), space O(n^2)",
        keeps: "as mmp; of the queue the windows that wait and the buckets they span",
        choose: "to see what buckets gain over the queue of mmp, with nearly the same windows; with turn=window its rounds are those of the paper",
        memory_counter: Counter::StoredWindows,
        parameters: BUCKET_AND_LIST_PARAMETERS,
        build: |mesh, values| {
            let threshold = threshold_width(mesh, values);
            if values.word(&TURN) == Some("window") {
                let solver = fwp_mmp_by_window(mesh, buckets(values));
                let solver = solver.map_policy(|policy| policy.keeping(keep(values)));
                return Box::new(solver.with_threshold(threshold));
            }
            let solver = fwp_mmp(mesh, buckets(values));
            let solver = solver.filtering(filter(values)).keeping(keep(values));
            Box::new(solver.with_threshold(threshold))
        },
        ..Algorithm::EXACT
    },
    Algorithm {
        name: "fwp-ch",
        family: "fwp-family",
        paper: "Xu et al. 2015, section 4; Xin, Wang 2009, section 3.2",
        summary: "ich in buckets, some thousands of windows a round",
        keeps: "the windows in the buckets and one record for each angle",
        choose: "instead of ich: the same windows in less time",
        parameters: BUCKET_PARAMETERS,
        build: |mesh, values| {
            Box::new(fwp_ch(mesh, buckets(values)).with_threshold(threshold_width(mesh, values)))
        },
        ..Algorithm::EXACT
    },
    Algorithm {
        name: "lc-mmp",
        family: "lc-family",
        paper: "Bertsekas 1993; Xu et al. 2015, section 7.4",
        summary: "mmp in a label correcting queue",
        complexity: "time without a useful bound, space O(n^2)",
        keeps: "as mmp",
        choose: "to compare with fwp-mmp",
        memory_counter: Counter::StoredWindows,
        parameters: &[BETA, TURN, LIST_FILTER, LISTS, THRESHOLD],
        build: |mesh, values| {
            let threshold = threshold_width(mesh, values);
            if values.word(&TURN) == Some("window") {
                let solver = lc_mmp_by_window(mesh, label_correcting(values));
                let solver = solver.map_policy(|policy| policy.keeping(keep(values)));
                return Box::new(solver.with_threshold(threshold));
            }
            let solver = lc_mmp(mesh, label_correcting(values));
            let solver = solver.filtering(filter(values)).keeping(keep(values));
            Box::new(solver.with_threshold(threshold))
        },
        ..Algorithm::EXACT
    },
    Algorithm {
        name: "lc-ch",
        family: "lc-family",
        paper: "Bertsekas 1993; Xu et al. 2015, section 7.4; Xin, Wang 2009, section 3.2",
        summary: "ich in a label correcting queue",
        complexity: "time without a useful bound, space O(n)",
        keeps: "the windows in the queue and one record for each angle",
        choose: "to compare with fwp-ch",
        parameters: &[BETA, THRESHOLD],
        build: |mesh, values| {
            Box::new(
                lc_ch(mesh, label_correcting(values)).with_threshold(threshold_width(mesh, values)),
            )
        },
        ..Algorithm::EXACT
    },
    Algorithm {
        name: "vtp-mmp",
        family: "vtp-family",
        paper: "Qin et al. 2016, section 6.2",
        summary: "mmp in the order of vtp",
        complexity: "time O(n^2 log n), space O(n^2)",
        keeps: "as mmp; of the queue the vertices of the wavefront",
        choose: "to tell what vtp owes to its order from what it owes to its rules",
        memory_counter: Counter::StoredWindows,
        parameters: &[FILTER, LISTS, THRESHOLD],
        build: |mesh, values| {
            let solver = vtp_mmp(mesh)
                .filtering(filter(values))
                .keeping(keep(values));
            Box::new(solver.with_threshold(threshold_width(mesh, values)))
        },
        ..Algorithm::EXACT
    },
    Algorithm {
        name: "vtp-ch",
        family: "vtp-family",
        paper: "Qin et al. 2016, section 6.2; Xin, Wang 2009, section 3.2",
        summary: "ich in the order of vtp",
        keeps: "the windows of the wavefront and one record for each angle",
        choose: "to tell what vtp owes to its order from what it owes to its rules",
        build: |mesh, values| Box::new(vtp_ch(mesh).with_threshold(threshold_width(mesh, values))),
        ..Algorithm::EXACT
    },
];
