//! Small meshes on which solvers were wrong, and the checks of a solver on them.
//!
//! The tests of all crates with solvers include this file, so the meshes exist once.

#![allow(dead_code)] // Each crate uses the meshes on which its own solvers were wrong.

use std::f64::consts::PI;
use std::iter;

use geobench_mesh::{Mesh, TriangleSoup, VertexId};
use geobench_window::{Counter, Solver};

pub(crate) mod data;
#[macro_use]
pub(crate) mod defects;

/// The solvers of a crate, set up for a mesh, with their names.
pub(crate) type Solvers = Vec<(&'static str, Box<dyn Solver>)>;

/// A mesh, sources, and the distance of every vertex from the nearest of them.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Case {
    /// The name of the constant in words.
    pub(crate) name: &'static str,
    /// The positions of the vertices.
    pub(crate) positions: &'static [[f64; 3]],
    /// The corners of the faces.
    pub(crate) faces: &'static [[u32; 3]],
    /// The source vertices.
    pub(crate) sources: &'static [u32],
    /// The right distances; infinite where no path leads.
    pub(crate) distances: &'static [f64],
}

impl Case {
    /// Checks all `solvers` on this mesh, up to rounding of the greatest distance.
    pub(crate) fn check(&self, solvers: impl Fn(&Mesh) -> Solvers) {
        self.check_beyond(1e-9, FLOOR, solvers);
    }

    /// Checks each distance to 1e-9 of itself, however small it is.
    pub(crate) fn check_relative(&self, solvers: impl Fn(&Mesh) -> Solvers) {
        self.check_beyond(1e-9, 0.0, solvers);
    }

    /// The same with each distance to 1e-13 of itself.
    pub(crate) fn check_closely(&self, solvers: impl Fn(&Mesh) -> Solvers) {
        self.check_beyond(1e-13, 0.0, solvers);
    }

    fn check_beyond(&self, relative: f64, floor: f64, solvers: impl Fn(&Mesh) -> Solvers) {
        let mesh = mesh(self.positions.to_vec(), self.faces.to_vec());
        let sources: Vec<VertexId> = self.sources.iter().map(|&v| VertexId::new(v)).collect();
        let failures = solvers(&mesh).into_iter().filter_map(|(name, mut solver)| {
            let found = solver.solve(&sources).unwrap().distances;
            wrong(&found, self.distances, relative, floor).map(|wrong| format!("{name}: {wrong}"))
        });
        let failures: Vec<String> = failures.collect();
        assert!(
            failures.is_empty(),
            "{}:\n{}",
            self.name,
            failures.join("\n")
        );
    }
}

fn mesh(positions: Vec<[f64; 3]>, faces: Vec<[u32; 3]>) -> Mesh {
    Mesh::from_soup(TriangleSoup::new(positions, faces))
        .unwrap()
        .0
}

/// Rounding error of every distance, as a fraction of the greatest one.
const FLOOR: f64 = 1e-13;

/// The first vertex whose distance is wrong by more than `relative` of it, and how it is. `floor`
/// is as [`FLOOR`].
fn wrong(found: &[f64], expected: &[f64], relative: f64, floor: f64) -> Option<String> {
    assert_eq!(found.len(), expected.len());
    let reached = expected.iter().copied().filter(|d| d.is_finite());
    let slack = floor * reached.fold(0.0, f64::max);
    let is_right = |d: f64, e: f64| d == e || (d - e).abs() <= relative * e + slack;
    iter::zip(found, expected)
        .position(|(&d, &e)| !is_right(d, e))
        .map(|v| format!("vertex {v} at {} instead of {}", found[v], expected[v]))
}

/// Most windows that a solver may propagate on a needle: ten times 200, which MMP does not reach.
const NEEDLE_WINDOWS: u64 = 2000;

/// Checks the distances and the work of all `solvers` on open cones of ten faces around a tip, of
/// base radius 1 and heights up to 1e10, from a vertex of the base.
pub(crate) fn check_needles(solvers: impl Fn(&Mesh) -> Solvers) {
    for height in [1e2, 1e4, 1e6, 1e8, 1e10] {
        let (mesh, expected) = needle(height);
        for (name, mut solver) in solvers(&mesh) {
            let (solution, counters) = solver.count(&[VertexId::new(1)]).unwrap();
            let wrong = wrong(&solution.distances, &expected, 1e-9, FLOOR);
            assert_eq!(wrong, None, "{name}, height {height:e}");
            let propagated = counters.get(Counter::Propagated).unwrap();
            assert!(
                propagated <= NEEDLE_WINDOWS,
                "{name}, height {height:e}: {propagated} windows"
            );
        }
    }
}

/// An open cone with vertex 0 as its tip, and the distances from vertex 1. Unfolded, the cone is a
/// fan of equal triangles, and the shortest paths are chords of the fan.
fn needle(height: f64) -> (Mesh, Vec<f64>) {
    let corners = 10;
    let on_base = |i: u32| {
        let angle = 2.0 * PI * f64::from(i) / f64::from(corners);
        [angle.cos(), angle.sin(), 0.0]
    };
    let tip = [0.0, 0.0, height];
    let positions = iter::once(tip).chain((0..corners).map(on_base)).collect();
    let faces = (0..corners)
        .map(|i| [0, 1 + i, 1 + (i + 1) % corners])
        .collect();
    let side = height.hypot(1.0);
    let angle = 2.0 * ((PI / f64::from(corners)).sin() / side).asin();
    let to_base = |i: u32| 2.0 * side * (0.5 * angle * f64::from(i.min(corners - i))).sin();
    let distances = iter::once(side).chain((0..corners).map(to_base)).collect();
    (mesh(positions, faces), distances)
}
