//! The diagram: cells, the arcs between them, the vertices in which arcs meet.

mod arrange;
mod border;
mod curve;
mod dual;
mod line;
pub(crate) mod sites;
mod table;

use std::collections::{BTreeSet, HashMap};

use geobench_mesh::vector::{Point, between, cross_2d, norm, sub};
use geobench_mesh::{DisjointSets, FaceId, HalfEdgeId, Mesh};
use geobench_window::Window;

use crate::field::{LabelledField, NO_SOURCE};
use crate::store::edge_of;
use arrange::{Arrangement, FaceNodeKind, Span, arrange};
pub use curve::Bisector;
pub use dual::{Dual, NoTriangulation, Obstacle};
use line::SegmentCells;
use sites::{FaceSites, corners};

/// A geodesic Voronoi diagram: the cells of the sources, their borders and their Voronoi vertices.
///
/// ```
/// use geobench_mesh::{Mesh, VertexId};
/// use geobench_voronoi::{Diagram, FieldSolver, WindowVtp};
///
/// let mesh = Mesh::generate("grid,n=4")?;
/// let mut solver = WindowVtp::new(&mesh);
/// // Two opposite corners of a square: each has half of it.
/// let field = solver.field(&[0, 24].map(VertexId::new))?;
/// let diagram = Diagram::new(&field, 2);
/// assert!((diagram.cells()[0].area - 8.0).abs() < 1e-12);
/// assert_eq!(diagram.cells()[0].neighbours, [1]);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct Diagram {
    mesh: Mesh,
    labels: Vec<u32>,
    nodes: Vec<Node>,
    vertices: Vec<Vertex>,
    arcs: Vec<BorderArc>,
    cells: Vec<VoronoiCell>,
    faces: Vec<BorderFace>,
    /// For each face its only cell; [`NO_SOURCE`] for border faces and faces that no source
    /// reaches.
    inner: Vec<u32>,
    /// Whether several cells share each face.
    border_face: Vec<bool>,
}

/// A point at which arcs end.
///
/// ```
/// use geobench_mesh::{Mesh, VertexId};
/// use geobench_voronoi::{Diagram, FieldSolver, NodeKind, WindowVtp};
///
/// let mesh = Mesh::generate("grid,n=4")?;
/// let mut solver = WindowVtp::new(&mesh);
/// // The corners of a square of four by four.
/// let field = solver.field(&[0, 4, 20, 24].map(VertexId::new))?;
/// let diagram = Diagram::new(&field, 4);
/// // Borders of neighbours cross edges on their way to the middle.
/// let on_edges = diagram.nodes().iter().filter(|node| node.kind == NodeKind::OnEdge);
/// assert!(on_edges.count() >= 4);
/// let node = diagram.nodes()[0];
/// let [x, y, _] = diagram.position(node.face, node.place).ok_or("no positions")?;
/// assert!((x - 2.0).abs() < 1e-12 || (y - 2.0).abs() < 1e-12);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Node {
    /// One of the faces in which it lies.
    pub face: FaceId,
    /// Its position in the plane of that face, in the frame of the first half-edge.
    pub place: [f64; 2],
    /// The kind of the node.
    pub kind: NodeKind,
}

/// The kind of a [`Node`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NodeKind {
    /// Where a border between two cells crosses an edge of the mesh.
    OnEdge,
    /// Inside a face, a border passes from one bisector to the next.
    Breakpoint,
    /// A Voronoi vertex.
    Vertex {
        /// The number of borders that meet here.
        degree: u32,
    },
}

/// A Voronoi vertex: a point at which three cells or more meet.
///
/// ```
/// use geobench_mesh::{Mesh, VertexId};
/// use geobench_voronoi::{Diagram, FieldSolver, WindowVtp};
///
/// let mesh = Mesh::generate("grid,n=4")?;
/// let mut solver = WindowVtp::new(&mesh);
/// // The corners of a square of four by four.
/// let field = solver.field(&[0, 4, 20, 24].map(VertexId::new))?;
/// let diagram = Diagram::new(&field, 4);
/// // The middle, once with four cells or twice with three.
/// for vertex in diagram.vertices() {
///     assert!((vertex.distance - 8.0_f64.sqrt()).abs() < 1e-9);
/// }
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Vertex {
    /// The index of its node in [`Diagram::nodes`].
    pub node: u32,
    /// The cells around it, counter-clockwise in the orientation of the faces.
    pub cells: Vec<u32>,
    /// Its distance from the sources of these cells, in the units of the mesh.
    pub distance: f64,
}

/// A piece of the border between two cells, inside one face.
///
/// ```
/// use geobench_mesh::{Mesh, VertexId};
/// use geobench_voronoi::{Diagram, FieldSolver, WindowVtp};
///
/// let mesh = Mesh::generate("grid,n=4")?;
/// let mut solver = WindowVtp::new(&mesh);
/// let field = solver.field(&[0, 24].map(VertexId::new))?;
/// let diagram = Diagram::new(&field, 2);
/// // In a plane all borders are straight; this one is a diagonal of the square.
/// assert!(diagram.arcs().iter().all(|arc| arc.is_line()));
/// let length: f64 = diagram.arcs().iter().map(|arc| arc.length()).sum();
/// assert!((length - 32.0_f64.sqrt()).abs() < 1e-12);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BorderArc {
    /// The face in which it lies.
    pub face: FaceId,
    /// The cells on its left and on its right, seen from its first end to its second.
    pub sources: [u32; 2],
    /// The nodes at which it begins and ends, as indices into [`Diagram::nodes`].
    pub nodes: [u32; 2],
    /// The positions of its ends in the plane of the face.
    pub ends: [[f64; 2]; 2],
    /// The bisector that contains it; `None` if the arc is a straight line up to rounding.
    pub bisector: Option<Bisector>,
}

impl BorderArc {
    /// Whether it is straight.
    pub fn is_line(&self) -> bool {
        self.bisector.is_none_or(|bisector| bisector.is_line())
    }

    /// The point of the arc on the perpendicular to its chord at fraction `t`, in the plane of the
    /// face. 0 and 1 give the ends.
    pub fn point(&self, t: f64) -> [f64; 2] {
        let [from, to] = self.ends;
        if t == 0.0 || t == 1.0 {
            return self.ends[usize::from(t == 1.0)];
        }
        let curve = self.bisector.and_then(|b| b.beside(from, to, t));
        curve.unwrap_or_else(|| between(from, to, t))
    }

    /// The length of the arc, and the area between it and its chord, positive on the left of the
    /// chord.
    fn length_and_area(&self) -> (f64, f64) {
        let [from, to] = self.ends;
        let length = norm(sub(to, from));
        match self.bisector {
            Some(bisector) if length > 0.0 && !bisector.is_line() => {
                bisector.length_and_area(from, to)
            }
            _ => (length, 0.0),
        }
    }

    /// Its length, in the units of the mesh.
    pub fn length(&self) -> f64 {
        self.length_and_area().0
    }
}

/// All points that are nearer to one source than to any other.
///
/// ```
/// use geobench_mesh::{Mesh, VertexId};
/// use geobench_voronoi::{Diagram, FieldSolver, WindowVtp};
///
/// let mesh = Mesh::generate("grid,n=4")?;
/// let mut solver = WindowVtp::new(&mesh);
/// // The corners of a square of four by four.
/// let field = solver.field(&[0, 4, 20, 24].map(VertexId::new))?;
/// let diagram = Diagram::new(&field, 4);
/// for cell in diagram.cells() {
///     assert!((cell.area - 4.0).abs() < 1e-12 && cell.is_disc());
/// }
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, Default, PartialEq)]
pub struct VoronoiCell {
    /// Area, in square units of the mesh.
    pub area: f64,
    /// Length of its border, including the boundary of the surface.
    pub perimeter: f64,
    /// The cells with which it shares a border, in ascending order.
    pub neighbours: Vec<u32>,
    /// Euler characteristic of its interior: 1 for a disc, less with holes or handles. 0 for an
    /// empty cell, as of the second of two sources at one place.
    pub euler: i64,
    /// Whether its interior is connected. Parts that only meet at a pinched vertex are not.
    pub is_connected: bool,
}

impl VoronoiCell {
    /// Whether it is a disc.
    pub fn is_disc(&self) -> bool {
        self.euler == 1 && self.is_connected
    }
}

/// A part of a cell inside a face.
///
/// ```
/// use geobench_mesh::{Mesh, VertexId};
/// use geobench_voronoi::{Diagram, FieldSolver, WindowVtp};
///
/// let mesh = Mesh::generate("grid,n=4")?;
/// let mut solver = WindowVtp::new(&mesh);
/// let field = solver.field(&[0, 24].map(VertexId::new))?;
/// let diagram = Diagram::new(&field, 2);
/// // Eight of the 32 faces lie along the diagonal that is the border.
/// let parts: Vec<_> = diagram.parts(0).collect();
/// assert_eq!(parts.len(), parts.iter().flat_map(|part| part.triangles()).count());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct CellPart {
    /// The cell.
    pub source: u32,
    /// The face.
    pub face: FaceId,
    /// Its outline as a polygon in the plane of the face, counter-clockwise. Points along curved
    /// arcs approximate them.
    pub outline: Vec<[f64; 2]>,
}

impl CellPart {
    /// Triangles that make up the outline, as indices of its corners; O(n³) for n corners.
    pub fn triangles(&self) -> Vec<[usize; 3]> {
        let mut left: Vec<usize> = (0..self.outline.len()).collect();
        let mut triangles = Vec::new();
        while left.len() > 2 {
            let n = left.len();
            let corner = |i: usize| self.outline[left[i % n]];
            let is_ear = |&i: &usize| {
                let [a, b, c] = [corner(i + n - 1), corner(i), corner(i + 1)];
                let turns = |a, b, p| cross_2d(sub(b, a), sub(p, a));
                let holds =
                    |p| turns(a, b, p) > 0.0 && turns(b, c, p) > 0.0 && turns(c, a, p) > 0.0;
                turns(a, b, c) > 0.0 && !(0..n).map(corner).any(holds)
            };
            // In an outline without area, any corner will do.
            let ear = (0..n).find(is_ear).unwrap_or(0);
            triangles.push([left[(ear + n - 1) % n], left[ear], left[(ear + 1) % n]]);
            left.remove(ear);
        }
        triangles
    }
}

/// A face that several cells share.
#[derive(Clone, Debug)]
struct BorderFace {
    face: FaceId,
    arrangement: Arrangement,
    /// The index of the arc of its first piece.
    first_arc: usize,
}

impl Diagram {
    /// Computes the diagram of `field`, the result of a run from this number of `sources`.
    ///
    /// # Panics
    ///
    /// If a source of the field has the number `sources` or more.
    pub fn new(field: &LabelledField<'_>, sources: usize) -> Self {
        let mut builder = Builder::new(field, sources);
        builder.find_lines();
        builder.divide_faces();
        builder.finish()
    }

    /// The mesh.
    pub const fn mesh(&self) -> &Mesh {
        &self.mesh
    }

    /// The nearest source of every vertex of the mesh; [`NO_SOURCE`] where no path leads.
    pub fn labels(&self) -> &[u32] {
        &self.labels
    }

    /// The points at which arcs end.
    pub fn nodes(&self) -> &[Node] {
        &self.nodes
    }

    /// The Voronoi vertices.
    pub fn vertices(&self) -> &[Vertex] {
        &self.vertices
    }

    /// The pieces of the borders between cells.
    pub fn arcs(&self) -> &[BorderArc] {
        &self.arcs
    }

    /// The cells, in the order of the sources.
    pub fn cells(&self) -> &[VoronoiCell] {
        &self.cells
    }

    /// Number of faces that several cells share.
    pub fn border_faces(&self) -> usize {
        self.faces.len()
    }

    /// The only cell of a face; `None` if several cells share the face, or no source reaches it.
    pub fn cell_of_face(&self, face: FaceId) -> Option<u32> {
        let cell = self.inner[face.index()];
        (cell != NO_SOURCE).then_some(cell)
    }

    /// Whether several cells share a face.
    pub fn is_border(&self, face: FaceId) -> bool {
        self.border_face[face.index()]
    }

    /// The parts into which cells divide the faces that several of them share. A curved arc is
    /// approximated by its ends and `points_per_arc` points between them.
    pub fn parts(&self, points_per_arc: usize) -> impl Iterator<Item = CellPart> {
        self.faces.iter().flat_map(move |border| {
            border.arrangement.regions.iter().map(move |region| {
                let mut outline = Vec::new();
                for span in &region.border {
                    let (piece, is_forward) = match span {
                        Span::Sides(points) => {
                            outline.extend_from_slice(points);
                            continue;
                        }
                        Span::Inside(piece, is_forward) => (piece, *is_forward),
                    };
                    let arc = &self.arcs[border.first_arc + piece];
                    let count = if arc.is_line() { 0 } else { points_per_arc };
                    for i in 1..=count {
                        let t = i as f64 / (count + 1) as f64;
                        outline.push(arc.point(if is_forward { t } else { 1.0 - t }));
                    }
                    outline.push(arc.ends[usize::from(is_forward)]);
                }
                if region.border.len() > 1 {
                    // The outline ends at the point where it began.
                    outline.pop();
                }
                outline.dedup();
                CellPart {
                    source: region.source,
                    face: border.face,
                    outline,
                }
            })
        })
    }

    /// The barycentric coordinates of a position in the plane of `face`.
    pub fn barycentric(&self, face: FaceId, place: [f64; 2]) -> [f64; 3] {
        let corners = corners(&self.mesh, face);
        let twice = |a: Point, b: Point, c: Point| cross_2d(sub(b, a), sub(c, a));
        let [a, b, c] = corners;
        let whole = twice(a, b, c);
        let [u, v] = [twice(place, b, c), twice(a, place, c)].map(|part| part / whole);
        [u, v, 1.0 - u - v]
    }

    /// The position in space of a position in the plane of `face`; `None` if the mesh has no
    /// positions.
    pub fn position(&self, face: FaceId, place: [f64; 2]) -> Option<[f64; 3]> {
        let weights = self.barycentric(face, place);
        let positions = self.mesh.positions();
        let mut position = [0.0; 3];
        for (weight, v) in weights.into_iter().zip(self.mesh.face_vertices(face)) {
            let corner = positions.get(v.index())?;
            for (sum, x) in position.iter_mut().zip(corner) {
                *sum += weight * x;
            }
        }
        Some(position)
    }
}

/// The connected parts of cells.
#[derive(Clone, Debug, Default)]
struct CellComponents {
    sets: DisjointSets,
    /// The cell of each element.
    cells: Vec<u32>,
}

impl CellComponents {
    /// The number of the next element.
    fn next(&self) -> u32 {
        self.cells.len() as u32
    }

    fn add(&mut self, cell: u32) {
        self.sets.add();
        self.cells.push(cell);
    }
}

const NO_LINE: u32 = u32::MAX;

/// A run along an edge has no extent if it is no longer than this fraction of the edge.
const NO_EXTENT: f64 = 1e-12;

/// Builds a [`Diagram`].
struct Builder<'a> {
    field: &'a LabelledField<'a>,
    /// For each edge, under the lesser of its half-edges, its line; [`NO_LINE`] if it has only one
    /// cell.
    line_of: Vec<u32>,
    lines: Vec<SegmentCells>,
    /// For each line, the number of its first node.
    first_node: Vec<u32>,
    /// For each line, the number in `unions` of its first run.
    first_union: Vec<u32>,
    nodes: Vec<Node>,
    arcs: Vec<BorderArc>,
    cells: Vec<VoronoiCell>,
    neighbours: Vec<BTreeSet<u32>>,
    faces: Vec<BorderFace>,
    inner: Vec<u32>,
    border_face: Vec<bool>,
    vertices: Vec<Vertex>,
    /// The connected parts of cells. A *run* is a part of a segment in one cell. The elements are,
    /// in this order: the vertices of the mesh, the runs along edges with several cells, the runs
    /// along cuts inside faces.
    unions: CellComponents,
    /// For each half-edge from a pinched vertex, the number in `unions` of its fan of faces.
    fans: HashMap<HalfEdgeId, u32>,
    /// Whether each element of `unions` lies along an edge with some length. A pinched vertex that
    /// is as near to the source of another cell begins a run without length in that cell.
    extended: Vec<bool>,
}

impl<'a> Builder<'a> {
    fn new(field: &'a LabelledField<'a>, sources: usize) -> Self {
        Self {
            field,
            line_of: vec![NO_LINE; field.mesh.half_edge_count()],
            lines: Vec::new(),
            first_node: Vec::new(),
            first_union: Vec::new(),
            nodes: Vec::new(),
            arcs: Vec::new(),
            cells: vec![VoronoiCell::default(); sources],
            neighbours: vec![BTreeSet::new(); sources],
            faces: Vec::new(),
            inner: Vec::new(),
            border_face: Vec::new(),
            vertices: Vec::new(),
            unions: CellComponents::default(),
            fans: HashMap::new(),
            extended: Vec::new(),
        }
    }

    /// Finds where cells change along the edges of the mesh, and adds a node for each change.
    fn find_lines(&mut self) {
        let mesh = self.field.mesh;
        for h in mesh.half_edges() {
            let twin = mesh.twin(h);
            if twin.is_some_and(|twin| twin < h) {
                continue;
            }
            let line = match twin {
                Some(twin) => self.line_inside(h, edge_of(h, twin).0),
                None => self.line_of_boundary(h),
            };
            let Some(line) = line.filter(|line| !line.changes.is_empty()) else {
                continue;
            };
            let [from, to] = side_of(mesh, h);
            self.line_of[h.index()] = self.lines.len() as u32;
            self.first_node.push(self.nodes.len() as u32);
            for change in &line.changes {
                self.nodes.push(Node {
                    face: h.face(),
                    place: between(from, to, change.at),
                    kind: NodeKind::OnEdge,
                });
            }
            self.lines.push(line);
        }
    }

    /// The distances and cells of both ends of `h`.
    fn ends(&self, h: HalfEdgeId) -> [(f64, u32); 2] {
        let mesh = self.field.mesh;
        [mesh.tail(h), mesh.head(h)].map(|v| {
            let v = v.index();
            (self.field.distances[v], self.field.labels[v])
        })
    }

    /// The cells along an edge between two faces, from the windows of both directions stored there
    /// and from the ends of the edge. `None` if there is only one cell.
    fn line_inside(&self, h: HalfEdgeId, e: usize) -> Option<SegmentCells> {
        let ends = self.ends(h);
        let list = self.field.store.list(e);
        let first = ends[0].1;
        if ends[1].1 == first && list.iter().all(|s| s.source() == first) {
            return None;
        }
        let l = self.field.mesh.length(h);
        let stored = || list.iter().map(|s| (s.window, s.source()));
        let windows = || stored().chain(end_windows(ends, l));
        let disjoint = stored().collect();
        let line = SegmentCells::envelope(disjoint, end_windows(ends, l), l, [first, ends[1].1]);
        Some(line.settled(l, |t, wanted| {
            let windows = windows().filter(|(_, s)| wanted.is_none_or(|source| source == *s));
            let paths = windows.map(|(window, source)| (path_to(&window, t * l), source));
            paths.fold((f64::INFINITY, NO_SOURCE), |least, path| {
                if path.0 < least.0 { path } else { least }
            })
        }))
    }

    /// The cells along a boundary edge, from the sites of its face, because no windows are stored
    /// there. `None` if there is only one cell.
    fn line_of_boundary(&self, h: HalfEdgeId) -> Option<SegmentCells> {
        let ends = self.ends(h);
        let first = ends[0].1;
        let sites = FaceSites::new(self.field, h.face());
        if sites.sites.iter().all(|site| site.source == first) {
            return None;
        }
        let [from, to] = side_of(self.field.mesh, h);
        Some(sites.line(from, to, [first, ends[1].1]))
    }

    /// The index of the line along `h`, and whether the line runs the other way; `None` if there is
    /// only one cell.
    fn line_along(&self, h: HalfEdgeId) -> Option<(usize, bool)> {
        let twin = self.field.mesh.twin(h);
        let (e, is_reversed) = twin.map_or((h.index(), false), |twin| edge_of(h, twin));
        let line = self.line_of[e];
        (line != NO_LINE).then_some((line as usize, is_reversed))
    }

    /// Divides all faces among the cells.
    fn divide_faces(&mut self) {
        let field = self.field;
        let mesh = field.mesh;
        self.add_vertices();
        for line in &self.lines {
            self.first_union.push(self.unions.next());
            for source in line.cells() {
                self.unions.add(source);
            }
        }
        for face in mesh.faces() {
            let along = face.half_edges().map(|h| self.line_along(h));
            if along == [None; 3] {
                self.add_inner_face(face);
            } else {
                self.add_border_face(face, along);
            }
        }
        self.count_edges_and_vertices();
    }

    /// Adds the vertices to `unions`, under their own numbers, and the fans of pinched vertices,
    /// each with its own number. Copies are no place of the surface.
    fn add_vertices(&mut self) {
        let mesh = self.field.mesh;
        for (v, &label) in mesh.vertices().zip(self.field.labels) {
            let is_no_place = mesh.is_pinched(v) || mesh.is_copy(v);
            let label = if is_no_place { NO_SOURCE } else { label };
            self.unions.add(label);
        }
        for v in mesh.vertices().filter(|&v| mesh.is_pinched(v)) {
            for &h in mesh.outgoing(v) {
                self.fans.insert(h, self.unions.next());
                self.unions.add(self.field.labels[v.index()]);
            }
            for &h in mesh.outgoing(v) {
                if let Some(beside) = mesh.twin(h.prev()) {
                    self.unions.sets.union(self.fans[&h], self.fans[&beside]);
                }
            }
        }
    }

    /// The number in `unions` of the vertex at which `h` starts, or of its fan there.
    fn corner(&self, h: HalfEdgeId) -> u32 {
        let v = self.field.mesh.tail(h);
        if self.field.mesh.is_pinched(v) {
            self.fans[&h]
        } else {
            v.raw()
        }
    }

    /// Adds a face with one cell, or none.
    fn add_inner_face(&mut self, face: FaceId) {
        let mesh = self.field.mesh;
        let source = self.field.labels[mesh.face_vertices(face)[0].index()];
        self.inner.push(source);
        self.border_face.push(false);
        if source == NO_SOURCE {
            return;
        }
        let [first, second, third] = face.half_edges().map(|h| self.corner(h));
        self.unions.sets.union(first, second);
        self.unions.sets.union(second, third);
        let [a, b, c] = corners(mesh, face);
        let cell = &mut self.cells[source as usize];
        cell.area += 0.5 * cross_2d(sub(b, a), sub(c, a));
        cell.euler += 1;
    }

    /// Adds a face that several cells share.
    fn add_border_face(&mut self, face: FaceId, along: [Option<(usize, bool)>; 3]) {
        self.inner.push(NO_SOURCE);
        self.border_face.push(true);
        let sites = FaceSites::new(self.field, face);
        let vertices = self.field.mesh.face_vertices(face);
        let lines = [0, 1, 2].map(|k| match along[k] {
            Some((line, false)) => self.lines[line].clone(),
            Some((line, true)) => self.lines[line].reversed(),
            None => SegmentCells::of(self.field.labels[vertices[k].index()]),
        });
        let runs = [0, 1, 2].map(|k| self.runs_along(face.half_edge(k), along[k as usize]));
        let next_run = self.unions.next();
        let arrangement = arrange(&sites, &lines, &runs, next_run);
        for &source in &arrangement.cuts {
            self.unions.add(source);
        }
        for region in &arrangement.regions {
            for pair in region.runs.windows(2) {
                self.unions.sets.union(pair[0], pair[1]);
            }
        }
        let numbers = self.add_nodes(face, &arrangement, along, &lines);
        for (node, around) in &arrangement.vertices {
            self.vertices.push(Vertex {
                node: numbers[*node],
                cells: around.clone(),
                distance: sites.distance(arrangement.nodes[*node].at),
            });
        }
        let first_arc = self.arcs.len();
        for piece in &arrangement.pieces {
            let arc = BorderArc {
                face,
                sources: piece.sources,
                nodes: piece.nodes.map(|node| numbers[node]),
                ends: piece.nodes.map(|node| arrangement.nodes[node].at),
                bisector: piece.curve,
            };
            self.add_arc(arc);
        }
        // The area of a cell is half the integral of x × dx along its border. The first corner is
        // the origin, so only the opposite side of the face contributes. Arcs are added by
        // `add_arc`.
        let [_, second, third] = sites.corners;
        let mut at = 0.0;
        let ends = lines[1].changes.iter().map(|change| change.at);
        for (source, end) in lines[1].cells().zip(ends.chain([1.0])) {
            self.cells[source as usize].area += 0.5 * (end - at) * cross_2d(second, third);
            at = end;
        }
        for region in &arrangement.regions {
            self.cells[region.source as usize].euler += 1;
        }
        for &source in &arrangement.cuts {
            self.cells[source as usize].euler -= 1;
        }
        self.faces.push(BorderFace {
            face,
            arrangement,
            first_arc,
        });
    }

    /// The numbers in `unions` of the runs along `h`. The first and last run are joined with the
    /// ends of the edge. An edge with one cell has its tail as its run.
    fn runs_along(&mut self, h: HalfEdgeId, along: Option<(usize, bool)>) -> Vec<u32> {
        let (tail, head) = (self.corner(h), self.corner(h.next()));
        let Some((line, is_reversed)) = along else {
            self.unions.sets.union(tail, head);
            return vec![tail];
        };
        let first = self.first_union[line];
        let count = self.lines[line].changes.len() as u32;
        let mut runs: Vec<u32> = (first..=first + count).collect();
        if is_reversed {
            runs.reverse();
        }
        self.unions.sets.union(runs[0], tail);
        self.unions.sets.union(runs[count as usize], head);
        runs
    }

    /// Adds the nodes of a face, except those on edges, which exist already. Returns the numbers of
    /// all its nodes in the diagram.
    fn add_nodes(
        &mut self,
        face: FaceId,
        arrangement: &Arrangement,
        along: [Option<(usize, bool)>; 3],
        lines: &[SegmentCells; 3],
    ) -> Vec<u32> {
        let mut numbers = Vec::new();
        for node in &arrangement.nodes {
            let kind = match node.kind {
                FaceNodeKind::Side { side, change } => {
                    let side = side as usize;
                    let (line, is_reversed) = along[side].unwrap_or_default();
                    let last = lines[side].changes.len() as u32 - 1;
                    let change = if is_reversed { last - change } else { change };
                    numbers.push(self.first_node[line] + change);
                    continue;
                }
                FaceNodeKind::Inside => NodeKind::Breakpoint,
                FaceNodeKind::Vertex(degree) => NodeKind::Vertex { degree },
            };
            numbers.push(self.nodes.len() as u32);
            self.nodes.push(Node {
                face,
                place: node.at,
                kind,
            });
        }
        numbers
    }

    /// Adds an arc, and its shares of the length and area of the cells on both sides.
    fn add_arc(&mut self, arc: BorderArc) {
        let (length, bulge) = arc.length_and_area();
        let [from, to] = arc.ends;
        // Its share of the integral counter-clockwise around the cell on its left.
        let area = 0.5 * cross_2d(from, to) - bulge;
        let [left, right] = arc.sources;
        for (source, other, area) in [(left, right, area), (right, left, -area)] {
            let cell = &mut self.cells[source as usize];
            cell.area += area;
            cell.perimeter += length;
            self.neighbours[source as usize].insert(other);
        }
        self.arcs.push(arc);
    }

    /// Adds edges and vertices to the Euler characteristics of the cells, and the boundary of the
    /// surface to their perimeters.
    fn count_edges_and_vertices(&mut self) {
        let mesh = self.field.mesh;
        self.extended = vec![false; self.unions.cells.len()];
        for h in mesh.half_edges() {
            let twin = mesh.twin(h);
            if twin.is_some_and(|twin| twin < h) {
                continue;
            }
            let constant;
            let (line, first) = if let Some((line, _)) = self.line_along(h) {
                (&self.lines[line], self.first_union[line])
            } else {
                constant = SegmentCells::of(self.field.labels[mesh.tail(h).index()]);
                (&constant, self.corner(h))
            };
            if line.first == NO_SOURCE {
                continue;
            }
            let l = mesh.length(h);
            let mut at = 0.0;
            let ends = line.changes.iter().map(|change| change.at).chain([1.0]);
            for ((source, end), run) in line.cells().zip(ends).zip(first..) {
                self.extended[run as usize] |= end - at > NO_EXTENT;
                let cell = &mut self.cells[source as usize];
                if twin.is_some() {
                    cell.euler -= 1;
                } else {
                    cell.perimeter += l * (end - at);
                }
                at = end;
            }
        }
        for v in mesh.vertices() {
            let source = self.field.labels[v.index()];
            if mesh.outgoing(v).is_empty() {
                self.extended[v.index()] = true;
            } else if source != NO_SOURCE && !mesh.is_boundary(v) {
                self.cells[source as usize].euler += 1;
            }
        }
    }

    fn finish(mut self) -> Diagram {
        for (cell, neighbours) in self.cells.iter_mut().zip(self.neighbours) {
            cell.neighbours = neighbours.into_iter().collect();
        }
        let mut pieces = vec![0; self.cells.len()];
        let mut is_counted = vec![false; self.extended.len()];
        for (i, _) in (0..).zip(&self.extended).filter(|(_, extended)| **extended) {
            let source = self.unions.cells[i as usize];
            let root = self.unions.sets.find(i) as usize;
            if source != NO_SOURCE && !std::mem::replace(&mut is_counted[root], true) {
                pieces[source as usize] += 1;
            }
        }
        for (cell, pieces) in self.cells.iter_mut().zip(pieces) {
            cell.is_connected = pieces == 1;
        }
        Diagram {
            mesh: self.field.mesh.clone(),
            labels: self.field.labels.to_vec(),
            vertices: self.vertices,
            nodes: self.nodes,
            arcs: self.arcs,
            cells: self.cells,
            faces: self.faces,
            inner: self.inner,
            border_face: self.border_face,
        }
    }
}

/// The ends of an edge as (pseudo-)sources: a window along the whole edge for each end.
fn end_windows(ends: [(f64, u32); 2], l: f64) -> impl Iterator<Item = (Window, u32)> {
    let places = ends.into_iter().zip([0.0, l]);
    places
        .filter(|((_, source), _)| *source != NO_SOURCE)
        .map(move |((sigma, source), px)| {
            let window = Window {
                b0: 0.0,
                b1: l,
                px,
                py: 0.0,
                sigma,
            };
            (window, source)
        })
}

/// The length of the shortest path through the interval of `window` to abscissa `x` of its edge.
fn path_to(window: &Window, x: f64) -> f64 {
    let turn = x.clamp(window.b0, window.b1);
    window.distance(turn) + (x - turn).abs()
}

/// The ends of `h` in the plane of its face.
fn side_of(mesh: &Mesh, h: HalfEdgeId) -> [Point; 2] {
    let corners = corners(mesh, h.face());
    let k = h.corner() as usize;
    [corners[k], corners[(k + 1) % 3]]
}
