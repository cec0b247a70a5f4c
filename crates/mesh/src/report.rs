//! The report of validation.

use std::fmt;

use crate::defect::{Defect, DefectKind, LONGEST_EDGE, SHORTEST_EDGE, Severity};

/// All defects of a model, with their elements.
///
/// ```
/// use geobench_mesh::{DefectKind, Mesh};
///
/// // An edge is too long, and one vertex does not exist.
/// let positions = vec![[0.0; 3], [1e99, 0.0, 0.0], [0.0, 1.0, 0.0]];
/// let invalid = Mesh::new(positions, vec![[0, 1, 2], [0, 2, 7]]).unwrap_err();
/// assert!(invalid.report.is_fatal());
/// let kinds: Vec<_> = invalid.report.defects.iter().map(|defect| defect.kind()).collect();
/// let [long, missing] = [DefectKind::LengthOutOfRange, DefectKind::IndexOutOfRange];
/// assert_eq!(kinds, [missing, long, long]);
/// ```
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Report {
    /// The defects, ordered by kind and then by elements.
    pub defects: Vec<Defect>,
}

/// All defects of one kind in one sentence.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct DefectSummary {
    /// The kind.
    pub kind: DefectKind,
    /// Number of defects. Of a defect that counts components or vertices, their number.
    pub count: usize,
    /// A sentence that names the defect, the number of elements and the first few of them.
    pub text: String,
    /// A remedy; empty if none is needed.
    pub advice: String,
}

/// The error for a model with fatal defects.
///
/// The message has one line: for each fatal kind the number of defects, the first elements and a
/// remedy. `report` lists all defects.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub struct InvalidMesh {
    /// All defects, fatal and others.
    pub report: Report,
}

impl Report {
    /// Sorts `defects` and drops repeats. The edges of a duplicate face, and the triangles of one
    /// polygon, report the same elements.
    pub(crate) fn new(mut defects: Vec<Defect>) -> Self {
        defects.sort_by_key(Defect::sort_key);
        defects.dedup();
        Self { defects }
    }

    /// Whether a defect is fatal.
    pub fn is_fatal(&self) -> bool {
        self.with_severity(Severity::Fatal).next().is_some()
    }

    /// The defects of this severity.
    pub fn with_severity(&self, severity: Severity) -> impl Iterator<Item = &Defect> {
        self.defects
            .iter()
            .filter(move |defect| defect.severity() == severity)
    }

    /// What a user should know before using the mesh, in at most two lines: repairs and notes
    /// without their elements, but with the departures from a format, then vertices that welding
    /// would join.
    pub fn notes(&self) -> Vec<String> {
        let (joinable, others): (Vec<_>, Vec<_>) = self
            .summaries()
            .into_iter()
            .filter(|summary| summary.kind.severity() != Severity::Fatal)
            .partition(|summary| summary.kind == DefectKind::CoincidentVertices);
        let others = others.iter().map(|s| match s.kind {
            DefectKind::FileForm => s.text.clone(),
            kind => headline(kind, s.count),
        });
        let others: Vec<String> = others.collect();
        let mut notes: Vec<String> = Vec::new();
        if !others.is_empty() {
            notes.push(others.join("; "));
        }
        notes.extend(joinable.iter().map(|s| format!("{}; {}", s.text, s.advice)));
        notes
    }

    /// One sentence for each kind of defect, in the order of [`DefectKind`], fatal ones first.
    pub fn summaries(&self) -> Vec<DefectSummary> {
        let kinds = self.defects.chunk_by(|x, y| x.kind() == y.kind());
        let mut summaries: Vec<DefectSummary> = kinds.map(summarize).collect();
        let is_left_out = |s: &DefectSummary| s.kind == DefectKind::CollapsedFace;
        if summaries.iter().any(is_left_out)
            && let Some(none) = summaries.iter_mut().find(|s| s.kind == DefectKind::NoFaces)
        {
            none.text.push_str(" left");
            "distances need a surface".clone_into(&mut none.advice);
        }
        summaries
    }
}

impl fmt::Display for InvalidMesh {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut separator = "the mesh cannot be used: ";
        let mut names_elements = false;
        let summaries = self.report.summaries();
        let has_no_faces = summaries
            .iter()
            .any(|summary| summary.kind == DefectKind::NoFaces);
        for summary in summaries {
            // These explain why there are no faces.
            let explains = has_no_faces
                && matches!(
                    summary.kind,
                    DefectKind::CollapsedFace | DefectKind::WeldedVertices
                );
            if summary.kind.severity() == Severity::Fatal || explains {
                write!(f, "{separator}{}", summary.text)?;
                if !summary.advice.is_empty() {
                    write!(f, "; {}", summary.advice)?;
                }
                if summary.kind == DefectKind::WeldedVertices {
                    f.write_str("; --weld with a smaller tolerance, or none, joins less")?;
                }
                separator = ". Also: ";
                names_elements |= !matches!(
                    summary.kind,
                    DefectKind::NoVertices | DefectKind::NoFaces | DefectKind::TooLarge
                );
            }
        }
        if names_elements {
            f.write_str(" (vertices and faces are counted from 0)")?;
        }
        Ok(())
    }
}

/// Summarises defects of one kind. There must be at least one.
fn summarize(defects: &[Defect]) -> DefectSummary {
    const SHOWN: usize = 3;
    let kind = defects[0].kind();
    let count = match &defects[0] {
        Defect::SeveralComponents { triangles } => triangles.len(),
        Defect::WeldedVertices { count }
        | Defect::Parts { parts: count }
        | Defect::Unposed { meshes: count } => *count as usize,
        Defect::CoincidentVertices { exact, near, .. } => match exact {
            0 => *near as usize,
            exact => *exact as usize,
        },
        _ => defects.len(),
    };
    let mut text = match &defects[0] {
        Defect::CoincidentVertices {
            exact: 0,
            near,
            tolerance,
            ..
        } => {
            let lie = if *near == 1 {
                "vertex lies"
            } else {
                "vertices lie"
            };
            format!("{near} {lie} within {tolerance:e} of the size of another")
        }
        _ => headline(kind, count),
    };
    let mut names: Vec<String> = defects.iter().take(SHOWN).map(Defect::to_string).collect();
    names.retain(|name| !name.is_empty());
    if !names.is_empty() {
        let more = match defects.len().saturating_sub(SHOWN) {
            0 => String::new(),
            more => format!("; and {more} more"),
        };
        text = format!("{text} ({}{more})", names.join("; "));
    }
    DefectSummary {
        kind,
        count,
        text,
        advice: advice(kind, defects),
    }
}

/// The text that names the defect, for `count` elements.
fn headline(kind: DefectKind, count: usize) -> String {
    let (one, many) = match kind {
        DefectKind::NoVertices => return "it has no vertices".to_owned(),
        DefectKind::NoFaces => return "it has no faces".to_owned(),
        DefectKind::TooLarge => return "it has too many elements".to_owned(),
        DefectKind::LengthCount => return "lengths and triangles do not match".to_owned(),
        DefectKind::SeveralComponents => {
            return format!("{count} components that are not connected");
        }
        DefectKind::IndexOutOfRange => (
            "face corner names a vertex that does not exist",
            "face corners name vertices that do not exist",
        ),
        DefectKind::NonFiniteCoordinate => (
            "vertex has a coordinate that is not a finite number",
            "vertices have coordinates that are not finite numbers",
        ),
        DefectKind::RepeatedVertex => (
            "face names one vertex several times",
            "faces name one vertex several times",
        ),
        DefectKind::ZeroLengthEdge => (
            "edge has no length, and its ends are made one vertex",
            "edges have no length, and their ends are made one vertex",
        ),
        DefectKind::RepeatedFace => (
            "face has the same vertices as another and is left out",
            "faces have the same vertices as others and are left out",
        ),
        DefectKind::CollapsedFace => (
            "face has several corners at one vertex and is left out",
            "faces have several corners at one vertex and are left out",
        ),
        DefectKind::WeldedVertices => (
            "vertex was welded to another",
            "vertices were welded to others",
        ),
        DefectKind::CoincidentVertices => (
            "vertex lies at the place of another",
            "vertices lie at the place of another",
        ),
        DefectKind::LengthOutOfRange => (
            "edge has a length that cannot be computed with",
            "edges have lengths that cannot be computed with",
        ),
        DefectKind::UnequalLengths => (
            "edge has different lengths in its two triangles",
            "edges have different lengths in their two triangles",
        ),
        DefectKind::TriangleInequality => (
            "triangle has a side longer than the two others together",
            "triangles have a side longer than the two others together",
        ),
        DefectKind::NonManifoldEdge => (
            "edge has more than two faces",
            "edges have more than two faces",
        ),
        DefectKind::NotOrientable => (
            "surface cannot be oriented, it has only one side",
            "surfaces cannot be oriented, they have only one side",
        ),
        DefectKind::DuplicateFace => (
            "face has the same vertices as another, whose other side it is",
            "faces have the same vertices as others, whose other sides they are",
        ),
        DefectKind::FlippedFace => (
            "face was wound against its neighbours and is used turned over",
            "faces were wound against their neighbours and are used turned over",
        ),
        DefectKind::ShortFace => (
            "face has fewer than three corners and is left out",
            "faces have fewer than three corners and are left out",
        ),
        DefectKind::FlatFace => ("face has no area", "faces have no area"),
        DefectKind::PinchedVertex => (
            "vertex joins several fans of faces",
            "vertices join several fans of faces",
        ),
        DefectKind::IsolatedVertex => (
            "vertex is in no face and cannot be reached",
            "vertices are in no face and cannot be reached",
        ),
        DefectKind::UnplacedVertex => (
            "vertex in no face has no finite position and is put at a corner of the first face",
            "vertices in no face have no finite position and are put at a corner of the first face",
        ),
        DefectKind::FileForm => (
            "departure from the file's format",
            "departures from the file's format",
        ),
        DefectKind::Parts => (
            "mesh of the file",
            "meshes of the file are parts of one model",
        ),
        DefectKind::Unposed => (
            "mesh has a skin or a morph, which is not applied",
            "meshes have skins or morphs, which are not applied",
        ),
    };
    format!("{count} {}", if count == 1 { one } else { many })
}

/// The remedy for `defects`, which are of this kind.
fn advice(kind: DefectKind, defects: &[Defect]) -> String {
    match kind {
        DefectKind::CoincidentVertices => match defects {
            [
                Defect::CoincidentVertices {
                    near: 1..,
                    tolerance,
                    ..
                },
            ] => {
                return format!("--weld={tolerance:e} does it");
            }
            _ => "--weld does it",
        },
        DefectKind::NoVertices | DefectKind::ShortFace | DefectKind::FileForm => {
            "check that the file is complete"
        }
        DefectKind::NoFaces => "distances need a surface: triangulate the points first",
        DefectKind::TooLarge => "split or simplify the model",
        DefectKind::LengthCount => "give three lengths for each triangle",
        DefectKind::IndexOutOfRange => "correct the numbers or check that the file is complete",
        DefectKind::NonFiniteCoordinate => "correct or remove them",
        DefectKind::RepeatedVertex => "remove such faces",
        DefectKind::LengthOutOfRange => {
            // Only lengths that were given can be negative or not a number.
            let is_no_length = |defect: &Defect| {
                matches!(defect, Defect::LengthOutOfRange { length, .. } if length.is_nan() || *length < 0.0)
            };
            let action = if defects.iter().any(is_no_length) {
                "correct the lengths"
            } else {
                "scale the model"
            };
            return format!(
                "{action}, so that all lengths lie between {SHORTEST_EDGE:e} and {LONGEST_EDGE:e}"
            );
        }
        DefectKind::UnequalLengths => "give both triangles of an edge the same number",
        DefectKind::TriangleInequality => "correct the lengths",
        DefectKind::DuplicateFace => "remove the second of each if that was not meant",
        DefectKind::FlippedFace
        | DefectKind::NonManifoldEdge
        | DefectKind::NotOrientable
        | DefectKind::RepeatedFace
        | DefectKind::CollapsedFace
        | DefectKind::ZeroLengthEdge
        | DefectKind::WeldedVertices
        | DefectKind::FlatFace
        | DefectKind::PinchedVertex
        | DefectKind::SeveralComponents
        | DefectKind::Parts
        | DefectKind::Unposed
        | DefectKind::IsolatedVertex
        | DefectKind::UnplacedVertex => "",
    }
    .to_owned()
}
