//! Meshes that nodes of a scene place by transforms, gathered into one.

use super::error::Flaw;
use super::faces::FileMesh;
use crate::defect::{Defect, FileForm};
use crate::vector::{cross, dot, sub};

/// An affine map: rows of three factors and a shift.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Affine(pub(super) [[f64; 4]; 3]);

impl Affine {
    pub(super) const IDENTITY: Self = Self([
        [1.0, 0.0, 0.0, 0.0],
        [0.0, 1.0, 0.0, 0.0],
        [0.0, 0.0, 1.0, 0.0],
    ]);

    /// The transform of the matrix with these rows; `None` if the last row is not 0, 0, 0, 1. Some
    /// programs divide by another last row, and a matrix whose columns are written as rows has its
    /// shift there.
    pub(super) fn from_rows(rows: &[f64; 16]) -> Option<Self> {
        // Rounding to a few digits, as in a text.
        const ROUNDED: f64 = 1e-5;
        let last = rows[12..].iter().zip([0.0, 0.0, 0.0, 1.0]);
        let is_affine = last
            .map(|(x, wanted)| (x - wanted).abs())
            .all(|off| off <= ROUNDED);
        is_affine
            .then(|| Self([0, 1, 2].map(|row| [0, 1, 2, 3].map(|column| rows[4 * row + column]))))
    }

    /// As [`from_rows`](Self::from_rows), of the matrix with these columns.
    pub(super) fn from_columns(columns: &[f64; 16]) -> Option<Self> {
        Self::from_rows(&std::array::from_fn(|i| columns[4 * (i % 4) + i / 4]))
    }

    /// A shift.
    pub(super) fn shift([x, y, z]: [f64; 3]) -> Self {
        Self([[1.0, 0.0, 0.0, x], [0.0, 1.0, 0.0, y], [0.0, 0.0, 1.0, z]])
    }

    /// Factors along the axes.
    pub(super) fn scale([x, y, z]: [f64; 3]) -> Self {
        Self([[x, 0.0, 0.0, 0.0], [0.0, y, 0.0, 0.0], [0.0, 0.0, z, 0.0]])
    }

    /// The rotation of a unit quaternion.
    pub(super) fn rotation([x, y, z, w]: [f64; 4]) -> Self {
        let two = 2.0;
        Self([
            [
                1.0 - two * (y * y + z * z),
                two * (x * y - w * z),
                two * (x * z + w * y),
                0.0,
            ],
            [
                two * (x * y + w * z),
                1.0 - two * (x * x + z * z),
                two * (y * z - w * x),
                0.0,
            ],
            [
                two * (x * z - w * y),
                two * (y * z + w * x),
                1.0 - two * (x * x + y * y),
                0.0,
            ],
        ])
    }

    /// The place and direction of a viewer at `eye` who looks along -z at `target`, with `up`
    /// above. Not finite if these are no directions.
    pub(super) fn look_at(eye: [f64; 3], target: [f64; 3], up: [f64; 3]) -> Self {
        let unit = |v: [f64; 3]| v.map(|x| x / dot(v, v).sqrt());
        let back = unit(sub(eye, target));
        let right = unit(cross(up, back));
        let above = cross(back, right);
        Self([0, 1, 2].map(|row| [right[row], above[row], back[row], eye[row]]))
    }

    /// The rotation about `axis` by `degrees`.
    pub(super) fn turn(axis: [f64; 3], degrees: f64) -> Self {
        // `libm` gives the same bits on every machine.
        let half = 0.5 * degrees.to_radians();
        let length = axis.iter().map(|x| x * x).sum::<f64>().sqrt();
        let [x, y, z] = axis.map(|x| libm::sin(half) * x / length);
        if length > 0.0 {
            Self::rotation([x, y, z, libm::cos(half)])
        } else {
            Self::IDENTITY
        }
    }

    /// First `inner`, then this.
    pub(super) fn after(&self, inner: &Self) -> Self {
        Self(self.0.map(|row| {
            [0, 1, 2, 3].map(|column| {
                let product = (0..3).map(|k| row[k] * inner.0[k][column]).sum::<f64>();
                product + if column == 3 { row[3] } else { 0.0 }
            })
        }))
    }

    fn of(&self, [x, y, z]: [f64; 3]) -> [f64; 3] {
        self.0.map(|[a, b, c, d]| a * x + b * y + c * z + d)
    }
}

/// The most levels of nodes within nodes. Deeper ones may be a circle.
pub(super) const DEEPEST: usize = 1000;

/// The problem of a matrix that is no affine transform.
pub(super) const NOT_AFFINE: &str =
    "the last row of its matrix is not 0 0 0 1, and programs differ on what it means then";

/// The flaw of nodes that are deeper than [`DEEPEST`].
pub(super) fn too_deep(what: &str) -> Flaw {
    Flaw::file(format!(
        "{what} is nested more than {DEEPEST} deep, or contains itself"
    ))
}

/// The placed meshes.
#[derive(Debug)]
pub(super) struct Assembly {
    all: FileMesh,
    parts: u32,
    /// How many meshes without faces were placed.
    without_faces: u32,
    /// How many of the placed meshes have skins or morphs.
    unposed: u32,
    /// How many more bytes the placed meshes may take.
    room: u64,
}

impl Assembly {
    /// A scene whose placed meshes may take `room` bytes: nodes may place one mesh any number of
    /// times.
    pub(super) fn new(room: u64) -> Self {
        Self {
            all: FileMesh::default(),
            parts: 0,
            without_faces: 0,
            unposed: 0,
            room,
        }
    }

    /// Pays for the visit of a node.
    pub(super) fn visit(&mut self) -> Result<(), Flaw> {
        self.pay(64)
    }

    /// Notes a departure from the format in the line that `line` finds, which may take a pass over
    /// the file. Only the first of each kind is kept.
    pub(super) fn note_form(&mut self, form: FileForm, line: impl FnOnce() -> u64) {
        if !self.all.faces.has_form(form) {
            self.all.faces.note_form(line(), form);
        }
    }

    /// Notes that a placed mesh has a skin or a morph.
    pub(super) fn note_unposed(&mut self) {
        self.unposed += 1;
    }

    /// Allows `bytes` more.
    pub(super) fn make_room(&mut self, bytes: u64) {
        self.room = self.room.saturating_add(bytes);
    }

    /// Takes `bytes` of the room.
    pub(super) fn pay(&mut self, bytes: u64) -> Result<(), Flaw> {
        self.room = self.room.checked_sub(bytes).ok_or_else(|| {
            Flaw::file(
                "the meshes that its nodes place take more memory than the limit of decompressed \
                 sizes",
            )
            .over_limit()
        })?;
        Ok(())
    }

    /// Adds a mesh, called `name` in messages.
    pub(super) fn place(
        &mut self,
        piece: &FileMesh,
        transform: &Affine,
        name: &str,
    ) -> Result<(), Flaw> {
        if piece.faces.is_empty() {
            self.without_faces += 1;
            return Ok(());
        }
        self.pay(24 * piece.positions.len() as u64 + piece.faces.bytes())?;
        let first = self.all.positions.len();
        u32::try_from(first + piece.positions.len())
            .map_err(|_| Flaw::file("there are more than 4294967295 vertices in it"))?;
        self.all
            .faces
            .append(&piece.faces, first as u32, |face, corner| {
                let vertices = piece.positions.len();
                (corner as usize >= vertices).then(|| {
                Flaw::file(format!(
                    "{name}: face {face} names vertex {corner}, but there are {vertices}, counted \
                     from 0"
                ))
            })
            })?;
        if *transform == Affine::IDENTITY {
            self.all.positions.extend_from_slice(&piece.positions);
        } else {
            let places = piece.positions.iter().map(|&at| transform.of(at));
            self.all.positions.extend(places);
        }
        self.parts += 1;
        Ok(())
    }

    /// The placed meshes as one, with a note on their number. An error if there is none.
    pub(super) fn into_mesh(mut self) -> Result<FileMesh, Flaw> {
        match (self.parts, self.without_faces) {
            (0, 0) => {
                return Err(Flaw::file(
                    "no mesh is placed in it: its scene, build or list of pieces is empty; save it \
                     with its objects",
                ));
            }
            (0, _) => {
                return Err(Flaw::file(
                    "what it places has no faces, at most points and lines; a surface is needed",
                ));
            }
            _ => {}
        }
        if self.parts > 1 {
            self.all.faces.note(Defect::Parts { parts: self.parts });
        }
        if self.unposed > 0 {
            let meshes = self.unposed;
            self.all.faces.note(Defect::Unposed { meshes });
        }
        Ok(self.all)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn transforms_follow_each_other() {
        let turned = Affine::turn([0.0, 0.0, 2.0], 90.0).of([1.0, 0.0, 5.0]);
        let off = turned
            .iter()
            .zip([0.0, 1.0, 5.0])
            .map(|(a, b)| (a - b).abs());
        assert!(off.fold(0.0, f64::max) < 1e-15, "{turned:?}");
        // Half a turn about the axis that is up.
        let seen = Affine::look_at([5.0, 0.0, 0.0], [5.0, 0.0, 9.0], [0.0, 2.0, 0.0]);
        assert_eq!(seen.of([1.0, 2.0, 3.0]), [4.0, 2.0, -3.0]);
        let mut matrix = [0.0; 16];
        (matrix[3], matrix[12], matrix[15]) = (7.0, 1e-6, 0.999_999);
        assert_eq!(
            Affine::from_rows(&matrix).unwrap().of([0.0; 3]),
            [7.0, 0.0, 0.0]
        );
        // As columns it has its shift in the last row.
        assert_eq!(Affine::from_columns(&matrix), None);
        matrix[15] = 2.0;
        assert_eq!(Affine::from_rows(&matrix), None);
        let both = Affine::shift([1.0, 0.0, 0.0]).after(&Affine::scale([2.0; 3]));
        assert_eq!(both.of([1.0, 2.0, 3.0]), [3.0, 4.0, 6.0]);
    }

    #[test]
    fn a_mesh_cannot_be_placed_without_bound() {
        let mut piece = FileMesh {
            positions: vec![[0.0; 3]; 3],
            ..FileMesh::default()
        };
        piece.faces.push(&[0, 1, 2]);
        let mut scene = Assembly::new(1000);
        let mut place = || scene.place(&piece, &Affine::IDENTITY, "a");
        assert!((0..100).any(|_| place().is_err()));
        piece.faces.push(&[0, 1, 3]);
        let flaw = Assembly::new(1000).place(&piece, &Affine::IDENTITY, "a");
        assert!(
            flaw.unwrap_err()
                .problem
                .contains("a: face 1 names vertex 3")
        );
    }
}
