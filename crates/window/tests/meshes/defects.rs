//! Defects that the meshes of [`data`](super::data) showed, each as a function named after it.
//!
//! A crate lists the defects of its own solvers in [`regression_tests`].

use geobench_mesh::Mesh;

use super::{Solvers, check_needles, check_spikes, data};

/// Declares a test for each of these functions, with the solvers that the function `solvers` sets
/// up.
macro_rules! regression_tests {
    ($solvers:ident: $($defect:ident)*) => {
        $(
            #[test]
            fn $defect() {
                meshes::defects::$defect($solvers);
            }
        )*
    };
}

/// `l - cx` cancels where the right exit is short: √5 was computed as 2.236066470725.
pub(crate) fn a_short_right_exit_had_the_wrong_direction(solvers: impl Fn(&Mesh) -> Solvers) {
    data::SHORT_RIGHT_EXIT.check(solvers);
}

pub(crate) fn vertices_on_a_strip_of_five_narrow_faces_were_lost(
    solvers: impl Fn(&Mesh) -> Solvers,
) {
    data::NARROW_STRIP_OF_FIVE.check(solvers);
}

/// A window along an edge replaced the only point through which another source sends its rays.
pub(crate) fn directions_were_lost_beside_one_flat_face(solvers: impl Fn(&Mesh) -> Solvers) {
    data::ONE_FLAT_FACE.check(solvers);
}

/// The same defect beside thin faces, none of which is flat.
pub(crate) fn directions_of_three_sources_were_lost_beside_thin_faces(
    solvers: impl Fn(&Mesh) -> Solvers,
) {
    data::THREE_SOURCES_BESIDE_THIN_FACES.check(solvers);
}

/// The same defect beside nearly flat faces.
pub(crate) fn directions_were_lost_beside_nearly_flat_faces(solvers: impl Fn(&Mesh) -> Solvers) {
    data::NEARLY_FLAT_FACES.check(solvers);
}

/// A window with half of a foot, and so half of its directions, prevented the whole foot from being
/// stored.
pub(crate) fn half_a_foot_kept_all_directions(solvers: impl Fn(&Mesh) -> Solvers) {
    data::HALF_A_FOOT.check(solvers);
}

/// The foot of a source was not recognised on the next edge, which is longer.
pub(crate) fn a_foot_was_lost_on_a_longer_edge(solvers: impl Fn(&Mesh) -> Solvers) {
    data::FOOT_ON_A_LONGER_EDGE.check(solvers);
}

/// Rays of all directions cross the face of no area; slivers are beside it.
pub(crate) fn windows_beside_slivers_and_a_flat_face_were_deleted(
    solvers: impl Fn(&Mesh) -> Solvers,
) {
    data::SLIVERS_AND_A_FLAT_FACE.check(solvers);
}

/// The source is there by rounding. Moving it made its distance from all other points too short.
pub(crate) fn a_source_above_an_exit_was_moved_onto_it(solvers: impl Fn(&Mesh) -> Solvers) {
    data::SOURCE_ABOVE_THE_EXIT.check(solvers);
}

/// A window that overlapped the last window but one was not compared with it.
pub(crate) fn a_run_out_of_order_forgot_what_it_had_inserted(solvers: impl Fn(&Mesh) -> Solvers) {
    data::RUN_OUT_OF_ORDER.check(solvers);
}

/// Ties did not consider the length of the edge, so a window was shorter than itself.
pub(crate) fn windows_wound_around_a_sharp_fan_without_end(solvers: impl Fn(&Mesh) -> Solvers) {
    data::SHARP_FAN.check(solvers);
}

/// A straight line around a tip of angle θ winds around it π/θ times.
pub(crate) fn windows_wound_around_a_needle_pi_over_its_angle_times(
    solvers: impl Fn(&Mesh) -> Solvers,
) {
    check_needles(solvers);
}

/// No window beside the spike is longer than another by more than the margin of the filter.
pub(crate) fn windows_beside_a_spike_were_never_told_apart(solvers: impl Fn(&Mesh) -> Solvers) {
    check_spikes(solvers);
}

/// Where both σ are equal up to rounding, both roots are as well, and neither counted as a tie.
pub(crate) fn a_tie_was_lost_where_sources_were_equal_up_to_rounding(
    solvers: impl Fn(&Mesh) -> Solvers,
) {
    data::EQUAL_SIGMAS.check(solvers);
}

/// The denominators of the positions on an exit cancel where the source is close to the edge.
pub(crate) fn a_source_close_to_a_ray_moved_the_ends_of_windows(
    solvers: impl Fn(&Mesh) -> Solvers,
) {
    data::SOURCE_CLOSE_TO_A_RAY.check_relative(solvers);
}

pub(crate) fn vertices_on_a_strip_with_flat_faces_were_lost(solvers: impl Fn(&Mesh) -> Solvers) {
    data::STRIP_WITH_FLAT_FACES.check(solvers);
}

/// Windows were deleted because their root had been reached by a shorter path, after they had
/// replaced equal windows.
pub(crate) fn windows_that_had_replaced_others_were_given_up(solvers: impl Fn(&Mesh) -> Solvers) {
    data::ROOT_COME_NEARER.check(solvers);
}

pub(crate) fn vertices_on_a_strip_of_thin_faces_were_lost(solvers: impl Fn(&Mesh) -> Solvers) {
    data::STRIP_OF_THIN_FACES.check(solvers);
}

pub(crate) fn vertices_on_narrow_faces_among_others_were_lost(solvers: impl Fn(&Mesh) -> Solvers) {
    data::NARROW_FACES_AMONG_OTHERS.check(solvers);
}

/// Rules 2 and 3 used errors of positions relative to these, instead of to the face.
pub(crate) fn windows_of_a_thin_strip_were_taken_for_crossing(solvers: impl Fn(&Mesh) -> Solvers) {
    data::FOUR_THIN_FACES.check(solvers);
}

/// The same defect as on the thin strip, on a larger mesh.
pub(crate) fn windows_beside_slivers_were_deleted(solvers: impl Fn(&Mesh) -> Solvers) {
    data::SLIVERS.check(solvers);
}

/// The same defect on slivers whose height is below rounding.
pub(crate) fn windows_beside_slivers_below_rounding_were_deleted(
    solvers: impl Fn(&Mesh) -> Solvers,
) {
    data::SLIVERS_BELOW_ROUNDING.check(solvers);
}

/// The image of the source is placed to some ulps of the needle's long side.
pub(crate) fn a_path_past_a_tip_was_shorter_than_the_distance_of_the_tip(
    solvers: impl Fn(&Mesh) -> Solvers,
) {
    data::TIP_OF_A_LONG_NEEDLE.check_closely(solvers);
}
