//! Defects that were mended, each with a test that is named after what went wrong.

#[path = "cli/support.rs"]
#[allow(dead_code, reason = "the tests of the command line use all of it")]
mod support;

use std::io::Write;
use std::process::Command;

use flate2::Compression;
use flate2::write::GzEncoder;
use support::Sandbox;

/// An OBJ file of spaces, many gzip members long, that decompresses to `mebibytes`.
fn bomb(sandbox: &Sandbox, name: &str, mebibytes: usize) {
    let mut member = GzEncoder::new(Vec::new(), Compression::best());
    member.write_all(&vec![b' '; 1 << 20]).unwrap();
    let bytes = member.finish().unwrap().repeat(mebibytes);
    std::fs::write(sandbox.path(name), bytes).unwrap();
}

#[test]
fn a_small_gzip_file_took_gigabytes() {
    let sandbox = Sandbox::new();
    bomb(&sandbox, "bomb.obj.gz", 3000);
    let message = "bomb.obj.gz: 3 MiB decompress to more than 301 MiB; if the file can be trusted, \
                   raise the limit with --max-decompressed SIZE";
    let program = assert_cmd::cargo::cargo_bin("geobench");
    for arguments in [
        "info bomb.obj.gz",
        "distance bomb.obj.gz --source 0 -o d.csv",
        "gen file,path=bomb.obj.gz -o m.obj",
        "run bomb.obj.gz --algo vtp",
        "run bomb.obj.gz --algo vtp --isolate none",
        "verify bomb.obj.gz --algo vtp",
    ] {
        // The limits of the system end the command, and its children, where memory is not bounded.
        let output = Command::new("sh")
            .current_dir(sandbox.path(""))
            .args(["-c", "ulimit -v 1500000; exec \"$@\"", "sh"])
            .arg(&program)
            .args(arguments.split(' '))
            .output()
            .unwrap();
        let stderr = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{arguments}: {stderr}");
        assert!(stderr.contains(message), "{arguments}: {stderr}");
    }
}

#[test]
fn a_raised_limit_of_decompression_reaches_child_processes() {
    let sandbox = Sandbox::with_square();
    bomb(&sandbox, "blank.off.gz", 80);
    let mut end = GzEncoder::new(Vec::new(), Compression::best());
    end.write_all(b"\n").unwrap();
    end.write_all(sandbox.read("square.off").as_bytes())
        .unwrap();
    let mut bytes = std::fs::read(sandbox.path("blank.off.gz")).unwrap();
    bytes.extend(end.finish().unwrap());
    std::fs::write(sandbox.path("blank.off.gz"), bytes).unwrap();

    let run = "run blank.off.gz --algo vtp --repeat 1 --warmup 0 --resume j.jsonl -o r.json";
    let refused = sandbox.call(run);
    assert_eq!(refused.code, 2, "{}", refused.stderr);
    std::fs::remove_file(sandbox.path("j.jsonl")).unwrap();
    sandbox.succeed(&format!("{run} --max-decompressed 100MiB"));
    let file = sandbox.json("r.json");
    assert_eq!(file["cells"][0]["status"], "ok");
    assert_eq!(file["plan"]["groups"][0]["max_decompressed"], 100_u64 << 20);
    // The limit tells runs apart: a journal is not continued with another one.
    let other = sandbox.call(&format!("{run} --max-decompressed 200MiB"));
    assert_eq!(other.code, 2, "{}", other.stderr);
    assert!(
        other.stderr.contains("max_decompressed"),
        "{}",
        other.stderr
    );
}
