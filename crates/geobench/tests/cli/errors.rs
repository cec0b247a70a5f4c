//! Every wrong input ends with status 2 and one line that says what to do.

use crate::support::{Sandbox, UNUSABLE};

#[test]
fn wrong_usage() {
    let sandbox = Sandbox::with_square();
    for (arguments, message) in [
        (
            "rum",
            "unrecognized subcommand 'rum'; a similar subcommand exists: 'run'; see --help",
        ),
        (
            "run square.off --repeat 0",
            "invalid value '0' for '--repeat <N>': a whole number from 1 to 1000000 is expected; see --help",
        ),
        (
            "run square.off --repeat -3",
            "a whole number from 1 to 1000000",
        ),
        (
            "run square.off --tolerance -1",
            "a number of 0 or more is expected",
        ),
        (
            "run square.off --tolerance nan",
            "a number of 0 or more is expected",
        ),
        (
            "run square.off --algo vtq",
            "there is no algorithm `vtq` (did you mean `vtp`?); known are",
        ),
        (
            "run square.off --algo mmp{k=1}",
            "algorithm `mmp` has no parameter `k`",
        ),
        (
            "run square.off --algo mmp,,ich",
            "an algorithm name is missing",
        ),
        (
            "run square.off --source x",
            "`x` is not a source: give `first`, a vertex number",
        ),
        (
            "run square.off --source -1",
            "`-1` is not a source: give `first`, a vertex number",
        ),
        (
            "run square.off --format yaml",
            "invalid value 'yaml' for '--format <FORMAT>'",
        ),
        (
            "run square.off --check mmpp",
            "'--check <REF>': there is no algorithm `mmpp`",
        ),
        ("run square.off --seed -1", "a whole number from 0 to"),
        (
            "run square.off --min-time 6s --max-time 1s",
            "`min-time` is 6 s and above the 1 s of `max-time`; lower it",
        ),
        (
            "run square.off --wavefront --no-counts",
            "'--wavefront' cannot be used with '--no-counts'",
        ),
        ("run square.off --jobs 0", "a whole number from 1 to 1024"),
        (
            "run square.off --jobs 2 --isolate none",
            "--jobs needs --isolate process",
        ),
        (
            "run square.off --check all",
            "algorithms; name one algorithm",
        ),
        (
            "run square.off --check heat",
            "`heat` is not exact, and no reference therefore",
        ),
        ("run square.off --check no.csv", "--check: no.csv: "),
        (
            "run square.off --color blue",
            "invalid value 'blue' for '--color <WHEN>'",
        ),
        (
            "run square.off --no-such",
            "unexpected argument '--no-such' found; see --help",
        ),
        (
            "distance square.off -o x.csv",
            "required arguments were not provided: <--source <SRC>|--sources <FILE>|--pairs <FILE>|",
        ),
        (
            "distance square.off --source 0 --algo all -o x.csv",
            "name one algorithm",
        ),
        ("info", "required arguments were not provided: <MODEL>..."),
    ] {
        let found = sandbox.refuse(arguments);
        assert!(found.contains(message), "{arguments}: {found}");
    }
}

#[test]
fn without_arguments_there_is_help() {
    let outcome = Sandbox::new().call("");
    assert_eq!(outcome.code, 2);
    assert!(outcome.stderr.contains("Usage: geobench"));
    for command in ["run", "verify", "distance", "info", "gen", "algos"] {
        assert!(
            outcome.stderr.contains(&format!("\n  {command} ")),
            "{command}"
        );
    }
}

#[test]
fn models_that_are_not_there() {
    let sandbox = Sandbox::with_square();
    std::fs::create_dir(sandbox.path("empty")).unwrap();
    sandbox.write("notes.txt", "");
    sandbox.write("square.off.bz2", "");
    for (arguments, message) in [
        (
            "run nope.obj",
            "nope.obj: no such file or directory; give a mesh file",
        ),
        ("verify nope.obj", "nope.obj: no such file or directory"),
        (
            "info square.off nope.obj",
            "nope.obj: no such file or directory",
        ),
        (
            "run empty",
            "empty: no mesh file in this directory or below it; they end in .obj, .ply",
        ),
        (
            "run notes.txt",
            "notes.txt: the ending does not tell a mesh format; use .obj, .ply",
        ),
        (
            "run square.off.bz2",
            "square.off.bz2: it is compressed by bzip2, which is not read; unpack it first (bzip2 -d)",
        ),
        (
            "run gen:spere",
            "gen:spere: unknown model family `spere` (did you mean",
        ),
        (
            "run gen:sphere,sub=2",
            "gen:sphere,sub=2: `sphere` has no key `sub`",
        ),
    ] {
        let found = sandbox.refuse(arguments);
        assert!(found.contains(message), "{arguments}: {found}");
    }
}

#[test]
fn models_that_are_broken() {
    let sandbox = Sandbox::new();
    sandbox.write("fan.off", UNUSABLE);
    sandbox.write("cut.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n");
    sandbox.write("word.obj", "v 0 0 0\nv 1 zero 0\n");
    sandbox.write("index.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 7\n");
    sandbox.write("none.off", "");
    for command in [
        "run --quiet --algo mmp",
        "verify --quiet",
        "distance --source 0 -o x.csv",
    ] {
        for (model, element) in [
            ("fan.off", "vertices 0 and 1: 1.000e99"),
            ("cut.off", "line"),
            ("word.obj", "line 2"),
            ("index.off", "vertex 7"),
            ("none.off", "empty"),
        ] {
            let found = sandbox.refuse(&format!("{command} {model}"));
            assert!(found.starts_with(&format!("{model}: ")), "{found}");
            assert!(found.contains(element), "{element}: {found}");
        }
    }
    assert!(!sandbox.path("x.csv").exists());
}

#[test]
fn a_source_that_does_not_exist() {
    let sandbox = Sandbox::with_square();
    for command in [
        "run --quiet --algo mmp",
        "verify --quiet",
        "distance -o x.csv",
    ] {
        assert_eq!(
            sandbox.refuse(&format!("{command} square.off --source 4")),
            "square.off: source vertex 4 does not exist: the model has 4 vertices, numbered from 0"
        );
        assert_eq!(
            sandbox.refuse(&format!("{command} square.off --source random:5")),
            "square.off: 5 different sources are asked for, but the model has 4 vertices"
        );
    }
}

#[test]
fn an_output_replaced_the_file_it_was_made_from() {
    let sandbox = Sandbox::with_square();
    sandbox.succeed("gen file,path=square.off -o x.obj");
    sandbox.succeed("gen file,path=square.off -o x.ply");
    for result in ["a.json", "b.json"] {
        sandbox.succeed(&format!("run square.off --algo mmp --quiet -o {result}"));
    }
    for command in [
        "distance x.ply --source 0 -o ./x.ply",
        "path x.obj --source 0 --target 2 -o x.obj",
        "isolines x.obj --source 0 --levels 2 -o x.obj",
        "voronoi x.ply --source 0,2 -o x.ply",
        "voronoi x.obj --source 0,2 -o v.ply --dual x.obj",
        "remesh x.ply --sites 4 -o x.ply",
        "compare a.json b.json -o b.json",
    ] {
        let message = sandbox.refuse(command);
        assert!(
            message.contains("would replace a file that is read; name another output"),
            "{command}: {message}"
        );
    }
    sandbox.succeed("distance x.ply --source 0 --each --quiet -o x.ply");
}

#[test]
fn an_empty_variable_as_rules_of_compare_gated_nothing() {
    let sandbox = Sandbox::new();
    let message = sandbox.refuse("compare a.json b.json --fail-on=");
    assert!(message.contains("is not a rule"), "{message}");
}

#[test]
fn a_round_that_was_given_twice_counted_twice() {
    let sandbox = Sandbox::with_square();
    for result in ["a.json", "b.json"] {
        sandbox.succeed(&format!("run square.off --algo mmp --quiet -o {result}"));
    }
    let message = sandbox.refuse("pool a.json b.json a.json -o c.json");
    assert!(message.starts_with("a.json: given twice"), "{message}");
}

#[test]
fn files_that_cannot_be_written_are_found_before_the_work() {
    let sandbox = Sandbox::with_square();
    std::fs::create_dir(sandbox.path("d.json")).unwrap();
    for (file, message) in [
        (
            "no/such/r.json",
            "no/such/r.json: cannot be written: its directory does not exist",
        ),
        ("d.json", "d.json: cannot be written: it is a directory"),
        (
            "r.xml",
            "r.xml: the ending says in which form to write results; use .json, .csv, .md, .tex, .bmf.json or .gab.json",
        ),
        ("r", "r: the ending says in which form"),
        ("r.csv -o ./r.csv", "./r.csv: given twice as output"),
    ] {
        let outcome = sandbox.call(&format!("run square.off -o {file}"));
        assert_eq!(outcome.code, 2);
        assert_eq!(outcome.stdout, "", "nothing has run");
        assert!(outcome.stderr.contains(message), "{}", outcome.stderr);
    }
    // A pipe without a writer would be waited for.
    let found = sandbox.refuse("run square.off --add-to /dev/null");
    assert_eq!(found, "--add-to /dev/null: not a regular file");
    let found = sandbox.refuse("distance square.off --source 0 -o r.xml");
    assert!(
        found.contains("use .csv, .json, .npy, .ply, .vtp or .vtk"),
        "{found}"
    );
    let found = sandbox.refuse("gen sphere -o r.gts");
    assert!(
        found.contains("use .obj, .ply, .off or .stl, each also with .gz"),
        "{found}"
    );
}

#[test]
fn ratios_to_an_algorithm_that_does_not_run_are_not_left_out_in_silence() {
    let sandbox = Sandbox::with_square();
    sandbox.write(
        "s.toml",
        "ratios_to = \"ich\"\n[[group]]\nname = \"a\"\nmodels = [\"square.off\"]\nalgorithms = [\"mmp\"]\n",
    );
    let problem = "no ratios to `ich`, for it is not among the algorithms that run";
    assert_eq!(
        sandbox.refuse("run square.off --algo mmp,vtp --ratios-to ich"),
        format!("{problem}; name it in --algo")
    );
    let outcome = sandbox.call("run --config s.toml --repeat 1");
    assert_eq!(outcome.code, 0);
    let warning = format!("geobench: warning: {problem}\n");
    assert_eq!(outcome.stderr.matches(&warning).count(), 1);
}
