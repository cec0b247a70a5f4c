//! The stored distances belong to the models of today.

use geobench_oracle::{distances, edge_graph_distances, reference, rounded, zoo};

#[test]
fn stored_distances_are_those_of_the_models() {
    for model in zoo::slow() {
        let fields = reference::read(&model).expect("make_reference writes every slow model");
        assert_eq!(fields.len(), reference::SOURCES, "{}", model.name);
        let surface = model.surface::<f64>();
        for (source, stored) in fields {
            // The oracle itself takes too long on the thin torus; the edges around a source are
            // enough to notice that a model has changed.
            let above = edge_graph_distances(&surface, &[source]);
            assert_eq!(stored.len(), model.vertex_count, "{}", model.name);
            for (&stored, &above) in stored.iter().zip(&above) {
                assert!(stored <= above * (1.0 + 1e-15), "{}", model.name);
            }
            if model.name.contains("20:1") {
                continue;
            }
            let found = rounded(&distances(&surface, &[source]));
            for (vertex, (found, stored)) in found.iter().zip(&stored).enumerate() {
                assert!(
                    (found - stored).abs() <= 1e-12 * stored,
                    "{}, from {source} to {vertex}: {found}, stored {stored}",
                    model.name
                );
            }
        }
    }
}
