//! Records of the machine and the program.

use std::fs;
use std::thread;

use crate::schema::{Host, Tool};

/// The version, commit and compiler of this program.
pub fn tool() -> Tool {
    Tool {
        version: env!("CARGO_PKG_VERSION").to_owned(),
        commit: non_empty(env!("GEOBENCH_COMMIT")),
        rustc: non_empty(env!("GEOBENCH_RUSTC")),
        rustflags: Some(env!("GEOBENCH_RUSTFLAGS").to_owned()),
        profile: env!("GEOBENCH_PROFILE").to_owned(),
        features: Vec::new(),
    }
}

/// Whether this is a release build; times of others mean little.
pub fn is_release_build() -> bool {
    env!("GEOBENCH_PROFILE") == "release"
}

/// This machine, now. Values that the system does not report are absent; Linux reports most.
pub fn host() -> Host {
    Host {
        cpu: field("/proc/cpuinfo", "model name"),
        cores: thread::available_parallelism().map_or(1, usize::from),
        memory_bytes: kibibytes("/proc/meminfo", "MemTotal"),
        os: quoted("/etc/os-release", "PRETTY_NAME")
            .unwrap_or_else(|| std::env::consts::OS.to_owned()),
        kernel: fs::read_to_string("/proc/sys/kernel/osrelease")
            .ok()
            .and_then(|text| non_empty(text.trim())),
        load_start: fs::read_to_string("/proc/loadavg")
            .ok()
            .and_then(|text| text.split_whitespace().next()?.parse().ok()),
        simd: Some(geobench_vtp::Instructions::detect().to_string()),
    }
}

/// The value after `key:` in a file of such lines.
fn field(path: &str, key: &str) -> Option<String> {
    let text = fs::read_to_string(path).ok()?;
    text.lines().find_map(|line| {
        let (name, value) = line.split_once(':')?;
        (name.trim() == key).then(|| value.trim().to_owned())
    })
}

/// The value after `key:` in a file of such lines, which is in KiB, as bytes.
pub(crate) fn kibibytes(path: &str, key: &str) -> Option<u64> {
    let value = field(path, key)?;
    let number: u64 = value.strip_suffix("kB")?.trim().parse().ok()?;
    number.checked_mul(1024)
}

/// The value after `key=` in a file of such lines, without its quotes.
fn quoted(path: &str, key: &str) -> Option<String> {
    let text = fs::read_to_string(path).ok()?;
    text.lines().find_map(|line| {
        let (name, value) = line.split_once('=')?;
        (name == key).then(|| value.trim_matches('"').to_owned())
    })
}

fn non_empty(text: &str) -> Option<String> {
    (!text.is_empty()).then(|| text.to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_tool_knows_how_it_was_built() {
        let tool = tool();
        assert_eq!(tool.version, env!("CARGO_PKG_VERSION"));
        assert!(tool.rustc.unwrap().starts_with("rustc"));
        assert!(["debug", "release"].contains(&tool.profile.as_str()));
    }

    /// Those of `.cargo/config.toml`, unless the environment has others.
    #[cfg(target_arch = "x86_64")]
    #[test]
    fn the_tool_knows_the_flags_of_the_compiler() {
        let flags = tool().rustflags.unwrap();
        let elsewhere = option_env!("RUSTFLAGS").or(option_env!("CARGO_ENCODED_RUSTFLAGS"));
        assert!(
            elsewhere.is_some() || flags.contains("-x86-branches-within-32B-boundaries"),
            "{flags}"
        );
    }

    #[cfg(target_os = "linux")]
    #[test]
    fn linux_tells_everything() {
        let host = host();
        assert!(host.cores >= 1);
        assert!(host.memory_bytes.unwrap() > 1 << 20);
        assert!(host.kernel.is_some() && host.load_start.is_some());
    }

    #[test]
    fn a_missing_file_or_key_is_absent() {
        assert_eq!(field("/no/such/file", "x"), None);
        assert_eq!(kibibytes("Cargo.toml", "MemTotal"), None);
    }
}
