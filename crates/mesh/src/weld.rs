//! Welding: vertices at one place become one vertex.

use std::collections::HashMap;
use std::fmt;
use std::hash::{BuildHasher, RandomState};
use std::str::FromStr;

use crate::defect::Defect;
use crate::disjoint_sets::DisjointSets;
use crate::edges::EdgeGroups;
use crate::ids::VertexId;
use crate::inspection::component_sizes;
use crate::mesh::{Mesh, bounding_box_of, diagonal_of};
use crate::soup::TriangleSoup;

/// Distances of vertices, as fractions of the diagonal, up to which [`Defect::CoincidentVertices`]
/// counts them: the rounding of numbers with seven, six and five digits. The first counts always,
/// the others if they close more of the boundary and collapse no further face.
const NEAR: [f64; 3] = [1e-7, 1e-6, 1e-5];

/// Side of the cells of the grid in radii. Most balls then touch few cells, and few vertices that
/// are farther apart than the radius fit into one.
const CELL: f64 = 4.0;

/// Which vertices are welded: those at exactly one place, or those within a tolerance.
///
/// ```
/// use geobench_mesh::{Mesh, MeshMeasures, TriangleSoup, Weld};
///
/// // Two triangles that share no vertex. Their common edge is given twice.
/// let (a, b) = ([0.0, 0.0, 0.0], [1.0, 1.0, 0.0]);
/// let places = vec![a, [1.0, 0.0, 0.0], b, a, b, [0.0, 1.0, 0.0]];
/// let mut soup = TriangleSoup::new(places, vec![[0, 1, 2], [3, 4, 5]]);
/// soup.weld(Weld::COINCIDENT);
/// let (mesh, _) = Mesh::from_soup(soup)?;
/// assert_eq!(mesh.kept_vertex(3.into()), 0.into());
/// assert_eq!(MeshMeasures::of(&mesh).boundary_edges, 4);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Weld(f64);

/// The tolerance of a weld is not a number from 0 to 0.1.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("the tolerance of a weld is a fraction of the size of the model, from 0 to 0.1")]
pub struct WeldError;

impl Weld {
    /// Vertices at exactly one place.
    pub const COINCIDENT: Self = Self(0.0);

    /// Vertices within `tolerance`, a fraction of the diagonal of the bounding box; 0 for vertices
    /// at exactly one place.
    ///
    /// # Errors
    ///
    /// If the tolerance is not from 0 to 0.1.
    pub fn within(tolerance: f64) -> Result<Self, WeldError> {
        if (0.0..=0.1).contains(&tolerance) {
            Ok(Self(tolerance))
        } else {
            Err(WeldError)
        }
    }

    /// The tolerance as a fraction of the diagonal of the bounding box.
    pub const fn tolerance(self) -> f64 {
        self.0
    }

    /// The vertices that a lower one gathers, each with that one, in ascending order.
    pub(crate) fn copies(self, positions: &[[f64; 3]]) -> Vec<[u32; 2]> {
        copies_within(positions, 0..positions.len() as u32, self.0)
    }
}

impl FromStr for Weld {
    type Err = WeldError;

    fn from_str(text: &str) -> Result<Self, WeldError> {
        Self::within(text.parse().map_err(|_| WeldError)?)
    }
}

impl fmt::Display for Weld {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{:?}", self.0)
    }
}

impl TriangleSoup {
    /// Welds vertices: in the order of their numbers, each that no other has gathered gathers those
    /// that lie within the tolerance of it. The triangles then name it instead of its copies, and
    /// it keeps its place. Vertices keep their numbers, and the copies are in no triangle. O(n).
    pub fn weld(&mut self, weld: Weld) {
        // Of an earlier weld, the copies are in no triangle.
        let is_copy = |v: &u32| self.copies.binary_search_by_key(v, |copy| copy[0]).is_ok();
        let candidates = (0..self.positions.len() as u32).filter(|v| !is_copy(v));
        let copies = copies_within(&self.positions, candidates, weld.0);
        self.merge(copies);
    }

    /// Replaces vertices in all triangles: each of `copies`, none of them one already, by the lower
    /// one beside it.
    pub(crate) fn merge(&mut self, copies: Vec<[u32; 2]>) {
        if copies.is_empty() {
            return;
        }
        let kept = kept_vertices(self.positions.len(), &copies);
        let kept_of = |v: &mut u32| *v = kept.get(*v as usize).copied().unwrap_or(*v);
        self.triangles
            .as_flattened_mut()
            .iter_mut()
            .for_each(kept_of);
        self.copies.iter_mut().for_each(|[_, v]| kept_of(v));
        self.copies.extend(copies);
        self.copies.sort_unstable();
    }

    /// Welds the ends of edges of no length, since no mesh has such edges. A note names each.
    pub(crate) fn merge_ends_of_null_edges(&mut self) {
        let triangles = self.triangles.iter().zip(0..);
        let sides = triangles.flat_map(|(&[a, b, c], t)| {
            [[a, b], [b, c], [c, a]].map(|ends| (ends, self.file_face(t)))
        });
        let null = null_sides(&self.positions, sides);
        self.merge_ends(null);
    }

    /// Welds the ends of the given sides, all of no length and with the face that each is from. A
    /// note names each edge.
    pub(crate) fn merge_ends(&mut self, mut sides: Vec<([u32; 2], u32)>) {
        if sides.is_empty() {
            return;
        }
        sides.sort_unstable();
        sides.dedup();
        let mut places = DisjointSets::new(self.positions.len());
        for edge in sides.chunk_by(|x, y| x.0 == y.0) {
            let [low, high] = edge[0].0;
            places.union(low, high);
            self.notes.push(Defect::ZeroLengthEdge {
                vertices: [low, high],
                faces: edge.iter().map(|side| side.1).collect(),
            });
        }
        let all = 0..self.positions.len() as u32;
        let copies = all.map(|v| [v, places.find(v)]);
        self.merge(copies.filter(|[v, kept]| v != kept).collect());
    }
}

/// Of sides of faces those of no length, with the lower vertex first.
pub(crate) fn null_sides(
    positions: &[[f64; 3]],
    sides: impl Iterator<Item = ([u32; 2], u32)>,
) -> Vec<([u32; 2], u32)> {
    let is_null = |&([from, to], _): &([u32; 2], u32)| {
        let [p, q] = [from, to].map(|v| positions.get(v as usize));
        from != to && p.is_some() && p == q
    };
    let null = sides.filter(is_null);
    null.map(|([from, to], face)| ([from.min(to), from.max(to)], face))
        .collect()
}

/// For each vertex the one that stands for it, which may be itself.
pub(crate) fn kept_vertices(vertex_count: usize, copies: &[[u32; 2]]) -> Vec<u32> {
    let mut kept: Vec<u32> = (0..vertex_count as u32).collect();
    for &[copy, first] in copies {
        kept[copy as usize] = first;
    }
    kept
}

/// What welding would join in a mesh that has a boundary or several components; `None` if no
/// vertices lie at one place.
pub(crate) fn coincident_vertices(mesh: &Mesh, is_connected: bool) -> Option<Defect> {
    let positions = mesh.positions();
    let boundary = || mesh.vertices().filter(|&v| mesh.is_boundary(v));
    let copies_of = |vertices: &mut dyn Iterator<Item = VertexId>, tolerance| {
        copies_within(positions, vertices.map(VertexId::raw), tolerance)
    };
    let copies = |tolerance| {
        if is_connected {
            copies_of(&mut boundary(), tolerance)
        } else {
            let in_faces = |v: &VertexId| !mesh.outgoing(*v).is_empty();
            copies_of(&mut mesh.vertices().filter(in_faces), tolerance)
        }
    };
    let trial = |tolerance, copies: &[[u32; 2]]| {
        let triangles = mesh
            .faces()
            .map(|f| mesh.face_vertices(f).map(VertexId::raw));
        WeldTrial::new(tolerance, copies, positions.len(), triangles)
    };
    let [near, larger @ ..] = NEAR;
    let found = copies(near);
    let mut best = (!found.is_empty()).then(|| trial(near, &found));
    let open = mesh.half_edges().filter(|&h| mesh.twin(h).is_none());
    let mut open = best
        .as_ref()
        .map_or(open.count() as u32, |best| best.boundary_edges);
    for tolerance in larger {
        let found = copies_of(&mut boundary(), tolerance);
        if open == 0 || found.len() <= best.as_ref().map_or(0, |best| best.copies) {
            continue;
        }
        let faces = best
            .as_ref()
            .map_or(mesh.face_count(), |best| best.triangles.len());
        let wider = trial(tolerance, &found);
        if wider.boundary_edges < open && wider.triangles.len() == faces {
            open = wider.boundary_edges;
            best = Some(wider);
        }
    }
    let best = best?;
    let exact = copies(0.0).len();
    Some(Defect::CoincidentVertices {
        exact: exact as u32,
        near: best.copies.saturating_sub(exact) as u32,
        tolerance: best.tolerance,
        components: component_sizes(positions.len(), &best.triangles).len() as u32,
        boundary_edges: best.boundary_edges,
        non_manifold_edges: best.non_manifold_edges,
    })
}

/// What welding would make of a mesh.
struct WeldTrial {
    tolerance: f64,
    /// The number of copies.
    copies: usize,
    triangles: Vec<[u32; 3]>,
    boundary_edges: u32,
    non_manifold_edges: u32,
}

impl WeldTrial {
    fn new(
        tolerance: f64,
        copies: &[[u32; 2]],
        vertex_count: usize,
        triangles: impl Iterator<Item = [u32; 3]>,
    ) -> Self {
        let kept = kept_vertices(vertex_count, copies);
        let welded = triangles.map(|t| t.map(|v| kept[v as usize]));
        let welded: Vec<[u32; 3]> = welded
            .filter(|&[a, b, c]| a != b && b != c && c != a)
            .collect();
        let edges = EdgeGroups::new(vertex_count, &welded);
        let of_faces = |wanted: fn(usize) -> bool| {
            let found = edges.iter().filter(|edge| wanted(edge.side_count()));
            found.count() as u32
        };
        Self {
            tolerance,
            copies: copies.len(),
            boundary_edges: of_faces(|sides| sides == 1),
            non_manifold_edges: of_faces(|sides| sides > 2),
            triangles: welded,
        }
    }
}

/// The vertices among `candidates`, which ascend, that a lower one gathers, each with that one.
/// `tolerance` is a fraction of the diagonal of all positions.
fn copies_within(
    positions: &[[f64; 3]],
    candidates: impl Iterator<Item = u32>,
    tolerance: f64,
) -> Vec<[u32; 2]> {
    let place = |v: u32| positions[v as usize];
    let candidates = candidates.filter(|&v| place(v).iter().all(|x| x.is_finite()));
    let is_finite = |p: &&[f64; 3]| p.iter().all(|x| x.is_finite());
    let bounds = bounding_box_of(positions.iter().filter(is_finite));
    let radius = tolerance * bounds.map_or(0.0, diagonal_of);
    let mut copies = Vec::new();
    let (Some([low, _]), true) = (bounds, radius > 0.0 && radius.is_finite()) else {
        let mut known = PlaceTable::with_capacity(positions.len());
        for v in candidates {
            let first = known.find_or_insert(place(v), v, positions);
            if first != v {
                copies.push([v, first]);
            }
        }
        return copies;
    };
    // Of the vertices in a cell `first` has the last one, and `before` leads from each to another.
    let mut first: HashMap<[i64; 3], u32> = HashMap::new();
    let mut before: HashMap<u32, u32> = HashMap::new();
    // A radius below the rounding of the coordinates would overflow the numbers of cells.
    let side = CELL * radius.max(1e-16 * radius / tolerance);
    for v in candidates {
        let p = place(v);
        let cell = |shift: f64| [0, 1, 2].map(|k| ((p[k] - low[k] + shift) / side).floor() as i64);
        let (least, most) = (cell(-radius), cell(radius));
        let mut gathering: Option<u32> = None;
        for x in least[0]..=most[0] {
            for y in least[1]..=most[1] {
                for z in least[2]..=most[2] {
                    let mut kept = first.get(&[x, y, z]).copied();
                    while let Some(u) = kept {
                        if diagonal_of([p, place(u)]) <= radius {
                            gathering = Some(gathering.map_or(u, |known| known.min(u)));
                        }
                        kept = before.get(&u).copied();
                    }
                }
            }
        }
        if let Some(kept) = gathering {
            copies.push([v, kept]);
        } else if let Some(other) = first.insert(cell(0.0), v) {
            before.insert(v, other);
        }
    }
    copies
}

/// Finds vertices by their coordinates, where -0 equals 0. A hash table with open addressing.
pub(crate) struct PlaceTable {
    /// Vertex numbers or [`EMPTY`]. The number of slots is a power of two, and at least twice the
    /// number of vertices.
    slots: Vec<u32>,
    vertices: usize,
    /// A random key of the hash, so that no file can be made whose vertices all collide.
    key: u64,
}

/// A slot without a vertex.
const EMPTY: u32 = u32::MAX;

impl PlaceTable {
    pub(crate) fn with_capacity(vertices: usize) -> Self {
        Self {
            slots: vec![EMPTY; (2 * vertices).next_power_of_two()],
            vertices: 0,
            key: RandomState::new().hash_one(0),
        }
    }

    /// The vertex of the table at `place`; if there is none, enters `vertex`. `positions` has the
    /// places of all vertices of the table.
    pub(crate) fn find_or_insert(
        &mut self,
        place: [f64; 3],
        vertex: u32,
        positions: &[[f64; 3]],
    ) -> u32 {
        if 2 * (self.vertices + 1) > self.slots.len() {
            let larger = vec![EMPTY; 2 * self.slots.len()];
            let known = std::mem::replace(&mut self.slots, larger);
            for vertex in known.into_iter().filter(|&vertex| vertex != EMPTY) {
                let slot = self.slot(positions[vertex as usize], positions);
                self.slots[slot] = vertex;
            }
        }
        let slot = self.slot(place, positions);
        if self.slots[slot] == EMPTY {
            self.slots[slot] = vertex;
            self.vertices += 1;
        }
        self.slots[slot]
    }

    /// The slot of the vertex at `place`, or the empty slot where it belongs.
    fn slot(&self, place: [f64; 3], positions: &[[f64; 3]]) -> usize {
        // Adding 0 turns -0 into 0 and changes nothing else.
        let bits_of = |place: [f64; 3]| place.map(|x| (x + 0.0).to_bits());
        let bits = bits_of(place);
        let is_other = |&slot: &usize| {
            let vertex = self.slots[slot];
            vertex != EMPTY && bits_of(positions[vertex as usize]) != bits
        };
        let hash = bits.iter().fold(self.key, |hash, bits| {
            let product = u128::from(hash ^ bits) * 0x9e37_79b9_7f4a_7c15;
            (product >> 64) as u64 ^ product as u64
        });
        let mask = self.slots.len() - 1;
        let mut slots = (0..).map(|step| (hash as usize + step) & mask);
        slots.find(|slot| !is_other(slot)).unwrap_or(0)
    }
}
