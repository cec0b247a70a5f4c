//! Records what the program was built from and with, for the result files.

use std::path::Path;
use std::process::Command;

fn main() {
    set("GEOBENCH_COMMIT", commit().as_deref());
    let rustc = std::env::var("RUSTC").unwrap_or_else(|_| "rustc".into());
    set("GEOBENCH_RUSTC", output(&rustc, &["--version"]).as_deref());
    set("GEOBENCH_RUSTFLAGS", rustflags().as_deref());
    set("GEOBENCH_PROFILE", std::env::var("PROFILE").ok().as_deref());
    println!("cargo::rerun-if-changed=build.rs");
}

/// The commit that is checked out, if this is a checkout of the project itself and not a copy
/// inside some other repository.
fn commit() -> Option<String> {
    let workspace = Path::new("../..").canonicalize().ok()?;
    let top = output("git", &["rev-parse", "--show-toplevel"])?;
    if Path::new(&top).canonicalize().ok()? != workspace {
        return None;
    }
    // HEAD changes on a checkout; what a commit moves is the log of HEAD.
    for file in ["HEAD", "logs/HEAD"] {
        if let Some(path) = output("git", &["rev-parse", "--git-path", file])
            && Path::new(&path).exists()
        {
            println!("cargo::rerun-if-changed={path}");
        }
    }
    output("git", &["rev-parse", "HEAD"])
}

/// The compiler flags from the environment or a configuration of cargo.
fn rustflags() -> Option<String> {
    let flags = std::env::var("CARGO_ENCODED_RUSTFLAGS").ok()?;
    Some(flags.replace('\x1f', " "))
}

fn output(program: &str, arguments: &[&str]) -> Option<String> {
    let output = Command::new(program).args(arguments).output().ok()?;
    let text = String::from_utf8(output.stdout).ok()?;
    (output.status.success() && !text.trim().is_empty()).then(|| text.trim().to_owned())
}

fn set(variable: &str, value: Option<&str>) {
    println!("cargo::rustc-env={variable}={}", value.unwrap_or(""));
}
