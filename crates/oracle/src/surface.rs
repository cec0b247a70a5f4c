//! Triangles joined along edges, each unfolded into the frames of its sides.

use std::collections::HashMap;
use std::f64::consts::PI;

use crate::scalar::RealNumber;

/// Height of a triangle without area, as a fraction of its longest side.
///
/// A triangle without area is raised to this height. That changes no digit of the result, but a
/// line then has two sides on which to pass the vertices of the triangle.
const LIFT: f64 = 1.0 / (1_u128 << 120) as f64 / (1_u64 << 40) as f64;

/// Side `3 * triangle + corner` in its own frame: tail at the origin, head at `(length, 0)`, third
/// vertex of the triangle at `apex`, above.
#[derive(Clone, Copy, Debug)]
pub(crate) struct SideFrame<S> {
    pub(crate) tail: usize,
    /// The side of the only other triangle at its edge, if it has the opposite direction.
    pub(crate) twin: Option<usize>,
    pub(crate) length: S,
    pub(crate) apex: [S; 2],
}

/// The side of another triangle along the same edge.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Beyond {
    pub(crate) side: usize,
    /// Whether both sides have the same direction, so that one of the triangles must be turned over
    /// to unfold it beside the other.
    pub(crate) turned: bool,
}

/// A surface of triangles, with all numbers in the precision of `S`.
///
/// An edge may have any number of triangles, and the surface need not be orientable.
#[derive(Clone, Debug)]
pub struct PreciseSurface<S> {
    pub(crate) sides: Vec<SideFrame<S>>,
    /// The sides of the other triangles along the edge of each side.
    pub(crate) beyond: Vec<Vec<Beyond>>,
    /// The sides that leave each vertex, in no order.
    pub(crate) leaving: Vec<Vec<usize>>,
    bends: Vec<bool>,
    /// Whether the triangles are embedded in space, so that every edge is the shortest path between
    /// its ends.
    pub(crate) in_space: bool,
}

/// The side after `side` around its triangle.
pub(crate) const fn next(side: usize) -> usize {
    side - side % 3 + (side + 1) % 3
}

/// The side before `side` around its triangle.
pub(crate) const fn prev(side: usize) -> usize {
    side - side % 3 + (side + 2) % 3
}

impl<S: RealNumber> PreciseSurface<S> {
    /// The surface of `triangles` with vertices at `positions`. Triangles may have no area.
    /// Vertices may be isolated. Several fans may meet at a vertex.
    ///
    /// # Panics
    ///
    /// If a triangle names a vertex that does not exist.
    pub fn from_positions(positions: &[[f64; 3]], triangles: &[[u32; 3]]) -> Self {
        let mut surface = Self::new(positions.len(), triangles, |t| {
            let corners = triangles[t].map(|v| positions[v as usize].map(S::from_f64));
            let sides = [0, 1, 2].map(|k| minus(corners[(k + 1) % 3], corners[k]));
            let lengths = sides.map(norm);
            // One area for all three frames: if it consists of rounding errors only, the frames are
            // consistent nevertheless. It comes from the two shorter sides: beside a far vertex,
            // the products of the two longer ones cancel.
            let longest = (0..3).fold(0, |a, b| if lengths[b] > lengths[a] { b } else { a });
            let [a, b] = [1, 2].map(|turn| sides[(longest + turn) % 3]);
            let twice_area = raised(norm(cross(a, b)), lengths);
            [0, 1, 2].map(|k| {
                let x = -dot(sides[(k + 2) % 3], sides[k]) / lengths[k];
                (lengths[k], [x, twice_area / lengths[k]])
            })
        });
        surface.in_space = true;
        surface
    }

    /// The surface of `triangles` with these side lengths: `lengths[t][k]` is the length of the
    /// side from corner `k` of triangle `t` to the next corner. The surface need not have an
    /// embedding in space.
    ///
    /// # Panics
    ///
    /// As [`from_positions`](Self::from_positions).
    pub fn from_lengths(vertex_count: usize, triangles: &[[u32; 3]], lengths: &[[S; 3]]) -> Self {
        Self::new(vertex_count, triangles, |t| {
            let twice_area = raised(heron(lengths[t]), lengths[t]);
            [0, 1, 2].map(|k| {
                let [l, lb, la] = [0, 1, 2].map(|i| lengths[t][(k + i) % 3]);
                let x = (l * l + (la - lb) * (la + lb)) / (l + l);
                (l, [x, twice_area / l])
            })
        })
    }

    fn new(
        vertex_count: usize,
        triangles: &[[u32; 3]],
        frames: impl Fn(usize) -> [(S, [S; 2]); 3],
    ) -> Self {
        let mut by_ends: HashMap<(usize, usize), Vec<usize>> = HashMap::new();
        let mut leaving = vec![Vec::new(); vertex_count];
        for (t, triangle) in triangles.iter().enumerate() {
            for k in 0..3 {
                let (tail, head) = (triangle[k] as usize, triangle[(k + 1) % 3] as usize);
                let ends = (tail.min(head), tail.max(head));
                by_ends.entry(ends).or_default().push(3 * t + k);
                leaving[tail].push(3 * t + k);
            }
        }
        let mut sides = Vec::with_capacity(3 * triangles.len());
        let mut beyond = Vec::with_capacity(3 * triangles.len());
        for (t, triangle) in triangles.iter().enumerate() {
            for (k, (length, apex)) in frames(t).into_iter().enumerate() {
                let (tail, head) = (triangle[k] as usize, triangle[(k + 1) % 3] as usize);
                let along = &by_ends[&(tail.min(head), tail.max(head))];
                let others = along.iter().filter(|&&side| side != 3 * t + k);
                let others: Vec<Beyond> = others
                    .map(|&side| Beyond {
                        side,
                        turned: triangles[side / 3][side % 3] as usize == tail,
                    })
                    .collect();
                let twin = match others[..] {
                    [
                        Beyond {
                            side,
                            turned: false,
                        },
                    ] => Some(side),
                    _ => None,
                };
                sides.push(SideFrame {
                    tail,
                    twin,
                    length,
                    apex,
                });
                beyond.push(others);
            }
        }
        let mut surface = Self {
            sides,
            beyond,
            leaving,
            bends: Vec::new(),
            in_space: false,
        };
        surface.bends = (0..vertex_count)
            .map(|v| {
                surface.can_bend(v) || surface.is_beside_thin_triangle(v) || surface.is_on_seam(v)
            })
            .collect();
        surface
    }

    /// Whether `vertex` is on an edge with more than two triangles, or with two that have the same
    /// direction. All are taken for vertices where a path can bend, which costs time only.
    fn is_on_seam(&self, vertex: usize) -> bool {
        let is_seam =
            |side: usize| self.sides[side].twin.is_none() && !self.beyond[side].is_empty();
        let leaving = &self.leaving[vertex];
        leaving
            .iter()
            .any(|&side| is_seam(side) || is_seam(prev(side)))
    }

    /// Number of vertices.
    pub fn vertex_count(&self) -> usize {
        self.leaving.len()
    }

    /// Whether a shortest path may bend at `vertex`: several fans meet there, or a fan has more
    /// than a full turn (more than half a turn if it is open). Also true at the corners of
    /// triangles of nearly no area, where a line cannot pass reliably.
    ///
    /// # Panics
    ///
    /// If there is no such vertex.
    pub fn bends_at(&self, vertex: u32) -> bool {
        self.bends[vertex as usize]
    }

    /// Whether `vertex` is on an edge of a single triangle.
    ///
    /// # Panics
    ///
    /// If there is no such vertex.
    pub fn is_boundary(&self, vertex: u32) -> bool {
        let open = |side: usize| self.beyond[side].is_empty();
        let leaving = &self.leaving[vertex as usize];
        leaving.iter().any(|&side| open(side) || open(prev(side)))
    }

    fn is_beside_thin_triangle(&self, vertex: usize) -> bool {
        self.leaving[vertex].iter().any(|&side| {
            let triangle = [side, next(side), prev(side)];
            let lengths = triangle.map(|s| self.sides[s].length);
            let longest = lengths[0].max(lengths[1]).max(lengths[2]);
            let twice_area = lengths[0] * self.sides[side].apex[1];
            twice_area < S::from_f64(S::THIN) * longest * longest
        })
    }

    fn can_bend(&self, vertex: usize) -> bool {
        let mut unseen = self.leaving[vertex].clone();
        let mut fans = 0;
        while let Some(&any) = unseen.first() {
            let (fan, open) = self.fan(any);
            unseen.retain(|side| !fan.contains(side));
            fans += 1;
            if self.exceeds_straight(&fan, open) {
                return true;
            }
        }
        fans > 1
    }

    /// The sides that leave a vertex within one fan, and whether the fan is open.
    fn fan(&self, start: usize) -> (Vec<usize>, bool) {
        let mut fan = vec![start];
        let mut side = start;
        while let Some(onward) = self.sides[prev(side)].twin {
            if onward == start {
                return (fan, false);
            }
            fan.push(onward);
            side = onward;
        }
        side = start;
        while let Some(twin) = self.sides[side].twin {
            side = next(twin);
            fan.push(side);
        }
        (fan, true)
    }

    /// Whether the angles of a fan have a sum above 2π, or above π for an open fan.
    ///
    /// The sum in f64 gives the number of full turns. The product of the directions as complex
    /// numbers gives the rest, in the full precision of `S`.
    fn exceeds_straight(&self, fan: &[usize], open: bool) -> bool {
        let limit = if open { PI } else { 2.0 * PI };
        let mut sum = 0.0;
        let mut product = [S::from_f64(if open { -1.0 } else { 1.0 }), S::zero()];
        for &side in fan {
            let [x, y] = self.sides[side].apex;
            sum += y.to_f64().atan2(x.to_f64());
            let reach = self.sides[prev(side)].length;
            let (x, y) = (x / reach, y / reach);
            let [re, im] = product;
            product = [re * x - im * y, re * y + im * x];
        }
        let excess = sum - limit;
        if excess.abs() > 0.1 {
            return excess > 0.0;
        }
        product[1].to_f64().atan2(product[0].to_f64()) > S::SADDLE_SLACK
    }
}

/// Twice the area of a triangle, by Kahan's form of Heron's formula.
fn heron<S: RealNumber>([a, b, c]: [S; 3]) -> S {
    let longest = a.max(b).max(c);
    let shortest = a.min(b).min(c);
    let middle = a.min(b).max(a.max(b).min(c));
    let product = (longest + (middle + shortest))
        * (shortest - (longest - middle))
        * (shortest + (longest - middle))
        * (longest + (middle - shortest));
    product.max(S::zero()).sqrt() * S::from_f64(0.5)
}

/// `twice_area`, raised if needed to that of the least height of a triangle with these sides.
fn raised<S: RealNumber>(twice_area: S, [a, b, c]: [S; 3]) -> S {
    let longest = a.max(b).max(c);
    twice_area.max(S::from_f64(LIFT) * longest * longest)
}

fn minus<S: RealNumber>(a: [S; 3], b: [S; 3]) -> [S; 3] {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

fn dot<S: RealNumber>(a: [S; 3], b: [S; 3]) -> S {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn cross<S: RealNumber>(a: [S; 3], b: [S; 3]) -> [S; 3] {
    [
        a[1] * b[2] - a[2] * b[1],
        a[2] * b[0] - a[0] * b[2],
        a[0] * b[1] - a[1] * b[0],
    ]
}

fn norm<S: RealNumber>(a: [S; 3]) -> S {
    dot(a, a).sqrt()
}
