//! Every algorithm of the suite, in one table.
//!
//! This is the only place that knows which algorithms exist. The rest of the program reaches a
//! solver through [`Algorithm::build`] and the [`Solver`] trait; adding an algorithm is one entry
//! in the table behind [`algorithms`].

use geobench_ich::ich;
use geobench_mesh::Mesh;
use geobench_mmp::mmp;
use geobench_vtp::Vtp;
use geobench_window::{Counter, Solver};

/// What the suite knows about an algorithm.
#[derive(Clone, Copy, Debug)]
pub struct Algorithm {
    /// The name by which users ask for it, in lower case.
    pub name: &'static str,
    /// The group that `--algo` can ask for as a whole, such as `vtp-family`.
    pub family: &'static str,
    /// Where it is described: authors, year, section.
    pub paper: &'static str,
    /// Whether its distances are exact up to rounding.
    pub exact: bool,
    /// What it does, in one line.
    pub summary: &'static str,
    /// Worst-case time and space; n is the number of faces.
    pub complexity: &'static str,
    /// The counter of windows that the papers charge to its memory: those stored at the end for
    /// algorithms that keep every window, those alive at the peak for the others.
    pub memory_counter: Counter,
    /// Sets it up for a mesh; this is not part of the time reported for it.
    pub build: for<'m> fn(&'m Mesh) -> Box<dyn Solver + 'm>,
}

/// Every algorithm, in the order in which tables show them.
pub fn algorithms() -> &'static [Algorithm] {
    ALGORITHMS
}

const ALGORITHMS: &[Algorithm] = &[
    Algorithm {
        name: "mmp",
        family: "mmp-family",
        paper: "Mitchell, Mount, Papadimitriou 1987; Surazhsky et al. 2005, section 3",
        exact: true,
        summary: "windows kept on half-edges, overlaps trimmed at tie points, nearest first",
        complexity: "time O(n^2 log n), space O(n^2)",
        memory_counter: Counter::StoredWindows,
        build: |mesh| Box::new(mmp(mesh)),
    },
    Algorithm {
        name: "ich",
        family: "ch-family",
        paper: "Chen, Han 1990; Xin, Wang 2009, sections 3.2 and 3.3",
        exact: true,
        summary: "windows filtered by vertex distances and not kept, nearest first",
        complexity: "time O(n^2 log n), space O(n)",
        memory_counter: Counter::PeakWindows,
        build: |mesh| Box::new(ich(mesh)),
    },
    Algorithm {
        name: "vtp",
        family: "vtp-family",
        paper: "Qin et al. 2016, sections 4 and 5.2",
        exact: true,
        summary: "all windows around the nearest vertex cross its triangles together, pruned by rules 1, 2 and 3",
        complexity: "time O(n^2), space O(n)",
        memory_counter: Counter::PeakWindows,
        build: |mesh| Box::new(Vtp::new(mesh)),
    },
];

/// An algorithm that a user asked for, with its parameters.
#[derive(Clone, Copy, Debug)]
pub struct Selection {
    /// The algorithm.
    pub algorithm: &'static Algorithm,
}

impl Selection {
    /// The name under which its results are shown and stored.
    pub fn label(&self) -> &'static str {
        self.algorithm.name
    }

    /// Sets the algorithm up for `mesh`.
    pub fn build<'m>(&self, mesh: &'m Mesh) -> Box<dyn Solver + 'm> {
        (self.algorithm.build)(mesh)
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
    /// The algorithm has no such parameter.
    #[error("algorithm `{name}` takes no parameters, but `{key}` is given")]
    NoSuchParameter {
        /// The algorithm.
        name: String,
        /// The parameter.
        key: String,
    },
}

fn did_you_mean(suggestion: Option<&str>) -> String {
    suggestion.map_or_else(String::new, |name| format!(", did you mean `{name}`?"))
}

/// The algorithms that a comma-separated list of names, families, `exact` and `all` asks for, in
/// any letter case, each once, in the order in which they are first named.
///
/// # Errors
///
/// Names the first item that is not understood, with what would be.
pub fn select(list: &str) -> Result<Vec<Selection>, SelectError> {
    let mut chosen: Vec<Selection> = Vec::new();
    for item in split_outside_braces(list) {
        for algorithm in matches(item, list)? {
            if chosen.iter().all(|c| c.algorithm.name != algorithm.name) {
                chosen.push(Selection { algorithm });
            }
        }
    }
    Ok(chosen)
}

/// The algorithms that one item of a list names.
fn matches(item: &str, list: &str) -> Result<Vec<&'static Algorithm>, SelectError> {
    let (name, parameters) = split_parameters(item)?;
    if name.is_empty() {
        return Err(SelectError::Empty { list: list.into() });
    }
    let found: Vec<_> = algorithms()
        .iter()
        .filter(|a| match name.as_str() {
            "all" => true,
            "exact" => a.exact,
            _ => a.name == name || a.family == name,
        })
        .collect();
    match (found.is_empty(), parameters.first()) {
        (true, _) => Err(unknown(name)),
        (false, Some(key)) => Err(SelectError::NoSuchParameter {
            name,
            key: key.clone(),
        }),
        (false, None) => Ok(found),
    }
}

/// Splits at the commas that are not inside `{}`.
fn split_outside_braces(list: &str) -> impl Iterator<Item = &str> {
    let mut depth = 0_i32;
    list.split(move |c| {
        match c {
            '{' => depth += 1,
            '}' => depth -= 1,
            _ => {}
        }
        c == ',' && depth <= 0
    })
    .map(str::trim)
}

/// The name in lower case and the keys of the parameters of one item.
fn split_parameters(item: &str) -> Result<(String, Vec<String>), SelectError> {
    let malformed = || SelectError::Malformed { item: item.into() };
    let Some((name, rest)) = item.split_once('{') else {
        if item.contains(['}', '=']) {
            return Err(malformed());
        }
        return Ok((item.to_lowercase(), Vec::new()));
    };
    let body = rest.strip_suffix('}').ok_or_else(malformed)?;
    let keys = body
        .split(',')
        .filter(|_| !body.trim().is_empty())
        .map(|pair| match pair.split_once('=') {
            Some((key, value))
                if !key.trim().is_empty()
                    && !value.trim().is_empty()
                    && !pair.contains(['{', '}']) =>
            {
                Ok(key.trim().to_lowercase())
            }
            _ => Err(malformed()),
        })
        .collect::<Result<_, _>>()?;
    Ok((name.trim().to_lowercase(), keys))
}

fn unknown(name: String) -> SelectError {
    let mut known: Vec<&str> = algorithms().iter().map(|a| a.name).collect();
    for algorithm in algorithms() {
        if !known.contains(&algorithm.family) {
            known.push(algorithm.family);
        }
    }
    known.extend(["exact", "all"]);
    let suggestion = known
        .iter()
        .map(|k| (strsim::damerau_levenshtein(&name, k), *k))
        .filter(|(distance, k)| *distance <= 1 + k.len() / 4)
        .min()
        .map(|(_, k)| k.to_owned());
    SelectError::Unknown {
        name,
        suggestion,
        known: known.join(", "),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The names that scripts may rely on, from the command-line contract.
    const PROMISED: &str = "ch ich1 ich mmp mmp-edge fwp-mmp fwp-ch lc-mmp lc-ch ftp opftp vtp opvtp \
        vtp-exhaustive vtp-trimming vtp-mmp vtp-ch edge-based vtp-no-rule1 vtp-no-rules23 vtp-fast \
        pvtp window-vtp dijkstra fmm fmm-untidy heat svg avtp";

    fn names(list: &str) -> Vec<&'static str> {
        select(list).unwrap().iter().map(Selection::label).collect()
    }

    #[test]
    fn names_are_unique_and_promised() {
        for (i, algorithm) in algorithms().iter().enumerate() {
            assert!(
                PROMISED
                    .split_whitespace()
                    .any(|name| name == algorithm.name),
                "`{}` is not one of the promised names",
                algorithm.name
            );
            assert!(
                algorithms()[..i].iter().all(|a| a.name != algorithm.name),
                "`{}` stands twice in the table",
                algorithm.name
            );
            assert_eq!(algorithm.name, algorithm.name.to_lowercase());
            assert!(algorithms().iter().all(|a| a.name != algorithm.family));
        }
    }

    #[test]
    fn names_families_and_groups_in_any_case() {
        assert_eq!(names("vtp,mmp"), ["vtp", "mmp"]);
        assert_eq!(names(" VTP , Ich "), ["vtp", "ich"]);
        assert_eq!(names("vtp-family"), ["vtp"]);
        assert_eq!(names("exact").len(), 3);
        assert_eq!(names("ich,all"), ["ich", "mmp", "vtp"]);
        assert_eq!(names("mmp,MMP,mmp{}"), ["mmp"]);
    }

    #[test]
    fn an_unknown_name_brings_the_nearest_one() {
        let message = select("vtq").unwrap_err().to_string();
        assert!(message.starts_with("there is no algorithm `vtq`, did you mean `vtp`?"));
        assert!(message.contains("known are mmp, ich, vtp, mmp-family"));
        assert!(matches!(
            select("a-b-c-d"),
            Err(SelectError::Unknown {
                suggestion: None,
                ..
            })
        ));
    }

    #[test]
    fn parameters_are_read_and_refused_where_there_are_none() {
        assert_eq!(
            select("mmp{kmax=5,bucket=2},vtp").unwrap_err(),
            SelectError::NoSuchParameter {
                name: "mmp".into(),
                key: "kmax".into()
            }
        );
        for item in [
            "mmp{",
            "mmp}",
            "mmp{x}",
            "mmp{=1}",
            "mmp{a=}",
            "mmp{a=1}x",
            "mmp=1",
        ] {
            assert!(
                matches!(select(item), Err(SelectError::Malformed { .. })),
                "{item}"
            );
        }
        for list in ["", ",", "mmp,", "mmp,,vtp", "{a=1}"] {
            assert!(
                matches!(select(list), Err(SelectError::Empty { .. })),
                "{list}"
            );
        }
    }
}
