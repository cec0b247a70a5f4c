//! The models of the zoo have the properties that they claim, and both precisions agree on them.

use std::collections::HashSet;

use geobench_oracle::{DoubleDouble, Model, PreciseSurface, RealNumber, distances, rounded, zoo};

fn from<S: RealNumber>(surface: &PreciseSurface<S>, source: u32) -> Vec<f64> {
    rounded(&distances(surface, &[source]))
}

#[test]
fn both_precisions_agree() {
    for model in zoo::small() {
        let (single, double) = (model.surface::<f64>(), model.surface::<DoubleDouble>());
        for &source in &model.sources {
            let (found, exact) = (from(&single, source), from(&double, source));
            for (vertex, (found, exact)) in found.into_iter().zip(exact).enumerate() {
                assert!(
                    found == exact || (found - exact).abs() <= 1e-12 * exact,
                    "{}, from {source} to {vertex}: {found} in f64, {exact} in double-double",
                    model.name
                );
            }
        }
    }
}

#[test]
fn names_are_distinct_and_sources_exist() {
    let all: Vec<Model> = zoo::small().into_iter().chain(zoo::slow()).collect();
    let names: HashSet<_> = all.iter().map(|model| &model.name).collect();
    assert_eq!(names.len(), all.len());
    for model in &all {
        assert!(
            model.sources.len() >= model.vertex_count.min(5),
            "{}",
            model.name
        );
        let count = model.vertex_count as u32;
        assert!(model.sources.iter().all(|&s| s < count), "{}", model.name);
        assert!(
            model.triangles.as_flattened().iter().all(|&v| v < count),
            "{}",
            model.name
        );
    }
}

#[test]
fn a_path_passes_a_pinch_from_one_fan_into_another() {
    let solid = zoo::disphenoid([2.0, 3.0, 4.0]);
    let joined = zoo::pinched(&solid, 0, &solid, 3);
    let surface = joined.surface::<f64>();
    assert!(surface.bends_at(0) && !surface.bends_at(1));
    let edge = 13.0_f64.sqrt();
    // Vertex 4 is vertex 0 of the second solid, an edge of the same length as 0-1 and 3-2 away.
    let found = from(&surface, 1);
    let across = [4, 5, 6].map(|v| found[v] - edge);
    let mut lengths = [13.0, 20.0, 25.0].map(f64::sqrt);
    lengths.reverse();
    for (found, expected) in across.iter().zip(lengths) {
        assert!((found - expected).abs() < 1e-14, "{across:?}");
    }
}

#[test]
fn other_components_are_not_reached() {
    let model = zoo::with_isolated_vertices(&zoo::octahedron(), &[3]);
    let found = from(&model.surface::<f64>(), 0);
    assert_eq!(found.iter().filter(|d| d.is_infinite()).count(), 2);
    let found = from(&model.surface::<f64>(), 3);
    assert_eq!(found[3], 0.0);
    assert_eq!(found.iter().filter(|d| d.is_infinite()).count(), 7);
}
