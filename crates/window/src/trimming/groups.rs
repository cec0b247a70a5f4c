//! Groups of thin faces, within which no windows need be stored.

use geobench_mesh::{FaceId, HalfEdgeId, Mesh};

use super::thin::{ThinFaces, longest_side, relative_height};

/// The largest number of faces in a group.
///
/// On prisms of thin quads windows are stored on one of eight long edges, diagonals included. Up to
/// 6 % more of them cross than with every edge stored. Larger groups gain little.
const LARGEST: u8 = 8;

/// Groups are made if at least one face in this many may be in one. A few thin faces, as scans have
/// them, cost next to nothing.
const MANY: usize = 8;

/// Height of a face, relative to its longest side, below which it is in no group.
///
/// A window whose source is within 1e-6 of an edge, in edge lengths, [is near](super::is_near) it,
/// and gaps beside it are closed where it is stored. The corners of faces in groups are ten times
/// as far.
const LEAST: f64 = 1e-5;

/// The edges within groups of thin faces of `mesh`, by half-edge; `None` if there are no groups.
/// O(faces).
///
/// Windows that wind around a needle end where they are stored, if each turn leads over an edge
/// with stored windows. That need not be every edge. Groups are trees of at most [`LARGEST`] faces
/// that share long sides. A window that crosses edges within a group comes to each face of it at
/// most once, so it is stored again after fewer than [`LARGEST`] crossings.
pub(super) fn inner_edges(mesh: &Mesh, thin: &ThinFaces) -> Option<Vec<bool>> {
    let faces = mesh.face_count();
    if MANY * thin.count() < faces {
        return None;
    }
    let may_join: Vec<bool> = mesh
        .faces()
        .map(|face| thin.is_thin(mesh, face) && relative_height(mesh, face.half_edge(0)) >= LEAST)
        .collect();
    if MANY * may_join.iter().filter(|&&may| may).count() < faces {
        return None;
    }
    let is_long = |h: HalfEdgeId| 2.0 * mesh.length(h) >= longest_side(mesh, h);
    let mut groups = Groups::new(faces);
    let mut inner = vec![false; mesh.half_edge_count()];
    for h in mesh.half_edges() {
        if let Some(twin) = mesh.twin(h)
            && [h, twin].iter().all(|h| may_join[h.face().index()])
            && is_long(h)
            && is_long(twin)
            && groups.join(h.face(), twin.face())
        {
            inner[h.index()] = true;
            inner[twin.index()] = true;
        }
    }
    Some(inner)
}

/// Disjoint sets of at most [`LARGEST`] faces.
struct Groups {
    /// For each face another one of its group; the first face of a group has itself.
    ahead: Vec<FaceId>,
    /// The number of faces in the group of each first face.
    size: Vec<u8>,
}

impl Groups {
    fn new(faces: usize) -> Self {
        Self {
            ahead: (0..faces as u32).map(FaceId::new).collect(),
            size: vec![1; faces],
        }
    }

    fn first(&self, mut face: FaceId) -> FaceId {
        while self.ahead[face.index()] != face {
            face = self.ahead[face.index()];
        }
        face
    }

    /// Joins the groups of both faces, unless they are one, or too large together. Returns whether
    /// it did.
    fn join(&mut self, a: FaceId, b: FaceId) -> bool {
        let [a, b] = [a, b].map(|face| self.first(face));
        let size = self.size[a.index()] + self.size[b.index()];
        let joins = a != b && size <= LARGEST;
        if joins {
            self.ahead[b.index()] = a;
            self.size[a.index()] = size;
        }
        joins
    }
}

#[cfg(test)]
mod tests {
    use geobench_mesh::TriangleSoup;

    use super::*;

    /// A tube around the x axis with this many sides, each a quad of two faces.
    fn tube(sides: u32, length: f64) -> Mesh {
        let angle = |i: u32| std::f64::consts::TAU * f64::from(i) / f64::from(sides);
        let ends = [0.0, length].map(|x| {
            (0..sides).map(move |i| {
                let (sin, cos) = angle(i).sin_cos();
                [x, cos, sin]
            })
        });
        let positions = ends.into_iter().flatten().collect();
        let quad = |i: u32| {
            let [a, b] = [i, (i + 1) % sides];
            [[a, b, a + sides], [b, b + sides, a + sides]]
        };
        let soup = TriangleSoup::new(positions, (0..sides).flat_map(quad).collect());
        Mesh::from_soup(soup).expect("a tube is a mesh").0
    }

    fn inner(mesh: &Mesh) -> Option<Vec<bool>> {
        let thin = ThinFaces::of(mesh, mesh.half_edge_count(), HalfEdgeId::index);
        inner_edges(mesh, &thin)
    }

    #[test]
    fn every_eighth_long_edge_around_a_tube_of_thin_quads_is_stored() {
        let mesh = tube(16, 100.0);
        let inner = inner(&mesh).expect("all faces are thin");
        let stored = |h: &HalfEdgeId| !inner[h.index()];
        let long = |h: &HalfEdgeId| mesh.length(*h) > 50.0;
        let inside = |h: &HalfEdgeId| mesh.twin(*h).is_some();
        let around = mesh.half_edges().filter(long).filter(inside);
        // Each edge has two half-edges.
        assert_eq!(around.clone().count(), 64);
        assert_eq!(around.filter(stored).count(), 8);
        let short = mesh.half_edges().filter(|h| !long(h));
        assert!(short.clone().count() == 32 && short.clone().all(|h| stored(&h)));
    }

    /// A group is a tree, so that it does not close around a tube however few sides this has.
    #[test]
    fn each_way_around_leads_over_a_stored_edge() {
        for sides in 3..9 {
            let mesh = tube(sides, 1000.0);
            let inner = inner(&mesh).expect("all faces are thin");
            let edges = inner.iter().filter(|&&inner| inner).count() / 2;
            assert!(edges < 2 * sides as usize, "{sides}");
        }
    }

    #[test]
    fn faces_far_thinner_or_few_thin_ones_are_not_grouped() {
        assert!(inner(&tube(16, 1e5)).is_none());
        assert!(inner(&tube(16, 1.0)).is_none());
    }
}
