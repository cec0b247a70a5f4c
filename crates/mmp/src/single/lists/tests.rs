use proptest::prelude::*;
use proptest::sample::Index;

use super::*;

fn window(number: f64) -> Window {
    Window {
        b0: 0.0,
        b1: 1.0,
        px: number,
        py: -1.0,
        sigma: 0.0,
    }
}

fn store(lists: &mut Lists, i: usize, window: Window, waits: bool) -> ListEntry {
    let (_, waiting, slots) = lists.parts(i);
    slots.store(window, Direction::Forward, waits, waiting)
}

#[derive(Clone, Debug)]
enum Step {
    /// In this list, from this position on, replaces a fraction of the windows by this many
    /// windows.
    Replace(usize, Index, Index, usize, bool),
    Take(Index),
    Forget(usize),
}

fn steps() -> impl Strategy<Value = Vec<Step>> {
    let step = prop_oneof![
        6 => (0..4usize, any::<Index>(), any::<Index>(), 0..4usize, any::<bool>())
            .prop_map(|(i, a, b, n, w)| Step::Replace(i, a, b, n, w)),
        4 => any::<Index>().prop_map(Step::Take),
        1 => (0..4usize).prop_map(Step::Forget),
    ];
    prop::collection::vec(step, 0..200)
}

proptest! {
    /// Compares with a vector for each list, and a queue of all windows stored as waiting.
    #[test]
    fn lists_in_one_array_do_not_disturb_each_other(steps in steps()) {
        let (mut lists, mut model) = (Lists::new(4, 0), vec![Vec::<(Slot, f64)>::new(); 4]);
        let (mut queue, mut serial) = (Vec::<(usize, Slot, f64)>::new(), 0.0);
        for step in steps {
            match step {
                Step::Replace(i, from, part, new, waits) => {
                    let first = from.index(model[i].len() + 1);
                    let old = part.index(model[i].len() - first + 1);
                    for &(slot, _) in &model[i][first..first + old] {
                        let (_, waiting, slots) = lists.parts(i);
                        slots.remove(slot, waiting);
                    }
                    let entries: Vec<ListEntry> = (0..new)
                        .map(|_| {
                            serial += 1.0;
                            store(&mut lists, i, window(serial), waits)
                        })
                        .collect();
                    let number = |entry: &ListEntry| lists.windows()[entry.slot as usize].px;
                    let pieces: Vec<(Slot, f64)> =
                        entries.iter().map(|entry| (entry.slot, number(entry))).collect();
                    if waits {
                        queue.extend(pieces.iter().map(|&(slot, number)| (i, slot, number)));
                    }
                    lists.replace(i, first..first + old, &entries);
                    model[i].splice(first..first + old, pieces);
                }
                Step::Take(at) => {
                    if queue.is_empty() { continue }
                    let (i, slot, number) = queue.swap_remove(at.index(queue.len()));
                    let there = model[i].contains(&(slot, number));
                    match lists.take(i, slot) {
                        Dequeued::Propagate(w, ()) => prop_assert!(there && w.px == number),
                        Dequeued::Stale => prop_assert!(!there),
                        Dequeued::Requeue(_) => prop_assert!(false, "nothing was cut"),
                    }
                }
                Step::Forget(i) => {
                    if !lists.is_waited_for(i) {
                        lists.evict(i);
                        model[i].clear();
                        prop_assert!(lists.is_evicted(i));
                        lists.reopen(i);
                    }
                }
            }
            let mut waiting = 0;
            for (i, held) in model.iter().enumerate() {
                let stored = lists.places(i).iter().map(|p| (p.slot, lists.windows()[p.slot as usize].px));
                prop_assert_eq!(&stored.collect::<Vec<_>>(), held);
                let waits = held.iter().filter(|h| queue.contains(&(i, h.0, h.1))).count();
                prop_assert_eq!(lists.is_waited_for(i), waits > 0);
                waiting += waits;
            }
            prop_assert_eq!(lists.waiting(), waiting);
        }
    }
}

#[test]
fn a_window_that_was_cut_waits_for_its_new_turn() {
    let mut lists = Lists::new(1, 0);
    let near_left = Window {
        px: 0.2,
        ..window(0.0)
    };
    let entry = store(&mut lists, 0, near_left, true);
    lists.replace(0, 0..0, &[entry]);
    let slot = entry.slot;
    let grows = |lists: &mut Lists, b0, b1| lists.slots.cut(slot, b0, b1).1;
    assert!(!grows(&mut lists, 0.0, 0.8), "the nearest point is kept");
    assert!(grows(&mut lists, 0.5, 0.8));
    let Dequeued::Requeue(label) = lists.take(0, slot) else {
        panic!("its distance has grown");
    };
    assert_eq!(label, near_left.distance(0.5));
    assert!(
        matches!(lists.take(0, slot), Dequeued::Propagate(w, ()) if (w.b0, w.b1) == (0.5, 0.8))
    );
    assert!(!grows(&mut lists, 0.6, 0.8), "it does not wait any more");
}

proptest! {
    /// Keys of ends are rounded: of ends that nearly equal the point any number may be left, at any
    /// scale.
    #[test]
    fn none_is_counted_that_does_not_end_before_a_point(
        ends in prop::collection::vec((1..60u32, 0..3u32), 1..60),
        at in (1..60u32, 0..3u32),
        scale in prop_oneof![Just(1.0), Just(1e-150), Just(1e150), 0.1..10.0f64],
    ) {
        let abscissa = |(whole, more): (u32, u32)| scale * (f64::from(whole) + 1e-9 * f64::from(more));
        let mut ends: Vec<f64> = ends.into_iter().map(abscissa).collect();
        ends.sort_by(f64::total_cmp);
        let mut lists = Lists::new(1, 0);
        let entries: Vec<ListEntry> = ends
            .iter()
            .map(|&b1| store(&mut lists, 0, Window { b1, ..window(0.0) }, false))
            .collect();
        lists.replace(0, 0..0, &entries);
        for x in [0.0, abscissa(at)] {
            let certain = ends.iter().filter(|&&b1| b1 < x * (1.0 - 2e-6)).count();
            let before = ends.iter().filter(|&&b1| b1 < x).count();
            let counted = lists.ending_before(0, x);
            prop_assert!(certain <= counted && counted <= before, "{certain} {counted} {before}");
        }
    }
}
