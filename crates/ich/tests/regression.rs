//! Defects of the CH kinds that were mended, each with a test that is named after what went wrong.

use geobench_ich::{Pch, ich, ich1};
use geobench_mesh::Mesh;

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

/// `l - cx` cancels where the right exit is short: √5 came out as 2.236066470725.
#[test]
fn a_short_right_exit_had_the_wrong_direction() {
    meshes::SHORT_RIGHT_EXIT.check(solvers);
}

/// The denominators of the places on an exit cancel where the source is close to the edge.
#[test]
fn a_source_close_to_a_ray_moved_the_ends_of_windows() {
    meshes::SOURCE_CLOSE_TO_A_RAY.check_relative(solvers);
}

#[test]
fn vertices_on_a_strip_with_flat_faces_were_lost() {
    meshes::STRIP_WITH_FLAT_FACES.check(solvers);
}

/// It stands there by rounding. Moving it made its distance from all other points too short.
#[test]
fn a_source_above_an_exit_was_moved_onto_it() {
    meshes::SOURCE_ABOVE_THE_EXIT.check(solvers);
}

/// Ties did not know the length of the edge, so that a window was shorter than itself.
#[test]
fn windows_wound_around_a_sharp_fan_without_end() {
    meshes::SHARP_FAN.check(solvers);
}

/// A straight line around a tip of the angle θ winds around it π/θ times.
#[test]
fn windows_wound_around_a_needle_pi_over_its_angle_times() {
    meshes::check_needles(solvers);
}

/// Where both σ are equal up to rounding, so are both roots, and neither counted as a tie.
#[test]
fn a_tie_was_lost_where_sources_were_equal_up_to_rounding() {
    meshes::EQUAL_SIGMAS.check(solvers);
}

/// Windows were given up since their root had come nearer, after they had taken the place of equal
/// ones.
#[test]
fn windows_that_had_replaced_others_were_given_up() {
    meshes::ROOT_COME_NEARER.check(solvers);
}
