//! Through which exits of its face a window may leave.

use geobench_mesh::{HalfEdgeId, Mesh};
use geobench_window::{Faces, Frame, Window, apex_distance, separating_abscissa};

use crate::lists::WindowLists;
use crate::pairs::MARGIN;
use crate::sides::{BestPath, Sides};

/// A list about to cross a face.
#[derive(Clone, Copy, Debug)]
pub struct Crossing<'a> {
    /// The half-edge through which it enters.
    pub(crate) h: HalfEdgeId,
    pub(crate) frame: &'a Frame,
    /// The windows that are left of the list, and where their rays to the apex meet the half-edge.
    pub(crate) windows: &'a [Window],
    pub(crate) separations: &'a [f64],
    /// The shortest of their paths to the apex.
    pub(crate) best: BestPath,
    /// The windows that wait elsewhere.
    pub(crate) lists: &'a WindowLists,
    pub(crate) faces: &'a Faces,
}

/// Decides through which exits the windows of a list may leave the face that they cross.
pub trait Exits: Send {
    /// Sets up for `mesh`.
    fn new(mesh: &Mesh) -> Self;

    /// Forgets the last run.
    fn reset(&mut self) {}

    /// A list is about to cross.
    fn enter(&mut self, crossing: &Crossing<'_>) {
        let _ = crossing;
    }

    /// Which rays of `w`, a window of that list whose ray to the apex meets the half-edge at `sp`,
    /// may go where. `best` is the best path of the list, `frame` the frame of the half-edge.
    fn sides(&self, frame: &Frame, best: &BestPath, w: &Window, sp: f64) -> Sides;
}

/// Every ray leaves where it leads: rule 1 switched off.
#[derive(Clone, Copy, Debug)]
pub struct AnyExit;

impl Exits for AnyExit {
    fn new(_: &Mesh) -> Self {
        Self
    }

    #[inline]
    fn sides(&self, _: &Frame, _: &BestPath, w: &Window, sp: f64) -> Sides {
        Sides::both(w, sp)
    }
}

/// Rule 1 (Qin et al. 2016, section 4.1): no ray crosses the best path of the list to the apex.
#[derive(Clone, Copy, Debug)]
pub struct OneAngleTwoSides;

impl Exits for OneAngleTwoSides {
    fn new(_: &Mesh) -> Self {
        Self
    }

    #[inline]
    fn sides(&self, _: &Frame, best: &BestPath, w: &Window, sp: f64) -> Sides {
        best.sides(w, sp)
    }
}

/// Rule 1, and no ray crosses the shortest path across the face that came through one of its other
/// half-edges earlier in the run either (Strategy II of the transfer report, figure 5.6 c; case 11
/// of Qin et al. 2016).
#[derive(Clone, Debug)]
pub struct AcrossTheFace {
    records: PathRecords,
    reach: Reach,
}

impl Exits for AcrossTheFace {
    fn new(mesh: &Mesh) -> Self {
        Self {
            records: PathRecords::new(mesh),
            reach: Reach::default(),
        }
    }

    fn reset(&mut self) {
        self.records.reset();
    }

    fn enter(&mut self, crossing: &Crossing<'_>) {
        self.records.note(crossing);
        self.reach = Reach {
            tail: self.records.least(crossing.h.next()),
            head: self.records.least(crossing.h.prev()),
        };
    }

    #[inline]
    fn sides(&self, frame: &Frame, best: &BestPath, w: &Window, sp: f64) -> Sides {
        let rule_1 = best.sides(w, sp);
        rule_1.and(self.reach.sides(frame.l, w, sp))
    }
}

/// No ray crosses *any* path to a vertex of the face that is shorter than its own window's: the
/// path of every other window of the list to the apex (cases 7 to 10 of Qin et al. 2016 for all
/// pairs, which rule 1 makes for the best window only), and the paths of all windows that wait at,
/// or have come through, the other two half-edges of the face (case 11).
#[derive(Clone, Debug)]
pub struct EveryPath {
    records: PathRecords,
    reach: Reach,
    paths: Vec<BestPath>,
}

impl Exits for EveryPath {
    fn new(mesh: &Mesh) -> Self {
        Self {
            records: PathRecords::new(mesh),
            reach: Reach::default(),
            paths: Vec::new(),
        }
    }

    fn reset(&mut self) {
        self.records.reset();
    }

    fn enter(&mut self, crossing: &Crossing<'_>) {
        self.records.note(crossing);
        let least = |h| self.records.least(h).min(least_waiting(crossing, h));
        self.reach = Reach {
            tail: least(crossing.h.next()),
            head: least(crossing.h.prev()),
        };
        self.paths.clear();
        let windows = crossing.windows.iter().zip(crossing.separations);
        self.paths
            .extend(windows.map(|(w, &sp)| BestPath::of(crossing.frame, w, sp)));
    }

    fn sides(&self, frame: &Frame, best: &BestPath, w: &Window, sp: f64) -> Sides {
        let own = apex_distance(frame, w, sp) * MARGIN;
        let better = self.paths.iter().filter(|path| path.distance < own);
        let rule_1 = best.sides(w, sp);
        better.fold(
            rule_1.and(self.reach.sides(frame.l, w, sp)),
            |sides, path| sides.and(path.sides(w, sp)),
        )
    }
}

/// The shortest path of the windows that wait on `h` to the apex of its face.
fn least_waiting(crossing: &Crossing<'_>, h: HalfEdgeId) -> f64 {
    let frame = crossing.faces.frame(h);
    let waiting = crossing.lists.on(h);
    waiting
        .map(|w| apex_distance(&frame, w, separating_abscissa(&frame, w)))
        .fold(f64::INFINITY, f64::min)
}

/// For each half-edge the length of the shortest path that has come through it and across its face
/// to the apex, in this run. Such a path stays real even when its windows have been replaced.
#[derive(Clone, Debug)]
struct PathRecords {
    least: Vec<f64>,
}

impl PathRecords {
    fn new(mesh: &Mesh) -> Self {
        Self {
            least: vec![f64::INFINITY; mesh.half_edge_count()],
        }
    }

    fn reset(&mut self) {
        self.least.fill(f64::INFINITY);
    }

    fn note(&mut self, crossing: &Crossing<'_>) {
        let least = &mut self.least[crossing.h.index()];
        *least = least.min(crossing.best.distance);
    }

    fn least(&self, h: HalfEdgeId) -> f64 {
        self.least[h.index()]
    }
}

/// How far the ends of a half-edge are on paths across its face from the other two half-edges.
#[derive(Clone, Copy, Debug, Default)]
struct Reach {
    /// The tail A, on a path that enters through the edge BC.
    tail: f64,
    /// The head B, on a path that enters through the edge CA.
    head: f64,
}

impl Reach {
    /// What such paths leave of `w`, which lies on a half-edge of length `l`.
    ///
    /// A path from BC to A parts AB from AC, so every ray of `w` for the left exit crosses it. The
    /// crossing lies on a path of `w` to A, and of these the one bent at `b0` is the shortest; if
    /// the path from BC is shorter, so it is up to the crossing, and the ray is useless from there
    /// on. Mirrored for B and the right exit.
    #[inline]
    fn sides(self, l: f64, w: &Window, sp: f64) -> Sides {
        let Sides { left, right } = Sides::both(w, sp);
        let to_tail = (w.distance(w.b0) + w.b0) * MARGIN;
        let to_head = (w.distance(w.b1) + (l - w.b1)) * MARGIN;
        Sides {
            left: left.filter(|_| self.tail >= to_tail),
            right: right.filter(|_| self.head >= to_head),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const WINDOW: Window = Window {
        b0: 0.25,
        b1: 0.75,
        px: 0.5,
        py: 0.0,
        sigma: 1.0,
    };

    #[test]
    fn a_shorter_path_across_the_face_closes_the_exit_behind_it() {
        // The window's shortest ways to both ends of the edge have length 1 + 0.25 + 0.25.
        let sides = |tail, head| Reach { tail, head }.sides(1.0, &WINDOW, 0.5);
        let both = Sides::both(&WINDOW, 0.5);
        assert_eq!(sides(2.0, f64::INFINITY), both);
        assert_eq!(sides(1.4, 2.0), Sides { left: None, ..both });
        assert_eq!(
            sides(2.0, 1.4),
            Sides {
                right: None,
                ..both
            }
        );
    }

    #[test]
    fn an_equal_path_across_the_face_closes_nothing() {
        for noise in [-1e-15, 0.0, 1e-15] {
            let equal = Reach {
                tail: 1.5 + noise,
                head: 1.5 - noise,
            };
            assert_eq!(equal.sides(1.0, &WINDOW, 0.5), Sides::both(&WINDOW, 0.5));
        }
    }
}
