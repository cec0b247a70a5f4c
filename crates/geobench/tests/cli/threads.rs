//! `--threads`: the parallel algorithms, on as many threads as asked for.

use std::thread::available_parallelism;

use serde_json::{Value, json};

use crate::support::Sandbox;

const MODEL: &str = "gen:torus,faces=3000,bump=0.1,seed=7";

/// Algorithm and threads of every cell.
fn threads(result: &Value) -> Vec<(String, u64)> {
    let cells = result["cells"].as_array().unwrap();
    let threads = |cell: &Value| {
        assert_eq!(cell["status"], "ok", "{cell}");
        let algorithm = cell["algorithm"].as_str().unwrap().to_owned();
        (algorithm, cell["threads"].as_u64().unwrap())
    };
    cells.iter().map(threads).collect()
}

#[test]
fn cells_record_the_number_of_threads() {
    let sandbox = Sandbox::new();
    for place in ["process", "none"] {
        sandbox.succeed(&format!(
            "run {MODEL} --algo mmp,pvtp,pvtp{{threads=1}},pvtp{{threads=3}} --threads 2 --repeat 1 --warmup 0 \
             --quiet --isolate {place} -o r.json"
        ));
        let expected = [
            ("mmp", 1),
            ("pvtp", 2),
            ("pvtp{threads=1}", 1),
            ("pvtp{threads=3}", 3),
        ]
        .map(|(name, n)| (name.to_owned(), n));
        let result = sandbox.json("r.json");
        assert_eq!(threads(&result), expected);
        let plan = &result["plan"]["groups"][0]["algorithms"];
        assert_eq!(plan[1]["parameters"]["threads"], 2);
        assert_eq!(plan[3]["parameters"]["threads"], 3);
    }
}

#[test]
fn one_thread_is_the_default_of_suites() {
    let sandbox = Sandbox::new();
    sandbox.write(
        "suite.toml",
        &format!(
            "algorithms = [\"pvtp\"]\nrepeat = 1\nwarmup = 0\n\
             [[group]]\nname = \"one\"\nmodels = [\"{MODEL}\"]\n\
             [[group]]\nname = \"two\"\nmodels = [\"{MODEL}\"]\nthreads = 2\n"
        ),
    );
    sandbox.succeed("run --config suite.toml --quiet -o r.json");
    let of = |n| ("pvtp".to_owned(), n);
    assert_eq!(threads(&sandbox.json("r.json")), [of(1), of(2)]);
    sandbox.succeed("run --config suite.toml --threads 3 --quiet -o r.json");
    assert_eq!(threads(&sandbox.json("r.json")), [of(3), of(3)]);
    sandbox.write("suite.toml", "threads = 0\n[[group]]\nname = \"a\"\n");
    let message = sandbox.refuse("run --config suite.toml");
    assert!(message.contains("line 1: `threads`"), "{message}");
}

#[test]
fn no_thread_and_no_number_are_refused() {
    let sandbox = Sandbox::with_square();
    for command in [
        "run square.off",
        "verify square.off",
        "distance square.off --source 0 -o d.csv",
    ] {
        for wrong in ["0", "-1", "two", "1.5", "1025", "99999999999999999999"] {
            let outcome = sandbox.call(&format!("{command} --threads {wrong}"));
            assert_eq!(outcome.code, 2, "{command} --threads {wrong}");
            assert!(outcome.stderr.contains("--threads"), "{}", outcome.stderr);
        }
    }
    for wrong in ["0", "1025", "many"] {
        let message = sandbox.refuse(&format!("run square.off --algo pvtp{{threads={wrong}}}"));
        assert!(
            message.contains("a whole number from 1 to 1024 or `default`"),
            "{message}"
        );
    }
}

#[test]
fn more_threads_than_processors_run_and_are_warned_of() {
    let sandbox = Sandbox::new();
    let more = available_parallelism().unwrap().get() + 1;
    let run =
        format!("run {MODEL} --algo pvtp --check none --repeat 1 --warmup 0 -o r.json --threads");
    let outcome = sandbox.call(&format!("{run} {more}"));
    assert_eq!(outcome.code, 0, "{}", outcome.stderr);
    let warning = format!("warning: {more} threads take turns, since this machine has ");
    assert!(outcome.stderr.contains(&warning), "{}", outcome.stderr);
    assert_eq!(sandbox.json("r.json")["cells"][0]["threads"], more);
    // A list of one processor, whichever of them this process may use.
    let cpu = (0..1024)
        .find(|cpu| {
            let probe = format!("run gen:cube,n=1 --algo mmp --quiet --repeat 1 --cpu {cpu}");
            sandbox.call(&probe).code == 0
        })
        .unwrap();
    let outcome = sandbox.call(&format!("{run} 2 --cpu {cpu}"));
    assert_eq!(outcome.code, 0, "{}", outcome.stderr);
    let warning = "warning: 2 threads take turns, since --cpu allows 1 processor\n";
    assert!(outcome.stderr.contains(warning), "{}", outcome.stderr);
    let outcome = sandbox.call(&format!("{run} 1 --cpu {cpu}"));
    assert!(!outcome.stderr.contains("take turns"), "{}", outcome.stderr);
}

#[test]
fn a_journal_of_other_threads_is_not_continued() {
    let sandbox = Sandbox::new();
    let run = format!(
        "run {MODEL} --algo pvtp,mmp --repeat 1 --warmup 0 --quiet --resume j -o r.json --threads"
    );
    sandbox.succeed(&format!("{run} 2"));
    let first = sandbox.read("r.json");
    sandbox.succeed(&format!("{run} 2"));
    let cells = |text: &str| serde_json::from_str::<Value>(text).unwrap()["cells"].clone();
    assert_eq!(cells(&first), cells(&sandbox.read("r.json")));
    let message = sandbox.refuse(&format!("{run} 1"));
    assert!(
        message.contains("parameters.threads` is 2 there and 1 now"),
        "{message}"
    );
}

#[test]
fn parts_on_several_threads_are_merged() {
    let sandbox = Sandbox::new();
    for part in [1, 2] {
        sandbox.succeed(&format!(
            "run {MODEL} gen:cube,n=6 --algo pvtp --threads 2 --repeat 1 --warmup 0 --quiet --shard {part}/2 -o {part}.json"
        ));
    }
    sandbox.succeed("merge 1.json 2.json -o all.json");
    let of = ("pvtp".to_owned(), 2);
    assert_eq!(threads(&sandbox.json("all.json")), [of.clone(), of]);
}

#[test]
fn verify_checks_the_parallel_algorithms_on_threads() {
    let sandbox = Sandbox::new();
    let said = sandbox.succeed(&format!("verify {MODEL} --algo pvtp --threads 2"));
    assert!(said.ends_with("2 of 2 answers agree\n"), "{said}");
}

/// Several threads find the same paths in a different order, so lengths are rounded differently.
#[test]
fn distances_on_threads_are_the_same_but_for_rounding() {
    let sandbox = Sandbox::new();
    let distances = |threads| {
        sandbox.succeed(&format!(
            "distance {MODEL} --source 5,900 --algo pvtp --threads {threads} --quiet -o {threads}.npy"
        ));
        let bytes = std::fs::read(sandbox.path(&format!("{threads}.npy"))).unwrap();
        let (numbers, _) = bytes[128..].as_chunks();
        numbers.iter().copied().map(f64::from_le_bytes).collect()
    };
    let expected: Vec<f64> = distances(1);
    assert!(expected.len() > 900 && expected[5] == 0.0 && expected[900] == 0.0);
    for threads in [2, 3] {
        let found: Vec<f64> = distances(threads);
        assert_eq!(found.len(), expected.len());
        for (v, (d, e)) in found.iter().zip(&expected).enumerate() {
            assert!(
                (d - e).abs() <= 1e-12 * e,
                "{threads} threads: vertex {v} at {d}, not {e}"
            );
        }
    }
    sandbox.succeed(&format!(
        "distance {MODEL} --source 5,900 --threads 4 --quiet -o d.json"
    ));
    assert_eq!(sandbox.json("d.json")["algorithm"], json!("vtp-fast"));
}

#[test]
fn each_source_has_the_same_field_with_any_number_of_threads() {
    let sandbox = Sandbox::new();
    let fields = |options: &str, name: &str| {
        let said = sandbox.succeed(&format!(
            "distance {MODEL} --source 900,5,31 --each -o {name}.npy {options}"
        ));
        let lines: Vec<_> = said.lines().collect();
        let mut place = 0;
        assert_eq!(lines.len(), 3, "{said}");
        [900, 5, 31].map(|source| {
            let file = format!("{name}.s{source}.npy");
            assert!(lines[place].starts_with(&file), "{said}");
            place += 1;
            std::fs::read(sandbox.path(&file)).unwrap()
        })
    };
    for algorithm in ["vtp-fast", "pvtp", "mmp"] {
        let expected = [900, 5, 31].map(|source| {
            sandbox.succeed(&format!(
                "distance {MODEL} --source {source} --algo {algorithm} --quiet -o alone.npy"
            ));
            std::fs::read(sandbox.path("alone.npy")).unwrap()
        });
        assert!(expected[0] != expected[1]);
        for threads in [1, 2, 7] {
            let found = fields(
                &format!("--algo {algorithm} --threads {threads}"),
                &format!("{algorithm}{threads}"),
            );
            assert!(found == expected, "{algorithm} on {threads} threads");
        }
    }
}

#[test]
fn a_field_that_cannot_be_written_is_named_before_the_work() {
    let sandbox = Sandbox::with_square();
    std::fs::create_dir(sandbox.path("d.s2.csv")).unwrap();
    let message = sandbox.refuse("distance square.off --source 0,2 --each --threads 2 -o d.csv");
    assert!(message.contains("d.s2.csv: cannot be written"), "{message}");
    assert!(!sandbox.path("d.s0.csv").exists());
}

#[test]
fn threads_of_distance_change_no_byte() {
    let sandbox = Sandbox::new();
    sandbox.succeed("gen terrain,n=150,seed=1 -o t.obj");
    sandbox.succeed("gen terrain,n=150,seed=1 -o t.ply");
    for model in ["t.obj", "t.ply"] {
        sandbox.succeed(&format!("distance {model} --source 7 -o one.csv"));
        for threads in [2, 5] {
            sandbox.succeed(&format!(
                "distance {model} --source 7 --threads {threads} -o many.csv"
            ));
            assert!(
                sandbox.read("one.csv") == sandbox.read("many.csv"),
                "{model}, {threads} threads"
            );
        }
    }
}
