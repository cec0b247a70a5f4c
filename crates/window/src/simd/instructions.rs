//! Instruction sets, chosen at run time.

use std::fmt;
use std::str::FromStr;

/// An instruction set for which vector code is compiled. Narrower sets are less than wider ones.
///
/// ```
/// use geobench_window::simd::Instructions;
///
/// let widest = Instructions::detect();
/// assert!(widest.is_available() && Instructions::Scalar <= widest);
/// assert_eq!("avx2".parse(), Ok(Instructions::Avx2));
/// assert_eq!(Instructions::Avx512.or_narrower(), widest);
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Instructions {
    /// One number at a time, on any processor.
    Scalar,
    /// Four numbers at a time.
    Avx2,
    /// Eight numbers at a time.
    Avx512,
}

impl Instructions {
    /// All sets, from the narrowest to the widest.
    pub const ALL: [Self; 3] = [Self::Scalar, Self::Avx2, Self::Avx512];

    /// The widest set of this processor.
    pub fn detect() -> Self {
        Self::Avx512.or_narrower()
    }

    /// Whether this processor has the set.
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

    /// Whether this processor has the set.
    #[cfg(not(target_arch = "x86_64"))]
    pub fn is_available(self) -> bool {
        self == Self::Scalar
    }

    /// The next narrower set; `None` for [`Scalar`](Self::Scalar).
    pub fn narrower(self) -> Option<Self> {
        match self {
            Self::Avx512 => Some(Self::Avx2),
            Self::Avx2 => Some(Self::Scalar),
            Self::Scalar => None,
        }
    }

    /// This set if the processor has it, else the widest narrower one that it has.
    #[must_use]
    pub fn or_narrower(self) -> Self {
        let mut set = self;
        while !set.is_available() {
            set = set.narrower().unwrap_or(Self::Scalar);
        }
        set
    }

    /// The name in command lines and result files.
    pub fn name(self) -> &'static str {
        match self {
            Self::Scalar => "scalar",
            Self::Avx2 => "avx2",
            Self::Avx512 => "avx512",
        }
    }
}

/// Whether the processor has the bit instructions that vector code uses in addition.
#[cfg(target_arch = "x86_64")]
fn has_bit_instructions() -> bool {
    is_x86_feature_detected!("bmi1")
        && is_x86_feature_detected!("bmi2")
        && is_x86_feature_detected!("popcnt")
        && is_x86_feature_detected!("lzcnt")
}

impl fmt::Display for Instructions {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

impl FromStr for Instructions {
    type Err = UnknownInstructions;

    fn from_str(name: &str) -> Result<Self, UnknownInstructions> {
        let named = Self::ALL.into_iter().find(|set| set.name() == name);
        named.ok_or_else(|| UnknownInstructions(name.to_owned()))
    }
}

/// The name of no instruction set.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("unknown instructions `{0}`; expected `scalar`, `avx2` or `avx512`")]
pub struct UnknownInstructions(pub String);

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sets_are_found_by_their_names() {
        for set in Instructions::ALL {
            assert_eq!(set.to_string().parse(), Ok(set));
        }
        let unknown = "auto".parse::<Instructions>().unwrap_err();
        assert_eq!(
            unknown.to_string(),
            "unknown instructions `auto`; expected `scalar`, `avx2` or `avx512`"
        );
    }

    #[test]
    fn every_narrower_set_is_the_lesser() {
        for set in Instructions::ALL {
            assert!(set.narrower().is_none_or(|narrower| narrower < set));
            assert!(set.or_narrower() <= set && set.or_narrower().is_available());
        }
        assert_eq!(Instructions::Scalar.narrower(), None);
    }
}
