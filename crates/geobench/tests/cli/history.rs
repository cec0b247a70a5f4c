//! `geobench record`, `trend`, `compare` of several files and of a history, and exports.

use std::process::Command;

use serde_json::{Value, json};

use crate::support::{PLAIN_GIT, SQUARE, Sandbox};

/// A result file for commit `i`, made from a real one by changing its times and counts.
fn result_of(base: &Value, i: usize, commit: &str) -> Value {
    let mut file = base.clone();
    file["tool"]["commit"] = commit.into();
    file["started"] = format!("2025-03-{:02}T00:00:00Z", i + 1).into();
    for cell in file["cells"].as_array_mut().unwrap() {
        // Slower from commit 12 on, counted from 0. The noise has no pattern over a few commits.
        let slower = if i >= 12 { 1.3 } else { 1.0 };
        let samples = (0..6).map(|k| {
            let noise = ((i * 7 + k * 3) % 11) as f64 / 11.0 - 0.5;
            slower * (1.0 + 0.02 * noise)
        });
        let samples: Vec<f64> = samples.collect();
        cell["time"]["median"] = samples[2].into();
        cell["time"]["samples"] = json!(samples);
    }
    file
}

fn git(sandbox: &Sandbox, arguments: &str) -> String {
    let output = Command::new("git")
        .current_dir(sandbox.path(""))
        .args(arguments.split_whitespace())
        .envs(PLAIN_GIT)
        .output()
        .unwrap();
    let error = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(output.status.success(), "git {arguments}: {error}");
    String::from_utf8(output.stdout).unwrap().trim().to_owned()
}

/// A repository of 16 commits, and a history with a record of each.
fn recorded() -> (Sandbox, Vec<String>) {
    let sandbox = Sandbox::with_square();
    sandbox.succeed("run square.off --algo mmp,vtp --repeat 1 --quiet -o r.json");
    let base = sandbox.json("r.json");
    git(&sandbox, "init -q -b main .");
    let commits: Vec<String> = (0..16)
        .map(|i| {
            let author = "-c user.name=n -c user.email=e@example.org";
            git(
                &sandbox,
                &format!("{author} commit -q --allow-empty -m {i}"),
            );
            let commit = git(&sandbox, "rev-parse HEAD");
            sandbox.write("one.json", &result_of(&base, i, &commit).to_string());
            // All commits are about a second apart, so the times of the runs order them.
            sandbox.succeed("record one.json --into history --suite quick --quiet");
            commit
        })
        .collect();
    (sandbox, commits)
}

#[test]
fn a_slow_commit_is_named_and_shown_on_the_page() {
    let (sandbox, commits) = recorded();
    let shown = sandbox.succeed("trend history -o trend.html");
    let slow = &commits[12][..12];
    for algorithm in ["mmp", "vtp"] {
        let line = shown
            .lines()
            .find(|line| line.contains(&format!("square, {algorithm}, ")));
        let line = line.unwrap_or_else(|| panic!("{shown}"));
        assert!(line.contains(slow) && line.contains("time"), "{line}");
    }
    let found: Value =
        serde_json::from_str(&sandbox.succeed("trend history --format json")).unwrap();
    assert_eq!(found.as_array().unwrap().len(), 2, "{found}");
    assert_eq!(found[0]["commit"], slow);
    assert!((found[0]["ratio"].as_f64().unwrap() - 1.3).abs() < 0.02);
    let page = sandbox.read("trend.html");
    assert!(page.contains(slow) && page.contains("<svg "));
    let names: Vec<_> = std::fs::read_dir(sandbox.path("history"))
        .unwrap()
        .collect();
    // The lock file is counted, too.
    assert_eq!(names.len(), 16 + 1);
}

#[test]
fn the_newest_commit_is_held_against_the_noise_of_others() {
    let (sandbox, _) = recorded();
    let gate = |more: &str| sandbox.call(&format!("compare history --against {more}"));
    // Compared with slow commits it is not slower; compared with all earlier ones it is.
    let same = gate("main~4..main~1 --fail-on time=5%,propagated=0");
    assert_eq!(same.code, 0, "{}{}", same.stdout, same.stderr);
    assert!(
        same.stdout.ends_with("0 of 4 figures are worse\n"),
        "{}",
        same.stdout
    );
    let worse = gate("main~15..main~4 --fail-on time=5%,propagated=0");
    assert_eq!(worse.code, 1, "{}{}", worse.stdout, worse.stderr);
    assert!(worse.stdout.contains("! [time=5%]"), "{}", worse.stdout);
    let without = gate("main~15..main~4");
    assert_eq!(without.code, 0, "{}", without.stderr);
    assert!(
        without.stdout.contains("no rules: no figure is judged"),
        "{}",
        without.stdout
    );
    let error = gate("nothing..main").stderr;
    assert!(error.contains("not a range of commits"), "{error}");
    let few = gate("main~1..main --fail-on time=5%");
    // The history has learned enough; a range without records is no reason to pass.
    assert_eq!(few.code, 2, "{}", few.stdout);
    assert!(
        few.stderr
            .contains("no record of the commits to compare with"),
        "{}",
        few.stderr
    );
    // A range that begins before the first commit.
    let all = gate("main~40..main~4 --fail-on time=5% -o gate.md -o gate.json");
    assert_eq!(all.code, 1, "{}", all.stderr);
    assert!(
        all.stderr.contains("all commits up to main~4"),
        "{}",
        all.stderr
    );
    let page = sandbox.read("gate.md");
    assert!(
        page.starts_with("### geobench: 2 of 2 figures are worse\n"),
        "{page}"
    );
    assert!(page.contains("| Cell | Figure |"), "{page}");
    // Another machine is no base.
    let error = gate("main~15..main --machine none").stderr;
    assert!(error.contains("no record is of such a machine"), "{error}");
    // Another commit is judged: the one before the slow one.
    let before = gate("main~15..main~5 --commit main~4 --fail-on time=5%");
    assert_eq!(before.code, 0, "{}{}", before.stdout, before.stderr);
}

#[test]
fn several_files_have_a_column_each() {
    let sandbox = Sandbox::with_square();
    sandbox.succeed("run square.off --algo mmp,vtp --repeat 1 --quiet -o r.json");
    let base = sandbox.json("r.json");
    for (i, name) in [(0, "a"), (1, "b"), (12, "c")] {
        let file = result_of(&base, i, "c0ffee").to_string();
        sandbox.write(&format!("{name}.json"), &file);
    }
    let shown = sandbox.succeed("compare a.json b.json c.json");
    assert!(shown.contains("a.json") && shown.contains("1 ("), "{shown}");
    assert!(shown.contains("1.3"), "{shown}");
    let call = sandbox.call("compare a.json b.json c.json --baseline c.json --format json");
    let several: Value = serde_json::from_str(&call.stdout).unwrap();
    assert_eq!(several["schema"], "geobench-comparisons/1");
    assert_eq!(several["comparisons"][1]["old"]["file"], "c.json");
    let ratio = &several["comparisons"][0]["cells"][0]["time"]["ratio"];
    assert!(
        (ratio.as_f64().unwrap() - 1.0 / 1.3).abs() < 0.02,
        "{ratio}"
    );
    let call = sandbox.call("compare a.json b.json c.json --fail-on time=10%");
    assert_eq!(call.code, 1, "{}", call.stdout);
    assert!(
        sandbox
            .refuse("compare a.json")
            .contains("give two or more files")
    );
}

#[test]
fn services_get_their_forms() {
    let sandbox = Sandbox::with_square();
    sandbox.succeed(
        "run square.off --algo mmp --repeat 6 --quiet -o r.json -o r.bmf.json -o r.gab.json",
    );
    let cell = &sandbox.json("r.json")["cells"][0];
    let median = cell["time"]["median"].as_f64().unwrap();
    let bencher = sandbox.json("r.bmf.json");
    let measures = &bencher["square, mmp, source 0"];
    assert_eq!(measures["latency"]["value"].as_f64().unwrap(), median * 1e9);
    assert!(measures["latency"]["lower_value"].as_f64().unwrap() <= median * 1e9);
    assert_eq!(
        measures["propagations"]["value"],
        cell["counters"]["propagated"].as_f64().unwrap()
    );
    let list = sandbox.json("r.gab.json");
    assert_eq!(list[0]["name"], "square, mmp, source 0");
    assert_eq!(
        (&list[0]["unit"], &list[0]["value"]),
        (&json!("s"), &json!(median))
    );
    assert!(list[0]["range"].as_str().unwrap().starts_with("± "));
    assert_eq!(list[1]["unit"], "windows");
}

#[test]
fn a_commit_that_is_unknown_here_needs_a_time() {
    let sandbox = Sandbox::with_square();
    sandbox.succeed("run square.off --algo mmp --repeat 1 --quiet -o r.json");
    let record = "record r.json --into history --commit c0ffee";
    let message = sandbox.refuse(record);
    assert!(
        message.contains("--commit") && message.contains("--date"),
        "{message}"
    );
    let path = sandbox.succeed(&format!("{record} --date 2025-03-04"));
    assert!(path.starts_with("history/2025-03-04-c0ffee-"), "{path}");
    // A file whose start is a path writes nothing, and nowhere else.
    let mut file = sandbox.json("r.json");
    file["started"] = "../../../x".into();
    sandbox.write("evil.json", &file.to_string());
    let message = sandbox.refuse("record evil.json --into other --commit c0ffee --date 2025-03-04");
    assert!(message.contains("`../../../x`, is not a time"), "{message}");
    assert!(!sandbox.path("other").exists());
}

#[test]
fn commits_are_ordered_by_git_and_not_by_dates() {
    let sandbox = Sandbox::with_square();
    sandbox.succeed("run square.off --algo vtp --repeat 1 --quiet -o r.json");
    let base = sandbox.json("r.json");
    git(&sandbox, "init -q -b main .");
    let commits: Vec<String> = (0..16)
        .map(|i| {
            // All commits have one second, as after a rebase.
            let committed = Command::new("git")
                .current_dir(sandbox.path(""))
                .args(["-c", "user.name=n", "-c", "user.email=e@example.org"])
                .args(["commit", "-q", "--allow-empty", "-m", &i.to_string()])
                .env("GIT_COMMITTER_DATE", "1700000000 +0000")
                .envs(PLAIN_GIT)
                .status();
            assert!(committed.unwrap().success());
            git(&sandbox, "rev-parse HEAD")
        })
        .collect();
    // HEAD is measured first, the others backwards.
    for i in (0..16).rev() {
        let mut file = result_of(&base, i, &commits[i]);
        file["started"] = format!("2025-03-{:02}T00:00:00Z", 20 - i).into();
        sandbox.write("one.json", &file.to_string());
        sandbox.succeed("record one.json --into history --suite quick --quiet");
    }
    let named = |sandbox: &Sandbox| {
        let found = sandbox.succeed("trend history --format json");
        let found: Value = serde_json::from_str(&found).unwrap();
        let found = found.as_array().unwrap().clone();
        let of_time = found.iter().filter(|change| change["figure"] == "time");
        let commits = of_time.map(|change| change["commit"].as_str().unwrap().to_owned());
        commits.collect::<Vec<_>>()
    };
    assert_eq!(named(&sandbox), [&commits[12][..12]]);
    let slow = sandbox.call("compare history --against HEAD~15..HEAD~4 --fail-on time=5%");
    assert_eq!(slow.code, 1, "{}{}", slow.stdout, slow.stderr);
    // `trend` judges the last commit against all earlier ones.
    for (commit, code) in [(11, 0), (12, 1)] {
        let trend = format!(
            "trend history --commit {} --fail-on time=5%",
            commits[commit]
        );
        let outcome = sandbox.call(&trend);
        assert_eq!(outcome.code, code, "{}{}", outcome.stdout, outcome.stderr);
    }
    // The records order themselves where no repository is.
    std::fs::rename(sandbox.path(".git"), sandbox.path("gone")).unwrap();
    assert_eq!(named(&sandbox), [&commits[12][..12]]);
}

#[test]
fn exports_name_cells_that_failed() {
    let sandbox = Sandbox::with_square();
    let run = "run square.off --algo mmp,test-abort --repeat 1 --quiet";
    sandbox.call(&format!("{run} -o r.bmf.json -o r.gab.json"));
    let bencher = sandbox.json("r.bmf.json");
    let failed = &bencher["square, test-abort, source 0"];
    assert_eq!(*failed, serde_json::json!({"failed": {"value": 1}}));
    assert!(bencher["square, mmp, source 0"]["failed"].is_null());
    let list = sandbox.json("r.gab.json");
    let mut entries = list.as_array().unwrap().iter();
    let failed = entries.find(|entry| entry["unit"] == "failed").unwrap();
    assert_eq!(failed["name"], "square, test-abort, source 0, failed");
}

#[test]
fn a_result_is_of_the_repository_in_which_it_was_run() {
    let sandbox = Sandbox::with_square();
    git(&sandbox, "init -q -b main .");
    git(&sandbox, "add square.off");
    git(
        &sandbox,
        "-c user.name=n -c user.email=e@example.org commit -q -m first",
    );
    let head = git(&sandbox, "rev-parse HEAD");
    // A program that the repository names is not started.
    sandbox.write("watch", "#!/bin/sh\ntouch watched\n");
    let executable = std::os::unix::fs::PermissionsExt::from_mode(0o755);
    std::fs::set_permissions(sandbox.path("watch"), executable).unwrap();
    git(&sandbox, "config core.fsmonitor ./watch");
    let run = "run square.off --algo vtp --repeat 1 --quiet -o r.json";
    sandbox.succeed(run);
    assert!(!sandbox.path("watched").exists());
    assert_eq!(sandbox.json("r.json")["repository"]["commit"], head);
    let path = sandbox.succeed("record r.json --into history");
    assert!(path.contains(&head[..12]), "{path}");
    let record = sandbox.json(path.trim_end());
    assert_eq!(record["commit"], head);
    assert!(record["version"].is_string());
    // Changes that no commit has.
    sandbox.write(
        "square.off",
        &(crate::support::SQUARE.to_owned() + "# changed\n"),
    );
    sandbox.succeed(run);
    let message = sandbox.refuse("record r.json --into history");
    assert!(message.contains("--dirty"), "{message}");
    sandbox.succeed("record r.json --into history --dirty --quiet");
}

/// github-action-benchmark posts names as code in a table, without escapes.
#[test]
fn exports_have_names_that_leave_no_table() {
    let sandbox = Sandbox::new();
    sandbox.write("a`|b\u{202e}.off", SQUARE);
    sandbox
        .succeed("run a`|b\u{202e}.off --algo mmp --repeat 1 --quiet -o r.bmf.json -o r.gab.json");
    let bencher = sandbox.json("r.bmf.json");
    let name = bencher.as_object().unwrap().keys().next().unwrap();
    assert!(name.starts_with("a`|b\\u{202e}"), "{name}");
    let list = sandbox.json("r.gab.json");
    let name = list[0]["name"].as_str().unwrap();
    assert!(name.starts_with("a'/b\\u{202e}"), "{name}");
}
