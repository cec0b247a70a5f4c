//! Hilbert's curve through space.

/// Bits of a coordinate along each axis: three fit into a place.
const BITS: u32 = 21;

/// Where on the curve through their bounding box each of `positions`, which are finite, lies.
///
/// Points that are near each other on the curve are near each other in space, and mostly the other way round.
pub(super) fn places(positions: &[[f64; 3]]) -> Vec<u64> {
    let mut low = [f64::INFINITY; 3];
    let mut high = [f64::NEG_INFINITY; 3];
    for position in positions {
        for axis in 0..3 {
            low[axis] = low[axis].min(position[axis]);
            high[axis] = high[axis].max(position[axis]);
        }
    }
    // Halves, since the difference of two numbers can be too large.
    let half = |axis: usize| high[axis] / 2.0 - low[axis] / 2.0;
    let size = half(0).max(half(1)).max(half(2));
    let scale = f64::from((1 << BITS) - 1);
    #[allow(clippy::cast_sign_loss)] // No position lies below the box.
    let cell = |x: f64, axis: usize| ((x / 2.0 - low[axis] / 2.0) / size * scale) as u32;
    positions
        .iter()
        .map(|p| place([0, 1, 2].map(|axis| cell(p[axis], axis))))
        .collect()
}

/// Number of a cell on the curve through a cube of 2^`BITS` cells along each edge.
///
/// Skilling, "Programming the Hilbert curve" (2004): the coordinates are turned, octant by octant, into the
/// transposed number, whose bits are then collected.
fn place(mut x: [u32; 3]) -> u64 {
    let mut bit = 1 << (BITS - 1);
    while bit > 1 {
        let below = bit - 1;
        for axis in 0..3 {
            if x[axis] & bit != 0 {
                x[0] ^= below;
            } else {
                let swap = (x[0] ^ x[axis]) & below;
                x[0] ^= swap;
                x[axis] ^= swap;
            }
        }
        bit >>= 1;
    }
    x[1] ^= x[0];
    x[2] ^= x[1];
    let mut gray = 0;
    let mut bit = 1 << (BITS - 1);
    while bit > 1 {
        if x[2] & bit != 0 {
            gray ^= bit - 1;
        }
        bit >>= 1;
    }
    let mut number = 0;
    for bit in (0..BITS).rev() {
        for coordinate in x {
            number = number << 1 | u64::from((coordinate ^ gray) >> bit & 1);
        }
    }
    number
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_curve_visits_every_cell_and_goes_from_each_to_a_neighbour() {
        // The coarsest cells that the bits below do not divide: 8 along each edge.
        let shift = BITS - 3;
        let mut cells: Vec<_> = (0..512_u32)
            .map(|i| {
                let cell = [i / 64, i / 8 % 8, i % 8];
                (place(cell.map(|x| x << shift)) >> (3 * shift), cell)
            })
            .collect();
        cells.sort_unstable();
        let numbers: Vec<_> = cells.iter().map(|(number, _)| *number).collect();
        assert_eq!(numbers, (0..512).collect::<Vec<_>>());
        for pair in cells.windows(2) {
            let distance: u32 = (0..3)
                .map(|axis| pair[0].1[axis].abs_diff(pair[1].1[axis]))
                .sum();
            assert_eq!(distance, 1, "{pair:?}");
        }
    }

    #[test]
    fn any_positions_have_places() {
        assert!(places(&[]).is_empty());
        assert_eq!(places(&[[7.0; 3]; 2]), [0, 0]);
        let huge = places(&[[-1e308, 0.0, 0.0], [1e308, 0.0, 0.0], [0.0; 3]]);
        assert_eq!(huge[0], 0);
        assert!(huge[0] < huge[2] && huge[2] < huge[1]);
        let flat = places(&[[0.0, 0.0, 1e-300], [1.0, 1e-320, 0.0]]);
        assert_ne!(flat[0], flat[1]);
    }
}
