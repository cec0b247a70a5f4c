//! `--simd`.

use geobench_window::simd::Instructions;
use serde_json::{Value, json};

use crate::support::Sandbox;

/// The cells of a run on a small sphere with `--simd simd`.
fn cells(algorithms: &str, simd: &str, more: &str) -> Vec<Value> {
    let sandbox = Sandbox::new();
    sandbox.succeed(&format!(
        "run gen:sphere,subdiv=3 --algo {algorithms} --simd {simd} --repeat 1 --warmup 0 \
         --check none --quiet -o r.json {more}"
    ));
    sandbox.json("r.json")["cells"].as_array().unwrap().clone()
}

#[test]
fn the_instructions_of_a_run_are_recorded() {
    for (simd, wanted) in [
        ("auto", Instructions::detect()),
        ("avx2", Instructions::Avx2.or_narrower()),
        ("Scalar", Instructions::Scalar),
    ] {
        for cell in cells("mmp,vtp,vtp-fast", simd, "") {
            // In a table `auto` compares algorithms of papers, and not their vector code.
            let wanted = match (simd, &cell["algorithm"]) {
                ("auto", name) if name != "vtp-fast" => Instructions::Scalar,
                _ => wanted,
            };
            assert_eq!(cell["simd"], wanted.to_string(), "{cell}");
        }
    }
    // A parameter can select narrower instructions, but not wider ones.
    let cells = cells("vtp-fast{simd=avx512}", "scalar", "");
    assert_eq!(cells[0]["simd"], "scalar");
    assert_eq!(cells[0]["algorithm"], "vtp-fast{simd=avx512}");
}

#[test]
fn a_suite_names_instructions_for_its_groups() {
    let sandbox = Sandbox::with_square();
    sandbox.write(
        "s.toml",
        "simd = \"scalar\"\nrepeat = 1\nmodels = [\"square.off\"]\nalgorithms = [\"vtp-fast\"]\n\
         [[group]]\nname = \"a\"\n[[group]]\nname = \"b\"\nsimd = \"auto\"\n",
    );
    let simd_of = |options: &str| {
        sandbox.succeed(&format!("run --config s.toml --quiet -o r.json {options}"));
        let result = sandbox.json("r.json");
        let of = |path: &str| result.pointer(path).unwrap().clone();
        [
            of("/cells/0/simd"),
            of("/cells/1/simd"),
            of("/plan/groups/0/simd"),
            of("/plan/groups/1/simd"),
        ]
    };
    let widest = Instructions::detect().to_string();
    assert_eq!(
        simd_of(""),
        [
            json!("scalar"),
            json!(widest),
            json!("scalar"),
            json!("auto")
        ]
    );
    assert_eq!(
        simd_of("--simd scalar"),
        [
            json!("scalar"),
            json!("scalar"),
            json!("scalar"),
            json!("scalar")
        ]
    );
    sandbox.write("s.toml", "simd = \"sse\"\n[[group]]\nname = \"a\"\n");
    let message = sandbox.refuse("run --config s.toml");
    assert!(
        message.contains("line 1: `simd`: `sse` is not one of auto, scalar, avx2 and avx512"),
        "{message}"
    );
}

#[test]
fn every_command_that_solves_takes_instructions() {
    let sandbox = Sandbox::with_square();
    sandbox.succeed("verify square.off --algo vtp,ich --simd scalar");
    sandbox.succeed("distance square.off --source 0 --simd scalar -o scalar.csv");
    sandbox.succeed("distance square.off --source 0 --simd auto -o auto.csv");
    assert_eq!(sandbox.read("scalar.csv"), sandbox.read("auto.csv"));
    let message = sandbox.refuse("run square.off --simd neon");
    assert!(
        message.contains("auto, scalar, avx2 and avx512"),
        "{message}"
    );
}

/// The number of instructions of a solve depends on the SIMD level. Needs Valgrind.
#[test]
fn instructions_reach_the_kernels() {
    if Instructions::Avx2.or_narrower() != Instructions::Avx2 {
        return;
    }
    let algorithms = "vtp,edge-based,ich-fast,vtp-fast";
    let counts = |simd| {
        let cells = cells(algorithms, simd, "--instructions");
        let count = |cell: Value| {
            assert_eq!(cell["instructions_simd"], simd, "{cell}");
            let count = cell["instructions"].as_u64();
            (cell["algorithm"].to_string(), count.unwrap())
        };
        cells.into_iter().map(count).collect::<Vec<_>>()
    };
    for ((name, scalar), (_, vector)) in counts("scalar").into_iter().zip(counts("avx2")) {
        let ratio = scalar as f64 / vector as f64;
        assert!((ratio - 1.0).abs() > 0.01, "{name}: {scalar} {vector}");
    }
}
