//! Fixed defects of the VTP kinds, each as a test named after what went wrong.

use geobench_mesh::Mesh;
use geobench_vtp::{
    EdgeBased, FastOptions, Ftp, Opftp, Opvtp, Pvtp, Vtp, VtpExhaustive, VtpFast, VtpNoRule1,
    VtpNoRules23, VtpTrimming,
};
use geobench_window::simd::Instructions;

#[macro_use]
#[path = "../../window/tests/meshes/mod.rs"]
mod meshes;
#[path = "../../window/tests/meshes/seeds.rs"]
mod seeds;

use meshes::Solvers;

fn solvers(mesh: &Mesh) -> Solvers {
    let fast = |options| VtpFast::with_options(mesh, options);
    let with = |instructions| FastOptions {
        instructions,
        ..FastOptions::default()
    };
    vec![
        ("vtp", Box::new(Vtp::new(mesh))),
        ("opvtp", Box::new(Opvtp::new(mesh))),
        ("ftp", Box::new(Ftp::new(mesh))),
        ("opftp", Box::new(Opftp::new(mesh))),
        ("vtp-exhaustive", Box::new(VtpExhaustive::new(mesh))),
        ("vtp-trimming", Box::new(VtpTrimming::new(mesh))),
        ("vtp-no-rule1", Box::new(VtpNoRule1::new(mesh))),
        ("vtp-no-rules23", Box::new(VtpNoRules23::new(mesh))),
        ("edge-based", Box::new(EdgeBased::new(mesh))),
        (
            "vtp-fast, scalar",
            Box::new(fast(with(Instructions::Scalar))),
        ),
        ("vtp-fast, avx2", Box::new(fast(with(Instructions::Avx2)))),
        (
            "vtp-fast, avx512",
            Box::new(fast(with(Instructions::Avx512))),
        ),
        ("pvtp", Box::new(Pvtp::new(mesh, 2))),
    ]
}

regression_tests! {
    solvers:
    a_short_right_exit_had_the_wrong_direction
    a_source_close_to_a_ray_moved_the_ends_of_windows
    vertices_on_a_strip_of_thin_faces_were_lost
    vertices_on_narrow_faces_among_others_were_lost
    windows_of_a_thin_strip_were_taken_for_crossing
    windows_beside_slivers_were_deleted
    windows_beside_slivers_and_a_flat_face_were_deleted
    windows_beside_slivers_below_rounding_were_deleted
    a_source_above_an_exit_was_moved_onto_it
    windows_wound_around_a_sharp_fan_without_end
    windows_wound_around_a_needle_pi_over_its_angle_times
    a_tie_was_lost_where_sources_were_equal_up_to_rounding
    a_path_past_a_tip_was_shorter_than_the_distance_of_the_tip
}

/// Rule 1 cut rays of a source at a distance of 3e-12 of the edge.
#[test]
fn rule_1_cut_rays_beside_a_source_near_the_edge() {
    for seed in [10_549, 14_123] {
        seeds::check(seed, u64::MAX, solvers);
    }
}

/// Lists of the traversed area crossed first in, first out: 20,000 times around one needle.
#[test]
fn lists_wound_around_needles_before_those_that_beat_them_had_come() {
    for (seed, most) in [
        (4887, 2_650),
        (14587, 4_370),
        (22444, 12_610),
        (98587, 9_620),
    ] {
        seeds::check(seed, most, solvers);
    }
}

/// Faces had turns by the distance of their far vertex, but windows beside them by their own
/// distance.
#[test]
fn a_window_wound_around_a_needle_before_the_next_face_joined() {
    seeds::check(95587, 4_670, solvers);
}
