//! Random meshes of kinds that break geodesic programs, each determined by its kind and seed.
//!
//! A mesh starts as one of [`Kind::GENERAL`]: slivers, exact ties, faces without area, needle tips
//! and so on; or as one of [`Kind::BUILT`]: chains of near ties, combs, graded edges, parts of
//! solid modellers and so on, small ([`Kind::mesh`]) or of up to 20,000 faces
//! ([`Kind::large_mesh`]); or as one of [`Kind::JOINED`], with edges of any number of faces. Some
//! are changed further: edges are split, flipped or shortened to almost nothing, points are
//! inserted on edges, faces are removed. The whole mesh may be stretched, scaled, moved away from
//! the origin, renumbered, turned inside out or joined with another one.
//!
//! A mesh may have a defect that no program accepts, such as an edge without length. The mesh
//! builder under test must detect it.

mod built;
mod draft;
mod joined;
mod kinds;
mod polygon;
mod random;

use crate::model::Model;
use crate::random::Random;
use draft::Draft;

pub use kinds::Kind;

/// Most faces of a mesh of a general kind.
pub const MOST_FACES: usize = 120;

/// Most faces of a small mesh of a built kind.
pub const MOST_BUILT: usize = 400;

/// Most faces of a large mesh.
pub const MOST_LARGE: usize = 20_000;

/// A random mesh with sources.
#[derive(Clone, Debug)]
pub struct Nasty {
    /// The seed of the mesh.
    pub seed: u64,
    /// The kind that it started as.
    pub kind: Kind,
    /// The mesh. All its sources are meant to be used at once.
    pub model: Model,
}

/// The mesh of a general kind for `seed`. The seed also determines the kind.
///
/// ```
/// use geobench_oracle::nasty;
///
/// let mesh = nasty::mesh(17);
/// assert_eq!(mesh.model, nasty::mesh(17).model);
/// assert!(mesh.model.triangles.len() <= nasty::MOST_FACES);
/// ```
pub fn mesh(seed: u64) -> Nasty {
    let count = Kind::GENERAL.len() as u64;
    Kind::GENERAL[(seed % count) as usize].mesh(seed)
}

impl Kind {
    /// The mesh of this kind for `seed`.
    pub fn mesh(self, seed: u64) -> Nasty {
        let mut random = Random::new(seed.wrapping_mul(0x2545_f491_4f6c_dd1d));
        if Self::BUILT.contains(&self) {
            self.built(seed, [10, MOST_BUILT], random)
        } else {
            self.made(seed, 0, MOST_FACES, &mut random)
        }
    }

    /// The large mesh of this built kind for `seed`.
    ///
    /// # Panics
    ///
    /// If the kind is not built.
    pub fn large_mesh(self, seed: u64) -> Nasty {
        assert!(Self::BUILT.contains(&self), "{self} has no large meshes");
        let random = Random::new(seed.wrapping_mul(0x2545_f491_4f6c_dd1d));
        let mut mesh = self.built(seed, [MOST_BUILT, MOST_LARGE], random);
        mesh.model.name.insert_str(0, "large-");
        mesh
    }

    /// A mesh with a random number of faces, distributed evenly on a logarithmic scale. Half of
    /// these meshes are changed no further, and half have vertex 0 as their only source: where
    /// chains begin and faces meet.
    #[allow(clippy::cast_sign_loss)] // The logarithm's inverse is positive.
    fn built(self, seed: u64, [least, most]: [usize; 2], mut random: Random) -> Nasty {
        let scale = random.between((least as f64).ln(), (most as f64).ln());
        let faces = (scale.exp() as u32).max(1);
        if random.coin() {
            return self.made(seed, faces, most, &mut random);
        }
        let mut draft = self.draft(faces, &mut random);
        draft.limit(most);
        self.finished(seed, draft, &[], &mut random)
    }

    /// A mesh with changes.
    fn made(self, seed: u64, faces: u32, most: usize, random: &mut Random) -> Nasty {
        let mut draft = self.draft(faces, random);
        draft.limit(most);
        let mut changes = Vec::new();
        change(&mut draft, self, random, &mut changes);
        draft.limit(most);
        self.finished(seed, draft, &changes, random)
    }

    fn finished(self, seed: u64, draft: Draft, changes: &[&str], random: &mut Random) -> Nasty {
        let sources = if Self::BUILT.contains(&self) && random.coin() {
            vec![0]
        } else {
            sources(&draft, random)
        };
        let mut name = format!("{self} {seed}");
        for change in changes {
            name += ", ";
            name += change;
        }
        let model = Model::new(name, draft.positions, draft.faces).only_from(&sources);
        Nasty {
            seed,
            kind: self,
            model,
        }
    }
}

/// Changes that may be made to any mesh.
fn change(draft: &mut Draft, kind: Kind, random: &mut Random, changes: &mut Vec<&'static str>) {
    // One mesh in three is changed often.
    let often = if random.below(3) == 0 { 3 } else { 1 };
    let mut chance = |random: &mut Random, one_in: u32, what: &'static str| {
        let made = random.below(one_in) < often;
        if made {
            changes.push(what);
        }
        made
    };
    if chance(random, 6, "edges split") {
        draft.split_edges(random.below(6) + 1, random);
    }
    if chance(random, 8, "flat faces") {
        draft.insert_on_edges(random.below(6) + 1, 0.0, random);
    }
    if chance(random, 12, "nearly flat faces") {
        let height = random.magnitude(-17, -4);
        draft.insert_on_edges(random.below(6) + 1, height, random);
    }
    if chance(random, 10, "edges flipped") {
        draft.flip_edges(random.below(10) + 1, random);
    }
    if chance(random, 12, "edges nearly collapsed") {
        draft.shorten_edges(random.below(3) + 1, random);
    }
    if chance(random, 12, "pinholes") {
        draft.inset_faces(random.below(3) + 1, true, random);
    }
    if chance(random, 16, "faces removed") {
        draft.remove_faces(random.below(4) + 1, random);
    }
    if chance(random, 20, "two vertices made one") {
        draft.weld(random);
    }
    if chance(random, 12, "stretched") {
        let factors = [0; 3].map(|_| random.magnitude(-5, 5));
        draft.scale(factors);
    }
    if chance(random, 16, "joined with another") {
        let other = Kind::GENERAL[random.below(Kind::GENERAL.len() as u32) as usize];
        let mut other = other.draft(0, random);
        other.limit(30);
        if random.below(2) == 0 {
            draft.pinch(&other, random);
        } else {
            draft.place_beside(&other);
        }
    }
    if chance(random, 12, "coordinates rounded") {
        draft.round(random.below(6));
    }
    // Positions far from the origin are rounded, so needle tips and tiny parts would be lost.
    if kind != Kind::NeedleTip && chance(random, 10, "far from the origin") {
        let size = draft.size();
        let far = [0; 3].map(|_| random.between(-1e6, 1e6).round() * size);
        draft.translate(far);
    }
    if chance(random, 4, "scaled") {
        let factor = random.magnitude(-30, 30);
        draft.scale([factor; 3]);
    }
    if chance(random, 12, "with isolated vertices") {
        let size = draft.size();
        for _ in 0..=random.below(2) {
            draft.positions.push(random.in_ball().map(|x| x * size));
        }
    }
    if chance(random, 4, "renumbered") {
        draft.renumber(random);
    }
    if chance(random, 4, "turned inside out") {
        for face in &mut draft.faces {
            face.swap(1, 2);
        }
    }
}

/// One source, or with probability 1/4 up to four.
fn sources(draft: &Draft, random: &mut Random) -> Vec<u32> {
    let count = match random.below(4) {
        0 => 2 + random.below(3),
        _ => 1,
    };
    let mut sources = Vec::new();
    for _ in 0..count {
        // Isolated vertices are tried rarely.
        let source = if random.below(40) == 0 {
            random.below(draft.positions.len() as u32)
        } else {
            let face = random.below(draft.faces.len() as u32) as usize;
            draft.faces[face][random.below(3) as usize]
        };
        if !sources.contains(&source) {
            sources.push(source);
        }
    }
    sources
}
