//! The algorithms of the registry, each with the values of its parameters that keep it exact.

use geobench_registry::UsageError;
use geobench_registry::{Algorithm, Numbers, Parameter, Selection, Value, select};

use crate::case::{Case, Limited};

/// Most faces of a mesh for `ch`, whose windows grow exponentially with the faces that they can go
/// around.
const MOST_FACES_OF_CH: usize = 40;

/// The algorithms that solve large meshes.
pub(crate) const JUDGES: [&str; 7] = [
    "mmp", "ich", "vtp", "fwp-ch", "mmp-fast", "vtp-fast", "pvtp",
];

/// The name of the certificate in lists of algorithms.
pub(crate) const CERTIFICATE: &str = "certificate";

/// The parameter that gives up exactness.
const APPROXIMATE: &str = "threshold";

/// The algorithms that a list of the command line selects. An item with parameters selects itself.
/// A name or a family selects the algorithms with all [`variants`], unless `plain`. Algorithms that
/// are not exact are left out.
pub(crate) fn selected(list: &str, plain: bool) -> Result<Vec<Selection>, UsageError> {
    let mut all: Vec<Selection> = Vec::new();
    for selection in select(list)? {
        let algorithm = *selection.algorithm();
        if !algorithm.exact {
            continue;
        }
        let more = if plain || selection.label() != algorithm.name {
            vec![selection]
        } else {
            variants(&algorithm)
        };
        for selection in more {
            if all.iter().all(|known| known.label() != selection.label()) {
                all.push(selection);
            }
        }
    }
    Ok(all)
}

/// The labels of the selected algorithms, and of the certificate, if the list names it or all.
pub(crate) fn labels(list: &str, plain: bool) -> Result<Vec<String>, UsageError> {
    let items: Vec<&str> = list.split(',').collect();
    let has_certificate = items.iter().any(|item| ["all", CERTIFICATE].contains(item));
    let others = items.into_iter().filter(|item| *item != CERTIFICATE);
    let others = others.collect::<Vec<_>>().join(",");
    let mut labels = Vec::new();
    if !others.is_empty() {
        let selected = selected(&others, plain)?;
        labels.extend(selected.iter().map(|s| s.label().to_owned()));
    }
    if has_certificate {
        labels.push(CERTIFICATE.to_owned());
    }
    Ok(labels)
}

/// The name of the algorithm in a label.
pub(crate) fn name_of(label: &str) -> &str {
    label.split('{').next().unwrap_or_default()
}

/// Whether `selection` must end on any mesh, since the number of its windows has a useful bound.
///
/// `ch` has none. Label correcting has none if only its order separates near windows from far ones:
/// those that wind around a needle then go on until nearer ones have their turn.
pub(crate) fn must_end(selection: &Selection) -> bool {
    let label = selection.label();
    let unordered = ["beta=none", "beta=1e6", "filter=none"];
    match name_of(label) {
        "ch" => false,
        "lc-mmp" | "lc-ch" => unordered.iter().all(|value| !label.contains(value)),
        _ => true,
    }
}

/// Whether the windows of `selection` are limited where those of `limited` are.
pub(crate) fn is_limited(selection: &Selection, limited: Limited) -> bool {
    match limited {
        Limited::None => false,
        Limited::NearestFirst => must_end(selection) && takes_nearest_first(selection),
        Limited::All => must_end(selection),
    }
}

/// Whether `selection` takes windows, or vertices with their windows, by distance.
///
/// `ich1` and a first-in, first-out queue take them breadth first. `pch`, the `fwp` kinds and
/// queues of buckets take all windows, or some thousands, of a round at once. Label correcting
/// takes those below a threshold in any order. All of these are the orders of their papers.
fn takes_nearest_first(selection: &Selection) -> bool {
    let label = selection.label();
    let is_coarse = match name_of(label) {
        "ich1" | "pch" | "fwp-mmp" | "fwp-ch" | "lc-mmp" | "lc-ch" => true,
        _ => ["queue=fifo", "queue=buckets"]
            .iter()
            .any(|queue| label.contains(queue)),
    };
    !is_coarse
}

/// Whether `selection` ends in reasonable time on `case`.
pub(crate) fn can_finish(selection: &Selection, case: &Case) -> bool {
    match selection.label() {
        _ if name_of(selection.label()) == "ch" => case.faces.len() <= MOST_FACES_OF_CH,
        label => !case.is_large() || JUDGES.contains(&label),
    }
}

/// Whether `selection` has the default of every parameter.
pub(crate) fn is_plain(selection: &Selection) -> bool {
    selection.label() == selection.algorithm().name
}

/// Values of parameters by name.
type Settings = Vec<(&'static str, String)>;

/// `algorithm` with its defaults, with every other value of one parameter, and with every pair of
/// other words of two parameters. A parameter that needs another one is combined with it.
fn variants(algorithm: &Algorithm) -> Vec<Selection> {
    let settings: Vec<(&Parameter, Vec<String>)> = algorithm
        .parameters
        .iter()
        .filter(|parameter| parameter.name != APPROXIMATE)
        .map(|parameter| (parameter, other_values(parameter)))
        .collect();
    let mut specs: Vec<Settings> = vec![Vec::new()];
    for (i, (parameter, values)) in settings.iter().enumerate() {
        for value in values {
            let one = with_needed(parameter, value);
            for (other, values) in &settings[i + 1..] {
                for value in values.iter().filter(|v| is_word(parameter, other, v)) {
                    specs.extend(joined(&one, with_needed(other, value)));
                }
            }
            specs.push(one);
        }
    }
    let parsed = specs.iter().filter_map(|settings| {
        let settings: Vec<String> = settings.iter().map(|(k, v)| format!("{k}={v}")).collect();
        let spec = format!("{}{{{}}}", algorithm.name, settings.join(","));
        match select(&spec) {
            Ok(selected) => Some(selected),
            // A parameter that works only with the default of a second one.
            Err(error) if error.to_string().contains("` does nothing without `") => None,
            Err(error) => panic!("{spec}: {error}"),
        }
    });
    parsed.flatten().collect()
}

/// The value of a parameter, after that of the parameter that it needs.
fn with_needed(parameter: &Parameter, value: &str) -> Settings {
    let needed = parameter
        .only_with
        .map(|(name, words)| (name, words[0].to_owned()));
    let own = (parameter.name, value.to_owned());
    needed.into_iter().chain([own]).collect()
}

/// Both settings; `None` if they contradict each other.
fn joined(one: &Settings, other: Settings) -> Option<Settings> {
    let mut all = one.clone();
    for (name, value) in other {
        match all.iter().find(|(known, _)| *known == name) {
            Some((_, known)) if *known != value => return None,
            Some(_) => {}
            None => all.push((name, value)),
        }
    }
    Some(all)
}

/// Whether a parameter takes words only, and `value` of `other` is one of its words.
fn is_word(parameter: &Parameter, other: &Parameter, value: &str) -> bool {
    parameter.allowed.numbers == Numbers::None && other.allowed.words.contains(&value)
}

/// The values of `parameter` except its default: every word, both ends of its range, and 1.
fn other_values(parameter: &Parameter) -> Vec<String> {
    let words = parameter
        .allowed
        .words
        .iter()
        .map(|&word| Value::Word(word));
    let numbers = match parameter.allowed.numbers {
        Numbers::None => Vec::new(),
        Numbers::Integers(..) if parameter.name == "threads" => vec![Value::Integer(2)],
        Numbers::Integers(least, most) => vec![
            Value::Integer(least),
            Value::Integer(1.clamp(least, most)),
            Value::Integer(most),
        ],
        Numbers::Reals(least, most) => vec![
            Value::Real(least),
            Value::Real(1.0_f64.clamp(least, most)),
            Value::Real(most),
        ],
    };
    let mut texts: Vec<String> = words
        .chain(numbers)
        .filter(|value| *value != parameter.default)
        .map(|value| value.to_string())
        .collect();
    texts.dedup();
    texts
}
