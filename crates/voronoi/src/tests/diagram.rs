//! Diagrams against distances from single sources, formulas and an independent program.

use std::collections::{BTreeSet, HashMap};

use geobench_mesh::{FaceId, Mesh, TriangleSoup, VertexId};
use geobench_oracle::{Model, nasty, subdivide, zoo};
use geobench_vtp::VtpFast;
use geobench_window::{Solver, VertexFilter};
use spade::{DelaunayTriangulation, Point2, Triangulation};

use super::{mesh_of, one_by_one, some_vertices, try_mesh_of};
use crate::diagram::sites::FaceSites;
use crate::{Diagram, Kind, Lct11, NO_SOURCE, Obstacle, Options, Removal, WindowVtp};

/// Largest error of distances at points of arcs, relative to the distance.
const ON_ARCS: f64 = 1e-9;

fn diagram_of(mesh: &Mesh, sources: &[VertexId]) -> Diagram {
    let mut solver = WindowVtp::new(mesh);
    Diagram::new(&solver.field(sources).unwrap(), sources.len())
}

/// The distances from each of `sources` alone at any point of a face.
struct Judge {
    solvers: Vec<WindowVtp>,
    sources: Vec<VertexId>,
}

impl Judge {
    fn new(mesh: &Mesh, sources: &[VertexId]) -> Self {
        let options = Options {
            removal: Removal::Off,
            ..Options::default()
        };
        Self {
            solvers: vec![WindowVtp::with_options(mesh, options); sources.len()],
            sources: sources.to_vec(),
        }
    }

    /// For each source a way to measure the distances in a face.
    fn faces(&mut self, mesh: &Mesh) -> Vec<Vec<FaceSites>> {
        let each = self.solvers.iter_mut().zip(&self.sources);
        each.map(|(solver, &source)| {
            let field = solver.field(&[source]).unwrap();
            mesh.faces()
                .map(|face| FaceSites::new(&field, face))
                .collect()
        })
        .collect()
    }
}

/// All that is true of every diagram.
fn check(name: &str, mesh: &Mesh, sources: &[VertexId]) -> Vec<String> {
    let mut wrong = Vec::new();
    let diagram = diagram_of(mesh, sources);
    let mut complain = |text: String| wrong.push(format!("{name} from {sources:?}: {text}"));
    // Areas.
    let area =
        |face: FaceId| 0.5 * mesh.length(face.half_edge(0)) * mesh.apex(face.half_edge(0))[1];
    let reached =
        |face: &FaceId| diagram.labels()[mesh.face_vertices(*face)[0].index()] != NO_SOURCE;
    let whole: f64 = mesh.faces().filter(reached).map(area).sum();
    let sum: f64 = diagram.cells().iter().map(|cell| cell.area).sum();
    if (whole - sum).abs() > 1e-9 * whole {
        complain(format!("areas of {sum} in {whole}"));
    }
    let mut areas = vec![0.0; sources.len()];
    for face in mesh.faces() {
        if let Some(cell) = diagram.cell_of_face(face) {
            areas[cell as usize] += area(face);
        }
    }
    for part in diagram.parts(30) {
        let [o, rest @ ..] = &part.outline[..] else {
            continue;
        };
        let twice = |p: &[[f64; 2]]| {
            (p[0][0] - o[0]) * (p[1][1] - o[1]) - (p[0][1] - o[1]) * (p[1][0] - o[0])
        };
        areas[part.source as usize] += 0.5 * rest.windows(2).map(twice).sum::<f64>();
    }
    for (i, (cell, area)) in diagram.cells().iter().zip(&areas).enumerate() {
        if (cell.area - area).abs() > 1e-3 * whole / sources.len() as f64 {
            complain(format!("cell {i} has {}, its parts {area}", cell.area));
        }
    }
    // Arcs.
    let mut judge = Judge::new(mesh, sources);
    let single = judge.faces(mesh);
    for arc in diagram.arcs() {
        let f = arc.face.index();
        for t in [0.0, 0.1, 0.37, 0.5, 0.81, 1.0] {
            let x = arc.point(t);
            let distances: Vec<f64> = single.iter().map(|faces| faces[f].distance(x)).collect();
            let least = distances.iter().fold(f64::INFINITY, |a, &b| a.min(b));
            let slack = ON_ARCS * (least + single[0][f].size);
            for source in arc.sources {
                let d = distances[source as usize];
                if d > least + slack {
                    complain(format!(
                        "{arc:?} at {t}: {d} from {source}, {least} from another"
                    ));
                }
            }
        }
    }
    // How arcs meet.
    let mut ends: HashMap<u32, u32> = HashMap::new();
    for node in diagram.arcs().iter().flat_map(|arc| arc.nodes) {
        *ends.entry(node).or_default() += 1;
    }
    for (i, node) in (0..).zip(diagram.nodes()) {
        let count = ends.get(&i).copied().unwrap_or_default();
        let expected = match node.kind {
            Kind::Vertex { degree } => degree,
            Kind::Breakpoint => 2,
            // The border of the surface has one face.
            Kind::OnEdge if count == 1 => 1,
            Kind::OnEdge => 2,
        };
        if count != expected {
            complain(format!("node {i}, {node:?}, has {count} arcs"));
        }
    }
    // Euler's formula: inside faces, edges and vertices of the diagram make up the surface.
    let inside = |v: &VertexId| !mesh.is_boundary(*v) && diagram.labels()[v.index()] != NO_SOURCE;
    let vertices = mesh
        .vertices()
        .filter(|v| !mesh.outgoing(*v).is_empty())
        .filter(inside);
    let faces = mesh.faces().filter(reached).count() as i64;
    let inner_edges = |face: FaceId| {
        (0..3)
            .filter(move |&k| mesh.twin(face.half_edge(k)).is_some())
            .count() as i64
    };
    let halves: i64 = mesh.faces().filter(reached).map(inner_edges).sum();
    let surface = vertices.count() as i64 - halves / 2 + faces;
    let on_boundary = ends.iter().filter(|(node, count)| {
        **count == 1 && diagram.nodes()[**node as usize].kind == Kind::OnEdge
    });
    let nodes = ends.len() as i64 - on_boundary.count() as i64;
    let cells: i64 = diagram.cells().iter().map(|cell| cell.euler).sum();
    if nodes - diagram.arcs().len() as i64 + cells != surface {
        complain(format!(
            "{nodes} nodes, {} arcs, {cells} of cells: not {surface}",
            diagram.arcs().len()
        ));
    }
    wrong
}

/// Distances at points of edges and inside faces against those of the vertices of the same surface
/// in smaller triangles. Faces with one cell, whose windows may have been removed, are left out.
fn check_points(model: &Model, options: Options, sources: &[VertexId]) -> Vec<String> {
    let mesh = mesh_of(model);
    // The coordinates of some points coincide.
    let Some(fine) = try_mesh_of(&model.subdivided(4)) else {
        return Vec::new();
    };
    let truth = VtpFast::new(&fine).solve(sources).unwrap().distances;
    let cut = subdivide(model.vertex_count, &model.triangles, 4);
    let mut solver = WindowVtp::with_options(&mesh, options);
    let field = solver.field(sources).unwrap();
    let diagram = (options.removal != Removal::Off).then(|| Diagram::new(&field, sources.len()));
    let mut wrong = Vec::new();
    for (small, &parent) in cut.triangles.iter().zip(&cut.parents) {
        let face = FaceId::new(parent as u32);
        if diagram
            .as_ref()
            .is_some_and(|diagram| !diagram.is_border(face))
        {
            continue;
        }
        let sites = FaceSites::new(&field, face);
        for &v in small {
            let mut at = [0.0; 2];
            for &(corner, weight) in &cut.weights[v as usize] {
                let vertices = mesh.face_vertices(face);
                let k = vertices.iter().position(|v| v.raw() == corner).unwrap();
                for (x, c) in at.iter_mut().zip(sites.corners[k]) {
                    *x += f64::from(weight) / 4.0 * c;
                }
            }
            let (d, expected) = (sites.distance(at), truth[v as usize]);
            if (d - expected).abs() > 1e-11 * (expected + sites.size) && expected.is_finite() {
                wrong.push(format!(
                    "{} from {sources:?}, {options:?}: {expected} at {at:?} of face {parent}, not {d}",
                    model.name
                ));
            }
        }
    }
    wrong
}

#[test]
fn distances_at_points_of_border_faces_are_those_of_a_finer_mesh() {
    let mut wrong = Vec::new();
    for (i, model) in (0..).zip(zoo::small()) {
        let mesh = mesh_of(&model);
        for count in [2, 5, 30] {
            for removal in [Removal::Off, Removal::Continuous] {
                let options = Options {
                    removal,
                    ..Options::default()
                };
                wrong.extend(check_points(
                    &model,
                    options,
                    &some_vertices(&mesh, count, i + 100),
                ));
            }
        }
    }
    let first: Vec<&String> = wrong.iter().take(12).collect();
    assert!(wrong.is_empty(), "{} complaints: {first:#?}", wrong.len());
}

fn check_all(models: impl Iterator<Item = (Model, Vec<usize>)>) {
    let mut wrong = Vec::new();
    for (i, (model, counts)) in (0..).zip(models) {
        let mesh = mesh_of(&model);
        for count in counts {
            let found = check(&model.name, &mesh, &some_vertices(&mesh, count, i + 100));
            if let Some(first) = found.first() {
                eprintln!(
                    "BAD {} {count}: {} {}",
                    model.name,
                    found.len(),
                    &first[..first.len().min(500)]
                );
            }
            wrong.extend(found);
        }
    }
    let first: Vec<&String> = wrong.iter().take(12).collect();
    assert!(wrong.is_empty(), "{} complaints: {first:#?}", wrong.len());
}

#[test]
fn diagrams_of_the_zoo_are_right() {
    check_all(
        zoo::small()
            .into_iter()
            .map(|model| (model, vec![1, 2, 5, 30])),
    );
}
