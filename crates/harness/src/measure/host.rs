//! Records of the machine and the program.

use std::fs;
use std::path::Path;
use std::thread;
use std::time::SystemTime;

use crate::schema::{Host, Tool};

/// The version, commit and compiler of this program.
pub fn tool() -> Tool {
    let rustflags = env!("GEOBENCH_RUSTFLAGS");
    Tool {
        version: env!("CARGO_PKG_VERSION").to_owned(),
        commit: non_empty(env!("GEOBENCH_COMMIT")),
        rustc: non_empty(env!("GEOBENCH_RUSTC")),
        rustflags: Some(rustflags.to_owned()),
        profile: env!("GEOBENCH_PROFILE").to_owned(),
        features: Vec::new(),
    }
}

/// The current time, RFC 3339 in UTC; the first second of 1970 if the clock is before it.
pub fn now() -> String {
    let now = SystemTime::now().max(SystemTime::UNIX_EPOCH);
    humantime::format_rfc3339_seconds(now).to_string()
}

/// Whether this is a release build. Times of other builds are meaningless.
pub fn is_release_build() -> bool {
    env!("GEOBENCH_PROFILE") == "release"
}

/// Describes this machine in its present state. Values that the system does not report are absent;
/// Linux reports most.
pub fn host() -> Host {
    Host {
        cpu: field("/proc/cpuinfo", "model name", ':'),
        cores: thread::available_parallelism().map_or(1, usize::from),
        memory_bytes: kibibytes("/proc/meminfo", "MemTotal"),
        os: field("/etc/os-release", "PRETTY_NAME", '=').map_or_else(
            || std::env::consts::OS.to_owned(),
            |name| name.trim_matches('"').to_owned(),
        ),
        kernel: text("/proc/sys/kernel/osrelease").and_then(|text| non_empty(&text)),
        load_start: load(Path::new("/")),
        simd: Some(geobench_window::simd::Instructions::detect().to_string()),
        node: std::env::var("SLURMD_NODENAME").ok(),
    }
}

/// The trimmed text of a file; `None` if it cannot be read.
pub(super) fn text(path: impl AsRef<Path>) -> Option<String> {
    Some(fs::read_to_string(path).ok()?.trim().to_owned())
}

/// One-minute load average of the system below `root`.
pub(super) fn load(root: &Path) -> Option<f64> {
    let text = text(root.join("proc/loadavg"))?;
    text.split_whitespace().next()?.parse().ok()
}

/// The value of the first line `key separator value` of a file.
fn field(path: impl AsRef<Path>, key: &str, separator: char) -> Option<String> {
    text(path)?.lines().find_map(|line| {
        let (name, value) = line.split_once(separator)?;
        (name.trim() == key).then(|| value.trim().to_owned())
    })
}

/// The value of the first line `key: number kB` of a file, in bytes.
pub(crate) fn kibibytes(path: impl AsRef<Path>, key: &str) -> Option<u64> {
    let value = field(path, key, ':')?;
    let number: u64 = value.strip_suffix("kB")?.trim().parse().ok()?;
    number.checked_mul(1024)
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

    /// A configuration of cargo may give flags as well.
    #[test]
    fn the_tool_knows_the_flags_of_the_compiler() {
        let flags = tool().rustflags.unwrap();
        let wanted = option_env!("RUSTFLAGS").unwrap_or_default();
        assert!(flags.contains(wanted.trim()), "{flags}");
    }

    #[cfg(target_os = "linux")]
    #[test]
    fn linux_gives_every_field() {
        let host = host();
        assert!(host.cores >= 1);
        assert!(host.memory_bytes.unwrap() > 1 << 20);
        assert!(host.kernel.is_some() && host.load_start.is_some());
    }

    #[test]
    fn a_missing_file_or_key_is_absent() {
        assert_eq!(field("/no/such/file", "x", ':'), None);
        assert_eq!(kibibytes("Cargo.toml", "MemTotal"), None);
    }
}
