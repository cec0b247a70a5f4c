//! Invariants that hold on every mesh.

use geobench_mesh::generate::generate;
use geobench_mesh::{Mesh, VertexId};
use geobench_oracle::nasty::Kind;
use geobench_oracle::{Model, edge_graph_distances, euclidean_distances, steiner_distances, zoo};
use geobench_window::{Counter, FrontWindow, Fronts, Goal, Observer, PhaseSampler};

use crate::support::{Failures, ROUNDING, caught, exact_runs, mesh_of};

/// Runs `check` on every small model of the zoo, and collects failures.
fn on_the_zoo(check: impl Fn(&Model, &mut Failures)) {
    let mut failures = Failures::default();
    for model in zoo::small() {
        let mut of_model = Failures::default();
        let _ = caught(&mut failures, || check(&model, &mut of_model));
        failures.extend(of_model);
    }
    failures.report();
}

/// Meshes on which windows that are narrower than rounding were cut, and vertices lost: the tip of
/// a cone whose faces shrink to 1e-18 of its size, and a grid beside a vertex that is 4.5e19 away.
#[test]
fn a_vertex_that_is_connected_to_a_source_has_a_distance() {
    let mut failures = Failures::default();
    for (kind, seed) in [(Kind::Graded, 12379), (Kind::FarVertex, 5166)] {
        let model = kind.mesh(seed).model;
        for mut run in exact_runs(&model.name, &mesh_of(&model)) {
            let found = run.distances(&model.sources);
            let lost = found.iter().filter(|d| d.is_infinite()).count();
            failures.unless(lost == 0, || {
                format!("{}: {lost} lost", run.at(&model.sources))
            });
        }
    }
    failures.report();
}

#[test]
fn distances_lie_between_their_bounds() {
    on_the_zoo(|model, failures| {
        let mesh = mesh_of(model);
        let surface = model.surface::<f64>();
        let source = model.sources[0];
        let over_edges = edge_graph_distances(&surface, &[source]);
        let over_steiner_points = steiner_distances(&surface, &[source], 4);
        let straight = model.positions().map(|p| euclidean_distances(p, &[source]));
        for mut run in exact_runs(&model.name, &mesh) {
            let found = run.distances(&[source]);
            let furthest = found
                .iter()
                .copied()
                .filter(|d| d.is_finite())
                .fold(0.0, f64::max);
            let slack = ROUNDING * furthest;
            for (v, &d) in found.iter().enumerate() {
                let above = over_edges[v].min(over_steiner_points[v]);
                failures.unless(d <= above + slack, || {
                    format!(
                        "{}: {d} to {v}, over edges or Steiner points {above}",
                        run.at(&[source])
                    )
                });
                let below = straight.as_ref().map_or(0.0, |s| s[v]);
                failures.unless(d >= below - slack, || {
                    format!("{}: {d} to {v}, through space {below}", run.at(&[source]))
                });
            }
            for h in mesh.half_edges() {
                let [a, b] = [mesh.tail(h), mesh.head(h)];
                let [at_a, at_b] = [a, b].map(|v| found[v.index()]);
                let same = at_a == at_b || (at_a - at_b).abs() <= mesh.length(h) + slack;
                failures.unless(same, || {
                    format!(
                        "{}: {at_a} at {a} and {at_b} at {b}, an edge apart",
                        run.at(&[source])
                    )
                });
            }
        }
    });
}

#[test]
fn a_solver_that_was_used_answers_as_a_fresh_one() {
    on_the_zoo(|model, failures| {
        let mesh = mesh_of(model);
        let mut used = exact_runs(&model.name, &mesh);
        for sources in [
            &model.sources[..1],
            &model.sources[..],
            &model.sources[1..2],
        ] {
            for (used, mut fresh) in used.iter_mut().zip(exact_runs(&model.name, &mesh)) {
                let (found, expected) = (used.distances(sources), fresh.distances(sources));
                let same = fresh.may_give(&found, &expected);
                failures.unless(same, || format!("{}: other bits", fresh.at(sources)));
            }
        }
    });
}

/// The windows that wait lie on edges of the mesh, and no vertex is farther than over them.
#[test]
fn wavefronts_lie_on_edges_at_true_distances() {
    on_the_zoo(|model, failures| {
        let mesh = mesh_of(model);
        let source = [model.sources[0]];
        let id = [VertexId::new(source[0])];
        for mut run in exact_runs(&model.name, &mesh) {
            let plain = run.distances(&source);
            let finite = plain.iter().copied().filter(|d| d.is_finite());
            let furthest = finite.fold(0.0, f64::max);
            let slack = ROUNDING * furthest;
            let mut fronts = Fronts::at([0.5 * furthest, 0.25 * furthest]);
            let solved = run
                .solver()
                .run(&id, &Goal::everything(), Observer::Fronts(&mut fronts));
            // The run ends with the last wavefront; what is not final then is infinite.
            let same = solved.is_ok_and(|solution| {
                let found = solution.distances.iter().zip(&plain);
                let found: Vec<f64> = found
                    .map(|(d, plain)| if d.is_finite() { *d } else { *plain })
                    .collect();
                run.may_give(&found, &plain)
            });
            failures.unless(same, || {
                format!("{}: other bits when observed", run.at(&source))
            });
            for front in fronts.found() {
                let (count, sum) = (front.windows.len(), |sum, w: &FrontWindow| sum + w.distance);
                let mean = front.windows.iter().fold(0.0, sum) / count as f64;
                let is_whole = front.record.windows == count as u64
                    && (mean - front.record.distance).abs() <= slack
                    && mean + slack >= front.at;
                failures.unless(is_whole, || {
                    format!("{}: {count} windows of {:?}", run.at(&source), front.record)
                });
                for window in &front.windows {
                    let [tail, head] = window.ends;
                    let length = mesh.neighbours(tail).find(|(v, _)| *v == head);
                    let fits = length.is_some_and(|(_, length)| {
                        let [from, to] = window.interval;
                        from >= 0.0
                            && from <= to
                            && to <= length + slack
                            && plain[tail.index()] <= window.distance + to + slack
                            && plain[head.index()] <= window.distance + length - from + slack
                    });
                    failures.unless(fits, || format!("{}: {window:?}", run.at(&source)));
                }
            }
        }
    });
}

#[test]
fn observation_changes_no_answer_and_counts_add_up() {
    on_the_zoo(|model, failures| {
        let mesh = mesh_of(model);
        let source = [model.sources[0]];
        let id = [VertexId::new(source[0])];
        for mut run in exact_runs(&model.name, &mesh) {
            let plain = run.distances(&source);
            let mut sampler = PhaseSampler::start().unwrap();
            let profiled =
                run.solver()
                    .run(&id, &Goal::everything(), Observer::Phases(&mut sampler));
            let (Ok((counted, counters)), Ok(profiled)) = (run.solver().count(&id), profiled)
            else {
                failures.unless(false, || format!("{}: refused", run.at(&source)));
                continue;
            };
            let same = run.may_give(&counted.distances, &plain)
                && run.may_give(&profiled.distances, &plain);
            failures.unless(same, || {
                format!("{}: other bits when observed", run.at(&source))
            });
            // What would be stored has been at one time only if nothing was given up.
            let keeps_all = run.selection.label().contains("lists=keep");
            let all_kept = keeps_all.then_some((Counter::StoredWindows, Counter::PeakWindows));
            // If an algorithm has both, each counter is at most the next one.
            for (small, large) in [
                (Counter::Kept, Counter::Children),
                (Counter::Children, Counter::Propagated),
                (Counter::PeakWavefront, Counter::PeakWindows),
                (Counter::Levels, Counter::Parents),
                (Counter::QueuePeak, Counter::QueuePushes),
                (Counter::Prime, Counter::Propagated),
                (Counter::Secondary, Counter::Propagated),
            ]
            .into_iter()
            .chain(all_kept)
            {
                if let (Some(a), Some(b)) = (counters.get(small), counters.get(large)) {
                    failures.unless(a <= b, || {
                        format!(
                            "{}: {} is {a}, {} is {b}",
                            run.at(&source),
                            small.key(),
                            large.key()
                        )
                    });
                }
            }
            let peak = counters.get(Counter::PeakWavefront);
            let sampled = counters.wavefront.iter().map(|s| s.windows).max();
            failures.unless(peak.is_none_or(|peak| sampled <= Some(peak)), || {
                format!(
                    "{}: {sampled:?} windows sampled, {peak:?} at most",
                    run.at(&source)
                )
            });
        }
    });
}

/// The entries of windows that had been trimmed away since were sampled: on the horse 22,000
/// windows of `mmp{turn=window}`, where 15,296 wait at most.
#[test]
fn samples_of_the_wavefront_hold_no_window_that_is_gone() {
    let spec = "gen:torus,faces=2000,bump=0.2,seed=1";
    let soup = generate(&spec.parse().unwrap_or_else(|e| panic!("{e}")));
    let (mesh, _) = soup
        .map_err(|error| error.to_string())
        .and_then(|soup| Mesh::from_soup(soup).map_err(|error| error.to_string()))
        .unwrap_or_else(|error| panic!("{spec}: {error}"));
    let mut failures = Failures::default();
    for mut run in exact_runs(spec, &mesh) {
        let Ok((_, counters)) = run.solver().count(&[VertexId::new(0)]) else {
            panic!("{}: refused", run.at(&[0]));
        };
        let Some(peak) = counters.get(Counter::PeakWavefront) else {
            continue;
        };
        let sampled = counters.wavefront.iter().map(|s| s.windows).max();
        // Some dozens of samples do not miss the peak by much.
        let near = sampled.is_none_or(|s| s <= peak && s as f64 >= 0.8 * peak as f64);
        failures.unless(near, || {
            format!("{}: {sampled:?} sampled, {peak} at most", run.at(&[0]))
        });
    }
    failures.report();
}

#[test]
fn a_source_that_does_not_exist_is_refused() {
    let model = zoo::octahedron();
    let mesh = mesh_of(&model);
    for mut run in exact_runs(&model.name, &mesh) {
        assert!(
            run.solver().solve(&[VertexId::new(6)]).is_err(),
            "{}",
            run.selection.label()
        );
        assert!(
            run.solver().solve(&[]).is_err(),
            "{}",
            run.selection.label()
        );
        assert_eq!(
            run.distances(&[0, 0]),
            run.distances(&[0]),
            "{}",
            run.selection.label()
        );
    }
}
