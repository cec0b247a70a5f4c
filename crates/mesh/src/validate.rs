//! Finds everything that is wrong with a triangle soup, in one pass.

use crate::build::build;
use crate::mesh::Mesh;
use crate::soup::TriangleSoup;

/// Something about a model that a user should know.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum Defect {}

/// What was repaired or noticed in a mesh that can be used.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Report {
    /// Every defect found, in the order of their kinds and then of their elements.
    pub defects: Vec<Defect>,
}

/// A model that no exact algorithm can work on.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("the mesh is invalid")]
pub struct InvalidMesh {
    /// What was found, the fatal defects among them.
    pub report: Report,
}

impl Mesh {
    /// Checks `soup` and builds its mesh.
    ///
    /// # Errors
    ///
    /// Names every element that makes the mesh unusable.
    pub fn from_soup(soup: TriangleSoup) -> Result<(Mesh, Report), InvalidMesh> {
        let p = &soup.positions;
        let distance = |a: u32, b: u32| {
            // Ordered, so that both half-edges of an edge get the same bits.
            let (a, b) = (p[a.min(b) as usize], p[a.max(b) as usize]);
            ((a[0] - b[0]).powi(2) + (a[1] - b[1]).powi(2) + (a[2] - b[2]).powi(2)).sqrt()
        };
        let lengths: Vec<[f64; 3]> = soup
            .triangles
            .iter()
            .map(|t| {
                [
                    distance(t[0], t[1]),
                    distance(t[1], t[2]),
                    distance(t[2], t[0]),
                ]
            })
            .collect();
        let vertex_count = p.len();
        let mesh = build(vertex_count, soup.positions, &soup.triangles, &lengths);
        Ok((mesh, Report::default()))
    }

    /// Builds a mesh from edge lengths alone: `lengths[t][k]` belongs to the edge from corner `k`
    /// of triangle `t` to the next corner.
    ///
    /// # Errors
    ///
    /// As [`from_soup`](Mesh::from_soup).
    pub fn from_lengths(
        vertex_count: usize,
        triangles: &[[u32; 3]],
        lengths: &[[f64; 3]],
    ) -> Result<(Mesh, Report), InvalidMesh> {
        Ok((
            build(vertex_count, Vec::new(), triangles, lengths),
            Report::default(),
        ))
    }
}
