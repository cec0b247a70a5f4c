//! The rule by which every check decides whether a distance is right.

use crate::mesh::Mesh;

/// Which distances are right beside those of a reference: all that differ from a reference distance
/// d by at most `1e-9 d + 1e-13 m`.
///
/// * The first part is a relative error. Users may allow another ([`with_relative`]).
/// * The second part is rounding. A distance is the length of a path through coordinates and images
///   of the size of the mesh, so a distance of 1e-10 on a mesh of size 1 has the rounding of 1. The
///   *scale* m of a component is the lesser of its greatest distance and [`MEDIANS`] times the
///   median of its finite distances. One far vertex is not the size of the others' paths: it raises
///   the greatest distance, but not the median.
///
/// The scale comes from the whole field of the reference, also where only the distances of some
/// vertices or within a radius are compared. Otherwise the same distance would be right or wrong,
/// depending on what else was asked.
///
/// An infinite distance is right only where the reference is infinite, and NaN never is.
///
/// ```
/// use geobench_mesh::Tolerance;
///
/// let reference = [0.0, 1e-10, 1.0, 2.0, f64::INFINITY];
/// let rule = Tolerance::of(&reference);
/// assert!(rule.is_right(1, 1e-10 + 1e-14, 1e-10));
/// assert!(!rule.is_right(1, 1e-10 + 1e-12, 1e-10));
/// let found = [0.0, 1e-10, 1.0 + 1e-8, 2.0, 5.0];
/// assert!(rule.wrong(&found, &reference).eq([2, 4]));
/// ```
///
/// [`with_relative`]: Self::with_relative
#[derive(Clone, Debug, PartialEq)]
pub struct Tolerance {
    relative: f64,
    rounding: f64,
    /// The scale of each distance, or a single one for all.
    scales: Vec<f64>,
}

/// Relative error of a right distance, unless a user allows another.
pub const RELATIVE: f64 = 1e-9;

/// Rounding of a right distance, as a fraction of the scale of its component.
const ROUNDING: f64 = 1e-13;

/// How many times the median of the distances the scale is at most.
pub const MEDIANS: f64 = 100.0;

impl Tolerance {
    /// The rule for a reference with the distances `field`, all of whose finite ones lie in one
    /// component: there is one source, or one component. O(distances).
    pub fn of(field: &[f64]) -> Self {
        Self {
            scales: vec![scale(field.to_vec())],
            ..Self::relative(RELATIVE)
        }
    }

    /// The rule for a reference with the distances `field` of the vertices of `mesh`.
    ///
    /// # Panics
    ///
    /// If `field` does not have the length of the vertices.
    pub fn on(mesh: &Mesh, field: &[f64]) -> Self {
        Self::by_component(field, &mesh.components())
    }

    /// The rule for a reference with the distances `field`, in these components, numbered from 0.
    ///
    /// # Panics
    ///
    /// If the lengths differ.
    pub fn by_component(field: &[f64], components: &[u32]) -> Self {
        assert_eq!(field.len(), components.len(), "one component each");
        let scales = scales(field, components);
        let scale = |&component: &u32| scales[component as usize];
        Self::with_scales(match scales[..] {
            [one] => vec![one],
            _ => components.iter().map(scale).collect(),
        })
    }

    /// The rule where the scale of each distance is known, or where all have the single one given.
    pub fn with_scales(scales: Vec<f64>) -> Self {
        Self {
            scales,
            ..Self::relative(RELATIVE)
        }
    }

    /// A relative error alone, for comparisons that are stricter than the rule.
    pub fn relative(relative: f64) -> Self {
        Self {
            relative,
            rounding: ROUNDING,
            scales: vec![0.0],
        }
    }

    /// Allows this relative error in place of [`RELATIVE`].
    #[must_use]
    pub fn with_relative(self, relative: f64) -> Self {
        Self { relative, ..self }
    }

    /// Allows this fraction of the scale, for comparisons that are stricter than the rule.
    #[must_use]
    pub fn with_rounding(self, rounding: f64) -> Self {
        Self { rounding, ..self }
    }

    /// The largest difference from the distance `expected` that is right. `index` is its place in
    /// the field, usually the number of a vertex. 0 if it is infinite.
    ///
    /// # Panics
    ///
    /// If the field has no such place.
    pub fn allowed(&self, index: usize, expected: f64) -> f64 {
        if !expected.is_finite() {
            return 0.0;
        }
        let scale = match self.scales[..] {
            [one] => one,
            _ => self.scales[index],
        };
        self.relative * expected + self.rounding * scale
    }

    /// Whether `found` is right where the reference has the distance `expected`.
    ///
    /// # Panics
    ///
    /// As [`allowed`](Self::allowed).
    pub fn is_right(&self, index: usize, found: f64, expected: f64) -> bool {
        // A comparison with NaN is false.
        found == expected || (found - expected).abs() <= self.allowed(index, expected)
    }

    /// The places of the distances of `found` that are wrong beside the reference `expected`.
    ///
    /// # Panics
    ///
    /// If the lengths differ.
    pub fn wrong<'a>(
        &'a self,
        found: &'a [f64],
        expected: &'a [f64],
    ) -> impl Iterator<Item = usize> + 'a {
        assert_eq!(found.len(), expected.len(), "distances of one mesh");
        (0..found.len()).filter(|&v| !self.is_right(v, found[v], expected[v]))
    }
}

/// The scale of each component of a field; `components` has the number of that of each distance.
pub fn scales(field: &[f64], components: &[u32]) -> Vec<f64> {
    by_component(field, components)
        .into_iter()
        .map(scale)
        .collect()
}

/// The distances of each component of a field; `components` has the number of that of each
/// distance.
pub fn by_component(field: &[f64], components: &[u32]) -> Vec<Vec<f64>> {
    let count = components.iter().max().map_or(0, |&last| last as usize + 1);
    let mut parts = vec![Vec::new(); count];
    for (&distance, &component) in field.iter().zip(components) {
        parts[component as usize].push(distance);
    }
    parts
}

/// The scale of a field in one component: the lesser of the greatest distance and [`MEDIANS`] times
/// the median, of the finite ones. 0 without any.
pub fn scale(mut field: Vec<f64>) -> f64 {
    field.retain(|d| d.is_finite());
    let middle = field.len() / 2;
    if field.is_empty() {
        return 0.0;
    }
    let greatest = field.iter().copied().fold(0.0, f64::max);
    let is_even = field.len().is_multiple_of(2);
    let (below, &mut upper, _) = field.select_nth_unstable_by(middle, f64::total_cmp);
    let median = if is_even {
        let lower = below.iter().copied().fold(0.0, f64::max);
        f64::midpoint(lower, upper)
    } else {
        upper
    };
    greatest.min(MEDIANS * median)
}

#[cfg(test)]
mod tests {
    use super::*;

    const INF: f64 = f64::INFINITY;

    #[test]
    fn the_scale_is_the_greatest_distance_or_a_hundred_medians() {
        assert_eq!(scale(vec![0.0, 1.0, 5.0]), 5.0);
        assert_eq!(scale(vec![5.0, 1.0, 0.0, INF, f64::NAN]), 5.0);
        // One far vertex does not count.
        assert_eq!(scale(vec![0.0, 1.0, 3.0, 1e9]), 200.0);
        assert_eq!(scale(vec![1e9, 2.0, 0.0]), 200.0);
        assert_eq!(scale(vec![0.0]), 0.0);
        assert_eq!(scale(vec![INF]), 0.0);
        assert_eq!(scale(Vec::new()), 0.0);
    }

    #[test]
    fn each_component_has_a_scale_of_its_own() {
        let field = [0.0, 1.0, 2.0, 0.0, 1e6, 1e6, INF];
        let rule = Tolerance::by_component(&field, &[0, 0, 0, 1, 1, 1, 2]);
        assert_eq!(rule.allowed(1, 0.0), 1e-13 * 2.0);
        assert_eq!(rule.allowed(4, 0.0), 1e-13 * 1e6);
        assert_eq!(rule.allowed(6, INF), 0.0);
        // All in one.
        assert_eq!(Tolerance::of(&field).allowed(1, 0.0), 1e-13 * 150.0);
    }

    #[test]
    fn a_difference_is_right_up_to_both_parts_of_the_rule() {
        let rule = Tolerance::of(&[0.0, 1.0, 4.0]);
        let most = 1e-9 + 4e-13;
        assert_eq!(rule.allowed(1, 1.0), most);
        assert!(rule.is_right(1, 1.0 + 0.999 * most, 1.0));
        assert!(rule.is_right(1, 1.0 - 0.999 * most, 1.0));
        assert!(!rule.is_right(1, 1.0 + 1.001 * most, 1.0));
        // A source is at 0 up to rounding.
        assert!(rule.is_right(0, 1e-13, 0.0));
        assert!(!rule.is_right(0, 5e-13, 0.0));
        let rule = rule.with_relative(0.5);
        assert!(rule.is_right(1, 1.5, 1.0) && !rule.is_right(1, 1.51, 1.0));
        assert!(!Tolerance::relative(1e-9).is_right(0, 1e-300, 0.0));
    }

    #[test]
    fn infinite_against_finite_and_not_a_number_are_wrong() {
        let rule = Tolerance::of(&[0.0, 1.0]).with_relative(1e9);
        for (found, expected) in [(INF, 1.0), (1.0, INF), (f64::NAN, 1.0), (f64::NAN, INF)] {
            assert!(!rule.is_right(0, found, expected), "{found} {expected}");
        }
        assert!(!rule.is_right(0, 1.0, f64::NAN));
        assert!(!rule.is_right(0, f64::NAN, f64::NAN));
        assert!(rule.is_right(0, INF, INF));
        let rule = rule.with_relative(0.0);
        assert!(!rule.is_right(0, 1.0, INF) && rule.is_right(0, INF, INF));
    }

    #[test]
    fn the_components_of_a_mesh_share_no_vertex() {
        let positions = vec![[0.0; 3]; 8].into_iter().enumerate();
        let positions = positions.map(|(i, _)| [i as f64, (i * i) as f64, 0.0]);
        let faces = vec![[4, 5, 6], [0, 1, 2], [2, 3, 1]];
        let mesh = Mesh::new(positions.collect(), faces).unwrap();
        assert_eq!(mesh.components(), [0, 0, 0, 0, 1, 1, 1, 2]);
        let field = [0.0, 1.0, 1.0, 2.0, 0.0, 7.0, 7.0, INF];
        let rule = Tolerance::on(&mesh, &field);
        assert_eq!(rule.allowed(0, 0.0), 1e-13 * 2.0);
        assert_eq!(rule.allowed(4, 0.0), 1e-13 * 7.0);
    }
}
