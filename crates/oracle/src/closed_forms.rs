//! Surfaces on which a formula gives every geodesic distance.

mod plane;
mod round;

use crate::model::Model;

/// A surface and the formula for its distances.
pub struct ClosedForm {
    /// The surface. The formula holds at least from each of its [`sources`](Model::sources).
    pub model: Model,
    formula: Formula,
}

type Formula = Box<dyn Fn(u32, u32) -> Option<f64> + Send + Sync>;

impl ClosedForm {
    fn new(
        model: Model,
        formula: impl Fn(u32, u32) -> Option<f64> + Send + Sync + 'static,
    ) -> Self {
        Self {
            model,
            formula: Box::new(formula),
        }
    }

    /// The distance between two vertices, with a relative error of some 1e-15; `None` for pairs
    /// that the formula does not cover.
    pub fn distance(&self, from: u32, to: u32) -> Option<f64> {
        (self.formula)(from, to)
    }
}

/// Every surface with a formula.
pub fn all() -> Vec<ClosedForm> {
    let mut all = Vec::new();
    all.extend(plane::whole_plates());
    all.extend(plane::plates_with_holes());
    all.extend(plane::folded_plates());
    all.extend(round::boxes());
    all.extend(round::disphenoids());
    all.extend(round::pillows());
    all.extend(round::platonic_solids());
    all.extend(round::flat_tori());
    all.extend(round::prisms());
    all.extend(round::cones());
    all
}
