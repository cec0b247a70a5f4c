//! Modifiers of any model, generated or loaded.

use super::keys::{Key, KeyValue};
use super::noise::add_noise;
use super::parts::cut_into_parts;
use super::subdivide::{midpoint_subdivide, split};
use super::{GenerateError, MAX_FACES};
use crate::soup::TriangleSoup;

/// The keys that every family takes in addition to its own.
pub const MODIFIER_KEYS: &[Key] = &[
    Key::whole(
        "parts",
        1,
        [1, 4096],
        "parts each edge is cut into, and with them each face into their square, the surface unchanged",
    ),
    Key::whole(
        "subdivide",
        0,
        [0, 12],
        "times each face is split in four at its midpoints, the surface unchanged",
    ),
    Key::real(
        "noise",
        0.0,
        [0.0, 10.0],
        "random displacement along the normals, in mean edge lengths",
    ),
    Key::real("scale", 1.0, [1e-100, 1e100], "factor of all coordinates"),
    Key::whole(
        "seed",
        1,
        [0, u64::MAX],
        "number that picks the random choices",
    ),
];

/// Parts, subdivision, noise and scale, applied in this order.
#[derive(Clone, Debug, PartialEq)]
pub struct Modifiers {
    /// Into how many parts each edge is cut; at least 1.
    pub parts: u32,
    /// How many times each triangle is split in four.
    pub subdivide: u32,
    /// Largest displacement of a vertex along its normal, in mean edge lengths.
    pub noise: f64,
    /// Factor of all coordinates.
    pub scale: f64,
    /// Seed of the displacements.
    pub seed: u64,
}

impl Default for Modifiers {
    fn default() -> Self {
        Self {
            parts: 1,
            subdivide: 0,
            noise: 0.0,
            scale: 1.0,
            seed: 1,
        }
    }
}

impl Modifiers {
    /// The soup with all modifiers applied. The default modifiers return it unchanged, bit for bit.
    ///
    /// Vertices keep their numbers. Defects are left for validation to report; `file_faces` maps
    /// the parts of split triangles to the faces of the file.
    ///
    /// # Errors
    ///
    /// If parts and subdivision would make more than [`MAX_FACES`] triangles.
    pub fn apply(&self, soup: TriangleSoup) -> Result<TriangleSoup, GenerateError> {
        self.apply_with(soup, midpoint_subdivide)
    }

    /// As [`apply`](Self::apply) for a generated soup, whose triangles belong to no face of a file.
    pub(super) fn apply_to_generated(
        &self,
        soup: TriangleSoup,
    ) -> Result<TriangleSoup, GenerateError> {
        self.apply_with(soup, split)
    }

    fn apply_with(
        &self,
        mut soup: TriangleSoup,
        split: impl Fn(&TriangleSoup) -> TriangleSoup,
    ) -> Result<TriangleSoup, GenerateError> {
        if self.parts > 1 || self.subdivide > 0 {
            self.face_count(soup.triangles.len() as u64)?;
        }
        if self.parts > 1 {
            soup = cut_into_parts(&soup, self.parts);
        }
        for _ in 0..self.subdivide {
            soup = split(&soup);
        }
        if self.noise != 0.0 {
            add_noise(&mut soup, self.noise, self.seed);
        }
        if self.scale != 1.0 {
            for x in soup.positions.as_flattened_mut() {
                *x *= self.scale;
            }
        }
        Ok(soup)
    }

    /// The number of triangles that a model of `faces` triangles will have, unless that is too
    /// many.
    pub(super) fn face_count(&self, faces: u64) -> Result<u64, GenerateError> {
        let factor = 4u64.checked_pow(self.subdivide).unwrap_or(u64::MAX);
        let parts = u64::from(self.parts).pow(2);
        let faces = faces.saturating_mul(factor).saturating_mul(parts);
        if faces > MAX_FACES {
            return Err(GenerateError::TooManyFaces { faces });
        }
        Ok(faces)
    }

    /// Sets the value of one of [`MODIFIER_KEYS`].
    pub(super) fn set(&mut self, key: &Key, value: &KeyValue) {
        match (key.name, value) {
            ("parts", KeyValue::Whole(parts)) => self.parts = *parts as u32,
            ("subdivide", KeyValue::Whole(times)) => self.subdivide = *times as u32,
            ("noise", KeyValue::Real(noise)) => self.noise = *noise,
            ("scale", KeyValue::Real(scale)) => self.scale = *scale,
            ("seed", KeyValue::Whole(seed)) => self.seed = *seed,
            (name, value) => unreachable!("{name}={value} is not a modifier"),
        }
    }

    /// The keys that change the model, with their values. The seed changes it if there is noise, or
    /// if the shape depends on it (`seeded`).
    pub(super) fn settings(&self, seeded: bool) -> impl Iterator<Item = (&'static str, KeyValue)> {
        let default = Self::default();
        [
            (
                self.parts != default.parts,
                ("parts", KeyValue::Whole(u64::from(self.parts))),
            ),
            (
                self.subdivide != default.subdivide,
                ("subdivide", KeyValue::Whole(u64::from(self.subdivide))),
            ),
            (
                self.noise != default.noise,
                ("noise", KeyValue::Real(self.noise)),
            ),
            (
                self.scale != default.scale,
                ("scale", KeyValue::Real(self.scale)),
            ),
            (
                seeded || self.noise != 0.0,
                ("seed", KeyValue::Whole(self.seed)),
            ),
        ]
        .into_iter()
        .filter(|(matters, _)| *matters)
        .map(|(_, setting)| setting)
    }
}
