//! Limits of a run: time, memory, size of decompressed models.

use std::fmt;
use std::str::FromStr;
use std::time::Duration;

use bytesize::ByteSize;
use geobench_mesh::io::ReadOptions;
use geobench_registry::UsageError;

/// Limits of the process of a cell.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Limits {
    /// Limit of the time of each run (warm-up, timed, counting or profiled), set-up included. The
    /// same limit applies to loading the model.
    pub timeout: Timeout,
    /// Limit of the resident memory of the process and its descendants.
    pub memory: MemoryLimit,
    /// Limit of the decompressed size of a compressed model.
    pub decompressed: DecompressionLimit,
}

impl Limits {
    /// The defaults.
    pub const USUAL: Self = Self {
        timeout: Timeout::USUAL,
        memory: MemoryLimit(None),
        decompressed: DecompressionLimit(None),
    };
}

/// A time limit; none by default.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Timeout(pub Option<Duration>);

/// A memory limit in bytes; none by default.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct MemoryLimit(pub Option<u64>);

/// A limit of the decompressed size of a model, in bytes. `None` is
/// [`usual_decompression_limit`](geobench_mesh::io::usual_decompression_limit).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct DecompressionLimit(pub Option<u64>);

impl From<DecompressionLimit> for ReadOptions {
    fn from(limit: DecompressionLimit) -> Self {
        Self {
            max_decompressed: limit.0,
            ..Self::default()
        }
    }
}

impl Timeout {
    /// The default limit of a run.
    pub const USUAL: Self = Self(Some(Duration::from_secs(10 * 60)));
}

impl FromStr for Timeout {
    type Err = UsageError;

    fn from_str(text: &str) -> Result<Self, UsageError> {
        if text.trim().eq_ignore_ascii_case("none") {
            return Ok(Self(None));
        }
        match humantime::parse_duration(text.trim()) {
            Ok(time) if !time.is_zero() => Ok(Self(Some(time))),
            _ => Err(UsageError(format!(
                "`{text}` is not a time; give one such as 90s, 10m or 1h30m, or none"
            ))),
        }
    }
}

impl FromStr for MemoryLimit {
    type Err = UsageError;

    fn from_str(text: &str) -> Result<Self, UsageError> {
        if text.trim().eq_ignore_ascii_case("none") {
            return Ok(Self(None));
        }
        match size(text) {
            Some(bytes) => Ok(Self(Some(bytes))),
            None => Err(UsageError(format!(
                "`{text}` is not a size; give one such as 512MiB, 8GiB or 4GB, or none"
            ))),
        }
    }
}

impl FromStr for DecompressionLimit {
    type Err = UsageError;

    fn from_str(text: &str) -> Result<Self, UsageError> {
        match size(text) {
            Some(bytes) => Ok(Self(Some(bytes))),
            None => Err(UsageError(format!(
                "`{text}` is not a size; give one such as 512MiB, 8GiB or 4GB"
            ))),
        }
    }
}

/// Parses a number of bytes with a unit.
fn size(text: &str) -> Option<u64> {
    let text = text.trim();
    // Single letters are binary units, as in `ulimit`, `dd` and systemd. `bytesize` takes them as
    // decimal.
    let unit = match text.chars().last()?.to_ascii_lowercase() {
        'k' | 'm' | 'g' | 't' => "ib",
        c if c == '.' || c.is_ascii_digit() => "b",
        _ => "",
    };
    let bytes = format!("{text}{unit}").parse::<ByteSize>().ok()?.as_u64();
    // No machine has more than about 2^53 bytes.
    (1..=9_000_000_000_000_000)
        .contains(&bytes)
        .then_some(bytes)
}

impl fmt::Display for Timeout {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.0 {
            Some(time) => write!(f, "{}", humantime::format_duration(time)),
            None => f.write_str("none"),
        }
    }
}

impl fmt::Display for MemoryLimit {
    /// In the largest binary unit in which the number is at least 1, with one decimal.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Some(bytes) = self.0 else {
            return f.write_str("none");
        };
        if bytes < bytesize::KIB {
            return write!(f, "{bytes} bytes");
        }
        let size = format!("{:.1}", ByteSize(bytes).display().iec());
        f.write_str(&size.replace(".0 ", " "))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_are_read_and_shown() {
        for (text, shown) in [
            ("90s", "1m 30s"),
            ("10m", "10m"),
            ("250ms", "250ms"),
            ("1h30m", "1h 30m"),
            ("None", "none"),
        ] {
            assert_eq!(text.parse::<Timeout>().unwrap().to_string(), shown);
        }
        for text in ["", "10", "0s", "-1s", "soon", "1e99h"] {
            assert!(text.parse::<Timeout>().is_err(), "{text}");
        }
    }

    #[test]
    fn sizes_are_read_and_shown() {
        for (text, bytes, shown) in [
            ("8GiB", 8 << 30, "8 GiB"),
            ("8g", 8 << 30, "8 GiB"),
            ("1.5 MiB", 3 << 19, "1.5 MiB"),
            ("2.T", 2 << 40, "2 TiB"),
            ("20 kb", 20_000, "19.5 KiB"),
            ("500MB", 500_000_000, "476.8 MiB"),
            ("1000", 1000, "1000 bytes"),
        ] {
            let limit: MemoryLimit = text.parse().unwrap();
            assert_eq!(limit, MemoryLimit(Some(bytes)));
            assert_eq!(limit.to_string(), shown);
        }
        assert_eq!("none".parse(), Ok(MemoryLimit(None)));
        for text in [
            "", "GiB", "-1", "0", "0.2", "1e9", "8 eggs", "99999TiB", "1..2k",
        ] {
            assert!(text.parse::<MemoryLimit>().is_err(), "{text}");
        }
        assert_eq!("1g".parse(), Ok(DecompressionLimit(Some(1 << 30))));
        assert!("none".parse::<DecompressionLimit>().is_err());
    }
}
