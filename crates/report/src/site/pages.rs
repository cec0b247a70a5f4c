//! What pages share: the records, names and addresses of programs and models, tables of
//! measurements.

use std::collections::HashMap;
use std::path::Path;

use geobench_export::escape::xml as escape;
use geobench_harness::figures::CLAIMED;
use geobench_harness::measure::number::{counted, grouped, ratio, scientific, with_unit};
use geobench_harness::measure::statistics::median;
use geobench_harness::schema::ModelRecord;
use geobench_harness::usage::document::{DocumentError, TomlDocument};
use geobench_window::Counter;
use serde::Deserialize;

use super::measured::{Measurement, key};
use super::records::{SiteRecord, SiteRecords};
use crate::corpus::Corpus;
use crate::page::document::{Section, SectionItem, slug};
use crate::table::group::{by_key, distinct};
use crate::table::{Column, Entry, Mark, Table};

/// The most rows of a table. Pages stay below 500 KB.
const MOST_ROWS: usize = 600;

/// The pages that every site has: the name of the file, the link, the title.
pub(super) const PAGES: [(&str, &str, &str); 10] = [
    (
        "index",
        "Overview",
        "Geodesic distances on triangle meshes: how fast, how exact",
    ),
    ("programs", "Programs", "Programs"),
    ("models", "Models", "Models"),
    ("papers", "Papers", "Papers and their claims"),
    ("wrong", "Where they are wrong", "Where programs are wrong"),
    ("records", "Records", "Records and machines"),
    ("method", "Method", "Method and biases"),
    ("program", "Add a program", "How to add a program"),
    ("submit", "Add a record", "How to submit a record"),
    ("wishes", "Wish list", "Wish list"),
];

/// The name and the link of the page of a history.
pub(super) const TREND: (&str, &str) = ("trend", "Trend");

/// What the pages are made from.
pub(super) struct Pages<'r> {
    pub(super) records: &'r SiteRecords,
    pub(super) corpus: &'r Corpus,
    pub(super) programs: Vec<PublicProgram>,
    pub(super) all: &'r [Measurement<'r>],
    /// The first record of each model, by its key: records may name a model differently.
    pub(super) named: HashMap<&'r str, &'r ModelRecord>,
    pub(super) has_trend: bool,
}

/// A public program.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct PublicProgram {
    pub(super) name: String,
    pub(super) title: String,
    pub(super) address: String,
    pub(super) version: String,
    pub(super) algorithm: String,
    #[serde(default = "usually")]
    pub(super) exact: bool,
    /// What its time includes.
    pub(super) times: String,
    #[serde(default)]
    pub(super) issues: Vec<String>,
}

fn usually() -> bool {
    true
}

/// The programs of `bench-configs/site/programs.toml`.
pub(super) fn public() -> Result<Vec<PublicProgram>, DocumentError> {
    #[derive(Deserialize)]
    #[serde(deny_unknown_fields)]
    struct File {
        #[serde(rename = "program")]
        programs: Vec<PublicProgram>,
    }
    let text = include_str!("../../embedded/programs.toml");
    let document = TomlDocument::new(Path::new("programs.toml"), text);
    let file: File = document.read(document.parse()?)?;
    Ok(file.programs)
}

/// The name of the page of a program.
pub(super) fn program_address(program: &str) -> String {
    format!("program-{}", slug(program))
}

/// The start of the hash of a model.
pub(super) fn short_hash(model: &ModelRecord) -> String {
    key(model).chars().take(8).collect()
}

impl<'r> Pages<'r> {
    /// Links to the main pages; the page called `here` is the current one.
    pub(super) fn links(&self, here: &str) -> String {
        let trend = self.has_trend.then_some(TREND);
        let pages = PAGES
            .iter()
            .map(|(name, link, _)| (*name, *link))
            .chain(trend);
        let links = pages.map(|(name, link)| {
            let current = if name == here {
                " aria-current=\"page\""
            } else {
                ""
            };
            format!(
                "<li><a href=\"{name}.html\"{current}>{}</a></li>\n",
                escape(link)
            )
        });
        let links: String = links.collect();
        format!("<nav class=\"site\" aria-label=\"Site\"><ul>\n{links}</ul></nav>\n")
    }

    /// The programs, ours in the order of the registry, then the others.
    pub(super) fn program_names(&self) -> Vec<&'r str> {
        let mut names = distinct(self.all.iter().map(Measurement::program));
        let registered = geobench_registry::algorithms();
        let place = |name: &&str| {
            let place = registered.iter().position(|one| one.name == *name);
            (place.unwrap_or(usize::MAX), (*name).to_owned())
        };
        names.sort_by_key(place);
        names
    }

    /// A record of each model, those of the corpus first and in its order.
    pub(super) fn models(&self) -> Vec<&'r ModelRecord> {
        let mut models: Vec<&ModelRecord> = self.named.values().copied().collect();
        let place = |model: &&ModelRecord| {
            let hash = model.sha256.as_ref();
            let place = self
                .corpus
                .models
                .iter()
                .position(|m| Some(&m.sha256) == hash);
            let hash = key(model).to_owned();
            (
                place.unwrap_or(usize::MAX),
                model.name.clone(),
                model.faces,
                hash,
            )
        };
        models.sort_by_key(place);
        models
    }

    /// The record that names a model.
    fn first_of(&self, model: &'r ModelRecord) -> &'r ModelRecord {
        self.named.get(key(model)).copied().unwrap_or(model)
    }

    /// The name of the page of a model. Models outside of the corpus may share a name, so their
    /// hash is added.
    pub(super) fn model_address(&self, model: &'r ModelRecord) -> String {
        if let Some(known) = self.corpus.of_record(model) {
            return format!("model-{}", slug(&known.name));
        }
        let name = slug(&self.first_of(model).name);
        format!("model-{name}-{}", slug(&short_hash(model)))
    }

    /// The name of a model: that of the corpus, or else of its first record.
    pub(super) fn name_of(&self, model: &'r ModelRecord) -> &'r str {
        let model = self.first_of(model);
        let known = self.corpus.of_record(model);
        known.map_or(&model.name, |known| &known.name)
    }

    /// The title of a program: that of a public program is its own.
    pub(super) fn title<'n>(&'n self, program: &'n str) -> &'n str {
        self.public(program).map_or(program, |public| &public.title)
    }

    pub(super) fn public(&self, program: &str) -> Option<&PublicProgram> {
        let name = program.strip_prefix("ext:")?;
        self.programs.iter().find(|public| public.name == name)
    }

    /// The version of the program of a measurement.
    pub(super) fn version(&self, one: &Measurement<'_>) -> String {
        if one.is_outside() {
            if let Some(version) = one.recorded().and_then(|p| p.provenance.version.clone()) {
                return version;
            }
            let public = self.public(one.program());
            return public.map_or_else(|| "unknown".to_owned(), |p| p.version.clone());
        }
        let tool = &one.record.result.tool;
        let commit = tool.commit.as_deref().unwrap_or("unknown");
        format!("{} ({})", tool.version, commit.get(..7).unwrap_or(commit))
    }

    pub(super) fn program_entry(&self, program: &str) -> Entry {
        let address = format!("{}.html", program_address(program));
        Entry::linked(self.title(program), address)
    }

    pub(super) fn model_entry(&self, model: &'r ModelRecord) -> Entry {
        let address = format!("{}.html", self.model_address(model));
        Entry::linked(self.name_of(model), address)
    }

    /// The table of `measured`, at most [`MOST_ROWS`], with a remark on those that are left out.
    /// The first column is the model, or the program if `of_model`.
    pub(super) fn table(
        &self,
        id: &str,
        measured: &[&Measurement<'r>],
        of_model: bool,
    ) -> Vec<SectionItem> {
        let first = if of_model { "Program" } else { "Model" };
        // Older ones of a machine are in the records.
        let newest = by_key(measured, |one| {
            let host = one.record.result.host_of(one.cells[0]);
            (one.label, one.key(), self.records.machine(host))
        });
        let newest: Vec<&Measurement<'r>> = newest
            .into_iter()
            .filter_map(|(_, own)| own.into_iter().max_by_key(|one| &one.record.result.started))
            .copied()
            .collect();
        let row = |one: &&Measurement<'r>| {
            let dash = || "-".to_owned();
            let counters = one.cells.iter().map(|cell| &cell.counters);
            let windows = counters.filter_map(|c| c.get(Counter::Propagated));
            let windows = median(&windows.map(|n| n as f64).collect::<Vec<_>>());
            let heap = one
                .cells
                .iter()
                .filter_map(|cell| cell.memory.heap_peak_bytes.or(cell.memory.rss_peak_bytes));
            let heap = median(&heap.map(|bytes| bytes as f64).collect::<Vec<_>>());
            let form = if one.label == one.program() {
                ""
            } else {
                one.label
            };
            let time = match (one.time, one.failure()) {
                (_, Some(cell)) => Entry::marked(cell.status.in_words(), Mark::Failed),
                (Some(time), None) => {
                    let claimed = one.cells.iter().any(|cell| cell.time.unconfirmed);
                    let mark = if claimed { CLAIMED } else { "" };
                    let time = format!("{} {mark}", with_unit(time));
                    Entry::new(time.trim().replace(' ', "\u{a0}"))
                }
                (None, None) => Entry::new("-"),
            };
            let to_base = one.to_base.map_or_else(dash, |to_base| {
                match (ratio(to_base.ratio), to_base.vectors()) {
                    (ratio, "") => ratio,
                    (ratio, vectors) => format!("{ratio}\u{a0}({vectors})"),
                }
            });
            vec![
                if of_model {
                    self.program_entry(one.program())
                } else {
                    self.model_entry(one.model)
                },
                Entry::new(form),
                Entry::new(one.model.faces.map_or_else(dash, grouped)),
                time,
                Entry::new(to_base),
                Entry::new(one.max_error().map_or_else(dash, scientific)),
                Entry::new(windows.map_or_else(dash, |n| grouped(n as u64))),
                Entry::new(heap.map_or_else(dash, |bytes| format!("{:.1}", bytes / 1e6))),
                Entry::new(
                    self.records
                        .machine(one.record.result.host_of(one.cells[0])),
                ),
                Entry::linked(one.record.date(), one.record.address()),
            ]
        };
        let kept = &newest[..newest.len().min(MOST_ROWS)];
        let table = Table {
            id: id.to_owned(),
            caption:
                "Median times without set-up, the newest of each machine; ratios to vtp in the same \
                 run, with its instructions unless they are scalar; errors against the reference \
                 of the run; peak memory of the solver, of outside programs of the process. The \
                 date leads to the record."
                    .to_owned(),
            ..Table::new(
                [
                    &Column::of([first, "Form"], ["Faces", "Time", "To vtp", "Max. error"])[..],
                    &Column::of([""; 0], ["Windows", "Memory (MB)"]),
                    &Column::of(["Machine", "Date"], [""; 0]),
                ]
                .concat(),
                kept.iter().map(row).collect(),
            )
        };
        let mut items = vec![SectionItem::Table(table)];
        if kept.len() < measured.len() {
            let rest = counted(measured.len() - kept.len(), "measurement");
            items.push(SectionItem::Text(format!("The records have {rest} more.")));
        }
        items
    }

    pub(super) fn records_and_machines(&self) -> Vec<Section> {
        let results = &self.records.results;
        let row = |record: &SiteRecord| {
            let result = &record.result;
            let commit = result.tool.commit.as_deref().unwrap_or("unknown");
            vec![
                Entry::linked(&record.name, record.address()),
                Entry::new(record.date()),
                Entry::new(self.records.machine(&result.host)),
                Entry::new(commit.get(..7).unwrap_or(commit)),
                Entry::new(result.cells.len().to_string()),
                Entry::new(result.command.join(" ")),
            ]
        };
        let mut columns = Column::of(["Record", "Date", "Machine", "Commit"], ["Cells"]);
        columns.push(Column::text("Command"));
        let records = Table {
            id: "records-table".to_owned(),
            caption: "Result files as they were written, the newest first.".to_owned(),
            ..Table::new(columns, results.iter().map(row).collect())
        };
        let known: Vec<String> = results
            .iter()
            .map(|r| self.records.machine(&r.result.host))
            .collect();
        let machines = distinct(known.iter().map(String::as_str)).into_iter();
        let machines = machines.map(|key| {
            let machine = self
                .records
                .machines
                .iter()
                .find(|machine| machine.key == key);
            let host = results
                .iter()
                .find(|r| self.records.machine(&r.result.host) == key);
            let host = host.map_or_else(String::new, |r| r.result.host.in_words());
            let owner = machine.map_or("unknown", |machine| &machine.owner);
            let words = machine.map_or("not described", |machine| &machine.words);
            [key, &host, owner, words].map(Entry::new).into()
        });
        let machines = Table {
            id: "machines-table".to_owned(),
            caption: "Machines, in the words of their owners.".to_owned(),
            ..Table::new(
                Column::of(["Machine", "Processor", "Owner", "Words"], [""; 0]),
                machines.collect(),
            )
        };
        vec![
            section("machines", "Machines", vec![SectionItem::Table(machines)]),
            section("all", "Records", vec![SectionItem::Table(records)]),
        ]
    }
}

pub(super) fn section(id: &str, heading: &str, blocks: Vec<SectionItem>) -> Section {
    Section {
        id: id.to_owned(),
        heading: heading.to_owned(),
        top: true,
        blocks,
    }
}

/// The sections of a page of prose, whose headings start with `## `.
pub(super) fn prose(page: &str, text: &str) -> Vec<Section> {
    let sections = text.split("\n## ").enumerate().map(|(i, part)| {
        let part = if i == 0 {
            part.trim_start_matches("## ")
        } else {
            part
        };
        let (heading, rest) = part.split_once('\n').unwrap_or((part, ""));
        let id = format!("{page}-{}", slug(heading));
        section(
            &id,
            heading,
            vec![SectionItem::Prose(rest.trim().to_owned())],
        )
    });
    sections.collect()
}
