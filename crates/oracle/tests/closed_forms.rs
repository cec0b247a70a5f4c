//! The oracle against formulas, in both precisions.

use geobench_oracle::closed_forms::{self, ClosedForm};
use geobench_oracle::{
    DoubleDouble, RealNumber, distances, edge_graph_distances, euclidean_distances, rounded,
    steiner_distances,
};

/// Compares the oracle with the formula from every source of a case.
fn check<S: RealNumber>(case: &ClosedForm, tolerance: f64) {
    let surface = case.model.surface::<S>();
    for &source in &case.model.sources {
        let found = rounded(&distances(&surface, &[source]));
        // Two vertices may lie in the same place, joined by faces of no area: distance 0.
        let furthest = found.iter().copied().fold(0.0, f64::max);
        for (vertex, &found) in found.iter().enumerate() {
            let Some(expected) = case.distance(source, vertex as u32) else {
                continue;
            };
            assert!(
                (found - expected).abs() <= (tolerance * expected).max(1e-16 * furthest),
                "{}, from {source} to {vertex}: {found} instead of {expected}",
                case.model.name
            );
        }
    }
}

#[test]
fn in_f64() {
    for case in closed_forms::all() {
        check::<f64>(&case, 1e-13);
    }
}

#[test]
fn in_double_double() {
    for case in closed_forms::all() {
        if case.model.vertex_count < 60 {
            check::<DoubleDouble>(&case, 1e-14);
        }
    }
}

#[test]
fn double_doubles_are_exact_to_thirty_digits() {
    let octahedron = geobench_oracle::zoo::octahedron();
    let found = distances(&octahedron.surface::<DoubleDouble>(), &[0]);
    let opposite = found[1].expect("the octahedron is connected");
    let error = opposite * opposite - DoubleDouble::new(6.0);
    assert!(error.high().abs() < 1e-29, "{opposite:?}");
}

#[test]
fn bounds_enclose_the_distance() {
    for case in closed_forms::all() {
        let Some(positions) = case.model.positions() else {
            continue;
        };
        let surface = case.model.surface::<f64>();
        let source = case.model.sources[0];
        let below = euclidean_distances(positions, &[source]);
        let edges = edge_graph_distances(&surface, &[source]);
        let above = steiner_distances(&surface, &[source], 8);
        let furthest = above.iter().copied().fold(0.0, f64::max);
        for vertex in 0..positions.len() {
            let Some(expected) = case.distance(source, vertex as u32) else {
                continue;
            };
            let slack = 1e-14 * furthest;
            assert!(below[vertex] <= expected + slack, "{}", case.model.name);
            assert!(above[vertex] >= expected - slack, "{}", case.model.name);
            assert!(
                above[vertex] <= edges[vertex] + slack,
                "{}",
                case.model.name
            );
            assert!(
                above[vertex] <= expected * 1.02 + 0.05 * furthest,
                "{}",
                case.model.name
            );
        }
    }
}
