//! The dual of a diagram: a triangle of sources for each Voronoi vertex.

use std::collections::HashMap;
use std::fmt;

use geobench_mesh::TriangleSoup;

use super::Diagram;

/// The dual of a [`Diagram`]: sources whose cells meet in a Voronoi vertex form a triangle.
///
/// ```
/// use geobench_mesh::{Mesh, VertexId};
/// use geobench_voronoi::{Diagram, FieldSolver, WindowVtp};
///
/// let mesh = Mesh::generate("sphere,subdiv=2")?;
/// let mut solver = WindowVtp::new(&mesh);
/// let sources: Vec<VertexId> = (0..12).map(VertexId::new).collect();
/// let dual = Diagram::new(&solver.field(&sources)?, sources.len()).dual();
/// // The first vertices are those of an icosahedron.
/// assert_eq!((dual.triangles.len(), dual.obstacles.len()), (20, 0));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Dual {
    /// Triangles of sources, in the orientation of the surface.
    pub triangles: Vec<[u32; 3]>,
    /// The nodes of Voronoi vertices at which more than three cells meet. The polygon of each was
    /// cut into triangles from its first corner, unless it is an
    /// [obstacle](Obstacle::TwiceAtVertex).
    pub split: Vec<u32>,
    /// Reasons why the triangles are not a triangulation; empty if none was found.
    pub obstacles: Vec<Obstacle>,
}

/// Why the dual of a diagram is not a triangulation.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Obstacle {
    /// A cell that is not a disc.
    NoDisc {
        /// The cell.
        cell: u32,
        /// The [Euler characteristic](super::VoronoiCell::euler) of its interior.
        euler: i64,
    },
    /// A Voronoi vertex around which one cell occurs twice.
    TwiceAtVertex {
        /// The node of the vertex.
        node: u32,
        /// The cell.
        cell: u32,
    },
    /// A disc without Voronoi vertices, as of two sources on a sphere.
    NoTriangle {
        /// The cell.
        cell: u32,
    },
    /// Two cells that share several borders.
    SeveralBorders {
        /// The cells.
        cells: [u32; 2],
    },
}

impl fmt::Display for Obstacle {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NoDisc { cell, euler: 0 } => {
                write!(
                    f,
                    "cell {cell} is no disc: it has a hole or a handle, or is empty"
                )
            }
            Self::NoDisc { cell, euler: 1.. } => {
                write!(
                    f,
                    "cell {cell} is no disc: it is not in one piece, or the whole surface"
                )
            }
            Self::NoDisc { cell, .. } => {
                write!(f, "cell {cell} is no disc: it has holes or handles")
            }
            Self::TwiceAtVertex { node, cell } => {
                write!(
                    f,
                    "cell {cell} meets itself at the Voronoi vertex of node {node}"
                )
            }
            Self::NoTriangle { cell } => {
                write!(f, "cell {cell} has no Voronoi vertex, so no triangle")
            }
            Self::SeveralBorders { cells: [a, b] } => {
                write!(f, "cells {a} and {b} share several borders")
            }
        }
    }
}

/// The error of a dual that is not a triangulation: its obstacles.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub struct NoTriangulation(pub Vec<Obstacle>);

impl fmt::Display for NoTriangulation {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        /// The greatest number of obstacles that are named.
        const NAMED: usize = 4;
        write!(f, "the dual is no triangulation: ")?;
        for (i, obstacle) in self.0.iter().take(NAMED).enumerate() {
            write!(f, "{}{obstacle}", if i > 0 { "; " } else { "" })?;
        }
        if self.0.len() > NAMED {
            write!(f, "; and {} more", self.0.len() - NAMED)?;
        }
        write!(f, "; add sources there")
    }
}

impl Dual {
    /// The dual as a triangle mesh. `corners` are the positions of the sources, one for each, in
    /// their order.
    ///
    /// # Errors
    ///
    /// If the dual has obstacles.
    pub fn triangulation(&self, corners: Vec<[f64; 3]>) -> Result<TriangleSoup, NoTriangulation> {
        if !self.obstacles.is_empty() {
            return Err(NoTriangulation(self.obstacles.clone()));
        }
        Ok(TriangleSoup::new(corners, self.triangles.clone()))
    }
}

impl Diagram {
    /// The dual of the diagram, with the obstacles that keep it from being a triangulation.
    pub fn dual(&self) -> Dual {
        let mut dual = Dual::default();
        for (cell, found) in (0..).zip(&self.cells) {
            if !found.is_disc() {
                let euler = found.euler;
                dual.obstacles.push(Obstacle::NoDisc { cell, euler });
            }
        }
        let mut edges: HashMap<[u32; 2], u32> = HashMap::new();
        for vertex in self.vertices() {
            let (node, around) = (vertex.node, &vertex.cells);
            if around.len() > 3 {
                dual.split.push(node);
            }
            let mut sorted = around.clone();
            sorted.sort_unstable();
            if let Some(pair) = sorted.windows(2).find(|pair| pair[0] == pair[1]) {
                let cell = pair[0];
                dual.obstacles.push(Obstacle::TwiceAtVertex { node, cell });
                continue;
            }
            for i in 1..around.len() - 1 {
                let [a, b, c] = [around[0], around[i], around[i + 1]];
                dual.triangles.push([a, b, c]);
                for edge in [[a, b], [b, c], [c, a]] {
                    *edges.entry(edge).or_default() += 1;
                }
            }
        }
        let mut has_triangle = vec![false; self.cells.len()];
        for &corner in dual.triangles.as_flattened() {
            has_triangle[corner as usize] = true;
        }
        let cells = (0..).zip(self.cells.iter().zip(has_triangle));
        let alone = cells.filter(|(_, (cell, has_triangle))| cell.is_disc() && !has_triangle);
        let alone = alone.map(|(cell, _)| Obstacle::NoTriangle { cell });
        dual.obstacles.extend(alone);
        let mut several: Vec<[u32; 2]> = edges
            .into_iter()
            .filter(|(_, count)| *count > 1)
            .map(|([a, b], _)| [a.min(b), a.max(b)])
            .collect();
        several.sort_unstable();
        several.dedup();
        let several = several.into_iter();
        let obstacles = several.map(|cells| Obstacle::SeveralBorders { cells });
        dual.obstacles.extend(obstacles);
        dual
    }
}
