//! The pairs of windows of a list that are compared.

// Kernels must be inlined into the functions that enable the instructions.
#![allow(clippy::inline_always)]
// The engine is private, so other crates cannot implement this trait.
#![allow(private_bounds, private_interfaces)]

use geobench_window::{Counter, Window};

use crate::engine::active_list::ActiveList;
use crate::engine::kernels::settle;
use crate::engine::layout::MeshLayout;
use crate::pairs::{PairOutcome, SharedEdge, check_pair};
use crate::tally::{PairTally, PruningTally};
use crate::trim::trim_pair;
use geobench_window::simd::Lanes;

/// Selects and compares pairs of windows of a list before it crosses its face.
pub trait Pairs: Send {
    /// The counters of these comparisons.
    #[doc(hidden)]
    const COUNTERS: &'static [Counter];

    /// Cuts or drops windows of `active`, the list on half-edge `h` of `layout`.
    #[doc(hidden)]
    fn prune<L: Lanes, T: PruningTally>(
        simd: L::Token,
        active: &mut ActiveList,
        layout: &MeshLayout,
        h: u32,
        tally: &mut T,
    );
}

/// Neighbours in the list: rules 2 and 3 (Qin et al. 2016, sections 4.2 and 4.3). Neighbours are
/// compared until no window is deleted. This takes linear time for a list.
#[derive(Clone, Copy, Debug)]
pub struct Neighbours;

impl Pairs for Neighbours {
    const COUNTERS: &'static [Counter] = PairTally::OF_NEIGHBOURS;

    #[inline(always)]
    fn prune<L: Lanes, T: PruningTally>(
        simd: L::Token,
        active: &mut ActiveList,
        layout: &MeshLayout,
        h: u32,
        tally: &mut T,
    ) {
        settle_neighbours::<L, T, false>(simd, active, layout, h, tally);
    }
}

/// Compares neighbours until no window is deleted, and with `TRIM` cuts them at their tie points.
/// Returns whether the list has settled. It has not if a window would be split or change its place.
#[inline(always)]
fn settle_neighbours<L: Lanes, T: PruningTally, const TRIM: bool>(
    simd: L::Token,
    active: &mut ActiveList,
    layout: &MeshLayout,
    h: u32,
    tally: &mut T,
) -> bool {
    let len = active.len;
    if len < 2 {
        return true;
    }
    let edge = || SharedEdge::of(layout, h);
    let (block, cuts, again) = active.parts();
    let (len, settled) = settle::<L, T, TRIM>(simd, block, len, edge, cuts, again, tally);
    active.len = len;
    settled
}

/// No pairs: rules 2 and 3 switched off.
#[derive(Clone, Copy, Debug)]
pub struct NoPairs;

impl Pairs for NoPairs {
    const COUNTERS: &'static [Counter] = &[];

    #[inline(always)]
    fn prune<L: Lanes, T: PruningTally>(
        _: L::Token,
        _: &mut ActiveList,
        _: &MeshLayout,
        _: u32,
        _: &mut T,
    ) {
    }
}

/// Compares windows one at a time. `push` compares each with the windows `checked` so far, cuts or
/// drops these, and appends the window unless it is deleted.
fn one_by_one<T: PruningTally>(
    active: &mut ActiveList,
    layout: &MeshLayout,
    h: u32,
    tally: &mut T,
    push: impl Fn(&mut Vec<Window>, Window, &SharedEdge, &mut T),
) {
    if active.len < 2 {
        return;
    }
    let edge = SharedEdge::of(layout, h);
    let mut checked = std::mem::take(&mut active.windows);
    checked.clear();
    for w in active.iter() {
        push(&mut checked, w, &edge, tally);
    }
    active.replace(&checked);
    active.windows = checked;
}

/// Every pair once. Quadratic in the length of the list.
#[derive(Clone, Copy, Debug)]
pub struct AllPairs;

impl Pairs for AllPairs {
    const COUNTERS: &'static [Counter] = PairTally::OF_OTHERS;

    fn prune<L: Lanes, T: PruningTally>(
        _: L::Token,
        active: &mut ActiveList,
        layout: &MeshLayout,
        h: u32,
        tally: &mut T,
    ) {
        one_by_one(active, layout, h, tally, push_to_all);
    }
}

/// Compares `new` with all of `checked`.
fn push_to_all(
    checked: &mut Vec<Window>,
    mut new: Window,
    edge: &SharedEdge,
    tally: &mut impl PruningTally,
) {
    let mut alive = true;
    checked.retain_mut(|w| {
        if !alive {
            return true;
        }
        tally.check();
        let verdict = check_pair(w, &mut new, edge);
        alive = verdict != PairOutcome::SecondDies;
        verdict != PairOutcome::FirstDies
    });
    if alive {
        checked.push(new);
    }
}

/// Neighbours in the list, as in rules 2 and 3. Remaining overlaps are cut at the tie points, as in
/// MMP, so neighbours never overlap.
#[derive(Clone, Copy, Debug)]
pub struct TrimmedNeighbours;

impl Pairs for TrimmedNeighbours {
    const COUNTERS: &'static [Counter] = PairTally::OF_OTHERS;

    #[inline(always)]
    fn prune<L: Lanes, T: PruningTally>(
        simd: L::Token,
        active: &mut ActiveList,
        layout: &MeshLayout,
        h: u32,
        tally: &mut T,
    ) {
        if !settle_neighbours::<L, T, true>(simd, active, layout, h, tally) {
            one_by_one(active, layout, h, tally, push_and_trim);
        }
    }
}

/// Compares `new` with the last of `checked`, with the one before if that is deleted, and so on,
/// and trims overlaps.
fn push_and_trim(
    checked: &mut Vec<Window>,
    mut new: Window,
    edge: &SharedEdge,
    tally: &mut impl PruningTally,
) {
    while let Some(last) = checked.last_mut() {
        tally.check();
        match check_pair(last, &mut new, edge) {
            PairOutcome::BothStay => {}
            PairOutcome::FirstDies => {
                checked.pop();
                continue;
            }
            PairOutcome::SecondDies => return,
        }
        let Some((of_last, of_new)) = trim_pair(last, &new, edge.l) else {
            break;
        };
        if of_new.is_empty() {
            return;
        }
        checked.pop();
        if of_last.is_empty() {
            continue;
        }
        let start = checked.len();
        checked.extend(of_last.iter().chain(of_new.iter()));
        checked[start..].sort_by(|a, b| a.b0.total_cmp(&b.b0));
        return;
    }
    checked.push(new);
}

#[cfg(test)]
mod tests {
    use geobench_mesh::{Mesh, Numbering, TriangleSoup};

    use super::*;
    use geobench_window::Count;
    use geobench_window::simd::Scalar;

    fn window(b0: f64, b1: f64, px: f64, py: f64, sigma: f64) -> Window {
        Window {
            b0,
            b1,
            px,
            py,
            sigma,
        }
    }

    /// The windows that `P` leaves of `windows`, on an edge of length 1 with a vertex at (0.5, -1)
    /// behind it.
    fn prune<P: Pairs>(windows: &[Window]) -> Vec<Window> {
        prune_with::<P>(windows, &mut ())
    }

    fn prune_with<P: Pairs>(windows: &[Window], tally: &mut impl PruningTally) -> Vec<Window> {
        let positions = [[0.0, 0.0], [1.0, 0.0], [0.5, 1.0], [0.5, -1.0]];
        let positions = positions.map(|[x, y]| [x, y, 0.0]).to_vec();
        let soup = TriangleSoup::new(positions, vec![[0, 1, 2], [1, 0, 3]]);
        let (mesh, _) = Mesh::from_soup(soup).unwrap();
        let layout = MeshLayout::new(&mesh, &Numbering::same());
        assert_eq!(layout.behind(0), [0.5, -1.0]);
        let mut active = ActiveList::new();
        active.replace(windows);
        P::prune::<Scalar, _>((), &mut active, &layout, 0, tally);
        active.iter().collect()
    }

    #[test]
    fn a_new_window_is_compared_with_all_that_it_kills() {
        let dear = [0.1, 0.2, 0.3].map(|b0| window(b0, b0 + 0.1, 0.9, -1.0, 3.0));
        let better = window(0.0, 0.6, 0.1, -1.0, 0.0);
        let list = [&dear[..], &[better]].concat();
        assert_eq!(prune::<Neighbours>(&list), [better]);
        assert_eq!(prune::<AllPairs>(&list), [better]);
        assert_eq!(prune::<TrimmedNeighbours>(&list), [better]);
        assert_eq!(prune::<NoPairs>(&list), list);
    }

    /// In the first round the last of the dear windows is deleted and the others stay. Each
    /// deletion brings one more pair together, at most 2n in all.
    #[test]
    fn comparisons_are_counted_by_case() {
        let dear = [0.1, 0.2, 0.3].map(|b0| window(b0, b0 + 0.1, 0.9, -1.0, 3.0));
        let better = window(0.0, 0.6, 0.1, -1.0, 0.0);
        let list = [&dear[..], &[better]].concat();
        for (seam, from) in [(3, 3), (4, 0), (0, 0)] {
            let mut tally = PairTally::default();
            tally.start(seam, list.len());
            assert_eq!(prune_with::<Neighbours>(&list, &mut tally), [better]);
            let mut counted = Count::default();
            tally.add_to(&mut counted);
            let counters = counted.counters(PairTally::OF_NEIGHBOURS);
            let of = |counter: Counter| counters.get(counter).unwrap();
            assert_eq!(of(Counter::ComparedWindows), 4);
            assert_eq!(of(Counter::PairChecks), 5);
            // The better window starts before the dear ones, which stand before it in the list.
            let cases = PairTally::OF_NEIGHBOURS[2..].iter().map(|case| of(*case));
            let mut expected = [0; 6];
            expected[1 + from] = 3;
            assert_eq!(cases.collect::<Vec<_>>(), expected, "{seam}");
        }
    }

    #[test]
    fn only_the_exhaustive_check_looks_past_a_neighbour() {
        let best = window(0.0, 0.5, 0.1, -1.0, 0.0);
        let beside = window(0.9, 1.0, 0.95, -1.0, 0.0);
        let beaten = window(0.2, 0.4, 0.9, -1.0, 3.0);
        let list = [best, beside, beaten];
        assert_eq!(prune::<Neighbours>(&list), list);
        assert_eq!(prune::<AllPairs>(&list), [best, beside]);
    }

    #[test]
    fn equal_windows_survive_each_other_under_every_rule() {
        let w = window(0.2, 0.4, 0.9, -1.0, 1.0);
        let noisy = Window {
            px: w.px + 2e-16,
            ..w
        };
        for list in [[w, w], [w, noisy], [noisy, w]] {
            assert_eq!(prune::<Neighbours>(&list), list);
            assert_eq!(prune::<AllPairs>(&list), list);
            assert_eq!(prune::<TrimmedNeighbours>(&list), list);
        }
    }

    #[test]
    fn trimmed_neighbours_meet_at_their_tie_point_in_order() {
        let left = window(0.0, 0.8, 0.0, -1.0, 0.0);
        let right = window(0.2, 1.0, 1.0, -1.0, 0.0);
        for list in [[left, right], [right, left]] {
            let checked = prune::<TrimmedNeighbours>(&list);
            let ends: Vec<_> = checked.iter().map(|w| [w.b0, w.b1]).collect();
            assert_eq!(ends, [[0.0, 0.5], [0.5, 1.0]]);
        }
    }

    #[test]
    fn a_better_window_in_the_middle_parts_the_other_one() {
        let dear = window(0.0, 1.0, 0.5, -1.0, 5.0);
        let cheap = window(0.4, 0.6, 0.5, -0.5, 0.0);
        let checked = prune::<TrimmedNeighbours>(&[dear, cheap]);
        let ends: Vec<_> = checked.iter().map(|w| [w.b0, w.b1]).collect();
        assert_eq!(ends, [[0.0, 0.4], [0.4, 0.6], [0.6, 1.0]]);
    }
}
