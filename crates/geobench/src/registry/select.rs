//! How users ask for algorithms.

use std::sync::Arc;

use geobench_mesh::Mesh;
use geobench_vtp::Instructions;
use geobench_window::Solver;

use super::parameter::THREADS;
use super::program::{OUTSIDE, PREFIX};
use super::program::{Program, Programs, UnknownProgram};
use super::{Algorithm, Parameter, Value, Values, algorithms, failing};

/// An algorithm that a user asked for, with the values of its parameters.
#[derive(Clone, Debug)]
pub struct Selection {
    algorithm: Algorithm,
    values: Values,
    label: String,
    /// How many threads it may use, if it can use several and does not say so itself.
    threads: usize,
    /// The outside program behind it, if it is one and has been found.
    program: Option<Arc<Program>>,
}

impl Selection {
    /// The algorithm with these values.
    pub fn new(algorithm: &Algorithm, values: Values) -> Self {
        Self {
            algorithm: *algorithm,
            label: format!("{}{values}", algorithm.name),
            values,
            threads: 1,
            program: None,
        }
    }

    /// The outside program of this name, which is still to be found.
    fn outside(name: &str) -> Self {
        Self {
            label: format!("{PREFIX}{name}"),
            ..Self::new(&OUTSIDE, Values::default())
        }
    }

    /// Name of the outside program that it asks for; none if it is an algorithm of the suite.
    pub fn outside_name(&self) -> Option<&str> {
        self.label.strip_prefix(PREFIX)
    }

    /// The outside program behind it, once it has been [found](Self::find_program).
    pub const fn program(&self) -> Option<&Arc<Program>> {
        self.program.as_ref()
    }

    /// Looks up the outside program that it asks for, if it asks for one.
    ///
    /// # Errors
    ///
    /// When there is none of its name.
    pub fn find_program(&mut self, programs: &Programs) -> Result<(), UnknownProgram> {
        if let Some(name) = self.outside_name() {
            self.program = Some(programs.find(name)?);
        }
        Ok(())
    }

    /// Whether its distances are not held to the tolerance, because nobody says that they are
    /// exact.
    pub fn is_approximate(&self) -> bool {
        self.program
            .as_ref()
            .is_some_and(|program| program.approximate)
    }

    /// The algorithm.
    pub const fn algorithm(&self) -> &Algorithm {
        &self.algorithm
    }

    /// The name under which its results are shown and stored: that of the algorithm, followed by
    /// the parameters that do not have their defaults, as in `fwp-mmp{kmax=5000}`. The same
    /// algorithm with the same values has the same label however it was asked for.
    pub fn label(&self) -> &str {
        &self.label
    }

    /// The same on `threads` threads, unless it is not parallel or asks for a number of them by
    /// itself. What it is called stays the same.
    #[must_use]
    pub fn with_threads(mut self, threads: usize) -> Self {
        self.threads = threads;
        if let Value::Word(_) = self.values.get(&THREADS)
            && self.is_parallel()
        {
            let value = Value::Integer(threads as u64);
            self.values = self.values.with(self.algorithm.parameters, &THREADS, value);
        }
        self
    }

    /// The same with no wider instructions than `widest`, as far as it can be told. What it is
    /// called stays the same.
    #[must_use]
    pub fn at_most(mut self, widest: Instructions) -> Self {
        self.values = self.values.at_most(widest);
        self
    }

    /// The widest instructions that its solver may use.
    pub fn instructions(&self) -> Instructions {
        self.values.instructions()
    }

    /// Whether it is one of the suite's own parallel algorithms.
    fn is_parallel(&self) -> bool {
        let mut parameters = self.algorithm.parameters.iter();
        parameters.any(|parameter| parameter.name == THREADS.name)
    }

    /// On how many threads it runs.
    pub fn threads(&self) -> usize {
        match &self.program {
            Some(program) if program.takes_threads() => self.threads,
            _ if self.is_parallel() => self.values.integer_or_word(&THREADS).unwrap_or(1) as usize,
            _ => 1,
        }
    }

    /// All that tells it from others, so that [`select_one`] gives it again: its
    /// [label](Self::label), and the threads that it was [given](Self::with_threads).
    pub fn spelled(&self) -> String {
        if self.outside_name().is_some() {
            return self.label.clone();
        }
        format!("{}{}", self.algorithm.name, self.values)
    }

    /// The value of one of its parameters.
    pub fn value(&self, parameter: &Parameter) -> Value {
        self.values.get(parameter)
    }

    /// Sets the algorithm up for `mesh`.
    ///
    /// # Panics
    ///
    /// When it is an outside program, which has no solver here.
    pub fn build(&self, mesh: &Mesh) -> Box<dyn Solver> {
        (self.algorithm.build)(mesh, &self.values)
    }
}

/// Why a list of algorithms was not understood.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum SelectError {
    /// The list, or one place in it, is empty.
    #[error("an algorithm name is missing in `{list}`; give names separated by commas")]
    Empty {
        /// The list as it was given.
        list: String,
    },
    /// Several algorithms are asked for where there is room for one.
    #[error("`{list}` asks for {count} algorithms; name one algorithm")]
    Several {
        /// The list as it was given.
        list: String,
        /// How many it asks for.
        count: usize,
    },
    /// No algorithm, family or group has this name.
    #[error("there is no algorithm `{name}`{}; known are {known}", did_you_mean(suggestion.as_deref()))]
    Unknown {
        /// The name asked for.
        name: String,
        /// The nearest known name, if one is near.
        suggestion: Option<String>,
        /// All names that would be understood.
        known: String,
    },
    /// The parameters are not of the form `{key=value,...}`.
    #[error("`{item}` is not understood: parameters are written `name{{key=value,...}}`")]
    Malformed {
        /// The item as it was given.
        item: String,
    },
    /// The algorithm has no parameters at all.
    #[error("algorithm `{name}` takes no parameters, but `{key}` is given")]
    NoParameters {
        /// The algorithm.
        name: String,
        /// The parameter.
        key: String,
    },
    /// The algorithm has parameters, but not this one.
    #[error("algorithm `{name}` has no parameter `{key}`{}; it has {known}", did_you_mean(suggestion.as_deref()))]
    UnknownParameter {
        /// The algorithm.
        name: String,
        /// The parameter asked for.
        key: String,
        /// The nearest parameter that it has, if one is near.
        suggestion: Option<String>,
        /// All parameters that it has.
        known: String,
    },
    /// A parameter is given twice.
    #[error("algorithm `{name}`: parameter `{key}` is given twice")]
    Twice {
        /// The algorithm.
        name: String,
        /// The parameter.
        key: String,
    },
    /// The parameter would do nothing, since another one has not the value that it goes with.
    #[error("algorithm `{name}`: `{key}` does nothing without `{needs}`; leave it out")]
    Idle {
        /// The algorithm.
        name: String,
        /// The parameter.
        key: String,
        /// What it goes with, as it is written.
        needs: String,
    },
    /// The parameter cannot have this value.
    #[error("algorithm `{name}`: `{value}` is not a value of `{key}`, which is {allowed}")]
    Value {
        /// The algorithm.
        name: String,
        /// The parameter.
        key: String,
        /// What was given.
        value: String,
        /// What can be given.
        allowed: String,
    },
}

fn did_you_mean(suggestion: Option<&str>) -> String {
    suggestion.map_or_else(String::new, |name| format!(", did you mean `{name}`?"))
}

/// The algorithms that a comma-separated list of names, families, `exact` and `all` asks for, in
/// any letter case, in the order in which they are first named; each once, unless with other
/// values of its parameters.
///
/// # Errors
///
/// Names the first item that is not understood, with what would be.
pub fn select(list: &str) -> Result<Vec<Selection>, SelectError> {
    let mut chosen: Vec<Selection> = Vec::new();
    for item in split_outside_braces(list) {
        for selection in matches(item, list)? {
            if chosen.iter().all(|c| c.label != selection.label) {
                chosen.push(selection);
            }
        }
    }
    Ok(chosen)
}

/// The one algorithm that `name` asks for.
///
/// # Errors
///
/// As [`select`], and when there are several.
pub fn select_one(name: &str) -> Result<Selection, SelectError> {
    let mut selected = select(name)?;
    match (selected.len(), selected.pop()) {
        (1, Some(one)) => Ok(one),
        (count, _) => Err(SelectError::Several {
            list: name.to_owned(),
            count,
        }),
    }
}

/// What one item of a list asks for.
fn matches(item: &str, list: &str) -> Result<Vec<Selection>, SelectError> {
    let (name, settings) = split_parameters(item)?;
    if name.is_empty() {
        return Err(SelectError::Empty { list: list.into() });
    }
    if let Some(program) = name.strip_prefix(PREFIX) {
        return match settings.first() {
            _ if program.is_empty() => Err(SelectError::Empty { list: list.into() }),
            Some((key, _)) => Err(SelectError::NoParameters {
                name: name.clone(),
                key: key.clone(),
            }),
            None => Ok(vec![Selection::outside(program)]),
        };
    }
    let found: Vec<_> = algorithms()
        .iter()
        .filter(|a| match name.as_str() {
            "all" => true,
            "exact" => a.exact,
            _ => a.name == name || a.family == name,
        })
        .chain(failing().iter().filter(|a| a.name == name))
        .collect();
    if found.is_empty() {
        return Err(unknown(name));
    }
    found.iter().map(|a| with_settings(a, &settings)).collect()
}

/// `algorithm` with the values that `settings` gives to the parameters of these names.
fn with_settings(
    algorithm: &Algorithm,
    settings: &[(String, &str)],
) -> Result<Selection, SelectError> {
    let name = || algorithm.name.to_owned();
    let mut given: Vec<(&Parameter, Value)> = Vec::new();
    for (key, text) in settings {
        let Some(parameter) = algorithm.parameters.iter().find(|p| p.name == key) else {
            return Err(unknown_parameter(algorithm, key));
        };
        let Some(value) = parameter.parse(text) else {
            return Err(SelectError::Value {
                name: name(),
                key: key.clone(),
                value: (*text).to_owned(),
                allowed: parameter.allowed.to_string(),
            });
        };
        if given.iter().any(|(other, _)| other.name == parameter.name) {
            return Err(SelectError::Twice {
                name: name(),
                key: key.clone(),
            });
        }
        given.push((parameter, value));
    }
    let values = Values::new(algorithm.parameters, &given);
    for (parameter, _) in given {
        if let Some(needs) = values.missing_for(algorithm.parameters, parameter) {
            return Err(SelectError::Idle {
                name: name(),
                key: parameter.name.to_owned(),
                needs,
            });
        }
    }
    Ok(Selection::new(algorithm, values))
}

/// Splits at the commas that are not inside `{}`.
fn split_outside_braces(list: &str) -> impl Iterator<Item = &str> {
    let mut depth = 0_i32;
    list.split(move |c| {
        match c {
            '{' => depth = depth.saturating_add(1),
            '}' => depth = depth.saturating_sub(1),
            _ => {}
        }
        c == ',' && depth <= 0
    })
    .map(str::trim)
}

/// Keys in lower case with their values as written.
type Settings<'i> = Vec<(String, &'i str)>;

/// The name of one item in lower case, and its parameters.
fn split_parameters(item: &str) -> Result<(String, Settings<'_>), SelectError> {
    let malformed = || SelectError::Malformed { item: item.into() };
    let Some((name, rest)) = item.split_once('{') else {
        if item.contains(['}', '=']) {
            return Err(malformed());
        }
        return Ok((item.to_lowercase(), Vec::new()));
    };
    let body = rest.strip_suffix('}').ok_or_else(malformed)?;
    let settings = body
        .split(',')
        .filter(|_| !body.trim().is_empty())
        .map(|pair| match pair.split_once('=') {
            Some((key, value))
                if !key.trim().is_empty()
                    && !value.trim().is_empty()
                    && !pair.contains(['{', '}']) =>
            {
                Ok((key.trim().to_lowercase(), value.trim()))
            }
            _ => Err(malformed()),
        })
        .collect::<Result<_, _>>()?;
    Ok((name.trim().to_lowercase(), settings))
}

fn unknown(name: String) -> SelectError {
    let mut known: Vec<&str> = algorithms().iter().map(|a| a.name).collect();
    for algorithm in algorithms() {
        if !known.contains(&algorithm.family) {
            known.push(algorithm.family);
        }
    }
    known.extend(["exact", "all"]);
    SelectError::Unknown {
        suggestion: nearest(&name, &known),
        name,
        known: known.join(", "),
    }
}

fn unknown_parameter(algorithm: &Algorithm, key: &str) -> SelectError {
    let known: Vec<&str> = algorithm.parameters.iter().map(|p| p.name).collect();
    let (name, key) = (algorithm.name.to_owned(), key.to_owned());
    if known.is_empty() {
        return SelectError::NoParameters { name, key };
    }
    SelectError::UnknownParameter {
        suggestion: nearest(&key, &known),
        name,
        key,
        known: known.join(", "),
    }
}

/// The one of `known` that a mistyped `name` is likely to mean.
pub(crate) fn nearest(name: &str, known: &[&str]) -> Option<String> {
    known
        .iter()
        .map(|k| (strsim::damerau_levenshtein(name, k), *k))
        .filter(|(distance, k)| *distance <= 1 + k.len() / 4)
        .min()
        .map(|(_, k)| k.to_owned())
}

#[cfg(test)]
#[path = "tests.rs"]
mod tests;
