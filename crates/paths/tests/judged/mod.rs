//! The paths of every solver, judged by the oracle.

#![allow(dead_code)] // Each test program uses a part of it.

use geobench_fwp::{
    BucketOptions, LabelCorrectingOptions, fwp_ch, fwp_mmp, fwp_mmp_batched, lc_ch, vtp_ch,
    vtp_mmp_batched,
};
use geobench_ich::{ch, ich};
use geobench_mesh::{Mesh, VertexId};
use geobench_mmp::{mmp, mmp_edge, mmp_fast};
use geobench_paths::Paths;
use geobench_vtp::{EdgeBased, Ftp, Opvtp, Pvtp, Vtp, VtpExhaustive, VtpFast, VtpTrimming};
use geobench_window::{Goal, SolveError, Solver, precision};

#[path = "../../../oracle/tests/support/mesh.rs"]
pub(crate) mod oracle_mesh;
pub(crate) mod path;

pub(crate) use path::{judge, surface};

pub(crate) fn solvers(mesh: &Mesh) -> Vec<(&'static str, Box<dyn Solver>)> {
    let mut all: Vec<(&'static str, Box<dyn Solver>)> = vec![
        ("mmp", Box::new(mmp(mesh))),
        ("mmp-fast", Box::new(mmp_fast(mesh))),
        ("mmp-edge", Box::new(mmp_edge(mesh))),
        ("ich", Box::new(ich(mesh))),
        ("fwp-mmp", Box::new(fwp_mmp(mesh, BucketOptions::default()))),
        (
            "fwp-mmp by list",
            Box::new(fwp_mmp_batched(mesh, BucketOptions::default())),
        ),
        ("fwp-ch", Box::new(fwp_ch(mesh, BucketOptions::default()))),
        (
            "lc-ch",
            Box::new(lc_ch(mesh, LabelCorrectingOptions::default())),
        ),
        ("vtp-mmp", Box::new(vtp_mmp_batched(mesh))),
        ("vtp-ch", Box::new(vtp_ch(mesh))),
        ("ftp", Box::new(Ftp::new(mesh))),
        ("vtp", Box::new(Vtp::new(mesh))),
        ("opvtp", Box::new(Opvtp::new(mesh))),
        ("vtp-exhaustive", Box::new(VtpExhaustive::new(mesh))),
        ("vtp-trimming", Box::new(VtpTrimming::new(mesh))),
        ("edge-based", Box::new(EdgeBased::new(mesh))),
        ("vtp-fast", Box::new(VtpFast::new(mesh))),
        ("pvtp", Box::new(Pvtp::new(mesh, 2))),
    ];
    // Its windows may grow exponentially with the faces that they can go around.
    if mesh.face_count() <= 40 {
        all.push(("ch", Box::new(ch(mesh))));
    }
    all
}

/// Judges the paths of every solver from `sources` to all vertices, unless distances are in doubt.
/// Appends a message to `failures` for each wrong path.
pub(crate) fn check(name: &str, mesh: &Mesh, sources: &[u32], failures: &mut Vec<String>) {
    let surface = surface(mesh);
    let kept = |v: u32| mesh.kept_vertex(VertexId::new(v));
    let starts: Vec<u32> = sources.iter().map(|&v| kept(v).raw()).collect();
    for (algorithm, mut solver) in solvers(mesh) {
        let found = Paths::find(solver.as_mut(), mesh, sources, &Goal::everything());
        let refusal = SolveError::at_junctions(mesh);
        if refusal.is_some() && found.as_ref().err() == refusal.as_ref() {
            continue;
        }
        let paths = found.unwrap();
        if precision::doubt(mesh, paths.distances()).is_some() {
            continue;
        }
        for v in mesh.vertices() {
            let d = paths.distances()[v.index()];
            let flaw = match paths.to(v) {
                Ok(Some(path)) => {
                    let judged = judge(&surface, &path, &starts, kept(v.raw()), d);
                    judged.err().map(|flaw| flaw.to_string())
                }
                Ok(None) => (d < f64::INFINITY).then(|| "there is none".to_owned()),
                Err(lost) => Some(lost.to_string()),
            };
            let at = || format!("{name}, {algorithm}, from {sources:?} to {v} at {d}");
            failures.extend(flaw.map(|flaw| format!("{}: {flaw}", at())));
        }
    }
}

/// Fails with at most three of the `failures` of each mesh, if there are any.
pub(crate) fn report(failures: &[String]) {
    let mut of_mesh = ("", 0);
    let first = failures.iter().filter(|line| {
        let mesh = line.split(", from").next().unwrap_or_default();
        of_mesh = if of_mesh.0 == mesh {
            (mesh, of_mesh.1 + 1)
        } else {
            (mesh, 0)
        };
        of_mesh.1 < 3
    });
    let lines: Vec<&str> = first.take(60).map(String::as_str).collect();
    assert!(
        failures.is_empty(),
        "{} failures:\n  {}",
        failures.len(),
        lines.join("\n  ")
    );
}
