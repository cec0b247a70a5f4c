//! Pages of programs, and the page of their errors.

use geobench_harness::figures::capitalised;
use geobench_harness::measure::number::{counted, scientific};
use geobench_harness::schema::Status;

use super::measured::{Measurement, key};
use super::pages::{Pages, section};
use crate::page::document::{Section, SectionItem};
use crate::table::group::{by_key, distinct};
use crate::table::{Column, Entry, Mark, Table};

/// All programs.
pub(super) fn list(context: &Pages<'_>) -> Vec<Section> {
    let row = |name: &&str| {
        let own: Vec<&Measurement<'_>> = context
            .all
            .iter()
            .filter(|m| m.program() == *name)
            .collect();
        let (what, paper) = match (geobench_registry::find(name), context.public(name)) {
            (Some(one), _) => (one.summary.to_owned(), one.paper.to_owned()),
            (None, Some(public)) => (public.algorithm.clone(), String::new()),
            (None, None) => (String::new(), String::new()),
        };
        vec![
            context.program_entry(name),
            Entry::new(if own[0].is_outside() {
                "public"
            } else {
                "this suite"
            }),
            Entry::new(if own[0].is_approximate() {
                "approximate"
            } else {
                "exact"
            }),
            Entry::new(what),
            Entry::new(paper),
            Entry::new(distinct(own.iter().map(|m| m.key())).len().to_string()),
            Entry::new(own[0].record.date()),
        ]
    };
    let mut columns = Column::of(
        ["Program", "By", "Distances", "What it is", "Paper"],
        ["Models"],
    );
    columns.push(Column::text("Newest record"));
    let table = Table {
        id: "programs-table".to_owned(),
        caption: "Every program that a record has.".to_owned(),
        ..Table::new(columns, context.program_names().iter().map(row).collect())
    };
    vec![section(
        "all-programs",
        "All programs",
        vec![SectionItem::Table(table)],
    )]
}

/// The title and the sections of the page of a program.
pub(super) fn page(context: &Pages<'_>, name: &str) -> (String, Vec<Section>) {
    let fact = |name: &str, value: &str| (name.to_owned(), value.to_owned());
    let own: Vec<&Measurement<'_>> = context.all.iter().filter(|m| m.program() == name).collect();
    let mut about = Vec::new();
    if let Some(public) = context.public(name) {
        about.push(SectionItem::Facts(vec![
            fact("Algorithm", &public.algorithm),
            fact(
                "Distances",
                if public.exact { "exact" } else { "approximate" },
            ),
            fact("Version", &public.version),
            fact("Its time also includes", &public.times),
            fact("Name in commands", name),
        ]));
        about.push(SectionItem::Prose(format!(
            "Source: [{0}]({0}).",
            public.address
        )));
        if !public.issues.is_empty() {
            let issues = format!("- {}", public.issues.join("\n- "));
            about.push(SectionItem::Heading("What the suite found".to_owned()));
            about.push(SectionItem::Prose(issues));
        }
    } else if let Some(one) = geobench_registry::find(name) {
        let facts = [
            ("What it is", one.summary),
            ("Paper", one.paper),
            ("Family", one.family),
            (
                "Distances",
                if one.exact {
                    "exact up to rounding"
                } else {
                    "approximate"
                },
            ),
            ("Worst case", one.complexity),
            ("Keeps", one.keeps),
            ("Choose it", one.choose),
            ("Departs from its paper", one.departs),
        ];
        let facts = facts.into_iter().chain(one.facts());
        let facts = facts.filter(|(_, value)| !value.is_empty());
        about.push(SectionItem::Facts(
            facts.map(|(name, value)| fact(name, value)).collect(),
        ));
        if !one.parameters.is_empty() {
            let row = |parameter: &geobench_registry::Parameter| {
                [
                    parameter.name.to_owned(),
                    parameter.allowed.to_string().replace('`', ""),
                    parameter.default.to_string(),
                    parameter.meaning.to_owned(),
                ]
                .map(Entry::new)
                .into()
            };
            about.push(SectionItem::Table(Table {
                id: "parameters".to_owned(),
                caption: "Parameters.".to_owned(),
                ..Table::new(
                    Column::of(["Name", "Values", "Default", "Meaning"], [""; 0]),
                    one.parameters.iter().map(row).collect(),
                )
            }));
        }
    } else {
        about.push(SectionItem::Text(
            "An outside program that the site does not describe.".to_owned(),
        ));
    }
    about.extend(recorded(&own).into_iter().flatten());
    let is_known = |one: &&&Measurement<'_>| context.corpus.of_record(one.model).is_some();
    let (known, others): (Vec<_>, Vec<_>) = own.iter().partition(is_known);
    let mut sections = vec![section("about", "What it is", about)];
    let wrong = errors(context, "wrong-table", own.iter().copied(), true);
    if let Some(table) = wrong {
        sections.push(section(
            "wrong",
            "Where it is wrong",
            vec![SectionItem::Table(table)],
        ));
    }
    for (id, heading, rows) in [
        ("corpus", "Results on the corpus", known),
        ("others", "Results on other models", others),
    ] {
        if !rows.is_empty() {
            sections.push(section(
                id,
                heading,
                context.table(&format!("{id}-table"), &rows, false),
            ));
        }
    }
    (context.title(name).to_owned(), sections)
}

/// The provenance of an outside program in the newest record that has it. `own` has the newest
/// first.
fn recorded(own: &[&Measurement<'_>]) -> Option<[SectionItem; 2]> {
    let mut known = own.iter().filter_map(|one| Some((one, one.recorded()?)));
    let (one, program) = known.next()?;
    let facts = program.facts().into_iter();
    let facts = facts.map(|(name, value)| (capitalised(name), value));
    Some([
        SectionItem::Heading(format!("As it ran on {}", one.record.date())),
        SectionItem::Facts(facts.collect()),
    ])
}

/// The newest of the measurements that are `wrong`, for each program and model. `measured` has the
/// newest first.
pub(super) fn newest_wrong<'m, 'r: 'm>(
    measured: impl Iterator<Item = &'m Measurement<'r>>,
    wrong: impl Fn(&Measurement<'r>) -> bool,
) -> Vec<&'m Measurement<'r>> {
    let wrong = measured.filter(|one| wrong(one));
    let by_place = by_key(wrong, |one| (one.label, one.key()));
    by_place.into_iter().map(|(_, own)| own[0]).collect()
}

/// A row for each program and model with a wrong or failed answer among `measured`; `None` without
/// one.
fn errors<'m, 'r: 'm>(
    context: &Pages<'r>,
    id: &str,
    measured: impl Iterator<Item = &'m Measurement<'r>>,
    of_program: bool,
) -> Option<Table> {
    let failed = |one: &Measurement<'_>| {
        let status = one.failure().map(|cell| cell.status);
        one.is_wrong() || status == Some(Status::Crashed)
    };
    let rows: Vec<Vec<Entry>> = newest_wrong(measured, failed)
        .into_iter()
        .map(|one| {
            let cell = one.failure().unwrap_or(one.cells[0]);
            let message = cell.message.clone().unwrap_or_default();
            let mut row = vec![
                context.model_entry(one.model),
                Entry::marked(cell.status.in_words(), Mark::Failed),
                Entry::new(one.max_error().map_or_else(|| "-".to_owned(), scientific)),
                Entry::new(message),
                Entry::new(proof(context, one)),
                Entry::linked(one.record.date(), one.record.address()),
            ];
            if !of_program {
                row.insert(0, context.program_entry(one.program()));
            }
            row
        })
        .collect();
    let first = if of_program {
        &["Model"][..]
    } else {
        &["Program", "Model"]
    };
    let columns = [
        &Column::of(first, [""; 0])[..],
        &Column::of(["Outcome"], ["Max. error"]),
        &Column::of(["What differs", "The right distances", "Date"], [""; 0]),
    ];
    (!rows.is_empty()).then(|| Table {
        id: id.to_owned(),
        caption: "Answers that are not the distances, and runs that crashed; the newest of each \
                  program and model."
            .to_owned(),
        ..Table::new(columns.concat(), rows)
    })
}

/// What the distances of a model rest on.
fn proof(context: &Pages<'_>, one: &Measurement<'_>) -> String {
    let name = context.name_of(one.model);
    let found = context.records.certificates.iter().find(|certificate| {
        certificate.certified
            && certificate.name == name
            && Some(certificate.faces) == one.model.faces
    });
    match (
        found.and_then(|certificate| certificate.relative),
        &one.cells[0].check.reference,
    ) {
        (Some(bound), _) => format!("certified to {}", scientific(bound)),
        (None, Some(reference)) if one.cells.iter().any(|cell| cell.check.proven.is_some()) => {
            format!("{reference}, proven in the run")
        }
        (None, Some(reference)) => format!("{reference}, not certified"),
        (None, None) => "not compared".to_owned(),
    }
}

/// The page of errors: wrong answers, then the largest error of each exact public program on each
/// model.
pub(super) fn wrong(context: &Pages<'_>) -> Vec<Section> {
    let outside = || context.all.iter().filter(|one| one.is_outside());
    let exact = || outside().filter(|one| !one.is_approximate());
    let programs = distinct(exact().map(Measurement::program));
    let models = context
        .models()
        .into_iter()
        .filter(|model| exact().any(|one| one.key() == key(model)));
    let row = |model: &geobench_harness::schema::ModelRecord| {
        let of_model = || exact().filter(|one| one.key() == key(model));
        let entry = |program: &&str| {
            let mut own = of_model().filter(|one| one.program() == *program);
            let Some(one) = own.next() else {
                return Entry::new("");
            };
            let error = one.max_error().map_or_else(
                || {
                    one.failure()
                        .map_or_else(|| "-".to_owned(), |cell| cell.status.in_words())
                },
                scientific,
            );
            Entry::marked(
                error,
                if one.is_wrong() {
                    Mark::Failed
                } else {
                    Mark::None
                },
            )
        };
        let name = context.name_of(model);
        let address = format!("{}.html", context.model_address(model));
        let right = of_model()
            .next()
            .map_or_else(String::new, |one| proof(context, one));
        let mut row = vec![Entry::linked(name, address)];
        row.extend(programs.iter().map(entry));
        row.push(Entry::new(right));
        row
    };
    let rows: Vec<Vec<Entry>> = models.map(row).collect();
    let heads = programs.iter().map(|program| context.title(program));
    let mut columns = Column::of(["Model"], heads);
    columns.push(Column::text("The right distances"));
    let table = Table {
        id: "errors-table".to_owned(),
        caption:
            "Largest relative error of each exact public program, from the newest record; wrong \
                  answers are red."
                .to_owned(),
        ..Table::new(columns, rows)
    };
    let wrong = errors(context, "wrong-table", context.all.iter(), false);
    let count = wrong.as_ref().map_or(0, |table| table.parts[0].rows.len());
    let text = format!(
        "{} in the records, the newest of each program and model. An answer is wrong if a distance \
         differs from the reference by more than 1e-9 of it; where programs disagree, a [proof](method.html) decides. Certified \
         distances are proven in interval arithmetic, to the error that stands beside them.",
        counted(count, "wrong or crashed answer")
    );
    let mut blocks = vec![SectionItem::Prose(text)];
    blocks.extend(wrong.map(SectionItem::Table));
    let mut sections = vec![section("wrong", "Wrong answers", blocks)];
    if !table.parts[0].rows.is_empty() {
        sections.push(section(
            "errors",
            "Errors by model",
            vec![SectionItem::Table(table)],
        ));
    }
    sections
}
