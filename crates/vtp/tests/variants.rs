//! Every algorithm of the family against MMP on surfaces full of ties, and its counts.

use std::panic::{AssertUnwindSafe, catch_unwind};

use geobench_mesh::generate::generate;
use geobench_mesh::{Mesh, TriangleSoup, VertexId};
use geobench_mmp::mmp;
use geobench_oracle::zoo;
use geobench_vtp::{
    EdgeBased, FastOptions, Ftp, Opftp, Opvtp, Pvtp, Vtp, VtpExhaustive, VtpFast, VtpNoRule1,
    VtpNoRules23, VtpTrimming,
};
use geobench_window::simd::Instructions;
use geobench_window::{Counter, Counters, Goal, Phase, Probe, Propagate, Solver};

fn family(mesh: &Mesh) -> [(&'static str, Box<dyn Solver>); 9] {
    family_with(mesh, Instructions::detect())
}

fn family_with(mesh: &Mesh, instructions: Instructions) -> [(&'static str, Box<dyn Solver>); 9] {
    macro_rules! solver {
        ($algorithm:ident) => {
            Box::new($algorithm::new(mesh).with_instructions(instructions))
        };
    }
    [
        ("vtp", solver!(Vtp)),
        ("opvtp", solver!(Opvtp)),
        ("ftp", solver!(Ftp)),
        ("opftp", solver!(Opftp)),
        ("vtp-exhaustive", solver!(VtpExhaustive)),
        ("vtp-trimming", solver!(VtpTrimming)),
        ("vtp-no-rule1", solver!(VtpNoRule1)),
        ("vtp-no-rules23", solver!(VtpNoRules23)),
        ("edge-based", solver!(EdgeBased)),
    ]
}

fn scaled(mut soup: TriangleSoup, scale: f64) -> Mesh {
    for position in &mut soup.positions {
        *position = position.map(|x| x * scale);
    }
    Mesh::from_soup(soup).unwrap().0
}

fn soup_of(spec: &str) -> TriangleSoup {
    generate(&spec.parse().unwrap()).unwrap()
}

/// Compares the whole family with MMP from `count` sources spread over the mesh.
fn check(name: &str, mesh: &Mesh, count: usize) {
    let mut reference = mmp(mesh);
    let mut family: Vec<_> = all(mesh).collect();
    for i in 0..count {
        let source = VertexId::new((i * mesh.vertex_count() / count) as u32);
        let expected = reference.solve(&[source]).unwrap().distances;
        for (algorithm, solver) in &mut family {
            let found = solver.solve(&[source]).unwrap().distances;
            for (v, (d, e)) in found.iter().zip(&expected).enumerate() {
                assert!(
                    d == e || (d - e).abs() <= 1e-12 * e,
                    "{name}, {algorithm} from {source:?}: vertex {v} at {d} instead of {e}"
                );
            }
        }
    }
}

/// Every variant.
fn all(mesh: &Mesh) -> impl Iterator<Item = (&'static str, Box<dyn Solver>)> {
    let family = family(mesh).into_iter().chain(fast(mesh));
    family.chain(parallel(mesh))
}

/// VTP for speed, with all sets of instructions and with each improvement switched off.
fn fast(mesh: &Mesh) -> Vec<(&'static str, Box<dyn Solver>)> {
    let all = FastOptions::default();
    let with = |instructions| FastOptions {
        instructions,
        ..all
    };
    let options = [
        ("scalar", with(Instructions::Scalar)),
        ("avx2", with(Instructions::Avx2)),
        ("avx512", with(Instructions::Avx512)),
        ("staying", FastOptions { stay: 1, ..all }),
        (
            "staying, scalar",
            FastOptions {
                stay: 1,
                ..with(Instructions::Scalar)
            },
        ),
        (
            "staying, avx2",
            FastOptions {
                stay: 1,
                ..with(Instructions::Avx2)
            },
        ),
        ("often changing", FastOptions { stay: 3, ..all }),
        ("all pairs", FastOptions { pairs: 1, ..all }),
        ("no pairs", FastOptions { pairs: 0, ..all }),
        (
            "narrow buckets",
            FastOptions {
                bucket: 0.01,
                ..all
            },
        ),
        ("wide buckets", FastOptions { bucket: 3.0, ..all }),
        (
            "all around",
            FastOptions {
                spawn_wedge: false,
                ..all
            },
        ),
        (
            "parted",
            FastOptions {
                coalesce: false,
                ..all
            },
        ),
        (
            "own numbers",
            FastOptions {
                renumber: false,
                ..all
            },
        ),
    ];
    let solver = |o| -> Box<dyn Solver> { Box::new(VtpFast::with_options(mesh, o)) };
    options
        .into_iter()
        .map(|(name, o)| (name, solver(o)))
        .collect()
}

/// The same on several threads.
fn parallel(mesh: &Mesh) -> [(&'static str, Box<dyn Solver>); 3] {
    let solver = |threads| -> Box<dyn Solver> { Box::new(Pvtp::new(mesh, threads)) };
    [
        ("one thread", solver(1)),
        ("two threads", solver(2)),
        ("four threads", solver(4)),
    ]
}

#[test]
fn all_agree_where_everything_ties() {
    for spec in [
        "gen:grid,n=14",
        "gen:cube,n=5",
        "gen:holes,holes=2",
        "gen:holes,holes=2,jitter=0.2,subdivide=1",
        "gen:tetrahedron,subdiv=3",
        "gen:sphere,subdiv=3",
        "gen:torus,faces=800",
        "gen:terrain,n=20,seed=3",
    ] {
        for scale in [1.0, 1e-6, 1e6] {
            check(spec, &scaled(soup_of(spec), scale), 12);
        }
    }
}

#[test]
fn all_agree_on_whole_numbers_pinches_borders_and_several_components() {
    let terrain = zoo::whole_terrain(12, 2);
    let ball = zoo::octahedron();
    for model in [
        zoo::whole_terrain(16, 4),
        zoo::pinched(&terrain, 17, &ball, 0),
        zoo::side_by_side(&terrain, &ball),
        zoo::with_flat_faces(terrain.clone(), 12, 0.5),
        zoo::star(8, 0.5, -0.25),
    ] {
        let positions = model.positions().unwrap().to_vec();
        let soup = TriangleSoup::new(positions, model.triangles.clone());
        check(&model.name, &scaled(soup, 1.0), 16);
    }
}

#[test]
fn a_solver_gives_the_same_answer_again_and_from_several_sources() {
    let mesh = scaled(soup_of("gen:terrain,n=16,seed=5"), 1.0);
    let [a, b] = [3, 200].map(VertexId::new);
    for (algorithm, mut solver) in all(&mesh) {
        let [from_a, from_b] = [a, b].map(|s| solver.solve(&[s]).unwrap().distances);
        let from_both = solver.solve(&[a, b]).unwrap().distances;
        // Several threads find the same paths in another order, whose lengths are rounded
        // differently.
        let rounding = if algorithm.ends_with("threads") {
            1e-12
        } else {
            0.0
        };
        let again = solver.solve(&[a]).unwrap().distances;
        for (x, y) in again.iter().zip(&from_a) {
            assert!((x - y).abs() <= rounding * y, "{algorithm}");
        }
        for ((x, y), both) in from_a.iter().zip(&from_b).zip(&from_both) {
            let least = x.min(*y);
            assert!((least - both).abs() <= 1e-12 * least, "{algorithm}");
        }
    }
}

/// Every variant of the parallel form. Threads race for faces and vertices, which must not matter.
#[test]
fn any_number_of_threads_finds_the_same_distances() {
    let all = FastOptions::default();
    let variants = [
        all,
        FastOptions {
            instructions: Instructions::Scalar,
            pairs: 1,
            ..all
        },
        FastOptions { bucket: 2.0, ..all },
        FastOptions {
            bucket: 0.01,
            ..all
        },
        FastOptions {
            spawn_wedge: false,
            pairs: 0,
            ..all
        },
        FastOptions {
            coalesce: false,
            ..all
        },
        FastOptions {
            renumber: false,
            ..all
        },
    ];
    let mut models: Vec<(String, Mesh)> = [
        "gen:sphere,subdiv=4,noise=0.05,seed=2",
        "gen:terrain,n=40,seed=3",
        "gen:grid,n=20",
        "gen:anisotropic,faces=3000,g=6",
        "gen:torus,faces=5000,bump=0.1,seed=7",
    ]
    .map(|spec| (spec.to_owned(), scaled(soup_of(spec), 1.0)))
    .into();
    let apart = zoo::side_by_side(&zoo::whole_terrain(12, 2), &zoo::octahedron());
    let positions = apart.positions().unwrap().to_vec();
    let soup = TriangleSoup::new(positions, apart.triangles.clone());
    models.push((apart.name, scaled(soup, 1.0)));
    for (name, mesh) in &models {
        let n = mesh.vertex_count() as u32;
        let sources = [vec![n / 3], vec![n / 2, n - 1, n / 2]];
        for (variant, options) in variants.into_iter().enumerate() {
            let mut one = Pvtp::with_options(mesh, 1, options);
            for sources in &sources[..if variant == 0 { 2 } else { 1 }] {
                let sources: Vec<_> = sources.iter().copied().map(VertexId::new).collect();
                let (expected, counters) = one.count(&sources).unwrap();
                assert_eq!(one.count(&sources).unwrap(), (expected.clone(), counters));
                for threads in [2, 3, 4] {
                    let mut several = Pvtp::with_options(mesh, threads, options);
                    assert_eq!(several.threads(), threads);
                    // Repeated, because the order of threads is random.
                    for run in 0..if variant == 0 { 20 } else { 4 } {
                        let found = several.solve(&sources).unwrap();
                        for (v, (d, e)) in
                            (0..).zip(found.distances.iter().zip(&expected.distances))
                        {
                            assert!(
                                d == e || (d - e).abs() <= 1e-12 * e,
                                "{name} from {sources:?}, variant {variant}, {threads} threads, run {run}: \
                                 vertex {v} at {d} instead of {e}"
                            );
                        }
                    }
                }
            }
        }
    }
}

#[test]
fn one_thread_of_the_parallel_form_does_the_same_as_the_other_one() {
    let mesh = scaled(soup_of("gen:torus,faces=5000,bump=0.1,seed=7"), 1.0);
    let source = [VertexId::new(0)];
    let (fast, fast_counters) = VtpFast::new(&mesh).count(&source).unwrap();
    let (parallel, counters) = Pvtp::new(&mesh, 1).count(&source).unwrap();
    assert_eq!(fast.distances, parallel.distances);
    for counter in Pvtp::counters() {
        let [a, b] = [&fast_counters, &counters].map(|c| c.get(counter));
        assert_eq!(a, b, "{counter:?}");
    }
}

/// An idle thread, or one that was far ahead, once did not hold back the others while windows that
/// they had sent waited for it. If the system did not run it for a while, the others propagated up
/// to three times as many windows into its part of the surface. Now 16 threads on two processors
/// take less than 30 % more than one; how many depends on their turns.
#[test]
fn threads_do_not_run_away_from_one_that_is_late() {
    let mesh = scaled(soup_of("gen:torus,faces=5000,bump=0.1,seed=7"), 1.0);
    let propagated = |threads| {
        let (_, counters) = Pvtp::new(&mesh, threads)
            .count(&[VertexId::new(0)])
            .unwrap();
        counters.get(Counter::Propagated).unwrap()
    };
    let alone = propagated(1);
    for threads in [2, 4, 8, 16] {
        for _ in 0..5 {
            let together = propagated(threads);
            assert!(
                together < 2 * alone,
                "{threads} threads: {together}, not {alone}"
            );
        }
    }
}

/// A run that was aborted once left windows, handoffs and queues for the next run, which found
/// distances too short.
#[test]
fn a_run_that_was_broken_off_leaves_nothing_for_the_next_one() {
    struct Breaks(u32);
    impl Probe for Breaks {
        fn enter(&mut self, _: Phase) {
            self.0 -= 1;
            assert!(self.0 > 0, "on purpose");
        }
    }
    let mesh = scaled(soup_of("gen:terrain,n=30,seed=3"), 1.0);
    let [a, b] = [3, 800].map(VertexId::new);
    for threads in [1, 2, 4] {
        let mut solver = Pvtp::new(&mesh, threads);
        let expected = solver.solve(&[b]).unwrap().distances;
        for steps in [10, 300, 900] {
            let run = AssertUnwindSafe(|| solver.propagate(&[a], &mut Breaks(steps)));
            assert!(catch_unwind(run).is_err(), "{threads} threads, {steps}");
            let found = solver.solve(&[b]).unwrap().distances;
            for (d, e) in found.iter().zip(&expected) {
                assert!((d - e).abs() <= 1e-12 * e, "{threads} threads, {steps}");
            }
        }
    }
}

/// If kernels gave other bits with other registers, distances would depend on the processor.
#[test]
fn all_instructions_give_the_same_bits_and_counts() {
    let mut available = 0;
    for spec in [
        "gen:sphere,subdiv=4,noise=0.05,seed=2",
        "gen:terrain,n=40,seed=3",
        "gen:grid,n=20",
        "gen:anisotropic,faces=3000,g=6",
    ] {
        for scale in [1.0, 1e-40, 1e40] {
            let mesh = scaled(soup_of(spec), scale);
            let source = [VertexId::new(mesh.vertex_count() as u32 / 3)];
            let run = |instructions, pairs| {
                let options = FastOptions {
                    instructions,
                    pairs,
                    ..FastOptions::default()
                };
                let mut solver = VtpFast::with_options(&mesh, options);
                assert_eq!(solver.options().instructions, instructions);
                let (solution, counters) = solver.count(&source).unwrap();
                let bits: Vec<_> = solution.distances.iter().map(|d| d.to_bits()).collect();
                (bits, counters)
            };
            for pairs in [1, 8] {
                let scalar = run(Instructions::Scalar, pairs);
                for wide in [Instructions::Avx2, Instructions::Avx512] {
                    if wide.is_available() {
                        available += 1;
                        assert!(run(wide, pairs) == scalar, "{spec} times {scale}: {wide}");
                    }
                }
            }
        }
    }
    for wide in [Instructions::Avx2, Instructions::Avx512] {
        if wide.is_available() {
            check_bits(wide);
        }
    }
    if available == 0 {
        eprintln!("SKIPPED: this processor has no vector instructions that are used");
    }
}

#[test]
fn lists_that_stay_change_their_form_and_end_early() {
    let mesh = scaled(soup_of("gen:torus,faces=12000,bump=0.1,seed=7"), 1.0);
    let sources = [0, 2500].map(VertexId::new);
    let expected = mmp(&mesh).solve(&sources).unwrap().distances;
    let is_right = |d: f64, e: f64| (d - e).abs() <= 1e-12 * e;
    for stay in [1, 4, 8, 12, 16, 24] {
        let options = FastOptions {
            stay,
            ..FastOptions::default()
        };
        let mut solver = VtpFast::with_options(&mesh, options);
        for target in [17_u32, 900, 5000] {
            let goal = Goal::targets([target]);
            let found = solver.solve_until(&sources, &goal).unwrap().distances;
            let v = target as usize;
            assert!(is_right(found[v], expected[v]), "{stay}, {target}");
        }
        let found = solver.solve(&sources).unwrap().distances;
        for (v, (&d, &e)) in found.iter().zip(&expected).enumerate() {
            assert!(is_right(d, e), "{stay}: vertex {v} at {d} instead of {e}");
        }
    }
}

#[test]
fn lists_that_stay_give_the_same_bits_with_all_instructions() {
    for spec in [
        "gen:sphere,subdiv=4,noise=0.05,seed=2",
        "gen:torus,faces=5000,bump=0.1,seed=7",
    ] {
        for scale in [1.0, 1e-12, 1e12, 1e-40, 1e40] {
            let mesh = scaled(soup_of(spec), scale);
            let run = |instructions| {
                let options = FastOptions {
                    instructions,
                    stay: 1,
                    ..FastOptions::default()
                };
                let mut solver = VtpFast::with_options(&mesh, options);
                let distances = solver.distances_from(7).unwrap();
                distances.iter().map(|d| d.to_bits()).collect::<Vec<_>>()
            };
            let scalar = run(Instructions::Scalar);
            for wide in [Instructions::Avx2, Instructions::Avx512] {
                if wide.is_available() {
                    assert!(run(wide) == scalar, "{spec} times {scale}: {wide}");
                }
            }
        }
    }
}

/// Compares the whole family with `wide` instructions with scalar instructions.
fn check_bits(wide: Instructions) {
    let spec = "gen:sphere,subdiv=4,noise=0.05,seed=2";
    let mesh = scaled(soup_of(spec), 1.0);
    let source = [VertexId::new(mesh.vertex_count() as u32 / 3)];
    let scalar = family_with(&mesh, Instructions::Scalar);
    for ((name, mut one), (_, mut other)) in scalar.into_iter().zip(family_with(&mesh, wide)) {
        let [(expected, counters), (found, counted)] =
            [&mut one, &mut other].map(|solver| solver.count(&source).unwrap());
        assert!(expected == found && counters == counted, "{name}: {wide}");
    }
}

#[test]
fn every_improvement_leaves_its_mark_on_the_counts() {
    let mesh = scaled(soup_of("gen:sphere,subdiv=4,noise=0.05,seed=2"), 1.0);
    let get = |options, counter| {
        let mut solver = VtpFast::with_options(&mesh, options);
        let counters = solver.count(&[VertexId::new(0)]).unwrap().1;
        counters.get(counter).unwrap()
    };
    let all = FastOptions::default();
    let children = |pairs| get(FastOptions { pairs, ..all }, Counter::Children);
    assert!(children(1) < children(8) && children(8) < children(0));
    let spawned = |spawn_wedge| get(FastOptions { spawn_wedge, ..all }, Counter::Spawned);
    assert!(2 * spawned(true) < spawned(false));
    let rounds = |bucket| get(FastOptions { bucket, ..all }, Counter::Iterations);
    assert!(rounds(0.1) > 2 * rounds(0.5));
}

/// Numbers of children in runs of the serial form and of the parallel form on one thread.
fn children(mesh: &Mesh, coalesce: bool) -> [u64; 2] {
    let options = FastOptions {
        coalesce,
        ..FastOptions::default()
    };
    let source = [VertexId::new(0)];
    let one = VtpFast::with_options(mesh, options).count(&source);
    let parallel = Pvtp::with_options(mesh, 1, options).count(&source);
    [one, parallel].map(|run| run.unwrap().1.get(Counter::Children).unwrap())
}

#[test]
fn windows_that_flat_vertices_part_are_one_behind_them() {
    // The second surface is flat except at its edges; the third is subdivided without a change of
    // shape.
    for (spec, gain) in [
        ("gen:grid,n=30", 4),
        ("gen:cube,n=10", 2),
        ("gen:terrain,n=8,seed=3,subdivide=3", 2),
    ] {
        let mesh = scaled(soup_of(spec), 1.0);
        let [with, without] = [true, false].map(|coalesce| children(&mesh, coalesce));
        for (with, without) in with.into_iter().zip(without) {
            assert!(gain * with < without, "{spec}: {with} of {without}");
        }
    }
    let plane = scaled(soup_of("gen:grid,n=30"), 1.0);
    assert!(children(&plane, true)[0] < plane.half_edge_count() as u64);
    let curved = scaled(soup_of("gen:sphere,subdiv=4,noise=0.05,seed=2"), 1.0);
    assert_eq!(children(&curved, true), children(&curved, false));
}

fn counts(mesh: &Mesh) -> Vec<(&'static str, Counters)> {
    family(mesh)
        .into_iter()
        .map(|(name, mut solver)| (name, solver.count(&[VertexId::new(0)]).unwrap().1))
        .collect()
}

#[test]
fn counts_fit_together_in_every_algorithm() {
    let mesh = scaled(soup_of("gen:sphere,subdiv=4,noise=0.05,seed=2"), 1.0);
    for (name, counters) in counts(&mesh) {
        let get = |counter| counters.get(counter).unwrap();
        let propagated = get(Counter::Propagated);
        assert_eq!(
            get(Counter::Prime) + get(Counter::Secondary),
            propagated,
            "{name}"
        );
        assert!(get(Counter::Children) <= propagated, "{name}");
        assert!(propagated <= 2 * get(Counter::Parents), "{name}");
        assert!(get(Counter::PeakWindows) > 0, "{name}");
        assert!(
            10 * get(Counter::Prime) > 9 * propagated,
            "{name}: secondary propagations are few"
        );
        assert!(counters.wavefront_deviation.unwrap() > 0.0, "{name}");
        assert!(
            get(Counter::SecondaryNear) <= get(Counter::Secondary),
            "{name}"
        );
    }
}

/// Proposition 5.1 of Qin et al. 2016: rule 2 is linear. All pairs are not.
#[test]
fn neighbours_are_compared_at_most_twice_for_each_window() {
    let mesh = scaled(soup_of("gen:knot,faces=3000"), 1.0);
    for (name, counters) in counts(&mesh) {
        let checks = counters.get(Counter::PairChecks);
        assert_eq!(checks.is_none(), name == "vtp-no-rules23", "{name}");
        let Some(checks) = checks else { continue };
        let windows = counters.get(Counter::ComparedWindows).unwrap();
        assert!(checks > windows / 2, "{name}: {checks} of {windows}");
        assert_eq!(
            checks > 2 * windows,
            name == "vtp-exhaustive",
            "{name}: {checks} of {windows}"
        );
        let Some(pruned) = counters.get(Counter::Case1) else {
            continue;
        };
        let others = [
            Counter::Case2,
            Counter::Case3,
            Counter::Case4,
            Counter::Case5,
            Counter::Case6,
        ];
        let pruned = others
            .into_iter()
            .fold(pruned, |sum, case| sum + counters.get(case).unwrap());
        assert!(0 < pruned && pruned < 2 * checks, "{name}: {pruned}");
    }
}

/// On the flat grid no path bends, so the deepest window has crossed the longest strip of faces
/// that a straight line from the corner meets, whatever the algorithm.
#[test]
fn levels_are_those_of_mmp_where_only_the_shape_decides() {
    let mesh = scaled(soup_of("gen:grid,n=9"), 1.0);
    let levels = |counters: &Counters| counters.get(Counter::Levels).unwrap();
    let (_, of_mmp) = mmp(&mesh).count(&[VertexId::new(0)]).unwrap();
    assert!(levels(&of_mmp) > 9);
    for (name, mut solver) in family(&mesh).into_iter().chain(fast(&mesh)) {
        let (_, counters) = solver.count(&[VertexId::new(0)]).unwrap();
        assert_eq!(levels(&counters), levels(&of_mmp), "{name}");
    }
}

#[test]
fn every_choice_leaves_its_mark_on_the_counts() {
    let mesh = scaled(soup_of("gen:sphere,subdiv=4,noise=0.05,seed=2"), 1.0);
    let counts = counts(&mesh);
    let get = |name: &str, counter| {
        let (_, counters) = counts.iter().find(|(n, _)| *n == name).unwrap();
        counters.get(counter).unwrap()
    };
    let children = |name| get(name, Counter::Children);
    let vtp = children("vtp");
    // Without rule 1 every window with both exits is tried at both.
    let doubled = get("vtp-no-rule1", Counter::Propagated);
    assert_eq!(doubled, 2 * get("vtp-no-rule1", Counter::Parents));
    assert!(children("vtp-no-rule1") > vtp);
    // Rule 1 closes an exit of each window that crosses, where both lead somewhere.
    let closed = get("vtp", Counter::Rule1) + get("vtp", Counter::Propagated);
    assert!(closed <= 2 * get("vtp", Counter::Parents));
    assert!(2 * get("vtp", Counter::Rule1) > get("vtp", Counter::Propagated));
    assert!(children("vtp-no-rules23") > vtp);
    assert!(children("vtp-exhaustive") < vtp);
    assert!(children("edge-based") <= vtp);
    assert!(children("vtp-trimming") < vtp);
    assert_ne!(children("opvtp"), vtp);
    assert_ne!(children("opftp"), children("ftp"));
    // A turn adds one face instead of a ring of faces, so more turns are queued.
    assert!(get("ftp", Counter::QueuePushes) > 2 * get("vtp", Counter::QueuePushes));
}
