//! Surfaces whose distances are known by formulas: plates, boxes, tetrahedra, tori, cones.
//!
//! Most are symmetric and have integer coordinates. Such surfaces have many ties, flat vertices and
//! vertices in line with each other.

use geobench_oracle::closed_forms::{self, ClosedForm};

use crate::support::{Failures, ROUNDING, caught, exact_runs, mesh_of};

fn check(case: &ClosedForm, failures: &mut Failures) {
    let model = &case.model;
    let mesh = mesh_of(model);
    for mut run in exact_runs(&model.name, &mesh) {
        for &source in &model.sources {
            let Some(found) = caught(failures, || run.distances(&[source])) else {
                continue;
            };
            let known =
                (0..model.vertex_count).filter_map(|v| Some((v, case.distance(source, v as u32)?)));
            failures.compare(|| run.at(&[source]), &found, known, ROUNDING);
        }
    }
}

#[test]
fn distances_match_the_formulas() {
    let mut failures = Failures::default();
    for case in closed_forms::all() {
        let mut of_case = Failures::default();
        let _ = caught(&mut failures, || check(&case, &mut of_case));
        failures.extend(of_case);
    }
    failures.report();
}
