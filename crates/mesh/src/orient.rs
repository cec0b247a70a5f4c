//! Consistent orientation of the faces of a surface.

use crate::mesh::NO_TWIN;

/// The faces to turn over so that all agree with their neighbours, as far as possible.
#[derive(Debug, Default, PartialEq)]
pub(crate) struct Orientation {
    /// Their numbers in ascending order. In every patch this is the smaller part, so that most
    /// faces stay.
    pub(crate) flipped: Vec<u32>,
    /// For every patch that cannot be oriented, a half-edge at which orientations found from face
    /// to face contradict.
    pub(crate) contradictions: Vec<u32>,
}

/// Finds the faces to turn over, patch by patch. A patch is a set of faces connected by `mates`.
///
/// `mates[h]` is the other half-edge along the edge of `h`, or [`NO_TWIN`] where a patch ends. If
/// both parts of a patch have the same size, the one with the first face stays. Takes linear time.
pub(crate) fn orient(triangles: &[[u32; 3]], mates: &[u32]) -> Orientation {
    let tails = triangles.as_flattened();
    // Consistently oriented neighbours have opposite directions along their common edge.
    let agree = |h: u32, mate: u32| tails[h as usize] != tails[mate as usize];
    let mut sides: Vec<Option<bool>> = vec![None; triangles.len()];
    let mut result = Orientation::default();
    let mut patch = Vec::new();
    for seed in 0..triangles.len() {
        if sides[seed].is_some() {
            continue;
        }
        sides[seed] = Some(false);
        patch.clear();
        patch.push(seed as u32);
        let mut contradiction = None;
        let mut done = 0;
        while let Some(&face) = patch.get(done) {
            done += 1;
            let side = sides[face as usize] == Some(true);
            for h in 3 * face..3 * face + 3 {
                let mate = mates[h as usize];
                if mate == NO_TWIN {
                    continue;
                }
                let wanted = side ^ !agree(h, mate);
                match &mut sides[mate as usize / 3] {
                    Some(there) if *there == wanted => {}
                    Some(_) => contradiction = contradiction.or(Some(h)),
                    unseen @ None => {
                        *unseen = Some(wanted);
                        patch.push(mate / 3);
                    }
                }
            }
        }
        if let Some(h) = contradiction {
            result.contradictions.push(h);
            // Rather than contradict as often, the faces stay as they are.
            let half_edges = patch.iter().flat_map(|face| 3 * face..3 * face + 3);
            let pairs = half_edges.map(|h| (h, mates[h as usize]));
            let pairs = pairs.filter(|&(_, mate)| mate != NO_TWIN);
            let is_against =
                |&(h, mate): &(u32, u32)| sides[h as usize / 3] != sides[mate as usize / 3];
            let as_given = pairs.clone().filter(|&(h, mate)| !agree(h, mate)).count();
            let turned = pairs.filter(|p| is_against(p) == agree(p.0, p.1)).count();
            if as_given <= turned {
                continue;
            }
        }
        let is_turned = |face: &u32| sides[*face as usize] == Some(true);
        let turned = patch.iter().filter(|face| is_turned(face)).count();
        let minority = 2 * turned <= patch.len();
        result
            .flipped
            .extend(patch.iter().filter(|face| is_turned(face) == minority));
    }
    result.flipped.sort_unstable();
    result
}

/// Turns the `flipped` faces over: swaps their last two corners in the triangles, and updates the
/// lengths along their half-edges and the pairing of half-edges.
pub(crate) fn turn_over(
    flipped: &[u32],
    triangles: &mut [[u32; 3]],
    lengths: &mut [[f64; 3]],
    mates: &mut [u32],
) {
    for &face in flipped {
        let t = face as usize;
        triangles[t].swap(1, 2);
        lengths[t].swap(0, 2);
        // Half-edges 0 and 2 of the face exchange their edges.
        let (first, last) = (3 * t, 3 * t + 2);
        for (h, renamed) in [(first, last), (last, first)] {
            let mate = mates[h];
            if mate != NO_TWIN {
                mates[mate as usize] = renamed as u32;
            }
        }
        mates.swap(first, last);
    }
}
