//! Counts and sizes of a mesh.

use crate::disjoint_sets::DisjointSets;
use crate::frames::is_flat;
use crate::ids::HalfEdgeId;
use crate::mesh::Mesh;

/// Counts and sizes of a mesh. Lengths are in the model's units.
///
/// ```
/// use geobench_mesh::{Mesh, MeshMeasures};
///
/// let measures = MeshMeasures::of(&Mesh::generate("torus,faces=500")?);
/// assert_eq!((measures.euler_characteristic, measures.genus), (0, 1));
/// assert!(measures.saddles > 0 && measures.boundary_edges == 0);
/// # Ok::<(), geobench_mesh::MeshError>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct MeshMeasures {
    /// Number of vertices, including isolated ones and copies.
    pub vertices: usize,
    /// Triangles.
    pub faces: usize,
    /// Undirected edges.
    pub edges: usize,
    /// Edges with a face on one side only.
    pub boundary_edges: usize,
    /// [Junctions](Mesh::junction): edges with more than two faces, or with two whose half-edges
    /// have the same direction.
    pub junctions: usize,
    /// Boundary loops; a disk has one. Loops that meet at a pinched vertex count separately, unless
    /// the mesh has a [junction](Mesh::junction).
    pub boundary_loops: usize,
    /// Connected components of faces that share vertices.
    pub components: usize,
    /// Vertices in no face, without copies.
    pub isolated_vertices: usize,
    /// Vertices at which several fans meet; those on junctions do not count.
    pub pinched_vertices: usize,
    /// Vertices in faces - edges + faces: 2 for a sphere, 1 for a disk, 0 for a torus.
    pub euler_characteristic: i64,
    /// Number of handles, over all components. Pinched vertices are split, the mesh is cut apart
    /// along its [junctions](Mesh::junction), and holes are closed before handles are counted.
    pub genus: usize,
    /// Vertices at which a shortest path can bend ([`Mesh::is_saddle`]).
    pub saddles: usize,
    /// Faces whose area is indistinguishable from 0.
    pub flat_faces: usize,
    /// Length of the shortest edge; infinite without edges.
    pub min_edge_length: f64,
    /// Mean length of the edges; 0 without edges.
    pub mean_edge_length: f64,
    /// Length of the longest edge; 0 without edges.
    pub max_edge_length: f64,
    /// Sum of the areas of the faces.
    pub area: f64,
    /// Least and greatest x, y and z over all vertices; `None` for a mesh built from lengths.
    pub bounding_box: Option<[[f64; 3]; 2]>,
    /// Mean over the faces of g = P·H / (2·√3·S), where P is half the perimeter, H the longest edge
    /// and S the area (Xu et al. 2015, section 5): 1 if all faces are equilateral, large if they
    /// are slender. Faces without area are left out; 1 if no others exist.
    pub anisotropy: f64,
}

impl MeshMeasures {
    /// Measures `mesh`, in linear time.
    pub fn of(mesh: &Mesh) -> Self {
        let lengths = EdgeLengths::of(mesh);
        let shapes = Shapes::of(mesh);
        let count = |is: fn(&Mesh, crate::VertexId) -> bool| {
            mesh.vertices().filter(|&v| is(mesh, v)).count()
        };
        let isolated_vertices = count(|mesh, v| mesh.outgoing(v).is_empty() && !mesh.is_copy(v));
        let (edges, faces) = (lengths.edges, mesh.face_count());
        // With pinched vertices split and junctions cut apart, every fan has a vertex of its own.
        // Each part, with its b holes closed by disks, then has vertices - edges + faces + b =
        // 2 - 2 genus.
        let loops_when_cut = boundary_loops(mesh);
        let genus = (2 * patch_count(mesh) + lengths.edges_when_cut)
            .saturating_sub(fan_count(mesh) + faces + loops_when_cut)
            / 2;
        let boundary_loops = if mesh.has_junctions() {
            connected_boundaries(mesh)
        } else {
            loops_when_cut
        };
        let vertices_in_faces = mesh.vertex_count() - isolated_vertices - mesh.copies().len();
        Self {
            vertices: mesh.vertex_count(),
            faces,
            edges,
            boundary_edges: lengths.boundary_edges,
            junctions: lengths.junctions,
            boundary_loops,
            components: parts(mesh).count() - isolated_vertices,
            isolated_vertices,
            pinched_vertices: count(|mesh, v| mesh.is_pinched(v) && !is_on_junction(mesh, v)),
            euler_characteristic: signed(vertices_in_faces) - signed(edges) + signed(faces),
            genus,
            saddles: count(Mesh::is_saddle),
            flat_faces: shapes.flat_faces,
            min_edge_length: lengths.min,
            mean_edge_length: lengths.sum / edges.max(1) as f64,
            max_edge_length: lengths.max,
            area: shapes.area,
            bounding_box: mesh.bounding_box(),
            anisotropy: shapes.anisotropy,
        }
    }
}

struct EdgeLengths {
    edges: usize,
    /// With one edge for each half-edge along a junction.
    edges_when_cut: usize,
    boundary_edges: usize,
    junctions: usize,
    min: f64,
    max: f64,
    sum: f64,
}

impl EdgeLengths {
    fn of(mesh: &Mesh) -> Self {
        let mut all = Self {
            edges: 0,
            edges_when_cut: 0,
            boundary_edges: 0,
            junctions: 0,
            min: f64::INFINITY,
            max: 0.0,
            sum: 0.0,
        };
        for h in mesh.half_edges() {
            all.edges_when_cut += usize::from(mesh.twin(h).is_none_or(|twin| h < twin));
            if mesh.edge_of(h) == h {
                let length = mesh.length(h);
                all.edges += 1;
                all.boundary_edges += usize::from(mesh.is_boundary_edge(h));
                all.junctions += usize::from(!mesh.junction(h).is_empty());
                all.min = all.min.min(length);
                all.max = all.max.max(length);
                all.sum += length;
            }
        }
        all
    }
}

fn is_on_junction(mesh: &Mesh, v: crate::VertexId) -> bool {
    let sides = mesh.outgoing(v).iter().flat_map(|&h| [h, h.prev()]);
    let mut junctions = sides.map(|h| mesh.junction(h));
    junctions.any(|junction| !junction.is_empty())
}

struct Shapes {
    area: f64,
    flat_faces: usize,
    anisotropy: f64,
}

impl Shapes {
    fn of(mesh: &Mesh) -> Self {
        let (mut area, mut flat_faces, mut sum) = (0.0, 0, 0.0);
        for face in mesh.faces() {
            let lengths = mesh.side_lengths(face);
            let apex = mesh.apex(face.half_edge(0));
            let own_area = lengths[0] * apex[1] / 2.0;
            area += own_area;
            if is_flat(lengths, apex) {
                flat_faces += 1;
                continue;
            }
            let [a, b, c] = lengths;
            let half_perimeter = (a + b + c) / 2.0;
            let longest = a.max(b).max(c);
            sum += half_perimeter * longest / (2.0 * 3f64.sqrt() * own_area);
        }
        let others = mesh.face_count() - flat_faces;
        Self {
            area,
            flat_faces,
            anisotropy: if others == 0 {
                1.0
            } else {
                sum / others as f64
            },
        }
    }
}

/// Number of boundary loops.
fn boundary_loops(mesh: &Mesh) -> usize {
    let mut seen = vec![false; mesh.half_edge_count()];
    let mut loops = 0;
    for start in mesh.half_edges() {
        if seen[start.index()] || mesh.twin(start).is_some() {
            continue;
        }
        loops += 1;
        let mut h = start;
        while !seen[h.index()] {
            seen[h.index()] = true;
            h = next_along_boundary(mesh, h);
        }
    }
    loops
}

/// Number of parts of the boundary that share no vertex.
fn connected_boundaries(mesh: &Mesh) -> usize {
    let mut parts = DisjointSets::new(mesh.vertex_count());
    let mut count = 0;
    for h in mesh.half_edges().filter(|&h| mesh.is_boundary_edge(h)) {
        parts.union(mesh.tail(h).raw(), mesh.head(h).raw());
    }
    for v in mesh.vertices().filter(|&v| mesh.is_boundary(v)) {
        count += usize::from(parts.find(v.raw()) == v.raw());
    }
    count
}

/// The boundary half-edge that starts at the head of boundary half-edge `h`, in the same fan.
fn next_along_boundary(mesh: &Mesh, h: HalfEdgeId) -> HalfEdgeId {
    let mut g = h.next();
    while let Some(twin) = mesh.twin(g) {
        g = twin.next();
    }
    g
}

/// Number of fans over all vertices: 0 at an isolated vertex, 1 at others, more at a pinched
/// vertex.
fn fan_count(mesh: &Mesh) -> usize {
    let fans = |v| {
        let outgoing = mesh.outgoing(v);
        let breaks = outgoing
            .windows(2)
            .filter(|pair| mesh.twin(pair[0].prev()) != Some(pair[1]))
            .count();
        breaks + usize::from(!outgoing.is_empty())
    };
    mesh.vertices().map(fans).sum()
}

/// Number of parts that are connected across edges.
fn patch_count(mesh: &Mesh) -> usize {
    let mut patches = DisjointSets::new(mesh.face_count());
    for h in mesh.half_edges() {
        if let Some(twin) = mesh.twin(h) {
            patches.union(h.face().raw(), twin.face().raw());
        }
    }
    patches.count()
}

/// The parts that are connected through vertices. An isolated vertex is one.
fn parts(mesh: &Mesh) -> DisjointSets {
    let mut parts = DisjointSets::new(mesh.vertex_count());
    for h in mesh.half_edges() {
        parts.union(mesh.tail(h).raw(), mesh.head(h).raw());
    }
    for [copy, kept] in mesh.copies() {
        parts.union(copy.raw(), kept.raw());
    }
    parts
}

impl Mesh {
    /// The connected component of each vertex. Components are numbered in the order of their first
    /// vertices, and share no vertex. O(faces).
    pub fn components(&self) -> Vec<u32> {
        let mut parts = parts(self);
        let mut numbers: Vec<u32> = Vec::with_capacity(self.vertex_count());
        let mut count = 0;
        for v in self.vertices() {
            let first = parts.find(v.raw());
            let number = numbers.get(first as usize).copied().unwrap_or(count);
            count = count.max(number + 1);
            numbers.push(number);
        }
        numbers
    }
}

/// A count as a signed number. There are fewer than 2³² elements of any kind.
fn signed(count: usize) -> i64 {
    i64::try_from(count).unwrap_or(i64::MAX)
}
