//! Pages of models.

use geobench_harness::exec::limits::DecompressionLimit;
use geobench_harness::measure::number::{grouped, ratio, scientific};
use geobench_harness::schema::ModelRecord;

use super::measured::{Measurement, key};
use super::pages::{Pages, program_address, section};
use super::program::newest_wrong;
use crate::corpus::CorpusModel;
use crate::page::PictureChoice;
use crate::page::chart::Chart;
use crate::page::document::{Plot, Section, SectionItem, slug};
use crate::page::picture;
use crate::table::{Column, Entry, Table};

/// The largest picture, in bytes of SVG. Only noisy surfaces are above.
const LARGEST_PICTURE: usize = 380_000;

/// The most faces of a model that is drawn.
const MOST_DRAWN: u64 = 150_000;

/// The corpus, then the other models.
pub(super) fn list(context: &Pages<'_>) -> Vec<Section> {
    let models = context.models();
    let programs = |hash: &str| {
        let own = context.all.iter().filter(|one| one.key() == hash);
        crate::table::group::distinct(own.map(Measurement::program)).len()
    };
    let row = |model: &CorpusModel| {
        let count = programs(&model.sha256);
        let address = format!("model-{}.html", slug(&model.name));
        vec![
            if count > 0 {
                Entry::linked(&model.name, address)
            } else {
                Entry::new(&model.name)
            },
            Entry::new(if model.is_real() { "real" } else { "generated" }),
            Entry::new(grouped(model.faces)),
            Entry::new(count.to_string()),
            Entry::new(&model.why),
            Entry::new(&model.address),
            Entry::new(model.licence.as_deref().unwrap_or("as the program")),
            Entry::new(model.sha256.get(..12).unwrap_or_default()),
        ]
    };
    let mut columns = Column::of(["Model", "Kind"], ["Faces", "Programs"]);
    columns.extend(Column::of(
        ["Why it is here", "From", "Licence", "SHA-256"],
        [""; 0],
    ));
    let corpus = Table {
        id: "corpus-table".to_owned(),
        caption:
            "The corpus: models that programs are compared on. Files hold the models as measured, \
                  with coordinates written anew; the hash is of that file."
                .to_owned(),
        ..Table::new(columns, context.corpus.models.iter().map(row).collect())
    };
    let others = models
        .iter()
        .filter(|model| context.corpus.of_record(model).is_none());
    let row = |model: &&ModelRecord| {
        vec![
            context.model_entry(model),
            Entry::new(model.faces.map_or_else(|| "-".to_owned(), grouped)),
            Entry::new(programs(key(model)).to_string()),
            Entry::new(&model.path),
        ]
    };
    let mut columns = Column::of(["Model"], ["Faces", "Programs"]);
    columns.push(Column::text("File or generator"));
    let others = Table {
        id: "others-table".to_owned(),
        caption:
            "Models of records that are not in the corpus. They do not count on the front page."
                .to_owned(),
        ..Table::new(columns, others.map(row).collect())
    };
    let about =
        "`geobench corpus check DIR` says which models of the corpus a directory holds, by \
                 their hashes, and makes the generated ones."
            .to_owned();
    let mut sections = vec![section(
        "corpus",
        "The corpus",
        vec![SectionItem::Prose(about), SectionItem::Table(corpus)],
    )];
    if !others.parts[0].rows.is_empty() {
        sections.push(section(
            "others",
            "Other models",
            vec![SectionItem::Table(others)],
        ));
    }
    sections
}

/// The page of a model.
pub(super) fn page(context: &Pages<'_>, model: &ModelRecord) -> Vec<Section> {
    let own: Vec<&Measurement<'_>> = context
        .all
        .iter()
        .filter(|one| one.key() == key(model))
        .collect();
    let mut about = vec![SectionItem::Prose(fastest(context, &own))];
    about.extend(drawn(context, model, &own).map(|plot| SectionItem::Plots(vec![plot])));
    about.push(SectionItem::Facts(facts(context, model)));
    let mut sections = vec![section("about", "The model", about)];
    let wrong: Vec<String> = newest_wrong(own.iter().copied(), Measurement::is_wrong)
        .into_iter()
        .map(|one| {
            let cell = one.failure().unwrap_or(one.cells[0]);
            let error = one
                .max_error()
                .map_or_else(String::new, |e| format!(", by up to {}", scientific(e)));
            let message = cell.message.as_deref().unwrap_or("differs");
            format!(
                "- {}{error}: {message}\n",
                context.title(one.program()).replace(['[', '*', '`'], "")
            )
        })
        .collect();
    if !wrong.is_empty() {
        let blocks = vec![SectionItem::Prose(wrong.concat())];
        sections.push(section("disagree", "Where programs disagree", blocks));
    }
    let mut rows = own;
    // The newest measurement of each label first, the fastest first; older ones follow.
    let age = |one: &Measurement<'_>, all: &[&Measurement<'_>]| {
        let newer = |other: &&&Measurement<'_>| {
            other.label == one.label && other.record.date() > one.record.date()
        };
        all.iter().filter(newer).count()
    };
    let all = rows.clone();
    rows.sort_by(|a, b| {
        let [of_a, of_b] = [a, b].map(|one| {
            let place = (age(one, &all), one.to_base.is_none());
            let ratio = one.to_base.map(|to_base| to_base.ratio);
            (place, ratio.or(one.time).unwrap_or(f64::MAX))
        });
        of_a.0.cmp(&of_b.0).then(of_a.1.total_cmp(&of_b.1))
    });
    sections.push(section(
        "results",
        "Results",
        context.table("results-table", &rows, true),
    ));
    sections
}

/// Which exact programs are the fastest, by their ratios to the base.
fn fastest(context: &Pages<'_>, own: &[&Measurement<'_>]) -> String {
    let best = |is_outside: bool| {
        let exact = own.iter().filter(|one| {
            one.is_outside() == is_outside && !one.is_approximate() && one.is_plain()
        });
        exact
            .filter_map(|one| Some((one.to_base?, one)))
            .min_by(|a, b| a.0.ratio.total_cmp(&b.0.ratio))
    };
    let said = [(false, "of this suite"), (true, "of others")].map(|(is_outside, whose)| {
        let (to_base, one) = best(is_outside)?;
        let with = match to_base.vectors() {
            "" => String::new(),
            vectors => format!(" with {vectors}"),
        };
        Some(format!(
            "The fastest exact program {whose} is [{}]({}.html), {} times the time of vtp{with} \
             ({}, {}).",
            context.title(one.program()),
            program_address(one.program()),
            ratio(to_base.ratio),
            context.records.machine(&one.record.result.host),
            one.record.date()
        ))
    });
    let said: Vec<String> = said.into_iter().flatten().collect();
    if said.is_empty() {
        return "No record compares an exact program with vtp on this model.".to_owned();
    }
    said.join(" ")
}

fn facts(context: &Pages<'_>, model: &ModelRecord) -> Vec<(String, String)> {
    let number = |count: Option<u64>| count.map(grouped);
    let known = context.corpus.of_record(model);
    let facts = [
        (
            "Why it is in the corpus",
            known.map(|known| known.why.clone()),
        ),
        ("From", known.map(|known| known.address.clone())),
        ("Licence", known.and_then(|known| known.licence.clone())),
        ("File or generator", Some(model.path.clone())),
        ("Faces", number(model.faces)),
        ("Vertices", number(model.vertices)),
        ("Boundary edges", number(model.boundary_edges)),
        ("Components", number(model.components)),
        ("Genus", number(model.genus)),
        ("Saddle vertices", number(model.saddles)),
        ("Anisotropy g", model.anisotropy.map(|g| format!("{g:.3}"))),
        ("SHA-256", model.sha256.clone()),
    ];
    let facts = facts.into_iter();
    facts
        .filter_map(|(name, value)| Some((name.to_owned(), value?)))
        .collect()
}

/// The picture of a model of the corpus, if it can be loaded again.
fn drawn(context: &Pages<'_>, model: &ModelRecord, own: &[&Measurement<'_>]) -> Option<Plot> {
    context.corpus.of_record(model)?;
    if model.faces? > MOST_DRAWN {
        return None;
    }
    let wanted = PictureChoice::Of {
        model: own[0].model.name.clone(),
        source: None,
    };
    let limit = DecompressionLimit::default();
    let picture = picture::picture(&own[0].record.result, &wanted, limit).ok()??;
    let plot = Plot {
        id: "picture".to_owned(),
        title: format!("Distances on {}", context.name_of(model)),
        caption: picture.caption.clone(),
        chart: Chart::Picture(Box::new(picture)),
    };
    (plot.draw(false).len() <= LARGEST_PICTURE).then_some(plot)
}
