//! Sites along the boundary of a surface.

use std::collections::HashSet;
use std::f64::consts::PI;

use geobench_mesh::{HalfEdgeId, Mesh, PointError, SurfacePoint, VertexId};

/// Least difference from π of the angle at a boundary vertex that is a corner.
const CORNER: f64 = PI / 4.0;

/// Least number of sites on a boundary loop.
const FEWEST: usize = 3;

/// Factor by which the spacing grows while there are too many sites.
const COARSER: f64 = 1.25;

/// Greatest number of times that the spacing grows, far beyond any model.
const ROUNDS: usize = 200;

/// Points along every boundary loop, at most `spacing` apart, with all corners. If there are more
/// than `most`, the spacing grows; at least three points remain on each loop.
///
/// # Errors
///
/// If a point is not on the mesh, which is a defect of the program.
pub(super) fn points(
    mesh: &Mesh,
    spacing: f64,
    most: usize,
) -> Result<Vec<SurfacePoint>, PointError> {
    let chains: Vec<Vec<Chain>> = loops(mesh).into_iter().map(|l| chains(mesh, l)).collect();
    let mut spacing = spacing;
    let count = |spacing: f64| -> usize {
        let counts = chains.iter().map(|chains| {
            let pieces = chains
                .iter()
                .map(|chain| chain.pieces(spacing, chains.len()));
            pieces.sum::<usize>()
        });
        counts.sum()
    };
    for _ in 0..ROUNDS {
        if count(spacing) <= most {
            break;
        }
        spacing *= COARSER;
    }
    let mut points = Vec::new();
    for chains in &chains {
        for chain in chains {
            chain.divide(mesh, chain.pieces(spacing, chains.len()), &mut points)?;
        }
    }
    Ok(points)
}

/// The boundary loops, each as its half-edges in order.
fn loops(mesh: &Mesh) -> Vec<Vec<HalfEdgeId>> {
    let mut seen = HashSet::new();
    let mut loops = Vec::new();
    for start in mesh.half_edges().filter(|&h| mesh.twin(h).is_none()) {
        let mut around = Vec::new();
        let mut h = start;
        while seen.insert(h) {
            around.push(h);
            // The next boundary half-edge is found by turning around the head, across the faces of
            // its fan.
            h = h.next();
            while let Some(twin) = mesh.twin(h) {
                h = twin.next();
            }
        }
        if !around.is_empty() {
            loops.push(around);
        }
    }
    loops
}

/// A part of the boundary from one corner to the next, or a whole loop without corners.
struct Chain {
    edges: Vec<HalfEdgeId>,
    length: f64,
}

/// The chains of a loop.
fn chains(mesh: &Mesh, mut around: Vec<HalfEdgeId>) -> Vec<Chain> {
    let is_corner = |v: VertexId| (mesh.total_angle(v) - PI).abs() > CORNER;
    if let Some(first) = around.iter().position(|&h| is_corner(mesh.tail(h))) {
        around.rotate_left(first);
    }
    let mut chains: Vec<Chain> = Vec::new();
    for h in around {
        let length = mesh.length(h);
        match chains.last_mut().filter(|_| !is_corner(mesh.tail(h))) {
            Some(chain) => {
                chain.edges.push(h);
                chain.length += length;
            }
            None => chains.push(Chain {
                edges: vec![h],
                length,
            }),
        }
    }
    chains
}

impl Chain {
    /// The number of equal pieces into which the chain is divided. None is longer than `spacing`,
    /// and a loop of `chains` chains has at least [`FEWEST`] pieces.
    fn pieces(&self, spacing: f64, chains: usize) -> usize {
        #[expect(clippy::cast_sign_loss, reason = "lengths are positive")]
        let needed = (self.length / spacing - 1e-9).ceil().max(1.0) as usize;
        needed.max(FEWEST.div_ceil(chains))
    }

    /// Adds the points at which pieces begin.
    fn divide(
        &self,
        mesh: &Mesh,
        pieces: usize,
        points: &mut Vec<SurfacePoint>,
    ) -> Result<(), PointError> {
        let (mut before, mut next) = (0.0, 0);
        for &h in &self.edges {
            let length = mesh.length(h);
            while next < pieces {
                let along = self.length * (next as f64 / pieces as f64) - before;
                if along >= length * (1.0 - 1e-9) {
                    break;
                }
                let ends = [mesh.tail(h), mesh.head(h)];
                points.push(if along <= 1e-9 * length {
                    ends[0].into()
                } else {
                    mesh.point_on_edge(ends, along / length)?
                });
                next += 1;
            }
            before += length;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_sides_of_a_square_are_divided_evenly() {
        let mesh = Mesh::generate("grid,n=10").unwrap();
        let sites = points(&mesh, 3.0, 1000).unwrap();
        // Each side of length 10 in four pieces.
        assert_eq!(sites.len(), 16);
        let low = mesh.positions()[0];
        for site in &sites {
            let position = mesh.position_of(site).unwrap();
            let on = [0, 1].map(|k| (position[k] - low[k]) / 2.5);
            assert!(on.iter().all(|x| (x - x.round()).abs() < 1e-9), "{on:?}");
        }
        // Too many: only corners are left.
        assert_eq!(points(&mesh, 3.0, 4).unwrap().len(), 4);
        let closed = Mesh::generate("sphere,subdiv=1").unwrap();
        assert_eq!(points(&closed, 0.1, 1000).unwrap(), []);
    }

    #[test]
    fn every_loop_gets_three_points() {
        let mesh = Mesh::generate("holes,holes=2").unwrap();
        let count = loops(&mesh).len();
        assert_eq!(count, geobench_mesh::MeshMeasures::of(&mesh).boundary_loops);
        let sites = points(&mesh, f64::INFINITY, 1000).unwrap();
        assert!(sites.len() >= 3 * count, "{} on {count}", sites.len());
    }
}
