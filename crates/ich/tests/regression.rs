//! Fixed defects of the CH kinds, each as a test named after what went wrong.

use geobench_ich::{Pch, ich, ich1};
use geobench_mesh::Mesh;

#[macro_use]
#[path = "../../window/tests/meshes/mod.rs"]
mod meshes;

use meshes::Solvers;

fn solvers(mesh: &Mesh) -> Solvers {
    vec![
        ("ich", Box::new(ich(mesh))),
        ("ich1", Box::new(ich1(mesh))),
        ("pch", Box::new(Pch::new(mesh, 2))),
        ("pch by levels", Box::new(Pch::with_bucket(mesh, 1, 1e6))),
    ]
}

regression_tests! {
    solvers:
    a_short_right_exit_had_the_wrong_direction
    a_source_close_to_a_ray_moved_the_ends_of_windows
    vertices_on_a_strip_with_flat_faces_were_lost
    a_source_above_an_exit_was_moved_onto_it
    windows_wound_around_a_sharp_fan_without_end
    windows_wound_around_a_needle_pi_over_its_angle_times
    windows_beside_a_spike_were_never_told_apart
    a_tie_was_lost_where_sources_were_equal_up_to_rounding
    windows_that_had_replaced_others_were_given_up
    a_path_past_a_tip_was_shorter_than_the_distance_of_the_tip
}

#[test]
fn a_source_named_a_hundred_times_cost_a_hundred_times() {
    use geobench_mesh::VertexId;
    let mesh = Mesh::generate("grid,n=6").unwrap();
    for (name, mut solver) in solvers(&mesh) {
        let once = solver.count(&[VertexId::new(3)]).unwrap();
        let often = solver.count(&[VertexId::new(3); 100]).unwrap();
        assert!(once == often, "{name}");
    }
}

/// Windows on a strip of needles crossed faces after shorter ones had taken their places, and so
/// did their descendants: breadth first, `ich1` took 642,344 windows on 200 faces, growing as n³.
#[test]
fn windows_that_had_been_replaced_went_on() {
    meshes::check_strip(200, 200 * 200, solvers);
}

/// One thin face kept all stale windows of the mesh: twice as many in all.
#[test]
fn a_thin_face_kept_stale_windows_everywhere() {
    use geobench_mesh::VertexId;
    use geobench_window::Counter;
    let [with, without] = meshes::terrains_with_and_without_a_sliver().map(|mesh| {
        let count = |(name, mut solver): (&'static str, Box<dyn geobench_window::Solver>)| {
            let (_, counters) = solver.count(&[VertexId::new(0)]).unwrap();
            (name, counters.get(Counter::Propagated).unwrap() as f64)
        };
        solvers(&mesh).into_iter().map(count).collect::<Vec<_>>()
    });
    for ((name, with), (_, without)) in with.into_iter().zip(without) {
        assert!(with <= 1.1 * without, "{name}: {with} instead of {without}");
    }
}
