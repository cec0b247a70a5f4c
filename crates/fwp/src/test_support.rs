//! Tests of disciplines without an algorithm.

use std::collections::BTreeMap;

use geobench_mesh::{HalfEdgeId, Mesh, TriangleSoup};
use geobench_window::Count;
use geobench_window::queue::{Discipline, Event, EventKind};
use proptest::prelude::*;

/// Two triangles: 4 vertices, 5 edges of lengths 1 and √2.
pub(crate) fn square() -> Mesh {
    let positions = vec![
        [0.0, 0.0, 0.0],
        [1.0, 0.0, 0.0],
        [1.0, 1.0, 0.0],
        [0.0, 1.0, 0.0],
    ];
    let soup = TriangleSoup::new(positions, vec![[0, 1, 2], [0, 2, 3]]);
    Mesh::from_soup(soup)
        .expect("two triangles are a valid mesh")
        .0
}

/// The event of window `id` on half-edge 0.
pub(crate) fn window(id: u32) -> Event {
    Event::window(HalfEdgeId::new(0), id)
}

/// The number of a window's event.
///
/// # Panics
///
/// When it is a vertex's.
pub(crate) fn id_of(event: Event) -> u32 {
    match event.kind() {
        EventKind::Window(_, id) => id,
        EventKind::Vertex(v) => panic!("{v} in a queue of windows"),
    }
}

/// An operation on a queue.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Step {
    Push(f64),
    Pop,
}

/// Pushes of all magnitudes, pops, and runs of equal labels.
pub(crate) fn steps() -> impl Strategy<Value = Vec<Step>> {
    let step = prop_oneof![
        3 => (0.0..10.0f64).prop_map(Step::Push),
        1 => (0u8..4).prop_map(|label| Step::Push(f64::from(label))),
        1 => (-300..300i32).prop_map(|e| Step::Push(10f64.powi(e))),
        4 => Just(Step::Pop),
    ];
    prop::collection::vec(step, 0..300)
}

/// Runs the steps and then empties the queue: every event must come out once, with its label, and
/// the waiting labels be known at any time. The queue is then cleared in the middle of a second
/// run, and a third must be the same as the first.
pub(crate) fn check_queue<Q: Discipline>(
    queue: &mut Q,
    steps: &[Step],
) -> Result<(), TestCaseError> {
    let first = run(queue, steps)?;
    for step in steps {
        if let Step::Push(label) = *step {
            queue.push(label, window(0), &mut ());
        }
    }
    queue.pop(&mut ());
    queue.clear();
    prop_assert_eq!(queue.pop(&mut ()), None);
    queue.clear();
    prop_assert_eq!(run(queue, steps)?, first);
    Ok(())
}

/// The order in which events came.
fn run<Q: Discipline>(queue: &mut Q, steps: &[Step]) -> Result<Vec<u32>, TestCaseError> {
    let (mut waiting, mut order) = (BTreeMap::new(), Vec::new());
    let mut count = Count::default();
    let to_the_end = steps.iter().map(|_| &Step::Pop);
    for (id, &step) in (0u32..).zip(steps.iter().chain(to_the_end)) {
        match step {
            Step::Push(label) => {
                queue.push(label, window(id), &mut count);
                waiting.insert(id, label);
            }
            Step::Pop => match queue.pop(&mut count) {
                Some((label, event)) => {
                    prop_assert_eq!(waiting.remove(&id_of(event)), Some(label));
                    order.push(id_of(event));
                }
                None => prop_assert!(waiting.is_empty()),
            },
        }
        let mut labels: Vec<f64> = queue.events().map(|(label, _)| label).collect();
        labels.sort_by(f64::total_cmp);
        let mut expected: Vec<f64> = waiting.values().copied().collect();
        expected.sort_by(f64::total_cmp);
        prop_assert_eq!(labels, expected);
    }
    prop_assert!(waiting.is_empty());
    Ok(order)
}
