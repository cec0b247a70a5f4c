use geobench_mesh::generate::generate;
use geobench_mesh::{HalfEdgeId, Mesh};
use proptest::prelude::*;

use super::*;
use crate::crossing::Crossing;
use crate::filter::{is_beaten_across, is_beaten_from_ends};
use crate::frame::{Exit, Side};
use crate::window::tests::windows;

fn terrain() -> Mesh {
    let spec = "gen:terrain,n=8,seed=3".parse().unwrap();
    Mesh::from_soup(generate(&spec).unwrap()).unwrap().0
}

/// A window on the unit edge, on one of another length.
fn stretched(w: &Window, length: f64) -> Window {
    Window {
        b0: w.b0 * length,
        b1: w.b1 * length,
        px: w.px * length,
        py: w.py * length,
        sigma: w.sigma * length,
    }
}

fn close(a: f64, b: f64) -> bool {
    (a - b).abs() <= 1e-9 * a.abs().max(b.abs()).max(1e-3)
}

proptest! {
    #[test]
    fn windows_cross_together_as_they_do_alone(
        all in prop::collection::vec((windows(), 0..1000u32), 1..=LANES),
    ) {
        let mesh = terrain();
        let faces = Faces::new(&mesh);
        let mut together = Crossings::default();
        let mut portable = Crossings::new(Instructions::Scalar);
        let mut entered = Vec::new();
        for (w, h) in &all {
            let h = HalfEdgeId::new(h % mesh.half_edge_count() as u32);
            let window = stretched(w, faces.length(h));
            together.add(h, &window);
            portable.add(h, &window);
            entered.push((h, window));
        }
        together.cross(&faces);
        portable.cross(&faces);
        prop_assert_eq!(&together.leaving, &portable.leaving, "every program computes the same");
        for (lane, (h, window)) in entered.iter().enumerate() {
            let frame = faces.frame(*h);
            let crossing = Crossing::new(&frame, window);
            prop_assert_eq!(together.covers_apex(lane), crossing.covers_apex());
            prop_assert_eq!(together.apex(lane), faces.corners(*h)[2]);
            let exit = faces.exit(*h, &frame, crossing.side());
            if crossing.covers_apex() {
                prop_assert_eq!(together.apex_distance(lane), crossing.straight_distance());
                prop_assert_eq!(together.entry(lane, &faces), crossing.separation() / frame.l);
                check(&together.child(lane), crossing.left_child(&exit), &exit)?;
                let exit = faces.exit(*h, &frame, Side::Right);
                check(&together.right_child(lane, &faces), crossing.right_child(&exit), &exit)?;
            } else {
                prop_assert!(close(together.apex_distance(lane), crossing.bent_distance(&exit)));
                check(&together.child(lane), crossing.only_child(&exit), &exit)?;
            }
        }
    }
}

/// Compares what a window leaves with what it leaves `alone` at that exit.
fn check(together: &CrossedChild, alone: Option<Window>, exit: &Exit) -> Result<(), TestCaseError> {
    let CrossedChild {
        exit_edge,
        window,
        label,
        limits,
    } = *together;
    prop_assert_eq!(exit_edge.half_edge(), exit.half_edge);
    prop_assert_eq!(exit_edge.corners, exit.corners);
    prop_assert_eq!((window.b0 < window.b1).then_some(window), alone);
    let Some(alone) = alone else { return Ok(()) };
    prop_assert_eq!(label, alone.min_distance());
    prop_assert!(!together.is_beaten([f64::INFINITY; 3]));
    // Each of the distances on either side of where it begins to beat the window.
    let end = exit.is_left * alone.b0 + exit.is_right * alone.b1;
    for corner in 0..3 {
        for by in [-1e-6, 1e-6] {
            let mut distances = [f64::INFINITY; 3];
            distances[corner] = limits[corner] + by;
            prop_assert_eq!(together.is_beaten(distances), by < 0.0);
            if distances[corner] > 0.0 {
                let [tail, head, behind] = distances;
                let beaten = is_beaten_from_ends(&alone, exit.length, tail, head)
                    || is_beaten_across(&alone, end, exit.behind, behind);
                prop_assert_eq!(beaten, by < 0.0, "corner {}", corner);
            }
        }
    }
    Ok(())
}

/// The window that a source at the tail of an edge has there is exactly as long as the path along
/// the edge.
#[test]
fn a_tie_beats_nothing() {
    let mesh = terrain();
    let faces = Faces::new(&mesh);
    for h in mesh.half_edges() {
        let frame = faces.frame(h);
        for side in 0..2 {
            let [b0, b1] = [[0.0, 0.25], [0.75, 1.0]][side].map(|x| x * frame.l);
            let px = [0.0, frame.l][side];
            let mut crossings = Crossings::default();
            crossings.add(
                h,
                &Window {
                    b0,
                    b1,
                    px,
                    py: 0.0,
                    sigma: 0.0,
                },
            );
            crossings.cross(&faces);
            if !crossings.covers_apex(0) {
                let at_source = crossings.child(0).exit_edge.corners.map(|v| {
                    if v == faces.corners(h)[side] {
                        0.0
                    } else {
                        f64::INFINITY
                    }
                });
                assert!(!crossings.child(0).is_beaten(at_source), "{h} {side}");
            }
        }
    }
}
