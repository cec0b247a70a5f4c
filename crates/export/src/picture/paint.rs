//! Colours of faces and of parts of faces.

use std::collections::HashMap;

use geobench_mesh::{FaceId, Mesh};
use geobench_voronoi::{Diagram, NO_SOURCE};

use crate::diagrams::{POINTS_PER_ARC, colour};

/// A triangle within a face, by the barycentric coordinates of its corners, and its colour.
type ColouredTriangle = ([[f64; 3]; 3], [u8; 3]);

/// The colours of the faces of a mesh, which replace the colours of distances.
#[derive(Clone, Debug)]
pub struct Paint {
    /// The colour of each face.
    faces: Vec<[u8; 3]>,
    /// The coloured triangles of each face that has several colours.
    parts: HashMap<FaceId, Vec<ColouredTriangle>>,
}

impl Paint {
    /// One colour for all faces of `mesh`.
    pub fn plain(mesh: &Mesh, colour: [u8; 3]) -> Self {
        Self {
            faces: vec![colour; mesh.face_count()],
            parts: HashMap::new(),
        }
    }

    /// A colour for each cell of `diagram`.
    pub fn cells(diagram: &Diagram) -> Self {
        let faces = diagram.mesh().faces();
        let faces = faces.map(|face| colour(diagram.cell_of_face(face).unwrap_or(NO_SOURCE)));
        let mut parts: HashMap<FaceId, Vec<ColouredTriangle>> = HashMap::new();
        for part in diagram.parts(POINTS_PER_ARC) {
            let outline = part.outline.iter();
            let outline: Vec<[f64; 3]> = outline
                .map(|&place| diagram.barycentric(part.face, place))
                .collect();
            let triangles = part.triangles().into_iter();
            let triangles =
                triangles.map(|corners| (corners.map(|i| outline[i]), colour(part.source)));
            parts.entry(part.face).or_default().extend(triangles);
        }
        Self {
            faces: faces.collect(),
            parts,
        }
    }

    pub(super) fn of_face(&self, face: FaceId) -> Option<[u8; 3]> {
        self.faces.get(face.index()).copied()
    }

    /// The coloured triangles of a face, if it has several colours.
    pub(super) fn parts(&self, face: FaceId) -> Option<&[ColouredTriangle]> {
        self.parts.get(&face).map(Vec::as_slice)
    }
}
