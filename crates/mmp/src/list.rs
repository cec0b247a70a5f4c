//! The windows of one half-edge: sorted, disjoint, trimmed at tie points.

use geobench_window::{Window, tie_points};

/// How much shorter a new window must be, relatively, to take ground from a stored one. The old
/// one wins ties, so that a window that comes twice is not stored twice.
const MARGIN: f64 = 1.0 - 1e-12;

/// Width, relative to the edge, below which what trimming leaves of a window is dropped.
///
/// Windows that meet along a ray overlap by rounding, and trimming then leaves slivers of 1e-17 to
/// 1e-11 of an edge, a third of all windows on scans, while true windows are wider than 1e-9. The
/// bent paths along the neighbours of a sliver are as short as its own to far below rounding.
const SLIVER: f64 = 1e-10;

/// Set in a tag while the window waits in the queue.
const QUEUED: u32 = 1 << 31;

/// A window on its half-edge.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Stored {
    window: Window,
    /// The number by which the queue knows the window, unique on its half-edge, and [`QUEUED`].
    tag: u32,
}

/// The windows of one half-edge in ascending order, with disjoint intervals. Gaps are normal.
#[derive(Clone, Debug, Default)]
pub(crate) struct WindowList {
    windows: Vec<Stored>,
}

impl WindowList {
    /// Bytes of one stored window.
    pub(crate) const WINDOW_BYTES: usize = size_of::<Stored>();

    pub(crate) fn len(&self) -> usize {
        self.windows.len()
    }

    pub(crate) fn clear(&mut self) {
        self.windows.clear();
    }

    /// Takes the window with this id out of the queue; it stays stored. `None` if it has been
    /// removed or replaced.
    pub(crate) fn take(&mut self, id: u32) -> Option<Window> {
        let stored = self.windows.iter_mut().find(|s| s.tag == id | QUEUED)?;
        stored.tag = id;
        Some(stored.window)
    }
}

/// Who is shorter on a range.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Owner {
    New,
    /// The stored window at this place of the list.
    Old(usize),
}

/// A range of the half-edge and its owner.
#[derive(Clone, Copy, Debug)]
struct Segment {
    start: f64,
    end: f64,
    owner: Owner,
}

/// Inserts windows into lists: the buffers this needs, and what the last insertion did.
#[derive(Clone, Debug, Default)]
pub(crate) struct Inserter {
    next_id: u32,
    segments: Vec<Segment>,
    pieces: Vec<Stored>,
    /// Labels and ids of the windows to queue: what is left of the new one, and stored ones whose
    /// least distance grew before their turn came.
    pub(crate) to_queue: Vec<(f64, u32)>,
    /// How many of these are pieces of the new window.
    pub(crate) new_pieces: usize,
    /// Stored windows that lost a part.
    pub(crate) trimmed: usize,
    /// Stored windows that lost everything.
    pub(crate) removed: usize,
}

impl Inserter {
    /// Inserts `new` into `list`, whose half-edge has length `l`.
    ///
    /// Each stored window that `new` meets is split at the tie points inside the common range, of
    /// which there may be two, and each part goes to the window that is shorter at its middle.
    /// Ranges that nobody held go to `new`. Takes O(log k + m) for m windows met among k, and the
    /// moving of the windows behind them.
    pub(crate) fn insert(&mut self, list: &mut WindowList, new: &Window, l: f64) {
        self.to_queue.clear();
        (self.new_pieces, self.trimmed, self.removed) = (0, 0, 0);
        let first = list.windows.partition_point(|s| s.window.b1 <= new.b0);
        let met = list.windows[first..]
            .iter()
            .take_while(|s| s.window.b0 < new.b1)
            .count();
        self.share_out(&list.windows[first..first + met], new, SLIVER * l);
        self.segments.retain(|s| s.end - s.start > SLIVER * l);
        if self.segments.iter().any(|s| s.owner == Owner::New) {
            self.replace(list, first..first + met, new);
        }
    }

    /// Divides the ranges of `met` and `new` between them.
    fn share_out(&mut self, met: &[Stored], new: &Window, sliver: f64) {
        self.segments.clear();
        let mut covered = new.b0;
        for (i, stored) in met.iter().enumerate() {
            let w = &stored.window;
            let old = Owner::Old(i);
            let (lo, hi) = (w.b0.max(new.b0), w.b1.min(new.b1));
            self.grant(covered, w.b0, Owner::New);
            self.grant(w.b0, lo, old);
            let mut start = lo;
            if hi - lo > sliver {
                let ties = tie_points(w, new);
                for &tie in ties.as_slice() {
                    if start + sliver < tie && tie < hi - sliver {
                        self.grant(start, tie, shorter(w, new, start, tie, old));
                        start = tie;
                    }
                }
                self.grant(start, hi, shorter(w, new, start, hi, old));
            } else {
                self.grant(start, hi, old);
            }
            self.grant(hi, w.b1, old);
            covered = hi;
        }
        self.grant(covered, new.b1, Owner::New);
    }

    /// Gives `start..end` to `owner`.
    fn grant(&mut self, start: f64, end: f64, owner: Owner) {
        if start < end {
            match self.segments.last_mut() {
                Some(last) if last.owner == owner => last.end = end,
                _ => self.segments.push(Segment { start, end, owner }),
            }
        }
    }

    /// Puts the segments in the place of the windows `range` of `list`.
    fn replace(&mut self, list: &mut WindowList, range: std::ops::Range<usize>, new: &Window) {
        self.pieces.clear();
        let met = &list.windows[range.clone()];
        let mut segments = std::mem::take(&mut self.segments);
        let mut survivors = 0;
        let mut last_old = None;
        for segment in segments.drain(..) {
            match segment.owner {
                Owner::New => {
                    let window = Window {
                        b0: segment.start,
                        b1: segment.end,
                        ..*new
                    };
                    self.new_pieces += 1;
                    self.queue_piece(window);
                }
                Owner::Old(i) => {
                    let first_piece = last_old != Some(i);
                    survivors += usize::from(first_piece);
                    last_old = Some(i);
                    self.keep_piece(&met[i], segment.start, segment.end, first_piece);
                }
            }
        }
        self.segments = segments;
        self.removed = met.len() - survivors;
        list.windows.splice(range, self.pieces.drain(..));
    }

    /// Stores a window that has to be propagated.
    fn queue_piece(&mut self, window: Window) {
        self.next_id = (self.next_id + 1) & !QUEUED;
        self.to_queue.push((window.min_distance(), self.next_id));
        self.pieces.push(Stored {
            window,
            tag: self.next_id | QUEUED,
        });
    }

    /// Stores what is left of `old` on `start..end`.
    ///
    /// A window that was propagated already is only cut, since its children will be trimmed by
    /// those of the winner; one that still waits is queued again if its least distance grew.
    fn keep_piece(&mut self, old: &Stored, start: f64, end: f64, first_piece: bool) {
        let window = Window {
            b0: start,
            b1: end,
            ..old.window
        };
        let whole = start == old.window.b0 && end == old.window.b1;
        self.trimmed += usize::from(first_piece && !whole);
        let in_queue_as_is =
            first_piece && (whole || window.min_distance() <= old.window.min_distance());
        if old.tag & QUEUED == 0 || in_queue_as_is {
            self.pieces.push(Stored {
                window,
                tag: old.tag,
            });
        } else {
            self.queue_piece(window);
        }
    }
}

/// Which of a stored and a new window is shorter in the middle of a range without a tie.
fn shorter(stored: &Window, new: &Window, start: f64, end: f64, old: Owner) -> Owner {
    let middle = 0.5 * (start + end);
    if new.distance(middle) < stored.distance(middle) * MARGIN {
        Owner::New
    } else {
        old
    }
}
