//! Colours for distances.

/// Nine colours evenly spaced along a ramp from dark blue over green to yellow that grows steadily
/// lighter, so that it also reads in grey and to most colour-blind people (after "viridis").
const RAMP: [[u8; 3]; 9] = [
    [68, 1, 84],
    [71, 44, 122],
    [59, 81, 139],
    [44, 113, 142],
    [33, 144, 141],
    [39, 173, 129],
    [92, 200, 99],
    [170, 220, 50],
    [253, 231, 37],
];

/// The colour of vertices that no path reaches.
pub(crate) const UNREACHED: [u8; 3] = [128, 128, 128];

/// The colour at a place on the ramp, from 0 to 1.
#[allow(clippy::cast_sign_loss)] // Neither places nor parts of colours are negative.
pub(crate) fn colour(share: f64) -> [u8; 3] {
    let place = share.clamp(0.0, 1.0) * (RAMP.len() - 1) as f64;
    let (low, between) = (place.floor() as usize, place.fract());
    let (from, to) = (RAMP[low], RAMP[(low + 1).min(RAMP.len() - 1)]);
    std::array::from_fn(|k| {
        let (from, to) = (f64::from(from[k]), f64::from(to[k]));
        (from + between * (to - from)).round() as u8
    })
}

/// A colour for each distance: the ramp from 0 to the largest finite distance.
pub(super) fn colours(distances: &[f64]) -> impl Iterator<Item = [u8; 3]> {
    let largest = distances
        .iter()
        .copied()
        .filter(|d| d.is_finite())
        .fold(0.0, f64::max);
    distances.iter().map(move |&distance| {
        if !distance.is_finite() {
            UNREACHED
        } else if largest > 0.0 {
            colour(distance / largest)
        } else {
            RAMP[0]
        }
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_ends_of_the_ramp_and_the_unreached() {
        let found: Vec<_> = colours(&[0.0, 2.0, 1.0, f64::INFINITY]).collect();
        assert_eq!(found, [RAMP[0], RAMP[8], RAMP[4], UNREACHED]);
        assert_eq!(colours(&[0.0]).next(), Some(RAMP[0]));
    }
}
