use proptest::prelude::*;
use proptest::sample::Index;

use super::*;

/// A window whose least distance is `label`.
fn window(number: f64, label: f64) -> Window {
    Window {
        b0: 0.0,
        b1: number,
        px: 0.0,
        py: 0.0,
        sigma: label,
    }
}

/// The number of the window, and its label while it waits.
fn described(stored: &Window) -> (f64, f64) {
    let label = stored.min_distance();
    let label = if waits(stored) { label } else { f64::INFINITY };
    (stored.b1, label)
}

#[derive(Clone, Debug)]
enum Step {
    /// In this list, from this position on, replaces a fraction of the windows by windows with
    /// these labels.
    Replace(usize, Index, Index, Vec<u8>),
    /// Takes the windows due at this label.
    Take(usize, u8),
    Forget(usize),
}

fn steps() -> impl Strategy<Value = Vec<Step>> {
    let labels = prop::collection::vec(0..9u8, 0..4);
    let step = prop_oneof![
        6 => (0..4usize, any::<Index>(), any::<Index>(), labels)
            .prop_map(|(i, from, part, labels)| Step::Replace(i, from, part, labels)),
        3 => (0..4usize, 0..9u8).prop_map(|(i, due)| Step::Take(i, due)),
        1 => (0..4usize).prop_map(Step::Forget),
    ];
    prop::collection::vec(step, 0..200)
}

proptest! {
    /// Compares with a vector of numbers and labels for each list.
    #[test]
    fn taken_and_evicted_windows_are_those_of_a_list(steps in steps(), keeps_levels in any::<bool>()) {
        let (mut store, mut model) = (Store::new(4, 0), vec![Vec::<(f64, f64)>::new(); 4]);
        store.clear(keeps_levels);
        let (mut serial, mut evicted) = (0, 0);
        for step in steps {
            match step {
                Step::Replace(i, from, part, labels) => {
                    let first = from.index(model[i].len() + 1);
                    let old = part.index(model[i].len() - first + 1);
                    let new: Vec<(f64, f64)> = labels
                        .into_iter()
                        .map(|label| {
                            serial += 1;
                            (f64::from(serial), f64::from(label))
                        })
                        .collect();
                    let pieces: Vec<Window> = new
                        .iter()
                        .map(|&(number, label)| waiting(window(number, label)))
                        .collect();
                    let levels: Vec<u32> = (serial - new.len() as u32..serial).map(|n| n + 1).collect();
                    let old = first..first + old;
                    store.replace(i, old.clone(), &pieces);
                    if keeps_levels {
                        store.replace_levels(i, old.clone(), levels);
                    }
                    model[i].splice(old, new);
                }
                Step::Take(i, due) => {
                    let due = f64::from(due);
                    let (mut taken, mut levels) = (Vec::new(), Vec::new());
                    let rest = store.take(i, &mut taken, &mut levels, |label| label <= due);
                    let mut expected = Vec::new();
                    for (number, label) in &mut model[i] {
                        if *label <= due {
                            *label = f64::INFINITY;
                            expected.push(*number);
                        }
                    }
                    let taken: Vec<f64> = taken.iter().map(|w| w.b1).collect();
                    prop_assert_eq!(&taken, &expected);
                    let numbers: Vec<f64> = levels.iter().map(|&level| f64::from(level)).collect();
                    prop_assert_eq!(numbers, if keeps_levels { expected } else { Vec::new() });
                    let left = model[i].iter().map(|m| m.1);
                    prop_assert_eq!(rest, left.fold(f64::INFINITY, f64::min));
                }
                Step::Forget(i) => {
                    store.evict(i);
                    evicted += model[i].len();
                    model[i].clear();
                    prop_assert!(store.is_evicted(i) && !store.is_waited_for(i));
                    store.reopen(i);
                }
            }
            for (i, held) in model.iter().enumerate() {
                let stored: Vec<_> = store.windows(i).iter().map(described).collect();
                prop_assert_eq!(&stored, held);
                if keeps_levels {
                    let levels: Vec<_> = store.levels(i).iter().map(|&l| f64::from(l)).collect();
                    prop_assert_eq!(levels, held.iter().map(|h| h.0).collect::<Vec<_>>());
                }
                let waiting = held.iter().filter(|h| h.1 < f64::INFINITY).count();
                prop_assert_eq!(store.waiting_in(i), waiting);
            }
            let stored = model.iter().map(Vec::len).sum::<usize>();
            prop_assert_eq!(store.stored(), stored);
            prop_assert_eq!(store.stored_in_all(), stored + evicted);
        }
    }
}
