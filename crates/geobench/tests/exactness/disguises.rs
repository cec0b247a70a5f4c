//! Invariance: different meshes of the same surface have the same distances.

use geobench_oracle::{Model, Random, Transform, distances, rounded};
use geobench_registry::Algorithm;
use geobench_window::Counter;
use proptest::prelude::*;

use crate::support::{Failures, ROUNDING, Run, exact_runs, mesh_of};
use crate::surfaces::{config, solid_surface_and_vertices, surface_and_vertices};

/// Checks that every algorithm finds the same distances on `model` and on the changed model.
fn check(
    transform: Transform,
    model: &Model,
    source: u32,
    seed: u64,
    included: impl Fn(&Algorithm) -> bool,
) -> Result<(), TestCaseError> {
    let changed = transform.apply(model, &mut Random::new(seed));
    let (mesh, other) = (mesh_of(model), mesh_of(&changed.model));
    let mut failures = Failures::default();
    let runs = exact_runs(&model.name, &mesh);
    for (mut run, mut again) in pairs(runs, exact_runs(&changed.model.name, &other)) {
        if !included(run.selection.algorithm()) {
            continue;
        }
        let plain = run.distances(&[source]);
        let found = changed.restored(&again.distances(&changed.sources(&[source])));
        failures.compare_all(|| again.at(&[source]), &found, &plain, ROUNDING);
        if transform == Transform::Scale {
            failures.unless(run.may_give(&found, &plain), || {
                format!("{}: other bits", again.at(&[source]))
            });
        }
    }
    failures.result().map_err(TestCaseError::fail)
}

/// The runs of each algorithm that can finish both models.
fn pairs<'m>(runs: Vec<Run<'m>>, others: Vec<Run<'m>>) -> impl Iterator<Item = (Run<'m>, Run<'m>)> {
    let mut others = others;
    runs.into_iter().filter_map(move |run| {
        let same = |other: &Run<'_>| other.selection.label() == run.selection.label();
        let place = others.iter().position(same)?;
        Some((run, others.swap_remove(place)))
    })
}

/// Whether an algorithm stores windows and trims them against each other.
fn trims(algorithm: &Algorithm) -> bool {
    algorithm.memory_counter == Counter::StoredWindows
}

proptest! {
    #![proptest_config(config(512))]

    #[test]
    fn every_algorithm_matches_the_oracle((model, sources) in surface_and_vertices(2)) {
        let mesh = mesh_of(&model);
        let surface = model.surface::<f64>();
        let mut failures = Failures::default();
        for mut run in exact_runs(&model.name, &mesh) {
            for sources in [&sources[..1], &sources[..]] {
                let expected = rounded(&distances(&surface, sources));
                let found = run.distances(sources);
                failures.compare_all(|| run.at(sources), &found, &expected, ROUNDING);
            }
        }
        failures.result().map_err(TestCaseError::fail)?;
    }

    #[test]
    fn powers_of_two_scale_bit_for_bit(
        (model, sources) in surface_and_vertices(1),
        seed in any::<u64>(),
    ) {
        check(Transform::Scale, &model, sources[0], seed, |_| true)?;
    }

    #[test]
    fn other_units_change_nothing(
        (model, sources) in surface_and_vertices(1),
        factor in prop::sample::select(vec![1e-6, 1e6, 0.0254]),
    ) {
        let scaled = model.clone().scaled(factor);
        let (mesh, other) = (mesh_of(&model), mesh_of(&scaled));
        let mut failures = Failures::default();
        let runs = exact_runs(&model.name, &mesh).into_iter();
        for (mut run, mut again) in runs.zip(exact_runs(&scaled.name, &other)) {
            let expected: Vec<_> = run.distances(&sources).iter().map(|d| d * factor).collect();
            let found = again.distances(&sources);
            failures.compare_all(|| again.at(&sources), &found, &expected, ROUNDING);
        }
        failures.result().map_err(TestCaseError::fail)?;
    }

    #[test]
    fn rigid_motions_change_nothing(
        (model, sources) in surface_and_vertices(1),
        seed in any::<u64>(),
    ) {
        check(Transform::Rotate, &model, sources[0], seed, |_| true)?;
    }

    #[test]
    fn renumbering_changes_nothing(
        (model, sources) in surface_and_vertices(1),
        seed in any::<u64>(),
    ) {
        check(Transform::Renumber, &model, sources[0], seed, |_| true)?;
    }

    #[test]
    fn reversing_the_orientation_changes_nothing((model, sources) in surface_and_vertices(1)) {
        check(Transform::Reverse, &model, sources[0], 0, |_| true)?;
    }

    #[test]
    fn smaller_triangles_on_the_same_surface_change_nothing(
        (model, sources) in solid_surface_and_vertices(1),
        seed in any::<u64>(),
    ) {
        check(Transform::Refine, &model, sources[0], seed, |_| true)?;
    }

    // Subdivided faces of area 0 put several vertices in one place, at distance 0 from each other.
    // Trimming cannot always distinguish the windows of such vertices; see the crate geobench-mmp.
    #[test]
    fn vertices_in_one_place_change_nothing(
        (model, sources) in surface_and_vertices(1),
        seed in any::<u64>(),
    ) {
        check(Transform::Refine, &model, sources[0], seed, |a| !trims(a))?;
    }

    #[test]
    fn several_sources_give_the_smallest_of_their_distances(
        (model, sources) in surface_and_vertices(4),
    ) {
        let mesh = mesh_of(&model);
        let mut failures = Failures::default();
        for mut run in exact_runs(&model.name, &mesh) {
            let mut nearest = vec![f64::INFINITY; model.vertex_count];
            for &source in &sources {
                for (d, other) in nearest.iter_mut().zip(run.distances(&[source])) {
                    *d = d.min(other);
                }
            }
            let found = run.distances(&sources);
            failures.compare_all(|| run.at(&sources), &found, &nearest, ROUNDING);
        }
        failures.result().map_err(TestCaseError::fail)?;
    }

    #[test]
    fn distances_are_a_metric((model, points) in surface_and_vertices(4)) {
        let mesh = mesh_of(&model);
        for mut run in exact_runs(&model.name, &mesh) {
            let fields: Vec<_> = points.iter().map(|&p| run.distances(&[p])).collect();
            let d = |i: usize, j: usize| fields[i][points[j] as usize];
            for i in 0..points.len() {
                prop_assert_eq!(d(i, i), 0.0);
                for j in 0..points.len() {
                    let (there, back) = (d(i, j), d(j, i));
                    prop_assert!(
                        there == back || (there - back).abs() <= ROUNDING * back,
                        "{}: {there} to {}, {back} back", run.at(&points[i..=i]), points[j]
                    );
                    for k in 0..points.len() {
                        prop_assert!(
                            d(i, k) <= (d(i, j) + d(j, k)) * (1.0 + ROUNDING),
                            "{}: further to {} than over {}",
                            run.at(&points[i..=i]), points[k], points[j]
                        );
                    }
                }
            }
        }
    }
}
