//! The oracle: every straight line from every point where a shortest path can start or bend.

use crate::bounds::edge_graph;
use crate::scalar::Scalar;
use crate::surface::{Surface, next, prev};

/// How far beyond the largest distance still wanted a line is followed.
const MARGIN: f64 = 1.0 + 1e-9;

/// Straight lines from one point that cross one side next to each other.
///
/// They come from below the side's frame and are about to cross the side's triangle.
#[derive(Clone, Copy)]
struct Beam<S> {
    side: usize,
    from: S,
    to: S,
    origin: [S; 2],
}

/// The distance of every vertex from the nearest of `sources`; `None` where no path leads.
///
/// Exact but for rounding. Dijkstra's algorithm over the vertices at which a path can bend, where
/// the "edges" are all straight lines between them: when such a vertex has its final
/// distance, all lines from it are followed, depth first, until they are longer than any distance
/// that could still improve. A line that runs exactly into a vertex is caught by the beams on
/// either side of it, whose end rays are offered to the vertices near them as well.
///
/// Time and the number of lines grow with the number of bends and, on curved surfaces, much
/// faster than the number of triangles; memory stays small.
///
/// # Panics
///
/// When a source is not a vertex.
pub fn distances<S: Scalar>(surface: &Surface<S>, sources: &[u32]) -> Vec<Option<S>> {
    let mut best = edge_graph(surface, sources);
    let mut open: Vec<usize> = (0..best.len()).filter(|&v| best[v].is_some()).collect();
    let nearer = |best: &[Option<S>], a: usize, b: usize| best[a] < best[b];
    while let Some(at) = (0..open.len()).reduce(|i, j| {
        if nearer(&best, open[j], open[i]) {
            j
        } else {
            i
        }
    }) {
        let vertex = open.swap_remove(at);
        let Some(start) = best[vertex] else { continue };
        for &side in &surface.leaving[vertex] {
            let (ahead, back) = (next(side), prev(side));
            offer(
                &mut best[surface.sides[ahead].tail],
                start + surface.sides[side].length,
            );
            offer(
                &mut best[surface.sides[back].tail],
                start + surface.sides[back].length,
            );
        }
        let is_source = sources.contains(&(vertex as u32));
        let furthest = open.iter().filter_map(|&v| best[v]).reduce(Scalar::max);
        if let Some(furthest) = furthest
            && (is_source || surface.bends_at(vertex as u32))
        {
            let limit = furthest * S::from_f64(MARGIN);
            follow_lines_from(surface, vertex, start, limit, &mut best);
        }
    }
    best
}

fn offer<S: Scalar>(best: &mut Option<S>, length: S) {
    if best.is_none_or(|b| length < b) {
        *best = Some(length);
    }
}

/// Follows all lines from `vertex`, itself at distance `start`, up to the distance `limit`.
fn follow_lines_from<S: Scalar>(
    surface: &Surface<S>,
    vertex: usize,
    start: S,
    limit: S,
    best: &mut [Option<S>],
) {
    let mut beams: Vec<Beam<S>> = surface.leaving[vertex]
        .iter()
        .filter_map(|&leaving| {
            // Seen from the neighbour across the opposite side, that side's frame is turned by
            // half a turn about its middle.
            let opposite = surface.sides[next(leaving)];
            let [x, y] = opposite.apex;
            Some(Beam {
                side: opposite.twin?,
                from: S::zero(),
                to: opposite.length,
                origin: [opposite.length - x, -y],
            })
        })
        .collect();
    while let Some(beam) = beams.pop() {
        // Depth first, few beams wait at any time, unless lines run in circles at no length.
        assert!(
            beams.len() < 1_000_000,
            "lines from {vertex} do not get ahead"
        );
        let [x, y] = beam.origin;
        let nearest = beam.from.max(beam.to.min(x));
        if start + (nearest - x).hypot(y) > limit {
            continue;
        }
        let apex_vertex = surface.sides[prev(beam.side)].tail;
        let (split, through) = reach_apex(surface, &beam);
        offer(&mut best[apex_vertex], start + through);
        beams.extend(left_part(surface, &beam, split));
        beams.extend(right_part(surface, &beam, split));
    }
}

/// Where the line to the apex crosses the beam's side, and the length of the shortest way to the
/// apex through the beam: straight if the crossing lies within the beam, else along its end ray.
fn reach_apex<S: Scalar>(surface: &Surface<S>, beam: &Beam<S>) -> (S, S) {
    let [cx, cy] = surface.sides[beam.side].apex;
    let [px, py] = beam.origin;
    let split = (cy * px - py * cx) / (cy - py);
    let through = if beam.from <= split && split <= beam.to {
        (cx - px).hypot(cy - py)
    } else {
        let bend = beam.from.max(beam.to.min(split));
        (bend - px).hypot(py) + (bend - cx).hypot(cy)
    };
    (split, through)
}

/// The lines that leave through the side from the tail to the apex.
fn left_part<S: Scalar>(surface: &Surface<S>, beam: &Beam<S>, split: S) -> Option<Beam<S>> {
    let entered = surface.sides[beam.side];
    let left = surface.sides[prev(beam.side)];
    let side = left.twin?;
    if beam.from >= split {
        return None;
    }
    let ([cx, cy], [px, py]) = (entered.apex, beam.origin);
    let length = left.length;
    let at = |s: S| clamp(-(length * py * s) / (cy * (px - s) - cx * py), length);
    let (ux, uy) = (cx / length, cy / length);
    kept(Beam {
        side,
        from: at(beam.from),
        to: if beam.to >= split {
            length
        } else {
            at(beam.to)
        },
        origin: [ux * px + uy * py, ux * py - uy * px],
    })
}

/// The lines that leave through the side from the apex to the head.
fn right_part<S: Scalar>(surface: &Surface<S>, beam: &Beam<S>, split: S) -> Option<Beam<S>> {
    let entered = surface.sides[beam.side];
    let right = surface.sides[next(beam.side)];
    let side = right.twin?;
    if beam.to <= split {
        return None;
    }
    let ([cx, cy], [px, py]) = (entered.apex, beam.origin);
    let (length, base) = (right.length, entered.length);
    let at = |s: S| {
        let along = length * ((s - split) * (cy - py));
        clamp(along / (cy * (s - px) - (base - cx) * py), length)
    };
    let (ux, uy) = ((base - cx) / length, -cy / length);
    kept(Beam {
        side,
        from: if beam.from <= split {
            S::zero()
        } else {
            at(beam.from)
        },
        to: at(beam.to),
        origin: [
            ux * (px - cx) + uy * (py - cy),
            ux * (py - cy) - uy * (px - cx),
        ],
    })
}

fn clamp<S: Scalar>(x: S, length: S) -> S {
    x.max(S::zero()).min(length)
}

/// The beam, if it has any width and comes from below its side; where rounding says otherwise, it
/// consists of one line at most.
fn kept<S: Scalar>(beam: Beam<S>) -> Option<Beam<S>> {
    (beam.from < beam.to && beam.origin[1] < S::zero()).then_some(beam)
}
