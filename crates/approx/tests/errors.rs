//! Errors of the approximate algorithms: their order under refinement, and their sign.

use geobench_approx::{Dijkstra, Fmm, FmmUntidy};
use geobench_mesh::Mesh;
use geobench_window::Solver;

/// Distances from vertex 0 of a flat convex mesh.
fn straight(mesh: &Mesh) -> Vec<f64> {
    let positions = mesh.positions();
    let away = |p: &[f64; 3]| (p[0] - positions[0][0]).hypot(p[1] - positions[0][1]);
    positions.iter().map(away).collect()
}

/// Distances from vertex 0 on the unit sphere.
fn round(mesh: &Mesh) -> Vec<f64> {
    let positions = mesh.positions();
    let away = |p: &[f64; 3]| {
        let cosine: f64 = p.iter().zip(positions[0]).map(|(a, b)| a * b).sum();
        cosine.clamp(-1.0, 1.0).acos()
    };
    positions.iter().map(away).collect()
}

/// Mean relative error without the source.
fn mean_error(found: &[f64], exact: &[f64]) -> f64 {
    let others = found.iter().zip(exact).skip(1);
    let errors = others.map(|(found, exact)| (found - exact).abs() / exact);
    errors.sum::<f64>() / (found.len() - 1) as f64
}

/// The mean errors of a method on meshes, each twice as fine as the one before.
fn errors(
    specs: &[String],
    exact: fn(&Mesh) -> Vec<f64>,
    solve: impl Fn(&Mesh) -> Vec<f64>,
) -> Vec<f64> {
    let error = |spec: &String| {
        let mesh = Mesh::generate(spec).unwrap();
        mean_error(&solve(&mesh), &exact(&mesh))
    };
    specs.iter().map(error).collect()
}

fn grids() -> Vec<String> {
    [16, 32, 64, 128].map(|n| format!("grid,n={n}")).into()
}

fn spheres() -> Vec<String> {
    [3, 4, 5, 6].map(|n| format!("sphere,subdiv={n}")).into()
}

/// Asserts that halving the edges multiplies the error by a factor within these bounds, each time.
fn assert_rate(errors: &[f64], least: f64, most: f64) {
    for pair in errors.windows(2) {
        let rate = pair[1] / pair[0];
        assert!((least..most).contains(&rate), "{errors:?}");
    }
}

#[test]
fn fast_marching_is_of_first_order() {
    let fmm = |mesh: &Mesh| Fmm::new(mesh, true).distances_from(0).unwrap();
    // From a point source the error is h log(1/h): halving h multiplies it by slightly more than
    // 0.5, approaching 0.5.
    for errors in [
        errors(&grids(), straight, fmm),
        errors(&spheres(), round, fmm),
    ] {
        assert_rate(&errors, 0.5, 0.73);
        let rates: Vec<f64> = errors.windows(2).map(|pair| pair[1] / pair[0]).collect();
        assert!(rates.is_sorted_by(|a, b| a > b), "{rates:?}");
    }
}

#[test]
fn fast_marching_carries_a_straight_front_exactly() {
    let mesh = Mesh::generate("grid,n=24,jitter=0.24,seed=3").unwrap();
    let positions = mesh.positions();
    let side: Vec<u32> = (0..mesh.vertex_count() as u32)
        .filter(|&v| positions[v as usize][0] == 0.0)
        .collect();
    assert_eq!(side.len(), 25);
    let found = Fmm::new(&mesh, true).distances_from(&side).unwrap();
    for (d, p) in found.iter().zip(positions) {
        assert!((d - p[0]).abs() <= 1e-12 * p[0], "{d} {}", p[0]);
    }
}

#[test]
fn the_untidy_queue_costs_little() {
    let mesh = Mesh::generate("sphere,subdiv=5").unwrap();
    let exact = round(&mesh);
    let tidy = mean_error(&Fmm::new(&mesh, true).distances_from(0).unwrap(), &exact);
    for width in [1e-9, 0.1] {
        let mut untidy = FmmUntidy::new(&mesh, true, width);
        let error = mean_error(&untidy.distances_from(0).unwrap(), &exact);
        assert!(
            (error - tidy).abs() < 0.05 * tidy,
            "{width}: {error} {tidy}"
        );
    }
}

#[test]
fn fast_marching_is_never_too_short_on_a_flat_convex_surface() {
    for spec in [
        "grid,n=24",
        "grid,n=24,jitter=0.24,seed=3",
        "grid,nx=7,ny=40,diagonal=alternating",
    ] {
        let mesh = Mesh::generate(spec).unwrap();
        let exact = straight(&mesh);
        for unfold in [true, false] {
            let found = Fmm::new(&mesh, unfold).distances_from(0).unwrap();
            for (v, (found, exact)) in found.iter().zip(&exact).enumerate() {
                assert!(
                    *found >= exact * (1.0 - 1e-13),
                    "{spec}: {v} {found} {exact}"
                );
            }
        }
    }
}

#[test]
fn unfolding_obtuse_corners_makes_fast_marching_more_accurate() {
    let mesh = Mesh::generate("uvsphere,slices=32,stacks=128").unwrap();
    let exact = round(&mesh);
    let error = |unfold| {
        let found = Fmm::new(&mesh, unfold).distances_from(0).unwrap();
        mean_error(&found, &exact)
    };
    assert!(
        error(true) <= error(false),
        "{} {}",
        error(true),
        error(false)
    );
}

#[test]
fn finer_meshes_do_not_help_dijkstra() {
    let dijkstra = |mesh: &Mesh| Dijkstra::new(mesh).distances_from(0).unwrap();
    let errors = errors(&grids(), straight, dijkstra);
    assert_rate(&errors, 1.0, 1.05);
}

#[test]
fn dijkstra_traces_its_edges() {
    use geobench_mesh::HalfEdgeId;
    use geobench_window::{Goal, Origin};
    let mesh = Mesh::generate("torus,faces=800,bump=0.2,seed=3").unwrap();
    let (solution, origins) = Dijkstra::new(&mesh)
        .trace(&[5.into()], &Goal::everything())
        .unwrap();
    for v in mesh.vertices().filter(|v| v.raw() != 5) {
        let Origin::Vertex(from) = origins.of(&mesh, v) else {
            panic!("{v:?} comes along no edge");
        };
        let is_edge = |h: &HalfEdgeId| mesh.tail(*h) == from && mesh.head(*h) == v;
        let edge = mesh.half_edges().find(is_edge).unwrap();
        let [d, before] = [v, from].map(|v| solution.distances[v.index()]);
        assert_eq!(d, before + mesh.length(edge));
    }
}

#[cfg(feature = "heat")]
mod heat {
    use geobench_approx::{Boundary, Heat, HeatOptions};
    use geobench_window::Counter;

    use super::*;

    fn heat(options: HeatOptions) -> impl Fn(&Mesh) -> Vec<f64> {
        move |mesh| Heat::new(mesh, options).distances_from(0).unwrap()
    }

    #[test]
    fn heat_converges_on_the_sphere() {
        let options = HeatOptions::default();
        assert_rate(&errors(&spheres(), round, heat(options)), 0.3, 0.75);
    }

    /// With t = h² the fronts on a right-angled grid keep the shape of its stencil at every
    /// resolution. With t ~ h they become round.
    #[test]
    fn heat_converges_on_the_plane_if_it_flows_longer_than_an_edge() {
        // Flips of the diagonals of squares, which rounding decides, would mix their directions.
        let unflipped = HeatOptions {
            delaunay: false,
            ..HeatOptions::default()
        };
        assert_rate(&errors(&grids(), straight, heat(unflipped)), 0.8, 1.2);
        let longer = |mesh: &Mesh| {
            let options = HeatOptions {
                time: (mesh.vertex_count() as f64).sqrt() / 4.0,
                ..unflipped
            };
            heat(options)(mesh)
        };
        assert_rate(&errors(&grids(), straight, longer), 0.3, 0.8);
    }

    #[test]
    fn delaunay_edges_make_heat_more_accurate_on_stretched_faces() {
        let mesh = Mesh::generate("uvsphere,slices=24,stacks=192").unwrap();
        let exact = round(&mesh);
        let error = |delaunay| {
            let options = HeatOptions {
                delaunay,
                ..HeatOptions::default()
            };
            mean_error(&heat(options)(&mesh), &exact)
        };
        assert!(
            error(true) <= error(false) * 1.001,
            "{} {}",
            error(true),
            error(false)
        );
    }

    /// On a sheared grid without Delaunay edges, the solution is negative at a quarter of the
    /// vertices. Distances there are 0, and counted.
    #[test]
    fn negative_values_are_counted_and_there_are_none_by_default() {
        let n: u32 = 30;
        let places =
            (0..=n).flat_map(|j| (0..=n).map(move |i| [f64::from(i + 6 * j), f64::from(j), 0.0]));
        let corner = |i, j| j * (n + 1) + i;
        let faces = (0..n)
            .flat_map(|j| (0..n).map(move |i| (i, j)))
            .flat_map(|(i, j)| {
                let [a, b, c, d] = [
                    corner(i, j),
                    corner(i + 1, j),
                    corner(i, j + 1),
                    corner(i + 1, j + 1),
                ];
                [[a, b, d], [a, d, c]]
            });
        let mesh = Mesh::new(places.collect(), faces.collect()).unwrap();
        let negative = |delaunay| {
            let options = HeatOptions {
                delaunay,
                ..HeatOptions::default()
            };
            let (solution, counters) = Heat::new(&mesh, options).count(&[0.into()]).unwrap();
            let zeros = solution.distances.iter().filter(|d| **d == 0.0).count();
            assert_eq!(
                counters.get(Counter::Negative),
                Some(solution.negative as u64)
            );
            assert_eq!(zeros, solution.negative + 1);
            solution.negative
        };
        assert!(HeatOptions::default().delaunay);
        assert!(negative(false) > 0);
        assert_eq!(negative(true), 0);
    }

    #[test]
    fn the_mean_of_both_boundary_conditions_is_the_best() {
        let mesh = Mesh::generate("grid,n=64").unwrap();
        let middle = 64 / 2 * 65 + 64 / 2;
        let away = |p: &[f64; 3]| {
            let m = mesh.positions()[middle as usize];
            (p[0] - m[0]).hypot(p[1] - m[1])
        };
        let from_middle: Vec<f64> = mesh.positions().iter().map(away).collect();
        let error = |boundary| {
            let options = HeatOptions {
                boundary,
                time: 64.0,
                ..HeatOptions::default()
            };
            let found = Heat::new(&mesh, options).distances_from(middle).unwrap();
            let others = found.iter().zip(&from_middle).filter(|(_, e)| **e > 0.0);
            others.map(|(f, e)| (f - e).abs() / e).sum::<f64>()
        };
        let [average, insulated, cold] =
            [Boundary::Average, Boundary::Insulated, Boundary::Cold].map(error);
        assert!(
            average < insulated && average < cold,
            "{average} {insulated} {cold}"
        );
    }

    #[test]
    fn a_shift_of_the_laplace_matrix_hardly_matters() {
        let mesh = Mesh::generate("sphere,subdiv=4").unwrap();
        let shifted = HeatOptions {
            shift: 1e-9,
            ..HeatOptions::default()
        };
        let one = heat(HeatOptions::default())(&mesh);
        let other = heat(shifted)(&mesh);
        for (a, b) in one.iter().zip(&other) {
            assert!((a - b).abs() < 1e-6, "{a} {b}");
        }
    }
}
