//! The faces of a file, before they are cut into triangles.

use super::error::Flaw;
use super::triangulate::{Budget, TooComplex, triangulate};
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

    /// Cuts every face into triangles. Faces with fewer than three corners are left out:
    /// `file_faces` still counts them, and `short_faces` lists their numbers.
    pub(super) fn into_soup(self, positions: Vec<[f64; 3]>) -> Result<TriangleSoup, Flaw> {
        let mut soup = TriangleSoup::new(positions, self.triangles);
        let mut budget = Budget::for_corners(self.corners.len());
        let mut rest = &self.corners[..];
        for (face, &arity) in self.arities.iter().enumerate() {
            let (corners, next) = rest.split_at(arity as usize);
            rest = next;
            if arity < 3 {
                soup.short_faces.push(face as u32);
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
        match (soup.positions.len(), soup.triangles.len()) {
            (0, 0) => Err(Flaw::file(
                "there is neither a vertex nor a face in it; is it a file of this format?",
            )),
            (_, 0) if !soup.short_faces.is_empty() => Err(Flaw::file(format!(
                "no face in it has three corners or more ({} have fewer); a surface is needed",
                soup.short_faces.len()
            ))),
            (vertices, 0) => Err(Flaw::file(format!(
                "there is no face in it, only vertices ({vertices}); a surface is needed"
            ))),
            _ => Ok(soup),
        }
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
        assert_eq!(soup.short_faces, [1]);
    }

    #[test]
    fn points_alone_are_no_surface() {
        let mut faces = FaceList::default();
        faces.push(&[0, 1]);
        assert!(faces.into_soup(vec![[0.0; 3]; 2]).is_err());
    }
}
