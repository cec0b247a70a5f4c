//! Binary numbers one after another.

/// Appends each of `numbers` as `to_bytes` lays it out.
pub(super) fn append<T, const N: usize>(
    bytes: &mut Vec<u8>,
    numbers: impl IntoIterator<Item = T>,
    to_bytes: fn(T) -> [u8; N],
) {
    for number in numbers {
        bytes.extend_from_slice(&to_bytes(number));
    }
}
