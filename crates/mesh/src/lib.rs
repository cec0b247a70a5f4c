//! Half-edge triangle meshes for geodesic distances: files, validation, generators.
//!
//! A model is read from a file ([`io::read`]) or made by a generator ([`generate::generate`]) as a
//! [`TriangleSoup`], in the numbering of the file and at the full precision of its numbers.
//! [`Mesh::from_soup`] finds every [`Defect`] in one pass and repairs the orientation where that is
//! possible. It builds a [`Mesh`], or returns an error that names the elements:
//!
//! ```
//! use geobench_mesh::{Mesh, TriangleSoup};
//!
//! let positions = vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]];
//! // The second triangle is the wrong way round.
//! let soup = TriangleSoup::new(positions, vec![[0, 1, 2], [0, 3, 2]]);
//! let (mesh, report) = Mesh::from_soup(soup)?;
//! assert_eq!(report.defects.len(), 1);
//! assert_eq!(mesh.face_count(), 2);
//! # Ok::<(), geobench_mesh::InvalidMesh>(())
//! ```
//!
//! Shortest paths are intrinsic: they depend only on the lengths of edges and on which faces share
//! them. So a mesh stores the length of every half-edge. It can also be built from lengths alone
//! ([`Mesh::from_lengths`]), for surfaces without an embedding in space. A half-edge has the number
//! `3 * face + corner`, so only the twin is stored as a link. A mesh is immutable.
//!
//! Surfaces need not be closed, connected or manifold at every vertex. Components without a source
//! are at infinite distance. Paths pass through a *pinched* vertex, at which several fans of faces
//! meet. Edges may have more than two faces, and surfaces need not be orientable: such edges are
//! [junctions](Mesh::junction).
//!
//! [`Weld`] makes vertices at one place one vertex. Vertices and triangles keep the numbers of the
//! file: [`Mesh::kept_vertex`], [`Mesh::file_triangle`].

mod build;
mod corner;
mod curve;
mod defect;
mod disjoint_sets;
mod edges;
mod frames;
pub mod generate;
mod ids;
mod inspection;
pub mod io;
mod junctions;
mod measure;
mod mesh;
mod nearest;
mod numbering;
mod orient;
mod point;
pub mod precision;
mod random;
mod refine;
mod report;
mod rows;
mod sanity;
mod sound;
mod soup;
mod splice;
mod stand_ins;
mod suggestion;
pub mod threads;
pub mod tolerance;
mod validate;
pub mod vector;
mod weld;

pub use curve::{Curve, CurveError, CurveSegment};
pub use defect::{Defect, DefectKind, FileForm, LONGEST_EDGE, SHORTEST_EDGE, Severity};
pub use disjoint_sets::DisjointSets;
pub use frames::FaceShapes;
pub use ids::{FaceId, HalfEdgeId, VertexId};
pub use measure::MeshMeasures;
pub use mesh::{Mesh, MeshError};
pub use nearest::NearestPoint;
pub use numbering::Numbering;
pub use point::{Place, PointError, SurfacePoint};
pub use random::SplitMix64;
pub use refine::{Insertion, Motion, Refined};
pub use report::{DefectSummary, InvalidMesh, Report};
pub use rows::RowTable;
pub use soup::TriangleSoup;
pub use splice::Splice;
pub use suggestion::did_you_mean;
pub use tolerance::Tolerance;
pub use weld::{Weld, WeldError};
