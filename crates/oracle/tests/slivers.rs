//! The oracle against an independent program, on meshes with slivers, flat faces and needle tips.

use std::io::{self, Write};

use geobench_oracle::{DoubleDouble, Model, Search, rounded, search};

#[path = "../examples/fuzz/slivers.rs"]
mod slivers;

#[test]
fn the_oracle_is_right_on_every_sliver() {
    let Ok(slivers) = slivers::read() else {
        // Written past the capture of test output, which would hide it.
        let _ = writeln!(
            io::stderr(),
            "SKIPPED: {} is missing",
            slivers::path().display()
        );
        return;
    };
    let mut failures = Vec::new();
    for sliver in slivers {
        let model = Model::new(&sliver.name, sliver.vertices, sliver.faces);
        let surface = model.surface::<DoubleDouble>();
        for plan in [
            Search::pruned(1_000_000),
            Search::pruned(1_000_000).from_everywhere(),
        ] {
            let Ok(found) = search(&surface, &sliver.source, plan) else {
                failures.push(format!("{}, {plan:?}: gave up", sliver.name));
                continue;
            };
            let furthest = sliver
                .distances
                .iter()
                .flatten()
                .copied()
                .fold(0.0, f64::max);
            for (v, (found, expected)) in rounded(&found).iter().zip(&sliver.distances).enumerate()
            {
                let expected = expected.unwrap_or(f64::INFINITY);
                let same = *found == expected
                    || (found - expected).abs() <= (1e-12 * expected).max(1e-26 * furthest);
                if !same {
                    failures.push(format!(
                        "{}, {plan:?}, vertex {v}: {found:?} instead of {expected:?}",
                        sliver.name
                    ));
                }
            }
        }
    }
    assert!(
        failures.is_empty(),
        "{} failures:\n{}",
        failures.len(),
        failures.join("\n")
    );
}
