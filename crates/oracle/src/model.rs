//! A named surface for tests.

use std::fmt;

use crate::random::Random;
use crate::scalar::RealNumber;
use crate::surface::PreciseSurface;

/// The data that determine the shape of a [`Model`].
#[derive(Clone, Debug, PartialEq)]
pub enum Geometry {
    /// A point of space for each vertex.
    Positions(Vec<[f64; 3]>),
    /// For each triangle, the lengths of the edges from each corner to the next.
    Lengths(Vec<[f64; 3]>),
}

/// A named surface for tests, with suitable sources.
#[derive(Clone, PartialEq)]
pub struct Model {
    /// The name in test failures.
    pub name: String,
    /// Number of vertices, including isolated ones.
    pub vertex_count: usize,
    /// The three vertices of each triangle, consistently oriented.
    pub triangles: Vec<[u32; 3]>,
    /// Positions or edge lengths.
    pub geometry: Geometry,
    /// At least five vertices, or all if there are fewer: first those that the model was made for,
    /// then random ones.
    pub sources: Vec<u32>,
}

impl fmt::Debug for Model {
    /// Prints the name, which describes the model, and the sizes instead of all numbers.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Model")
            .field("name", &self.name)
            .field("vertices", &self.vertex_count)
            .field("faces", &self.triangles.len())
            .finish_non_exhaustive()
    }
}

impl Model {
    /// A surface in space.
    pub fn new(
        name: impl Into<String>,
        positions: Vec<[f64; 3]>,
        triangles: Vec<[u32; 3]>,
    ) -> Self {
        let count = positions.len();
        Self::with_geometry(
            name.into(),
            count,
            triangles,
            Geometry::Positions(positions),
        )
    }

    /// A surface given by its edge lengths.
    pub fn from_lengths(
        name: impl Into<String>,
        vertex_count: usize,
        triangles: Vec<[u32; 3]>,
        lengths: Vec<[f64; 3]>,
    ) -> Self {
        Self::with_geometry(
            name.into(),
            vertex_count,
            triangles,
            Geometry::Lengths(lengths),
        )
    }

    fn with_geometry(
        name: String,
        vertex_count: usize,
        triangles: Vec<[u32; 3]>,
        geometry: Geometry,
    ) -> Self {
        let model = Self {
            name,
            vertex_count,
            triangles,
            geometry,
            sources: Vec::new(),
        };
        model.starting_at(&[])
    }

    /// The same surface with `sources` before some random ones.
    #[must_use]
    pub(crate) fn starting_at(mut self, sources: &[u32]) -> Self {
        const ENOUGH: usize = 5;
        self.sources = sources.to_vec();
        let mut random = Random::new(self.vertex_count as u64);
        while self.sources.len() < ENOUGH.min(self.vertex_count) {
            let source = random.below(self.vertex_count as u32);
            if !self.sources.contains(&source) {
                self.sources.push(source);
            }
        }
        self
    }

    /// The same surface with `sources` only.
    #[must_use]
    pub fn only_from(mut self, sources: &[u32]) -> Self {
        self.sources = sources.to_vec();
        self
    }

    /// The same surface with every length multiplied by `factor`.
    #[must_use]
    pub fn scaled(mut self, factor: f64) -> Self {
        let (Geometry::Positions(numbers) | Geometry::Lengths(numbers)) = &mut self.geometry;
        for number in numbers.as_flattened_mut() {
            *number *= factor;
        }
        self.name = format!("{} x {factor:e}", self.name);
        self
    }

    /// The positions, if the model has any.
    pub fn positions(&self) -> Option<&[[f64; 3]]> {
        match &self.geometry {
            Geometry::Positions(positions) => Some(positions),
            Geometry::Lengths(_) => None,
        }
    }

    /// The surface for the oracle.
    pub fn surface<S: RealNumber>(&self) -> PreciseSurface<S> {
        match &self.geometry {
            Geometry::Positions(positions) => {
                PreciseSurface::from_positions(positions, &self.triangles)
            }
            Geometry::Lengths(lengths) => {
                let lengths: Vec<_> = lengths.iter().map(|l| l.map(S::from_f64)).collect();
                PreciseSurface::from_lengths(self.vertex_count, &self.triangles, &lengths)
            }
        }
    }
}
