//! Defects of the disciplines that were mended, each with a test that is named after what went
//! wrong.

use geobench_fwp::{
    BucketOptions, LabelCorrectingOptions, fwp_ch, fwp_mmp, fwp_mmp_batched, lc_ch, lc_mmp,
    lc_mmp_batched, vtp_ch, vtp_mmp, vtp_mmp_batched,
};
use geobench_mesh::Mesh;

#[macro_use]
#[path = "../../window/tests/meshes/mod.rs"]
mod meshes;

use meshes::Solvers;

fn solvers(mesh: &Mesh) -> Solvers {
    let buckets = BucketOptions::default();
    let labels = LabelCorrectingOptions::default();
    vec![
        ("fwp-mmp", Box::new(fwp_mmp(mesh, buckets))),
        ("fwp-mmp batched", Box::new(fwp_mmp_batched(mesh, buckets))),
        ("fwp-ch", Box::new(fwp_ch(mesh, buckets))),
        ("lc-mmp", Box::new(lc_mmp(mesh, labels))),
        ("lc-mmp batched", Box::new(lc_mmp_batched(mesh, labels))),
        ("lc-ch", Box::new(lc_ch(mesh, labels))),
        ("vtp-mmp", Box::new(vtp_mmp(mesh))),
        ("vtp-mmp batched", Box::new(vtp_mmp_batched(mesh))),
        ("vtp-ch", Box::new(vtp_ch(mesh))),
    ]
}

regression_tests! {
    solvers:
    a_short_right_exit_had_the_wrong_direction
    a_source_close_to_a_ray_moved_the_ends_of_windows
    vertices_on_a_strip_of_five_narrow_faces_were_lost
    vertices_on_a_strip_with_flat_faces_were_lost
    directions_were_lost_beside_one_flat_face
    directions_of_three_sources_were_lost_beside_thin_faces
    directions_were_lost_beside_nearly_flat_faces
    half_a_foot_kept_all_directions
    a_foot_was_lost_on_a_longer_edge
    windows_beside_slivers_and_a_flat_face_were_deleted
    a_source_above_an_exit_was_moved_onto_it
    a_run_out_of_order_forgot_what_it_had_inserted
    windows_wound_around_a_sharp_fan_without_end
    windows_wound_around_a_needle_pi_over_its_angle_times
    a_tie_was_lost_where_sources_were_equal_up_to_rounding
    windows_that_had_replaced_others_were_given_up
}
