//! Validation: finds all defects of a triangle soup in one pass and builds its mesh. Soups without
//! defects take the fast path of [`Sound`] instead.
//!
//! No check hides another: triangles with unusable vertices are left out, and the rest is still
//! checked. One run reports every [`Defect`]. All checks take time linear in the size of the model,
//! up to the sorting of the edges at a vertex.

use crate::build::build;
use crate::defect::{Defect, DefectKind};
use crate::edges::EdgeGroups;
use crate::ids::HalfEdgeId;
use crate::inspection::{Inspection, Metric};
use crate::junctions::Junctions;
use crate::mesh::{Mesh, NO_TWIN};
use crate::orient::turn_over;
use crate::report::{InvalidMesh, Report};
use crate::sound::Sound;
use crate::soup::TriangleSoup;
use crate::stand_ins::{LeftOutTriangle, StandIns};
use crate::weld::coincident_vertices;

impl Mesh {
    /// Checks `soup` and builds its mesh.
    ///
    /// Vertices keep their numbers. Faces that are oriented against the majority of their surface
    /// are turned over. Triangles without three different vertices, and second copies, are left
    /// out; the others follow each other ([`file_triangle`](Self::file_triangle)). Both ends of an
    /// edge of no length become one vertex. The report lists repairs and notes. Takes linear time.
    ///
    /// # Errors
    ///
    /// If the model has a fatal defect. The error lists all defects with their elements.
    pub fn from_soup(mut soup: TriangleSoup) -> Result<(Self, Report), InvalidMesh> {
        let mut notes = std::mem::take(&mut soup.notes);
        if let count @ 1.. = welded_on_request(&soup.copies, &notes) {
            notes.push(Defect::WeldedVertices { count });
        }
        let (mesh, mut found) = if let Some(mut sound) = Sound::of(&soup) {
            let found = std::mem::take(&mut sound.notes);
            let mesh = sound.into_mesh(soup.positions, soup.triangles, soup.copies);
            (mesh, found)
        } else {
            soup.merge_ends_of_null_edges();
            notes.append(&mut soup.notes);
            match Self::from_inspected(soup) {
                Ok((mesh, report)) => (mesh, report.defects),
                Err(InvalidMesh { mut report }) => {
                    report.defects.append(&mut notes);
                    let report = Report::new(report.defects);
                    return Err(InvalidMesh { report });
                }
            }
        };
        let is_part = |defect: &Defect| defect.kind() == DefectKind::SeveralComponents;
        let is_connected = !found.iter().any(is_part);
        notes.extend(coincident_vertices(&mesh, is_connected));
        found.append(&mut notes);
        Ok((mesh, Report::new(found)))
    }

    /// The mesh and what the checks find, without the fast path and without the notes of `soup`. No
    /// edge may have ends at one place.
    pub(crate) fn from_inspected(soup: TriangleSoup) -> Result<(Self, Report), InvalidMesh> {
        let checked = check(
            soup.positions.len(),
            &soup.triangles,
            &soup.copies,
            Metric::Positions(&soup.positions),
            &soup.file_faces,
        )?;
        Ok(checked.into_mesh(soup.positions, soup.triangles, soup.copies))
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
        let checked = check(vertex_count, triangles, &[], Metric::Lengths(lengths), &[])?;
        Ok(checked.into_mesh(Vec::new(), triangles.to_vec(), Vec::new()))
    }
}

/// The number of copies that no note says to be an end of an edge of no length.
fn welded_on_request(copies: &[[u32; 2]], notes: &[Defect]) -> u32 {
    let mut ends: Vec<u32> = Vec::new();
    for note in notes {
        if let Defect::ZeroLengthEdge { vertices, .. } = note {
            ends.extend(vertices);
        }
    }
    ends.sort_unstable();
    let is_end = |copy: &&[u32; 2]| ends.binary_search(&copy[0]).is_ok();
    (copies.len() - copies.iter().filter(is_end).count()) as u32
}

/// Puts the vertices of a sound soup that have no finite position, and so are in no triangle, at
/// the place of the first corner, so that all positions are finite and the model keeps its size.
fn place_unused_vertices(positions: &mut [[f64; 3]], triangles: &[[u32; 3]]) {
    let corner = triangles.first().map(|t| t[0] as usize);
    // A mesh known by its lengths has no positions.
    let Some(place) = corner.and_then(|v| positions.get(v).copied()) else {
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
    /// The indices of the triangles that are used; `None` for all.
    places: Option<Vec<u32>>,
    mates: Vec<u32>,
    lengths: Vec<[f64; 3]>,
    flipped: Vec<u32>,
    has_junctions: bool,
}

impl Checked {
    fn into_mesh(
        mut self,
        mut positions: Vec<[f64; 3]>,
        triangles: Vec<[u32; 3]>,
        copies: Vec<[u32; 2]>,
    ) -> (Mesh, Report) {
        let (mut triangles, left_out) = self.split(triangles);
        place_unused_vertices(&mut positions, &triangles);
        turn_over(
            &self.flipped,
            &mut triangles,
            &mut self.lengths,
            &mut self.mates,
        );
        let junctions = if self.has_junctions {
            cut_at_junctions(self.vertex_count, &triangles, &mut self.mates)
        } else {
            Junctions::default()
        };
        let mesh = build(
            self.vertex_count,
            positions,
            triangles,
            self.lengths,
            (self.mates, junctions),
            StandIns {
                copies,
                left_out,
                turned: self.flipped,
            },
        );
        (mesh, self.report)
    }

    /// The triangles that are used, and the others.
    fn split(&self, triangles: Vec<[u32; 3]>) -> (Vec<[u32; 3]>, Vec<LeftOutTriangle>) {
        let Some(places) = &self.places else {
            return (triangles, Vec::new());
        };
        let mut used = places.iter().peekable();
        let (mut kept, mut left_out) = (Vec::with_capacity(places.len()), Vec::new());
        for (number, corners) in (0..).zip(triangles) {
            if used.next_if_eq(&&number).is_some() {
                kept.push(corners);
            } else {
                left_out.push(LeftOutTriangle { number, corners });
            }
        }
        (kept, left_out)
    }
}

/// Finds the [junctions](Mesh::junction) of oriented triangles, and parts the half-edges along
/// them.
fn cut_at_junctions(vertex_count: usize, triangles: &[[u32; 3]], mates: &mut [u32]) -> Junctions {
    let tails = triangles.as_flattened();
    let edges = EdgeGroups::new(vertex_count, triangles);
    let junctions = edges.iter().filter(|edge| match edge.pair() {
        Some([a, b]) => tails[a as usize] == tails[b as usize],
        None => edge.side_count() > 2,
    });
    let junctions: Vec<Vec<u32>> = junctions.map(|edge| edge.half_edges().collect()).collect();
    for &h in junctions.iter().flatten() {
        mates[h as usize] = NO_TWIN;
    }
    Junctions::new(
        junctions
            .into_iter()
            .map(|junction| junction.into_iter().map(HalfEdgeId::new)),
    )
}

/// Runs all checks on a soup whose vertices and triangles have 4-byte numbers.
fn check(
    vertex_count: usize,
    triangles: &[[u32; 3]],
    copies: &[[u32; 2]],
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
    inspection.check_vertices(triangles, copies);
    let mut edges = EdgeGroups::new(vertex_count, &inspection.usable.triangles);
    if inspection.leave_out_repeated_faces(&edges) {
        edges = EdgeGroups::new(vertex_count, &inspection.usable.triangles);
    }
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
    let is_junction = |kind| {
        matches!(
            kind,
            DefectKind::NonManifoldEdge | DefectKind::NotOrientable
        )
    };
    let mut kinds = report.defects.iter().map(Defect::kind);
    Ok(Checked {
        vertex_count,
        has_junctions: kinds.any(is_junction),
        report,
        places: inspection.usable.places,
        mates: inspection.mates,
        lengths: inspection.lengths,
        flipped,
    })
}
