//! Paths on a refined mesh, mapped to the original mesh.

use geobench_mesh::{Mesh, Refined, SurfacePoint};

use crate::path::{Path, PathPlace, Point};

impl Path {
    /// Maps this path on `refined` to `mesh`. `refined` must be the result of [`Mesh::with_points`]
    /// for `mesh` and `points`. Crossings of edges that `mesh` does not have are left out. The ends
    /// may lie on edges and inside faces of `mesh`.
    ///
    /// ```
    /// use geobench_mesh::{FaceId, Mesh};
    /// use geobench_paths::{Paths, PathPlace};
    /// use geobench_vtp::VtpFast;
    /// use geobench_window::Goal;
    ///
    /// // From the middle of the first face to that of an edge.
    /// let mesh = Mesh::generate("grid,n=4")?;
    /// let source = mesh.point_in_face(FaceId::new(0), [0.25, 0.25, 0.5])?;
    /// let target = mesh.point_on_edge([12.into(), 13.into()], 0.5)?;
    /// let points = [source, target];
    /// let refined = mesh.with_points(&points)?;
    /// let [from, to] = [refined.vertices[0], refined.vertices[1]];
    /// let mut solver = VtpFast::new(&refined.mesh);
    /// let paths = Paths::find(&mut solver, &refined.mesh, from, &Goal::targets([to]))?;
    /// let path = paths.to(to)?.expect("the grid is in one piece");
    /// let path = path.of_original(&mesh, &refined, &points);
    /// assert_eq!(path.points[0].face, Some(FaceId::new(0)));
    /// assert!(matches!(path.points.last().unwrap().place, PathPlace::Edge { t: 0.5, .. }));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    #[must_use]
    pub fn of_original(&self, mesh: &Mesh, refined: &Refined, points: &[SurfacePoint]) -> Self {
        let onto = OriginalMapper {
            mesh,
            refined,
            points,
        };
        let last = self.points.len().saturating_sub(1);
        let told = self.points.iter().enumerate().filter_map(|(i, point)| {
            let point = onto.point(point);
            (i == 0 || i == last || point.place != PathPlace::Face).then_some(point)
        });
        Self {
            length: self.length,
            points: told.collect(),
        }
    }
}

struct OriginalMapper<'a> {
    mesh: &'a Mesh,
    refined: &'a Refined,
    points: &'a [SurfacePoint],
}

impl OriginalMapper<'_> {
    fn point(&self, point: &Point) -> Point {
        let Some(face) = point.face else {
            return *point;
        };
        let parent = self.refined.parent(face);
        let weights = point.barycentric;
        let barycentric = (self.refined).in_parent(self.mesh, self.points, face, weights);
        let positive = (0..3).filter(|&k| barycentric[k] > 0.0);
        let place = match positive.collect::<Vec<_>>()[..] {
            [k] => PathPlace::Vertex(self.mesh.face_vertices(parent)[k]),
            [a, b] => {
                let corners = self.mesh.face_vertices(parent);
                PathPlace::Edge {
                    ends: [corners[a], corners[b]],
                    t: barycentric[b] / (barycentric[a] + barycentric[b]),
                }
            }
            _ => PathPlace::Face,
        };
        Point {
            place,
            face: Some(parent),
            barycentric,
        }
    }
}
