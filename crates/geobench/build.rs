//! Records what the program was built from and with, for the result files, and has it linked so
//! that its memory can be measured.

use std::path::Path;
use std::process::Command;

fn main() {
    set("GEOBENCH_COMMIT", commit().as_deref());
    let rustc = std::env::var("RUSTC").unwrap_or_else(|_| "rustc".into());
    set("GEOBENCH_RUSTC", output(&rustc, &["--version"]).as_deref());
    set("GEOBENCH_RUSTFLAGS", rustflags().as_deref());
    set("GEOBENCH_PROFILE", profile().as_deref());
    lie_at_one_address();
    println!("cargo::rerun-if-changed=build.rs");
}

/// The profile: `debug`, `quick`, or `release` for all others. Cargo tells custom profiles as that
/// which they inherit from; the directory of the output has their names.
fn profile() -> Option<String> {
    let output = std::env::var("OUT_DIR").ok()?;
    let directory = Path::new(&output).ancestors().nth(3)?.file_name()?;
    if directory == "quick" {
        return Some("quick".to_owned());
    }
    std::env::var("PROFILE").ok()
}

/// Has the program loaded at the same address each time. Linux maps the 64 KB around each page of
/// code that is needed, aligned by address: with an address by chance the memory of a cell on a
/// model of 6,000 faces differs by up to 1 MB of 8 from one start to the next, with one address by
/// 0.3, and it is 0.1 less.
fn lie_at_one_address() {
    let target = |variable| std::env::var(variable).unwrap_or_default();
    let is_static = target("CARGO_CFG_TARGET_FEATURE")
        .split(',')
        .any(|feature| feature == "crt-static");
    if target("CARGO_CFG_TARGET_OS") == "linux"
        && target("CARGO_CFG_TARGET_ENV") == "gnu"
        && !is_static
    {
        println!("cargo::rustc-link-arg-bins=-no-pie");
    }
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
