//! The jump between two pieces, in double-double arithmetic.
//!
//! Interval arithmetic would bound a jump by a few units in the last place of the distances, and
//! these bounds add up over all pieces of an edge. Here the input is exact, and a sum, product or
//! root of two double-doubles has a relative error of at most 2^-100 (M. Joldes, J.-M. Muller, V.
//! Popescu, Tight and rigorous error bounds for basic building blocks of double-word arithmetic,
//! 2017; V. Lefèvre, N. Louvet, J.-M. Muller, J. Picot, L. Rideau, Accurate calculation of
//! Euclidean norms using double-word arithmetic, 2023).

use crate::ball::{two_product, two_sum};
use crate::envelope::EnvelopePiece;

/// More than the error of a difference, as a fraction of the numbers involved.
const ERROR: f64 = 1e-28;

/// An upper bound of the sum of the jumps between consecutive pieces.
pub(crate) fn sum_of_jumps(pieces: &[EnvelopePiece]) -> f64 {
    pieces.windows(2).fold(0.0, |sum: f64, pair| {
        (sum + jump(&pair[0], &pair[1], pair[0].to)).next_up()
    })
}

/// An upper bound of the jump from `a` to `b` at abscissa `t`.
fn jump(a: &EnvelopePiece, b: &EnvelopePiece, t: f64) -> f64 {
    let [of_a, of_b] = [a, b].map(|piece| image_distance(piece, t));
    let mut sum = two_sum(a.sigma, -b.sigma);
    for x in [of_a.0, -of_b.0, of_a.1, -of_b.1] {
        let (high, low) = two_sum(sum.0, x);
        sum = two_sum(high, low + sum.1);
    }
    let size = a.sigma + b.sigma + of_a.0 + of_b.0;
    ((sum.0 + sum.1).abs() + ERROR * size).next_up()
}

/// The distance to the image.
fn image_distance(piece: &EnvelopePiece, t: f64) -> (f64, f64) {
    let x = two_sum(t, -piece.image[0]);
    let y = piece.image[1];
    let xx = two_product(x.0, x.0);
    let yy = two_product(y, y);
    let (high, low) = two_sum(xx.0, yy.0);
    let low = low + xx.1 + yy.1 + 2.0 * x.0 * x.1;
    let (high, low) = two_sum(high, low);
    let root = high.sqrt();
    if root == 0.0 {
        return (0.0, 0.0);
    }
    let rest = (-root).mul_add(root, high) + low;
    two_sum(root, rest / (2.0 * root))
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::ball::Ball;
    use crate::difference::Distance;

    fn piece(x: f64, y: f64, sigma: f64) -> EnvelopePiece {
        EnvelopePiece {
            from: 0.0,
            to: 1.0,
            image: [x, y],
            sigma,
        }
    }

    #[test]
    fn equal_distances_have_no_jump() {
        // Pythagorean triples.
        let (a, b) = (piece(3.0, 4.0, 2.0), piece(5.0, 12.0, -6.0));
        assert!(jump(&a, &b, 0.0) < 1e-26);
        // A jump far below a unit in the last place of the distances.
        let b = piece(5.0, 12.0, -6.0 + 1e-15);
        assert!((jump(&a, &b, 0.0) / (b.sigma + 6.0) - 1.0).abs() < 1e-10);
    }

    proptest! {
        #[test]
        fn it_is_within_the_bounds_of_balls(
            a in (-3.0..3.0f64, 0.0..3.0f64, 0.0..3.0f64),
            b in (-3.0..3.0f64, 0.0..3.0f64, 0.0..3.0f64),
            t in 0.0..1.0f64,
        ) {
            let pieces = [a, b].map(|(x, y, sigma)| piece(x, y, sigma));
            let found = jump(&pieces[0], &pieces[1], t);
            let [a, b] = pieces.map(|p| {
                let distance = Distance {
                    image: p.image.map(Ball::exact),
                    sigma: Ball::exact(p.sigma),
                };
                distance.at(Ball::exact(t))
            });
            let exact = (a - b).abs();
            prop_assert!(found >= exact.lower() && found <= exact.upper() + 1e-27);
        }
    }
}
