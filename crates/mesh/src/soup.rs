//! What a file or a generator delivers, before anything about it is known to be right.

/// Vertex positions and triangles, unchecked.
///
/// The position of vertex `i` stands at place `i`, in the numbering of the file it came from.
/// Triangles may name vertices that do not exist, repeat themselves, or meet in any way:
/// [`Mesh::from_soup`](crate::Mesh::from_soup) finds out and says so.
///
/// ```
/// use geobench_mesh::TriangleSoup;
/// use geobench_mesh::io::{Format, read_bytes};
///
/// let text = b"v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\n";
/// let soup: TriangleSoup = read_bytes(text, Format::Obj, "square.obj".as_ref())?;
/// assert_eq!(soup.triangles, [[0, 1, 2], [0, 2, 3]]);
/// assert_eq!(soup.file_face(1), 0); // Both are of the first face of the file.
/// # Ok::<(), geobench_mesh::io::ReadError>(())
/// ```
#[derive(Clone, Debug, Default, PartialEq)]
pub struct TriangleSoup {
    /// Coordinates of each vertex, in the model's own units.
    pub positions: Vec<[f64; 3]>,
    /// The three vertices of each triangle, as places in `positions`.
    pub triangles: Vec<[u32; 3]>,
    /// For each triangle the number of the file's face it was cut from, where some face had more
    /// than three corners; empty when triangles and the file's faces are the same.
    pub file_faces: Vec<u32>,
    /// The file's faces with fewer than three corners, which have no triangle.
    pub short_faces: Vec<u32>,
}

impl TriangleSoup {
    /// A soup whose triangles are the file's own faces.
    pub fn new(positions: Vec<[f64; 3]>, triangles: Vec<[u32; 3]>) -> Self {
        Self {
            positions,
            triangles,
            file_faces: Vec::new(),
            short_faces: Vec::new(),
        }
    }

    /// The number of the file's face from which triangle `triangle` was cut.
    pub fn file_face(&self, triangle: u32) -> u32 {
        self.file_faces
            .get(triangle as usize)
            .copied()
            .unwrap_or(triangle)
    }
}
