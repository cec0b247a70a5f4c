//! Parses lists of algorithms with their parameters.

use std::str::FromStr;
use std::sync::Arc;

use geobench_mesh::{Mesh, did_you_mean};
use geobench_voronoi::FieldSolver;
use geobench_window::Solver;
use geobench_window::simd::Instructions;

use super::parameter::{THREADS, THRESHOLD};
use super::program::{OUTSIDE, PREFIX};
use super::program::{Program, Programs};
use super::{Algorithm, Parameter, SimdChoice, Value, Values, algorithms, by_name_only};
use crate::UsageError;

/// An algorithm with its parameter values.
#[derive(Clone, Debug)]
pub struct Selection {
    algorithm: Algorithm,
    values: Values,
    label: String,
    /// Number of threads, unless the parameters set it.
    threads: usize,
    is_optional: bool,
    /// The external program, once it has been looked up.
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
            is_optional: false,
            program: None,
        }
    }

    /// The same as part of a set, such as a family or a default.
    #[must_use]
    pub fn as_optional(self) -> Self {
        Self {
            is_optional: true,
            ..self
        }
    }

    /// Whether it is selected as part of a set: a family, `exact`, `all` or a default. A model that
    /// it cannot solve then goes without it. One that is named fails.
    pub const fn is_optional(&self) -> bool {
        self.is_optional
    }

    /// The external program of this name, not yet looked up.
    fn outside(name: &str) -> Self {
        Self {
            label: format!("{PREFIX}{name}"),
            ..Self::new(&OUTSIDE, Values::default())
        }
    }

    /// Name of the external program; `None` for an algorithm of the registry.
    pub fn outside_name(&self) -> Option<&str> {
        self.label.strip_prefix(PREFIX)
    }

    /// The external program, once it has been [looked up](Self::find_programs).
    pub const fn program(&self) -> Option<&Arc<Program>> {
        self.program.as_ref()
    }

    /// Looks up the external programs that this selects; an algorithm of the registry selects
    /// itself.
    ///
    /// # Errors
    ///
    /// If there is no program of this name.
    pub fn find_programs(&self, programs: &Programs) -> Result<Vec<Self>, UsageError> {
        let Some(name) = self.outside_name() else {
            return Ok(vec![self.clone()]);
        };
        let mut names = programs.meant_by(name);
        if names.is_empty() {
            names.push(name.to_owned());
        }
        let found = names.iter().map(|name| {
            let program = Some(programs.find(name)?);
            Ok(Self {
                program,
                label: format!("{PREFIX}{name}"),
                ..self.clone()
            })
        });
        found.collect()
    }

    /// Whether the tolerance does not apply: the algorithm is approximate, or the external program
    /// is declared approximate.
    pub fn is_approximate(&self) -> bool {
        match &self.program {
            Some(program) => program.approximate,
            None => !self.algorithm.exact && self.outside_name().is_none(),
        }
    }

    /// Whether its distances are exact up to rounding and thus usable as a reference: it is not
    /// approximate and drops no narrow windows. An external program counts as exact until it is
    /// looked up.
    pub fn is_exact(&self) -> bool {
        let drops_windows = (self.algorithm.parameters.iter())
            .filter(|parameter| parameter.name == THRESHOLD.name)
            .any(|parameter| self.values.real_or_word(parameter).is_some_and(|x| x > 0.0));
        !self.is_approximate() && !drops_windows
    }

    /// Whether a run ends once the distances of its goal are final. External programs always
    /// compute all distances.
    pub const fn ends_early(&self) -> bool {
        self.algorithm.ends_early
    }

    /// Whether it solves meshes with [junctions](Mesh::junction). An external program is asked.
    pub fn crosses_junctions(&self) -> bool {
        self.algorithm.crosses_junctions || self.outside_name().is_some()
    }

    /// Proven bound on the relative error of its distances, rounding aside; `None` without one.
    pub fn error_bound(&self) -> Option<f64> {
        (self.algorithm.error_bound)(&self.values)
    }

    /// The largest relative difference from exact distances that passes, if `tolerance` passes for
    /// exact algorithms: a proven bound takes its place if it is larger.
    pub fn tolerance(&self, tolerance: f64) -> f64 {
        tolerance.max(self.error_bound().unwrap_or(0.0))
    }

    /// Whether its distances may differ from exact ones by any finite amount: it is approximate,
    /// without a proven bound.
    pub fn may_differ(&self) -> bool {
        self.is_approximate() && self.error_bound().is_none()
    }

    /// The algorithm.
    pub const fn algorithm(&self) -> &Algorithm {
        &self.algorithm
    }

    /// The name of its results in files and tables: the algorithm, followed by the parameters that
    /// differ from their defaults, as in `fwp-mmp{kmax=5000}`. The notation of the user does not
    /// affect it.
    pub fn label(&self) -> &str {
        &self.label
    }

    /// Sets the number of threads of a parallel algorithm, unless its parameters set one. The label
    /// does not change.
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

    /// Sets the vector instructions of the run. The label does not change.
    #[must_use]
    pub fn with_simd(self, simd: SimdChoice) -> Self {
        match simd {
            SimdChoice::Auto => self,
            SimdChoice::AtMost(widest) => self.at_most(widest),
        }
    }

    /// [`with_simd`](Self::with_simd) for a table: `auto` means scalar instructions, so that
    /// algorithms of papers are compared and not their code, but the widest for fast forms.
    #[must_use]
    pub fn with_simd_in_table(self, simd: SimdChoice) -> Self {
        match simd {
            SimdChoice::Auto if !self.algorithm.fast => self.at_most(Instructions::Scalar),
            _ => self.with_simd(simd),
        }
    }

    /// Limits the vector instructions to `widest`. The label does not change.
    #[must_use]
    pub fn at_most(mut self, widest: Instructions) -> Self {
        self.values = self.values.at_most(widest);
        self
    }

    /// The widest instructions that its solver may use.
    pub fn instructions(&self) -> Instructions {
        self.values.instructions()
    }

    /// The name of these instructions; `None` for an external program.
    pub fn simd(&self) -> Option<String> {
        self.outside_name()
            .is_none()
            .then(|| self.instructions().to_string())
    }

    /// Whether it is a parallel algorithm of the registry.
    fn is_parallel(&self) -> bool {
        let mut parameters = self.algorithm.parameters.iter();
        parameters.any(|parameter| parameter.name == THREADS.name)
    }

    /// The number of threads that it runs on.
    pub fn threads(&self) -> usize {
        match &self.program {
            Some(program) if program.takes_threads() => self.threads,
            _ if self.is_parallel() => self.values.threads(),
            _ => 1,
        }
    }

    /// The text from which [`select_one`] restores this selection: its [label](Self::label) with
    /// its [threads](Self::with_threads).
    pub fn spelled(&self) -> String {
        if self.outside_name().is_some() {
            return self.label.clone();
        }
        format!("{}{}", self.algorithm.name, self.values)
    }

    /// All parameters with their values, and the [facts](Algorithm::facts). Results of selections
    /// with equal settings can be compared. None of an external program, which has its description.
    pub fn settings(&self) -> impl Iterator<Item = (&'static str, Value)> {
        let parameters = self.algorithm.parameters.iter();
        let facts = self
            .outside_name()
            .is_none()
            .then(|| self.algorithm.facts());
        let facts = facts.into_iter().flatten();
        parameters
            .map(|parameter| (parameter.name, self.values.get(parameter)))
            .chain(facts.map(|(name, word)| (name, Value::Word(word))))
    }

    /// The value of one of its parameters.
    pub fn value(&self, parameter: &Parameter) -> Value {
        self.values.get(parameter)
    }

    /// Sets up a solver for Voronoi diagrams; `None` if the algorithm keeps no windows of which
    /// diagrams could be made.
    pub fn field_solver(&self, mesh: &Mesh) -> Option<Box<dyn FieldSolver>> {
        self.algorithm.field.map(|field| field(mesh, &self.values))
    }

    /// Sets up a solver for `mesh`.
    ///
    /// # Panics
    ///
    /// For an external program, which has no solver in this process.
    pub fn build(&self, mesh: &Mesh) -> Box<dyn Solver> {
        (self.algorithm.build)(mesh, &self.values)
    }
}

/// Parses a comma-separated list of names, families, `exact` and `all`; case is ignored. The result
/// has the order of the list, without duplicates of an algorithm with the same parameter values.
///
/// # Errors
///
/// Names the first invalid item and the allowed values.
pub fn select(list: &str) -> Result<Vec<Selection>, UsageError> {
    let items = split_outside_braces(list).map(|item| matches(item, list));
    let items = items.collect::<Result<Vec<_>, UsageError>>()?;
    Ok(distinct(items.into_iter().flatten()))
}

/// `selections` in their order, each label once. It is optional if all of that label are.
pub fn distinct(selections: impl IntoIterator<Item = Selection>) -> Vec<Selection> {
    let mut chosen: Vec<Selection> = Vec::new();
    for selection in selections {
        match chosen.iter_mut().find(|one| one.label == selection.label) {
            Some(one) => one.is_optional &= selection.is_optional,
            None => chosen.push(selection),
        }
    }
    chosen
}

/// Parses the name of one algorithm.
///
/// # Errors
///
/// As [`select`], and if there are several algorithms.
pub fn select_one(name: &str) -> Result<Selection, UsageError> {
    let mut selected = select(name)?;
    match (selected.len(), selected.pop()) {
        (1, Some(one)) => Ok(one),
        (count, _) => Err(UsageError(format!(
            "`{name}` asks for {count} algorithms; name one algorithm"
        ))),
    }
}

impl FromStr for Selection {
    type Err = UsageError;

    fn from_str(name: &str) -> Result<Self, UsageError> {
        select_one(name)
    }
}

/// The algorithms of one item of a list.
fn matches(item: &str, list: &str) -> Result<Vec<Selection>, UsageError> {
    let (name, settings) = split_parameters(item)?;
    let program = name.strip_prefix(PREFIX);
    if program.unwrap_or(&name).is_empty() {
        return Err(UsageError(format!(
            "an algorithm name is missing in `{list}`; give names separated by commas"
        )));
    }
    if let Some(program) = program {
        // Its parameters are validated when it is looked up.
        let values: Vec<String> = settings.iter().map(|(k, v)| format!("{k}={v}")).collect();
        return Ok(vec![Selection::outside(&if values.is_empty() {
            program.to_owned()
        } else {
            format!("{program}{{{}}}", values.join(","))
        })]);
    }
    let found: Vec<_> = algorithms()
        .iter()
        .filter(|a| match name.as_str() {
            "all" => true,
            "exact" => a.exact,
            _ => a.name == name || a.family == name,
        })
        .chain(by_name_only().filter(|a| a.name == name))
        .collect();
    if found.is_empty() {
        return Err(unknown(&name));
    }
    let selections = found.iter().map(|algorithm| {
        let selection = with_settings(algorithm, &settings)?;
        Ok(if algorithm.name == name {
            selection
        } else {
            selection.as_optional()
        })
    });
    selections.collect()
}

/// `algorithm` with these parameter values.
fn with_settings(
    algorithm: &Algorithm,
    settings: &[(String, &str)],
) -> Result<Selection, UsageError> {
    let (name, parameters) = (algorithm.name, algorithm.parameters);
    let error = |problem| Err(UsageError(format!("algorithm `{name}`: {problem}")));
    let mut given: Vec<(&Parameter, Value)> = Vec::new();
    for (key, text) in settings {
        let Some(parameter) = parameters.iter().find(|p| p.name == key) else {
            return Err(unknown_parameter(name, parameters, key));
        };
        let Some(value) = parameter.parse(text) else {
            let allowed = parameter.allowed;
            return error(format!(
                "`{text}` is not a value of `{key}`, which is {allowed}"
            ));
        };
        if given.iter().any(|(other, _)| other.name == parameter.name) {
            return error(format!("parameter `{key}` is given twice"));
        }
        given.push((parameter, value));
    }
    let values = Values::new(parameters, &given);
    for (parameter, _) in given {
        if let Some(needs) = values.missing_for(parameters, parameter) {
            let key = parameter.name;
            return error(format!(
                "`{key}` does nothing without `{needs}`; leave it out"
            ));
        }
    }
    Ok(Selection::new(algorithm, values))
}

/// Splits at commas outside of `{}`.
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

/// Keys in lower case, with their values unchanged.
type GivenValues<'i> = Vec<(String, &'i str)>;

/// Splits an item into its name in lower case and its parameters.
fn split_parameters(item: &str) -> Result<(String, GivenValues<'_>), UsageError> {
    let malformed = || {
        UsageError(format!(
            "`{item}` is not understood: parameters are written `name{{key=value,...}}`"
        ))
    };
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

fn unknown(name: &str) -> UsageError {
    let mut known: Vec<&str> = algorithms().iter().map(|a| a.name).collect();
    for algorithm in algorithms() {
        if !known.contains(&algorithm.family) {
            known.push(algorithm.family);
        }
    }
    known.extend(["exact", "all"]);
    UsageError(format!(
        "there is no algorithm `{name}`{}; known are {}",
        did_you_mean(name, &known),
        known.join(", ")
    ))
}

fn unknown_parameter(algorithm: &str, parameters: &[Parameter], key: &str) -> UsageError {
    let known: Vec<&str> = parameters.iter().map(|p| p.name).collect();
    UsageError(if known.is_empty() {
        format!("algorithm `{algorithm}` takes no parameters, but `{key}` is given")
    } else {
        format!(
            "algorithm `{algorithm}` has no parameter `{key}`{}; it has {}",
            did_you_mean(key, &known),
            known.join(", ")
        )
    })
}

#[cfg(test)]
mod tests;
