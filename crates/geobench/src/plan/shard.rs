//! Splitting a plan into parts that run on different machines.
//!
//! A *unit* is one model with one source of one group: the cells that are compared with each other,
//! and whose runs are interleaved. The units of a benchmark are numbered from 0 through the groups,
//! the models of each, and the sources in each, in the order of the plan; unit `u` belongs to part
//! `u mod N + 1` of `N`. This follows from the plan alone, so every machine splits it alike, and no
//! model needs to be loaded for it: of random sources too, the number is known. Neighbours, which
//! are often alike in size, come to different parts.

use std::fmt;
use std::ops::Range;
use std::str::FromStr;

use serde::{Deserialize, Serialize};

use crate::plan::Plan;

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

/// A part of one plan of a benchmark.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Share {
    /// Which part.
    pub shard: Shard,
    /// Number of the first unit of the plan.
    pub first_unit: u128,
}

/// Restricts `plans`, which are those of one benchmark, to a part of it.
pub fn restrict(plans: &mut [Plan], shard: Shard) {
    let mut first_unit = 0;
    for plan in plans {
        plan.share = Some(Share { shard, first_unit });
        first_unit += plan.units();
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::exec::mock::{Rehearsal, plan, rehearse};
    use proptest::prelude::*;

    #[test]
    fn parts_are_read() {
        assert_eq!("2/3".parse(), Ok(Shard { index: 2, count: 3 }));
        for text in ["", "1", "0/3", "4/3", "1/0", "-1/3", "1/3/5", "a/b"] {
            assert!(text.parse::<Shard>().is_err(), "{text}");
        }
    }

    proptest! {
        #[test]
        fn every_unit_belongs_to_exactly_one_part(count in 1_u32..20, start in 0_u128..50, length in 0_u128..50) {
            let units = start..start + length;
            let mut held = 0;
            for index in 1..=count {
                let shard = Shard { index, count };
                let those = units.clone().filter(|&unit| shard.holds(unit)).count() as u128;
                prop_assert_eq!(shard.held(units.clone()), those);
                held += those;
            }
            prop_assert_eq!(held, length);
        }

        /// The cells of all parts together are those of the whole, each once; cells that are
        /// compared are never apart.
        #[test]
        fn parts_are_disjoint_and_complete(
            models in 1_usize..5,
            sources in prop::sample::select(vec!["0", "3,1", "random:3", "2,0,1,3", "random:9", "1,7"]),
            count in 1_u32..9,
            groups in 1_usize..3,
        ) {
            let names = ["a", "b", "c", "d"];
            let mut plans: Vec<Plan> = (0..groups)
                .map(|g| {
                    let mut plan = plan(&names[..models - g.min(models - 1)], "mmp,vtp", sources);
                    plan.group.name = Some(format!("group {g}"));
                    plan.repeat = 1;
                    plan
                })
                .collect();
            let keys = |plans: &[Plan]| -> Vec<(String, String, Option<u32>, String)> {
                let mut workplace = Rehearsal { refuse: vec!["b"], ..Rehearsal::default() };
                plans
                    .iter()
                    .flat_map(|plan| rehearse(plan, &mut workplace).cells)
                    .map(|c| (c.group.unwrap(), c.model, c.source, c.algorithm))
                    .collect()
            };
            let mut whole = keys(&plans);
            let mut parts = Vec::new();
            for index in 1..=count {
                restrict(&mut plans, Shard { index, count });
                let part = keys(&plans);
                for pair in part.chunks(2) {
                    prop_assert_eq!((&pair[0].1, pair[0].2), (&pair[1].1, pair[1].2));
                }
                parts.extend(part);
            }
            whole.sort();
            parts.sort();
            prop_assert_eq!(parts, whole);
        }
    }
}
