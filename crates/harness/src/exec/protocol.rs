//! The protocol between this program and its children; `docs/protocol.md` describes it.
//!
//! A child writes a [`Reply`], one line of JSON, when it has loaded the model and after each
//! request. Children are outside programs, and this program itself for the algorithms of the suite.

use std::time::Duration;

use geobench_mesh::did_you_mean;
use geobench_window::{Counter, Counters};
use serde::{Deserialize, Serialize};
use serde_json::Value;

use crate::exec::{Observation, Pass};
use crate::measure::memory::Peaks;
use crate::schema::{ModelRecord, SourceLabel};
use crate::usage::quoted;

/// Request to an outside program with `protocol = "session"`. Its command names the model and the
/// source.
pub(crate) const SOLVE: &str = "solve";

/// Number of pings before each solve of protocol 2.
pub(crate) const PINGS: usize = 5;

/// Pause before each ping. As during a solve, both processes then sleep.
pub(crate) const PAUSE: Duration = Duration::from_micros(500);

/// The keys that outside programs may use.
const KEYS: [&str; 7] = [
    "seconds",
    "setup_seconds",
    "rss_peak_bytes",
    "heap_peak_bytes",
    "counters",
    "refused",
    "ready",
];

/// Request to a child of this program.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Request {
    /// The algorithm with its parameters.
    pub(crate) algorithm: String,
    /// The widest instructions that it may use.
    pub(crate) simd: String,
    /// The source, or several together.
    pub(crate) source: SourceLabel,
    /// The targets; all vertices without any.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(crate) targets: Option<String>,
    /// The largest distance asked for.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(crate) radius: Option<f64>,
    /// The purpose of the run.
    pub(crate) pass: Pass,
    /// Solves of a timed run.
    pub(crate) solves: usize,
}

/// Last argument of a child of this program.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct ChildSettings {
    /// Name of the model.
    pub(crate) name: String,
    /// Process id of the parent; the child exits if it has gone.
    pub(crate) parent: u32,
    /// Memory limit in bytes, from which the data limit is set.
    pub(crate) memory_limit: Option<u64>,
    /// Bytes that a compressed model may decompress to; the default limit if null.
    pub(crate) max_decompressed: Option<u64>,
    /// Tolerance within which vertices of the model are welded; none are if null.
    pub(crate) weld: Option<f64>,
    /// The reader of OBJ files, by name.
    pub(crate) reader: String,
}

/// A line of a child. Every field is optional; unknown fields are errors, so that a typo does not
/// go unnoticed.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub(crate) struct Reply {
    /// The model is loaded.
    pub(crate) ready: bool,
    /// Record of the loaded model; from this program only.
    pub(crate) model: Option<Box<ModelRecord>>,
    /// Why the child cannot work on the model or the source.
    pub(crate) refused: Option<String>,
    /// How the algorithm failed, in a child that goes on.
    pub(crate) crashed: Option<String>,
    /// Seconds that the solve took.
    pub(crate) seconds: Option<f64>,
    /// Seconds of set-up that depends on the mesh alone, if part of this run.
    pub(crate) setup_seconds: Option<f64>,
    /// Counters, by the names of result files.
    #[serde(with = "counters")]
    pub(crate) counters: Option<Counters>,
    /// Most memory that the process occupied during the solve.
    pub(crate) rss_peak_bytes: Option<u64>,
    /// Most bytes on its heap during the solve, without the mesh.
    pub(crate) heap_peak_bytes: Option<u64>,
    /// The result of a run, as journals hold it; from this program only, in place of the figures
    /// above.
    pub(crate) observation: Option<Box<Observation>>,
    /// The widest instructions of the run; from this program only.
    pub(crate) simd: Option<String>,
    /// The nearest source of each vertex; from this program only.
    pub(crate) labels: Option<Vec<u32>>,
    /// The distances, unless they equal the last ones sent; from this program only.
    #[serde(with = "distances")]
    pub(crate) distances: Option<Vec<f64>>,
}

impl Reply {
    /// Parses a line.
    ///
    /// # Errors
    ///
    /// If it is not one JSON object, or a key or a value is not allowed.
    pub(crate) fn parse(line: &[u8]) -> Result<Self, ReplyError> {
        let object = serde_json::from_slice::<serde_json::Map<String, Value>>(line);
        let object = object.map_err(|_| ReplyError::NoObject)?;
        if let Some(Value::Object(counters)) = object.get("counters")
            && let Some(unknown) = counters.keys().find(|name| !is_counter(name))
        {
            return Err(ReplyError::Key(no_such_counter(unknown)));
        }
        let mut json = serde_json::Deserializer::from_slice(line);
        let reply: Self = serde_path_to_error::deserialize(&mut json).map_err(|error| {
            let problem = error.inner().to_string();
            let at = error.path().to_string();
            if let Some(problem) = unknown_key(&problem) {
                return ReplyError::Key(problem);
            }
            // The position in a line says no more than the key.
            let problem = problem.split(" at line ").next().unwrap_or("");
            ReplyError::Key(match at.as_str() {
                "." => problem.to_owned(),
                at => format!("`{at}`: {problem}"),
            })
        })?;
        for (key, seconds) in [
            ("seconds", reply.seconds),
            ("setup_seconds", reply.setup_seconds),
        ] {
            if let Some(seconds) = seconds.filter(|s| !s.is_finite() || *s < 0.0) {
                return Err(ReplyError::Key(format!("`{key}`: {seconds} is no time")));
            }
        }
        Ok(reply)
    }

    /// The first key set that outside programs may not use.
    pub(crate) fn own_key(&self) -> Option<&'static str> {
        let keys = [
            ("model", self.model.is_some()),
            ("observation", self.observation.is_some()),
            ("simd", self.simd.is_some()),
            ("labels", self.labels.is_some()),
            ("distances", self.distances.is_some()),
        ];
        keys.into_iter().find_map(|(key, set)| set.then_some(key))
    }

    /// Maximum number of bytes of a line with at most `answers` distances and labels.
    pub(crate) const fn longest(answers: usize) -> usize {
        const REST: usize = 1 << 20;
        // 8 bytes are at most 11 characters of base64. A label has at most 10 digits and a comma.
        const EACH: usize = 11 + 11;
        REST.saturating_add(answers.saturating_mul(EACH))
    }

    /// The result of a run with these distances.
    pub(crate) fn observation(self, distances: Vec<f64>) -> Observation {
        let of_outside = || Observation {
            seconds: self.seconds,
            setup_seconds: self.setup_seconds,
            counters: self.counters,
            peaks: Peaks {
                heap: self.heap_peak_bytes,
                rss: self.rss_peak_bytes,
            },
            ..Observation::default()
        };
        Observation {
            distances,
            labels: self.labels,
            ..self.observation.map_or_else(of_outside, |own| *own)
        }
    }
}

/// Why a line is no reply.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) enum ReplyError {
    /// It is not one JSON object.
    NoObject,
    /// A key or its value is not allowed.
    Key(String),
}

/// The message for an unknown key; `None` if `problem` of serde is another one.
fn unknown_key(problem: &str) -> Option<String> {
    let name = problem.strip_prefix("unknown field `")?.split('`').next()?;
    Some(no_such_key(&quoted(name)))
}

/// The message for a key that outside programs may not use.
pub(crate) fn no_such_key(name: &str) -> String {
    format!(
        "there is no key `{name}`{}; known are {}",
        did_you_mean(name, &KEYS),
        KEYS.join(", ")
    )
}

/// The names that `counters` may have.
fn counter_names() -> impl Iterator<Item = &'static str> {
    let counts = Counter::ALL.iter().map(|counter| counter.key());
    counts.chain([Counters::WAVEFRONT_DEVIATION])
}

fn is_counter(name: &str) -> bool {
    counter_names().any(|known| known == name)
}

/// The message for an unknown counter.
fn no_such_counter(name: &str) -> String {
    let name = quoted(name);
    let known: Vec<&str> = counter_names().collect();
    format!(
        "there is no counter `{name}`{}; `geobench algos --counters` lists them",
        did_you_mean(&name, &known)
    )
}

impl From<Observation> for Reply {
    fn from(mut observation: Observation) -> Self {
        Self {
            distances: Some(std::mem::take(&mut observation.distances)),
            labels: observation.labels.take(),
            observation: Some(Box::new(observation)),
            ..Self::default()
        }
    }
}

/// Optional distances as base64 of little-endian f64: a third of the size of digits, exact, with
/// infinity.
mod distances {
    use base64::Engine;
    use base64::prelude::BASE64_STANDARD_NO_PAD;
    use serde::de::Error;
    use serde::{Deserialize, Deserializer, Serialize, Serializer};

    #[expect(clippy::ref_option, reason = "serde calls it so")]
    pub(super) fn serialize<S: Serializer>(
        distances: &Option<Vec<f64>>,
        serializer: S,
    ) -> Result<S::Ok, S::Error> {
        let text = distances.as_ref().map(|distances| {
            let bytes: Vec<u8> = distances.iter().flat_map(|d| d.to_le_bytes()).collect();
            BASE64_STANDARD_NO_PAD.encode(bytes)
        });
        text.serialize(serializer)
    }

    pub(super) fn deserialize<'de, D: Deserializer<'de>>(
        deserializer: D,
    ) -> Result<Option<Vec<f64>>, D::Error> {
        let Some(text) = Option::<String>::deserialize(deserializer)? else {
            return Ok(None);
        };
        let bytes = BASE64_STANDARD_NO_PAD
            .decode(text)
            .map_err(|error| D::Error::custom(format!("distances in base64: {error}")))?;
        let (numbers, rest) = bytes.as_chunks::<8>();
        if !rest.is_empty() {
            return Err(D::Error::custom("distances in base64: not of 8 bytes each"));
        }
        Ok(Some(
            numbers.iter().map(|&d| f64::from_le_bytes(d)).collect(),
        ))
    }
}

/// Optional counters, as in result files.
pub(crate) mod counters {
    use geobench_window::Counters;
    use serde::{Deserialize, Deserializer, Serialize, Serializer};

    use crate::schema::counters_as_map;

    #[derive(Serialize, Deserialize)]
    struct Map(#[serde(with = "counters_as_map")] Counters);

    #[expect(clippy::ref_option, reason = "serde calls it so")]
    pub(crate) fn serialize<S: Serializer>(
        counters: &Option<Counters>,
        serializer: S,
    ) -> Result<S::Ok, S::Error> {
        counters.clone().map(Map).serialize(serializer)
    }

    pub(crate) fn deserialize<'de, D: Deserializer<'de>>(
        deserializer: D,
    ) -> Result<Option<Counters>, D::Error> {
        Ok(Option::<Map>::deserialize(deserializer)?.map(|Map(counters)| counters))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::schema::{PhaseSeconds, WavefrontSample};

    #[test]
    fn an_observation_comes_back_to_the_last_bit() {
        let mut counters = Counters::default();
        counters.set(Counter::Propagated, u64::MAX);
        counters.wavefront_deviation = Some(0.1 + 0.2);
        let distances = vec![0.0, -0.0, 0.1 + 0.2, f64::INFINITY, f64::MIN_POSITIVE];
        for (distances, counters) in [(distances, Some(counters)), (Vec::new(), None)] {
            let observation = Observation {
                distances,
                seconds: Some(1.0 / 3.0),
                solves: Some(7),
                outside_seconds: None,
                ping_seconds: None,
                setup_seconds: None,
                extraction_seconds: Some(0.1),
                labels: Some(vec![0, u32::MAX]),
                counters,
                wavefront: vec![WavefrontSample {
                    parents: u64::MAX,
                    windows: 1,
                    distance: 1.0 / 3.0,
                    deviation: 0.0,
                    k: None,
                }],
                peaks: Peaks {
                    heap: Some(7),
                    rss: None,
                },
                phases: Some(PhaseSeconds {
                    propagation: Some(0.1),
                    ..PhaseSeconds::default()
                }),
                edge_excess: Some(0.1 + 0.2),
                note: Some("at:1,2,3 is 1 from the surface".to_owned()),
            };
            let text = serde_json::to_vec(&Reply::from(observation.clone())).unwrap();
            let mut reply = Reply::parse(&text).unwrap();
            let distances = reply.distances.take().unwrap();
            let back = reply.observation(distances);
            assert_eq!(back, observation);
            let bits =
                |o: &Observation| o.distances.iter().map(|d| d.to_bits()).collect::<Vec<_>>();
            assert_eq!(bits(&back), bits(&observation));
        }
    }

    #[test]
    fn a_reply_with_many_labels_is_not_too_long() {
        let answers = 500_000;
        let reply = Reply {
            distances: Some(vec![f64::MAX; answers]),
            labels: Some(vec![u32::MAX; answers]),
            ..Reply::default()
        };
        let line = serde_json::to_vec(&reply).unwrap();
        assert!(line.len() <= Reply::longest(answers), "{}", line.len());
    }

    #[test]
    fn a_distance_that_is_no_number_stays_one() {
        let reply = Reply {
            distances: Some(vec![f64::NAN]),
            ..Reply::default()
        };
        let text = serde_json::to_vec(&reply).unwrap();
        let back = Reply::parse(&text).unwrap();
        assert!(back.distances.unwrap()[0].is_nan());
    }

    #[test]
    fn damaged_distances_are_refused() {
        for damage in ["AAAA", "?", "A"] {
            let text = format!("{{\"distances\": \"{damage}\"}}");
            let error = serde_json::from_str::<Reply>(&text).unwrap_err();
            assert!(error.to_string().contains("distances in base64"), "{error}");
        }
    }

    #[test]
    fn a_line_is_understood_whole_or_not_at_all() {
        let line = Reply::parse(br#"{"seconds": 0.5, "counters": {"propagated": 7}}"#).unwrap();
        assert_eq!(line.seconds, Some(0.5));
        let counters = line.counters.unwrap();
        assert_eq!(counters.get(Counter::Propagated), Some(7));
        assert_eq!(counters.get(Counter::Kept), None);
        assert!(Reply::parse(br#"{"ready": true}"#).unwrap().ready);
        for garbage in [
            "mesh has 4 vertices",
            r#"{"second": 0.5}"#,
            r#"{"seconds": -1}"#,
            r#"{"seconds": "fast"}"#,
            "{",
        ] {
            assert!(Reply::parse(garbage.as_bytes()).is_err(), "{garbage}");
        }
        let wrong = |line: &str| match Reply::parse(line.as_bytes()) {
            Err(ReplyError::Key(problem)) => problem,
            other => panic!("{line}: {other:?}"),
        };
        assert_eq!(
            wrong(r#"{"sec": 1}"#),
            "there is no key `sec` (did you mean `seconds`?); known are seconds, setup_seconds, \
             rss_peak_bytes, heap_peak_bytes, counters, refused, ready"
        );
        assert_eq!(
            wrong(r#"{"seconds": 1, "counters": {"propogated": 7}}"#),
            "there is no counter `propogated` (did you mean `propagated`?); `geobench algos \
             --counters` lists them"
        );
        assert_eq!(
            wrong(r#"{"seconds": 1, "seconds": 2}"#),
            "duplicate field `seconds`"
        );
        assert_eq!(wrong(r#"{"seconds": -1}"#), "`seconds`: -1 is no time");
        assert_eq!(
            wrong(r#"{"seconds": "fast"}"#),
            "`seconds`: invalid type: string \"fast\", expected f64"
        );
    }
}
