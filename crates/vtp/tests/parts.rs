//! Parts as from a solid modeller: long thin faces beside short ones, holes, fillets. `vtp-fast`
//! once propagated four times the windows of `vtp` on one of them.

use geobench_mesh::{Mesh, Tolerance, TriangleSoup};
use geobench_mmp::mmp_fast;
use geobench_oracle::nasty::Kind;
use geobench_vtp::{Vtp, VtpFast};
use geobench_window::{Counter, Solver};

/// Compares `vtp-fast` from vertex 0 with `vtp` and `mmp-fast`.
fn check(name: &str, mesh: &Mesh) {
    let run = |solver: &mut dyn Solver| {
        let (solution, counters) = solver.count(&[0.into()]).unwrap();
        let windows = counters.get(Counter::Propagated).unwrap();
        (solution.distances, windows)
    };
    let (distances, fast) = run(&mut VtpFast::new(mesh));
    let (_, plain) = run(&mut Vtp::new(mesh));
    let (expected, mmp) = run(&mut mmp_fast(mesh));
    println!("{name}: {fast} windows, vtp {plain}, mmp-fast {mmp}");
    assert!(fast <= 2 * plain, "{name}: {fast} windows, vtp {plain}");
    let rule = Tolerance::on(mesh, &expected);
    for (v, (&d, &right)) in distances.iter().zip(&expected).enumerate() {
        assert!(rule.is_right(v, d, right), "{name}: vertex {v}");
    }
}

#[test]
fn parts_take_at_most_twice_the_windows_of_vtp() {
    for seed in [3, 6, 13, 14, 23, 25, 36, 40, 52, 56] {
        let model = Kind::Part.large_mesh(seed).model;
        let positions = model.positions().unwrap().to_vec();
        let soup = TriangleSoup::new(positions, model.triangles.clone());
        check(&model.name, &Mesh::from_soup(soup).unwrap().0);
    }
}

#[test]
fn shared_parts_take_at_most_twice_the_windows_of_vtp() {
    for name in ["idler_front", "plate_79741"] {
        let path = format!("../../../shared/cases/slow/{name}.stl.gz");
        check(name, &Mesh::read(path).unwrap());
    }
}
