//! The stored distances belong to the current models.

use geobench_oracle::{distances, edge_graph_distances, reference, rounded, zoo};

#[test]
fn stored_distances_are_those_of_the_models() {
    for model in zoo::slow() {
        let fields = reference::read(&model).expect("make_reference writes every slow model");
        assert_eq!(fields.len(), reference::SOURCES, "{}", model.name);
        let surface = model.surface::<f64>();
        for (source, stored) in fields {
            // The oracle takes too long on the thin torus. The edges around a source suffice to
            // notice a changed model.
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
