//! What result files and journals keep of plans.

use super::{Plan, Reference};
use crate::exec::model::ModelRef;
use crate::registry::{Selection, Value};
use crate::schema::IsolationRecord;
use crate::schema::plan_record::{PlanRecord, PlannedAlgorithm, PlannedGroup, PlannedModel};

/// The plan of a benchmark whose groups have these plans and whose cells run there. Reads the files
/// of all models once, to hash them.
pub fn record(plans: &[Plan], isolation: IsolationRecord) -> PlanRecord {
    PlanRecord {
        isolation,
        shard: plans.iter().find_map(|plan| Some(plan.share?.shard)),
        groups: plans.iter().map(group).collect(),
    }
}

fn group(plan: &Plan) -> PlannedGroup {
    PlannedGroup {
        name: plan.group.name.clone(),
        models: plan.models.iter().map(model).collect(),
        algorithms: plan.algorithms.iter().map(algorithm).collect(),
        sources: plan.sources.to_string(),
        repeat: plan.repeat,
        warmup: plan.warmup,
        reference: match &plan.reference {
            Reference::None => "none".to_owned(),
            Reference::Algorithm(selection) => selection.label().to_owned(),
            Reference::Files(files) => files.to_string(),
        },
        tolerance: plan.tolerance,
        seed: plan.seed,
        timeout: plan.limits.timeout.0.map(|time| time.as_secs_f64()),
        memory_limit: plan.limits.memory.0,
        max_decompressed: plan.limits.decompressed.0,
    }
}

fn model(model: &ModelRef) -> PlannedModel {
    PlannedModel {
        name: model.name.clone(),
        spec: model.spec(),
        file_sha256: model.file_sha256(),
    }
}

fn algorithm(selection: &Selection) -> PlannedAlgorithm {
    let parameters = selection.algorithm().parameters.iter();
    let program = selection.program().into_iter().flat_map(|program| {
        [
            ("command", program.command.clone().into()),
            ("protocol", program.keeping.name().into()),
            ("approximate", program.approximate.into()),
            ("threads", selection.threads().into()),
        ]
    });
    PlannedAlgorithm {
        label: selection.label().to_owned(),
        parameters: parameters
            .map(|parameter| {
                let value = match selection.value(parameter) {
                    Value::Integer(n) => n.into(),
                    Value::Real(x) => x.into(),
                    Value::Word(word) => word.into(),
                };
                (parameter.name.to_owned(), value)
            })
            .chain(program.map(|(name, value)| (name.to_owned(), value)))
            .collect(),
    }
}
