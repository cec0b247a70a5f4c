//! Parameters of algorithms and their values.

use std::fmt;
use std::ops::RangeInclusive;
use std::str::FromStr;

use geobench_mesh::Mesh;
use geobench_window::queue::{HeapQueue, HeapShape};
use geobench_window::simd::Instructions;
use serde::ser::SerializeStruct;
use serde::{Serialize, Serializer};

use crate::UsageError;

/// The parameter that all parallel algorithms have, and no others.
pub(crate) const THREADS: Parameter = Parameter::integer(
    "threads",
    1,
    1..=MOST_THREADS as u64,
    "number of threads; by default that of --threads",
)
.or_words(&["default"])
.with_default(Value::Word("default"));

/// Maximum number of threads.
pub const MOST_THREADS: u32 = 1024;

/// A parameter of an algorithm: a number, one of a few words, or either.
///
/// ```
/// use geobench_registry::{Parameter, Value};
///
/// const KMAX: Parameter = Parameter::integer("kmax", 20_000, 1..=1_000_000, "greatest batch");
/// const WIDTH: Parameter = Parameter::real("width", 1.0, 0.01..=100.0, "width of a bucket");
/// const LIMIT: Parameter = Parameter::real("limit", 0.5, 0.0..=1.0, "drops what is below")
///     .or_words(&["none"])
///     .with_default(Value::Word("none"));
/// const ORDER: Parameter = Parameter::word("order", &["fifo", "nearest"], "the order of windows");
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Parameter {
    /// The key by which users set it, in lower case.
    pub name: &'static str,
    /// Its value by default.
    pub default: Value,
    /// The values it can take.
    #[serde(flatten)]
    pub allowed: Allowed,
    /// Its meaning, in one line.
    pub meaning: &'static str,
    /// The parameter on which this one depends, and the values which that one may have.
    #[serde(skip)]
    pub only_with: Option<(&'static str, &'static [&'static str])>,
    /// A word of earlier versions, and the word of today.
    #[serde(skip)]
    pub formerly: Option<(&'static str, &'static str)>,
}

/// A value of a parameter.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[serde(untagged)]
pub enum Value {
    /// A whole number.
    Integer(u64),
    /// A finite number.
    Real(f64),
    /// One of the words that the parameter knows.
    Word(&'static str),
}

/// The values that a parameter can take.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Allowed {
    /// The numbers.
    pub numbers: Numbers,
    /// The words; case is ignored.
    pub words: &'static [&'static str],
}

/// The numbers that a parameter can take. Ranges include both ends.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Numbers {
    /// None: it takes words only.
    None,
    /// Whole numbers in this range.
    Integers(u64, u64),
    /// Numbers in this range.
    Reals(f64, f64),
}

impl Serialize for Allowed {
    /// The ends of the range are null if only words are allowed.
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let ends = match self.numbers {
            Numbers::None => [None; 2],
            Numbers::Integers(least, most) => [least, most].map(|n| Some(Value::Integer(n))),
            Numbers::Reals(least, most) => [least, most].map(|x| Some(Value::Real(x))),
        };
        let mut fields = serializer.serialize_struct("Allowed", 4)?;
        fields.serialize_field("whole", &matches!(self.numbers, Numbers::Integers(..)))?;
        fields.serialize_field("min", &ends[0])?;
        fields.serialize_field("max", &ends[1])?;
        fields.serialize_field("words", self.words)?;
        fields.end()
    }
}

impl Parameter {
    const fn new(
        name: &'static str,
        default: Value,
        numbers: Numbers,
        words: &'static [&'static str],
        meaning: &'static str,
    ) -> Self {
        Self {
            name,
            default,
            allowed: Allowed { numbers, words },
            meaning,
            only_with: None,
            formerly: None,
        }
    }

    /// A parameter that is a whole number in `range`.
    pub const fn integer(
        name: &'static str,
        default: u64,
        range: RangeInclusive<u64>,
        meaning: &'static str,
    ) -> Self {
        let numbers = Numbers::Integers(*range.start(), *range.end());
        Self::new(name, Value::Integer(default), numbers, &[], meaning)
    }

    /// A parameter that is a real number in `range`.
    pub const fn real(
        name: &'static str,
        default: f64,
        range: RangeInclusive<f64>,
        meaning: &'static str,
    ) -> Self {
        let numbers = Numbers::Reals(*range.start(), *range.end());
        Self::new(name, Value::Real(default), numbers, &[], meaning)
    }

    /// A parameter that is one of `words`, at least one; the first is the default.
    pub const fn word(
        name: &'static str,
        words: &'static [&'static str],
        meaning: &'static str,
    ) -> Self {
        Self::new(name, Value::Word(words[0]), Numbers::None, words, meaning)
    }

    /// The parameter, with `words` allowed in place of a number.
    #[must_use]
    pub const fn or_words(mut self, words: &'static [&'static str]) -> Self {
        self.allowed.words = words;
        self
    }

    /// The parameter with another default.
    #[must_use]
    pub const fn with_default(mut self, default: Value) -> Self {
        self.default = default;
        self
    }

    /// The parameter, which now has an effect only if the parameter `name` is set to one of
    /// `words`.
    #[must_use]
    pub const fn only_with(mut self, name: &'static str, words: &'static [&'static str]) -> Self {
        self.only_with = Some((name, words));
        self
    }

    /// The parameter, for which earlier versions had the word `former` in place of `word`.
    #[must_use]
    pub(crate) const fn formerly(mut self, former: &'static str, word: &'static str) -> Self {
        self.formerly = Some((former, word));
        self
    }

    /// Parses a value; `None` if it is not allowed.
    pub fn parse(&self, text: &str) -> Option<Value> {
        let text = match self.formerly {
            Some((former, word)) if former.eq_ignore_ascii_case(text) => word,
            _ => text,
        };
        let word = |w: &&&str| w.eq_ignore_ascii_case(text);
        if let Some(word) = self.allowed.words.iter().find(word) {
            return Some(Value::Word(word));
        }
        match self.allowed.numbers {
            Numbers::None => None,
            Numbers::Integers(least, most) => {
                let n = text.parse().ok().filter(|n| (least..=most).contains(n));
                n.map(Value::Integer)
            }
            Numbers::Reals(least, most) => {
                let x = text.parse().ok().filter(|x| (least..=most).contains(x));
                x.map(Value::Real)
            }
        }
    }
}

impl fmt::Display for Value {
    /// The form of labels: the shortest text that parses to the same value.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Integer(n) => write!(f, "{n}"),
            Self::Real(x) => {
                let (plain, scientific) = (x.to_string(), format!("{x:e}"));
                f.write_str(if scientific.len() < plain.len() {
                    &scientific
                } else {
                    &plain
                })
            }
            Self::Word(word) => f.write_str(word),
        }
    }
}

impl fmt::Display for Allowed {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.numbers {
            Numbers::None => {}
            Numbers::Integers(least, most) => {
                write!(f, "a whole number from {least} to {most}")?;
            }
            Numbers::Reals(least, most) => write!(
                f,
                "a number from {} to {}",
                Value::Real(least),
                Value::Real(most)
            )?,
        }
        for (i, word) in self.words.iter().enumerate() {
            let or = i > 0 || self.numbers != Numbers::None;
            write!(f, "{}`{word}`", if or { " or " } else { "" })?;
        }
        Ok(())
    }
}

/// Values of the parameters of an algorithm. Unset parameters have their defaults.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Values {
    /// Values that differ from the defaults, in the order of the parameter table.
    given: Vec<(&'static str, Value)>,
    /// The widest vector instructions that the solver may use; `None` for the widest of the
    /// processor.
    pub(crate) widest: Option<Instructions>,
}

impl Values {
    /// The values in `given` that differ from the defaults, in the order of `parameters`.
    pub(crate) fn new(parameters: &[Parameter], given: &[(&Parameter, Value)]) -> Self {
        let find = |p: &Parameter| {
            let (_, value) = given.iter().find(|(g, _)| g.name == p.name)?;
            (*value != p.default).then_some((p.name, *value))
        };
        Self {
            given: parameters.iter().filter_map(find).collect(),
            widest: None,
        }
    }

    /// A copy with another value of `parameter`, which is one of `parameters`.
    pub(crate) fn with(
        &self,
        parameters: &[Parameter],
        parameter: &Parameter,
        value: Value,
    ) -> Self {
        let value_of = |p: &Parameter| {
            if p.name == parameter.name {
                value
            } else {
                self.get(p)
            }
        };
        let values: Vec<_> = parameters.iter().map(|p| (p, value_of(p))).collect();
        Self {
            widest: self.widest,
            ..Self::new(parameters, &values)
        }
    }

    /// The value of `parameter`.
    pub fn get(&self, parameter: &Parameter) -> Value {
        self.given
            .iter()
            .find(|(name, _)| *name == parameter.name)
            .map_or(parameter.default, |(_, value)| *value)
    }

    /// If the condition of `parameter` ([`only_with`](Parameter::only_with)) does not hold, the
    /// missing setting as `key=value`.
    pub(crate) fn missing_for(
        &self,
        parameters: &[Parameter],
        parameter: &Parameter,
    ) -> Option<String> {
        let (name, words) = parameter.only_with?;
        let other = parameters.iter().find(|p| p.name == name);
        let fits = other.and_then(|other| self.word(other));
        let fits = fits.is_some_and(|word| words.contains(&word));
        (!fits).then(|| format!("{name}={}", words[0]))
    }

    /// The value of [`THREADS`]; 1 if it is unset.
    pub(crate) fn threads(&self) -> usize {
        self.integer_or_word(&THREADS).unwrap_or(1) as usize
    }

    /// The value of an integer parameter; `None` if it is a word.
    pub(crate) fn integer_or_word(&self, parameter: &Parameter) -> Option<u64> {
        match self.get(parameter) {
            Value::Integer(n) => Some(n),
            Value::Real(_) | Value::Word(_) => None,
        }
    }

    /// The value of a real parameter; `None` if it is a word.
    pub(crate) fn real_or_word(&self, parameter: &Parameter) -> Option<f64> {
        match self.get(parameter) {
            Value::Real(x) => Some(x),
            Value::Integer(_) | Value::Word(_) => None,
        }
    }

    /// The value of an integer parameter that allows no words.
    ///
    /// # Panics
    ///
    /// If the parameter is of another kind, which is an error in the tables of the registry.
    pub fn integer(&self, parameter: &Parameter) -> u64 {
        self.integer_or_word(parameter)
            .unwrap_or_else(|| panic!("`{}` is not always a whole number", parameter.name))
    }

    /// The value of a real parameter that allows no words.
    ///
    /// # Panics
    ///
    /// If the parameter is of another kind, which is an error in the tables of the registry.
    pub fn real(&self, parameter: &Parameter) -> f64 {
        self.real_or_word(parameter)
            .unwrap_or_else(|| panic!("`{}` is not always a number", parameter.name))
    }

    /// The word that a parameter is set to; `None` if it is a number.
    pub fn word(&self, parameter: &Parameter) -> Option<&'static str> {
        match self.get(parameter) {
            Value::Word(word) => Some(word),
            Value::Integer(_) | Value::Real(_) => None,
        }
    }
}

impl fmt::Display for Values {
    /// The form of labels, `{key=value,...}`; empty if all values are defaults.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (i, (name, value)) in self.given.iter().enumerate() {
            write!(f, "{}{name}={value}", if i == 0 { '{' } else { ',' })?;
        }
        f.write_str(if self.given.is_empty() { "" } else { "}" })
    }
}

/// The priority queue of algorithms that take one window at a time. The order is the same in all
/// of them, so that only times differ.
pub(crate) const QUEUE: Parameter = Parameter::word(
    "queue",
    &["heap", "heap4", "calendar"],
    "the priority queue: `heap`: a binary heap, as in the paper; `heap4`: a heap of four children a node; `calendar`: buckets by distance, each sorted when it is due; the order and all counts are the same in all",
)
.formerly("priority", "calendar");

/// The heap that [`QUEUE`] or a parameter like it asks for.
pub(crate) fn heap_queue(values: &Values, queue: &Parameter) -> HeapQueue {
    HeapQueue::new(match values.word(queue) {
        Some("heap4") => HeapShape::Quaternary,
        _ => HeapShape::Binary,
    })
}

/// `$body` with `$queue` set up as the parameter `$parameter` says: a heap or a calendar queue.
macro_rules! with_queue {
    ($parameter:expr, $mesh:expr, $values:expr, |$queue:ident| $body:expr) => {
        if $values.word($parameter) == Some("calendar") {
            let $queue = geobench_window::queue::CalendarQueue::new($mesh);
            $body
        } else {
            let $queue = crate::parameter::heap_queue($values, $parameter);
            $body
        }
    };
}
pub(crate) use with_queue;

/// Drops narrow windows; off by default.
pub(crate) const THRESHOLD: Parameter = Parameter::real(
    "threshold",
    1e-6,
    0.0..=1.0,
    "drops windows narrower than this share of the model's longest side; distances are then no longer exact; \
     the papers use 1e-6",
)
.or_words(&["none"])
.with_default(Value::Word("none"));

/// The width of [`THRESHOLD`] in the units of `mesh`; 0 for a mesh without positions.
pub(crate) fn threshold_width(mesh: &Mesh, values: &Values) -> f64 {
    let Some(share) = values.real_or_word(&THRESHOLD) else {
        return 0.0;
    };
    let longest = mesh.bounding_box().map_or(0.0, |[low, high]| {
        let sides = [0, 1, 2].map(|k| high[k] - low[k]);
        sides.into_iter().fold(0.0, f64::max)
    });
    share * longest
}

/// The parameter for vector instructions.
pub(crate) const SIMD: Parameter = Parameter::word(
    "simd",
    &["auto", "avx512", "avx2", "scalar"],
    "widest vector instructions to use; narrower ones where the processor lacks them",
);

/// The vector instructions of a run, the value of `--simd`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum SimdChoice {
    /// The widest of the processor.
    #[default]
    Auto,
    /// These, or narrower ones if the processor lacks them.
    AtMost(Instructions),
}

impl fmt::Display for SimdChoice {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Auto => f.write_str("auto"),
            Self::AtMost(widest) => widest.fmt(f),
        }
    }
}

impl FromStr for SimdChoice {
    type Err = UsageError;

    /// Parses `auto`, `scalar`, `avx2` or `avx512`, in any letter case.
    fn from_str(text: &str) -> Result<Self, UsageError> {
        let name = text.to_lowercase();
        if name == "auto" {
            return Ok(Self::Auto);
        }
        name.parse().map(Self::AtMost).map_err(|_| {
            UsageError(format!(
                "`{text}` is not one of auto, scalar, avx2 and avx512"
            ))
        })
    }
}

impl Values {
    /// A copy with instructions no wider than `widest`. Labels do not show it.
    pub(crate) fn at_most(mut self, widest: Instructions) -> Self {
        self.widest = Some(widest);
        self
    }

    /// The widest instructions that the solver may use: the widest of this processor, unless the
    /// parameter `simd` or a limit is narrower.
    pub(crate) fn instructions(&self) -> Instructions {
        let there = Instructions::detect();
        let asked = self.word(&SIMD).and_then(|name| name.parse().ok());
        [asked, self.widest]
            .into_iter()
            .flatten()
            .fold(there, Instructions::min)
    }
}

#[cfg(test)]
mod tests {
    use geobench_mesh::{TriangleSoup, VertexId};

    use super::super::{select, select_one};
    use super::*;

    const K: Parameter = Parameter::integer("k", 5, 1..=9, "");
    const WIDTH: Parameter = Parameter::real("width", 1.0, 0.0..=1e9, "");
    const LIMIT: Parameter = Parameter::real("limit", 0.5, 0.0..=1.0, "")
        .or_words(&["none"])
        .with_default(Value::Word("none"));
    const ORDER: Parameter = Parameter::word("order", &["fifo", "nearest"], "");

    #[test]
    fn values_within_bounds_are_read() {
        assert_eq!(K.parse("9"), Some(Value::Integer(9)));
        assert_eq!(WIDTH.parse("1e-6"), Some(Value::Real(1e-6)));
        assert_eq!(LIMIT.parse("NONE"), Some(Value::Word("none")));
        assert_eq!(LIMIT.parse("1"), Some(Value::Real(1.0)));
        assert_eq!(ORDER.parse("nearest"), Some(Value::Word("nearest")));
        for (parameter, text) in [
            (K, "0"),
            (K, "10"),
            (K, "1.5"),
            (K, "-1"),
            (K, "99999999999999999999999"),
            (K, "none"),
            (WIDTH, "inf"),
            (WIDTH, "nan"),
            (WIDTH, "-1"),
            (LIMIT, "nine"),
            (ORDER, "1"),
            (ORDER, ""),
        ] {
            assert_eq!(parameter.parse(text), None, "{} = {text}", parameter.name);
        }
    }

    #[test]
    fn values_are_written_as_short_as_can_be() {
        let text = |x| Value::Real(x).to_string();
        assert_eq!(text(1e-6), "1e-6");
        assert_eq!(text(0.5), "0.5");
        assert_eq!(text(20_000.0), "2e4");
        assert_eq!(text(1.0), "1");
        assert_eq!(K.allowed.to_string(), "a whole number from 1 to 9");
        assert_eq!(LIMIT.allowed.to_string(), "a number from 0 to 1 or `none`");
        assert_eq!(ORDER.allowed.to_string(), "`fifo` or `nearest`");
    }

    #[test]
    fn parameters_not_given_have_their_default() {
        let all = [K, WIDTH, LIMIT];
        let values = Values::new(
            &all,
            &[(&LIMIT, Value::Real(0.25)), (&K, Value::Integer(5))],
        );
        assert_eq!(values.to_string(), "{limit=0.25}");
        assert_eq!(values.integer(&K), 5);
        assert_eq!(values.real(&WIDTH), 1.0);
        assert_eq!(values.real_or_word(&LIMIT), Some(0.25));
        assert_eq!(Values::default().real_or_word(&LIMIT), None);
        assert_eq!(Values::default().word(&ORDER), Some("fifo"));
        assert_eq!(Values::default().to_string(), "");
    }

    fn spot_check(list: &str) -> Vec<f64> {
        let spec = "gen:torus,faces=800,bump=0.1,seed=7";
        let spec: geobench_mesh::generate::Spec = spec.parse().unwrap();
        let soup: TriangleSoup = geobench_mesh::generate::generate(&spec).unwrap();
        let (mesh, _) = Mesh::from_soup(soup).unwrap();
        let mut solver = select(list).unwrap()[0].build(&mesh);
        solver.solve(&[VertexId::new(0)]).unwrap().distances
    }

    #[test]
    fn a_coarse_threshold_costs_exactness_and_none_does_not() {
        for name in ["mmp", "ich", "fwp-mmp", "vtp-ch", "vtp", "ftp"] {
            let exact = spot_check(name);
            assert_eq!(
                spot_check(&format!("{name}{{threshold=none}}")),
                exact,
                "{name}"
            );
            assert_eq!(
                spot_check(&format!("{name}{{threshold=0}}")),
                exact,
                "{name}"
            );
            let coarse = spot_check(&format!("{name}{{threshold=0.1}}"));
            let longer = exact.iter().zip(&coarse).filter(|(e, c)| c > e).count();
            assert!(longer > 0, "{name}");
            assert!(
                exact
                    .iter()
                    .zip(&coarse)
                    .all(|(e, c)| *c >= e * (1.0 - 1e-12)),
                "{name}"
            );
        }
    }

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
}
