//! Regression tests for fixed defects of the Voronoi algorithms. Each test is named after what went
//! wrong.

use geobench_fwp::{BucketOptions, Buckets};
use geobench_mesh::Mesh;
use geobench_voronoi::{Lct11, Removal, WindowVtp, WindowVtpOptions};
use geobench_window::VertexFilter;
use geobench_window::queue::CalendarQueue;

#[macro_use]
#[path = "../../window/tests/meshes/mod.rs"]
mod meshes;
#[path = "../../window/tests/meshes/seeds.rs"]
mod seeds;

use seeds::Solvers;

fn solvers(mesh: &Mesh) -> Solvers {
    let (on, off) = (VertexFilter::On, VertexFilter::Off);
    let window_vtp = |removal, filter| {
        let options = WindowVtpOptions { removal, filter };
        Box::new(WindowVtp::with_options(mesh, options))
    };
    let lct11 = |filter| Box::new(Lct11::in_order(mesh, CalendarQueue::new(mesh), filter));
    let buckets = Buckets::new(mesh, BucketOptions::default());
    vec![
        ("window-vtp", window_vtp(Removal::Continuous, off)),
        ("window-vtp, filtered", window_vtp(Removal::Continuous, on)),
        ("window-vtp, all kept", window_vtp(Removal::Off, off)),
        ("xls14", window_vtp(Removal::Periodic { c: 1.0 }, off)),
        ("lct11", lct11(off)),
        ("lct11, filtered", lct11(on)),
        (
            "lct11 in buckets",
            Box::new(Lct11::in_order(mesh, buckets, off)),
        ),
    ]
}

/// Beside its foot, the window of a source on an edge won ties against windows of other sources.
/// Its own rays end there, but theirs go on at an angle.
#[test]
fn grazing_rays_of_a_source_on_an_edge_took_the_place_of_others() {
    seeds::check(93003, 5_780, solvers);
}

/// Windows in the traversed area crossed in first-in, first-out order.
#[test]
fn window_vtp_wound_around_needles() {
    for (seed, most) in [
        (14312, 4_500),
        (27812, 2_750),
        (53262, 2_000),
        (94587, 5_830),
    ] {
        seeds::check(seed, most, solvers);
    }
}

/// The same on meshes where no vertex is the tip of a needle.
#[test]
fn window_vtp_wound_around_collinear_faces_and_caps() {
    for (seed, most) in [(22444, 12_610), (51147, 9_080), (80273, 7_470)] {
        seeds::check(seed, most, solvers);
    }
}

regression_tests! {
    solvers:
    a_path_past_a_tip_was_shorter_than_the_distance_of_the_tip
}
