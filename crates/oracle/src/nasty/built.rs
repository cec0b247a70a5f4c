//! Meshes built against assumptions of algorithms: long chains of pseudo-sources, near ties that
//! add up, extreme ratios of lengths, high degrees. Each function takes the number of faces.

// Casts of positive numbers.
#![allow(clippy::cast_sign_loss)]

use super::draft::Draft;
use super::kinds::{on_circle, rings, unit_plate};
use super::polygon::triangulate;
use crate::random::Random;
use crate::zoo;

/// The part of a distance below which the algorithms take two paths for equally long, and the part
/// of the size of a face.
const TIES: [f64; 2] = [1e-13, 8e-15];

/// A sheet of a cell from vertex `from` to vertex `to`, both on the x axis.
struct Sheet {
    /// Pairs of vertices on both sides of the axis.
    rows: Vec<[u32; 2]>,
}

impl Sheet {
    /// Adds the faces and all vertices but the ends. Halfway, the sheet is `height` above the axis.
    fn add(draft: &mut Draft, [from, to]: [u32; 2], count: u32, width: f64, height: f64) -> Self {
        let [start, end] = [from, to].map(|v| draft.positions[v as usize]);
        let rows: Vec<[u32; 2]> = (1..=count)
            .map(|row| {
                let part = f64::from(row) / f64::from(count + 1);
                let x = start[0] + part * (end[0] - start[0]);
                let z = height * (2.0 * part).min(2.0 - 2.0 * part);
                [width, -width].map(|y| draft.add([x, start[1] + y, start[2] + z]))
            })
            .collect();
        let [p, q] = rows[rows.len() - 1];
        let [r, s] = rows[0];
        draft.faces.push([from, s, r]);
        for pair in rows.windows(2) {
            let ([r, s], [p, q]) = (pair[0], pair[1]);
            draft.faces.extend([[r, s, q], [r, q, p]]);
        }
        draft.faces.push([to, p, q]);
        Self { rows }
    }
}

/// Cells along the x axis and the sheets of each. The distance from vertex 0 to the last vertex is
/// the difference of their x, if one sheet of each cell is flat.
fn cells(faces: u32, random: &mut Random) -> (Draft, Vec<(u32, [Sheet; 2])>) {
    let rows = random.whole(2, 5);
    let count = (faces / (2 + 2 * rows)).max(2);
    // Near ties in relation to the distance add up over many cells behind one long face. Those in
    // relation to wide faces add up over short cells.
    let is_wide = random.coin();
    let length = if is_wide || random.coin() {
        random.magnitude(-9, -2)
    } else {
        1.0
    };
    let width = length
        * match random.below(2) {
            _ if is_wide => random.magnitude(4, 10),
            0 => 0.3,
            _ => random.magnitude(-2, 2),
        };
    let ties = match random.below(4) {
        0 => random.magnitude(-3, 3),
        1 => 0.95,
        _ => random.between(0.2, 1.2),
    };
    let flat_first = random.coin();
    let mut draft = Draft::default();
    let mut start = draft.add([0.0; 3]);
    if !is_wide && length < 1.0 {
        let ends = [[1.0, 0.0, 0.0], [0.5, -0.5, 0.0]].map(|p| draft.add(p));
        draft.faces.push([start, ends[1], ends[0]]);
        start = ends[0];
    }
    let first = draft.positions[start as usize][0];
    let mut joints = Vec::new();
    for k in 1..=count {
        let x = first + f64::from(k) * length;
        let end = draft.add([x, 0.0, 0.0]);
        let longer = ties
            * if is_wide {
                TIES[1] * width
            } else {
                TIES[0] * x
            };
        let height = (longer * length / 2.0).sqrt();
        let heights = if flat_first {
            [0.0, height]
        } else {
            [height, 0.0]
        };
        let ends = [start, end];
        let sheets = [
            Sheet::add(&mut draft, ends, rows, width, heights[0]),
            Sheet::add(&mut draft, ends, 1, width, heights[1]),
        ];
        joints.push((end, sheets));
        start = end;
    }
    (draft, joints)
}

pub(super) fn chain(faces: u32, random: &mut Random) -> Draft {
    cells(faces, random).0
}

pub(super) fn saddle_chain(faces: u32, random: &mut Random) -> Draft {
    let (mut draft, joints) = cells(faces * 2 / 3, random);
    for pair in joints.windows(2) {
        let ((joint, before), (_, after)) = (&pair[0], &pair[1]);
        // The sheets around the joint, in turn of the cell before and of the cell after it.
        let last = |sheet: &Sheet| sheet.rows[sheet.rows.len() - 1];
        let [[r0, s0], [r2, s2]] = [&before[0], &before[1]].map(last);
        let [[r1, s1], [r3, s3]] = [&after[0], &after[1]].map(|sheet| sheet.rows[0]);
        for [a, b] in [[s0, s1], [r1, r2], [s2, s3], [r3, r0]] {
            draft.faces.push([*joint, a, b]);
        }
    }
    draft
}

pub(super) fn corridor(faces: u32, random: &mut Random) -> Draft {
    let count = (faces / 2).max(2);
    let width = random.magnitude(-8, 0);
    let swing = width * random.magnitude(0, 3);
    let noise = if random.coin() { 0.0 } else { width };
    let mut draft = Draft::default();
    for k in 0..=count {
        let y = f64::from(k % 2) * swing;
        for side in [-0.5, 0.5] {
            let z = random.between(-noise, noise);
            draft.add([f64::from(k), y + side * width, z]);
        }
    }
    for k in 0..count {
        let [a, b, c, d] = [0, 1, 2, 3].map(|i| 2 * k + i);
        draft.faces.extend([[a, c, b], [b, c, d]]);
    }
    draft
}

/// A closed or open surface without thin faces.
fn rough(faces: u32, random: &mut Random) -> Draft {
    let levels = (f64::from(faces) / 20.0).max(1.0).log(4.0) as u32;
    let mut draft: Draft = match random.below(4) {
        0 => zoo::icosphere(levels.min(4)).into(),
        1 => {
            let around = (f64::from(faces) / 4.0).sqrt().max(3.0) as u32;
            zoo::torus([2 * around, around], 2.0, 1.0).into()
        }
        _ => {
            let side = (f64::from(faces) / 2.0).sqrt().max(1.0) as u32;
            unit_plate(side, side, random)
        }
    };
    let noise = match random.below(3) {
        0 => 0.0,
        1 => random.magnitude(-16, -1),
        _ => random.between(0.0, 0.4),
    };
    draft.place(|p| p.map(|x| x + random.between(-noise, noise)));
    draft
}

pub(super) fn near_duplicates(faces: u32, random: &mut Random) -> Draft {
    let mut draft = rough(faces, random);
    for _ in 0..random.whole(1, 2 + faces.min(200) / 20) {
        let (_, [near, far, _]) = draft.random_side(random);
        let part = random.magnitude(-16, -9);
        let splits = random.whole(1, 3);
        for _ in 0..splits {
            draft.split_edge([near, far], part * random.between(0.5, 1.0));
        }
    }
    let shift = random.magnitude(-16, -9);
    if random.coin() {
        draft.place(|p| p.map(|x| x + shift * random.between(-1.0, 1.0)));
    }
    draft
}

pub(super) fn comb(faces: u32, random: &mut Random) -> Draft {
    let cuts = random.whole(1, 4);
    let count = (faces / (2 * cuts + 1)).max(2);
    let width = random.magnitude(-8, 0);
    let most = random.whole(0, 8).cast_signed();
    let lean = random.between(-1.0, 1.0);
    let is_flat = random.coin();
    let mut draft = Draft::default();
    let mut x = 0.0;
    for _ in 0..=count {
        draft.add([x, -width, 0.0]);
        draft.add([x, 0.0, 0.0]);
        x += width * random.between(0.1, 1.0);
    }
    for k in 0..count {
        let [a, b, c, d] = [0, 1, 2, 3].map(|i| 2 * k + i);
        draft.faces.extend([[a, c, b], [b, c, d]]);
        let height = random.magnitude(-1, most);
        let out = if is_flat {
            0.0
        } else {
            random.between(-1.0, 1.0)
        };
        let mut tip = draft.between(b, d, 0.5 + lean);
        for (x, by) in tip.iter_mut().zip([0.0, height, height * out]) {
            *x += by;
        }
        let tip = draft.add(tip);
        let (mut left, mut right) = (b, d);
        for cut in (1..cuts).rev() {
            let part = 1.0 / f64::from(cut + 1);
            let ends = [left, right].map(|v| draft.between(v, tip, part));
            let [p, q] = ends.map(|p| draft.add(p));
            draft.faces.extend([[left, right, q], [left, q, p]]);
            (left, right) = (p, q);
        }
        draft.faces.push([left, right, tip]);
    }
    draft
}

/// Moves vertices away by 10^`from` to 10^`to` in random directions.
fn pull(draft: &mut Draft, count: u32, [from, to]: [i32; 2], random: &mut Random) {
    for _ in 0..count {
        let v = random.below(draft.positions.len() as u32) as usize;
        let by = random.magnitude(from, to);
        let direction = random.in_ball();
        for (x, d) in draft.positions[v].iter_mut().zip(direction) {
            *x += by * d;
        }
    }
}

pub(super) fn spikes(faces: u32, random: &mut Random) -> Draft {
    let mut draft = rough(faces, random);
    let count = random.whole(1, 1 + faces / 20);
    let most = random.whole(1, 10).cast_signed();
    pull(&mut draft, count, [0, most], random);
    draft
}

pub(super) fn far_vertex(faces: u32, random: &mut Random) -> Draft {
    let mut draft = rough(faces, random);
    pull(&mut draft, 1, [1, 25], random);
    draft
}

pub(super) fn graded(faces: u32, random: &mut Random) -> Draft {
    let spokes = random.whole(3, 8);
    let count = (faces / (2 * spokes)).max(2);
    // The smallest edges, and from them the ratio of successive ones.
    let least = random.magnitude(-20, -2);
    let ratio = least.powf(1.0 / f64::from(count));
    let slope = if random.coin() {
        0.0
    } else {
        random.between(-2.0, 2.0)
    };
    let noise = if random.coin() { 0.0 } else { 0.3 };
    let mut draft = rings(spokes, count, false, [0.0; 3], |ring, k| {
        let radius = ratio.powi((count - 1 - ring).cast_signed());
        let z = slope * radius * random.between(1.0 - noise, 1.0 + noise);
        let radius = radius * random.between(1.0 - noise, 1.0 + noise);
        on_circle(f64::from(k) / f64::from(spokes), radius, z)
    });
    match random.below(4) {
        // Without the last sector, on a boundary.
        0 => draft.faces.retain(|face| {
            let is_in_first = |&v: &u32| v > 0 && (v - 1) % spokes == 0;
            !face.iter().any(is_in_first)
        }),
        // Small positions in one direction only.
        1 => draft.translate([0.0, 0.0, 1.0]),
        _ => {}
    }
    draft
}

pub(super) fn fan(faces: u32, random: &mut Random) -> Draft {
    let closed = random.coin();
    let count = if random.coin() { 1 } else { 2 };
    let spokes = (faces / (2 * count - u32::from(!closed))).max(3);
    let least = if random.coin() {
        0
    } else {
        -random.whole(1, 10).cast_signed()
    };
    let gaps: Vec<f64> = (0..spokes).map(|_| random.magnitude(least, 0)).collect();
    let turn: f64 = gaps.iter().sum();
    let mut angles = vec![0.0];
    for gap in &gaps[1..] {
        angles.push(angles[angles.len() - 1] + gap / turn);
    }
    let height = match random.below(3) {
        0 => 0.0,
        _ => random.magnitude(-8, 3),
    };
    let is_saddle = random.coin();
    let shortest = match random.below(3) {
        0 => 1.0,
        1 => 0.5,
        _ => random.magnitude(-6, 0),
    };
    let mut draft = rings(spokes, count, closed, [0.0, 0.0, height], |ring, k| {
        let z = if is_saddle && k % 2 == 0 { height } else { 0.0 };
        let radius = f64::from(ring + 1) * random.between(shortest, 1.0);
        on_circle(angles[k as usize], radius, z)
    });
    if closed {
        let below = if random.coin() { 0.0 } else { -height };
        draft.add([0.0, 0.0, below]);
    }
    draft
}

/// A square with some round or rectangular holes, whose faces are as long as they can be. Without
/// the vertices of the holes, the square has only its corners.
fn drilled_tile(corner: [f64; 2], round: u32, random: &mut Random) -> Vec<Vec<[f64; 2]>> {
    let at = |[x, y]: [f64; 2]| [corner[0] + x, corner[1] + y];
    let mut outlines = vec![
        [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]]
            .map(at)
            .to_vec(),
    ];
    let places = match random.below(4) {
        0 => vec![],
        1 => vec![[0.27, 0.3], [0.74, 0.68]],
        2 => vec![[0.25, 0.25], [0.75, 0.27], [0.5, 0.75]],
        _ => vec![[0.5, 0.5]],
    };
    let most = if places.len() == 1 { 0.45 } else { 0.2 };
    for [x, y] in places {
        let radius = if random.below(3) == 0 {
            random.magnitude(-4, -1)
        } else {
            random.between(0.05, most)
        };
        let corners = if random.below(4) == 0 { 4 } else { round };
        let turn = random.between(0.0, 0.2);
        let hole = (0..corners).rev().map(|k| {
            let [dx, dy, _] = on_circle(turn + f64::from(k) / f64::from(corners), radius, 0.0);
            at([x + dx, y + dy])
        });
        outlines.push(hole.collect());
    }
    outlines
}

pub(super) fn part(faces: u32, random: &mut Random) -> Draft {
    let round = random.whole(5, 48);
    // A tile has about one hole, and faces on both sides and on the wall of the hole.
    let strips = random.whole(1, 4);
    let tiles = (faces / (round * (2 + 2 * strips))).max(1);
    let columns = f64::from(tiles).sqrt().ceil() as u32;
    let mut draft = Draft::default();
    for tile in 0..tiles {
        let corner = [tile % columns, tile / columns].map(f64::from);
        let outlines = drilled_tile(corner, round, random);
        let mut numbers: Vec<u32> = Vec::new();
        for &[x, y] in outlines.iter().flatten() {
            let known = draft.positions.iter().position(|p| *p == [x, y, 0.0]);
            numbers.push(known.map_or_else(|| draft.add([x, y, 0.0]), |v| v as u32));
        }
        let cut = triangulate(&outlines);
        draft
            .faces
            .extend(cut.iter().map(|face| face.map(|v| numbers[v as usize])));
    }
    let thickness = random.magnitude(-3, 1);
    let fillet = if random.coin() {
        0.0
    } else {
        random.magnitude(-5, -2)
    };
    draft.thicken(thickness, strips, fillet, random);
    if random.coin() {
        // As a Boolean leaves them: vertices on edges of one side only, or nearly on them.
        let height = random.magnitude(-15, -6);
        draft.insert_on_edges(random.whole(1, 8), height, random);
    }
    if random.coin() {
        // As in STL files.
        draft.place(|p| p.map(|x| f64::from(x as f32)));
    }
    draft
}

pub(super) fn rims(faces: u32, random: &mut Random) -> Draft {
    let holes = random.whole(1, 6);
    // Faces on both sides and on the wall of each hole.
    let cuts = (faces / (4 * holes)).max(3);
    let [width, depth] = [f64::from(holes), random.between(1.0, 2.0)];
    let corners = [[0.0, 0.0], [width, 0.0], [width, depth], [0.0, depth]];
    let mut outlines = vec![corners.to_vec()];
    for hole in 0..holes {
        let radius = random.between(0.02, 0.45);
        let turn = random.between(0.0, 1.0);
        let rim = (0..cuts).rev().map(|k| {
            let place = (f64::from(k) + turn) / f64::from(cuts);
            let [x, y, _] = on_circle(place, radius, 0.0);
            [f64::from(hole) + 0.5 + x, depth / 2.0 + y]
        });
        outlines.push(rim.collect());
    }
    let mut draft = Draft::default();
    for &[x, y] in outlines.iter().flatten() {
        draft.add([x, y, 0.0]);
    }
    draft.faces = triangulate(&outlines);
    draft.thicken(random.magnitude(-3, 0), 1, 0.0, random);
    draft
}

pub(super) fn needle_strip(faces: u32, random: &mut Random) -> Draft {
    let width = random.magnitude(-10, 0);
    let wave = random.below(3);
    let mut draft = Draft::default();
    for k in 0..faces + 2 {
        let z = match wave {
            0 => 0.0,
            1 => width * random.between(-1.0, 1.0),
            _ => width * f64::from(k % 4 / 2),
        };
        draft.add([f64::from(k) * width, f64::from(k % 2), z]);
    }
    for k in 0..faces {
        let (a, b) = if k % 2 == 0 { (k, k + 2) } else { (k + 2, k) };
        draft.faces.push([a, b, k + 1]);
    }
    draft
}

pub(super) fn few_slivers(faces: u32, random: &mut Random) -> Draft {
    let mut draft = rough(faces, random);
    let height = random.magnitude(-14, -3);
    draft.insert_on_edges(random.whole(1, 3), height, random);
    draft
}
