//! A plan as files hold it: in result files, so that a run can be repeated, and at the top of
//! journals, so that one is not continued with another plan. Everything that may change a result is
//! in it, and nothing else.

use std::collections::BTreeMap;
use std::fmt;
use std::ops::Range;
use std::str::FromStr;

use serde::{Deserialize, Serialize};
use serde_json::{Map, Value};

use super::IsolationRecord;

/// What was to be run.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct PlanRecord {
    /// Which part of the plan; null if all of it.
    pub shard: Option<Shard>,
    /// Where cells run.
    pub isolation: IsolationRecord,
    /// The groups, in order.
    pub groups: Vec<PlannedGroup>,
}

/// A group: every algorithm on every model from every source.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct PlannedGroup {
    /// Its name; null if it has none.
    pub name: Option<String>,
    /// The models, in order.
    pub models: Vec<PlannedModel>,
    /// The algorithms, in order.
    pub algorithms: Vec<PlannedAlgorithm>,
    /// The sources, as on the command line.
    pub sources: String,
    /// Timed runs of each cell.
    pub repeat: usize,
    /// Untimed runs of each cell before those.
    pub warmup: usize,
    /// What answers must agree with, as on the command line.
    pub reference: String,
    /// Largest relative difference that passes.
    pub tolerance: f64,
    /// What the order of the runs is drawn from.
    pub seed: u64,
    /// Seconds that each run may take; null if any number.
    pub timeout: Option<f64>,
    /// Bytes that the process of each cell may occupy; null if any number.
    pub memory_limit: Option<u64>,
    /// Bytes that a compressed model may decompress to; null for the usual limit.
    #[serde(default)]
    pub max_decompressed: Option<u64>,
}

/// A model.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct PlannedModel {
    /// Its name, unique in the plan.
    pub name: String,
    /// The generator's spec with all defaults; null if it is read from a file.
    pub spec: Option<String>,
    /// SHA-256 of the file that it is read from; null if there is none, or if it could not be read.
    pub file_sha256: Option<String>,
}

/// An algorithm.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct PlannedAlgorithm {
    /// The name by which cells call it.
    pub label: String,
    /// All its parameters, those at their defaults too; of an outside program, how it is called.
    pub parameters: BTreeMap<String, serde_json::Value>,
}

/// Part `index` of `count`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Shard {
    /// Which part, from 1.
    pub index: u32,
    /// How many there are.
    pub count: u32,
}

/// A text that names no part.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("`{text}` is not a part: give I/N such as 2/3, with I from 1 to N")]
pub struct ShardError {
    text: String,
}

impl FromStr for Shard {
    type Err = ShardError;

    fn from_str(text: &str) -> Result<Self, ShardError> {
        let parse = || {
            let (index, count) = text.split_once('/')?;
            let (index, count) = (index.trim().parse().ok()?, count.trim().parse().ok()?);
            (1..=count)
                .contains(&index)
                .then_some(Self { index, count })
        };
        parse().ok_or_else(|| ShardError { text: text.into() })
    }
}

impl fmt::Display for Shard {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}/{}", self.index, self.count)
    }
}

impl Shard {
    /// Whether this part has a unit.
    pub const fn holds(self, unit: u128) -> bool {
        unit % self.count as u128 == self.index as u128 - 1
    }

    /// How many of these units this part has.
    pub const fn held(self, units: Range<u128>) -> u128 {
        let (count, index) = (self.count as u128, self.index as u128);
        // Units below x that are held: those congruent to index - 1.
        let below_start = (units.start + count - index) / count;
        let below_end = (units.end + count - index) / count;
        below_end - below_start
    }
}

/// How much of a value is shown.
const SHOWN: usize = 60;

/// A place and what stands there on both sides, as text.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Difference {
    /// Such as `plan.groups[0].repeat`.
    pub(crate) place: String,
    pub(crate) left: String,
    pub(crate) right: String,
}

/// The first difference, if there is one.
pub(crate) fn first_difference(left: &Value, right: &Value) -> Option<Difference> {
    let mut found = search("", left, right)?;
    if let Some(place) = found.place.strip_prefix('.') {
        found.place = place.to_owned();
    }
    Some(found)
}

fn search(place: &str, left: &Value, right: &Value) -> Option<Difference> {
    let here = |left, right| Difference {
        place: place.to_owned(),
        left,
        right,
    };
    match (left, right) {
        (Value::Object(a), Value::Object(b)) => {
            let mut keys = a.keys().chain(b.keys().filter(|key| !a.contains_key(*key)));
            let of = |map: &Map<String, Value>, key| map.get(key).cloned().unwrap_or_default();
            keys.find_map(|key| search(&format!("{place}.{key}"), &of(a, key), &of(b, key)))
        }
        (Value::Array(a), Value::Array(b)) if a.len() != b.len() => {
            let count = |list: &[Value]| format!("a list of {}", list.len());
            Some(here(count(a), count(b)))
        }
        (Value::Array(a), Value::Array(b)) => {
            let mut pairs = a.iter().zip(b).enumerate();
            pairs.find_map(|(i, (a, b))| search(&format!("{place}[{i}]"), a, b))
        }
        _ => (left != right).then(|| here(shown(left), shown(right))),
    }
}

fn shown(value: &Value) -> String {
    let text = value.to_string();
    match text.char_indices().nth(SHOWN) {
        Some((end, _)) => format!("{}...", &text[..end]),
        None => text,
    }
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;

    #[test]
    fn parts_are_read() {
        assert_eq!("2/3".parse(), Ok(Shard { index: 2, count: 3 }));
        for text in ["", "1", "0/3", "4/3", "1/0", "-1/3", "1/3/5", "a/b"] {
            assert!(text.parse::<Shard>().is_err(), "{text}");
        }
    }

    #[test]
    fn the_first_difference_is_named_with_both_values() {
        let found = |a: Value, b: Value| {
            first_difference(&a, &b).map(|d| format!("{}: {} / {}", d.place, d.left, d.right))
        };
        let a = json!({"a": [{"b": 1, "c": "x"}], "d": null});
        assert_eq!(found(a.clone(), a.clone()), None);
        let b = json!({"a": [{"b": 1, "c": "y"}], "d": 2});
        assert_eq!(found(a.clone(), b).unwrap(), "a[0].c: \"x\" / \"y\"");
        let b = json!({"a": [], "d": null});
        assert_eq!(found(a.clone(), b).unwrap(), "a: a list of 1 / a list of 0");
        let b = json!({"a": [{"b": 1, "c": "x"}], "d": null, "e": 3});
        assert_eq!(found(a, b).unwrap(), "e: null / 3");
        let long = found(json!("x"), json!("y".repeat(99))).unwrap();
        assert!(long.ends_with("y...") && long.len() < 80);
    }
}
