//! Logarithmic maps: vertices by the direction and the length of the shortest paths to them.

use std::f64::consts::TAU;

use geobench_mesh::{HalfEdgeId, Mesh, Place, Refined, SurfacePoint};

use crate::path::{Path, PathPlace, Point};
use crate::straightest::{Sector, sectors};
use crate::trace::Paths;

impl Paths {
    /// The logarithmic map at `source`: for each vertex of the original mesh of `refined` the point
    /// of the plane at its distance and in the direction in which its path starts. The paths must
    /// come from a run on `refined` from `source` alone.
    ///
    /// Directions are angles from an axis, counter-clockwise. At a vertex the axis is the first of
    /// its [outgoing half-edges](Mesh::outgoing), and angles are normalised (Polthier and Schmies
    /// 1998): multiplied by 2π over the total angle. On the boundary they stay as they are, so that
    /// the map of a flat surface is a motion. On an edge the axis is its half-edge with the lower
    /// number, in a face its first side.
    ///
    /// Of several shortest paths to a vertex, one counts. Unreachable vertices are at NaN.
    ///
    /// O(faces crossed by the last lines of all paths).
    ///
    /// ```
    /// use geobench_mesh::{Mesh, SurfacePoint};
    /// use geobench_paths::Paths;
    /// use geobench_vtp::VtpFast;
    /// use geobench_window::Goal;
    ///
    /// let mesh = Mesh::generate("grid,n=4")?;
    /// let source = mesh.point_in_face(0.into(), [0.2, 0.3, 0.5])?;
    /// let refined = mesh.with_points(&[source])?;
    /// let mut solver = VtpFast::new(&refined.mesh);
    /// let sources = &refined.vertices;
    /// let paths = Paths::find(&mut solver, &refined.mesh, sources, &Goal::everything())?;
    /// let map = paths.log_map(&source, &refined);
    /// // The grid is flat, so distances in the map are those in space.
    /// let apart = |v: usize, w: usize| (map[v][0] - map[w][0]).hypot(map[v][1] - map[w][1]);
    /// assert!((apart(0, 4) - 4.0).abs() < 1e-12 && (apart(0, 24) - 32.0_f64.sqrt()).abs() < 1e-12);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn log_map(&self, source: &SurfacePoint, refined: &Refined) -> Vec<[f64; 2]> {
        let mesh = refined.original();
        let sectors = sectors(mesh, source);
        let all: f64 = sectors.iter().filter_map(|sector| sector.angle).sum();
        let is_normalised = match source.place() {
            Place::Vertex(v) => !mesh.is_boundary(mesh.kept_vertex(v)),
            _ => false,
        };
        let unit = if is_normalised { TAU / all } else { 1.0 };
        let is_refined = refined.mesh.vertex_count() > mesh.vertex_count();
        let start = |line: &Path| {
            let original = is_refined.then(|| line.of_original(refined));
            let line = original.as_ref().unwrap_or(line);
            let mut points = line.points.iter().skip(1);
            points.find_map(|point| angle_to(mesh, &sectors, point))
        };
        let root = refined.vertices[0];
        // `None` at the source.
        let angles = self.along_lines(
            |v| (v != root).then_some(f64::NAN),
            |before, line| {
                Some(before.unwrap_or_else(|| start(line).map_or(f64::NAN, |a| unit * a)))
            },
        );
        let mut map = Vec::with_capacity(mesh.vertex_count());
        for (angle, &d) in angles
            .iter()
            .zip(self.distances())
            .take(mesh.vertex_count())
        {
            map.push(match angle {
                Some(Some(angle)) => [d * libm::cos(*angle), d * libm::sin(*angle)],
                Some(None) => [0.0; 2],
                None => [f64::NAN; 2],
            });
        }
        map
    }
}

/// The angle of the direction to `point`, from the first direction of the first of the `sectors`
/// on; `None` if it is in none of them, or at their tip.
fn angle_to(mesh: &Mesh, sectors: &[Sector], point: &Point) -> Option<f64> {
    let mut before = 0.0;
    for sector in sectors {
        let to = place_in(mesh, sector.h, point);
        let [x, y] = to.map_or([0.0; 2], |to| [0, 1].map(|k| to[k] - sector.from[k]));
        if x != 0.0 || y != 0.0 {
            return Some(match sector.angle {
                // Rounding may put a point of a side beside it.
                Some(angle) => before + libm::atan2(y.max(0.0), x).clamp(0.0, angle),
                None => libm::atan2(y, x),
            });
        }
        before += sector.angle.unwrap_or(0.0);
    }
    None
}

/// The place of a point of the face of `h` in the frame of `h`; `None` if it is not in this face.
fn place_in(mesh: &Mesh, h: HalfEdgeId, point: &Point) -> Option<[f64; 2]> {
    let sides = [h, h.next(), h.prev()];
    let corner_of = |v| (0..3).find(|&k| mesh.tail(sides[k]) == v);
    let mut weights = [0.0; 3];
    match point.place {
        PathPlace::Vertex(v) => weights[corner_of(v)?] = 1.0,
        PathPlace::Edge { ends: [a, b], t } => {
            let corners = [corner_of(a)?, corner_of(b)?];
            weights[corners[0]] = 1.0 - t;
            weights[corners[1]] = t;
        }
        PathPlace::Face if point.face == Some(h.face()) => {
            weights = sides.map(|side| point.barycentric[side.corner() as usize]);
        }
        PathPlace::Face => return None,
    }
    let apex = mesh.apex(h);
    Some([
        weights[1] * mesh.length(h) + weights[2] * apex[0],
        weights[2] * apex[1],
    ])
}

#[cfg(test)]
mod tests {
    use geobench_mesh::VertexId;
    use geobench_vtp::VtpFast;
    use geobench_window::Goal;

    use super::*;
    use crate::straightest::line_at;

    /// The paths and the map from a point.
    fn of(mesh: &Mesh, source: &SurfacePoint) -> (Paths, Vec<[f64; 2]>) {
        let refined = mesh.with_points(std::slice::from_ref(source)).unwrap();
        let mut solver = VtpFast::new(&refined.mesh);
        let goal = Goal::everything();
        let paths = Paths::find(&mut solver, &refined.mesh, &refined.vertices, &goal).unwrap();
        let map = paths.log_map(source, &refined);
        (paths, map)
    }

    /// A vertex, a point on an edge and one in a face.
    fn sources(mesh: &Mesh, v: u32, face: u32) -> [SurfacePoint; 3] {
        let [a, b, _] = mesh.face_vertices(face.into());
        [
            v.into(),
            mesh.point_on_edge([a, b], 0.3).unwrap(),
            mesh.point_in_face(face.into(), [0.2, 0.5, 0.3]).unwrap(),
        ]
    }

    /// Asserts that one rotation of the plane takes the places of the vertices to the map.
    fn assert_turned(map: &[[f64; 2]], places: &[Option<[f64; 2]>], what: &str) {
        let mut turn = None;
        for (v, (at, place)) in map.iter().zip(places).enumerate() {
            let Some([x, y]) = *place else {
                continue;
            };
            let size = x * x + y * y;
            if size < 1e-18 {
                assert!(at[0].hypot(at[1]) < 1e-9, "{what}, {v}");
                continue;
            }
            let by = [at[0] * x + at[1] * y, at[1] * x - at[0] * y].map(|part| part / size);
            let [c, s] = *turn.get_or_insert(by);
            assert!(
                (by[0] - c).abs() < 1e-9 && (by[1] - s).abs() < 1e-9,
                "{what}, {v}"
            );
            assert!((c.hypot(s) - 1.0).abs() < 1e-9, "{what}");
        }
    }

    #[test]
    fn the_map_of_the_plane_is_a_motion() {
        let grid = Mesh::generate("grid,n=10,jitter=0.2,seed=4").unwrap();
        // A vertex of the boundary as well.
        for source in sources(&grid, 60, 77)
            .into_iter()
            .chain([5.into(), 0.into()])
        {
            let [x, y, _] = grid.position_of(&source).unwrap();
            let places = grid.positions().iter();
            let places: Vec<_> = places.map(|p| Some([p[0] - x, p[1] - y])).collect();
            assert_turned(&of(&grid, &source).1, &places, &format!("{source:?}"));
        }
    }

    #[test]
    fn the_map_of_a_cylinder_unrolls_it() {
        let cylinder = Mesh::generate("cylinder,slices=24,stacks=9,height=3").unwrap();
        let around = |p: [f64; 3]| {
            // The polygon of the slices, unrolled: the side is straight within a slice.
            let (slice, side) = (TAU / 24.0, 2.0 * (TAU / 48.0).sin());
            let angle = libm::atan2(p[1], p[0]).rem_euclid(TAU);
            let within = (angle / slice).floor();
            let start = [(within * slice).cos(), (within * slice).sin()];
            within * side + (p[0] - start[0]).hypot(p[1] - start[1])
        };
        let round = 48.0 * (TAU / 48.0).sin();
        for source in sources(&cylinder, 100, 200) {
            let from = cylinder.position_of(&source).unwrap();
            let places = cylinder.positions().iter().map(|&p| {
                let turn = (around(p) - around(from)).rem_euclid(round);
                let way = if turn > 0.5 * round {
                    turn - round
                } else {
                    turn
                };
                // On the other side there are two shortest paths.
                (way.abs() < 0.499 * round).then_some([way, p[2] - from[2]])
            });
            let places: Vec<_> = places.collect();
            assert_turned(&of(&cylinder, &source).1, &places, &format!("{source:?}"));
        }
    }

    #[test]
    fn the_tip_of_a_cone_has_normalised_angles() {
        for angle in [60, 180, 300] {
            let spec = format!("cone,angle={angle},slices=20,stacks=6");
            let cone = Mesh::generate(&spec).unwrap();
            let tip = VertexId::new(0);
            let (paths, map) = of(&cone, &tip.into());
            let places = cone.positions().iter().enumerate().map(|(v, p)| {
                let round = libm::atan2(p[1], p[0]);
                let d = paths.distances()[v];
                Some([d * round.cos(), d * round.sin()])
            });
            let places: Vec<_> = places.collect();
            // Vertices are at equal angles around the axis, and so in the map.
            assert_turned(&map, &places, &spec);
        }
    }

    #[test]
    fn lines_in_the_directions_of_the_map_end_at_the_vertices() {
        for spec in [
            "sphere,subdiv=3",
            "torus,faces=1500,bump=0.2,seed=3",
            "box,n=3",
        ] {
            let mesh = Mesh::generate(spec).unwrap();
            for source in sources(&mesh, 7, 90) {
                let (paths, map) = of(&mesh, &source);
                let mut lines = 0;
                for v in mesh.vertices() {
                    let path = paths.to(v).unwrap().unwrap();
                    let ([x, y], d) = (map[v.index()], paths.distances()[v.index()]);
                    assert!((libm::hypot(x, y) - d).abs() <= 1e-12 * d);
                    if path.vertices().count() > 2 || path.points.len() < 2 {
                        continue;
                    }
                    let line = line_at(&mesh, &source, libm::atan2(y, x), d).unwrap();
                    let end = line.points.last().unwrap().position(&mesh).unwrap();
                    let expected = mesh.positions()[v.index()];
                    let off = (0..3).map(|k| (end[k] - expected[k]).powi(2)).sum::<f64>();
                    assert!(off.sqrt() < 1e-9, "{spec}, {source:?}, {v:?}: {off}");
                    lines += 1;
                }
                assert!(lines > mesh.vertex_count() / 4, "{spec}: {lines}");
            }
        }
    }

    #[test]
    fn unreachable_vertices_have_no_place() {
        let positions = vec![
            [0.0; 3],
            [1.0, 0.0, 0.0],
            [0.0, 1.0, 0.0],
            [5.0, 0.0, 0.0],
            [6.0, 0.0, 0.0],
            [5.0, 1.0, 0.0],
        ];
        let mesh = Mesh::new(positions, vec![[0, 1, 2], [3, 4, 5]]).unwrap();
        let map = of(&mesh, &0.into()).1;
        assert_eq!(map[0], [0.0; 2]);
        assert!(map[1..3].iter().all(|at| at[0].is_finite()));
        assert!(map[3..].iter().flatten().all(|x| x.is_nan()));
    }
}
