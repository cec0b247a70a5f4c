//! A flat corridor on which the papers' bounds on the number of windows are reached.
//!
//! The corridor has width 1, `n = 2^levels` square cells, a band of rows with 2, 4, ..., n, ..., 4
//! and 2 edges across, and n more cells. The row of n edges lies about n from the source, so it
//! splits what the source sees into about n windows that go on through the second half: Ω(n²)
//! windows on O(n) faces, in any order of propagation and under any rule for redundant windows,
//! since no path is longer than another one.
//!
//! Holes before the corridor make the order matter. Each can be passed on the left, along two
//! edges, or on the right, along three and a shorter way. MMP that takes windows first in, first
//! out reaches the corridor over the longest way first and improves it once for each hole: as many
//! wavefronts follow each other through the corridor, Ω(n³) windows with about n holes. Algorithms
//! that give up the windows of a vertex that has come nearer stop the older ones.

use super::keys::{Key, Params};
use crate::soup::TriangleSoup;

/// Vertices inside the right side of a hole.
const ON_THE_RIGHT: usize = 2;

/// Distance between holes, and of the first one from the source.
const GAP: f64 = 0.125;

/// How far a hole extends to the left.
const DEPTH: f64 = 0.4375;

pub(super) const KEYS: &[Key] = &[
    Key::whole(
        "levels",
        8,
        [1, 20],
        "2^levels cells before and behind the row of as many edges",
    ),
    Key::whole(
        "holes",
        0,
        [0, 1_000_000],
        "holes near the source, each with a longer and a shorter way around it",
    ),
];

pub(super) fn faces(params: &Params<'_>) -> u64 {
    let (n, holes) = (1 << params.whole("levels"), params.whole("holes"));
    (7 + ON_THE_RIGHT as u64) * holes + 3 + 4 * n + 6 * (n - 1)
}

/// The source is vertex 0, in the middle of the closed end.
pub(super) fn build(params: &Params<'_>) -> TriangleSoup {
    let (levels, holes) = (params.count("levels"), params.count("holes"));
    let n = 1 << levels;
    let mut corridor = Corridor::default();
    corridor.holes(holes);
    (0..n).for_each(|_| corridor.cell());
    for level in 1..=levels {
        corridor.row(1 << level);
    }
    for level in (0..levels).rev() {
        corridor.row(1 << level);
    }
    (0..n).for_each(|_| corridor.cell());
    corridor.soup
}

/// A corridor under construction.
#[derive(Default)]
struct Corridor {
    soup: TriangleSoup,
    /// How far it has got.
    y: f64,
    /// The vertices of its last row, from left to right.
    last: Vec<u32>,
}

impl Corridor {
    fn vertex(&mut self, x: f64, y: f64) -> u32 {
        self.soup.positions.push([x, y, 0.0]);
        self.soup.positions.len() as u32 - 1
    }

    /// Starts with the source between the ends of its row, passes the holes, and ends with a row of
    /// one edge.
    fn holes(&mut self, holes: usize) {
        let mut middle = self.vertex(0.5, 0.0);
        let mut sides = [0.0, 1.0].map(|x| self.vertex(x, 0.0));
        for _ in 0..holes {
            self.y += GAP;
            let near = self.vertex(0.5, self.y);
            let [left, right] = sides;
            let triangles = [[left, middle, near], [right, near, middle]];
            self.soup.triangles.extend(triangles);
            (middle, sides) = self.hole(near, sides);
        }
        self.y += 1.0;
        let [a, b] = [0.0, 1.0].map(|x| self.vertex(x, self.y));
        let [left, right] = sides;
        let triangles = [[left, middle, a], [middle, b, a], [middle, right, b]];
        self.soup.triangles.extend(triangles);
        self.last = vec![a, b];
    }

    /// A hole of height 1 above `near`, between the walls. Returns its upper end and the vertices
    /// on the walls beside it.
    fn hole(&mut self, near: u32, [left, right]: [u32; 2]) -> (u32, [u32; 2]) {
        let tip = self.vertex(0.5 - DEPTH, self.y + 0.5);
        let mut straight = vec![near];
        for i in 1..=ON_THE_RIGHT + 1 {
            let part = i as f64 / (ON_THE_RIGHT + 1) as f64;
            straight.push(self.vertex(0.5, self.y + part));
        }
        let far = straight[ON_THE_RIGHT + 1];
        self.y += 1.0;
        let [above_left, above_right] = [0.0, 1.0].map(|x| self.vertex(x, self.y));
        let triangles = &mut self.soup.triangles;
        triangles.extend([
            [left, near, tip],
            [left, tip, above_left],
            [tip, far, above_left],
        ]);
        triangles.extend(straight.windows(2).map(|pair| [right, pair[1], pair[0]]));
        triangles.push([right, above_right, far]);
        (far, [above_left, above_right])
    }

    /// A square behind a row of one edge.
    fn cell(&mut self) {
        self.y += 1.0;
        let next = self.points(1);
        let (a, b, c, d) = (self.last[0], self.last[1], next[0], next[1]);
        self.soup.triangles.extend([[a, b, d], [a, d, c]]);
        self.last = next;
    }

    /// A row of `edges` edges, twice or half as many as the last row has.
    fn row(&mut self, edges: usize) {
        let before = self.last.len() - 1;
        self.y += 1.0 / edges.max(before) as f64;
        let next = self.points(edges);
        let (coarse, fine) = if edges > before {
            (&self.last, &next)
        } else {
            (&next, &self.last)
        };
        for (i, edge) in coarse.windows(2).enumerate() {
            let (a, b, c, m, d) = (
                edge[0],
                edge[1],
                fine[2 * i],
                fine[2 * i + 1],
                fine[2 * i + 2],
            );
            let triangles = [[a, b, m], [a, m, c], [b, d, m]];
            let turned = |[u, v, w]: [u32; 3]| if edges > before { [u, v, w] } else { [v, u, w] };
            self.soup.triangles.extend(triangles.map(turned));
        }
        self.last = next;
    }

    /// The vertices of a row.
    fn points(&mut self, edges: usize) -> Vec<u32> {
        let y = self.y;
        let places = (0..=edges).map(|i| i as f64 / edges as f64);
        places.map(|x| self.vertex(x, y)).collect()
    }
}
