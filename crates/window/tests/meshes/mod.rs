//! Small meshes on which solvers were wrong, and the checks of a solver on them.
//!
//! The tests of all crates with solvers include this file, so the meshes exist once.

#![allow(dead_code)] // Each crate uses the meshes on which its own solvers were wrong.

use std::f64::consts::PI;
use std::iter;

use geobench_mesh::{Mesh, Tolerance, TriangleSoup, VertexId};
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
    /// Checks all `solvers` on this mesh.
    pub(crate) fn check(&self, solvers: impl Fn(&Mesh) -> Solvers) {
        let mesh = self.mesh();
        let rule = Tolerance::on(&mesh, self.distances);
        self.check_by(&rule, &mesh, solvers);
    }

    /// Checks each distance to 1e-9 of itself, however small it is.
    pub(crate) fn check_relative(&self, solvers: impl Fn(&Mesh) -> Solvers) {
        self.check_by(&Tolerance::relative(1e-9), &self.mesh(), solvers);
    }

    /// The same with each distance to 1e-13 of itself.
    pub(crate) fn check_closely(&self, solvers: impl Fn(&Mesh) -> Solvers) {
        self.check_by(&Tolerance::relative(1e-13), &self.mesh(), solvers);
    }

    fn mesh(&self) -> Mesh {
        mesh(self.positions.to_vec(), self.faces.to_vec())
    }

    fn check_by(&self, rule: &Tolerance, mesh: &Mesh, solvers: impl Fn(&Mesh) -> Solvers) {
        let sources: Vec<VertexId> = self.sources.iter().map(|&v| VertexId::new(v)).collect();
        let failures = solvers(mesh).into_iter().filter_map(|(name, mut solver)| {
            let found = solver.solve(&sources).unwrap().distances;
            wrong(&found, self.distances, rule).map(|wrong| format!("{name}: {wrong}"))
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

/// The first vertex whose distance is wrong, and how it is.
fn wrong(found: &[f64], expected: &[f64], rule: &Tolerance) -> Option<String> {
    let first = rule.wrong(found, expected).next();
    first.map(|v| format!("vertex {v} at {} instead of {}", found[v], expected[v]))
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
            let rule = Tolerance::on(&mesh, &expected);
            let wrong = wrong(&solution.distances, &expected, &rule);
            assert_eq!(wrong, None, "{name}, height {height:e}");
            let propagated = counters.get(Counter::Propagated).unwrap();
            assert!(
                propagated <= NEEDLE_WINDOWS,
                "{name}, height {height:e}: {propagated} windows"
            );
        }
    }
}

/// Checks the work of all `solvers` on a sphere of 80 faces with one vertex far away, from that
/// vertex and from another one. All distances may be equal up to rounding.
pub(crate) fn check_spikes(solvers: impl Fn(&Mesh) -> Solvers) {
    let sphere = Mesh::generate("sphere,subdiv=1").unwrap();
    let far = 30;
    for height in [1e4, 1e8, 1e10, 1e12, 1e14, 1e16, 1e20, 1e25] {
        let mut positions = sphere.positions().to_vec();
        positions[far] = positions[far].map(|x| height * x);
        let corners = |f| sphere.face_vertices(f).map(VertexId::raw);
        let mesh = mesh(positions, sphere.faces().map(corners).collect());
        for (name, mut solver) in solvers(&mesh) {
            for source in [far as u32, 3] {
                let (_, counters) = solver.count(&[VertexId::new(source)]).unwrap();
                let propagated = counters.get(Counter::Propagated).unwrap();
                assert!(
                    propagated <= NEEDLE_WINDOWS,
                    "{name}, height {height:e}, source {source}: {propagated} windows"
                );
            }
        }
    }
}

/// Checks the distances and the work of all `solvers` on a flat strip of `faces` faces, each a
/// millionth as wide as it is long, from a corner.
pub(crate) fn check_strip(faces: u32, most: u64, solvers: impl Fn(&Mesh) -> Solvers) {
    let at = |k: u32| [f64::from(k) * 1e-6, f64::from(k % 2), 0.0];
    let positions: Vec<[f64; 3]> = (0..faces + 2).map(at).collect();
    let expected: Vec<f64> = positions.iter().map(|[x, y, _]| x.hypot(*y)).collect();
    let turned = |k: u32| {
        if k.is_multiple_of(2) {
            [k, k + 2]
        } else {
            [k + 2, k]
        }
    };
    let corners = |k| [turned(k)[0], turned(k)[1], k + 1];
    let mesh = mesh(positions, (0..faces).map(corners).collect());
    let rule = Tolerance::on(&mesh, &expected);
    for (name, mut solver) in solvers(&mesh) {
        let (solution, counters) = solver.count(&[VertexId::new(0)]).unwrap();
        assert_eq!(wrong(&solution.distances, &expected, &rule), None, "{name}");
        let propagated = counters.get(Counter::Propagated).unwrap();
        assert!(propagated <= most, "{name}: {propagated} windows");
    }
}

/// A mesh with one thin face, and without it: a face of a terrain is split beside the middle of its
/// first edge. The last vertex is in one of them only.
pub(crate) fn terrains_with_and_without_a_sliver() -> [Mesh; 2] {
    let terrain = Mesh::generate("terrain,n=60,seed=3").unwrap();
    let mut positions = terrain.positions().to_vec();
    let corners = |f| terrain.face_vertices(f).map(VertexId::raw);
    let mut faces: Vec<[u32; 3]> = terrain.faces().map(corners).collect();
    let split = faces.len() / 2;
    let [a, b, c] = faces[split];
    let place = |weights: [f64; 3]| {
        let corners = [a, b, c].map(|v| positions[v as usize]);
        [0, 1, 2].map(|axis| (0..3).map(|k| weights[k] * corners[k][axis]).sum())
    };
    let inside = place([0.5 - 5e-5, 0.5 - 5e-5, 1e-4]);
    let new = positions.len() as u32;
    positions.push(inside);
    faces[split] = [a, b, new];
    faces.extend([[b, c, new], [c, a, new]]);
    [mesh(positions, faces), terrain]
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
