//! Defects of the MMP kinds that were mended, each with a test that is named after what went wrong.

use geobench_mesh::Mesh;
use geobench_mmp::{mmp, mmp_batched, mmp_edge, mmp_fast};
use geobench_window::VertexFilter;

#[path = "../../window/tests/meshes/mod.rs"]
mod meshes;

use meshes::Solvers;

fn solvers(mesh: &Mesh) -> Solvers {
    let mut solvers = of_half_edges(mesh);
    solvers.push(("mmp-edge", Box::new(mmp_edge(mesh))));
    solvers
}

fn of_half_edges(mesh: &Mesh) -> Solvers {
    vec![
        ("mmp", Box::new(mmp(mesh))),
        ("mmp-fast", Box::new(mmp_fast(mesh))),
        (
            "mmp-fast without slack",
            Box::new(mmp_batched(mesh, 0.0).filtering(VertexFilter::On)),
        ),
        (
            "mmp-fast without filter",
            Box::new(mmp_fast(mesh).filtering(VertexFilter::Off)),
        ),
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
    meshes::SOURCE_CLOSE_TO_A_RAY.check_relative(of_half_edges);
    meshes::SOURCE_CLOSE_TO_A_RAY.check(solvers);
}

#[test]
fn vertices_on_a_strip_of_five_narrow_faces_were_lost() {
    meshes::NARROW_STRIP_OF_FIVE.check(solvers);
}

/// A window along an edge took the only point through which another source sends its rays.
#[test]
fn directions_were_lost_beside_one_flat_face() {
    meshes::ONE_FLAT_FACE.check(solvers);
}

/// The same where no face is flat.
#[test]
fn directions_of_three_sources_were_lost_beside_thin_faces() {
    meshes::THREE_SOURCES_BESIDE_THIN_FACES.check(solvers);
}

/// The same where no face is flat.
#[test]
fn directions_were_lost_beside_nearly_flat_faces() {
    meshes::NEARLY_FLAT_FACES.check(solvers);
}

/// The half of a foot, which has half of the directions, kept the whole foot out.
#[test]
fn half_a_foot_kept_all_directions() {
    meshes::HALF_A_FOOT.check(solvers);
}

/// The foot of a source no longer counted as one on the next edge, which is longer.
#[test]
fn a_foot_was_lost_on_a_longer_edge() {
    meshes::FOOT_ON_A_LONGER_EDGE.check(solvers);
}

/// Rays of all directions pass the face of no area; slivers stand beside it.
#[test]
fn windows_beside_slivers_and_a_flat_face_were_deleted() {
    meshes::SLIVERS_AND_A_FLAT_FACE.check(solvers);
}

/// It stands there by rounding. Moving it made its distance from all other points too short.
#[test]
fn a_source_above_an_exit_was_moved_onto_it() {
    meshes::SOURCE_ABOVE_THE_EXIT.check(solvers);
}

/// A window that overlapped one before the last one was not compared with it.
#[test]
fn a_run_out_of_order_forgot_what_it_had_inserted() {
    meshes::RUN_OUT_OF_ORDER.check(solvers);
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
