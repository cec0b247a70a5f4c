use geobench_window::continuous::Dequeued;

use super::*;
use proptest::prelude::*;

fn window(b0: f64, b1: f64, px: f64, py: f64, sigma: f64) -> Window {
    Window {
        b0,
        b1,
        px,
        py,
        sigma,
    }
}

fn insert(inserter: &mut Inserter, lists: &mut Lists, new: &Window) {
    inserter.insert(lists, 0, new, Direction::Forward, 1.0);
}

fn insert_all(windows: &[Window]) -> Lists {
    let (mut list, mut inserter) = (Lists::new(1, 0), Inserter::default());
    for w in windows {
        insert(&mut inserter, &mut list, w);
    }
    list
}

fn stored(list: &Lists) -> Vec<Window> {
    let windows = list.places(0).iter();
    windows
        .map(|place| list.windows()[place.slot as usize])
        .collect()
}

fn at(list: &Lists, x: f64) -> Option<f64> {
    let mut windows = stored(list).into_iter();
    let held = windows.find(|w| w.b0 <= x && x <= w.b1);
    held.map(|w| w.distance(x))
}

fn windows() -> impl Strategy<Value = Window> {
    (
        0.0..0.9f64,
        0.01..1.0f64,
        -2.0..3.0f64,
        -4.0..0.0f64,
        0.0..2.0f64,
    )
        .prop_map(|(b0, width, px, py, sigma)| window(b0, (b0 + width).min(1.0), px, py, sigma))
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(1000))]

    #[test]
    fn a_list_is_the_lower_envelope_of_all_that_came(
        windows in prop::collection::vec(windows(), 1..12), x in 0.0..1.0f64,
    ) {
        let list = insert_all(&windows);
        for pair in stored(&list).windows(2) {
            prop_assert!(pair[0].b1 <= pair[1].b0, "{pair:?} overlap");
        }
        let near_an_end = windows.iter().any(|w| (x - w.b0).abs() < 1e-8 || (x - w.b1).abs() < 1e-8);
        prop_assume!(!near_an_end);
        let covering = windows.iter().filter(|w| w.b0 <= x && x <= w.b1);
        let least = covering.map(|w| w.distance(x)).reduce(f64::min);
        match (at(&list, x), least) {
            (Some(held), Some(least)) => prop_assert!((held - least).abs() <= 1e-9 * least),
            (None, None) => {}
            (held, least) => prop_assert!(false, "{held:?} held, {least:?} offered"),
        }
    }

    #[test]
    fn every_window_left_is_in_the_queue_under_its_least_distance(
        windows in prop::collection::vec(windows(), 1..12),
    ) {
        let (mut list, mut inserter) = (Lists::new(1, 0), Inserter::default());
        let mut queue = Vec::new();
        for w in &windows {
            insert(&mut inserter, &mut list, w);
            queue.extend_from_slice(&inserter.effects.to_queue);
        }
        let mut found = 0;
        while let Some(QueueEntry { label, slot, .. }) = queue.pop() {
            match list.take(0, slot) {
                Dequeued::Propagate(w, ()) => {
                    prop_assert_eq!(label, w.min_distance());
                    found += 1;
                }
                Dequeued::Requeue(later) => {
                    prop_assert!(later >= label);
                    queue.push(QueueEntry { label: later, slot, part_of: None });
                }
                Dequeued::Stale => {}
            }
        }
        prop_assert_eq!(found, list.len(0));
    }
}

#[test]
fn the_old_window_wins_a_tie() {
    let w = window(0.0, 1.0, 0.5, -1.0, 0.0);
    let list = insert_all(&[w, w]);
    assert_eq!(list.len(0), 1);
}

#[test]
fn a_window_between_two_ties_splits_the_old_one() {
    let far = window(0.0, 1.0, 0.5, -2.0, 0.0);
    let near = window(0.0, 1.0, 0.5, -0.1, 1.85);
    let list = insert_all(&[far, near]);
    assert_eq!(list.len(0), 3);
    assert_eq!(at(&list, 0.5), Some(near.distance(0.5)));
    assert_eq!(at(&list, 0.0), Some(far.distance(0.0)));
    assert_eq!(at(&list, 1.0), Some(far.distance(1.0)));
}

#[test]
fn a_propagated_window_is_cut_but_not_queued_again() {
    let (mut list, mut inserter) = (Lists::new(1, 0), Inserter::default());
    insert(&mut inserter, &mut list, &window(0.0, 1.0, 0.2, -1.0, 0.0));
    let slot = inserter.effects.to_queue[0].slot;
    assert!(matches!(list.take(0, slot), Dequeued::Propagate(..)));
    insert(&mut inserter, &mut list, &window(0.0, 0.5, 0.2, -0.5, 0.0));
    assert_eq!(
        (
            inserter.effects.new_pieces,
            inserter.effects.trimmed,
            inserter.effects.removed
        ),
        (1, 1, 0)
    );
    assert_eq!(inserter.effects.to_queue.len(), 1);
}

#[test]
fn a_waiting_window_whose_nearest_point_is_lost_waits_for_longer() {
    let (mut list, mut inserter) = (Lists::new(1, 0), Inserter::default());
    insert(&mut inserter, &mut list, &window(0.0, 1.0, 0.2, -1.0, 0.0));
    let first = inserter.effects.to_queue[0];
    insert(&mut inserter, &mut list, &window(0.0, 0.5, 0.2, -0.5, 0.0));
    assert_eq!(
        (inserter.effects.to_queue.len(), inserter.effects.outdated),
        (1, 1)
    );
    let rest = window(0.5, 1.0, 0.2, -1.0, 0.0);
    assert_eq!(
        list.take(0, first.slot),
        Dequeued::Requeue(rest.min_distance())
    );
    assert_eq!(list.take(0, first.slot), Dequeued::Propagate(rest, ()));
}

#[test]
fn both_parts_of_a_waiting_window_wait() {
    let (mut list, mut inserter) = (Lists::new(1, 0), Inserter::default());
    insert(&mut inserter, &mut list, &window(0.0, 1.0, 0.5, -2.0, 0.0));
    let whole = inserter.effects.to_queue[0].slot;
    insert(&mut inserter, &mut list, &window(0.4, 0.6, 0.5, -1.0, 0.0));
    let parts: Vec<_> = inserter
        .effects
        .to_queue
        .iter()
        .map(|e| e.part_of)
        .collect();
    assert_eq!(parts, [None, Some(whole)]);
    assert_eq!((list.len(0), list.waiting()), (3, 3));
    insert(&mut inserter, &mut list, &window(0.0, 1.0, 0.2, -0.1, 0.0));
    assert_eq!((list.len(0), list.waiting()), (1, 1));
}

/// The windows of a source on the edge have zero width there. When they were dropped as slivers,
/// vertices behind flat faces were twice as far.
#[test]
fn a_window_of_a_source_on_the_edge_is_no_sliver_however_narrow() {
    let whole = window(0.0, 1.0, 0.5, -1.0, 1.0);
    let fan = window(0.0, 4e-15, 0.0, -1e-20, 0.0);
    assert_eq!(insert_all(&[whole, fan]).len(0), 2);
    assert_eq!(insert_all(&[fan]).len(0), 1);
}

/// Sources at 0.75 and, through it, at 0.5 are equal left of 0.5. The midpoint of the edge is
/// there, so the first to arrive kept all of the edge, and rays to the right were 5e-2 too long.
/// This happened on an edge with two vertices on it and faces without area between, in all orders
/// but nearest first.
#[test]
fn sources_on_the_edge_are_told_apart_where_they_differ() {
    let far = window(0.0, 1.0, 0.5, -4e-31, 0.25);
    let near = window(0.0, 1.0, 0.75, -4e-31, 0.0);
    for windows in [[far, near], [near, far]] {
        let list = insert_all(&windows);
        assert_eq!(at(&list, 1.0), Some(0.25));
        assert_eq!(at(&list, 0.0), Some(0.75));
    }
}

/// Windows that meet along a ray overlap by rounding. When the slivers of such overlaps were
/// stored, the horse had twice as many windows, and up to 7,000 on an edge.
#[test]
fn overlaps_by_rounding_leave_no_splinters() {
    let left = window(0.0, 0.5 + 1e-15, 0.5, -1.0, 0.0);
    let right = window(0.5, 1.0, 0.5, -1.0, 1e-9);
    let list = insert_all(&[right, left]);
    assert_eq!(list.len(0), 2);
    assert!(stored(&list).iter().all(|w| w.b1 - w.b0 > 0.4));
}

/// A search finds windows up to a millionth, so the first window compared may end before the new
/// one begins. When everything from its end on counted as free, the new window began too far left,
/// and distances on needles were 1e-10 too long.
#[test]
fn a_window_begins_no_further_left_than_it_came() {
    let old = window(0.0, 0.5, 0.2, -1.0, 0.0);
    let new = window(0.5 + 1e-8, 1.0, 0.7, -1.0, 0.0);
    let list = insert_all(&[old, new]);
    assert_eq!(stored(&list), [old, new]);
}
