//! The papers' threshold for tiny windows, which any algorithm can be given.

use geobench_mesh::Mesh;

use super::{Parameter, Value, Values};

/// The parameter; by default nothing is dropped.
pub(super) const THRESHOLD: Parameter = Parameter::real(
    "threshold",
    1e-6,
    0.0..=1.0,
    "drops windows narrower than this share of the model's longest side, and exactness with them; \
     the papers use 1e-6",
)
.or_words(&["none"])
.with_default(Value::Word("none"));

/// The width that `values` ask for, in the units of `mesh`; 0 for a mesh without positions.
pub(super) fn width(mesh: &Mesh, values: &Values) -> f64 {
    let Some(share) = values.real_or_word(&THRESHOLD) else {
        return 0.0;
    };
    let side = |axis: usize| {
        let along = mesh.positions().iter().map(|p| p[axis]);
        let (least, most) = along.fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), x| {
            (a.min(x), b.max(x))
        });
        most - least
    };
    share * [0, 1, 2].map(side).into_iter().fold(0.0, f64::max)
}

#[cfg(test)]
mod tests {
    use geobench_mesh::{TriangleSoup, VertexId};
    use geobench_window::Solver;

    use super::super::select;
    use super::*;

    fn spot_check(list: &str) -> Vec<f64> {
        let spec = "gen:torus,faces=800,bump=0.1,seed=7";
        let spec: geobench_mesh::generate::Spec = spec.parse().unwrap();
        let soup: TriangleSoup = geobench_mesh::generate::generate(&spec).unwrap();
        let (mesh, _) = Mesh::from_soup(soup).unwrap();
        let mut solver: Box<dyn Solver + '_> = select(list).unwrap()[0].build(&mesh);
        solver.solve(&[VertexId::new(0)]).unwrap().distances
    }

    #[test]
    fn a_coarse_threshold_costs_exactness_and_none_does_not() {
        for name in ["mmp", "ich", "fwp-mmp", "vtp-ch", "vtp", "ftp"] {
            let exact = spot_check(name);
            assert_eq!(
                spot_check(&format!("{name}{{threshold=none}}")),
                exact,
                "{name}"
            );
            assert_eq!(
                spot_check(&format!("{name}{{threshold=0}}")),
                exact,
                "{name}"
            );
            let coarse = spot_check(&format!("{name}{{threshold=0.1}}"));
            let longer = exact.iter().zip(&coarse).filter(|(e, c)| c > e).count();
            assert!(longer > 0, "{name}");
            assert!(
                exact
                    .iter()
                    .zip(&coarse)
                    .all(|(e, c)| *c >= e * (1.0 - 1e-12)),
                "{name}"
            );
        }
    }
}
