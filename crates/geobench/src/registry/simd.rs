//! Which vector instructions a solver may use.

use geobench_vtp::Instructions;

use super::{Parameter, Values};

/// The parameter of algorithms whose instructions can be chosen.
pub(super) const SIMD: Parameter = Parameter::word(
    "simd",
    &["auto", "avx512", "avx2", "scalar"],
    "instructions to use, the widest that there are by default; narrower ones where these are missing",
);

/// The instructions of this name.
pub(crate) fn instructions(name: &str) -> Option<Instructions> {
    [
        Instructions::Scalar,
        Instructions::Avx2,
        Instructions::Avx512,
    ]
    .into_iter()
    .find(|instructions| instructions.to_string() == name)
}

/// The widest instructions narrower than `instructions`.
pub(crate) fn next_narrower(instructions: Instructions) -> Option<Instructions> {
    match instructions {
        Instructions::Avx512 => Some(Instructions::Avx2),
        Instructions::Avx2 => Some(Instructions::Scalar),
        Instructions::Scalar => None,
    }
}

/// The narrower of two sets.
fn narrower(a: Instructions, b: Instructions) -> Instructions {
    if (a as u8) < (b as u8) { a } else { b }
}

impl Values {
    /// The same, but the solver uses no wider instructions than `widest`. This is no parameter: it
    /// does not show in labels.
    pub(super) fn at_most(mut self, widest: Instructions) -> Self {
        self.widest = Some(widest);
        self
    }

    /// The widest instructions that the solver may use: those of this processor, unless `simd` or a
    /// limit asks for narrower ones.
    pub(super) fn instructions(&self) -> Instructions {
        let there = Instructions::detect();
        let asked = self.word(&SIMD).and_then(instructions).unwrap_or(there);
        let asked = narrower(asked, self.widest.unwrap_or(asked));
        narrower(asked, there)
    }
}

#[cfg(test)]
mod tests {
    use super::super::select_one;
    use super::*;

    #[test]
    fn the_narrowest_of_processor_parameter_and_limit_is_used() {
        let there = Instructions::detect();
        let of = |list: &str| select_one(list).unwrap();
        assert_eq!(of("vtp-fast").instructions(), there);
        assert_eq!(of("mmp").instructions(), there);
        let scalar = of("vtp-fast{simd=scalar}");
        assert_eq!(scalar.instructions(), Instructions::Scalar);
        let limited = scalar.at_most(Instructions::Avx512);
        assert_eq!(limited.instructions(), Instructions::Scalar);
        for list in ["vtp", "vtp-fast", "vtp-fast{simd=avx2}"] {
            let limited = of(list).at_most(Instructions::Scalar);
            assert_eq!(limited.instructions(), Instructions::Scalar, "{list}");
            assert_eq!(limited.label(), of(list).label());
        }
    }

    #[test]
    fn instructions_are_found_by_their_names() {
        for name in ["scalar", "avx2", "avx512"] {
            assert_eq!(instructions(name).unwrap().to_string(), name);
        }
        assert_eq!(instructions("auto"), None);
        assert_eq!(next_narrower(Instructions::Scalar), None);
    }
}
