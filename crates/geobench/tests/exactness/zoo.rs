//! The zoo: small surfaces with features that break geodesic programs, compared with the oracle.

use geobench_oracle::{Model, distances, reference, rounded, zoo};

use crate::support::{Failures, ROUNDING, caught, exact_runs, mesh_of};

/// Models come in units of micrometres and of kilometres.
const SCALES: [f64; 3] = [1.0, 1e-6, 1e6];

fn check(model: &Model, expected: &[(u32, Vec<f64>)], failures: &mut Failures) {
    let mesh = mesh_of(model);
    for mut run in exact_runs(&model.name, &mesh) {
        for (source, expected) in expected {
            let Some(found) = caught(failures, || run.distances(&[*source])) else {
                continue;
            };
            failures.compare_all(|| run.at(&[*source]), &found, expected, ROUNDING);
        }
    }
}

#[test]
fn small_models_match_the_oracle_at_every_scale() {
    let mut failures = Failures::default();
    for model in zoo::small() {
        for scale in SCALES {
            let model = model.clone().scaled(scale);
            let surface = model.surface::<f64>();
            let solve = |&source: &u32| (source, rounded(&distances(&surface, &[source])));
            let expected: Vec<_> = model.sources.iter().map(solve).collect();
            let mut of_model = Failures::default();
            let _ = caught(&mut failures, || check(&model, &expected, &mut of_model));
            failures.extend(of_model);
        }
    }
    failures.report();
}

#[test]
fn slow_models_match_the_stored_distances_at_every_scale() {
    let mut failures = Failures::default();
    for model in zoo::slow() {
        let stored = reference::read(&model).expect("distances are stored for every slow model");
        for scale in SCALES {
            let in_scale = |(source, field): &(u32, Vec<f64>)| {
                (*source, field.iter().map(|d| d * scale).collect())
            };
            let expected: Vec<_> = stored.iter().map(in_scale).collect();
            let mut of_model = Failures::default();
            let scaled = model.clone().scaled(scale);
            let _ = caught(&mut failures, || check(&scaled, &expected, &mut of_model));
            failures.extend(of_model);
        }
    }
    failures.report();
}
