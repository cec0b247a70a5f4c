//! Triangles from a file or a generator, unchecked.

use crate::defect::Defect;

/// Vertex positions and triangles, unchecked.
///
/// `positions[i]` is the position of vertex `i` of the file. Triangles may name vertices that do
/// not exist, repeat each other, or meet in any way: [`Mesh::from_soup`](crate::Mesh::from_soup)
/// reports it.
///
/// ```
/// use geobench_mesh::{Mesh, TriangleSoup};
///
/// let corners = vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
/// let soup = TriangleSoup::new(corners, vec![[0, 1, 7]]);
/// let error = Mesh::from_soup(soup).unwrap_err();
/// assert!(error.to_string().contains("names a vertex that does not exist"));
/// ```
#[derive(Clone, Debug, Default, PartialEq)]
pub struct TriangleSoup {
    /// Coordinates of each vertex, in the model's own units.
    pub positions: Vec<[f64; 3]>,
    /// The three vertices of each triangle, as indices of `positions`.
    pub triangles: Vec<[u32; 3]>,
    /// For each triangle, the number of the face in the file from which it was cut. Empty if every
    /// face of the file is a triangle.
    pub file_faces: Vec<u32>,
    /// Vertices that were [welded](Self::weld) to another one, each with that one, in ascending
    /// order. They are in no triangle.
    pub copies: Vec<[u32; 2]>,
    /// What reading has left out or filled in, all [noted](crate::Severity::Noted).
    pub notes: Vec<Defect>,
}

impl TriangleSoup {
    /// A soup whose triangles are the faces of the file.
    pub fn new(positions: Vec<[f64; 3]>, triangles: Vec<[u32; 3]>) -> Self {
        Self {
            positions,
            triangles,
            file_faces: Vec::new(),
            copies: Vec::new(),
            notes: Vec::new(),
        }
    }

    /// The number of the face in the file from which triangle `triangle` was cut.
    pub fn file_face(&self, triangle: u32) -> u32 {
        self.file_faces
            .get(triangle as usize)
            .copied()
            .unwrap_or(triangle)
    }
}
