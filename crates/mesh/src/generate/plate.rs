//! Flat models: the grid, the plate with holes, the strip of needles.

use super::keys::{Key, Params};
use crate::random::SplitMix64;
use crate::soup::TriangleSoup;

/// Largest number of cells along one side.
pub(super) const MAX_SIDE: u64 = 25_000_000;

const DIAGONAL: Key = Key {
    name: "diagonal",
    kind: super::Kind::Choice(&["one", "alternating"]),
    summary: "whether all cells are cut along the same diagonal, or neighbours along opposite ones",
};
// A corner of a right triangle with legs of length 1 cannot cross the opposite side if all corners
// move by less than 1/4 along each axis.
const JITTER: Key = Key::real(
    "jitter",
    0.0,
    [0.0, 0.24],
    "random shift of inner vertices within the plane, in cells",
);

pub(super) const GRID_KEYS: &[Key] = &[
    Key {
        name: "n",
        kind: super::Kind::All(&["nx", "ny"]),
        summary: "cells along both sides",
    },
    Key::whole("nx", 40, [1, MAX_SIDE], "cells of size 1 along x"),
    Key::whole("ny", 40, [1, MAX_SIDE], "cells of size 1 along y"),
    DIAGONAL,
    JITTER,
];

pub(super) const HOLES_KEYS: &[Key] = &[
    Key::whole("holes", 4, [1, 5_000], "holes along each side"),
    // Cells in holes cost time as well, so no plate may be mostly holes.
    Key::whole("width", 6, [1, 64], "cells of size 1 across a hole along x"),
    Key::whole(
        "height",
        3,
        [1, 64],
        "cells of size 1 across a hole along y",
    ),
    Key::whole("wall", 5, [1, 5_000], "cells between holes and around them"),
    DIAGONAL,
    JITTER,
];

pub(super) const STRIP_KEYS: &[Key] = &[
    Key::whole("n", 3_000, [1, super::MAX_FACES], "needles"),
    Key::real(
        "aspect",
        100.0,
        [0.5, 1e9],
        "height of a needle over its base; its tip spans 1/aspect radians",
    ),
];

pub(super) fn grid_faces(params: &Params<'_>) -> u64 {
    2 * params.whole("nx") * params.whole("ny")
}

/// A rectangle of unit cells with a corner at the origin; vertices are numbered row by row.
pub(super) fn grid(params: &Params<'_>) -> TriangleSoup {
    plate(params, params.count("nx"), params.count("ny"), |_, _| true)
}

pub(super) fn holes_faces(params: &Params<'_>) -> u64 {
    let [nx, ny] = holed_sides(params);
    let holes = params.whole("holes");
    // At most 5,000 × 10,000 cells a side, which cannot overflow.
    2 * (nx * ny - holes * holes * params.whole("width") * params.whole("height"))
}

fn holed_sides(params: &Params<'_>) -> [u64; 2] {
    let (holes, wall) = (params.whole("holes"), params.whole("wall"));
    ["width", "height"].map(|key| holes * (params.whole(key) + wall) + wall)
}

/// A plate of unit cells with rows of equal rectangular holes. The corners of the holes have
/// integer coordinates even with jitter, so a visibility graph gives the distances.
pub(super) fn holes(params: &Params<'_>) -> TriangleSoup {
    let [nx, ny] = holed_sides(params).map(|n| n as usize);
    let [width, height, wall] = ["width", "height", "wall"].map(|key| params.count(key));
    let in_wall = |cell: usize, hole: usize| cell % (hole + wall) < wall;
    plate(params, nx, ny, |x, y| {
        in_wall(x, width) || in_wall(y, height)
    })
}

/// The cells of an `nx` by `ny` rectangle that `keep` accepts, each cut into two triangles.
/// Vertices of no accepted cell are left out.
fn plate(
    params: &Params<'_>,
    nx: usize,
    ny: usize,
    keep: impl Fn(usize, usize) -> bool,
) -> TriangleSoup {
    let alternating = params.is("diagonal", "alternating");
    let jitter = params.real("jitter");
    let mut random = SplitMix64::for_use(params.seed, 1);
    // Numbers below 0 wrap to numbers beyond the rectangle, which are not accepted either.
    let kept = |x: usize, y: usize| x < nx && y < ny && keep(x, y);
    let mut soup = TriangleSoup::default();
    // Stores the vertices of two rows at a time, however many lie in holes.
    let (mut below, mut row) = (vec![0; nx + 1], vec![0; nx + 1]);
    for y in 0..=ny {
        std::mem::swap(&mut below, &mut row);
        let y_below = y.wrapping_sub(1);
        for (x, number) in row.iter_mut().enumerate() {
            let x_before = x.wrapping_sub(1);
            let cells = [(x_before, y_below), (x, y_below), (x_before, y), (x, y)];
            let around = cells.into_iter().filter(|&(x, y)| kept(x, y)).count();
            if around == 0 {
                continue;
            }
            *number = soup.positions.len() as u32;
            let mut position = [x as f64, y as f64, 0.0];
            if around == 4 && jitter > 0.0 {
                position[0] += jitter * random.signed();
                position[1] += jitter * random.signed();
            }
            soup.positions.push(position);
        }
        for x in (0..nx).filter(|&x| kept(x, y_below)) {
            let [a, b, c, d] = [below[x], below[x + 1], row[x + 1], row[x]];
            let rising = !alternating || (x + y_below).is_multiple_of(2);
            soup.triangles.extend(cut([a, b, c, d], rising));
        }
    }
    soup
}

/// A cell with these corners, counter-clockwise, cut from the first to the third if `rising`, else
/// from the second to the fourth.
pub(super) const fn cut([a, b, c, d]: [u32; 4], rising: bool) -> [[u32; 3]; 2] {
    if rising {
        [[a, b, c], [a, c, d]]
    } else {
        [[a, b, d], [b, c, d]]
    }
}

pub(super) fn strip_faces(params: &Params<'_>) -> u64 {
    params.whole("n")
}

/// Isosceles needles of height 1 side by side, with alternating tips; vertices zigzag along x.
pub(super) fn strip(params: &Params<'_>) -> TriangleSoup {
    let n = params.whole("n") as u32;
    let aspect = params.real("aspect");
    let positions = (0..n + 2)
        .map(|i| [f64::from(i) / (2.0 * aspect), f64::from(i % 2), 0.0])
        .collect();
    let triangles = (0..n)
        .map(|i| {
            if i % 2 == 0 {
                [i, i + 2, i + 1]
            } else {
                [i, i + 1, i + 2]
            }
        })
        .collect();
    TriangleSoup::new(positions, triangles)
}
