//! Remeshing: sites spread over a surface, and the dual of their diagram as a new mesh.

mod boundary;
mod centres;
mod flaws;
mod quality;
mod sampling;
mod tangent;

use std::collections::{BTreeSet, HashSet};

use geobench_mesh::{
    InvalidMesh, Mesh, MeshMeasures, PointError, Refined, SurfacePoint, TriangleSoup, VertexId,
};
use geobench_window::SolveError;

use crate::diagram::Diagram;
use crate::field::{FieldSolver, LabelledField};
use crate::window_vtp::WindowVtp;
use flaws::Flaws;
pub use quality::{Quality, SurfaceDeviation};
use sampling::Sampler;

/// Greatest number of rounds that add sites where the dual is not a triangulation.
const ROUNDS: usize = 32;

/// Limit of the number of sites: a factor of the number asked for, plus a constant.
const MOST_SITES: [usize; 2] = [4, 256];

/// Options of [`remesh()`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct RemeshOptions {
    /// The number of sites, the vertices of the new mesh.
    pub sites: usize,
    /// Steps of Lloyd's algorithm, each of which moves the sites to the centres of their cells.
    pub lloyd: usize,
    /// Seed that draws the first site of a surface without boundary.
    pub seed: u64,
}

/// Why a surface cannot be remeshed.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum RemeshError {
    /// The mesh was built from lengths alone, or has no faces.
    #[error("a mesh without coordinates or without faces cannot be remeshed")]
    NoSurface,
    /// Sites are drawn from the vertices in faces. The number asked for is 0 or exceeds theirs.
    #[error(
        "{sites} sites are asked for; from 1 to {vertices} are possible, the vertices in faces"
    )]
    Sites {
        /// The number asked for.
        sites: usize,
        /// The number of vertices in faces.
        vertices: usize,
    },
    /// The dual is not a triangulation, and adding sites did not make it one.
    #[error(
        "the dual of {sites} sites is no triangulation of the surface: {reason}; \
         ask for another number of sites, or give the model more vertices \
         (gen:file,path=MODEL,subdivide=1)"
    )]
    NoTriangulation {
        /// The number of sites, those that were added included.
        sites: usize,
        /// The first flaw, in words.
        reason: String,
    },
    /// The dual has another topology than the surface.
    #[error(
        "the dual of {sites} sites has another topology than the surface: {found}, not {expected}; \
         ask for more sites"
    )]
    Topology {
        /// The number of sites.
        sites: usize,
        /// The topology of the dual.
        found: String,
        /// The topology of the surface.
        expected: String,
    },
    /// The dual is not a valid mesh.
    #[error("the dual is no mesh: {0}")]
    Invalid(#[from] Box<InvalidMesh>),
    /// A solver failed.
    #[error(transparent)]
    Solve(#[from] SolveError),
    /// A site is not a point of the mesh, which is a defect of the program.
    #[error(transparent)]
    Point(#[from] PointError),
}

/// A new mesh for a surface.
#[derive(Clone, Debug)]
pub struct Remeshed {
    /// The new mesh; vertex i is site i.
    pub mesh: Mesh,
    /// The sites, as points of the original mesh.
    pub sites: Vec<SurfacePoint>,
    /// Number of sites beyond those asked for. Sites are added if the dual is not a triangulation,
    /// and for components and boundary loops that would have too few.
    pub added: usize,
    /// Number of Voronoi vertices at which more than three cells met. Their polygons were cut into
    /// triangles.
    pub split: usize,
    /// Mean distance by which the sites moved in each step of Lloyd's algorithm, in the units of
    /// the mesh.
    pub moved: Vec<f64>,
    /// The diagram of the sites, on the original mesh refined so that they are vertices.
    pub diagram: Diagram,
}

impl Remeshed {
    /// The new mesh as vertices and triangles, to write to a file.
    pub fn soup(&self) -> TriangleSoup {
        let faces = self.mesh.faces();
        let triangles = faces.map(|face| self.mesh.face_vertices(face).map(VertexId::raw));
        TriangleSoup::new(self.mesh.positions().to_vec(), triangles.collect())
    }
}

/// Remeshes a surface: the dual of the geodesic Voronoi diagram of sites spread evenly over it.
///
/// 1. Sites on the boundary: its corners, and points between them, at most as far apart as in a
///    mesh of equilateral triangles. Corners deviate from straight lines by more than a quarter of
///    that spacing. If these sites were more than half of all, they are fewer, but at least three
///    on each loop. Then farthest point sampling: each site is the vertex farthest from those
///    before it. Each component gets a site.
/// 2. Steps of Lloyd's algorithm. The centre of a cell is the end of the straight line from its
///    site along the mean, over the area of the cell, of the directions and lengths of the shortest
///    paths to its points. Sites on the boundary stay.
/// 3. While the dual is no triangulation, because a cell is no disc, two cells share several
///    borders, or the triangles at a site are no ring or fan, the farthest vertex of each such cell
///    becomes a site, too.
///
/// Voronoi vertices in which more than three cells meet become several triangles. The new mesh has
/// the components, the genus and the boundary loops of the surface.
///
/// ```
/// use geobench_mesh::{Mesh, MeshMeasures};
/// use geobench_voronoi::{Quality, RemeshOptions, remesh};
///
/// let mesh = Mesh::generate("torus,faces=2000")?;
/// let options = RemeshOptions { sites: 100, lloyd: 2, seed: 0 };
/// let remeshed = remesh(&mesh, &options)?;
/// assert_eq!(MeshMeasures::of(&remeshed.mesh).genus, 1);
/// assert!(Quality::of(&remeshed.mesh).least_angle > 25.0);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
///
/// When the mesh has no coordinates or has a [junction](Mesh::junction), there are fewer vertices
/// than sites, or no triangulation was found.
pub fn remesh(mesh: &Mesh, options: &RemeshOptions) -> Result<Remeshed, RemeshError> {
    if mesh.positions().is_empty() || mesh.face_count() == 0 {
        return Err(RemeshError::NoSurface);
    }
    if let Some(error) = SolveError::diagram_at_junctions(mesh) {
        return Err(error.into());
    }
    let measures = MeshMeasures::of(mesh);
    let vertices = measures.vertices - measures.isolated_vertices;
    if !(1..=vertices).contains(&options.sites) {
        let sites = options.sites;
        return Err(RemeshError::Sites { sites, vertices });
    }
    // The distance of neighbours if the new mesh were made of equilateral triangles.
    let spacing = (2.0 * measures.area / (3.0_f64.sqrt() * options.sites as f64)).sqrt();
    let mut sites = boundary::points(mesh, spacing, options.sites / 2)?;
    let refined = refine(mesh, &mut sites)?;
    let sampler = Sampler::new(&refined.mesh);
    let vertices = sampler.sample(&refined.vertices, options.sites, options.seed)?;
    let sampled = vertices[sites.len()..].iter();
    sites.extend(sampled.map(|&v| SurfacePoint::from(v)));
    let mut moved = Vec::new();
    for _ in 0..options.lloyd {
        let refined = refine(mesh, &mut sites)?;
        let diagram = diagram(&refined, |_| ())?.0;
        let step;
        (sites, step) = centres::centres(mesh, &sites, &refined, &diagram)?;
        moved.push(step);
    }
    triangulate(mesh, &measures, options.sites, sites, moved)
}

/// The mesh with a vertex at each site. Of sites that coincide, only the first one stays in
/// `sites`.
fn refine(mesh: &Mesh, sites: &mut Vec<SurfacePoint>) -> Result<Refined, PointError> {
    let refined = mesh.with_points(sites)?;
    let mut seen = HashSet::new();
    let mut vertices = refined.vertices.iter();
    let before = sites.len();
    sites.retain(|_| vertices.next().is_none_or(|v| seen.insert(*v)));
    if sites.len() == before {
        Ok(refined)
    } else {
        mesh.with_points(sites)
    }
}

/// The diagram of all sites, and the result of `look` for its field.
fn diagram<T>(
    refined: &Refined,
    look: impl FnOnce(&LabelledField<'_>) -> T,
) -> Result<(Diagram, T), SolveError> {
    let mut solver = WindowVtp::new(&refined.mesh);
    let field = solver.field(&refined.vertices)?;
    let diagram = Diagram::new(&field, refined.vertices.len());
    Ok((diagram, look(&field)))
}

/// Adds sites until the dual is a triangulation, and makes it the new mesh.
fn triangulate(
    mesh: &Mesh,
    measures: &MeshMeasures,
    asked: usize,
    mut sites: Vec<SurfacePoint>,
    moved: Vec<f64>,
) -> Result<Remeshed, RemeshError> {
    let [times, more] = MOST_SITES;
    let most = asked.saturating_mul(times).saturating_add(more);
    let mut rounds = 0;
    loop {
        let refined = refine(mesh, &mut sites)?;
        let (diagram, farthest) = diagram(&refined, |field| {
            farthest_of_cells(mesh, sites.len(), field)
        })?;
        let dual = diagram.dual();
        let flaws = Flaws::of(&diagram, &dual);
        if let Some(reason) = flaws.reason {
            let places = flaws.cells.iter().map(|&cell| farthest[cell as usize]);
            let places: BTreeSet<VertexId> = places.flatten().collect();
            rounds += 1;
            if places.is_empty() || rounds > ROUNDS || sites.len() + places.len() > most {
                let sites = sites.len();
                return Err(RemeshError::NoTriangulation { sites, reason });
            }
            sites.extend(places.into_iter().map(SurfacePoint::from));
            continue;
        }
        let positions = sites.iter().map(|site| mesh.position_of(site));
        let positions = positions.collect::<Option<_>>();
        let positions = positions.ok_or(PointError::NoPositions)?;
        let soup = TriangleSoup::new(positions, dual.triangles);
        let (new, _) = Mesh::from_soup(soup).map_err(Box::new)?;
        let (found, expected) = (topology(&MeshMeasures::of(&new)), topology(measures));
        if found != expected {
            let sites = sites.len();
            return Err(RemeshError::Topology {
                sites,
                found,
                expected,
            });
        }
        return Ok(Remeshed {
            mesh: new,
            added: sites.len().saturating_sub(asked),
            sites,
            split: dual.split.len(),
            moved,
            diagram,
        });
    }
}

/// The components, holes and handles of a surface, in words.
fn topology(measures: &MeshMeasures) -> String {
    let junctions = match measures.junctions {
        0 => String::new(),
        count => format!(", {count} edges at which it is no surface with two sides"),
    };
    format!(
        "{} components, genus {}, {} boundary loops{junctions}",
        measures.components, measures.genus, measures.boundary_loops
    )
}

/// For each cell, its vertex of the original mesh that is farthest from the site; `None` if there
/// is none but the site.
fn farthest_of_cells(
    mesh: &Mesh,
    sites: usize,
    field: &LabelledField<'_>,
) -> Vec<Option<VertexId>> {
    let mut farthest = vec![(0.0, None); sites];
    let reached = field.distances().iter().zip(field.labels());
    for (v, (&d, &cell)) in mesh.vertices().zip(reached) {
        if let Some(farthest) = farthest.get_mut(cell as usize)
            && d > farthest.0
        {
            *farthest = (d, Some(v));
        }
    }
    farthest.into_iter().map(|(_, v)| v).collect()
}
