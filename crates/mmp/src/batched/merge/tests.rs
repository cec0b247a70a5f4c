use geobench_window::Count;
use proptest::prelude::*;

use super::*;
use crate::single::insertion::Inserter;
use crate::single::lists::{Direction, Lists};

/// Windows that arrive together, in order or not, on an edge of length 1.
fn runs() -> impl Strategy<Value = Vec<Batch>> {
    let window = (
        0.0..0.9f64,
        0.01..1.0f64,
        -2.0..3.0f64,
        -4.0..0.0f64,
        0.0..2.0f64,
    );
    let window = window.prop_map(|(b0, width, px, py, sigma)| Window {
        b0,
        b1: (b0 + width).min(1.0),
        px,
        py,
        sigma,
    });
    let run = (prop::collection::vec(window, 1..6), any::<bool>());
    let run = run.prop_map(|(mut windows, is_in_order)| {
        if is_in_order {
            windows.sort_by(|v, w| v.b0.total_cmp(&w.b0));
            for k in 1..windows.len() {
                windows[k - 1].b1 = windows[k - 1].b1.min(windows[k].b0);
            }
            windows.retain(|w| w.b0 < w.b1);
        }
        Batch {
            levels: (0..windows.len() as u32).collect(),
            windows,
        }
    });
    prop::collection::vec(run, 1..8)
}

const OF_INTEREST: [Counter; 3] = [Counter::Trimmed, Counter::Filtered, Counter::Reinserted];

fn merge_all(runs: &[Batch], probe: &mut Count) -> (Store, Vec<Merged>, Vec<f64>) {
    let (mut store, mut merger) = (Store::new(1, 0), Merger::default());
    store.clear(true);
    let mut weighed = Vec::new();
    let mut weigh = |label| weighed.push(label);
    let merge = |run| merger.merge(&mut store, 0, run, 1.0, &mut weigh, probe);
    let merged = runs.iter().map(merge).collect();
    (store, merged, weighed)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(2000))]

    /// The stored windows and the counts.
    #[test]
    fn a_run_leaves_what_its_windows_leave_one_by_one(runs in runs()) {
        let mut count = Count::default();
        let (store, merged, _) = merge_all(&runs, &mut count);
        let (mut lists, mut inserter) = (Lists::new(1, 0), Inserter::default());
        let mut expected = [0; 3];
        for (run, merged) in runs.iter().zip(merged) {
            let mut kept = 0;
            for window in &run.windows {
                inserter.insert(&mut lists, 0, window, Direction::Forward, 1.0);
                let is_kept = u64::from(inserter.effects.new_pieces > 0);
                kept += is_kept;
                expected[0] += inserter.effects.trimmed as u64;
                expected[1] += inserter.effects.removed as u64 + 1 - is_kept;
                expected[2] += inserter.effects.outdated as u64;
            }
            prop_assert_eq!(merged.kept, kept);
        }
        let stored: Vec<Window> = store.windows(0).to_vec();
        let places = lists.places(0).iter();
        let inserted: Vec<Window> = places.map(|p| lists.windows()[p.slot as usize]).collect();
        prop_assert_eq!(&stored, &inserted);
        prop_assert_eq!(store.stored(), stored.len());
        let counters = count.counters(&OF_INTEREST);
        prop_assert_eq!(OF_INTEREST.map(|counter| counters.get(counter)), expected.map(Some));
    }

    #[test]
    fn every_window_waits_under_its_least_distance_and_was_weighed_with_it(runs in runs()) {
        let (store, merged, weighed) = merge_all(&runs, &mut Count::default());
        for stored in store.windows(0) {
            let label = stored.min_distance();
            prop_assert!(waits(stored) && weighed.contains(&label));
            prop_assert!(merged.iter().any(|m| m.least <= label));
        }
    }

    /// In the model a level is the place of a window in its run.
    #[test]
    fn every_piece_has_the_level_of_its_window(runs in runs()) {
        let (store, ..) = merge_all(&runs, &mut Count::default());
        for (stored, &level) in store.windows(0).iter().zip(store.levels(0)) {
            let origin = runs.iter().flat_map(|run| run.windows.iter().zip(&run.levels));
            let same = |w: &Window| (w.px, w.py, w.sigma) == (stored.px, stored.py, stored.sigma);
            prop_assert!(origin.into_iter().any(|(w, &l)| same(w) && l == level));
        }
    }
}

/// Children of windows that meet along a ray overlap by as much as rounding has moved the ray. Each
/// of them began a sweep of its own when this was not told from a run that is not in order.
#[test]
fn windows_of_a_run_that_overlap_by_rounding_take_one_sweep() {
    let left = Window {
        b0: 0.0,
        b1: 0.5 + 1e-15,
        px: 0.5,
        py: -1.0,
        sigma: 0.0,
    };
    let right = Window {
        b0: 0.5,
        b1: 1.0,
        sigma: 1e-9,
        ..left
    };
    let run = Batch {
        windows: vec![left, right],
        levels: vec![0, 1],
    };
    let (store, ..) = merge_all(&[run], &mut Count::default());
    let ends: Vec<_> = store.windows(0).iter().map(|w| (w.b0, w.b1)).collect();
    assert_eq!(ends, [(0.0, left.b1), (left.b1, 1.0)]);
}

#[test]
fn a_propagated_window_is_cut_and_does_not_wait() {
    let whole = Window {
        b0: 0.0,
        b1: 1.0,
        px: 0.2,
        py: -1.0,
        sigma: 0.0,
    };
    let nearer = Window {
        b1: 0.5,
        py: -0.5,
        ..whole
    };
    let (mut store, mut merger) = (Store::new(1, 0), Merger::default());
    let mut weighed = Vec::new();
    for window in [whole, nearer] {
        let run = Batch {
            windows: vec![window],
            levels: Vec::new(),
        };
        merger.merge(
            &mut store,
            0,
            &run,
            1.0,
            &mut |label| weighed.push(label),
            &mut (),
        );
        let mut taken = Vec::new();
        let rest = store.take(0, &mut taken, &mut Vec::new(), |_| true);
        assert_eq!((taken, rest), (vec![window], f64::INFINITY));
    }
    assert_eq!(weighed, [whole.min_distance(), nearer.min_distance()]);
    assert_eq!(store.windows(0).len(), 2);
}

/// A part of a window whose nearest point is lost waits under a greater label, unless the window
/// was propagated.
#[test]
fn a_window_that_waits_for_longer_once_it_is_cut_is_weighed_again() {
    let whole = Window {
        b0: 0.0,
        b1: 1.0,
        px: 0.2,
        py: -1.0,
        sigma: 3.0,
    };
    let batch = Batch::default();
    let mut weighed = Vec::new();
    let mut count = Count::default();
    let mut arrivals = BatchArrivals {
        windows: &mut [],
        batch: &batch,
        least: &mut { f64::INFINITY },
        dropped: &mut 0,
        weigh: &mut |label| weighed.push(label),
        probe: &mut count,
    };
    arrivals.cut(&whole, 0.0, 0.8);
    arrivals.cut(&whole, 0.5, 1.0);
    let propagated = Window { py: 1.0, ..whole };
    assert!(!waits(&arrivals.cut(&propagated, 0.5, 1.0)));
    arrivals.split(&propagated, 0.5, 1.0);
    assert_eq!(weighed, [whole.distance(0.5)]);
}
