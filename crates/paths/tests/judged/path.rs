//! A traced path in the terms of the oracle's judge.

use geobench_mesh::{Mesh, VertexId};
use geobench_oracle::{DoubleDouble, JudgedPoint, PathFlaw, PreciseSurface, judge_path};
use geobench_paths::{Path, PathPlace};

/// The surface of `mesh` for the judge.
pub(crate) fn surface(mesh: &Mesh) -> PreciseSurface<DoubleDouble> {
    let faces: Vec<_> = mesh.faces().collect();
    let triangles = faces
        .iter()
        .map(|&f| mesh.face_vertices(f).map(VertexId::raw));
    let triangles: Vec<_> = triangles.collect();
    if mesh.positions().is_empty() {
        let lengths = faces
            .iter()
            .map(|f| [0, 1, 2].map(|k| DoubleDouble::new(mesh.length(f.half_edge(k)))));
        let lengths: Vec<_> = lengths.collect();
        return PreciseSurface::from_lengths(mesh.vertex_count(), &triangles, &lengths);
    }
    PreciseSurface::from_positions(mesh.positions(), &triangles)
}

/// Judges a path from one of `sources` to `target`, at distance `d`.
pub(crate) fn judge(
    surface: &PreciseSurface<DoubleDouble>,
    path: &Path,
    sources: &[u32],
    target: VertexId,
    d: f64,
) -> Result<(), PathFlaw> {
    let points = judged_points(path);
    judge_path(surface, &points, sources, target.raw(), [d, path.length])
}

/// The points of a path. None may be inside a face.
pub(crate) fn judged_points(path: &Path) -> Vec<JudgedPoint> {
    let points = path.points.iter().map(|point| match point.place {
        PathPlace::Vertex(v) => JudgedPoint::Vertex(v.raw()),
        PathPlace::Edge { ends, t } => JudgedPoint::Edge {
            triangle: point.face.expect("an edge has a face").raw(),
            ends: ends.map(VertexId::raw),
            t,
        },
        PathPlace::Face => panic!("{point:?} is inside a face"),
    });
    points.collect()
}
