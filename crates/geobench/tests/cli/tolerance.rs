//! The rule of right distances, in `run` and `verify`: within 1e-9 of the distance and 1e-13 of the
//! scale of the reference's field.

use crate::support::Sandbox;

/// A unit square with vertex 4 beside vertex 0, at 1e-10.
const NEAR: &str = "OFF\n5 4 0\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n1e-10 1e-10 0\n\
     3 0 1 4\n3 1 2 4\n3 2 3 4\n3 3 0 4\n";

/// An algorithm whose distance of vertex 4 of [`NEAR`] is too long by this share.
fn off_by(share: &str) -> String {
    format!("test-wrong{{vertex=4,share={share}}}")
}

fn sandbox() -> Sandbox {
    let sandbox = Sandbox::new();
    sandbox.write("near.off", NEAR);
    sandbox
}

#[test]
fn rounding_of_the_field_is_no_error_at_any_tolerance() {
    let sandbox = sandbox();
    for goal in [
        "",
        "--target 4",
        "--target 4,1",
        "--radius 1e-9",
        "--radius 0.5",
    ] {
        // 1.4e-14 and 1.4e-12 are 1e-4 and 1e-2 of the distance.
        for (share, code) in [("0.0001", 0), ("0.01", 1)] {
            let algorithm = off_by(share);
            let verify = format!("verify near.off --algo {algorithm} --quiet {goal}");
            let outcome = sandbox.call(&verify);
            assert_eq!(outcome.code, code, "{verify}: {}", outcome.stdout);
            let run = format!(
                "run near.off --algo mmp,{algorithm} --check mmp --repeat 1 --warmup 0 --quiet \
                 -o r.json {goal}"
            );
            let outcome = sandbox.call(&run);
            assert_eq!(outcome.code, code, "{run}: {}", outcome.stderr);
            let cell = &sandbox.json("r.json")["cells"][1];
            let status = if code == 0 { "ok" } else { "wrong" };
            assert_eq!(cell["status"], status, "{cell}");
            assert_eq!(cell["check"]["cluster"], code);
        }
    }
}

#[test]
fn stored_distances_have_the_scale_of_all_that_the_file_has() {
    let sandbox = sandbox();
    sandbox.write(
        "near.s0.csv",
        "0,0\n1,1\n2,1.4142135623730951\n3,1\n4,1.4142135623730951e-10\n",
    );
    for goal in ["", "--target 4", "--radius 1e-9"] {
        for (share, code) in [("0.0001", 0), ("0.01", 1)] {
            let algorithm = off_by(share);
            let run = format!(
                "run near.off --algo {algorithm} --check file --repeat 1 --warmup 0 --quiet {goal}"
            );
            let outcome = sandbox.call(&run);
            assert_eq!(outcome.code, code, "{run}: {}", outcome.stderr);
        }
    }
    sandbox.succeed(&format!(
        "verify near.off --algo {} --quiet",
        off_by("0.0001")
    ));
}

#[test]
fn the_tolerance_replaces_the_relative_part() {
    let sandbox = sandbox();
    let algorithm = off_by("0.01");
    let verify = format!("verify near.off --algo {algorithm} --quiet --tolerance");
    assert_eq!(sandbox.call(&format!("{verify} 0.005")).code, 1);
    sandbox.succeed(&format!("{verify} 0.02"));
    // Rounding stays.
    let algorithm = off_by("0.0001");
    sandbox.succeed(&format!(
        "verify near.off --algo {algorithm} --quiet --tolerance 0"
    ));
}

/// A distant component, or a single distant vertex, once excused any error near the source.
#[test]
fn a_large_component_does_not_widen_the_tolerance() {
    let sandbox = Sandbox::new();
    let shifted = |by: usize| format!("3 {} {} {}\n", by, by + 1, by + 2);
    // A component of size 1 and one of size 1e6, with a source in each.
    let large = "1e7 0 0\n1.1e7 0 0\n1e7 1e6 0\n";
    let small = NEAR.strip_prefix("OFF\n5 4 0\n").unwrap();
    let (positions, faces) = small.split_once("3 0 1 4").unwrap();
    sandbox.write(
        "two.off",
        &format!("OFF\n8 5 0\n{positions}{large}3 0 1 4{faces}{}", shifted(5)),
    );
    let algorithm = off_by("0.01");
    for (source, goal) in [("0,5", ""), ("0,5", "--target 4"), ("5,0", "--radius 0.5")] {
        let run = format!(
            "run two.off --algo mmp,{algorithm} --check mmp --repeat 1 --warmup 0 --quiet \
             --source {source} --sources-together {goal}"
        );
        let outcome = sandbox.call(&run);
        assert_eq!(outcome.code, 1, "{run}: {}", outcome.stderr);
        let right = run.replace("share=0.01", "share=0.0001");
        sandbox.succeed(&right);
    }
    // One vertex at 1e6.
    sandbox.write(
        "far.off",
        &NEAR
            .replace("5 4 0", "6 5 0")
            .replace("3 0 1 4", "1e6 0.5 0\n3 2 1 5\n3 0 1 4"),
    );
    let verify = |share| sandbox.call(&format!("verify far.off --quiet --algo {}", off_by(share)));
    // 1e-13 of a hundred medians are 1e-11, and of the greatest distance 1e-7.
    assert_eq!(verify("0.05").code, 0);
    assert_eq!(verify("0.5").code, 1);
}
