//! The faces of a file, before they are cut into triangles.

use std::cmp::Ordering;
use std::collections::hash_map::Entry;
use std::collections::{HashMap, HashSet};
use std::ops::Range;

use super::error::Flaw;
use super::triangulate::{Budget, TooComplex, other_cuts, triangulate};
use crate::defect::{Defect, FileForm};
use crate::soup::TriangleSoup;
use crate::weld::{Weld, kept_vertices, null_sides};

/// The contents of a file: vertices, and faces that are not yet cut into triangles.
#[derive(Debug, Default)]
pub(super) struct FileMesh {
    pub(super) positions: Vec<[f64; 3]>,
    pub(super) faces: FaceList,
}

/// Faces with any number of corners, as the file lists them.
#[derive(Debug, Default)]
pub(super) struct FaceList {
    /// All faces, while all are triangles.
    triangles: Vec<[u32; 3]>,
    /// The corners of all faces, one after the other, once there is a polygon.
    corners: Vec<u32>,
    /// Number of corners of each face in `corners`.
    arities: Vec<u32>,
    /// What reading has found.
    notes: Vec<Defect>,
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

    /// Notes a departure from the format in `line`; 0 in binary data. Only the first of each kind
    /// is kept.
    pub(super) fn note_form(&mut self, line: u64, form: FileForm) {
        if !self.has_form(form) {
            self.note(Defect::FileForm { line, form });
        }
    }

    /// Whether a departure of this kind is noted.
    pub(super) fn has_form(&self, form: FileForm) -> bool {
        let is_known =
            |note: &Defect| matches!(note, Defect::FileForm { form: known, .. } if *known == form);
        self.notes.iter().any(is_known)
    }

    pub(super) fn note(&mut self, note: Defect) {
        self.notes.push(note);
    }

    /// Number of faces.
    pub(super) fn len(&self) -> usize {
        self.triangles.len() + self.arities.len()
    }

    /// Whether there is no face.
    pub(super) fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Whether a face has three corners.
    pub(super) fn has_surface(&self) -> bool {
        !self.triangles.is_empty() || self.arities.iter().any(|&arity| arity >= 3)
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

    /// Replaces each corner by the vertex that stands for it.
    fn rename(&mut self, kept: &[u32]) {
        let triangles = self.triangles.as_flattened_mut().iter_mut();
        for corner in triangles.chain(&mut self.corners) {
            *corner = kept.get(*corner as usize).copied().unwrap_or(*corner);
        }
    }

    /// Drops corners of polygons at the vertex of the corner before them, and last ones at that of
    /// the first, by which some programs close polygons. Three corners always stay.
    fn drop_repeated_corners(&mut self) {
        let mut read = 0;
        let mut written = 0;
        for arity in &mut self.arities {
            let start = written;
            let mut left = *arity;
            for place in read..read + *arity as usize {
                let corner = self.corners[place];
                if left > 3 && written > start && self.corners[written - 1] == corner {
                    left -= 1;
                } else {
                    self.corners[written] = corner;
                    written += 1;
                }
            }
            read += *arity as usize;
            while left > 3 && self.corners[start] == self.corners[written - 1] {
                written -= 1;
                left -= 1;
            }
            *arity = left;
        }
        self.corners.truncate(written);
    }

    /// The sides of all polygons, each with the number of its face. Faces with fewer than three
    /// corners are left out, so that they join nothing.
    fn sides(&self) -> impl Iterator<Item = ([u32; 2], u32)> {
        let faces = self.each().zip(0..);
        let faces = faces.filter(|(outline, _)| outline.len() >= 3);
        faces.flat_map(|(outline, face)| {
            let next = outline.iter().cycle().skip(1);
            outline.iter().zip(next).map(move |(&a, &b)| ([a, b], face))
        })
    }
}

impl FileMesh {
    /// Cuts every face into triangles. Faces with fewer than three corners are left out:
    /// `file_faces` still counts them, and the notes have their numbers.
    ///
    /// Cuts depend on which vertices are one and on which corner is the first, so that the order
    /// is: vertices are welded, if asked for; the ends of edges of no length become one vertex;
    /// repeated corners are dropped; copies of polygons are found; the polygons are cut. Equal
    /// surfaces with different defects are then cut alike. Triangles with repeated vertices and
    /// second copies are left out last, by [`Mesh::from_soup`](crate::Mesh::from_soup).
    pub(super) fn into_soup(self, weld: Option<Weld>) -> Result<TriangleSoup, Flaw> {
        let Self {
            positions,
            mut faces,
        } = self;
        let vertex_count = positions.len();
        let mut soup = TriangleSoup::new(positions, Vec::new());
        soup.notes = std::mem::take(&mut faces.notes);
        if let Some(weld) = weld {
            soup.merge(weld.copies(&soup.positions));
            faces.rename(&kept_vertices(vertex_count, &soup.copies));
        }
        if !faces.arities.is_empty() {
            let null_sides = null_sides(&soup.positions, faces.sides());
            if !null_sides.is_empty() {
                soup.merge_ends(null_sides);
                faces.rename(&kept_vertices(vertex_count, &soup.copies));
            }
            faces.drop_repeated_corners();
        }
        soup.triangles = faces.triangles;
        let mut budget = Budget::for_corners(faces.corners.len());
        let mut short = 0;
        let mut rest = &faces.corners[..];
        for (face, &arity) in faces.arities.iter().enumerate() {
            let (corners, next) = rest.split_at(arity as usize);
            rest = next;
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
        if !faces.arities.is_empty() {
            cut_alike_or_apart(&mut soup, &faces.corners, &faces.arities);
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
    let soup = FileMesh { positions, faces }.into_soup(None);
    soup.map_err(|flaw| PolygonError(flaw.problem))
}

/// The corners and the triangles of a polygon, as ranges of those of all.
type Piece = (Range<usize>, Range<usize>);

/// Cuts polygons anew: apart, where a cut would make an edge of more than two faces that the file
/// has not, and alike, where one is a copy of another.
fn cut_alike_or_apart(soup: &mut TriangleSoup, corners: &[u32], arities: &[u32]) {
    let mut polygons: Vec<Piece> = Vec::with_capacity(arities.len());
    let (mut corner, mut triangle) = (0, 0);
    for &arity in arities {
        let (outline, count) = (arity as usize, arity.saturating_sub(2) as usize);
        polygons.push((corner..corner + outline, triangle..triangle + count));
        corner += outline;
        triangle += count;
    }
    // A copy is cut as the first one is, so that their triangles are copies, too, and are left out.
    let copies = copies_of_polygons(corners, &polygons);
    if copies.is_empty() {
        separate_cuts(soup, corners, &polygons);
        return;
    }
    let is_copy = |i: &usize| copies.binary_search_by_key(i, |copy| copy.polygon).is_ok();
    let others = polygons.iter().enumerate().filter(|(i, _)| !is_copy(i));
    let firsts: Vec<Piece> = others.map(|(_, piece)| piece.clone()).collect();
    separate_cuts(soup, corners, &firsts);
    for copy in copies {
        let (from, to) = (&polygons[copy.first].1, &polygons[copy.polygon].1);
        soup.triangles.copy_within(from.clone(), to.start);
        if copy.is_turned {
            soup.triangles[to.clone()]
                .iter_mut()
                .for_each(|t| t.swap(1, 2));
        }
    }
}

/// A polygon whose corners follow each other as those of an earlier one, in either direction.
struct PolygonCopy {
    polygon: usize,
    first: usize,
    /// Whether the direction is the other one.
    is_turned: bool,
}

/// The copies among polygons of more than three corners, in ascending order. O(n log n) for n
/// corners.
fn copies_of_polygons(corners: &[u32], polygons: &[Piece]) -> Vec<PolygonCopy> {
    // Most polygons differ in this number from all others. It depends on neither start nor
    // direction.
    let mark = |v: &u32| u64::from(v ^ 0x5bd1_e995).wrapping_mul(0x9e37_79b9_7f4a_7c15);
    let sum_of = |outline: &[u32]| {
        let marks = outline.iter().map(|v| mark(v) ^ (mark(v) >> 29));
        marks.fold(0, u64::wrapping_add)
    };
    let all = polygons.iter().enumerate();
    let all = all.filter(|(_, (outline, _))| outline.len() > 3);
    let mut marked: Vec<(u64, usize)> = all
        .map(|(i, (outline, _))| (sum_of(&corners[outline.clone()]), i))
        .collect();
    marked.sort_unstable();
    let alike = marked.chunk_by(|a, b| a.0 == b.0);
    let mut copies = Vec::new();
    for group in alike.filter(|group| group.len() > 1) {
        let mut known: HashMap<Vec<u32>, (usize, bool)> = HashMap::new();
        for &(_, polygon) in group {
            let outline = &corners[polygons[polygon].0.clone()];
            let turned: Vec<u32> = outline.iter().rev().copied().collect();
            let (forward, backward) = (from_least(outline), from_least(&turned));
            let is_backward = backward < forward;
            let cycle = if is_backward { backward } else { forward };
            match known.entry(cycle) {
                Entry::Occupied(first) => copies.push(PolygonCopy {
                    polygon,
                    first: first.get().0,
                    is_turned: first.get().1 != is_backward,
                }),
                Entry::Vacant(place) => {
                    place.insert((polygon, is_backward));
                }
            }
        }
    }
    copies.sort_unstable_by_key(|copy| copy.polygon);
    copies
}

/// The rotation of a cycle that comes first in lexicographic order. O(k) for k corners.
fn from_least(cycle: &[u32]) -> Vec<u32> {
    let k = cycle.len();
    // Of two candidates for the start, one falls behind at each difference; no start that was
    // passed is better.
    let (mut start, mut other, mut same) = (0, 1, 0);
    while start < k && other < k && same < k {
        match cycle[(start + same) % k].cmp(&cycle[(other + same) % k]) {
            Ordering::Equal => {
                same += 1;
                continue;
            }
            Ordering::Less => other += same + 1,
            Ordering::Greater => start += same + 1,
        }
        other += usize::from(start == other);
        same = 0;
    }
    let start = start.min(other);
    [&cycle[start..], &cycle[..start]].concat()
}

/// Cuts polygons anew whose cuts lie along an edge of another face or a cut of another polygon.
/// There the edge would have more than two faces, although in the file it has not. Two quads around
/// a vertex with two edges are an example: both may be cut between its neighbours. O(n log n) for n
/// corners.
fn separate_cuts(soup: &mut TriangleSoup, corners: &[u32], polygons: &[Piece]) {
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
    use crate::SplitMix64;

    fn soup_of(positions: Vec<[f64; 3]>, faces: FaceList) -> Result<TriangleSoup, Flaw> {
        FileMesh { positions, faces }.into_soup(None)
    }

    #[test]
    fn triangles_stay_as_they_are() {
        let mut faces = FaceList::default();
        faces.push(&[7, 8, 9]);
        faces.push(&[1, 1, 4]);
        let soup = soup_of(vec![[0.0; 3]], faces).unwrap();
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
        let soup = soup_of(square, faces).unwrap();
        assert_eq!(soup.triangles, [[0, 1, 2], [0, 1, 2], [0, 2, 3], [3, 2, 1]]);
        assert_eq!(soup.file_faces, [0, 2, 2, 3]);
        assert_eq!(soup.notes, [Defect::ShortFace { face: 1 }]);
    }

    #[test]
    fn points_alone_are_no_surface() {
        let mut faces = FaceList::default();
        faces.push(&[0, 1]);
        assert!(soup_of(vec![[0.0; 3]; 2], faces).is_err());
    }

    #[test]
    fn cycles_begin_at_their_least_rotation() {
        let mut random = SplitMix64::new(3);
        for _ in 0..2000 {
            let cycle: Vec<u32> = (0..=random.below(7))
                .map(|_| random.below(3) as u32)
                .collect();
            let rotations = (0..cycle.len()).map(|i| [&cycle[i..], &cycle[..i]].concat());
            assert_eq!(Some(from_least(&cycle)), rotations.min(), "{cycle:?}");
        }
    }
}
