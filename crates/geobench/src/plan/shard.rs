//! Splitting a plan into parts that run on different machines.
//!
//! A *unit* is one model with one source of one group: the cells that are compared with each other,
//! and whose runs are interleaved. The units of a benchmark are numbered from 0 through the groups,
//! the models of each, and the sources in each, in the order of the plan; unit `u` belongs to part
//! `u mod N + 1` of `N`. This follows from the plan alone, so every machine splits it alike, and no
//! model needs to be loaded for it: of random sources too, the number is known. Neighbours, which
//! are often alike in size, come to different parts.

use crate::plan::Plan;
use crate::schema::Shard;

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
    use crate::exec::mock::Rehearsal;
    use crate::run::mock::{plan, rehearse};
    use proptest::prelude::*;

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
