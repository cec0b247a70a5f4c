//! Messages between parent and child process, one line of JSON each, and the encoding of results.

use serde::{Deserialize, Serialize};

use crate::exec::{Failure, Observation, Pass};
use crate::schema::ModelRecord;

/// Distances as base64 of little-endian f64: a third of the size of digits, exact, with infinity.
pub(crate) mod distances {
    use base64::Engine;
    use base64::prelude::BASE64_STANDARD_NO_PAD;
    use serde::de::Error;
    use serde::{Deserialize, Deserializer, Serializer};

    pub(crate) fn serialize<S: Serializer>(
        distances: &[f64],
        serializer: S,
    ) -> Result<S::Ok, S::Error> {
        let bytes: Vec<u8> = distances.iter().flat_map(|d| d.to_le_bytes()).collect();
        serializer.serialize_str(&BASE64_STANDARD_NO_PAD.encode(bytes))
    }

    pub(crate) fn deserialize<'de, D: Deserializer<'de>>(
        deserializer: D,
    ) -> Result<Vec<f64>, D::Error> {
        let text = String::deserialize(deserializer)?;
        let bytes = BASE64_STANDARD_NO_PAD
            .decode(text)
            .map_err(|error| D::Error::custom(format!("distances in base64: {error}")))?;
        let (numbers, rest) = bytes.as_chunks::<8>();
        if !rest.is_empty() {
            return Err(D::Error::custom("distances in base64: not of 8 bytes each"));
        }
        Ok(numbers.iter().map(|&d| f64::from_le_bytes(d)).collect())
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

/// Request of the parent.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub(crate) enum Request {
    /// Load the model of the command line. Always first; answered by `Loaded` or `Refused`.
    Load {
        /// Name of the model.
        name: String,
        /// Process id of the parent; the child exits if it has gone.
        parent: u32,
        /// Processors to pin to; none means any.
        cpus: Vec<usize>,
        /// Memory limit in bytes, from which the data limit is set.
        memory_limit: Option<u64>,
        /// Bytes that a compressed model may decompress to; the default limit if null.
        max_decompressed: Option<u64>,
    },
    /// Carry out one run. Answered by `Ran`, `RanAgain` or `Failed`.
    Run {
        /// The algorithm with its parameters.
        algorithm: String,
        /// Number of the source vertex.
        source: u32,
        /// What the run is for.
        pass: Pass,
    },
}

/// Reply of the child.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub(crate) enum Reply {
    /// The model is in memory.
    Loaded(Box<ModelRecord>),
    /// The model cannot be used.
    Refused(String),
    /// Result of the run.
    Ran(Box<Observation>),
    /// The same, without distances: they equal the last ones sent.
    RanAgain(Box<Observation>),
    /// The run failed.
    Failed(Failure),
}

#[cfg(test)]
mod tests {
    use geobench_window::{Counter, Counters};

    use crate::exec::Observation;
    use crate::measure::memory::Peaks;
    use crate::schema::{Phases, WavefrontRecord};

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
                setup_seconds: None,
                counters,
                wavefront: vec![WavefrontRecord {
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
                phases: Some(Phases {
                    propagation: Some(0.1),
                    ..Phases::default()
                }),
            };
            let text = serde_json::to_string(&observation).unwrap();
            let back: Observation = serde_json::from_str(&text).unwrap();
            assert_eq!(back, observation);
            let bits =
                |o: &Observation| o.distances.iter().map(|d| d.to_bits()).collect::<Vec<_>>();
            assert_eq!(bits(&back), bits(&observation));
        }
    }

    #[test]
    fn a_distance_that_is_no_number_stays_one() {
        let observation = Observation {
            distances: vec![f64::NAN],
            ..Observation::default()
        };
        let text = serde_json::to_string(&observation).unwrap();
        let back: Observation = serde_json::from_str(&text).unwrap();
        assert!(back.distances[0].is_nan());
    }

    #[test]
    fn damaged_distances_are_refused() {
        let text = serde_json::to_string(&Observation::default()).unwrap();
        for damage in ["AAAA", "?", "A"] {
            let text = text.replace("\"distances\":\"\"", &format!("\"distances\":\"{damage}\""));
            let error = serde_json::from_str::<Observation>(&text).unwrap_err();
            assert!(error.to_string().contains("distances in base64"), "{error}");
        }
    }
}
