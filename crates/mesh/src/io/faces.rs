//! The faces of a file, before they are cut into triangles.

use std::collections::{HashMap, HashSet};

use super::error::Flaw;
use super::triangulate::{Budget, TooComplex, other_cuts, triangulate};
use crate::defect::{Defect, FileForm};
use crate::soup::TriangleSoup;

/// Faces with any number of corners, as the file lists them.
#[derive(Debug, Default)]
pub(super) struct FaceList {
    /// All faces, while all are triangles.
    triangles: Vec<[u32; 3]>,
    /// The corners of all faces, one after the other, once there is a polygon.
    corners: Vec<u32>,
    /// Number of corners of each face in `corners`.
    arities: Vec<u32>,
    /// The first line of each departure from the format.
    forms: Vec<(u64, FileForm)>,
}

impl FaceList {
    /// A list with room for `faces` triangles. The caller must have checked that number against the
    /// size of the file.
    pub(super) fn with_capacity(faces: usize) -> Self {
        Self {
            triangles: Vec::with_capacity(faces),
            ..Self::default()
        }
    }

    /// A list of these triangles.
    pub(super) fn of(triangles: Vec<[u32; 3]>) -> Self {
        Self {
            triangles,
            ..Self::default()
        }
    }

    /// Notes a departure from the format in `line`; 0 in binary data.
    pub(super) fn note(&mut self, line: u64, form: FileForm) {
        if self.forms.iter().all(|(_, known)| *known != form) {
            self.forms.push((line, form));
        }
    }

    /// Whether there is no face.
    pub(super) fn is_empty(&self) -> bool {
        self.triangles.is_empty() && self.arities.is_empty()
    }

    /// Appends a face.
    pub(super) fn push(&mut self, corners: &[u32]) {
        if self.arities.is_empty() {
            if let Ok(triangle) = corners.try_into() {
                self.triangles.push(triangle);
                return;
            }
            self.arities = vec![3; self.triangles.len()];
            self.corners = std::mem::take(&mut self.triangles).into_flattened();
        }
        self.arities.push(corners.len() as u32);
        self.corners.extend_from_slice(corners);
    }

    /// Appends the triangles of a strip, every second one turned over. Triangles that repeat a
    /// corner only join two parts of a strip.
    pub(super) fn push_strip(&mut self, strip: &[u32]) {
        for (i, corners) in strip.windows(3).enumerate() {
            let [a, b, c] = [corners[0], corners[1], corners[2]];
            if a != b && b != c && c != a {
                self.push(&if i % 2 == 0 { [a, b, c] } else { [b, a, c] });
            }
        }
    }

    /// The corners of each face.
    fn each(&self) -> impl Iterator<Item = &[u32]> {
        let triangles = self.triangles.iter().map(|corners| &corners[..]);
        let mut rest = &self.corners[..];
        triangles.chain(self.arities.iter().map(move |&arity| {
            let (corners, next) = rest.split_at(arity as usize);
            rest = next;
            corners
        }))
    }

    /// Estimated size in memory.
    pub(super) fn bytes(&self) -> u64 {
        (12 * self.triangles.len() + 4 * self.corners.len() + 4 * self.arities.len()) as u64
    }

    /// Appends the faces of `other`, with `first` added to the numbers of their vertices. `flaw`
    /// tells from the number of a face and a corner of it whether that is invalid.
    pub(super) fn append(
        &mut self,
        other: &Self,
        first: u32,
        flaw: impl Fn(usize, u32) -> Option<Flaw>,
    ) -> Result<(), Flaw> {
        let mut moved = Vec::new();
        for (face, corners) in other.each().enumerate() {
            if let Some(flaw) = corners.iter().find_map(|&corner| flaw(face, corner)) {
                return Err(flaw);
            }
            moved.clear();
            moved.extend(corners.iter().map(|corner| first + corner));
            self.push(&moved);
        }
        Ok(())
    }

    /// Cuts every face into triangles. Faces with fewer than three corners are left out:
    /// `file_faces` still counts them, and the notes have their numbers.
    pub(super) fn into_soup(self, positions: Vec<[f64; 3]>) -> Result<TriangleSoup, Flaw> {
        let mut soup = TriangleSoup::new(positions, self.triangles);
        let mut budget = Budget::for_corners(self.corners.len());
        let mut short = 0;
        let notes = self.forms.into_iter();
        soup.notes
            .extend(notes.map(|(line, form)| Defect::FileForm { line, form }));
        let mut rest = &self.corners[..];
        for (face, &arity) in self.arities.iter().enumerate() {
            let (corners, next) = rest.split_at(arity as usize);
            rest = next;
            let corners = open(corners);
            if corners.len() < 3 {
                short += 1;
                soup.notes.push(Defect::ShortFace { face: face as u32 });
            }
            triangulate(&soup.positions, corners, &mut soup.triangles, &mut budget).map_err(
                |TooComplex| {
                    Flaw::file(format!(
                        "face {face}, counted from 0, has {arity} corners and is not convex, so that \
                         cutting it into triangles takes too long; cut it into smaller faces"
                    ))
                },
            )?;
            soup.file_faces.resize(soup.triangles.len(), face as u32);
        }
        if !self.arities.is_empty() {
            separate_cuts(&mut soup, &self.corners, &self.arities);
        }
        match (soup.positions.len(), soup.triangles.len()) {
            (0, 0) => Err(Flaw::file(
                "there is neither a vertex nor a face in it; is it a file of this format?",
            )),
            (_, 0) if short > 0 => Err(Flaw::file(format!(
                "no face in it has three corners or more ({short} have fewer); a surface is needed"
            ))),
            (vertices, 0) => Err(Flaw::file(format!(
                "there is no face in it, only vertices ({vertices}); a surface is needed"
            ))),
            _ => Ok(soup),
        }
    }
}

/// Why polygons cannot be cut into triangles: there are none, or one is too complex.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{0}")]
pub struct PolygonError(String);

/// The soup of polygons, cut into triangles as those of a file.
///
/// ```
/// use geobench_mesh::{Mesh, io};
///
/// let positions = vec![[0.0; 3], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]];
/// let soup = io::polygons(positions, [[0, 1, 2, 3]])?;
/// let (mesh, _) = Mesh::from_soup(soup)?;
/// assert_eq!(mesh.face_count(), 2);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
///
/// If there is no polygon with three corners or more, or one with very many corners is not convex.
pub fn polygons(
    positions: Vec<[f64; 3]>,
    polygons: impl IntoIterator<Item = impl AsRef<[u32]>>,
) -> Result<TriangleSoup, PolygonError> {
    let mut faces = FaceList::default();
    for corners in polygons {
        faces.push(corners.as_ref());
    }
    let soup = faces.into_soup(positions);
    soup.map_err(|flaw| PolygonError(flaw.problem))
}

/// A polygon without the repetition of its first corner at its end, by which some programs close it.
fn open(mut corners: &[u32]) -> &[u32] {
    while let [first, .., last] = corners
        && corners.len() > 3
        && first == last
    {
        corners = &corners[..corners.len() - 1];
    }
    corners
}

/// Cuts polygons anew whose cuts lie along an edge of another face or a cut of another polygon.
/// There the edge would have more than two faces, although in the file it has not. Two quads around
/// a vertex with two edges are an example: both may be cut between its neighbours. O(n log n) for n
/// corners.
fn separate_cuts(soup: &mut TriangleSoup, corners: &[u32], arities: &[u32]) {
    // For each polygon the range of its corners and that of its triangles.
    let mut polygons = Vec::with_capacity(arities.len());
    let (mut corner, mut triangle) = (0, 0);
    for &arity in arities {
        let outline = open(&corners[corner..corner + arity as usize]).len();
        let count = outline.saturating_sub(2);
        polygons.push((corner..corner + outline, triangle..triangle + count));
        corner += arity as usize;
        triangle += count;
    }
    let mut cuts = Vec::new();
    for (outline, triangles) in polygons.iter().filter(|(outline, _)| outline.len() > 3) {
        let (outline, triangles) = (outline.clone(), triangles.clone());
        push_cuts(&corners[outline], &soup.triangles[triangles], &mut cuts);
    }
    cuts.sort_unstable();
    let filter = CutFilter::of(&cuts);
    let is_cut = |edge: &u64| filter.may_hold(*edge) && cuts.binary_search(edge).is_ok();
    let outlines = || {
        polygons
            .iter()
            .map(|(outline, _)| &corners[outline.clone()])
    };
    let crossed: HashSet<u64> = outlines().flat_map(edges_of).filter(is_cut).collect();
    let is_shared = cuts.windows(2).any(|pair| pair[0] == pair[1]);
    if crossed.is_empty() && !is_shared {
        return;
    }
    // How many polygons are cut along each pair of vertices.
    let mut polygons_cut: HashMap<u64, u32> = HashMap::new();
    for &cut in &cuts {
        *polygons_cut.entry(cut).or_default() += 1;
    }
    let edges: HashSet<u64> = outlines().flat_map(edges_of).collect();
    let mut own = Vec::new();
    for (outline, range) in polygons.iter().filter(|(outline, _)| outline.len() > 3) {
        let outline = &corners[outline.clone()];
        own.clear();
        push_cuts(outline, &soup.triangles[range.clone()], &mut own);
        if own
            .iter()
            .all(|cut| polygons_cut[cut] == 1 && !crossed.contains(cut))
        {
            continue;
        }
        for cut in &own {
            polygons_cut
                .entry(*cut)
                .and_modify(|polygons| *polygons -= 1);
        }
        let other = other_cuts(&soup.positions, outline).find(|triangles| {
            own.clear();
            push_cuts(outline, triangles, &mut own);
            let is_free =
                |cut| !edges.contains(cut) && polygons_cut.get(cut).is_none_or(|&n| n == 0);
            own.iter().all(is_free)
        });
        if let Some(triangles) = other {
            soup.triangles[range.clone()].copy_from_slice(&triangles);
        }
        own.clear();
        push_cuts(outline, &soup.triangles[range.clone()], &mut own);
        for &cut in &own {
            *polygons_cut.entry(cut).or_default() += 1;
        }
    }
}

/// Two vertices as a number, whatever their order.
fn key(a: u32, b: u32) -> u64 {
    (u64::from(a.min(b)) << 32) | u64::from(a.max(b))
}

/// The edges of a polygon.
fn edges_of(outline: &[u32]) -> impl Iterator<Item = u64> + '_ {
    let next = outline.iter().cycle().skip(1);
    outline.iter().zip(next).map(|(&a, &b)| key(a, b))
}

/// Appends the cuts of a polygon: the sides of its triangles that are no edges of it, each once.
fn push_cuts(outline: &[u32], triangles: &[[u32; 3]], cuts: &mut Vec<u64>) {
    if let ([a, _, c, _], [first, second]) = (outline, triangles) {
        // Most polygons are quads, which are cut along one diagonal or the other.
        let joins = |v| first.contains(v) && second.contains(v);
        cuts.push(if joins(a) && joins(c) {
            key(*a, *c)
        } else {
            key(outline[1], outline[3])
        });
        return;
    }
    let mut edges: Vec<u64> = edges_of(outline).collect();
    edges.sort_unstable();
    let sides = triangles
        .iter()
        .flat_map(|&[a, b, c]| [key(a, b), key(b, c), key(c, a)]);
    let mut own: Vec<u64> = sides
        .filter(|side| edges.binary_search(side).is_err())
        .collect();
    own.sort_unstable();
    own.dedup();
    cuts.append(&mut own);
}

/// Tells of most numbers that are not in a list that they are not, by one bit for each hash.
struct CutFilter(Vec<u64>);

impl CutFilter {
    fn of(numbers: &[u64]) -> Self {
        let mut words = vec![0; (numbers.len() / 4).next_power_of_two()];
        for &number in numbers {
            let (word, bit) = Self::place(number, words.len());
            words[word] |= bit;
        }
        Self(words)
    }

    fn place(number: u64, words: usize) -> (usize, u64) {
        let hash = number.wrapping_mul(0x9e37_79b9_7f4a_7c15) >> 26;
        ((hash >> 6) as usize & (words - 1), 1 << (hash & 63))
    }

    fn may_hold(&self, number: u64) -> bool {
        let (word, bit) = Self::place(number, self.0.len());
        self.0[word] & bit != 0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn triangles_stay_as_they_are() {
        let mut faces = FaceList::default();
        faces.push(&[7, 8, 9]);
        faces.push(&[1, 1, 4]);
        let soup = faces.into_soup(vec![[0.0; 3]]).unwrap();
        assert_eq!(soup.triangles, [[7, 8, 9], [1, 1, 4]]);
        assert!(soup.file_faces.is_empty());
    }

    #[test]
    fn file_faces_count_every_face() {
        let square = vec![
            [0.0, 0.0, 0.0],
            [1.0, 0.0, 0.0],
            [1.0, 1.0, 0.0],
            [0.0, 1.0, 0.0],
        ];
        let mut faces = FaceList::default();
        faces.push(&[0, 1, 2]);
        faces.push(&[0, 1]);
        faces.push(&[0, 1, 2, 3]);
        faces.push(&[3, 2, 1]);
        let soup = faces.into_soup(square).unwrap();
        assert_eq!(soup.triangles, [[0, 1, 2], [0, 1, 2], [0, 2, 3], [3, 2, 1]]);
        assert_eq!(soup.file_faces, [0, 2, 2, 3]);
        assert_eq!(soup.notes, [Defect::ShortFace { face: 1 }]);
    }

    #[test]
    fn points_alone_are_no_surface() {
        let mut faces = FaceList::default();
        faces.push(&[0, 1]);
        assert!(faces.into_soup(vec![[0.0; 3]; 2]).is_err());
    }
}
