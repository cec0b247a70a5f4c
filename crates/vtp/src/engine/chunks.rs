//! Lists that stay: windows keep their places in an unfolded plane while their list crosses faces.
//!
//! The windows of a list are rigid in the plane into which the faces are unfolded. A crossing turns
//! all of them alike, parts them at the apex, and joins lists. Of a long list most windows lie
//! beside the apex, and nothing about them changes. So a list is a row of *chunks* of up to
//! [`ROOM`] windows. A chunk has a frame of its own, in which its windows stay, and a header: where
//! this frame lies in that of the edge, and two straight lines that bound the rays of all windows.
//! If the apex is beside the lines, the header alone is turned. Else the chunk is opened.
//!
//! # Rounding
//!
//! Turning a header errs as turning a source does ([`geobench_window::precision`]): the place of
//! the frame by some ε of its distance from the edge and of the longest side of the face, after n
//! faces by at most n times as much. Windows are turned less often than one by one, when their
//! chunk joins another. The distance that matters is that from the *origin* of the frame, which may
//! be farther away than the source of a window. No origin is farther than the path of the window
//! that it was the source of when the frame was chosen. Other windows join a frame only if its
//! origin is at most [`FARTHEST`] times as far as a path to the edge is long: from a source 1e-10
//! away, windows that come back from edges of length 1 may wait on the same edge. So all that a
//! comparison of lengths may miss is within [`MARGIN`] of the path. Where sides are compared, the
//! distance of the origin counts as one of the coordinates ([`Chunk::blur`]).
//!
//! Turns are made vectors of [unit] length again wherever they are used to move windows. Without
//! that, a window that joins one chunk after another is enlarged by the same error each time, and
//! distances on 300,000 faces were too long by 1e-12.
//!
//! # Gaps
//!
//! In the usual form every window offers a path to the apex, bent if it does not see it. Here only
//! windows that see it do, and a ray that rounding has put into a gap between two windows is
//! offered by either. The rounding is that of the longest edge of the mesh, so lists on edges that
//! are hardly longer than it have the usual form. A shadow is wider than that: behind a vertex with
//! an angle of hardly more than 2π, which sends no windows, no window sees anything. So lists stay
//! only on meshes in which such vertices are few, and there they send windows
//! ([`light_shadows`](super::layout::MeshLayout::light_shadows)).

use geobench_window::prefetch_line;
use geobench_window::simd::{CacheLine, Lanes};

use super::kernels::Triangle;
use super::kernels::chunks::{Bounds, ChunkPart, leave, turn_rows};
use super::store::{Block, COLUMNS, Columns, PaddedBlock};
use crate::precision::{MARGIN, blur};

/// The largest number of windows in a chunk: one for each bit of a mask.
pub(crate) const ROOM: usize = 64;

/// Lines of a column of a body, and of a body.
const COLUMN: usize = ROOM / CacheLine::LANES;
const BODY: usize = COLUMNS * COLUMN;

/// The steepest ray in the frame of a chunk: its abscissa changes by so much for each unit of
/// height. A window alone in its chunk may be somewhat steeper.
pub(crate) const STEEPEST: f64 = 10.0;

/// The least cosine between the frames of two chunks that are joined.
const ALIKE: f64 = 0.2;

/// The least length of the sum of both directions of a window, for it to be in a chunk: those of
/// windows of almost half a turn have no slopes.
const NARROWEST_SUM: f64 = 0.1;

/// How far a source must be from both ends of a window for it to be in a chunk, as a fraction of
/// the edge. The direction of a ray comes from the place of an end, which errs by ε of the edge.
const NEAREST: f64 = 1e-3;

/// How far an origin may be from the edge for windows to join its frame, in lengths of a shortest
/// path to the edge. ε times this is far below the precision of distances.
const FARTHEST: f64 = 1e4;

/// How many chunks of a list are tried for joining.
const TRIED: usize = 3;

/// Relative rounding of `f32`, with room for that of a sum of two products.
const ROUNDING: f64 = 2e-7;

/// The least margin of bounding lines. Below it, and above its inverse, `f32` has other rounding.
const LEAST_MARGIN: f64 = 1e-30;

/// Heights between which there is nothing.
const NO_HEIGHTS: [f32; 2] = [1.0, -1.0];

/// The header of a chunk, in one cache line.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(64))]
pub(crate) struct Chunk {
    /// Cosine and sine of the turn from the frame of the chunk to that of the edge.
    turn: [f64; 2],
    /// The origin of the chunk in the frame of the edge.
    origin: [f64; 2],
    /// The heights between which the lines bound the rays; none if the second is less.
    heights: [f32; 2],
    /// A line left of all rays: its abscissa at height 0, and its slope.
    left: [f32; 2],
    /// A line right of all rays.
    right: [f32; 2],
    body: u32,
    pub(crate) len: u16,
    /// Whether the filter has deleted a neighbour of the windows; it may delete these as well.
    pub(crate) doubtful: bool,
}

const _: () = assert!(size_of::<Chunk>() == 64);

impl Chunk {
    /// A point of the frame of the edge in that of the chunk.
    #[inline(always)]
    pub(crate) fn inside(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        self.direction_inside([x - self.origin[0], y - self.origin[1]])
    }

    #[inline(always)]
    fn direction_inside(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        let [c, s] = self.turn;
        [c * x + s * y, c * y - s * x]
    }

    /// A direction of the frame of the chunk in that of the edge.
    #[inline(always)]
    fn direction_outside(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        let [c, s] = self.turn;
        [c * x - s * y, s * x + c * y]
    }

    /// Whether windows may join the frame, on an edge to which a path of this `length` leads.
    #[inline(always)]
    fn is_near(&self, length: f64) -> bool {
        let [x, y] = self.origin;
        x.abs() + y.abs() <= FARTHEST * length
    }

    /// The side of the apex at `[x, y]` in the frame of the chunk on which all of it passes, left
    /// (0) or right (1); `None` if the header does not tell.
    #[inline(always)]
    pub(crate) fn passage(&self, [x, y]: [f64; 2]) -> Option<usize> {
        let [low, high] = self.heights.map(f64::from);
        if self.doubtful || !(low <= y && y <= high) {
            return None;
        }
        let [left, right] = [self.left, self.right].map(|[x, slope]| {
            let (x, slope) = (f64::from(x), f64::from(slope));
            x + slope * y
        });
        if right < x {
            Some(0)
        } else {
            (x < left).then_some(1)
        }
    }

    /// The chunk beyond the left (0) or right (1) exit of `triangle`.
    #[inline(always)]
    fn beyond(&self, side: usize, triangle: &Triangle) -> Self {
        let [ux, uy] = triangle.directions[side];
        let [c, s] = self.turn;
        let start = [[0.0; 2], triangle.apex][side];
        let [x, y] = [self.origin[0] - start[0], self.origin[1] - start[1]];
        Self {
            turn: [ux * c + uy * s, ux * s - uy * c],
            origin: [ux * x + uy * y, ux * y - uy * x],
            ..*self
        }
    }

    /// The bound of the rounding error of the sources of the chunk, in addition to that of their
    /// own coordinates, on a mesh with edges up to `longest`.
    #[inline]
    pub(crate) fn blur(&self, longest: f64) -> f64 {
        let [x, y] = self.origin;
        blur(longest) + MARGIN * (x.abs() + y.abs())
    }

    /// Sets the bounding lines.
    ///
    /// Between both heights, the rightmost ray is a convex function of the height, so it is left of
    /// its chord. The lines are moved outwards, and the heights inwards, by more than the rounding
    /// of `f32`.
    #[inline(always)]
    pub(crate) fn bound(&mut self, bounds: &Bounds) {
        let Bounds {
            heights: [low, high],
            left,
            right,
        } = *bounds;
        let inverse = 1.0 / (high - low);
        let [left_slope, right_slope] = [left, right].map(|[a, b]| (b - a) * inverse);
        let [left, right] = [left[0] - left_slope * low, right[0] - right_slope * low];
        let height = low.abs() + high.abs();
        let size = left.abs() + right.abs() + (left_slope.abs() + right_slope.abs()) * height;
        let margin = ROUNDING * (size + height);
        self.heights = if LEAST_MARGIN < margin && margin < 1.0 / LEAST_MARGIN {
            [low + 1e-6 * low.abs(), high - 1e-6 * high.abs()].map(|y| y as f32)
        } else {
            NO_HEIGHTS
        };
        self.left = [(left - margin) as f32, left_slope as f32];
        self.right = [(right + margin) as f32, right_slope as f32];
    }

    /// Moves the lines outwards, so that they bound other rays as well.
    #[inline(always)]
    fn extend(&mut self, more: &Bounds) {
        let at = |[x, slope]: [f32; 2], y: f64| f64::from(x) + f64::from(slope) * y;
        let bounds = Bounds {
            heights: more.heights,
            left: [0, 1].map(|i| at(self.left, more.heights[i]).min(more.left[i])),
            right: [0, 1].map(|i| at(self.right, more.heights[i]).max(more.right[i])),
        };
        self.bound(&bounds);
    }

    /// The heights at which rays are measured to [extend](Self::extend) the lines, if there are
    /// lines.
    #[inline(always)]
    fn measured(&self) -> Option<[f64; 2]> {
        let [low, high] = self.heights.map(f64::from);
        (low < high).then_some([low, high])
    }
}

/// The chunks of all lists, by the numbers of the lists in the [`WindowStore`].
///
/// [`WindowStore`]: super::store::WindowStore
#[derive(Clone, Debug, Default)]
pub(crate) struct ChunkStore {
    /// The bodies: the sources of windows, their σ, and the slopes of their left and right rays.
    lines: Vec<CacheLine>,
    free: Vec<u32>,
    lists: Vec<ChunkList>,
    /// Empty vectors, for the chunks of further lists.
    spare: Vec<Vec<Chunk>>,
}

/// The chunks of a list.
#[derive(Clone, Debug, Default)]
pub(crate) struct ChunkList {
    /// The half-edge on which it waits.
    pub(crate) h: u32,
    pub(crate) chunks: Vec<Chunk>,
}

impl ChunkStore {
    /// The body of a chunk.
    #[inline(always)]
    pub(crate) fn columns(&self, chunk: &Chunk) -> Columns<'_> {
        let start = chunk.body as usize * BODY;
        Columns::new(
            &self.lines[start..start + BODY],
            COLUMN as u32,
            chunk.len.into(),
        )
    }

    /// The bodies of two chunks, for writing.
    #[inline(always)]
    pub(crate) fn bodies(&mut self, of: [&Chunk; 2]) -> [&mut [CacheLine]; 2] {
        let [a, b] = of.map(|chunk| chunk.body as usize * BODY);
        let cut = a.max(b);
        let (low, high) = self.lines.split_at_mut(cut);
        let low = &mut low[a.min(b)..][..BODY];
        let high = &mut high[..BODY];
        if a < b { [low, high] } else { [high, low] }
    }

    /// The body of a chunk and a line behind it, for writing.
    #[inline(always)]
    pub(crate) fn body(&mut self, chunk: &Chunk) -> &mut [CacheLine] {
        let start = chunk.body as usize * BODY;
        &mut self.lines[start..=start + BODY]
    }

    /// A copy of the header of `chunk` with a body of its own, which is empty.
    #[inline]
    pub(crate) fn another(&mut self, chunk: &Chunk) -> Chunk {
        let body = self.free.pop().unwrap_or_else(|| {
            // Kernels may load one number behind a body, without using it.
            let end = self.lines.len().saturating_sub(1);
            self.lines.resize(end + BODY + 1, CacheLine::default());
            (end / BODY) as u32
        });
        Chunk { body, ..*chunk }
    }

    /// Frees the body of a chunk.
    #[inline]
    pub(crate) fn drop(&mut self, chunk: &Chunk) {
        self.free.push(chunk.body);
    }

    /// Takes the chunks of `list`.
    #[inline(always)]
    pub(crate) fn take(&mut self, list: u32) -> Vec<Chunk> {
        match self.lists.get_mut(list as usize) {
            Some(list) if !list.chunks.is_empty() => std::mem::take(&mut list.chunks),
            _ => self.spare.pop().unwrap_or_default(),
        }
    }

    /// Keeps the memory of a list whose `chunks` have moved on.
    #[inline(always)]
    pub(crate) fn spare(&mut self, mut chunks: Vec<Chunk>) {
        chunks.clear();
        self.spare.push(chunks);
    }

    /// Sets the chunks of `list`, which waits on `h`.
    #[inline(always)]
    pub(crate) fn put(&mut self, list: u32, h: u32, chunks: Vec<Chunk>) {
        if self.lists.len() <= list as usize {
            self.lists
                .resize_with(list as usize + 1, ChunkList::default);
        }
        self.lists[list as usize] = ChunkList { h, chunks };
    }

    /// Whether `list` has chunks.
    #[inline(always)]
    pub(crate) fn holds(&self, list: u32) -> bool {
        !self.of(list).is_empty()
    }

    /// The chunks of `list`.
    #[inline(always)]
    pub(crate) fn of(&self, list: u32) -> &[Chunk] {
        self.lists
            .get(list as usize)
            .map_or(&[], |list| &list.chunks)
    }

    /// Gives the chunks of list `old` the number `new`.
    #[inline(always)]
    pub(crate) fn rename(&mut self, old: u32, new: u32) {
        if self.holds(old) {
            let ChunkList { h, chunks } = std::mem::take(&mut self.lists[old as usize]);
            self.put(new, h, chunks);
        }
    }

    /// All lists that may have chunks.
    pub(crate) fn lists(&self) -> &[ChunkList] {
        &self.lists
    }

    /// Prefetches the last chunks of `list`, or all of them.
    #[inline(always)]
    pub(crate) fn prefetch_headers(&self, list: u32, most: usize) {
        for chunk in self.of(list).iter().rev().take(most) {
            prefetch_line(chunk);
        }
    }

    /// Prefetches the bodies of the chunks of `list` that will be opened at the `apex`.
    #[inline(always)]
    pub(crate) fn prefetch_bodies(&self, list: u32, apex: [f64; 2]) {
        for chunk in self.of(list) {
            if chunk.passage(chunk.inside(apex)).is_none() {
                let lines = usize::from(chunk.len).div_ceil(CacheLine::LANES);
                let body = &self.lines[chunk.body as usize * BODY..][..BODY];
                for column in 0..COLUMNS {
                    for line in 0..lines.min(COLUMN) {
                        prefetch_line(&body[column * COLUMN + line]);
                    }
                }
            }
        }
    }

    /// The windows of a chunk in the frame of its edge, which has length `l`. Narrow ones may be
    /// empty there.
    pub(crate) fn rows(&self, chunk: &Chunk, l: f64) -> impl Iterator<Item = [f64; COLUMNS]> {
        (0..chunk.len.into()).map(move |i| self.row(chunk, i, l))
    }

    /// Window `i` of a chunk in the frame of its edge, which has length `l`. It may be empty.
    #[inline]
    pub(crate) fn row(&self, chunk: &Chunk, i: usize, l: f64) -> [f64; COLUMNS] {
        let [x, y, sigma, left, right] = self.columns(chunk).row(i);
        let [px, py] = chunk.direction_outside([x, y]);
        let (px, py) = (px + chunk.origin[0], py + chunk.origin[1]);
        let end = |slope, beyond| {
            let [x, y] = chunk.direction_outside([slope, 1.0]);
            // A ray that never meets the edge passes its end.
            if y > 0.0 { px - py * x / y } else { beyond }
        };
        let (b0, b1) = (end(left, 0.0).max(0.0), end(right, l).min(l));
        [b0, b1, px, -py.abs(), sigma]
    }

    /// Appends windows in the frame of an edge of length `l` to the chunks of its list. Returns
    /// whether they could be, all or none: a source may be too close to the edge.
    pub(crate) fn bring(&mut self, windows: Columns<'_>, l: f64, chunks: &mut Vec<Chunk>) -> bool {
        let rows = || (0..windows.len()).map(|i| windows.row(i));
        let directions = |row| Directions::of(row).filter(|d| d.shorter > NEAREST * l);
        if !rows().all(|row| directions(row).is_some()) {
            return false;
        }
        for (row, directions) in rows().zip(rows().filter_map(directions)) {
            let [.., px, py, sigma] = row;
            let joins = |chunk: &Chunk| {
                let slopes = directions.rays.map(|d| chunk.direction_inside(d));
                usize::from(chunk.len) < ROOM
                    && chunk.is_near(sigma + directions.shorter)
                    && slopes.iter().all(|[x, y]| x.abs() <= STEEPEST * y)
            };
            if !chunks.last().is_some_and(joins) {
                let [x, y] = directions.middle;
                let frame = Chunk {
                    turn: [y, -x],
                    origin: [px, py],
                    heights: NO_HEIGHTS,
                    left: [0.0; 2],
                    right: [0.0; 2],
                    body: 0,
                    len: 0,
                    doubtful: false,
                };
                let chunk = self.another(&frame);
                chunks.push(chunk);
            }
            let Some(chunk) = chunks.last_mut() else {
                return false;
            };
            let [x, y] = chunk.inside([px, py]);
            let slopes = directions.rays.map(|d| {
                let [x, y] = chunk.direction_inside(d);
                x / y
            });
            let i = usize::from(chunk.len);
            let body = self.body(chunk);
            for (column, value) in [x, y, sigma, slopes[0], slopes[1]].into_iter().enumerate() {
                body[column * COLUMN + i / CacheLine::LANES].0[i % CacheLine::LANES] = value;
            }
            chunk.len += 1;
            if let Some(heights) = chunk.measured() {
                let [left, right] = slopes.map(|slope| heights.map(|h| x + slope * (h - y)));
                chunk.extend(&Bounds {
                    heights,
                    left,
                    right,
                });
            }
        }
        true
    }

    /// Appends the `chunk` to `list` beyond the left (0) or right (1) exit of `triangle`, to which
    /// a path of length `shortest` leads, or joins it to one of the last chunks there.
    #[inline(always)]
    pub(crate) fn push<L: Lanes>(
        &mut self,
        simd: L::Token,
        list: &mut Vec<Chunk>,
        chunk: &Chunk,
        side: usize,
        triangle: &Triangle,
        shortest: f64,
    ) {
        let chunk = chunk.beyond(side, triangle);
        let half = (ROOM / 2) as u16;
        if chunk.len <= half || list.last().is_some_and(|last| last.len <= half) {
            for last in list.iter_mut().rev().take(TRIED) {
                if usize::from(last.len + chunk.len) <= ROOM
                    && last.is_near(shortest)
                    && self.join::<L>(simd, last, &chunk)
                {
                    self.drop(&chunk);
                    return;
                }
            }
        }
        list.push(chunk);
    }

    /// Moves a part of `from` through an exit into `to`, which may have the same body.
    #[inline(always)]
    pub(crate) fn leave<L: Lanes>(
        &mut self,
        simd: L::Token,
        from: &Chunk,
        to: &mut Chunk,
        part: &ChunkPart<'_>,
    ) {
        let (column, len) = (COLUMN as u32, from.len.into());
        let (kept, bounds) = if from.body == to.body {
            let mut body = PaddedBlock::new(self.body(from), column);
            let mut rows = body.in_place(len);
            let bounds = leave::<L>(simd, &mut rows, part);
            (rows.kept(), bounds)
        } else {
            let [from, to] = self.bodies([from, to]);
            let mut to = Block::new(to, column);
            let mut rows = (Columns::new(from, column, len), to.append(0));
            let bounds = leave::<L>(simd, &mut rows, part);
            (rows.1.len(), bounds)
        };
        to.len = kept as u16;
        to.doubtful = false;
        to.turn = unit(to.turn);
        if kept > 0 {
            to.bound(&bounds);
        }
    }

    /// Joins `other` to `chunk`, if their frames are alike. Returns whether they are.
    #[inline(always)]
    fn join<L: Lanes>(&mut self, simd: L::Token, chunk: &mut Chunk, other: &Chunk) -> bool {
        let [x, y] = other.turn;
        let turn = unit(chunk.direction_inside([x, y]));
        if turn[0] < ALIKE {
            return false;
        }
        let place = chunk.inside(other.origin);
        let [to, from] = self.bodies([chunk, other]);
        let from = Columns::new(from, COLUMN as u32, other.len.into());
        let mut to = Block::new(to, COLUMN as u32);
        let mut to = to.append(chunk.len.into());
        let heights = chunk.measured();
        let Some(bounds) = turn_rows::<L>(simd, from, &mut to, turn, place, heights) else {
            return false;
        };
        chunk.len += other.len;
        chunk.doubtful |= other.doubtful;
        if heights.is_some() {
            chunk.extend(&bounds);
        }
        true
    }
}

/// A vector of unit length up to rounding, normalised: frames are turned many times, and errors of
/// the length multiply.
#[inline(always)]
pub(crate) fn unit([x, y]: [f64; 2]) -> [f64; 2] {
    let inverse = 1.5 - 0.5 * (x * x + y * y);
    [x * inverse, y * inverse]
}

/// The directions of a window.
struct Directions {
    rays: [[f64; 2]; 2],
    /// The unit vector in the middle between both.
    middle: [f64; 2],
    /// The distance from the source to the nearer end.
    shorter: f64,
}

impl Directions {
    /// `None` if the window spans almost half a turn.
    fn of([b0, b1, px, py, _]: [f64; COLUMNS]) -> Option<Self> {
        let rays = [[b0 - px, -py], [b1 - px, -py]];
        let [l0, l1] = rays.map(|[x, y]| (x * x + y * y).sqrt());
        let sum = [rays[0][0] / l0 + rays[1][0] / l1, -py / l0 - py / l1];
        let size = (sum[0] * sum[0] + sum[1] * sum[1]).sqrt();
        (size > NARROWEST_SUM).then(|| Self {
            rays,
            middle: sum.map(|x| x / size),
            shorter: l0.min(l1),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::engine::kernels::chunks::look;
    use geobench_mesh::SplitMix64;
    use geobench_window::simd::Scalar;

    const TRIANGLE: Triangle = Triangle {
        l: 1.0,
        exits: [1.0, 1.0],
        apex: [0.5, 0.866_025_403_784_438_6],
        directions: [
            [0.5, 0.866_025_403_784_438_6],
            [0.5, -0.866_025_403_784_438_6],
        ],
    };

    /// Windows from sources up to `spread` to both sides and at least `depth` below.
    fn windows(count: usize, spread: f64, depth: f64) -> Vec<[f64; COLUMNS]> {
        let mut random = SplitMix64::new(7);
        let mut number = move || (random.next() >> 11) as f64 / (1_u64 << 53) as f64;
        let window = |_| {
            let b0 = 0.9 * number();
            let b1 = b0 + 0.1 * number();
            [
                b0,
                b1,
                spread * (2.0 * number() - 1.0),
                -depth - 9.0 * number(),
                number(),
            ]
        };
        (0..count).map(window).collect()
    }

    /// The chunks of these windows, on an edge of length 1.
    fn brought(store: &mut ChunkStore, rows: &[[f64; COLUMNS]]) -> Vec<Chunk> {
        let mut windows = crate::engine::store::WindowStore::new();
        let list = windows.append_rows(crate::engine::store::NO_LIST, rows);
        let mut chunks = Vec::new();
        assert!(store.bring(windows.columns(list), 1.0, &mut chunks));
        chunks
    }

    #[test]
    fn windows_come_out_of_chunks_as_they_came_in() {
        let mut store = ChunkStore::default();
        let rows = windows(200, 4.0, 0.1);
        let chunks = brought(&mut store, &rows);
        let out = chunks.iter().flat_map(|chunk| store.rows(chunk, 1.0));
        let out: Vec<_> = out.collect();
        assert_eq!(out.len(), rows.len());
        for (row, expected) in out.iter().zip(&rows) {
            let same = row.iter().zip(expected).all(|(x, e)| (x - e).abs() < 1e-13);
            assert!(same, "{row:?} instead of {expected:?}");
        }
    }

    #[test]
    fn windows_of_half_a_turn_and_sources_on_the_edge_are_not_brought() {
        let mut windows = crate::engine::store::WindowStore::new();
        for row in [
            [0.0, 1.0, 0.5, -0.01, 0.0],
            [0.25, 0.5, 0.25, 0.0, 0.0],
            [0.25, 0.5, 0.25, -1e-6, 0.0],
        ] {
            let list = windows.append_rows(crate::engine::store::NO_LIST, &[row]);
            let mut chunks = Vec::new();
            let mut store = ChunkStore::default();
            assert!(!store.bring(windows.columns(list), 1.0, &mut chunks));
            assert!(chunks.is_empty());
        }
    }

    /// A chunk that passes the apex on one side has no window with rays on the other, joined or
    /// not.
    #[test]
    fn lines_bound_the_rays_of_joined_chunks() {
        let mut store = ChunkStore::default();
        let mut list = Vec::new();
        for rows in windows(60, 1.0, 5.0).chunks(3) {
            for mut chunk in brought(&mut store, rows) {
                let apex = chunk.inside(TRIANGLE.apex);
                let slopes = [CacheLine::default(); ROOM / CacheLine::LANES];
                let part = ChunkPart {
                    left: true,
                    chosen: u64::MAX,
                    parted: 0,
                    apex,
                    cut: 0,
                    slopes: &slopes,
                    start: chunk.inside([0.0; 2]),
                    along: chunk.direction_inside([1.0, 0.0]),
                    length: 1.0,
                    reach: [f64::INFINITY; 2],
                    heights: [apex[1] - 2.0, apex[1] + 12.0],
                };
                let from = chunk;
                store.leave::<Scalar>((), &from, &mut chunk, &part);
                assert_eq!(chunk.len, from.len);
                store.push::<Scalar>((), &mut list, &chunk, 0, &TRIANGLE, 10.0);
            }
        }
        assert!(list.len() < 10, "chunks were joined");
        let mut passed = [0; 3];
        for chunk in &list {
            for i in 0..400 {
                let apex = [f64::from(i % 20) - 9.5, 0.5 + f64::from(i / 20) / 10.0];
                let apex = chunk.inside(apex);
                let [left, right] = look::<Scalar>((), store.columns(chunk), apex, 0.0).sides;
                let passage = chunk.passage(apex);
                passed[passage.unwrap_or(2)] += 1;
                if let Some(side) = passage {
                    assert_eq!([right, left][side], 0);
                }
            }
        }
        assert!(passed.iter().all(|&count| count > 50), "{passed:?}");
    }
}
