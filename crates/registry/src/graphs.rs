//! Approximate algorithms based on windows: graphs of direct geodesics, and windows replaced by
//! vertices within an error bound.

use geobench_approx::{SaddleVertexGraph, SvgBuilder, SvgOptions, avtp, mmp_approx_from};

use super::parameter::{QUEUE, THREADS, with_queue};
use super::{Algorithm, Parameter, Value, Values, single};

const K: Parameter = Parameter::integer(
    "k",
    50,
    1..=1_000_000,
    "number of nearest vertices to which set-up finds direct geodesics; `inf` finds all and is exact, and set-up then takes up to a whole solve per vertex",
)
.or_words(&["inf"]);

const BUILD: Parameter = Parameter::word(
    "build",
    &["ich-fast", "ich", "fwp-mmp"],
    "the algorithm that finds direct geodesics; the papers use `ich` and `fwp-mmp`; the graph is the same up to ties",
);

const EPS: Parameter = Parameter::real(
    "eps",
    0.01,
    0.0..=1000.0,
    "greatest relative error: a distance is at most 1 + eps times the exact one, never less; 0 is exact",
);

fn svg_options(values: &Values) -> SvgOptions {
    SvgOptions {
        k: values.integer_or_word(&K).map(|k| k as usize),
        builder: match values.word(&BUILD) {
            Some("ich") => SvgBuilder::Ich,
            Some("fwp-mmp") => SvgBuilder::FwpMmp,
            _ => SvgBuilder::IchFast,
        },
        threads: values.threads(),
    }
}

pub(crate) const FAMILY: &[Algorithm] = &[
    Algorithm {
        name: "svg",
        queue: "buckets",
        paper: "Ying, Wang, He 2013; Xu et al. 2015, section 5",
        summary: "Dijkstra's algorithm on a graph of direct geodesics that set-up has found",
        departs: "each edge stands at both of its ends, and the edges of the mesh are in the graph; all vertices relay unless k is inf; set-up by ich-fast (build)",
        complexity: "set-up: one run of a window algorithm around each vertex, until k vertices are final; query O(k n) for n vertices, a few of which are taken twice; space O(k n)",
        keeps: "the graph, 12 bytes for each end of an edge, about k per vertex",
        choose: "for many sources on one mesh, where errors of some tenths of a percent do not matter",
        parameters: &[K, BUILD, THREADS],
        error_bound: |values| (values.get(&K) == Value::Word("inf")).then_some(0.0),
        build: |mesh, values| Box::new(SaddleVertexGraph::new(mesh, svg_options(values))),
        ..Algorithm::APPROXIMATE
    },
    Algorithm {
        name: "mmp-approx",
        paper: "Surazhsky et al. 2005, section 4, with a bound of our own",
        summary: "mmp with windows replaced by vertices, within a proven error",
        departs: "replaces windows by pseudo-sources at vertices where the paper merges neighbours, which leaves gaps and no bound",
        complexity: "time without a proven bound, space O(n^2)",
        keeps: "the windows around the wavefront",
        choose: "to measure how many windows an error of eps saves",
        crossing: "single",
        parameters: &[EPS, QUEUE],
        error_bound: |values| Some(values.real(&EPS)),
        build: |mesh, values| {
            with_queue!(&QUEUE, mesh, values, |queue| {
                Box::new(mmp_approx_from(mesh, values.real(&EPS), queue))
            })
        },
        ..Algorithm::APPROXIMATE
    },
    Algorithm {
        name: "avtp",
        paper: "Qin et al. 2016, section 6.2 (vtp-ch), with a bound of our own",
        summary: "vtp-ch with windows replaced by vertices, within a proven error",
        departs: "windows are filtered as in vtp-ch, not compared as in vtp; as mmp-approx",
        complexity: "time without a proven bound; space O(n^2), in practice the waiting windows and O(n) records",
        keeps: "the windows of the wavefront and one record for each angle",
        choose: "as mmp-approx, with less memory",
        crossing: "single",
        parameters: &[EPS],
        error_bound: |values| Some(values.real(&EPS)),
        build: |mesh, values| single(avtp(mesh, values.real(&EPS)), mesh, values),
        ..Algorithm::APPROXIMATE
    },
];
