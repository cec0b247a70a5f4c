//! Sets of instructions, chosen when the program runs.

use std::fmt;

/// The instructions of which the kernels are made.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Instructions {
    /// One number at a time; any processor.
    Scalar,
    /// Four numbers at a time.
    Avx2,
    /// Eight numbers at a time.
    Avx512,
}

impl Instructions {
    /// The best ones that this processor has.
    pub fn detect() -> Self {
        [Self::Avx512, Self::Avx2]
            .into_iter()
            .find(|instructions| instructions.is_available())
            .unwrap_or(Self::Scalar)
    }

    /// Whether this processor has them.
    #[cfg(target_arch = "x86_64")]
    pub fn is_available(self) -> bool {
        match self {
            Self::Scalar => true,
            Self::Avx2 => is_x86_feature_detected!("avx2") && has_bit_instructions(),
            Self::Avx512 => {
                is_x86_feature_detected!("avx512f")
                    && is_x86_feature_detected!("avx512dq")
                    && is_x86_feature_detected!("avx512vl")
                    && has_bit_instructions()
            }
        }
    }

    /// Whether this processor has them.
    #[cfg(not(target_arch = "x86_64"))]
    pub fn is_available(self) -> bool {
        self == Self::Scalar
    }

    /// These if the processor has them, else the best ones below that it has.
    #[must_use]
    pub(crate) fn or_less(self) -> Self {
        match self {
            _ if self.is_available() => self,
            Self::Avx512 => Self::Avx2.or_less(),
            _ => Self::Scalar,
        }
    }
}

/// The instructions on bits that the vector programs use besides.
#[cfg(target_arch = "x86_64")]
fn has_bit_instructions() -> bool {
    is_x86_feature_detected!("bmi1")
        && is_x86_feature_detected!("bmi2")
        && is_x86_feature_detected!("popcnt")
        && is_x86_feature_detected!("lzcnt")
}

impl fmt::Display for Instructions {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Scalar => "scalar",
            Self::Avx2 => "avx2",
            Self::Avx512 => "avx512",
        })
    }
}
