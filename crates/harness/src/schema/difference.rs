//! Finds the first difference between two JSON records, for error messages.

use serde_json::{Map, Value};

/// Maximum number of characters of a value in a message.
const SHOWN: usize = 60;

/// The path of a field, and its value on each side as text.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Difference {
    /// Path of the field, such as `plan.groups[0].repeat`.
    pub place: String,
    /// The value on the left as text.
    pub left: String,
    /// The value on the right as text.
    pub right: String,
}

/// The first difference between two values in depth-first order; `None` if they are equal. A
/// missing key counts as null.
pub fn first_difference(left: &Value, right: &Value) -> Option<Difference> {
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
