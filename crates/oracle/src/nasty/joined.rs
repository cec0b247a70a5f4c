//! Kinds of meshes whose edges have any number of faces, or that have one side only.

use std::collections::{HashMap, HashSet};
use std::f64::consts::{PI, TAU};

use super::draft::Draft;
use super::kinds::{on_circle, unit_plate};
use crate::random::Random;

/// Turns over random faces: at an edge of many faces no orientation is better than another.
fn turn_over(draft: &mut Draft, random: &mut Random) {
    let one_in = [1, 2, 1000][random.below(3) as usize];
    for face in &mut draft.faces {
        if random.below(one_in) == 0 {
            face.swap(1, 2);
        }
    }
}

fn quad([a, b, c, d]: [u32; 4], random: &mut Random) -> [[u32; 3]; 2] {
    if random.coin() {
        [[a, b, c], [a, c, d]]
    } else {
        [[a, b, d], [b, c, d]]
    }
}

/// Sheets on a common line of edges, with holes that leave channels, each bent and moved along the
/// line a little.
pub(super) fn book(random: &mut Random) -> Draft {
    let (sheets, rows) = (random.whole(3, 5), random.whole(1, 4));
    let even = random.coin();
    let mut draft = Draft::default();
    let mut z = 0.0;
    for _ in 0..=rows {
        draft.positions.push([0.0, 0.0, z]);
        z += if even { 1.0 } else { random.between(0.2, 2.0) };
    }
    for sheet in 0..sheets {
        let columns = random.whole(1, 3);
        let turn = f64::from(sheet) / f64::from(sheets);
        let bend = if random.coin() {
            0.0
        } else {
            random.between(-0.2, 0.2)
        };
        let noise = if even { 0.0 } else { 0.2 };
        let step = if even { 1.0 } else { random.between(0.3, 2.0) };
        let mut before: Vec<u32> = (0..=rows).collect();
        for column in 1..=columns {
            let out = f64::from(column);
            let ring: Vec<u32> = (0..=rows)
                .map(|row| {
                    let z = draft.positions[row as usize][2] + random.between(-noise, noise);
                    draft.add(on_circle(turn + bend * out, step * out, z))
                })
                .collect();
            for row in 0..rows as usize {
                let corners = [before[row], ring[row], ring[row + 1], before[row + 1]];
                let faces = quad(corners, random);
                let keeps = random.below(6);
                draft.faces.extend(match keeps {
                    0 => &faces[..0],
                    1 => &faces[..1],
                    _ => &faces[..],
                });
            }
            before = ring;
        }
    }
    turn_over(&mut draft, random);
    draft
}

/// Lenses in a row: sheets between edges, which are as long as each other or nearly so.
pub(super) fn lenses(random: &mut Random) -> Draft {
    let (count, sheets) = (random.whole(2, 6), random.whole(2, 3));
    let apart = match random.below(3) {
        0 => 0.0,
        1 => random.magnitude(-15, -6),
        _ => random.between(0.0, 0.5),
    };
    let bulge = random.between(0.1, 1.0);
    let mut draft = Draft::default();
    for i in 0..=count {
        let x = 2.0 * f64::from(i) + random.between(-0.3, 0.3);
        draft.positions.push([x, random.between(-0.2, 0.2), 0.0]);
        draft
            .positions
            .push([x, 1.0 + random.between(-0.2, 0.2), 0.0]);
    }
    for i in 0..count {
        let [a, b, c, d] = [0, 1, 2, 3].map(|k| 2 * i + k);
        for sheet in 0..sheets {
            // A flat sheet of each kind, and others whose middle line is raised.
            let (sin, cos) = (TAU * f64::from(sheet) / f64::from(sheets)).sin_cos();
            let by = bulge * (1.0 + random.between(-apart, apart));
            let raised = |draft: &Draft, p: u32, q: u32| {
                let [x, y, z] = draft.between(p, q, 0.5);
                [x, y + by * sin, z + by * cos]
            };
            let [low, high] = [(a, c), (b, d)].map(|(p, q)| raised(&draft, p, q));
            let [low, high] = [draft.add(low), draft.add(high)];
            draft.faces.extend(quad([a, low, high, b], random));
            draft.faces.extend(quad([low, c, d, high], random));
        }
    }
    turn_over(&mut draft, random);
    draft
}

/// The vertices of a grid in space, numbered as they are used.
#[derive(Default)]
struct SheetLattice {
    numbers: HashMap<[u32; 3], u32>,
}

impl SheetLattice {
    fn at(&mut self, draft: &mut Draft, place: [u32; 3]) -> u32 {
        *(self.numbers.entry(place)).or_insert_with(|| draft.add(place.map(f64::from)))
    }

    /// The unit square across `axis` whose least corner is `at`.
    fn square(&mut self, draft: &mut Draft, at: [u32; 3], axis: usize, random: &mut Random) {
        let corner = |du: u32, dv: u32| {
            let mut place = at;
            place[(axis + 1) % 3] += du;
            place[(axis + 2) % 3] += dv;
            place
        };
        let corners = [(0, 0), (1, 0), (1, 1), (0, 1)];
        let corners = corners.map(|(du, dv)| self.at(draft, corner(du, dv)));
        draft.faces.extend(quad(corners, random));
    }
}

/// Moves the vertices a little, or not at all.
fn disturb(draft: &mut Draft, random: &mut Random) {
    if random.coin() {
        let noise = random.between(0.0, 0.4);
        draft.place(|p| p.map(|x| x + random.between(-noise, noise)));
    }
}

/// Cubes that touch along edges and at vertices.
pub(super) fn touching(random: &mut Random) -> Draft {
    let size = [0; 3].map(|_| random.whole(1, 3));
    let filled: HashSet<[i64; 3]> = {
        let one_in = random.whole(2, 3);
        let cells = (0..size.iter().product::<u32>())
            .map(|i| [i % size[0], i / size[0] % size[1], i / (size[0] * size[1])].map(i64::from));
        cells.filter(|_| random.below(one_in) == 0).collect()
    };
    let mut draft = Draft::default();
    let mut lattice = SheetLattice::default();
    let mut all: Vec<[i64; 3]> = filled.iter().copied().collect();
    all.sort_unstable();
    if all.is_empty() {
        all.push([0; 3]);
    }
    for cell in all {
        for axis in 0..3 {
            for side in [0, 1] {
                let mut beyond = cell;
                beyond[axis] += 2 * side - 1;
                if filled.contains(&beyond) {
                    continue;
                }
                let mut at = cell;
                at[axis] += side;
                let at = at.map(|x| u32::try_from(x).unwrap_or_default());
                lattice.square(&mut draft, at, axis, random);
            }
        }
    }
    disturb(&mut draft, random);
    turn_over(&mut draft, random);
    draft
}

/// Some squares of a grid in space, of which up to four meet at an edge.
pub(super) fn membranes(random: &mut Random) -> Draft {
    let size = [0; 3].map(|_| random.whole(1, 2));
    let one_in = random.whole(2, 5);
    let mut draft = Draft::default();
    let mut lattice = SheetLattice::default();
    for axis in 0..3 {
        for x in 0..=size[0] {
            for y in 0..=size[1] {
                for z in 0..=size[2] {
                    let at = [x, y, z];
                    let inside = |k: usize| at[(axis + k) % 3] < size[(axis + k) % 3];
                    if inside(1) && inside(2) && random.below(one_in) > 0 {
                        lattice.square(&mut draft, at, axis, random);
                    }
                }
            }
        }
    }
    if draft.faces.is_empty() {
        lattice.square(&mut draft, [0; 3], 0, random);
    }
    disturb(&mut draft, random);
    turn_over(&mut draft, random);
    draft
}

/// Plates that stand on a line of edges of another.
pub(super) fn tee(random: &mut Random) -> Draft {
    let [columns, rows] = [0; 2].map(|_| random.whole(2, 4));
    let mut draft = unit_plate(columns, rows, random);
    for _ in 0..random.whole(1, 2) {
        let line = random.below(rows + 1);
        let height = random.between(-2.0, 2.0);
        let lean = random.between(-1.0, 1.0);
        let first = random.below(columns);
        let foot: Vec<u32> = (first..=columns)
            .map(|i| line * (columns + 1) + i)
            .collect();
        let top: Vec<u32> = foot
            .iter()
            .map(|&v| {
                let [x, y, z] = draft.positions[v as usize];
                draft.add([x, y + lean, z + height])
            })
            .collect();
        for (below, above) in foot.windows(2).zip(top.windows(2)) {
            draft
                .faces
                .extend(quad([below[0], below[1], above[1], above[0]], random));
        }
    }
    disturb(&mut draft, random);
    turn_over(&mut draft, random);
    draft
}

/// A strip with its ends joined after some half turns, alone or with a sheet across.
pub(super) fn band(random: &mut Random) -> Draft {
    let (count, turns) = (random.whole(4, 14), random.whole(1, 3));
    let width = random.between(0.2, 1.5);
    let mut draft = Draft::default();
    for i in 0..count {
        let part = f64::from(i) / f64::from(count);
        let (sin, cos) = (PI * f64::from(turns) * part).sin_cos();
        for side in [-width, width] {
            draft
                .positions
                .push(on_circle(part, 2.0 + side * cos, side * sin));
        }
    }
    for i in 0..count {
        let [a, b] = [2 * i, 2 * i + 1];
        let [mut c, mut d] = [2 * i + 2, 2 * i + 3];
        if i + 1 == count {
            [c, d] = if turns % 2 == 0 { [0, 1] } else { [1, 0] };
        }
        draft.faces.extend(quad([a, c, d, b], random));
    }
    if random.coin() {
        let [i, j] = [0; 2].map(|_| random.below(count));
        if (i + 1) % count != j && (j + 1) % count != i && i != j {
            let corners = [2 * i, 2 * j, 2 * j + 1, 2 * i + 1];
            draft.faces.extend(quad(corners, random));
        }
    }
    disturb(&mut draft, random);
    turn_over(&mut draft, random);
    draft
}

/// A rectangle with opposite sides joined: a torus, a Klein bottle or a projective plane without
/// two points.
pub(super) fn rolled(random: &mut Random) -> Draft {
    let [columns, rows] = [0; 2].map(|_| random.whole(3, 6));
    let [turned_up, turned_across] = [0; 2].map(|_| random.coin());
    let at = |i: u32, j: u32| {
        let i = if j == rows && turned_up {
            2 * columns - i
        } else {
            i
        };
        let j = if i >= columns && i < 2 * columns && turned_across && !turned_up {
            rows + rows - j
        } else {
            j
        };
        j % rows * columns + i % columns
    };
    let noise = random.between(0.0, 0.5);
    let mut draft = Draft::default();
    for j in 0..rows {
        for i in 0..columns {
            let ring = on_circle(f64::from(i) / f64::from(columns), 1.0, 0.0);
            let (sin, cos) = (TAU * f64::from(j) / f64::from(rows)).sin_cos();
            let out = 3.0 + ring[0];
            let place = [out * cos, out * sin, ring[1]];
            draft
                .positions
                .push(place.map(|x| x + random.between(-noise, noise)));
        }
    }
    for j in 0..rows {
        for i in 0..columns {
            let corners = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
            let faces = quad(corners, random);
            let differ = |[a, b, c]: &[u32; 3]| a != b && b != c && c != a;
            draft.faces.extend(faces.iter().filter(|face| differ(face)));
        }
    }
    turn_over(&mut draft, random);
    draft
}

/// Random triangles on few vertices.
pub(super) fn heap(random: &mut Random) -> Draft {
    let vertices = random.whole(4, 9);
    let flat = random.below(4) == 0;
    let whole = random.coin();
    let mut draft = Draft::default();
    for _ in 0..vertices {
        let [x, y, z] = [0; 3].map(|_| random.between(-3.0, 3.0));
        let place = [x, y, if flat { 0.0 } else { z }];
        draft.add(if whole { place.map(f64::round) } else { place });
    }
    let mut known = HashSet::new();
    for _ in 0..random.whole(3, 18) {
        let face = [0; 3].map(|_| random.below(vertices));
        let mut sorted = face;
        sorted.sort_unstable();
        if sorted[0] < sorted[1] && sorted[1] < sorted[2] && known.insert(sorted) {
            draft.faces.push(face);
        }
    }
    if draft.faces.is_empty() {
        draft.faces.push([0, 1, 2]);
    }
    draft
}

/// A mesh of another kind of which some edges are made one with others, far from each other.
pub(super) fn sewn(random: &mut Random) -> Draft {
    let [columns, rows] = [0; 2].map(|_| random.whole(2, 5));
    let mut draft = unit_plate(columns, rows, random);
    draft.place(|[x, y, _]| [x, y, random.between(0.0, 1.0)]);
    for _ in 0..random.whole(1, 3) {
        let [(_, [a, b, _]), (_, [c, d, _])] = [0; 2].map(|_| draft.random_side(random));
        for face in &mut draft.faces {
            *face = face.map(|v| if v == c { a } else { v });
            *face = face.map(|v| if v == d { b } else { v });
        }
        let differ = |[a, b, c]: &[u32; 3]| a != b && b != c && c != a;
        if draft.faces.iter().any(differ) {
            draft.faces.retain(differ);
        }
    }
    draft
}
