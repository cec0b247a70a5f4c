//! Labels of algorithms in result files: one label, one set of parameters.
//!
//! A label omits parameters that have their defaults. Defaults change between versions, and a file
//! may have been edited. So labels are made anew from the parameters of the plan when a file is
//! read. Cells of different files are then joined by their labels.

use std::collections::{BTreeMap, HashMap};

use geobench_registry::{self as registry, Algorithm, Parameter};
use serde_json::Value;

use super::{PlannedAlgorithm, ResultFile};

/// Gives every algorithm of `file` the label that this version has for its parameters.
pub(super) fn renew(file: &mut ResultFile) {
    let mut labels: HashMap<(Option<String>, String), String> = HashMap::new();
    for group in file.plan.iter_mut().flat_map(|plan| &mut plan.groups) {
        for one in &mut group.algorithms {
            let label = label(&one.label, &one.parameters);
            let former = std::mem::replace(&mut one.label, label.clone());
            labels.insert((group.name.clone(), former), label);
        }
        if let Some(label) = labels.get(&(group.name.clone(), group.reference.clone())) {
            group.reference.clone_from(label);
        }
    }
    for one in &mut file.algorithms {
        one.label = label(&one.label, &one.parameters);
    }
    let has_parameters = file.plan.is_some() || !file.algorithms.is_empty();
    let renew = |group: &Option<String>, shown: &mut String| {
        if let Some(label) = labels.get(&(group.clone(), shown.clone())) {
            shown.clone_from(label);
        } else if !has_parameters {
            *shown = renewed(shown, BTreeMap::new());
        }
    };
    for cell in &mut file.cells {
        // Older versions had no protocol 2, and no mark of claims.
        let time = &mut cell.time;
        time.unconfirmed |= !time.doubted && time.ping.len() < time.claimed.len();
        renew(&cell.group, &mut cell.algorithm);
        if let Some(reference) = &mut cell.check.reference {
            renew(&cell.group, reference);
        }
    }
    for group in &mut file.groups {
        if let Some(base) = &mut group.ratios_to {
            renew(&group.name, base);
        }
    }
}

/// The label that this version has for the algorithm `label` of a record with these parameters.
pub fn renewed(label: &str, parameters: BTreeMap<String, Value>) -> String {
    let mut one = PlannedAlgorithm {
        label: label.to_owned(),
        parameters,
    };
    one.complete();
    self::label(&one.label, &one.parameters)
}

/// The label of an algorithm with these parameters. Parameters that are missing have the values of
/// `former`, its label so far, or their defaults. A label of an unknown algorithm stays.
fn label(former: &str, parameters: &BTreeMap<String, Value>) -> String {
    let name = former.split('{').next().unwrap_or_default();
    let Some(algorithm) = registry::find(name) else {
        return former.to_owned();
    };
    let settings = settings(former);
    let text = |key: &str| match parameters.get(key) {
        Some(Value::String(word)) => Some(word.clone()),
        Some(value) => Some(value.to_string()),
        None => settings.get(key).map(|&value| value.to_owned()),
    };
    let parsed = |parameter: &Parameter| {
        let given = text(parameter.name)?;
        Some(
            parameter
                .parse(&given)
                .map_or(given, |value| value.to_string()),
        )
    };
    let value =
        |parameter: &Parameter| parsed(parameter).unwrap_or_else(|| parameter.default.to_string());
    // The number of threads is a field of cells.
    let is_shown = |key: &str| key != "threads" || settings.contains_key(key);
    let mut shown: Vec<(&str, String)> = Vec::new();
    for parameter in algorithm.parameters {
        let is_used = parameter.only_with.is_none_or(|(other, words)| {
            let mut others = algorithm.parameters.iter();
            let other = others.find(|one| one.name == other).map(value);
            other.is_some_and(|other| words.contains(&&*other))
        });
        let value = value(parameter);
        if is_used && value != parameter.default.to_string() && is_shown(parameter.name) {
            shown.push((parameter.name, value));
        }
    }
    for (key, fact) in algorithm.facts() {
        shown.extend(text(key).filter(|value| value != fact).map(|v| (key, v)));
    }
    let foreign = parameters.keys().filter(|key| !has(algorithm, key));
    for key in foreign {
        shown.extend(text(key).map(|value| (&**key, value)));
    }
    if shown.is_empty() {
        return algorithm.name.to_owned();
    }
    let shown: Vec<String> = shown.iter().map(|(k, v)| format!("{k}={v}")).collect();
    format!("{}{{{}}}", algorithm.name, shown.join(","))
}

/// Whether `key` is a parameter or a fact of `algorithm`.
fn has(algorithm: &Algorithm, key: &str) -> bool {
    let mut parameters = algorithm.parameters.iter();
    parameters.any(|parameter| parameter.name == key)
        || algorithm.facts().any(|(fact, _)| fact == key)
}

/// The parameters in a label.
fn settings(label: &str) -> HashMap<&str, &str> {
    let inner = label.split_once('{').map_or("", |(_, rest)| rest);
    let inner = inner.strip_suffix('}').unwrap_or(inner);
    inner
        .split(',')
        .filter_map(|pair| pair.split_once('='))
        .collect()
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;

    fn of(label: &str, parameters: &Value) -> String {
        let one = json!({"label": label, "parameters": parameters});
        let one: PlannedAlgorithm = serde_json::from_value(one).unwrap();
        super::label(&one.label, &one.parameters)
    }

    #[test]
    fn a_label_has_the_parameters_that_differ_from_the_defaults() {
        let new = |queue| json!({"queue": queue, "crossing": "single", "threshold": "none"});
        assert_eq!(of("ich", &new("heap")), "ich");
        assert_eq!(of("ich", &new("calendar")), "ich{queue=calendar}");
        assert_eq!(of("ich{queue=calendar}", &new("heap")), "ich");
        assert_eq!(of("ext:other", &json!({"command": []})), "ext:other");
        assert_eq!(of("no-such", &json!({"a": 1})), "no-such");
        let graph = json!({"build": "ich", "queue": "buckets", "crossing": "none"});
        assert_eq!(of("svg{build=ich}", &graph), "svg{build=ich}");
        let threads = json!({"threads": 4, "bucket": 0.5, "queue": "buckets", "crossing": "list"});
        assert_eq!(of("pvtp", &threads), "pvtp{bucket=0.5}");
        assert_eq!(
            of("pvtp{threads=4}", &threads),
            "pvtp{threads=4,bucket=0.5}"
        );
        // The queue does nothing where lists are taken.
        let lists = json!({"turn": "list", "queue": "fifo", "crossing": "single"});
        assert_eq!(of("mmp{turn=list}", &lists), "mmp{turn=list}");
        assert_eq!(
            of("fwp-mmp", &json!({"width": 3, "crossing": "single"})),
            "fwp-mmp{width=3}"
        );
    }

    #[test]
    fn without_the_new_keys_queues_are_calendars_and_eight_windows_cross_at_once() {
        let old = |label, parameters: Value| of(label, &parameters);
        assert_eq!(
            old("mmp", json!({"queue": "priority", "turn": "window"})),
            "mmp{queue=calendar}"
        );
        assert_eq!(
            old("mmp{queue=fifo}", json!({"queue": "fifo"})),
            "mmp{queue=fifo}"
        );
        assert_eq!(old("mmp-edge", json!({})), "mmp-edge{queue=calendar}");
        assert_eq!(old("ich", json!({})), "ich{queue=calendar,crossing=joint}");
        assert_eq!(
            old("fwp-ch", json!({"bucket": 1.0})),
            "fwp-ch{crossing=joint}"
        );
        // Its queue was called a heap, and was a calendar.
        assert_eq!(
            old("lct11", json!({"queue": "heap"})),
            "lct11{queue=calendar}"
        );
        assert_eq!(
            old("lct11{queue=buckets}", json!({"queue": "buckets"})),
            "lct11{queue=buckets}"
        );
        // Its graph was built by the fast form of ICH, which was called `ich`.
        assert_eq!(old("svg", json!({"k": 50, "build": "ich"})), "svg");
        assert_eq!(
            old("svg{k=10}", json!({"k": 10, "build": "ich"})),
            "svg{k=10}"
        );
        for unchanged in ["vtp", "vtp-fast", "mmp-fast", "fwp-mmp", "window-vtp"] {
            assert_eq!(old(unchanged, json!({})), unchanged);
        }
    }
}
