//! No output may be a file that the command reads, under whatever name.

use std::fs;
use std::process::Command;

use assert_cmd::cargo::cargo_bin;

use crate::support::Sandbox;

/// A command with the options that name files. Options that take no part in a call are left out.
struct Files {
    /// The command and the arguments that it needs beside files.
    call: &'static str,
    /// Options that read: the option, `""` if it is positional, and the file of the sandbox.
    read: &'static [(&'static str, &'static str)],
    /// Options that write: the option and an ending that it takes.
    written: &'static [(&'static str, &'static str)],
}

const MODEL: (&str, &str) = ("", "square.off");

const COMMANDS: [Files; 14] = [
    Files {
        call: "run --algo vtp,mmp --repeat 1 --quiet",
        read: &[
            MODEL,
            ("--config", "suite.toml"),
            ("--ext", "programs.toml"),
            ("--check", "square.s0.csv"),
            ("--sources", "sources.csv"),
            ("--targets", "targets.csv"),
            ("--resume", "night.jsonl"),
        ],
        written: &[("--output", "json"), ("--add-to", "json")],
    },
    Files {
        call: "distance --source 0",
        read: &[
            MODEL,
            ("--sources", "sources.csv"),
            ("--targets", "targets.csv"),
        ],
        written: &[("--output", "csv")],
    },
    Files {
        call: "distance square.off",
        read: &[("--pairs", "pairs.csv")],
        written: &[("--output", "csv")],
    },
    Files {
        call: "distance square.off --algo mmp",
        read: &[("--curve", "curve.csv")],
        written: &[("--output", "csv")],
    },
    Files {
        call: "path --source 0 --target 2",
        read: &[
            MODEL,
            ("--sources", "sources.csv"),
            ("--targets", "targets.csv"),
        ],
        written: &[("--output", "json")],
    },
    Files {
        call: "isolines --source 0 --every 0.3",
        read: &[MODEL, ("--sources", "sources.csv")],
        written: &[("--output", "json")],
    },
    Files {
        call: "voronoi --source 0 --source 2",
        read: &[MODEL, ("--sources", "sources.csv")],
        written: &[
            ("--output", "json"),
            ("--dual", "off"),
            ("--borders", "obj"),
            ("--labels", "csv"),
        ],
    },
    Files {
        call: "remesh --sites 8",
        read: &[MODEL],
        written: &[("--output", "off"), ("--picture", "svg")],
    },
    Files {
        call: "gen",
        read: &[("", "gen:file,path=square.off")],
        written: &[("--output", "obj")],
    },
    Files {
        call: "claims",
        read: &[("", "result.json"), ("--claims", "claims.toml")],
        written: &[("--output", "md")],
    },
    Files {
        call: "compare other.json",
        read: &[("", "result.json"), ("--baseline", "result.json")],
        written: &[("--output", "md")],
    },
    Files {
        call: "merge",
        read: &[("", "result.json")],
        written: &[("--output", "json")],
    },
    Files {
        call: "pool other.json",
        read: &[("", "result.json")],
        written: &[("--output", "json")],
    },
    Files {
        call: "report",
        read: &[("", "result.json")],
        written: &[("--output", "html")],
    },
];

/// Commands that write no file of which the user chooses the name. `record` names its files itself,
/// `cluster` and `site` fill a directory of their own.
const OTHERS: [&str; 11] = [
    "verify",
    "certify",
    "info",
    "algos",
    "suites",
    "record",
    "cluster",
    "corpus",
    "site",
    "completions",
    "man",
];

fn sandbox() -> Sandbox {
    let sandbox = Sandbox::with_square();
    let run = "run square.off --algo vtp,mmp --repeat 1 --isolate none --quiet -o";
    sandbox.succeed(&format!("{run} result.json --resume night.jsonl"));
    sandbox.succeed(&format!("{run} other.json"));
    sandbox.write("sources.csv", "2\n");
    sandbox.write("targets.csv", "2\n");
    sandbox.write("pairs.csv", "2,0\n");
    sandbox.write("curve.csv", "0\n1\n");
    sandbox.write("square.s0.csv", "0,0\n1,1\n2,1.4142135623730951\n3,1\n");
    sandbox.write(
        "suite.toml",
        "[[group]]\nname = \"a\"\nmodels = [\"square.off\"]\n",
    );
    sandbox.write(
        "programs.toml",
        "[ext.own]\ncommand = [\"true\", \"{model}\", \"{source}\", \"{output}\"]\n",
    );
    sandbox.write("claims.toml", "claims = []\n");
    sandbox.succeed("record result.json --into history --commit c0ffee --date 2025-03-04 --quiet");
    sandbox
}

/// Calls `call` with the output `option` under a name that is a link to `file`.
fn refuses(sandbox: &Sandbox, call: &str, option: &str, ending: &str, file: &str) {
    let before = sandbox.bytes(file);
    for is_hard in [false, true] {
        let link = sandbox.path(&format!("link.{ending}"));
        if is_hard {
            fs::hard_link(sandbox.path(file), &link).unwrap();
        } else {
            std::os::unix::fs::symlink(sandbox.path(file), &link).unwrap();
        }
        let call = format!("{call} {option} link.{ending}");
        let message = sandbox.refuse(&call);
        assert!(
            message.ends_with("would replace a file that is read; name another output"),
            "{call}: {message}"
        );
        fs::remove_file(link).unwrap();
        assert_eq!(sandbox.bytes(file), before, "{call}");
    }
}

/// The further option that a call with the output `option` needs.
fn needed(call: &str, option: &str) -> &'static str {
    match call.split(' ').next() {
        Some("voronoi") if option != "--output" => "--output main.json",
        Some("remesh") if option != "--output" => "--output main.off",
        _ => "",
    }
}

#[test]
fn no_output_is_a_file_that_is_read() {
    let sandbox = sandbox();
    for Files {
        call,
        read,
        written,
    } in &COMMANDS
    {
        for &(input, file) in *read {
            // Runs need a model, whatever else they read.
            let model = match read[0] {
                MODEL if input != MODEL.0 && !call.starts_with("remesh") => "square.off",
                _ if call.starts_with("claims") && !input.is_empty() => "result.json",
                _ => "",
            };
            for &(option, ending) in *written {
                let needed = needed(call, option);
                let call = format!("{call} {model} {input} {file} {needed}");
                let file = file.strip_prefix("gen:file,path=").unwrap_or(file);
                refuses(&sandbox, &call, option, ending, file);
            }
        }
        for &(first, ending) in *written {
            for &(second, _) in written.iter().filter(|(second, _)| *second != first) {
                // Both names have the ending of the first; formats decide by it.
                let needed = needed(call, first);
                let call = format!(
                    "{call} {} {needed} {first} x.{ending} {second} x.{ending}",
                    read[0].1
                );
                let outcome = sandbox.call(&call);
                assert_eq!(outcome.code, 2, "{call}: {}", outcome.stderr);
                assert!(!sandbox.path(&format!("x.{ending}")).exists(), "{call}");
            }
        }
    }
}

#[test]
fn every_command_with_an_output_is_known() {
    let sandbox = Sandbox::new();
    let help = sandbox.succeed("--help");
    let commands = help.lines().skip_while(|line| *line != "Commands:").skip(1);
    let commands: Vec<&str> = commands
        .take_while(|line| !line.is_empty())
        .filter(|line| line.starts_with("  ") && !line.starts_with("   "))
        .filter_map(|line| line.split_whitespace().next())
        .collect();
    assert!(commands.contains(&"run"), "{help}");
    for command in commands {
        let known = COMMANDS.iter().filter(|files| {
            let name = files.call.split(' ').next();
            name == Some(command)
        });
        let known = known.flat_map(|known| known.read.iter().chain(known.written));
        let known: Vec<&str> = known.map(|(name, _)| *name).collect();
        if known.is_empty() {
            let others = OTHERS.contains(&command) || ["trend", "help", "init"].contains(&command);
            assert!(others, "{command}: which files does it read and write?");
            continue;
        }
        let help = sandbox.succeed(&format!("{command} --help"));
        for option in help.lines().filter_map(|line| {
            let (option, value) = line.trim().split_once(" <")?;
            let names_a_file = ["FILE>", "SUITE.toml>", "REF>"];
            let named = names_a_file.iter().any(|name| value.starts_with(name));
            let option = option.rsplit(' ').next()?;
            (named && option.starts_with("--")).then(|| option.to_owned())
        }) {
            assert!(
                known.contains(&&*option),
                "{command} {option}: is it read or written?"
            );
        }
    }
}

#[test]
fn files_that_are_found_through_others_are_read_too() {
    let sandbox = sandbox();
    let refused = |call: &str, option: &str, ending: &str, file: &str| {
        refuses(&sandbox, call, option, ending, file);
    };
    // The models and points of a suite, and distances stored beside a model.
    sandbox.write(
        "whole.toml",
        "algorithms = [\"vtp\"]\nsources = \"sources.csv\"\ntargets = \"targets.csv\"\n[[group]]\nname = \"a\"\nmodels = [\"square.off\"]\n",
    );
    for file in ["square.off", "sources.csv", "targets.csv"] {
        refused("run --config whole.toml", "-o", "json", file);
    }
    refused(
        "run square.off --algo vtp --check file",
        "-o",
        "csv",
        "square.s0.csv",
    );
    // A file of a directory.
    fs::create_dir(sandbox.path("results")).unwrap();
    fs::copy(
        sandbox.path("result.json"),
        sandbox.path("results/result.json"),
    )
    .unwrap();
    refused("claims results", "-o", "md", "results/result.json");
    let record = fs::read_dir(sandbox.path("history")).unwrap();
    let record = record.map(|entry| entry.unwrap().file_name());
    let record = record.map(|name| name.into_string().unwrap());
    let record = record.into_iter().find(|name| !name.starts_with('.'));
    let record = format!("history/{}", record.unwrap());
    refused("trend history", "-o", "html", &record);
    // A table whose name is a link.
    sandbox.succeed("report result.json --format csv tables --quiet");
    let tables = fs::read_dir(sandbox.path("tables")).unwrap();
    let table = tables.into_iter().next().unwrap().unwrap().path();
    fs::remove_file(&table).unwrap();
    std::os::unix::fs::symlink(sandbox.path("result.json"), &table).unwrap();
    let before = sandbox.bytes("result.json");
    let message = sandbox.refuse("report result.json --format csv tables --quiet");
    assert!(message.contains("a file that is read"), "{message}");
    assert_eq!(sandbox.bytes("result.json"), before);
    // A page draws models that the result names.
    std::os::unix::fs::symlink(sandbox.path("square.off"), sandbox.path("page.html")).unwrap();
    let before = sandbox.bytes("square.off");
    let message = sandbox.refuse("report result.json -o page.html --quiet");
    assert!(message.contains("a file that is read"), "{message}");
    assert_eq!(sandbox.bytes("square.off"), before);
}

#[test]
fn a_site_replaces_no_record() {
    let sandbox = sandbox();
    for (directory, file) in [("one", "result.json"), ("two", "other.json")] {
        fs::create_dir(sandbox.path(directory)).unwrap();
        fs::copy(
            sandbox.path(file),
            sandbox.path(&format!("{directory}/index.html")),
        )
        .unwrap();
    }
    let before = sandbox.bytes("one/index.html");
    let message = sandbox.refuse("site one/index.html -o one --quiet");
    assert!(message.contains("a file that is read"), "{message}");
    assert_eq!(sandbox.bytes("one/index.html"), before);
    // Two records of one name.
    sandbox.succeed("site one/index.html two/index.html -o site --quiet");
    let mut copies = ["", "-2"].map(|end| sandbox.bytes(&format!("site/records/index{end}.json")));
    copies.sort_unstable();
    let mut records = [before, sandbox.bytes("two/index.html")];
    records.sort_unstable();
    assert_eq!(copies, records);
    // The copies of a site can be its records.
    sandbox.succeed("site site/records/index.json -o site --quiet");
}

#[test]
fn files_of_single_sources_and_of_standard_input_are_guarded() {
    let sandbox = sandbox();
    sandbox.succeed("gen gen:cube,n=1 -o d.s0.ply");
    let message = sandbox.refuse("distance d.s0.ply --source 0 --each -o d.ply --quiet");
    assert!(message.contains("d.s0.ply"), "{message}");
    let before = sandbox.bytes("suite.toml");
    sandbox.refuse("run square.off --algo vtp --quiet --resume suite.toml");
    assert_eq!(sandbox.bytes("suite.toml"), before);
    let before = sandbox.bytes("result.json");
    let output = Command::new(cargo_bin("geobench"))
        .current_dir(sandbox.path(""))
        .args(["merge", "-", "-o", "result.json"])
        .stdin(fs::File::open(sandbox.path("result.json")).unwrap())
        .output()
        .unwrap();
    assert_eq!(output.status.code(), Some(2));
    assert_eq!(sandbox.bytes("result.json"), before);
}

#[test]
fn the_buffers_of_a_gltf_file_are_read() {
    let sandbox = sandbox();
    let corners = [[0.0_f32, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
    let bytes: Vec<u8> = corners
        .iter()
        .flatten()
        .flat_map(|x| x.to_le_bytes())
        .collect();
    fs::write(sandbox.path("corners.ply"), bytes).unwrap();
    sandbox.write(
        "a.gltf",
        r#"{"asset": {"version": "2.0"},
            "buffers": [{"byteLength": 36, "uri": "./corners.ply"}],
            "bufferViews": [{"buffer": 0, "byteLength": 36}],
            "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3"}],
            "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}],
            "nodes": [{"mesh": 0}], "scenes": [{"nodes": [0]}]}"#,
    );
    sandbox.succeed("distance a.gltf --source 0 -o d.csv --quiet");
    refuses(
        &sandbox,
        "distance a.gltf --source 0",
        "-o",
        "ply",
        "corners.ply",
    );
    refuses(
        &sandbox,
        "run a.gltf --algo vtp",
        "-o",
        "csv",
        "corners.ply",
    );
    // The hash of the model is that of all its bytes.
    let hash = |name: &str| {
        let call = "run a.gltf --algo vtp --repeat 1 --isolate none --quiet -o";
        sandbox.succeed(&format!("{call} {name}"));
        sandbox.json(name)["models"][0]["sha256"].clone()
    };
    let before = hash("before.json");
    let mut moved = vec![0; 36];
    moved[12..16].copy_from_slice(&2.0_f32.to_le_bytes());
    moved[28..32].copy_from_slice(&1.0_f32.to_le_bytes());
    fs::write(sandbox.path("corners.ply"), moved).unwrap();
    assert_ne!(hash("after.json"), before);
}

#[test]
fn links_to_nothing_are_followed() {
    let sandbox = sandbox();
    std::os::unix::fs::symlink("a.json", sandbox.path("l.csv")).unwrap();
    let message = sandbox.refuse("run square.off --algo vtp --quiet -o a.json -o l.csv");
    assert_eq!(message, "l.csv: given twice as output");
}

#[test]
fn standard_output_is_no_file_that_is_read() {
    let sandbox = sandbox();
    let before = sandbox.bytes("result.json");
    for call in [
        "claims result.json",
        "merge result.json -o - --output-format json",
    ] {
        let file = fs::OpenOptions::new()
            .append(true)
            .open(sandbox.path("result.json"));
        let output = Command::new(cargo_bin("geobench"))
            .current_dir(sandbox.path(""))
            .args(call.split(' '))
            .stdout(file.unwrap())
            .output()
            .unwrap();
        assert_eq!(output.status.code(), Some(2), "{call}");
        assert_eq!(sandbox.bytes("result.json"), before, "{call}");
    }
}

#[test]
#[cfg(target_os = "linux")]
fn a_full_standard_output_is_named() {
    for call in [
        "suites",
        "--help",
        "--version",
        "help run",
        "run -h",
        "completions bash",
        "man run",
    ] {
        let full = fs::OpenOptions::new().write(true).open("/dev/full");
        let output = Command::new(cargo_bin("geobench"))
            .args(call.split(' '))
            .stdout(full.unwrap())
            .output()
            .unwrap();
        assert_eq!(output.status.code(), Some(2), "{call}");
        let said = String::from_utf8(output.stderr).unwrap();
        assert!(
            said.starts_with("geobench: error: standard output: cannot be written: No space"),
            "{call}: {said}"
        );
    }
}

#[test]
fn only_a_store_of_results_is_replaced_by_another() {
    let sandbox = sandbox();
    let run = "run square.off --algo vtp --repeat 1 --isolate none --quiet -o a.json";
    let model = sandbox.bytes("square.off");
    let link = sandbox.path("a.json.unfinished");
    std::os::unix::fs::symlink(sandbox.path("square.off"), &link).unwrap();
    let message = sandbox.refuse(run);
    assert!(
        message.contains("a.json.unfinished: it is in the place"),
        "{message}"
    );
    assert_eq!(sandbox.bytes("square.off"), model);
    fs::remove_file(&link).unwrap();
    // Files of users with such names.
    sandbox.refuse(&format!("{run} --resume a.json.unfinished"));
    sandbox.write("a.json.unfinished", "2\n");
    sandbox.refuse(run);
    sandbox.refuse(&format!("{run} --targets a.json.unfinished"));
    assert_eq!(sandbox.read("a.json.unfinished"), "2\n");
    // What a killed run has left.
    let store = sandbox.json("result.json").to_string() + "\n";
    sandbox.write("a.json.unfinished", &store);
    sandbox.succeed(run);
    assert!(!link.exists());
}

#[test]
fn temporary_files_go_on_every_signal() {
    let sandbox = Sandbox::new();
    fs::create_dir(sandbox.path("temporary")).unwrap();
    let left = || fs::read_dir(sandbox.path("temporary")).unwrap().count();
    for (signal, number) in [("HUP", 1), ("INT", 2), ("QUIT", 3), ("TERM", 15)] {
        // It keeps standard input as a file until that ends.
        let mut child = Command::new(cargo_bin("geobench"))
            .current_dir(sandbox.path(""))
            .env("TMPDIR", sandbox.path("temporary"))
            .args([
                "distance",
                "-",
                "--input-format",
                "off",
                "--source",
                "0",
                "-o",
                "d.csv",
            ])
            .stdin(std::process::Stdio::piped())
            .spawn()
            .unwrap();
        // To wait for a child closes its standard input.
        let _stdin = child.stdin.take();
        while left() == 0 {
            std::thread::sleep(std::time::Duration::from_millis(5));
        }
        let kill = Command::new("kill")
            .args(["-s", signal, &child.id().to_string()])
            .status();
        assert!(kill.unwrap().success());
        let status = child.wait().unwrap();
        assert_eq!(
            std::os::unix::process::ExitStatusExt::signal(&status),
            Some(number)
        );
        assert_eq!(left(), 0, "{signal}");
    }
}
