//! Paths on a refined mesh, mapped to the original mesh.

use geobench_mesh::Refined;

use crate::path::{Path, PathPlace, Point};

impl Path {
    /// Maps this path on `refined` to the [original](Refined::original) mesh. Crossings of edges
    /// that the original does not have are left out. The ends may lie on its edges and inside its
    /// faces. O(points).
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
    /// let refined = mesh.with_points(&[source, target])?;
    /// let [from, to] = [refined.vertices[0], refined.vertices[1]];
    /// let mut solver = VtpFast::new(&refined.mesh);
    /// let paths = Paths::find(&mut solver, &refined.mesh, from, &Goal::targets([to]))?;
    /// let path = paths.to(to)?.expect("the grid is in one piece");
    /// let path = path.of_original(&refined);
    /// assert_eq!(path.points[0].face, Some(FaceId::new(0)));
    /// assert!(matches!(path.points.last().unwrap().place, PathPlace::Edge { t: 0.5, .. }));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Panics
    ///
    /// If a face of the path is not one of the refined mesh.
    #[must_use]
    pub fn of_original(&self, refined: &Refined) -> Self {
        let last = self.points.len().saturating_sub(1);
        let told = self.points.iter().enumerate().filter_map(|(i, point)| {
            let point = of_original(refined, point);
            (i == 0 || i == last || point.place != PathPlace::Face).then_some(point)
        });
        Self {
            length: self.length,
            points: told.collect(),
        }
    }
}

/// Maps a point of `refined` to the original mesh.
fn of_original(refined: &Refined, point: &Point) -> Point {
    let Some(face) = point.face else {
        return *point;
    };
    let parent = refined.parent(face);
    let barycentric = refined.in_parent(face, point.barycentric);
    let corners = refined.original().face_vertices(parent);
    let positive = (0..3).filter(|&k| barycentric[k] > 0.0);
    let place = match positive.collect::<Vec<_>>()[..] {
        [k] => PathPlace::Vertex(corners[k]),
        [a, b] => PathPlace::Edge {
            ends: [corners[a], corners[b]],
            t: barycentric[b] / (barycentric[a] + barycentric[b]),
        },
        _ => PathPlace::Face,
    };
    Point {
        place,
        face: Some(parent),
        barycentric,
    }
}
