//! The front page: programs on real and on generated models.

use geobench_harness::measure::number::{counted, ratio, scientific};
use geobench_harness::schema::ModelRecord;

use super::measured::{BASE, Measurement, Standing, standings};
use super::pages::{Pages, program_address, section};
use crate::page::chart::{Axis, Chart, LinePoint, Lines, Series};
use crate::page::document::{Plot, Section, SectionItem};
use crate::table::group::distinct;
use crate::table::{Column, Entry, Mark, Table};

/// The error that an exact answer is drawn with: the rounding of a number.
const ROUNDING: f64 = 1e-16;

/// The most programs in a chart of errors; the table below has all.
const MOST_POINTS: usize = 16;

/// The most programs in the chart of times against sizes.
const MOST_SERIES: usize = 10;

/// The fewest models of a program in that chart.
const FEWEST_MODELS: usize = 3;

pub(super) fn sections(context: &Pages<'_>) -> Vec<Section> {
    let records = &context.records.results;
    let (first, last) = (&records[records.len() - 1], &records[0]);
    let is_outside = |name: &&str| name.starts_with("ext:");
    let names = context.program_names();
    let outside = names.iter().filter(|name| is_outside(name)).count();
    let about = format!(
        "{} of this suite and {} of others on {}, from {} of {} to {}. Every answer is \
         [compared](method.html) with a reference; a wrong one has no time. Times are \
         multiples of the time of [vtp](program-vtp.html), an exact algorithm, in the same run on \
         the same machine: less is better. They are of one solve; set-up is a column of its own.",
        counted(names.len() - outside, "program"),
        outside,
        counted(context.models().len(), "model"),
        counted(records.len(), "record"),
        first.date(),
        last.date(),
    );
    let classes = [
        ("real", "Real models", true),
        ("generated", "Generated models", false),
    ];
    let (mut plots, mut tables) = (Vec::new(), Vec::new());
    for (id, heading, is_real) in classes {
        let counts = |model: &ModelRecord| {
            let known = context.corpus.of_record(model);
            known.is_some_and(|known| known.is_real() == is_real)
        };
        let standings = standings(context.all, counts);
        if !standings.is_empty() {
            plots.push(errors(id, heading, &standings, context, &names));
            let blocks = vec![
                SectionItem::Prose(in_words(&standings, context)),
                SectionItem::Table(table(id, heading, &standings, context)),
            ];
            tables.push(section(id, heading, blocks));
        }
    }
    plots.extend(sizes(context, &names));
    let mut blocks = vec![SectionItem::Prose(about)];
    if tables.is_empty() {
        let none = "No record is of a model of the [corpus](models.html).";
        blocks.push(SectionItem::Prose(none.to_owned()));
    }
    blocks.push(SectionItem::Plots(plots));
    let mut sections = vec![section("overview", "Overview", blocks)];
    sections.extend(tables);
    sections
}

/// The fastest exact program of this suite, the fastest public one and the fastest approximate one.
/// Exact programs count if they solved at least half as many models as vtp.
fn in_words(standings: &[Standing<'_>], context: &Pages<'_>) -> String {
    let is_outside = |one: &&Standing<'_>| one.program.starts_with("ext:");
    let base = standings.iter().find(|one| one.program == BASE);
    let enough = base.map_or(0, |base| base.models.div_ceil(2));
    let exact = || {
        let exact = standings.iter().filter(|one| !is_approximate(one));
        exact.filter(move |one| one.models >= enough)
    };
    let said = |what: &str, one: Option<&Standing<'_>>| {
        let one = one?;
        let setup = one.setup.filter(|_| is_approximate(one));
        Some(format!(
            "{what} is [{}]({}.html): {} times the time of vtp on {}{}",
            context.title(one.program),
            program_address(one.program),
            ratio(one.ratio),
            counted(one.models, "model"),
            setup.map_or_else(String::new, |setup| format!(
                ", after a set-up of {} times",
                ratio(setup)
            )),
        ))
    };
    let sentences = [
        said(
            "The fastest exact program",
            exact().find(|one| !is_outside(one)),
        ),
        said(
            "the fastest of the public exact programs",
            exact().find(is_outside),
        ),
        said(
            "the fastest approximate one",
            standings.iter().find(|one| is_approximate(one)),
        ),
    ];
    let sentences: Vec<String> = sentences.into_iter().flatten().collect();
    format!("{}.", sentences.join("; "))
}

fn is_approximate(one: &Standing<'_>) -> bool {
    one.measured.iter().any(|m| m.is_approximate())
}

/// A row for each program, the fastest first.
fn table(id: &str, heading: &str, standings: &[Standing<'_>], context: &Pages<'_>) -> Table {
    let best = standings.iter().find(|one| !is_approximate(one));
    let best = best.map(|one| one.program);
    let row = |one: &Standing<'_>| {
        let approximate = is_approximate(one);
        let machines = one
            .measured
            .iter()
            .map(|m| context.records.machine(&m.record.result.host));
        let mark = if best == Some(one.program) {
            Mark::Best
        } else {
            Mark::None
        };
        let models = match one.linked {
            0 => one.models.to_string(),
            linked => format!("{}\u{a0}({linked}\u{a0}linked)", one.models),
        };
        vec![
            context.program_entry(one.program),
            Entry::new(if approximate { "approximate" } else { "exact" }),
            Entry::new(if one.program.starts_with("ext:") {
                "public"
            } else {
                "this suite"
            }),
            Entry::marked(ratio(one.ratio), mark),
            Entry::new(format!(
                "{}\u{a0}to\u{a0}{}",
                ratio(one.range[0]),
                ratio(one.range[1])
            )),
            Entry::new(models),
            Entry::new(one.setup.map_or_else(|| "-".to_owned(), ratio)),
            Entry::new(one.base_simd.join(", ")),
            Entry::new(scientific(one.error)),
            Entry::new(scientific(one.max_error)),
            Entry::new(context.version(one.measured[0])),
            Entry::new(distinct(machines).join(", ")),
            Entry::new(one.measured[0].record.date()),
        ]
    };
    Table {
        id: format!("{id}-table"),
        caption: format!(
            "{heading}: geometric mean of the ratios of times to those of vtp over the models that \
             each solved, so compare rows of the same models; set-up as a multiple of the time of \
             vtp; the instructions that vtp ran with, since vectors save time; relative errors. \
             Linked ratios go through a third program that both records have."
        ),
        ..Table::new(
            [
                &Column::of(
                    ["Program", "Distances", "By"],
                    ["To vtp", "Range", "Models", "Set-up"],
                )[..],
                &Column::of(["vtp with"], ["Mean error", "Max. error"]),
                &Column::of(["Version", "Machine", "Date"], [""; 0]),
            ]
            .concat(),
            standings.iter().map(row).collect(),
        )
    }
}

fn series(program: &str, context: &Pages<'_>, styles: &[&str], points: Vec<LinePoint>) -> Series {
    Series {
        style: styles.iter().position(|name| *name == program).unwrap_or(0),
        name: context.title(program).to_owned(),
        algorithm: program.to_owned(),
        joined: false,
        hollow: program.starts_with("ext:"),
        points,
        fit: None,
    }
}

/// Errors against times, with the Pareto front.
fn errors(
    id: &str,
    heading: &str,
    standings: &[Standing<'_>],
    context: &Pages<'_>,
    styles: &[&str],
) -> Plot {
    // Public and approximate programs and the base, then those with the most models.
    let mut standings: Vec<&Standing<'_>> = standings.iter().collect();
    standings.sort_by_key(|one| {
        let comes_first =
            one.program.starts_with("ext:") || one.program == BASE || is_approximate(one);
        (!comes_first, std::cmp::Reverse(one.models))
    });
    standings.truncate(MOST_POINTS);
    let series = standings.iter().map(|one| {
        let point = LinePoint::new(one.ratio, one.error.max(ROUNDING), "");
        series(one.program, context, styles, vec![point])
    });
    let x = Axis::log("Time as a multiple of vtp's");
    let lines = Lines {
        front: true,
        ..Lines::new(x, Axis::log("Mean relative error"), series.collect())
    };
    Plot {
        id: format!("{id}-errors"),
        title: format!("{heading}: error against time"),
        caption:
            "Logarithmic scales; left and below is better. The dotted line is the Pareto front: \
                  no program is both faster and more exact. Outlines are public programs."
                .to_owned(),
        chart: Chart::Lines(lines),
    }
}

/// Times against numbers of faces on the machine with the most measurements.
fn sizes(context: &Pages<'_>, styles: &[&str]) -> Option<Plot> {
    let timed = || {
        context
            .all
            .iter()
            .filter(|one| one.is_plain() && one.time.is_some() && one.label == one.program())
    };
    let machine_of = |one: &Measurement<'_>| context.records.machine(&one.record.result.host);
    let machines = distinct(timed().map(machine_of));
    // Public programs count most: a machine without one compares little.
    let worth = |machine: &&String| {
        let own = || timed().filter(|one| machine_of(one) == **machine);
        let outside = own().filter(|one| one.is_outside());
        (
            distinct(outside.map(Measurement::program)).len(),
            own().count(),
        )
    };
    let machine = machines.iter().max_by_key(worth)?;
    let own = || timed().filter(|one| machine_of(one) == *machine);
    let mut programs: Vec<(&str, Vec<LinePoint>)> = Vec::new();
    for program in distinct(own().map(Measurement::program)) {
        let mut seen = Vec::new();
        let mut points = Vec::new();
        for one in own().filter(|one| one.program() == program) {
            if let (false, Some(faces), Some(time)) =
                (seen.contains(&one.key()), one.model.faces, one.time)
            {
                seen.push(one.key());
                points.push(LinePoint::new(faces as f64, time, ""));
            }
        }
        points.sort_by(|a, b| a.x.total_cmp(&b.x));
        if points.len() >= FEWEST_MODELS {
            programs.push((program, points));
        }
    }
    // Public programs and the base first, then those with the most models.
    programs.sort_by_key(|(name, points)| {
        (
            !(name.starts_with("ext:") || *name == BASE),
            std::cmp::Reverse(points.len()),
        )
    });
    programs.truncate(MOST_SERIES);
    let series = programs
        .into_iter()
        .map(|(name, points)| series(name, context, styles, points));
    let series: Vec<Series> = series.collect();
    (!series.is_empty()).then(|| Plot {
        id: "sizes-times".to_owned(),
        title: format!("Times on {machine}"),
        caption:
            "Logarithmic scales. A marker for each model, the newest time of each; programs with \
                  three models and more. Outlines are public programs."
                .to_owned(),
        chart: Chart::Lines(Lines::new(
            Axis::log("Faces"),
            Axis::log("Time (s)"),
            series,
        )),
    })
}
