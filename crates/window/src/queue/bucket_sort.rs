//! Sorting of a few events whose labels are spread about evenly over a range.

use super::Event;
use super::calendar::INTEGERS;

/// The most events that are sorted by bins.
const MOST: usize = 255;

/// Whether `a` comes before `b`: by its label, and of equal labels by its event.
#[inline]
pub(super) fn is_before(a: (f64, Event), b: (f64, Event)) -> bool {
    a.0 < b.0 || a.0 == b.0 && a.1 < b.1
}

/// Appends `events` to `sorted` in the order of [`is_before`].
///
/// `place` gives the position of a label within the range, from 0 to 1 up to rounding, and must not
/// decrease. As many bins as events bring them nearly in order. Insertion does the rest, and nearly
/// all of its branches are predictable. A comparison sort mispredicts half of its branches.
///
/// # Cost
///
/// O(k) for k evenly spread events; O(k log k) for more than 255; O(k²) for up to 255 that are not
/// spread.
pub(super) fn append_in_order(
    sorted: &mut Vec<(f64, Event)>,
    events: &mut [(f64, Event)],
    place: impl Fn(f64) -> f64,
) {
    if events.len() > MOST {
        // Labels are not negative, so their bits have the same order.
        events.sort_unstable_by_key(|&(label, event)| (label.to_bits(), event));
        sorted.extend_from_slice(events);
        return;
    }
    let (scale, last) = (events.len() as f64, events.len() as u8);
    let (mut bins, mut ends) = ([0; MOST], [0; MOST + 1]);
    for (bin, &(label, _)) in bins.iter_mut().zip(&*events) {
        // A label outside the range may fall into any bin.
        *bin = ((place(label) * scale + INTEGERS).to_bits() as u8).min(last);
        ends[usize::from(*bin)] += 1u8;
    }
    let mut end = 0;
    for count in &mut ends[..=usize::from(last)] {
        (*count, end) = (end, end + *count);
    }
    let before = sorted.len();
    sorted.extend_from_slice(events);
    let placed = &mut sorted[before..];
    for (&bin, &event) in bins.iter().zip(&*events) {
        let next = &mut ends[usize::from(bin)];
        placed[usize::from(*next)] = event;
        *next += 1;
    }
    insert_one_by_one(placed);
}

/// Sorts events that are nearly in order.
fn insert_one_by_one(events: &mut [(f64, Event)]) {
    for i in 1..events.len() {
        let event = events[i];
        let mut place = i;
        while place > 0 && is_before(event, events[place - 1]) {
            events[place] = events[place - 1];
            place -= 1;
        }
        events[place] = event;
    }
}

#[cfg(test)]
mod tests {
    use geobench_mesh::HalfEdgeId;
    use proptest::prelude::*;

    use super::*;

    fn events(labels: &[f64]) -> Vec<(f64, Event)> {
        let numbered = labels.iter().zip(0..);
        let event = |(&label, id)| (label, Event::window(HalfEdgeId::new(0), id));
        numbered.map(event).collect()
    }

    proptest! {
        #[test]
        fn equal_labels_are_sorted_by_their_events(
            labels in prop::collection::vec(prop_oneof![0.0..1.0f64, Just(0.5), 0.0..1e-9f64], 0..300),
            first in 0.0..0.5f64, scale in prop_oneof![Just(1.0), Just(0.0), Just(1e-9), Just(1e30), Just(f64::NAN)],
        ) {
            let mut given = events(&labels);
            let mut expected = given.clone();
            expected.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
            given.rotate_left(labels.len() / 2);
            let mut sorted = events(&[7.0]);
            append_in_order(&mut sorted, &mut given, |label| (label - first) * scale);
            prop_assert_eq!(&sorted[1..], &expected[..]);
            prop_assert_eq!(sorted[0].0, 7.0, "what was there stays");
        }
    }
}
