//! Validation: finds all defects of a triangle soup in one pass and builds its mesh. Soups without
//! defects take the fast path of [`Sound`] instead.
//!
//! No check hides another: triangles with unusable vertices are left out, and the rest is still
//! checked. One run reports every [`Defect`]. All checks take time linear in the size of the model,
//! up to the sorting of the edges at a vertex.

use crate::build::build;
use crate::defect::Defect;
use crate::edges::EdgeGroups;
use crate::inspection::{Inspection, Metric};
use crate::mesh::Mesh;
use crate::orient::turn_over;
use crate::report::{InvalidMesh, Report};
use crate::sound::Sound;
use crate::soup::TriangleSoup;

impl Mesh {
    /// Checks `soup` and builds its mesh.
    ///
    /// Vertices and triangles keep their numbers. Faces that are oriented against the majority of
    /// their surface are turned over. The report lists repairs and notes. Takes linear time.
    ///
    /// # Errors
    ///
    /// If the model has a fatal defect. The error lists all defects with their elements.
    pub fn from_soup(soup: TriangleSoup) -> Result<(Self, Report), InvalidMesh> {
        let Some(mut sound) = Sound::of(&soup.positions, &soup.triangles) else {
            return Self::from_inspected(soup);
        };
        let notes = std::mem::take(&mut sound.notes);
        let report = Report::new(notes.into_iter().chain(soup.notes).collect());
        Ok((sound.into_mesh(soup.positions, soup.triangles), report))
    }

    /// As [`from_soup`](Self::from_soup), without the fast path.
    pub(crate) fn from_inspected(mut soup: TriangleSoup) -> Result<(Self, Report), InvalidMesh> {
        let mut checked = check(
            soup.positions.len(),
            &soup.triangles,
            Metric::Positions(&soup.positions),
            &soup.file_faces,
        )?;
        if !soup.notes.is_empty() {
            let found = std::mem::take(&mut checked.report.defects);
            checked.report = Report::new(found.into_iter().chain(soup.notes).collect());
        }
        place_unused_vertices(&mut soup.positions, &soup.triangles);
        Ok(checked.into_mesh(soup.positions, soup.triangles))
    }

    /// Builds a mesh from edge lengths alone. `lengths[t][k]` is the length of the edge from corner
    /// `k` of triangle `t` to the next corner, in any unit. Such a surface need not have an
    /// embedding in space.
    ///
    /// ```
    /// use geobench_mesh::Mesh;
    ///
    /// // Two triangles with the same edges: a closed surface without an embedding as a polyhedron.
    /// let lengths = [[3.0, 4.0, 5.0], [5.0, 4.0, 3.0]];
    /// let (mesh, _report) = Mesh::from_lengths(3, &[[0, 1, 2], [0, 2, 1]], &lengths)?;
    /// assert!(mesh.positions().is_empty());
    /// assert_eq!(mesh.length(geobench_mesh::HalfEdgeId::new(1)), 4.0);
    /// # Ok::<(), geobench_mesh::InvalidMesh>(())
    /// ```
    ///
    /// # Errors
    ///
    /// As [`from_soup`](Mesh::from_soup). Also if a length is not positive, differs between both
    /// triangles of an edge, or breaks the triangle inequality.
    pub fn from_lengths(
        vertex_count: usize,
        triangles: &[[u32; 3]],
        lengths: &[[f64; 3]],
    ) -> Result<(Self, Report), InvalidMesh> {
        let checked = check(vertex_count, triangles, Metric::Lengths(lengths), &[])?;
        Ok(checked.into_mesh(Vec::new(), triangles.to_vec()))
    }
}

/// Puts the vertices of a sound soup that have no finite position, and so are in no triangle, at
/// the place of the first corner, so that all positions are finite and the model keeps its size.
fn place_unused_vertices(positions: &mut [[f64; 3]], triangles: &[[u32; 3]]) {
    let Some(place) = triangles.first().map(|t| positions[t[0] as usize]) else {
        return;
    };
    for position in positions {
        if !position.iter().all(|x| x.is_finite()) {
            *position = place;
        }
    }
}

/// A soup without fatal defects.
struct Checked {
    vertex_count: usize,
    report: Report,
    mates: Vec<u32>,
    lengths: Vec<[f64; 3]>,
    flipped: Vec<u32>,
}

impl Checked {
    fn into_mesh(
        mut self,
        positions: Vec<[f64; 3]>,
        mut triangles: Vec<[u32; 3]>,
    ) -> (Mesh, Report) {
        turn_over(
            &self.flipped,
            &mut triangles,
            &mut self.lengths,
            &mut self.mates,
        );
        let mesh = build(
            self.vertex_count,
            positions,
            triangles,
            self.lengths,
            self.mates,
        );
        (mesh, self.report)
    }
}

/// Runs all checks on a soup whose vertices and triangles have 4-byte numbers.
fn check(
    vertex_count: usize,
    triangles: &[[u32; 3]],
    metric: Metric<'_>,
    file_faces: &[u32],
) -> Result<Checked, InvalidMesh> {
    let invalid = |defects| InvalidMesh {
        report: Report::new(defects),
    };
    let mut defects = Vec::new();
    // The largest number is reserved for "none".
    if vertex_count >= u32::MAX as usize || triangles.len() >= u32::MAX as usize / 3 {
        defects.push(Defect::TooLarge {
            vertices: vertex_count,
            triangles: triangles.len(),
        });
    }
    if let Metric::Lengths(lengths) = metric
        && lengths.len() != triangles.len()
    {
        defects.push(Defect::LengthCount {
            triangles: triangles.len(),
            lengths: lengths.len(),
        });
    }
    if !defects.is_empty() {
        return Err(invalid(defects));
    }
    let mut inspection = Inspection::new(vertex_count, triangles, metric, file_faces);
    inspection.check_vertices(triangles);
    let edges = EdgeGroups::new(vertex_count, &inspection.usable.triangles);
    inspection.check_edges(&edges);
    inspection.check_fans(&edges);
    drop(edges);
    inspection.check_shapes();
    inspection.check_components();
    let flipped = inspection.check_orientation();
    let report = Report::new(inspection.defects);
    if report.is_fatal() {
        return Err(InvalidMesh { report });
    }
    Ok(Checked {
        vertex_count,
        report,
        mates: inspection.mates,
        lengths: inspection.lengths,
        flipped,
    })
}
