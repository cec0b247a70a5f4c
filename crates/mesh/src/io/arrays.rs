//! Arrays of binary numbers, as they are embedded in the formats of VTK, GIFTI and glTF.

use std::io::Read;

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use flate2::read::ZlibDecoder;

/// The type of a number.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum NumberType {
    I8,
    U8,
    I16,
    U16,
    I32,
    U32,
    I64,
    U64,
    F32,
    F64,
}

impl NumberType {
    /// Size in bytes.
    pub(super) const fn size(self) -> usize {
        match self {
            Self::I8 | Self::U8 => 1,
            Self::I16 | Self::U16 => 2,
            Self::I32 | Self::U32 | Self::F32 => 4,
            Self::I64 | Self::U64 | Self::F64 => 8,
        }
    }

    /// The bits of a number as a little-endian integer, from its bytes.
    fn bits(bytes: &[u8], is_little: bool) -> u64 {
        let mut all = [0; 8];
        all[..bytes.len()].copy_from_slice(bytes);
        if !is_little {
            all[..bytes.len()].reverse();
        }
        u64::from_le_bytes(all)
    }

    /// The number in `bytes`, which are as many as its size.
    pub(super) fn float(self, bytes: &[u8], is_little: bool) -> f64 {
        let bits = Self::bits(bytes, is_little);
        match self {
            Self::F32 => f32::from_bits(bits as u32).into(),
            Self::F64 => f64::from_bits(bits),
            _ => self.integer(bytes, is_little).unwrap_or_default() as f64,
        }
    }

    /// The whole number in `bytes`, which are as many as its size; `None` for a fraction.
    pub(super) fn integer(self, bytes: &[u8], is_little: bool) -> Option<i128> {
        let bits = Self::bits(bytes, is_little);
        // Casts to the narrower type of the same size keep the bits.
        Some(match self {
            Self::I8 => (bits as i8).into(),
            Self::I16 => (bits as i16).into(),
            Self::I32 => (bits as i32).into(),
            Self::I64 => bits.cast_signed().into(),
            Self::U8 | Self::U16 | Self::U32 | Self::U64 => bits.into(),
            Self::F32 | Self::F64 => {
                let number = self.float(bytes, is_little);
                return (number == number.trunc() && number.abs() < 1e15).then_some(number as i128);
            }
        })
    }
}

/// The bytes of `text` in base64, between which blanks may be.
pub(super) fn from_base64(text: &[u8]) -> Option<Vec<u8>> {
    let is_blank = |byte: &u8| byte.is_ascii_whitespace();
    if text.iter().any(is_blank) {
        let text: Vec<u8> = text.iter().copied().filter(|b| !is_blank(b)).collect();
        return STANDARD.decode(text).ok();
    }
    STANDARD.decode(text).ok()
}

/// Appends the bytes that `compressed` (zlib) holds to `bytes`, at most `limit`. Returns whether
/// that went well.
pub(super) fn inflate(compressed: impl Read, limit: u64, bytes: &mut Vec<u8>) -> bool {
    let before = bytes.len();
    let mut decoder = ZlibDecoder::new(compressed).take(limit.saturating_add(1));
    decoder.read_to_end(bytes).is_ok() && (bytes.len() - before) as u64 <= limit
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_keep_their_bits_in_both_orders() {
        assert_eq!(NumberType::I16.integer(&[0xff, 0xfe], false), Some(-2));
        assert_eq!(NumberType::U16.integer(&[0xfe, 0xff], true), Some(0xfffe));
        assert_eq!(NumberType::I64.integer(&[0xff; 8], true), Some(-1));
        assert_eq!(NumberType::F32.float(&1.5_f32.to_be_bytes(), false), 1.5);
        assert_eq!(NumberType::F64.float(&0.1_f64.to_le_bytes(), true), 0.1);
        assert_eq!(NumberType::F64.integer(&7.5_f64.to_le_bytes(), true), None);
        assert_eq!(NumberType::F32.integer(&7_f32.to_le_bytes(), true), Some(7));
    }

    #[test]
    fn blanks_in_base64_are_ignored() {
        assert_eq!(from_base64(b" AQ\nID\t"), Some(vec![1, 2, 3]));
        assert_eq!(from_base64(b"AQI"), None);
    }
}
