//! The passes over the windows of a [chunk](crate::engine::chunks), in its own frame.
//!
//! A ray of a window with source p and slope s is the line x = px + s·(y - py). So the side of a
//! point takes one product.

use geobench_window::simd::{CacheLine, InPlace, LaneMask, Lanes, Sink};

use crate::engine::chunks::{ROOM, STEEPEST};
use crate::engine::store::{COLUMNS, Columns};
use crate::precision::MARGIN;

/// Lines that bound the rays of windows: their abscissae at two heights.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Bounds {
    pub(crate) heights: [f64; 2],
    pub(crate) left: [f64; 2],
    pub(crate) right: [f64; 2],
}

/// The outermost rays of some windows, in lanes.
struct Outermost<L> {
    heights: [L; 2],
    left: [L; 2],
    /// The least of the negated abscissae.
    right: [L; 2],
}

impl<L: Lanes> Outermost<L> {
    #[inline(always)]
    fn new(simd: L::Token, heights: [f64; 2]) -> Self {
        let [low, high] = heights;
        let none = L::splat(simd, f64::INFINITY);
        Self {
            heights: [L::splat(simd, low), L::splat(simd, high)],
            left: [none; 2],
            right: [none; 2],
        }
    }

    /// Adds the windows that `mask` chooses.
    #[inline(always)]
    fn add(&mut self, simd: L::Token, mask: L::Mask, [px, py, left, right]: [L; 4]) {
        let (none, zero) = (L::splat(simd, f64::INFINITY), L::splat(simd, 0.0));
        for i in 0..2 {
            let height = self.heights[i] - py;
            let on_left = px + left * height;
            let on_right = zero - (px + right * height);
            self.left[i] = self.left[i].min(L::select(mask, on_left, none));
            self.right[i] = self.right[i].min(L::select(mask, on_right, none));
        }
    }

    #[inline(always)]
    fn bounds(&self, heights: [f64; 2]) -> Bounds {
        Bounds {
            heights,
            left: [self.left[0].least(), self.left[1].least()],
            right: [-self.right[0].least(), -self.right[1].least()],
        }
    }
}

/// The bits of `mask` for the windows of a register.
#[inline(always)]
fn lanes_of<L: Lanes>(simd: L::Token, mask: u64, register: usize) -> L::Mask {
    L::mask(simd, (mask >> (register * L::COUNT)) as u8)
}

/// What the windows of a chunk see of an apex.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Sight {
    /// The windows with rays on the left of the apex, and on its right.
    pub(crate) sides: [u64; 2],
    /// The shortest straight path to the apex, infinite if no window sees it, and its window.
    pub(crate) distance: f64,
    pub(crate) best: usize,
}

/// How the windows of a chunk pass the `apex`. `blur` is the error of their sources in addition to
/// that of coordinates.
///
/// A window sees the apex also if it is beside its rays by no more than rounding: one of the
/// windows around a gap of rounding offers the path through the gap.
#[inline(always)]
pub(crate) fn look<L: Lanes>(
    simd: L::Token,
    windows: Columns<'_>,
    apex: [f64; 2],
    blur: f64,
) -> Sight {
    let mut sight = Sight {
        sides: [0; 2],
        distance: f64::INFINITY,
        best: 0,
    };
    let (cx, cy) = (L::splat(simd, apex[0]), L::splat(simd, apex[1]));
    let (zero, none) = (L::splat(simd, 0.0), L::splat(simd, f64::INFINITY));
    let doubt = blur + MARGIN * (apex[0].abs() + apex[1].abs());
    let (doubt, margin) = (L::splat(simd, doubt), L::splat(simd, MARGIN));
    for register in 0..windows.registers::<L>() {
        let [px, py, sigma, left, right] = windows.load::<L>(simd, register);
        let listed = windows.listed::<L>(simd, register);
        let (x, y) = (cx - px, cy - py);
        let (from_left, from_right) = (x - left * y, x - right * y);
        let on_left = listed & zero.lt(from_left);
        let on_right = listed & from_right.lt(zero);
        sight.sides[0] |= u64::from(on_left.bits()) << (register * L::COUNT);
        sight.sides[1] |= u64::from(on_right.bits()) << (register * L::COUNT);
        let doubt = doubt + margin * (x.abs() + y.abs());
        let sees = listed & (zero - from_left).lt(doubt) & from_right.lt(doubt);
        if sees.any() {
            let path = L::select(sees, sigma + (x * x + y * y).sqrt(), none);
            let shortest = path.least();
            if shortest < sight.distance {
                let here = path.le(L::splat(simd, shortest)).bits().trailing_zeros();
                sight.distance = shortest;
                sight.best = register * L::COUNT + here as usize;
            }
        }
    }
    sight
}

/// Where a part of a chunk goes.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ChunkPart<'a> {
    /// Whether it goes to the left.
    pub(crate) left: bool,
    /// The windows of the part.
    pub(crate) chosen: u64,
    /// Those with rays on both sides of the apex, which are cut there.
    pub(crate) parted: u64,
    pub(crate) apex: [f64; 2],
    /// Those that are cut at other slopes, by rule 1.
    pub(crate) cut: u64,
    pub(crate) slopes: &'a [CacheLine; ROOM / CacheLine::LANES],
    /// The exit: its start, and the way to its end.
    pub(crate) start: [f64; 2],
    pub(crate) along: [f64; 2],
    pub(crate) length: f64,
    /// Upper bounds of useful paths at the start and at the end, that at the end with the length.
    pub(crate) reach: [f64; 2],
    /// The heights at which the part is bounded.
    pub(crate) heights: [f64; 2],
}

/// Rows that are read and kept, in place or elsewhere.
pub(crate) trait KeptRows {
    fn registers<L: Lanes>(&self) -> usize;
    fn load<L: Lanes>(&self, simd: L::Token, register: usize) -> [L; COLUMNS];
    /// Keeps the rows of `register` that `mask` chooses; `changed` tells whether they have changed.
    fn keep<L: Lanes>(&mut self, register: usize, mask: L::Mask, rows: [L; COLUMNS], changed: bool);
}

impl KeptRows for InPlace<'_, COLUMNS> {
    #[inline(always)]
    fn registers<L: Lanes>(&self) -> usize {
        self.registers::<L>()
    }

    #[inline(always)]
    fn load<L: Lanes>(&self, simd: L::Token, register: usize) -> [L; COLUMNS] {
        self.load::<L>(simd, register)
    }

    #[inline(always)]
    fn keep<L: Lanes>(
        &mut self,
        register: usize,
        mask: L::Mask,
        rows: [L; COLUMNS],
        changed: bool,
    ) {
        if changed {
            self.keep::<L>(mask, rows);
        } else {
            self.keep_unchanged::<L>(register, mask, rows);
        }
    }
}

impl KeptRows for (Columns<'_>, Sink<'_, COLUMNS>) {
    #[inline(always)]
    fn registers<L: Lanes>(&self) -> usize {
        self.0.registers::<L>()
    }

    #[inline(always)]
    fn load<L: Lanes>(&self, simd: L::Token, register: usize) -> [L; COLUMNS] {
        self.0.load::<L>(simd, register)
    }

    #[inline(always)]
    fn keep<L: Lanes>(&mut self, _: usize, mask: L::Mask, rows: [L; COLUMNS], _: bool) {
        self.1.add::<L>(mask, rows);
    }
}

/// Cuts the windows of a part at the apex, on their right if they go to the left, and keeps those
/// that no path along the exit from one of its ends beats (the vertex filter). Returns the lines
/// that bound them.
#[inline(always)]
pub(crate) fn leave<L: Lanes>(
    simd: L::Token,
    rows: &mut impl KeptRows,
    part: &ChunkPart<'_>,
) -> Bounds {
    let (zero, one) = (L::splat(simd, 0.0), L::splat(simd, 1.0));
    let (cx, cy) = (L::splat(simd, part.apex[0]), L::splat(simd, part.apex[1]));
    let (ax, ay) = (L::splat(simd, part.start[0]), L::splat(simd, part.start[1]));
    let (dx, dy) = (L::splat(simd, part.along[0]), L::splat(simd, part.along[1]));
    let (from_start, from_end) = (L::splat(simd, part.reach[0]), L::splat(simd, part.reach[1]));
    let length = L::splat(simd, part.length);
    let slopes = Columns1::new(part.slopes, (ROOM / CacheLine::LANES) as u32, ROOM);
    let mut outermost = Outermost::<L>::new(simd, part.heights);
    for register in 0..rows.registers::<L>() {
        let chosen = lanes_of::<L>(simd, part.chosen, register);
        if !chosen.any() {
            continue;
        }
        let [px, py, sigma, mut left, mut right] = rows.load::<L>(simd, register);
        let parted = chosen & lanes_of::<L>(simd, part.parted, register);
        if parted.any() {
            let [other] = slopes.load::<L>(simd, register);
            let cut = lanes_of::<L>(simd, part.cut, register);
            let slope = L::select(cut, other, (cx - px) / (cy - py));
            if part.left {
                right = L::select(parted, slope, right);
            } else {
                left = L::select(parted, slope, left);
            }
        }
        // Where the outer rays meet the exit. One that never does passes its end.
        let (x, y) = (px - ax, py - ay);
        let (d0, d1) = (dx - left * dy, dx - right * dy);
        let t0 = L::select(zero.lt(d0), (x - left * y) / d0, zero);
        let t1 = L::select(zero.lt(d1), (x - right * y) / d1, one);
        let (t0, t1) = (t0.max(zero).min(one), t1.max(zero).min(one));
        let (x0, y0) = (t0 * dx - x, t0 * dy - y);
        let (x1, y1) = (t1 * dx - x, t1 * dy - y);
        let from_end = from_end - sigma - t0 * length;
        let from_start = from_start - sigma + t1 * length;
        let kept = chosen
            & t0.lt(t1)
            & zero.le(from_end.min(from_start))
            & (x0 * x0 + y0 * y0).le(from_end * from_end)
            & (x1 * x1 + y1 * y1).le(from_start * from_start);
        outermost.add(simd, kept, [px, py, left, right]);
        rows.keep::<L>(register, kept, [px, py, sigma, left, right], parted.any());
    }
    outermost.bounds(part.heights)
}

/// A column.
type Columns1<'a> = geobench_window::simd::Columns<'a, 1>;

/// Appends `windows` to those of another chunk, turned by the vector `turn` and moved to `place`.
/// Returns the lines that bound them, or `None` if some of them are too steep there.
#[inline(always)]
pub(crate) fn turn_rows<L: Lanes>(
    simd: L::Token,
    windows: Columns<'_>,
    to: &mut Sink<'_, COLUMNS>,
    turn: [f64; 2],
    place: [f64; 2],
    heights: Option<[f64; 2]>,
) -> Option<Bounds> {
    let (c, s) = (L::splat(simd, turn[0]), L::splat(simd, turn[1]));
    let (x0, y0) = (L::splat(simd, place[0]), L::splat(simd, place[1]));
    let steepest = L::splat(simd, STEEPEST);
    let heights = heights.unwrap_or_default();
    let mut outermost = Outermost::<L>::new(simd, heights);
    for register in 0..windows.registers::<L>() {
        let [px, py, sigma, left, right] = windows.load::<L>(simd, register);
        let listed = windows.listed::<L>(simd, register);
        let (up0, up1) = (s * left + c, s * right + c);
        let (along0, along1) = (c * left - s, c * right - s);
        let flat = along0.abs().le(steepest * up0) & along1.abs().le(steepest * up1);
        if (listed & !flat).any() {
            return None;
        }
        let rows = [
            c * px - s * py + x0,
            s * px + c * py + y0,
            sigma,
            along0 / up0,
            along1 / up1,
        ];
        outermost.add(simd, listed, [rows[0], rows[1], rows[3], rows[4]]);
        to.add::<L>(listed, rows);
    }
    Some(outermost.bounds(heights))
}
