//! The sites of a face as a table stored by columns, so that vector instructions compute several
//! path lengths at once. Every instruction set rounds as [`Site::path`] does.

// Generic code must be inlined into the functions that are compiled for an instruction set.
#![allow(clippy::inline_always)]

use geobench_window::simd::{
    Block, CacheLine, Columns, Instructions, LaneMask, Lanes, Simd, SimdProgram,
};

use super::sites::{BENT, FROM_VERTEX, FaceSites, NearestSite, NearestSites, Site};
use geobench_mesh::vector::{Point, between, sub};

/// Number of columns of a table: image (0, 1), σ (2), left end of the gate (3, 4) and length of the
/// path to it (5), right end (6, 7) and length of the path to it (8), number of the source (9),
/// handicap of straight paths as a fraction of their length (10), number of the site (11).
const WIDTH: usize = 12;

/// Sites as rows of a table that is stored by columns.
#[derive(Clone, Debug, Default)]
pub(crate) struct SiteTable {
    lines: Vec<CacheLine>,
    /// Number of lines of each column.
    column: u32,
    len: usize,
}

impl SiteTable {
    /// An empty table with room for `len` rows.
    fn with_room(len: usize) -> Self {
        let column = len.div_ceil(CacheLine::LANES);
        Self {
            lines: vec![CacheLine::default(); WIDTH * column],
            column: column as u32,
            len: 0,
        }
    }

    /// The table of all `sites`.
    fn of(sites: &[Site]) -> Self {
        let mut table = Self::with_room(sites.len());
        let column = table.column as usize;
        for (i, site) in sites.iter().enumerate() {
            let row = row_of(i, site);
            for (k, x) in row.into_iter().enumerate() {
                table.lines[k * column + i / CacheLine::LANES].0[i % CacheLine::LANES] = x;
            }
        }
        table.len = sites.len();
        table
    }

    #[inline(always)]
    fn columns(&self) -> Columns<'_, WIDTH> {
        Columns::new(&self.lines, self.column, self.len)
    }
}

/// The row of a site. Without a gate, both ends of the gate are at the image. Then no path counts
/// as bent.
fn row_of(number: usize, site: &Site) -> [f64; WIDTH] {
    let [left, right] = site.gate.unwrap_or([site.image; 2]);
    let [to_left, to_right] = site.to_gate;
    let handicap = if site.gate.is_none() {
        FROM_VERTEX
    } else {
        0.0
    };
    [
        site.image[0],
        site.image[1],
        site.sigma,
        left[0],
        left[1],
        to_left,
        right[0],
        right[1],
        to_right,
        f64::from(site.source),
        handicap,
        number as f64,
    ]
}

/// The sites of a face as a table, with the vector instructions that compute path lengths.
#[derive(Clone, Debug)]
pub(crate) struct MeasuredSites<'a> {
    sites: &'a [Site],
    /// The longest side of the face.
    size: f64,
    simd: Simd,
    all: SiteTable,
}

impl<'a> MeasuredSites<'a> {
    pub(crate) fn new(face: &'a FaceSites) -> Self {
        let sites = &face.sites;
        Self {
            sites,
            size: face.size,
            simd: Simd::new(Instructions::detect()),
            all: SiteTable::of(sites),
        }
    }

    /// The length of the shortest of all paths to `x`.
    pub(crate) fn distance(&self, x: Point) -> f64 {
        self.least(&self.all, x)
    }

    /// An empty table for [`near_chord`](Self::near_chord).
    pub(crate) fn room(&self) -> SiteTable {
        SiteTable::with_room(self.all.len)
    }

    /// The length of the shortest path to `x` from the sites of `table`.
    pub(crate) fn least(&self, table: &SiteTable, x: Point) -> f64 {
        self.simd.run(LeastSite {
            columns: table.columns(),
            x,
        })
    }

    /// The length of the shortest path to `x`, and the shortest path of each of `sources`.
    ///
    /// Among equally long paths of a source, a straight path through a gate is preferred to one
    /// from a vertex of the face, and that one to a bent path. A window that ends at a vertex has
    /// bent paths through the vertex. The bisector of these paths is that of the vertex, not that
    /// of the window.
    pub(crate) fn nearest<const N: usize>(&self, sources: [u32; N], x: Point) -> NearestSites<N> {
        self.nearest_in(&self.all, sources, x)
    }

    /// The same among the sites of `table`.
    pub(crate) fn nearest_in<const N: usize>(
        &self,
        table: &SiteTable,
        sources: [u32; N],
        x: Point,
    ) -> NearestSites<N> {
        let (least, numbers) = self.simd.run(NearestOf {
            columns: table.columns(),
            sources,
            size: self.size,
            x,
        });
        let each = numbers.map(|site| match self.sites.get(site) {
            Some(found) => NearestSite::of(site, found.path(x)),
            None => NearestSite::NONE,
        });
        NearestSites { least, each }
    }

    /// Puts into `near` the sites that may have the shortest path to a point within `beside` of the
    /// chord between `ends`; site number `of` is one of them. `rounding` gives the error of a
    /// length.
    ///
    /// Lengths are convex functions of the point. On the chord, the length of `of` is at most the
    /// linear interpolation of its lengths at both ends. Any other length is at least its tangent
    /// at the midpoint.
    pub(crate) fn near_chord(
        &self,
        of: usize,
        [from, to]: [Point; 2],
        beside: f64,
        rounding: impl Fn(f64) -> f64,
        near: &mut SiteTable,
    ) {
        let middle = between(from, to, 0.5);
        let most = [from, to].map(|x| {
            let length = self.sites[of].path(x).length;
            // Off the chord, each of the two lengths changes by at most `beside`.
            length + 2.0 * beside + 2.0 * rounding(length)
        });
        near.len = self.simd.run(NearChord {
            columns: self.all.columns(),
            middle,
            half: sub(to, middle),
            most,
            near: Block::new(&mut near.lines, near.column),
        });
    }
}

/// The paths from the sites of a register to a point.
struct PathLanes<L: Lanes> {
    lengths: L,
    /// The last straight pieces of the paths, as vectors, and their lengths.
    last_pieces: [L; 2],
    last: L,
    is_bent: L::Mask,
}

/// See [`Site::path`].
#[inline(always)]
fn paths<L: Lanes>(simd: L::Token, row: &[L; WIDTH], x: [L; 2]) -> PathLanes<L> {
    let zero = L::splat(simd, 0.0);
    let cross = |a: [L; 2], b: [L; 2]| a[0] * b[1] - a[1] * b[0];
    let ray = [x[0] - row[0], x[1] - row[1]];
    let left = cross([row[3] - row[0], row[4] - row[1]], ray);
    let right = cross([row[6] - row[0], row[7] - row[1]], ray);
    let (is_left, is_right) = (zero.lt(left), right.lt(zero));
    let choose =
        |image: L, left: L, right: L| L::select(is_left, left, L::select(is_right, right, image));
    let turn = [
        choose(row[0], row[3], row[6]),
        choose(row[1], row[4], row[7]),
    ];
    let before = choose(row[2], row[5], row[8]);
    let last_pieces = [x[0] - turn[0], x[1] - turn[1]];
    let last = (last_pieces[0] * last_pieces[0] + last_pieces[1] * last_pieces[1]).sqrt();
    PathLanes {
        lengths: before + last,
        last_pieces,
        last,
        is_bent: is_left | is_right,
    }
}

/// See [`MeasuredSites::least`].
struct LeastSite<'a> {
    columns: Columns<'a, WIDTH>,
    x: Point,
}

impl SimdProgram for LeastSite<'_> {
    type Output = f64;

    #[inline(always)]
    fn run<L: Lanes>(self, simd: L::Token) -> f64 {
        let x = self.x.map(|c| L::splat(simd, c));
        let infinite = L::splat(simd, f64::INFINITY);
        let mut least = infinite;
        for register in 0..self.columns.registers::<L>() {
            let row = self.columns.load::<L>(simd, register);
            let listed = self.columns.listed::<L>(simd, register);
            let lengths = L::select(listed, paths(simd, &row, x).lengths, infinite);
            least = lengths.min(least);
        }
        least.least()
    }
}

/// See [`MeasuredSites::nearest`].
struct NearestOf<'a, const N: usize> {
    columns: Columns<'a, WIDTH>,
    sources: [u32; N],
    size: f64,
    x: Point,
}

impl<const N: usize> SimdProgram for NearestOf<'_, N> {
    type Output = (f64, [usize; N]);

    #[inline(always)]
    #[allow(clippy::cast_sign_loss)] // Numbers are not negative.
    fn run<L: Lanes>(self, simd: L::Token) -> Self::Output {
        let x = self.x.map(|c| L::splat(simd, c));
        let infinite = L::splat(simd, f64::INFINITY);
        let [bent, size] = [BENT, self.size].map(|x| L::splat(simd, x));
        let sources = self.sources.map(|source| L::splat(simd, f64::from(source)));
        let mut least = infinite;
        let mut best = [infinite; N];
        let mut places = [infinite; N];
        for register in 0..self.columns.registers::<L>() {
            let row = self.columns.load::<L>(simd, register);
            let listed = self.columns.listed::<L>(simd, register);
            let found = paths(simd, &row, x);
            let lengths = L::select(listed, found.lengths, infinite);
            least = lengths.min(least);
            let handicap = L::select(found.is_bent, bent * (lengths + size), row[10] * lengths);
            let ranked = lengths + handicap;
            for k in 0..N {
                let is_its = row[9].le(sources[k]) & sources[k].le(row[9]);
                let is_better = ranked.lt(best[k]) & is_its;
                best[k] = L::select(is_better, ranked, best[k]);
                places[k] = L::select(is_better, row[11], places[k]);
            }
        }
        let mut numbers = [usize::MAX; N];
        for k in 0..N {
            let shortest = L::splat(simd, best[k].least());
            // The first of several sites with equal ranks.
            let first = L::select(best[k].le(shortest), places[k], infinite).least();
            if first < f64::INFINITY {
                numbers[k] = first as usize;
            }
        }
        (least.least(), numbers)
    }
}

/// See [`MeasuredSites::near_chord`].
struct NearChord<'a> {
    columns: Columns<'a, WIDTH>,
    middle: Point,
    half: Point,
    most: [f64; 2],
    near: Block<'a, WIDTH>,
}

impl SimdProgram for NearChord<'_> {
    type Output = usize;

    #[inline(always)]
    fn run<L: Lanes>(mut self, simd: L::Token) -> usize {
        let [middle, half] = [self.middle, self.half].map(|p| p.map(|c| L::splat(simd, c)));
        let most = self.most.map(|length| L::splat(simd, length));
        let zero = L::splat(simd, 0.0);
        let mut near = self.near.append(0);
        for register in 0..self.columns.registers::<L>() {
            let row = self.columns.load::<L>(simd, register);
            let listed = self.columns.listed::<L>(simd, register);
            let found = paths(simd, &row, middle);
            let along = found.last_pieces[0] * half[0] + found.last_pieces[1] * half[1];
            let change = L::select(zero.lt(found.last), along / found.last, zero);
            let is_near =
                (found.lengths - change).le(most[0]) | (found.lengths + change).le(most[1]);
            let chosen = is_near & listed;
            // Most registers hold no near site.
            if chosen.any() {
                near.add::<L>(chosen, row);
            }
        }
        near.len()
    }
}
