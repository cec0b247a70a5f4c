//! Fixed defects of the MMP kinds, each as a test named after what went wrong.

use geobench_mesh::{HalfEdgeId, Mesh, VertexId};
use geobench_mmp::{mmp, mmp_batched, mmp_edge, mmp_fast};
use geobench_window::{Counter, Solver, VertexFilter};

#[macro_use]
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

regression_tests! {
    solvers:
    a_short_right_exit_had_the_wrong_direction
    vertices_on_a_strip_of_five_narrow_faces_were_lost
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
    a_path_past_a_tip_was_shorter_than_the_distance_of_the_tip
}

/// The denominators of the positions on an exit cancel where the source is close to the edge.
#[test]
fn a_source_close_to_a_ray_moved_the_ends_of_windows() {
    meshes::data::SOURCE_CLOSE_TO_A_RAY.check_relative(of_half_edges);
    meshes::data::SOURCE_CLOSE_TO_A_RAY.check(solvers);
}

/// Three units in the last place of the edge, between two windows of the source.
#[test]
fn a_gap_beside_a_near_source_grew_behind_a_face_of_no_area() {
    meshes::data::A_SOURCE_BESIDE_A_LONG_EDGE.check(solvers);
}

#[test]
fn one_very_long_edge_kept_all_windows_in_memory() {
    let mesh = Mesh::generate("terrain,n=40,seed=1").unwrap();
    let peak = |mesh: &Mesh| {
        let (_, counters) = mmp_fast(mesh).count(&[VertexId::new(0)]).unwrap();
        counters.get(Counter::PeakWindows).unwrap()
    };
    // A face at the source with a corner far away.
    let is_boundary = |h: &HalfEdgeId| mesh.twin(*h).is_none();
    let border = mesh
        .outgoing(VertexId::new(0))
        .iter()
        .copied()
        .find(is_boundary);
    let (tail, head) = border.map(|h| (mesh.tail(h), mesh.head(h))).unwrap();
    let mut positions = mesh.positions().to_vec();
    let mut triangles: Vec<[u32; 3]> = mesh
        .faces()
        .map(|face| mesh.face_vertices(face).map(VertexId::raw))
        .collect();
    triangles.push([head.raw(), tail.raw(), positions.len() as u32]);
    positions.push([-1e3, -1e3, 0.0]);
    let longer = Mesh::new(positions, triangles).unwrap();
    let [before, after] = [&mesh, &longer].map(peak);
    assert!(after < before + before / 4, "{before} {after}");
}
