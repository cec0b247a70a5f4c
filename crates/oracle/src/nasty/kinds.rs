//! The kinds of random meshes.

use std::f64::consts::{PI, TAU};
use std::fmt;

use super::built;
use super::draft::Draft;
use super::joined;
use crate::random::Random;
use crate::zoo::{self, Diagonal};

macro_rules! kinds {
    (
        general { $($(#[doc = $doc:literal])+ $name:ident = $text:literal, $make:path;)+ }
        built { $($(#[doc = $built_doc:literal])+ $built:ident = $built_text:literal, $build:path;)+ }
        joined { $($(#[doc = $joined_doc:literal])+ $joined:ident = $joined_text:literal, $join:path;)+ }
    ) => {
        /// The kind of mesh that a random mesh starts as.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
        pub enum Kind {
            $($(#[doc = $doc])+ $name,)+
            $($(#[doc = $built_doc])+ $built,)+
            $($(#[doc = $joined_doc])+ $joined,)+
        }

        impl Kind {
            /// The kinds of at most [`MOST_FACES`](super::MOST_FACES) faces. Seeds of notes and
            /// tests belong to this list, which therefore does not change.
            pub const GENERAL: &[Self] = &[$(Self::$name),+];

            /// The kinds that are built in any size, each against an assumption of an algorithm.
            pub const BUILT: &[Self] = &[$(Self::$built),+];

            /// The kinds with edges of any number of faces, or with one side only, of at most
            /// [`MOST_FACES`](super::MOST_FACES) faces.
            pub const JOINED: &[Self] = &[$(Self::$joined),+];

            /// The name in command lines.
            pub const fn name(self) -> &'static str {
                match self {
                    $(Self::$name => $text,)+
                    $(Self::$built => $built_text,)+
                    $(Self::$joined => $joined_text,)+
                }
            }

            /// A mesh of this kind, of about `faces` faces if the kind is built.
            pub(super) fn draft(self, faces: u32, random: &mut Random) -> Draft {
                match self {
                    $(Self::$name => $make(random),)+
                    $(Self::$built => $build(faces, random),)+
                    $(Self::$joined => $join(random),)+
                }
            }
        }
    };
}

kinds! {
    general {
        /// A plate cut along lines at very uneven distances.
        Slivers = "slivers", slivers;
        /// A terrain with integer heights, on which many distances tie.
        Ties = "ties", ties;
        /// A plate or solid with faces of exactly zero area.
        FlatFaces = "flat-faces", flat_faces;
        /// A plate or solid with faces of nearly zero area.
        NearlyFlat = "nearly-flat", nearly_flat;
        /// Small holes, or small faces, in large faces.
        Pinholes = "pinholes", pinholes;
        /// A cone with a total angle below a full turn.
        Cone = "cone", cone;
        /// Fans with a total angle above a full turn.
        Saddle = "saddle", saddle;
        /// A long narrow strip of triangles.
        Strip = "strip", strip;
        /// A plate with random faces missing: boundaries, bridges, pinched vertices.
        Holes = "holes", holes;
        /// A plate with integer coordinates and a random triangulation, including faces of zero
        /// area.
        FlippedGrid = "flipped-grid", flipped_grid;
        /// A regular or half regular solid, possibly subdivided.
        Solid = "solid", solid;
        /// An antiprism.
        Antiprism = "antiprism", antiprism;
        /// A cone of a very small total angle.
        NeedleTip = "needle-tip", needle_tip;
        /// A cube with edges of about 1e-11.
        TinyEdges = "tiny-edges", tiny_edges;
        /// A rough surface with edges nearly collapsed.
        Collapsed = "collapsed", collapsed;
        /// A sphere of rings with tiny caps at the poles.
        Poles = "poles", poles;
        /// Two cones on one base.
        Bipyramid = "bipyramid", bipyramid;
        /// A random terrain stretched by a large factor.
        Stretched = "stretched", stretched;
        /// A narrow strip along a helix.
        Helix = "helix", helix;
        /// Triangles with two very small angles, row over row.
        Caps = "caps", caps;
        /// A plate folded onto itself: a doubly covered polygon.
        Folded = "folded", folded;
        /// A noisy sphere with edges flipped.
        Crumpled = "crumpled", crumpled;
        /// Fans over vertices on one line.
        CollinearFan = "collinear-fan", collinear_fan;
        /// Two surfaces joined at one or two vertices.
        Pinched = "pinched", pinched;
        /// Several disjoint surfaces.
        Apart = "apart", apart;
    }
    built {
        /// Cells joined at single vertices. In each cell, routes nearly tie.
        Chain = "chain", built::chain;
        /// The same with the cells joined to a surface around saddle vertices.
        SaddleChain = "saddle-chain", built::saddle_chain;
        /// A strip that turns at each face, so that paths bend at its boundary.
        Corridor = "corridor", built::corridor;
        /// A rough surface with vertices that are almost in one place.
        NearDuplicates = "near-duplicates", built::near_duplicates;
        /// A strip with long teeth on one side.
        Comb = "comb", built::comb;
        /// A surface with long spikes.
        Spikes = "spikes", built::spikes;
        /// A surface with one vertex far away.
        FarVertex = "far-vertex", built::far_vertex;
        /// Edges that become shorter by a factor at each step towards a vertex.
        Graded = "graded", built::graded;
        /// Many faces around one vertex.
        Fan = "fan", built::fan;
        /// A drilled plate as from a solid modeller: long thin faces beside short ones, fillets.
        Part = "part", built::part;
        /// A plate of few long faces with finely cut holes.
        Rims = "rims", built::rims;
        /// A strip of equal thin faces.
        NeedleStrip = "needle-strip", built::needle_strip;
        /// A rough surface with few thin faces.
        FewSlivers = "few-slivers", built::few_slivers;
    }
    joined {
        /// Sheets on a common line of edges.
        Book = "book", joined::book;
        /// Lenses in a row.
        Lenses = "lenses", joined::lenses;
        /// Cubes that touch along edges and at vertices.
        Touching = "touching", joined::touching;
        /// Squares of a grid in space.
        Membranes = "membranes", joined::membranes;
        /// Plates that stand on another.
        Tee = "tee", joined::tee;
        /// A strip with its ends joined after half turns.
        Band = "band", joined::band;
        /// A rectangle with opposite sides joined, in either direction.
        Rolled = "rolled", joined::rolled;
        /// Random triangles on few vertices.
        Heap = "heap", joined::heap;
        /// A rough plate with edges made one.
        Sewn = "sewn", joined::sewn;
    }
}

impl fmt::Display for Kind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.name())
    }
}

/// A plate between these lines, each cell cut along a random diagonal.
pub(super) fn plate(xs: &[f64], ys: &[f64], random: &mut Random) -> Draft {
    let columns = xs.len() as u32;
    let mut draft = Draft::default();
    for &y in ys {
        draft.positions.extend(xs.iter().map(|&x| [x, y, 0.0]));
    }
    for j in 1..ys.len() as u32 {
        for i in 1..columns {
            let d = j * columns + i;
            let [a, b, c] = [d - columns - 1, d - columns, d - 1];
            if random.coin() {
                draft.faces.extend([[a, b, d], [a, d, c]]);
            } else {
                draft.faces.extend([[a, b, c], [b, d, c]]);
            }
        }
    }
    draft
}

/// A plate of unit cells with this number of columns and rows.
pub(super) fn unit_plate(columns: u32, rows: u32, random: &mut Random) -> Draft {
    let lines = |count: u32| (0..=count).map(f64::from).collect::<Vec<_>>();
    plate(&lines(columns), &lines(rows), random)
}

/// A plate of a few unit cells, whose size depends on the seed.
fn some_plate(random: &mut Random) -> Draft {
    let [columns, rows] = [0; 2].map(|_| random.whole(2, 6));
    unit_plate(columns, rows, random)
}

fn uneven_lines(random: &mut Random) -> Vec<f64> {
    let count = random.whole(2, 7);
    // One in this many gaps is small.
    let one_in = random.whole(1, 3);
    let least = -random.whole(2, 13).cast_signed();
    let mut at = 0.0;
    let mut lines = vec![at];
    for _ in 0..count {
        at += match random.below(one_in) {
            0 => random.magnitude(least, 0),
            1 => 1.0,
            _ => random.between(0.1, 1.0),
        };
        lines.push(at);
    }
    lines
}

fn slivers(random: &mut Random) -> Draft {
    let [xs, ys] = [0; 2].map(|_| uneven_lines(random));
    let mut draft = plate(&xs, &ys, random);
    if random.below(3) == 0 {
        let height = random.magnitude(-13, 0);
        draft.place(|[x, y, _]| [x, y, random.between(-height, height)]);
    }
    draft
}

fn ties(random: &mut Random) -> Draft {
    let mut draft = some_plate(random);
    let levels = random.whole(1, 4);
    draft.place(|[x, y, _]| [x, y, f64::from(random.below(levels))]);
    draft
}

fn simple(random: &mut Random) -> Draft {
    match random.below(4) {
        0 => ties(random),
        1 => solid(random),
        2 => {
            let mut draft = some_plate(random);
            draft.place(|[x, y, _]| [x, y, random.between(0.0, 1.0)]);
            draft
        }
        _ => some_plate(random),
    }
}

fn flat_faces(random: &mut Random) -> Draft {
    let mut draft = simple(random);
    draft.limit(70);
    draft.insert_on_edges(random.whole(1, 20), 0.0, random);
    draft
}

fn nearly_flat(random: &mut Random) -> Draft {
    let mut draft = simple(random);
    draft.limit(70);
    let height = random.magnitude(-17, -4);
    draft.insert_on_edges(random.whole(1, 20), height, random);
    draft
}

fn pinholes(random: &mut Random) -> Draft {
    let mut draft = simple(random);
    draft.limit(60);
    let holes = random.coin();
    draft.inset_faces(random.whole(1, 8), holes, random);
    draft
}

/// A point above the given angle on the circle.
pub(super) fn on_circle(turn: f64, radius: f64, z: f64) -> [f64; 3] {
    let (sin, cos) = (TAU * turn).sin_cos();
    [radius * cos, radius * sin, z]
}

/// Rings of vertices around vertex 0; the last ring is followed by a vertex of its own if `closed`.
pub(super) fn rings(
    spokes: u32,
    count: u32,
    closed: bool,
    tip: [f64; 3],
    mut place: impl FnMut(u32, u32) -> [f64; 3],
) -> Draft {
    let mut draft = Draft {
        positions: vec![tip],
        faces: Vec::new(),
    };
    for ring in 0..count {
        draft.positions.extend((0..spokes).map(|k| place(ring, k)));
    }
    let at = |ring: u32, k: u32| 1 + ring * spokes + k % spokes;
    for k in 0..spokes {
        draft.faces.push([0, at(0, k), at(0, k + 1)]);
        for ring in 1..count {
            let [a, b] = [at(ring - 1, k), at(ring - 1, k + 1)];
            let [c, d] = [at(ring, k), at(ring, k + 1)];
            draft.faces.extend([[a, c, d], [a, d, b]]);
        }
        if closed {
            let last = 1 + count * spokes;
            draft
                .faces
                .push([last, at(count - 1, k + 1), at(count - 1, k)]);
        }
    }
    draft
}

fn cone(random: &mut Random) -> Draft {
    let (spokes, count) = (random.whole(3, 12), random.whole(1, 4));
    let height = random.magnitude(-8, 2);
    let closed = random.coin();
    let noise = if random.coin() {
        0.0
    } else {
        random.magnitude(-10, -1)
    };
    let mut draft = rings(spokes, count, closed, [0.0, 0.0, height], |ring, k| {
        let part = f64::from(ring + 1) / f64::from(count);
        let z = height * (1.0 - part) + random.between(-noise, noise);
        on_circle(f64::from(k) / f64::from(spokes), part, z)
    });
    if closed {
        draft.positions.push([0.0; 3]);
    }
    draft
}

fn saddle(random: &mut Random) -> Draft {
    let (waves, count) = (random.whole(2, 5), random.whole(1, 4));
    let spokes = 2 * waves;
    let height = random.magnitude(-8, 2);
    rings(spokes, count, false, [0.0; 3], |ring, k| {
        let part = f64::from(ring + 1) / f64::from(count);
        let z = if k % 2 == 0 { height } else { -height };
        on_circle(f64::from(k) / f64::from(spokes), part, part * z)
    })
}

fn strip(random: &mut Random) -> Draft {
    let count = random.whole(5, 50);
    let width = random.magnitude(-10, 0);
    let even = random.coin();
    let noise = match random.below(3) {
        0 => 0.0,
        1 => width,
        _ => random.magnitude(-10, 0),
    };
    let mut draft = Draft::default();
    let mut x = 0.0;
    for i in 0..count + 2 {
        let z = random.between(-noise, noise);
        draft.positions.push([x, f64::from(i % 2), z]);
        x += if even {
            width / 2.0
        } else {
            random.between(0.0, width)
        };
    }
    for i in 0..count {
        let (a, b) = if i % 2 == 0 { (i, i + 2) } else { (i + 2, i) };
        draft.faces.push([a, b, i + 1]);
    }
    draft
}

fn holes(random: &mut Random) -> Draft {
    let mut draft = if random.coin() {
        ties(random)
    } else {
        some_plate(random)
    };
    draft.remove_faces(random.whole(1, 25), random);
    draft
}

fn flipped_grid(random: &mut Random) -> Draft {
    let mut draft = some_plate(random);
    draft.limit(90);
    match random.below(3) {
        0 => draft.split_edges(random.whole(1, 8), random),
        1 => draft.insert_on_edges(random.whole(1, 8), 0.0, random),
        _ => {}
    }
    draft.flip_edges(random.whole(1, 60), random);
    draft
}

fn solid(random: &mut Random) -> Draft {
    let mut draft: Draft = match random.below(5) {
        0 => zoo::disphenoid([1.0; 3]).into(),
        1 => zoo::octahedron().into(),
        2 => zoo::icosahedron().into(),
        3 => {
            let size = [0; 3].map(|_| random.whole(1, 2));
            let cuts = [Diagonal::Rising, Diagonal::Falling, Diagonal::Alternating];
            zoo::cuboid(size, cuts[random.below(3) as usize]).into()
        }
        _ => zoo::prism(
            random.whole(3, 6),
            random.whole(1, 3),
            1.0,
            Diagonal::Rising,
        )
        .into(),
    };
    if draft.faces.len() <= 30 && random.coin() {
        draft.subdivide();
    }
    draft
}

fn antiprism(random: &mut Random) -> Draft {
    let corners = random.whole(3, 12);
    let height = if random.coin() {
        1.0
    } else {
        random.magnitude(-6, 3)
    };
    let with_lids = random.coin();
    let mut draft = Draft::default();
    for ring in 0..2 {
        for k in 0..corners {
            let turn = (f64::from(k) + f64::from(ring) / 2.0) / f64::from(corners);
            draft
                .positions
                .push(on_circle(turn, 1.0, f64::from(ring) * height));
        }
    }
    for k in 0..corners {
        let next = (k + 1) % corners;
        draft
            .faces
            .extend([[k, next, corners + k], [next, corners + next, corners + k]]);
        // Lids are fans from a corner.
        if with_lids && k > 0 && next > 0 {
            draft.faces.push([0, next, k]);
            draft.faces.push([corners, corners + k, corners + next]);
        }
    }
    draft
}

fn needle_tip(random: &mut Random) -> Draft {
    let (spokes, count) = (random.whole(3, 10), random.whole(1, 4));
    let height = random.magnitude(2, 10);
    let closed = random.coin();
    let near_tip = random.coin();
    let mut draft = rings(spokes, count, closed, [0.0, 0.0, height], |ring, k| {
        let even = f64::from(ring + 1) / f64::from(count);
        let part = match count - 1 - ring {
            0 => 1.0,
            left if near_tip => even * 10.0_f64.powi(-3 * left.cast_signed()),
            _ => even,
        };
        on_circle(
            f64::from(k) / f64::from(spokes),
            part,
            height * (1.0 - part),
        )
    });
    if closed {
        let below = if random.coin() { 0.0 } else { -height };
        draft.positions.push([0.0, 0.0, below]);
    }
    draft
}

fn tiny_edges(random: &mut Random) -> Draft {
    let mut draft: Draft = zoo::cuboid([1; 3], Diagonal::Rising).into();
    if random.coin() {
        draft.subdivide();
    }
    for _ in 0..random.whole(1, 6) {
        let before = draft.positions.len();
        draft.split_edges(1, random);
        if random.coin() {
            // Moved towards the end from which it was inserted.
            let at = draft.positions[before];
            let near = draft.positions[random.below(8) as usize];
            let tiny = random.magnitude(-12, -10);
            let axis = random.below(3) as usize;
            let mut place = near;
            place[axis] += tiny * (at[axis] - near[axis]).signum();
            draft.positions[before] = place;
        }
    }
    draft.inset_faces(random.below(3), false, random);
    draft
}

fn collapsed(random: &mut Random) -> Draft {
    let mut draft = simple(random);
    draft.shorten_edges(random.whole(1, 8), random);
    draft
}

fn poles(random: &mut Random) -> Draft {
    let (spokes, count) = (random.whole(3, 10), random.whole(2, 5));
    let cap = random.magnitude(-10, -1);
    let mut draft = rings(spokes, count, true, [0.0, 0.0, 1.0], |ring, k| {
        let polar = match ring {
            0 => cap,
            last if last == count - 1 => PI - cap,
            ring => PI * f64::from(ring) / f64::from(count - 1),
        };
        let (sin, cos) = polar.sin_cos();
        on_circle(f64::from(k) / f64::from(spokes), sin, cos)
    });
    draft.positions.push([0.0, 0.0, -1.0]);
    draft
}

fn bipyramid(random: &mut Random) -> Draft {
    let spokes = random.whole(3, 20);
    let up = random.magnitude(-8, 6);
    let down = match random.below(4) {
        0 => up,
        1 => -random.magnitude(-8, 6),
        _ => random.magnitude(-8, 6),
    };
    let mut draft = rings(spokes, 1, true, [0.0, 0.0, up], |_, k| {
        on_circle(f64::from(k) / f64::from(spokes), 1.0, 0.0)
    });
    draft.positions.push([0.0, 0.0, -down]);
    if draft.faces.len() <= 16 && random.coin() {
        draft.subdivide();
    }
    draft
}

fn stretched(random: &mut Random) -> Draft {
    let mut draft = some_plate(random);
    let rough = random.magnitude(-4, 1);
    let jitter = if random.coin() { 0.0 } else { 0.3 };
    draft.place(|[x, y, _]| {
        let [dx, dy] = [0; 2].map(|_| random.between(-jitter, jitter));
        [x + dx, y + dy, random.between(-rough, rough)]
    });
    let factor = random.magnitude(-7, 7);
    let axis = random.below(3) as usize;
    let mut factors = [1.0; 3];
    factors[axis] = factor;
    draft.scale(factors);
    draft
}

fn helix(random: &mut Random) -> Draft {
    let steps = random.whole(4, 50);
    let [width, rise] = [0; 2].map(|_| random.magnitude(-7, 0));
    let per_turn = f64::from(random.whole(3, 16));
    let mut draft = Draft::default();
    for k in 0..=steps {
        let turn = f64::from(k) / per_turn;
        let z = rise * turn;
        let (inner, outer) = (on_circle(turn, 1.0, z), on_circle(turn, 1.0 + width, z));
        draft.positions.extend([inner, outer]);
    }
    for k in 0..steps {
        let [a, b, c, d] = [0, 1, 2, 3].map(|i| 2 * k + i);
        draft.faces.extend(if random.coin() {
            [[a, b, c], [b, d, c]]
        } else {
            [[a, b, d], [a, d, c]]
        });
    }
    draft
}

fn caps(random: &mut Random) -> Draft {
    let mut draft: Draft = zoo::caps(random.whole(2, 25), random.magnitude(-12, -1)).into();
    if random.coin() {
        let noise = random.magnitude(-14, -2);
        draft.place(|[x, y, z]| {
            let [dx, dz] = [0; 2].map(|_| random.between(-noise, noise));
            [x + dx, y, z + dz]
        });
    }
    draft
}

fn folded(random: &mut Random) -> Draft {
    if random.coin() {
        let size = [0; 2].map(|_| random.whole(1, 5));
        return zoo::pillow(size).0.into();
    }
    let mut draft = some_plate(random);
    let lines = [0; 2].map(|_| f64::from(random.whole(1, 3)));
    let twice = random.coin();
    draft.place(|[x, y, _]| {
        // Integer coordinates stay integers.
        let y = if twice { (y - lines[1]).abs() } else { y };
        [(x - lines[0]).abs(), y, 0.0]
    });
    draft
}

fn crumpled(random: &mut Random) -> Draft {
    let noise = random.between(0.0, 0.6);
    let mut draft: Draft = zoo::icosphere(1).into();
    draft.place(|p| {
        let radius = random.between(1.0 - noise, 1.0 + noise);
        p.map(|x| x * radius)
    });
    draft.flip_edges(random.whole(0, 60), random);
    draft
}

fn collinear_fan(random: &mut Random) -> Draft {
    let count = random.whole(3, 25);
    let above = random.magnitude(-12, 0);
    let below = if random.coin() {
        -above
    } else {
        -random.magnitude(-12, 0)
    };
    let even = random.coin();
    let mut draft = Draft {
        positions: vec![[0.5, above, 0.0], [0.25, below, 0.0]],
        faces: Vec::new(),
    };
    for i in 0..=count {
        let inside = i > 0 && i < count;
        let part = f64::from(i) / f64::from(count);
        let x = if even || !inside {
            part
        } else {
            (f64::from(i - 1) + random.part()) / f64::from(count)
        };
        draft.positions.push([x, 0.0, 0.0]);
    }
    for i in 0..count {
        let [a, b] = [i + 2, i + 3];
        draft.faces.extend([[0, a, b], [1, b, a]]);
    }
    if random.coin() {
        // A triangle over the whole line, without area in between.
        draft.faces.retain(|face| face[0] == 0);
        let last = count + 2;
        draft.faces.extend((1..count).map(|i| [2, i + 3, i + 2]));
        draft.faces.push([1, last, 2]);
    }
    draft
}

fn another(random: &mut Random) -> Draft {
    // All kinds but the last two, which consist of others.
    let count = Kind::GENERAL.len() as u32 - 2;
    let mut draft = Kind::GENERAL[random.below(count) as usize].draft(0, random);
    draft.limit(40);
    draft
}

fn pinched(random: &mut Random) -> Draft {
    let mut draft = another(random);
    for _ in 0..random.whole(1, 2) {
        let other = another(random);
        draft.pinch(&other, random);
    }
    if random.coin() {
        draft.weld(random);
    }
    draft
}

fn apart(random: &mut Random) -> Draft {
    let mut draft = another(random);
    for _ in 0..random.whole(1, 2) {
        draft.place_beside(&another(random));
    }
    draft
}
