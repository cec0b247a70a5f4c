//! Bisectors of two sites: branches of hyperbolas, or lines.

use super::sites::Site;
use geobench_mesh::vector::{Point, along, between, cross_2d, dot, norm, sub};

/// The points at which two sites are equally near: a branch of a hyperbola whose foci are the
/// images of the sites, or a line.
///
/// ```
/// use geobench_voronoi::Bisector;
///
/// let mut bisector = Bisector { images: [[0.0, 0.0], [2.0, 0.0]], sigmas: [0.0, 0.0] };
/// assert!(bisector.is_line());
/// bisector.sigmas[1] = 1.0;
/// assert!(!bisector.is_line()); // A branch of a hyperbola.
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bisector {
    /// The images of both sites, in the plane of the face.
    pub images: [[f64; 2]; 2],
    /// σ of both sites: the lengths of the paths up to the images.
    pub sigmas: [f64; 2],
}

/// Nodes and weights of Gauss-Legendre quadrature with four points on 0..1, for [short](SHORT)
/// parts.
const GAUSS_SHORT: [(f64, f64); 4] = [
    (0.069_431_844_202_973_71, 0.173_927_422_568_726_93),
    (0.330_009_478_207_571_87, 0.326_072_577_431_273_07),
    (0.669_990_521_792_428_1, 0.326_072_577_431_273_07),
    (0.930_568_155_797_026_3, 0.173_927_422_568_726_93),
];

/// Length of the chord of a part, relative to its distances from both images, below which the
/// height of the part over the chord is a polynomial of degree seven, up to 1e-13.
const SHORT: f64 = 0.1;

/// The same with eight points.
const GAUSS: [(f64, f64); 8] = [
    (0.019_855_071_751_231_856, 0.050_614_268_145_188_13),
    (0.101_666_761_293_186_64, 0.111_190_517_226_687_24),
    (0.237_233_795_041_835_5, 0.156_853_322_938_943_64),
    (0.408_282_678_752_175_1, 0.181_341_891_689_181),
    (0.591_717_321_247_825, 0.181_341_891_689_181),
    (0.762_766_204_958_164_5, 0.156_853_322_938_943_64),
    (0.898_333_238_706_813_4, 0.111_190_517_226_687_24),
    (0.980_144_928_248_768_1, 0.050_614_268_145_188_13),
];

/// Slope of a function across a border below which rounding hides the position of the border.
///
/// Two paths that run nearly side by side are equally long in a wide strip. This happens if one
/// source is right behind the other.
const FLAT: f64 = 1e-6;

/// Length of a step of Newton's method, as a fraction of the chord, after which no other step is
/// needed.
const CONVERGED: f64 = 1e-10;

/// Greatest number of steps of Newton's method.
const STEPS: usize = 40;

impl Bisector {
    pub(crate) fn of(sites: [&Site; 2]) -> Self {
        Self {
            images: sites.map(|site| site.image),
            sigmas: sites.map(|site| site.sigma),
        }
    }

    /// Whether it is a straight line: both σ are equal.
    pub fn is_line(&self) -> bool {
        self.sigmas[0] == self.sigmas[1]
    }

    /// The length of the path from the first site to `x` minus that from the second, and the
    /// gradient of this difference.
    fn difference(&self, x: Point) -> (f64, Point) {
        let rays = self.images.map(|image| sub(x, image));
        let lengths = rays.map(norm);
        let [a, b] = [0, 1].map(|i| {
            if lengths[i] > 0.0 {
                rays[i].map(|c| c / lengths[i])
            } else {
                [0.0; 2]
            }
        });
        let difference = (lengths[0] - lengths[1]) + (self.sigmas[0] - self.sigmas[1]);
        (difference, sub(a, b))
    }

    /// The point of the bisector on the perpendicular to the chord from `from` to `to` at fraction
    /// `t`; `None` if none is found.
    pub(crate) fn beside(&self, from: Point, to: Point, t: f64) -> Option<Point> {
        let start = between(from, to, t);
        newton_across(start, sub(to, from), |x| {
            let (difference, gradient) = self.difference(x);
            Some((difference, gradient))
        })
    }

    /// Length of the part from `from` to `to`, and the area between it and its chord, positive on
    /// the left of the chord.
    pub(crate) fn length_and_area(&self, from: Point, to: Point) -> (f64, f64) {
        let chord = sub(to, from);
        let c = norm(chord);
        let (mut length, mut area) = (0.0, 0.0);
        let mut rays = self
            .images
            .into_iter()
            .flat_map(|p| [sub(from, p), sub(to, p)]);
        let rule = if rays.all(|ray| c < SHORT * norm(ray)) {
            &GAUSS_SHORT[..]
        } else {
            &GAUSS
        };
        for &(t, weight) in rule {
            let on_chord = between(from, to, t);
            // If no point of the curve is found, its chord takes its place.
            let x = self.beside(from, to, t).unwrap_or(on_chord);
            let (_, gradient) = self.difference(x);
            let height = cross_2d(chord, sub(x, on_chord)) / c;
            // The curve is perpendicular to the gradient.
            let [with, across] = [cross_2d(gradient, chord), dot(gradient, chord)];
            let slope = if with == 0.0 { 0.0 } else { across / with };
            length += weight * c * slope.hypot(1.0);
            area += weight * c * height;
        }
        (length, area)
    }
}

/// A zero of a function on the line through `start` perpendicular to `direction`, by Newton's
/// method from `start`. If the function hardly changes along the line, any point is returned.
/// `function` gives the value and the gradient. `None` if `function` returns it or the method does
/// not converge.
pub(crate) fn newton_across(
    start: Point,
    direction: Point,
    function: impl Fn(Point) -> Option<(f64, Point)>,
) -> Option<Point> {
    let chord = norm(direction);
    if chord == 0.0 {
        return None;
    }
    let normal = [-direction[1] / chord, direction[0] / chord];
    let mut x = start;
    let mut last = f64::INFINITY;
    for _ in 0..STEPS {
        let (value, gradient) = function(x)?;
        let slope = dot(gradient, normal);
        if slope.abs() < FLAT {
            return Some(x);
        }
        let step = (-value / slope).clamp(-chord, chord);
        if step.is_nan() || step.abs() >= last {
            // The steps no longer shrink: the method has converged to rounding, or fails.
            return (last <= 1e-6 * chord || step == 0.0).then_some(x);
        }
        last = step.abs();
        x = along(x, step, normal);
        // Convergence is quadratic: the next step would be below rounding.
        if last <= CONVERGED * chord {
            return Some(x);
        }
    }
    (last <= 1e-6 * chord).then_some(x)
}
