//! Machine, program and command of a result.

use geobench_export::escape::shell;
use geobench_harness::figures::capitalised;
use geobench_harness::measure::number::counted;
use geobench_harness::schema::{ResultFile, Status, Tool};
use serde_json::Value;

/// Names and values of all known facts.
pub(crate) fn facts(result: &ResultFile) -> Vec<(String, String)> {
    let (tool, host) = (&result.tool, &result.host);
    let or_unknown = |text: Option<&String>| text.map_or("unknown", String::as_str).to_owned();
    let mut facts: Vec<(String, String)> = [
        ("Command", command(&result.command)),
        ("Started", result.started.clone()),
        ("Finished", result.finished.clone()),
        (
            "Program",
            format!(
                "geobench {}, commit {}, {} build",
                tool.version,
                or_unknown(tool.commit.as_ref()),
                tool.profile
            ),
        ),
        ("Compiler", compiler(tool)),
        ("Processor", or_unknown(host.cpu.as_ref())),
        ("Processors in use", host.cores.to_string()),
        (
            "Main memory",
            host.memory_bytes.map_or_else(
                || "unknown".to_owned(),
                |bytes| format!("{:.1} GB", bytes as f64 / 1e9),
            ),
        ),
        (
            "System",
            match &host.kernel {
                Some(kernel) => format!("{}, kernel {kernel}", host.os),
                None => host.os.clone(),
            },
        ),
    ]
    .map(|(name, value)| (name.to_owned(), value))
    .to_vec();
    if let Some(load) = host.load_start {
        facts.push(("Load at the start".to_owned(), format!("{load:.2}")));
    }
    if !tool.features.is_empty() {
        facts.push(("Features".to_owned(), tool.features.join(", ")));
    }
    for program in result.programs() {
        facts.push((format!("Program {}", program.name), program.in_words()));
    }
    facts.extend(others(result));
    // A result has several sessions if the run was resumed or its parts ran on several machines.
    if result.sessions.len() > 1 {
        for (i, session) in result.sessions.iter().enumerate() {
            let cpu = or_unknown(session.host.cpu.as_ref());
            let shard = session.shard.as_ref();
            let part =
                shard.map_or_else(String::new, |shard| format!(", part {shard} of the plan"));
            facts.push((
                format!("Session {}", i + 1),
                format!(
                    "{} on {cpu}{part}: {}",
                    session.started,
                    command(&session.command)
                ),
            ));
        }
    }
    facts
}

/// The isolation and the conditions of the run, except warnings, which are shown at the top.
fn others(result: &ResultFile) -> Vec<(String, String)> {
    let mut facts = Vec::new();
    for (name, value) in [
        ("isolation", serde_json::to_value(&result.isolation)),
        ("conditions", serde_json::to_value(&result.conditions)),
    ] {
        let mut value = value.unwrap_or_default();
        if let Some(fields) = value.as_object_mut() {
            fields.remove("warnings");
        }
        flatten(name, &value, &mut facts);
    }
    facts
}

/// A line for each value that is not null, named after its path.
fn flatten(name: &str, value: &Value, facts: &mut Vec<(String, String)>) {
    let text = match value {
        Value::Null => return,
        Value::Object(fields) => {
            for (key, value) in fields {
                let unit = if key.starts_with("frequency") {
                    " in hertz"
                } else {
                    ""
                };
                let key = key.replace('_', " ");
                flatten(&format!("{name}, {key}{unit}"), value, facts);
            }
            return;
        }
        Value::Array(items) if items.is_empty() => return,
        Value::Array(items) => {
            let texts: Vec<String> = items.iter().map(plain).collect();
            texts.join(", ")
        }
        value => plain(value),
    };
    facts.push((capitalised(name), text));
}

fn plain(value: &Value) -> String {
    match value {
        Value::String(text) => text.clone(),
        Value::Bool(true) => "yes".to_owned(),
        Value::Bool(false) => "no".to_owned(),
        Value::Number(number) if number.is_f64() => {
            let hundredths = number
                .as_f64()
                .map(|number| (100.0 * number).round() / 100.0);
            hundredths.unwrap_or_default().to_string()
        }
        value => value.to_string(),
    }
}

/// The compiler, with the flags of `RUSTFLAGS`.
fn compiler(tool: &Tool) -> String {
    let name = tool.rustc.as_deref().unwrap_or("unknown");
    match tool.rustflags.as_deref() {
        None | Some("") => name.to_owned(),
        Some(flags) => format!("{name}, with {flags}"),
    }
}

/// A command, quoted for a shell.
fn command(words: &[String]) -> String {
    let quoted: Vec<String> = words.iter().map(|word| shell(word)).collect();
    quoted.join(" ")
}

/// The outcome of the run, in one or two sentences.
pub(crate) fn summary(result: &ResultFile) -> String {
    let cells = result.cells.len();
    let count = |status: Status| result.cells.iter().filter(|c| c.status == status).count();
    let ok = count(Status::Ok);
    let mut text = format!(
        "{} on {}; {ok} of {} ended well.",
        counted(algorithms(result), "algorithm"),
        counted(result.models.len(), "model"),
        counted(cells, "cell"),
    );
    let failed: Vec<String> = [
        Status::Wrong,
        Status::Crashed,
        Status::Timeout,
        Status::OutOfMemory,
        Status::Refused,
    ]
    .into_iter()
    .map(|status| (count(status), status))
    .filter(|(count, _)| *count > 0)
    .map(|(count, status)| format!("{count} {}", status.name().replace('_', " ")))
    .collect();
    if !failed.is_empty() {
        text += &format!(" The others: {}.", failed.join(", "));
    }
    text
}

fn algorithms(result: &ResultFile) -> usize {
    crate::table::group::algorithms(&result.cells).len()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn commands_can_be_pasted_into_a_shell() {
        let words = ["geobench", "run", "--algo", "fwp-mmp{kmax=5}", "it's"];
        assert_eq!(
            command(&words.map(str::to_owned)),
            "geobench run --algo 'fwp-mmp{kmax=5}' 'it'\\''s'"
        );
    }

    #[test]
    fn fields_of_other_versions_are_shown_by_their_names() {
        let mut facts = Vec::new();
        let value = serde_json::json!({
            "turbo": false, "governor": "performance", "cpus": [0, 1], "none": null,
            "load_end": 1.7744,
        });
        flatten("conditions", &value, &mut facts);
        let lines: Vec<String> = facts.iter().map(|(k, v)| format!("{k}: {v}")).collect();
        assert_eq!(
            lines,
            [
                "Conditions, cpus: 0, 1",
                "Conditions, governor: performance",
                "Conditions, load end: 1.77",
                "Conditions, turbo: no"
            ]
        );
    }
}
