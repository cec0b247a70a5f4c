//! The exits of a face through which windows may leave.

// The engine is private, so other crates cannot implement this trait.
#![allow(private_bounds, private_interfaces)]

use crate::crossing::Least;
use crate::engine::active_list::ActiveList;
use crate::engine::kernels::Gate;
use crate::engine::kernels::exits::{BestPath, EveryBetterPath, Free, Reach, Rule};
use crate::engine::layout::{MeshLayout, half_edge, next, parts, prev};
use crate::front::Front;
use crate::precision::blur;
use geobench_window::simd::Simd;

/// A list that is about to cross a face.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ListCrossing<'a> {
    /// The half-edge through which it enters.
    pub(crate) h: u32,
    /// The windows that remain of the list.
    pub(crate) active: &'a ActiveList,
    pub(crate) gate: Gate,
    /// The shortest path of the list to the apex; `distance` is its length.
    pub(crate) best: BestPath,
    pub(crate) distance: f64,
    /// All waiting windows.
    pub(crate) front: &'a Front,
    pub(crate) layout: &'a MeshLayout,
    pub(crate) simd: Simd,
}

impl ListCrossing<'_> {
    /// The other two half-edges of the face: the one that starts at the head B, and the one that
    /// ends at the tail A.
    fn others(&self) -> [u32; 2] {
        let (f, corner) = parts(self.h);
        [next(corner), prev(corner)].map(|corner| half_edge(f as u32, corner))
    }
}

/// Decides through which exits the windows of a list may leave the face that they cross.
pub trait Exits: Send {
    /// The test that the pass across the face applies to each window.
    #[doc(hidden)]
    type Rule<'a>: Rule
    where
        Self: 'a;

    /// Whether exits are closed by rule 1 alone.
    #[doc(hidden)]
    const IS_RULE_1: bool = false;

    /// Sets up for a mesh with this number of faces.
    fn new(faces: usize) -> Self;

    /// Changes the number of faces, before the next [`reset`](Self::reset).
    fn resize(&mut self, faces: usize) {
        let _ = faces;
    }

    /// Clears the state of the last run.
    fn reset(&mut self) {}

    /// Called when a list is about to cross its face. Returns the rule for its windows.
    fn enter(&mut self, crossing: &ListCrossing<'_>) -> Self::Rule<'_>;
}

/// Every ray may leave: rule 1 switched off.
#[derive(Clone, Copy, Debug)]
pub struct AnyExit;

impl Exits for AnyExit {
    type Rule<'a> = Free;

    fn new(_: usize) -> Self {
        Self
    }

    #[inline]
    fn enter(&mut self, _: &ListCrossing<'_>) -> Free {
        Free
    }
}

/// Rule 1 (Qin et al. 2016, section 4.1): no ray crosses the list's shortest path to the apex.
#[derive(Clone, Copy, Debug)]
pub struct OneAngleTwoSides;

impl Exits for OneAngleTwoSides {
    type Rule<'a> = BestPath;

    const IS_RULE_1: bool = true;

    fn new(_: usize) -> Self {
        Self
    }

    #[inline]
    fn enter(&mut self, crossing: &ListCrossing<'_>) -> BestPath {
        crossing.best
    }
}

/// Rule 1, and paths of earlier lists: no ray crosses the shortest path across the face that came
/// through one of its other half-edges earlier in the run (strategy II of the transfer report,
/// figure 5.6 c; case 11 of Qin et al. 2016).
#[derive(Clone, Debug)]
pub struct AcrossTheFace {
    records: PathRecords,
}

impl Exits for AcrossTheFace {
    type Rule<'a> = (BestPath, Reach);

    fn new(faces: usize) -> Self {
        Self {
            records: PathRecords::new(faces),
        }
    }

    fn resize(&mut self, faces: usize) {
        self.records.least.resize(4 * faces, f64::INFINITY);
    }

    fn reset(&mut self) {
        self.records.reset();
    }

    fn enter(&mut self, crossing: &ListCrossing<'_>) -> (BestPath, Reach) {
        self.records.note(crossing);
        let Gate { l, longest, .. } = crossing.gate;
        let others = crossing.others();
        let [tail, head] = others.map(|h| self.records.least(h) + blur(longest));
        (crossing.best, Reach { l, tail, head })
    }
}

/// No ray crosses *any* path to a vertex of the face that is shorter than its own window's. This
/// covers the paths of all windows of the list to the apex (cases 7 to 10 of Qin et al. 2016 for
/// all pairs; rule 1 applies them to the best window only). It also covers the paths of all windows
/// that wait at, or have come through, the other two half-edges of the face (case 11).
#[derive(Clone, Debug)]
pub struct EveryPath {
    records: PathRecords,
    paths: Vec<(BestPath, f64)>,
    keep: Vec<u8>,
}

impl Exits for EveryPath {
    type Rule<'a> = (BestPath, (Reach, EveryBetterPath<'a>));

    fn new(faces: usize) -> Self {
        Self {
            records: PathRecords::new(faces),
            paths: Vec::new(),
            keep: Vec::new(),
        }
    }

    fn resize(&mut self, faces: usize) {
        self.records.least.resize(4 * faces, f64::INFINITY);
    }

    fn reset(&mut self) {
        self.records.reset();
    }

    fn enter(&mut self, crossing: &ListCrossing<'_>) -> Self::Rule<'_> {
        self.records.note(crossing);
        let Gate {
            l, apex, longest, ..
        } = crossing.gate;
        let [tail, head] = crossing.others().map(|h| {
            let waiting = least_waiting(crossing, h, &mut self.keep);
            waiting.min(self.records.least(h)) + blur(longest)
        });
        self.paths.clear();
        let list = crossing.active.columns();
        let path = |i| {
            let path = BestPath::of(list, i, &crossing.gate, crossing.distance);
            let w = crossing.active.window(i);
            let [x, y] = [apex[0] - path.entry, apex[1]];
            let bent = w.distance(path.entry) + (x * x + y * y).sqrt();
            (path, bent + blur(longest))
        };
        self.paths.extend((0..crossing.active.len).map(path));
        let every = EveryBetterPath {
            apex,
            paths: &self.paths,
        };
        (crossing.best, (Reach { l, tail, head }, every))
    }
}

/// The length of the shortest path of the windows that wait on `h` to the apex of its face.
fn least_waiting(crossing: &ListCrossing<'_>, h: u32, keep: &mut Vec<u8>) -> f64 {
    let gate = crossing.layout.gate(h, [f64::INFINITY; 2]);
    let lists = crossing.front.lists(h).into_iter();
    let lengths = lists.filter(|list| !list.is_empty()).map(|list| {
        let keep = &mut *keep;
        let program = Least {
            list,
            start: 0,
            gate: &gate,
            keep,
        };
        crossing.simd.run(program)
    });
    lengths.fold(f64::INFINITY, f64::min)
}

/// For each half-edge, the length of the shortest path in this run that came through it and across
/// its face to the apex. Such a path stays valid when its windows have been replaced.
#[derive(Clone, Debug)]
struct PathRecords {
    least: Vec<f64>,
}

impl PathRecords {
    fn new(faces: usize) -> Self {
        Self {
            least: vec![f64::INFINITY; 4 * faces],
        }
    }

    fn reset(&mut self) {
        self.least.fill(f64::INFINITY);
    }

    fn note(&mut self, crossing: &ListCrossing<'_>) {
        let least = &mut self.least[crossing.h as usize];
        *least = least.min(crossing.distance);
    }

    fn least(&self, h: u32) -> f64 {
        self.least[h as usize]
    }
}
