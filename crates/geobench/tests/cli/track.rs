//! A solver of one's own in a fresh repository, as in `docs/track-your-solver.md`: what `geobench
//! init` writes, and the steps of the workflow on a bare remote.

use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};

use crate::support::{PLAIN_GIT, SQUARE, Sandbox};

/// A solver of the square under protocol 1. Its times are what it claims, so that the load of the
/// machine decides no gate.
const CLAIMS: &str = r#"seconds=0.010
echo '{"ready": true}'
while read -r _; do
    printf '0,0\n1,1\n2,1.4142135623730951\n3,1\n' > "$3"
    echo "{\"seconds\": $seconds}"
done
"#;

/// The variables that `scripts/track` reads.
const INPUTS: [&str; 9] = [
    "SUITE", "PROGRAMS", "BUILD", "OPTIONS", "BRANCH", "PATHS", "RULES", "ROUNDS", "RESULT",
];

/// Runs `git` in a directory of the sandbox, and returns its output.
fn git(sandbox: &Sandbox, directory: &str, arguments: &[&str]) -> String {
    let output = Command::new("git")
        .args(["-c", "user.name=t", "-c", "user.email=t@localhost"])
        .args(arguments)
        .current_dir(sandbox.path(directory))
        .envs(PLAIN_GIT)
        .output()
        .unwrap();
    let error = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "git {arguments:?}: {error}");
    String::from_utf8(output.stdout).unwrap().trim().to_owned()
}

/// Starts a step of the action in a directory of the sandbox. Its summary is a file beside it.
fn track(sandbox: &Sandbox, directory: &str, mode: &str, more: &[(&str, &str)]) -> Child {
    let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scripts/track");
    let mut step = Command::new(script);
    for input in INPUTS {
        step.env_remove(input);
    }
    step.arg(mode)
        .current_dir(sandbox.path(directory))
        .env("GEOBENCH", assert_cmd::cargo::cargo_bin("geobench"))
        .env("GITHUB_STEP_SUMMARY", summary(sandbox, directory))
        .envs(PLAIN_GIT)
        // As few as there are for an interval.
        .env("ROUNDS", "6")
        .envs(more.iter().copied())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap()
}

fn summary(sandbox: &Sandbox, directory: &str) -> PathBuf {
    sandbox.path(&format!("{directory}.md"))
}

/// The exit status of a step, and its summary.
fn finished(sandbox: &Sandbox, directory: &str, step: Child) -> (i32, String) {
    let output = step.wait_with_output().unwrap();
    let log = String::from_utf8_lossy(&output.stderr).into_owned();
    let path = summary(sandbox, directory);
    let text = std::fs::read_to_string(&path).unwrap_or_default();
    let _ = std::fs::remove_file(path);
    (output.status.code().unwrap(), text + &log)
}

/// A repository with the files of `geobench init` on a bare remote. Its suite is one sphere.
fn repository() -> Sandbox {
    let sandbox = initialised("gen:sphere,subdiv=4");
    commit(&sandbox, "solver");
    sandbox
}

/// The same with the solver [`CLAIMS`] and the square.
fn repository_of_claims() -> Sandbox {
    let sandbox = initialised("square.off");
    sandbox.write("mine/benchmarks/square.off", SQUARE);
    sandbox.write("mine/benchmarks/solver.sh", CLAIMS);
    let command = "['sh', 'solver.sh', '{model}', '{source}', '{output}']";
    let table = format!("[ext.solver]\ncommand = {command}\n");
    sandbox.write("mine/benchmarks/programs.toml", &table);
    commit(&sandbox, "solver");
    sandbox
}

/// The files of `geobench init` in a directory with a bare remote, with a suite of one model.
fn initialised(model: &str) -> Sandbox {
    let sandbox = Sandbox::new();
    for directory in ["remote", "mine"] {
        std::fs::create_dir(sandbox.path(directory)).unwrap();
    }
    git(&sandbox, "remote", &["init", "-q", "--bare", "-b", "main"]);
    git(&sandbox, "mine", &["init", "-q", "-b", "main"]);
    git(&sandbox, "mine", &["remote", "add", "origin", "../remote"]);
    let mut init = sandbox.command("init");
    let output = init.current_dir(sandbox.path("mine")).output().unwrap();
    assert!(output.status.success());
    let suite = sandbox.read("mine/benchmarks/suite.toml");
    let start = suite.find("models = [").unwrap();
    let short = format!("models = [\"{model}\"]\nalgorithms = [\"ext:solver\"]\n");
    let suite = suite[..start].to_owned() + &short;
    sandbox.write("mine/benchmarks/suite.toml", &suite);
    sandbox
}

/// Commits everything and pushes it.
fn commit(sandbox: &Sandbox, message: &str) {
    git(sandbox, "mine", &["add", "-A"]);
    git(sandbox, "mine", &["commit", "-q", "-m", message]);
    git(sandbox, "mine", &["push", "-q", "origin", "HEAD"]);
}

/// Makes a branch in which `from` is `to` in a file, and merges it, as a pull request is.
fn pull_request(sandbox: &Sandbox, file: &str, from: &str, to: &str) {
    git(sandbox, "mine", &["checkout", "-q", "-B", "change", "main"]);
    let text = sandbox.read(&format!("mine/{file}"));
    assert!(text.contains(from), "{text}");
    sandbox.write(&format!("mine/{file}"), &text.replace(from, to));
    git(sandbox, "mine", &["commit", "-q", "-a", "-m", "change"]);
    git(sandbox, "mine", &["checkout", "-q", "-B", "merged", "main"]);
    let merge = ["merge", "-q", "--no-ff", "-m", "merge", "change"];
    git(sandbox, "mine", &merge);
}

#[test]
fn init_writes_files_that_work_and_replaces_none() {
    let sandbox = Sandbox::new();
    // One folder cannot be made.
    sandbox.write(".github", "a file");
    let message = sandbox.refuse("init");
    assert!(
        message.contains(".github/workflows: cannot be made"),
        "{message}"
    );
    assert!(!sandbox.path("benchmarks/suite.toml").exists());
    std::fs::remove_file(sandbox.path(".github")).unwrap();
    std::fs::remove_dir(sandbox.path("benchmarks")).unwrap();
    let listed = sandbox.succeed("init --list");
    assert_eq!(listed.lines().count(), 4);
    assert!(!listed.contains("exists"), "{listed}");
    assert!(!sandbox.path("benchmarks").exists());
    sandbox.write("benchmarks/solver.py", "mine");
    assert_eq!(
        sandbox.refuse("init"),
        "benchmarks/solver.py exists already; nothing was written (--force replaces, --list shows)"
    );
    assert!(!sandbox.path("benchmarks/suite.toml").exists());
    let listed = sandbox.succeed("init --list --force");
    assert!(listed.contains("solver.py: a solver to be replaced (exists, would be replaced)"));
    assert!(
        sandbox
            .refuse("init --action x")
            .contains("OWNER/REPOSITORY@HASH")
    );
    let said = sandbox.succeed("init --force --action some/geobench@0123abc");
    assert!(said.contains("next:\n  1. geobench run --config"), "{said}");
    let workflow = sandbox.read(".github/workflows/benchmarks.yml");
    assert_eq!(
        workflow.matches("- uses: some/geobench@0123abc\n").count(),
        2
    );
    let run = "run --config benchmarks/suite.toml --ext benchmarks/programs.toml --repeat 1";
    let shown = sandbox.succeed(run);
    assert!(shown.contains("ext:solver (approx.)"), "{shown}");
}

/// GitHub reads workflows in the top directory of a repository only.
#[test]
fn init_says_where_its_workflow_is_not_read() {
    let sandbox = Sandbox::new();
    let note = |directory: &str, arguments: &str| {
        std::fs::create_dir_all(sandbox.path(directory)).unwrap();
        let mut init = sandbox.command(arguments);
        let output = init.current_dir(sandbox.path(directory)).output().unwrap();
        assert!(output.status.success());
        String::from_utf8(output.stderr).unwrap()
    };
    let outside = "geobench: note: the current directory is in no repository";
    for arguments in ["init", "init --list"] {
        let said = note("outside", arguments);
        assert!(said.starts_with(outside), "{said}");
    }
    std::fs::create_dir_all(sandbox.path("mine/.git")).unwrap();
    assert_eq!(note("mine", "init"), "");
    for arguments in ["init", "init --list"] {
        let said = note("mine/sub", arguments);
        assert!(
            said.contains("/mine: GitHub reads no workflow below"),
            "{said}"
        );
    }
    // The top directory of a work tree.
    sandbox.write("mine/tree/.git", "gitdir: elsewhere");
    assert_eq!(note("mine/tree", "init"), "");
}

/// Every action is pinned by the hash of a commit, in our workflows and in those of others.
#[test]
fn actions_are_pinned_and_tokens_may_do_little() {
    let top = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let workflows = std::fs::read_dir(top.join(".github/workflows")).unwrap();
    let mut files: Vec<PathBuf> = workflows.map(|entry| entry.unwrap().path()).collect();
    files.push(top.join("crates/geobench/templates/benchmarks.yml"));
    files.push(top.join("action.yml"));
    for path in files {
        let text = std::fs::read_to_string(&path).unwrap();
        let uses = text.lines().filter_map(|line| line.split_once("uses: "));
        for (_, action) in uses.filter(|(_, action)| !["./", "{action}"].contains(action)) {
            let version = action.split('@').nth(1).unwrap_or_default();
            let hash: String = version
                .chars()
                .take_while(char::is_ascii_hexdigit)
                .collect();
            assert!(
                hash.len() == 40 && action.contains(" # v"),
                "{path:?}: {action}"
            );
        }
        if !path.ends_with("action.yml") {
            assert!(
                text.contains("\npermissions:\n  contents: read\n"),
                "{path:?}"
            );
        }
        // A required check that does not run leaves a pull request pending.
        let requests = text.split_once("\n  pull_request:\n").map(|(_, rest)| rest);
        if let Some(rest) = requests.filter(|_| !path.ends_with("wheels.yml")) {
            assert!(!rest.trim_start().starts_with("paths"), "{path:?}");
        }
    }
}

#[test]
fn pushes_are_recorded_also_at_the_same_time() {
    let sandbox = repository();
    let (status, shown) = {
        let step = track(&sandbox, "mine", "record", &[]);
        finished(&sandbox, "mine", step)
    };
    assert_eq!(status, 0, "{shown}");
    assert!(shown.contains("learning, 0 of 3 base commits"), "{shown}");
    // Two pushes, one after the other, whose jobs run at the same time.
    for name in ["first", "second"] {
        sandbox.write("mine/README", name);
        commit(&sandbox, name);
        git(&sandbox, ".", &["clone", "-q", "remote", name]);
    }
    let steps = ["first", "second"].map(|name| (name, track(&sandbox, name, "record", &[])));
    for (name, step) in steps {
        let (status, shown) = finished(&sandbox, name, step);
        assert_eq!(status, 0, "{shown}");
    }
    let branch = "refs/heads/benchmark-history";
    let files = git(
        &sandbox,
        "remote",
        &["ls-tree", "-r", "--name-only", branch],
    );
    let records = files.lines().filter(|line| line.starts_with("history/"));
    assert_eq!(records.count(), 3, "{files}");
    assert!(
        files.contains("index.html") && files.contains(".nojekyll"),
        "{files}"
    );
    // Nothing is left in the repository.
    assert_eq!(
        git(&sandbox, "mine", &["worktree", "list"]).lines().count(),
        1
    );
    assert_eq!(git(&sandbox, "mine", &["status", "--porcelain"]), "");
    let branches = ["branch", "--format", "%(refname:short)"];
    assert_eq!(git(&sandbox, "mine", &branches), "main");
    let step = track(&sandbox, "mine", "record", &[("BUILD", "exit 1")]);
    let (status, shown) = finished(&sandbox, "mine", step);
    assert_eq!(status, 2, "{shown}");
    assert!(shown.contains("HEAD does not build"), "{shown}");
}

#[test]
fn a_record_without_a_remote_is_refused_before_anything_is_built() {
    let sandbox = repository();
    let record = || {
        let step = track(&sandbox, "mine", "record", &[("BUILD", "touch built")]);
        let (status, shown) = finished(&sandbox, "mine", step);
        assert_eq!(status, 2, "{shown}");
        assert!(!sandbox.path("mine/built").exists());
        shown
    };
    std::fs::remove_dir_all(sandbox.path("remote")).unwrap();
    let shown = record();
    assert!(
        shown.contains("the remote origin cannot be read"),
        "{shown}"
    );
    git(&sandbox, "mine", &["remote", "remove", "origin"]);
    let shown = record();
    assert!(shown.contains("there is no remote origin"), "{shown}");
    assert!(shown.contains("git remote add origin URL"), "{shown}");
}

#[test]
fn a_pull_request_that_takes_longer_is_red() {
    let sandbox = repository_of_claims();
    let solver = "benchmarks/solver.sh";
    let gate = |more: &[(&str, &str)]| {
        let step = track(&sandbox, "mine", "gate", more);
        finished(&sandbox, "mine", step)
    };
    // What does not concern the solver passes at once, and so does a change without effect. The
    // program may be named from the top of the repository.
    pull_request(&sandbox, "benchmarks/suite.toml", "Three shapes", "A shape");
    let (status, shown) = gate(&[("PATHS", "src benchmarks/solver.sh")]);
    assert_eq!(status, 0, "{shown}");
    assert!(shown.contains("has changed: not measured"), "{shown}");
    let program = assert_cmd::cargo::cargo_bin("geobench");
    std::os::unix::fs::symlink(program, sandbox.path("program")).unwrap();
    let (status, shown) = gate(&[
        ("BUILD", "test -f benchmarks/solver.sh"),
        ("GEOBENCH", "../program"),
    ]);
    assert_eq!(status, 0, "{shown}");
    let call = "seconds=0.010";
    pull_request(&sandbox, solver, call, "seconds=0.012");
    let (status, shown) = gate(&[]);
    assert_eq!(status, 1, "{shown}");
    assert!(shown.contains("worse: measured again"), "{shown}");
    assert!(
        shown.contains("ext:solver") && shown.contains("time=15%"),
        "{shown}"
    );
    // Slower until the second measurement, whose folder is beside those of the trees.
    let once = "[ -d ../../../second ] && seconds=0.010 || seconds=0.012";
    pull_request(&sandbox, solver, call, once);
    let (status, shown) = gate(&[]);
    assert_eq!(status, 0, "{shown}");
    assert!(shown.contains("worse: measured again"), "{shown}");
    assert!(
        shown.contains("Worse in the first measurement and not in the second."),
        "{shown}"
    );
    // A misspelt file is an error: nothing would ever be measured.
    let (status, shown) = gate(&[("PROGRAMS", "benchmarks/program.toml")]);
    assert_eq!(status, 2, "{shown}");
    assert!(
        shown.contains("there is no benchmarks/program.toml"),
        "{shown}"
    );
    // The first commit with a solver has nothing to be compared with.
    git(&sandbox, "mine", &["checkout", "-q", "--orphan", "empty"]);
    git(&sandbox, "mine", &["rm", "-rfq", "."]);
    git(
        &sandbox,
        "mine",
        &["commit", "-q", "--allow-empty", "-m", "root"],
    );
    let join = [
        "merge",
        "-q",
        "--no-ff",
        "--allow-unrelated-histories",
        "-m",
        "m",
        "main",
    ];
    git(&sandbox, "mine", &join);
    let (status, shown) = gate(&[]);
    assert_eq!(status, 0, "{shown}");
    assert!(shown.contains("nothing to compare with yet"), "{shown}");
}

#[test]
fn a_pull_request_may_change_programs_build_and_files() {
    let sandbox = repository();
    // The solver is timed, so no time may be worse here: only a row may be missing.
    let gate = |more: &[(&str, &str)]| {
        let fixed = [("RULES", "missing=0"), ("ROUNDS", "2")];
        let step = track(&sandbox, "mine", "gate", &[&fixed[..], more].concat());
        finished(&sandbox, "mine", step)
    };
    // A program that the base does not have.
    let programs = sandbox.read("mine/benchmarks/programs.toml");
    let suite = sandbox.read("mine/benchmarks/suite.toml");
    let add = |name: &str| {
        let more = programs.replace("[ext.solver]", &format!("[ext.{name}]"));
        sandbox.write("mine/benchmarks/programs.toml", &(programs.clone() + &more));
        let both = format!("\"ext:solver\", \"ext:{name}\"");
        let suite = suite.replace("\"ext:solver\"", &both);
        sandbox.write("mine/benchmarks/suite.toml", &suite);
        commit(&sandbox, name);
    };
    add("more");
    let (status, shown) = gate(&[]);
    assert_eq!(status, 0, "{shown}");
    assert!(shown.contains("both run the suite of the base"), "{shown}");
    assert!(shown.contains("ext:solver"), "{shown}");
    // What mends the build of the base passes.
    let (status, shown) = gate(&[("BUILD", "grep -q ext.more benchmarks/programs.toml")]);
    assert_eq!(status, 0, "{shown}");
    assert!(shown.contains("The base does not build"), "{shown}");
    // Another program in its place: neither commit has all programs of the other.
    add("other");
    let (status, shown) = gate(&[("RULES", "missing=100%")]);
    assert_eq!(status, 0, "{shown}");
    assert!(shown.contains("the base runs its own suite"), "{shown}");
    assert!(
        shown.contains("ext:more") && shown.contains("ext:other"),
        "{shown}"
    );
    // A pattern of paths matches a file that is removed.
    for name in ["a.c", "b.c"] {
        sandbox.write(&format!("mine/src/{name}"), "");
    }
    commit(&sandbox, "files");
    std::fs::remove_file(sandbox.path("mine/src/b.c")).unwrap();
    commit(&sandbox, "one file less");
    let (status, shown) = gate(&[("PATHS", "src/*.c"), ("BUILD", "false")]);
    assert_eq!(status, 2, "{shown}");
    assert!(shown.contains("the head does not build"), "{shown}");
}
