//! Distances and labels compared with one run for each source.

use geobench_fwp::{BucketOptions, Buckets};
use geobench_mesh::{Mesh, VertexId};
use geobench_oracle::zoo;
use geobench_window::{Counter, Solver, VertexFilter};

use super::{ROUNDING, mesh_of, one_by_one, some_vertices};
use crate::{FieldSolver, LabelledField, Lct11, NO_SOURCE, Removal, WindowVtp, WindowVtpOptions};

/// A complaint about each vertex whose distance or label is wrong.
fn wrong_vertices(field: &LabelledField<'_>, each: &[Vec<f64>]) -> Vec<String> {
    let mut wrong = Vec::new();
    for v in 0..field.mesh().vertex_count() {
        let least = each.iter().fold(f64::INFINITY, |least, d| least.min(d[v]));
        let (d, label) = (field.distances()[v], field.labels()[v]);
        let slack = ROUNDING * least;
        let is_right = if least == f64::INFINITY {
            d == least && label == NO_SOURCE
        } else {
            let own = each.get(label as usize).map_or(f64::INFINITY, |d| d[v]);
            (d - least).abs() <= slack && own - least <= slack
        };
        if !is_right {
            wrong.push(format!("vertex {v}: {d} of {label}, not {least}"));
        }
    }
    wrong
}

const ALL_OPTIONS: [WindowVtpOptions; 4] = [
    WindowVtpOptions {
        removal: Removal::Continuous,
        filter: VertexFilter::Off,
    },
    WindowVtpOptions {
        removal: Removal::Off,
        filter: VertexFilter::Off,
    },
    WindowVtpOptions {
        removal: Removal::Continuous,
        filter: VertexFilter::On,
    },
    WindowVtpOptions {
        removal: Removal::Periodic { c: 0.1 },
        filter: VertexFilter::Off,
    },
];

fn check(name: &str, mesh: &Mesh, sources: &[VertexId]) {
    let each = one_by_one(mesh, sources);
    for options in ALL_OPTIONS {
        let mut solver = WindowVtp::with_options(mesh, options);
        // Twice: no state of the first run may affect the second.
        for _ in 0..2 {
            let field = solver.field(sources).unwrap();
            let wrong = wrong_vertices(&field, &each);
            assert!(
                wrong.is_empty(),
                "{name}, {options:?}, {sources:?}: {wrong:?}"
            );
        }
    }
    let mut lct11 = Lct11::new(mesh);
    let wrong = wrong_vertices(&lct11.field(sources).unwrap(), &each);
    assert!(wrong.is_empty(), "{name}, lct11, {sources:?}: {wrong:?}");
    let buckets = Buckets::new(mesh, BucketOptions::default());
    let mut lct11 = Lct11::in_order(mesh, buckets, VertexFilter::Off);
    let wrong = wrong_vertices(&lct11.field(sources).unwrap(), &each);
    assert!(
        wrong.is_empty(),
        "{name}, lct11 in buckets, {sources:?}: {wrong:?}"
    );
}

#[test]
fn labels_and_distances_are_those_of_one_run_for_each_source() {
    for (i, model) in (0..).zip(zoo::small()) {
        let mesh = mesh_of(&model);
        for count in [1, 2, 5, 30] {
            check(&model.name, &mesh, &some_vertices(&mesh, count, i));
        }
    }
}

#[test]
fn a_source_given_twice_has_one_cell() {
    let mesh = Mesh::generate("torus,faces=200").unwrap();
    let sources = [3, 50, 3].map(VertexId::new);
    let mut solver = WindowVtp::new(&mesh);
    let field = solver.field(&sources).unwrap();
    assert!(field.labels().iter().all(|&label| label < 2));
    assert_eq!(field.labels()[3], 0);
}

#[test]
fn sources_are_checked() {
    let mesh = Mesh::generate("cube,n=1").unwrap();
    let mut solver = WindowVtp::new(&mesh);
    assert!(solver.field(&[]).is_err());
    let error = solver.field(&[VertexId::new(99)]).unwrap_err();
    assert!(error.to_string().contains("99"), "{error}");
    assert!(solver.field(&[VertexId::new(0)]).is_ok());
}

#[test]
fn from_one_source_on_a_closed_surface_nothing_stays() {
    let mesh = Mesh::generate("torus,faces=2000").unwrap();
    let (_, counters) = WindowVtp::new(&mesh).count(&[VertexId::new(7)]).unwrap();
    assert_eq!(counters.get(Counter::StoredWindows), Some(0));
    let (_, all) = Lct11::new(&mesh).count(&[VertexId::new(7)]).unwrap();
    let stored = all.get(Counter::StoredWindows).unwrap();
    assert!(stored > 10_000, "{stored}");
    assert!(counters.get(Counter::PeakWindows).unwrap() < stored / 2);
}

#[test]
fn both_checks_leave_the_same_windows() {
    let mesh = Mesh::generate("torus,faces=5000,bump=0.1,seed=3").unwrap();
    let sources = some_vertices(&mesh, 10, 1);
    let count = |removal| {
        let options = WindowVtpOptions {
            removal,
            ..WindowVtpOptions::default()
        };
        let mut solver = WindowVtp::with_options(&mesh, options);
        let (_, counters) = solver.count(&sources).unwrap();
        let get = |counter| counters.get(counter).unwrap();
        [get(Counter::StoredWindows), get(Counter::PeakWindows)]
    };
    let [often, rare, none] = [
        Removal::Continuous,
        Removal::Periodic { c: 1.0 },
        Removal::Off,
    ]
    .map(count);
    assert!(
        often[1] < rare[1] && rare[1] < none[1],
        "{often:?} {rare:?} {none:?}"
    );
    // A few late windows are stored before the rare check closes their edge.
    assert!(
        often[0] <= rare[0] && rare[0] < often[0] + often[0] / 20,
        "{often:?} {rare:?}"
    );
    assert!(3 * often[0] < none[0], "{often:?} {none:?}");
}
