//! Decompression with a limit on the size.
//!
//! Deflate compresses up to 1032 times, so a small file can decompress to more than the memory of
//! the machine. Mesh files compress 3 to 20 times.

use std::io::Read;
use std::path::Path;

use flate2::bufread::GzDecoder;

use super::error::FileError;

/// Largest ratio of decompressed to compressed size that is accepted by default.
const RATIO: u64 = 100;

/// Any file may decompress to this many bytes, since small files of constant content compress well.
const FLOOR: u64 = 64 << 20;

/// The largest default limit in bytes.
const CEILING: u64 = 8 << 30;

/// The default limit of the decompressed size of `compressed` bytes: 100 times as many, at least 64
/// MiB, at most 8 GiB.
pub fn usual_decompression_limit(compressed: u64) -> u64 {
    compressed.saturating_mul(RATIO).clamp(FLOOR, CEILING)
}

/// Whether `bytes` start with the magic number of gzip.
pub(super) fn is_gzip(bytes: &[u8]) -> bool {
    bytes.starts_with(b"\x1f\x8b")
}

/// Decompresses `bytes`, including all members of a file, to at most `limit` bytes. As in `gzip`,
/// whatever follows the last member is ignored.
pub(super) fn inflate(bytes: &[u8], limit: Option<u64>, path: &Path) -> Result<Vec<u8>, FileError> {
    let compressed = bytes.len() as u64;
    let limit = limit.unwrap_or_else(|| usual_decompression_limit(compressed));
    let mut inflated = Vec::new();
    let mut rest = bytes;
    loop {
        let left = limit.saturating_add(1) - inflated.len() as u64;
        let mut member = GzDecoder::new(rest);
        let read = member.by_ref().take(left).read_to_end(&mut inflated);
        read.map_err(|source| FileError::Gzip {
            path: path.to_owned(),
            source,
        })?;
        rest = member.into_inner();
        if inflated.len() as u64 > limit || !is_gzip(rest) {
            break;
        }
    }
    if inflated.len() as u64 > limit {
        return Err(FileError::TooLarge {
            path: path.to_owned(),
            compressed,
            limit,
        });
    }
    Ok(inflated)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_usual_limit_is_a_ratio_between_two_sizes() {
        assert_eq!(usual_decompression_limit(0), 64 << 20);
        assert_eq!(usual_decompression_limit(1 << 20), 100 << 20);
        assert_eq!(usual_decompression_limit(u64::MAX), 8 << 30);
    }
}
