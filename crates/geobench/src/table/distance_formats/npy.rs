//! The array format of `NumPy`, version 1.0, as its documentation (`numpy.lib.format`) describes
//! it: magic, version, length of the header, the header padded to 64 bytes, the numbers.

use super::append;

const MAGIC: &[u8] = b"\x93NUMPY\x01\x00";

/// A one-dimensional little-endian f64 array.
pub(super) fn render(distances: &[f64]) -> Vec<u8> {
    let mut header = format!(
        "{{'descr': '<f8', 'fortran_order': False, 'shape': ({},), }}",
        distances.len()
    );
    // With magic, version, length and the final line break, a multiple of 64.
    let used = MAGIC.len() + 2 + header.len() + 1;
    header += &" ".repeat(used.next_multiple_of(64) - used);
    header.push('\n');

    let mut bytes = MAGIC.to_vec();
    bytes.extend_from_slice(&(header.len() as u16).to_le_bytes());
    bytes.extend_from_slice(header.as_bytes());
    append(&mut bytes, distances.iter().copied(), f64::to_le_bytes);
    bytes
}
