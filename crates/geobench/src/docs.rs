//! Parts of the pages in `docs` that are made from definitions in the code: options from the
//! command line, facts and parameters from the registry, counters from `geobench_window`. Each
//! stands between `<!-- BEGIN: NAME -->` and `<!-- END: NAME -->`. The tests compare; with
//! `UPDATE_DOCS` in the environment they write.

use std::collections::BTreeSet;
use std::fmt::Write as _;
use std::fs;
use std::path::Path;

use clap::Arg;
use clap::builder::{PossibleValue, Str};
use geobench_registry::{self as registry, Algorithm, Parameter};

use crate::commands::algos::{ADVICE, counters};

const DOCS: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../docs");
const RENEWAL: &str = "UPDATE_DOCS=1 cargo test -p geobench --bin geobench docs";

/// Options that the guide explains in a section of its own.
const SECTIONS: [(&str, &str); 7] = [
    ("source", "sources-and-targets"),
    ("sources", "sources-and-targets"),
    ("target", "sources-and-targets"),
    ("targets", "sources-and-targets"),
    ("view", "pictures"),
    ("weld", "welding"),
    ("far", "sources-and-targets"),
];

#[test]
fn made_parts_of_the_pages_agree_with_the_code() {
    let mut parts = BTreeSet::new();
    for folder in ["", "algorithms"] {
        for entry in fs::read_dir(Path::new(DOCS).join(folder)).unwrap() {
            let page = entry.unwrap().path();
            if page.extension().is_none_or(|ending| ending != "md") {
                continue;
            }
            let written = fs::read_to_string(&page).unwrap();
            let renewed = renew(&written, &mut parts);
            if std::env::var_os("UPDATE_DOCS").is_some() {
                fs::write(&page, renewed).unwrap();
            } else {
                assert!(
                    renewed == written,
                    "{}: renewed by {RENEWAL}",
                    page.display()
                );
            }
        }
    }
    let others = [
        "counters",
        "advice",
        "algorithms exact",
        "algorithms approximate",
    ];
    let mut expected: BTreeSet<String> = others.map(str::to_owned).into();
    let commands = "run verify distance path isolines certify voronoi remesh report site cluster";
    let commands = commands.split(' ');
    expected.extend(commands.map(|command| format!("options {command}")));
    for algorithm in registry::algorithms() {
        expected.insert(format!("facts {}", algorithm.name));
        if !algorithm.parameters.is_empty() {
            expected.insert(format!("parameters {}", algorithm.name));
        }
    }
    assert_eq!(parts, expected, "the parts of all pages");
}

/// The page with every part made anew. Adds the names of the parts.
fn renew(page: &str, names: &mut BTreeSet<String>) -> String {
    let mut renewed = String::new();
    let mut rest = page;
    while let Some((before, after)) = rest.split_once("<!-- BEGIN: ") {
        let (name, after) = after.split_once(" -->\n").unwrap();
        let end = format!("<!-- END: {name} -->");
        let (_, after) = after
            .split_once(&end)
            .unwrap_or_else(|| panic!("{end} is missing"));
        let part = part(name);
        write!(renewed, "{before}<!-- BEGIN: {name} -->\n{part}{end}").unwrap();
        names.insert(name.to_owned());
        rest = after;
    }
    renewed + rest
}

/// A part in Markdown by its name: a kind, and for most kinds a command or an algorithm.
fn part(name: &str) -> String {
    let algorithm = |name| registry::find(name).unwrap();
    match name.split_once(' ') {
        Some(("options", command)) => options(command),
        Some(("facts", name)) => facts(algorithm(name)),
        Some(("parameters", name)) => parameters(algorithm(name)),
        Some(("algorithms", kind)) => overview(kind == "exact"),
        None if name == "counters" => {
            let rows = counters().into_iter();
            let rows = rows.map(|c| [format!("`{}`", c.name), c.definition.to_owned()]);
            table(["counter", "meaning"], rows.collect())
        }
        None if name == "advice" => {
            let rows = ADVICE.map(|(want, take)| [want.to_owned(), in_markdown(take, "")]);
            table(["purpose", "algorithm"], rows.into())
        }
        _ => panic!("{name}: no part of a page"),
    }
}

/// A table; an entry may hold any text.
fn table<const N: usize>(heads: [&str; N], rows: Vec<[String; N]>) -> String {
    let mut table = format!("| {} |\n|{}\n", heads.join(" | "), "---|".repeat(N));
    for row in rows {
        writeln!(
            table,
            "| {} |",
            row.map(|entry| entry.replace('|', "\\|")).join(" | ")
        )
        .unwrap();
    }
    table.replace("  |", " |")
}

/// The options of a command in the order of its help, in a table for each heading. Those that
/// `run` has with the same meaning are only named.
fn options(command: &str) -> String {
    let of_run = if command == "run" {
        Vec::new()
    } else {
        arguments("run")
    };
    let is_of_run = |arg: &Arg| of_run.iter().any(|other| row(arg) == row(other));
    let (same, own): (Vec<_>, Vec<_>) = arguments(command).into_iter().partition(is_of_run);
    let groups = own.chunk_by(|a, b| a.get_help_heading() == b.get_help_heading());
    let tables = groups.map(|group| {
        let mut rows: Vec<_> = group.iter().map(row).collect();
        if own.ends_with(group) && !same.is_empty() {
            let names: Vec<String> = same.iter().map(linked).collect();
            rows.push([
                names.join(", "),
                "as in [`run`](#run)".into(),
                String::new(),
            ]);
        }
        let heading = group[0].get_help_heading();
        let heading = heading.map_or(String::new(), |heading| format!("{heading}:\n\n"));
        heading + &table(["option", "meaning", "default"], rows)
    });
    tables.collect::<Vec<_>>().join("\n")
}

/// The options of a command in the order of its help, without those that all commands have.
fn arguments(command: &str) -> Vec<Arg> {
    let mut program = crate::program();
    program.build();
    let command = program.find_subcommand_mut(command).unwrap();
    let help = command.render_help().to_string();
    let place = |arg: &Arg| {
        let long = format!("--{}", arg.get_long()?);
        let mut lines = help
            .lines()
            .filter(|line| line.trim_start().starts_with('-'));
        lines.position(|line| line.split([' ', '[']).take(7).any(|word| word == long))
    };
    let shown = |arg: &&Arg| !arg.is_hide_set() && !arg.is_global_set() && arg.get_id() != "help";
    let mut arguments: Vec<_> = command.get_arguments().filter(shown).cloned().collect();
    arguments.retain(|arg| !arg.is_positional());
    arguments.sort_by_cached_key(place);
    arguments
}

/// The help of an option, and its default where the help names it.
fn help(arg: &Arg) -> (String, String) {
    let help = arg.get_help().map(ToString::to_string).unwrap_or_default();
    match help.split_once("[default: ") {
        Some((meaning, default)) => {
            let (default, rest) = default.split_once(']').unwrap();
            ((meaning.trim_end().to_owned() + rest), default.to_owned())
        }
        None => (help, String::new()),
    }
}

/// An option with its values, as a link if the guide has a section about it.
fn linked(arg: &Arg) -> String {
    let short = arg
        .get_short()
        .map_or(String::new(), |short| format!("-{short}, "));
    let long = arg.get_long().unwrap();
    let takes_values = arg.get_action().takes_values();
    let words = arg.get_possible_values();
    let words: Vec<&str> = words
        .iter()
        .filter(|word| !word.is_hide_set())
        .map(PossibleValue::get_name)
        .collect();
    let names = arg.get_value_names().unwrap_or_default();
    let mut values: Vec<&str> = names.iter().map(Str::as_str).collect();
    let words = words.join("|");
    if takes_values && !words.is_empty() {
        values[0] = &words;
    }
    let values = values.join(" ");
    let values = match arg.get_num_args() {
        Some(range) if range.max_values() == 0 => String::new(),
        Some(range) if range.min_values() == 0 => format!("[={values}]"),
        _ if takes_values => format!(" {values}"),
        _ => String::new(),
    };
    let name = format!("`{short}--{long}{values}`");
    match SECTIONS.iter().find(|(option, _)| *option == long) {
        Some((_, section)) => format!("[{name}](#{section})"),
        None => name,
    }
}

fn row(arg: &Arg) -> [String; 3] {
    let (meaning, mut default) = help(arg);
    let required = if arg.is_required_set() {
        "Required. "
    } else {
        ""
    };
    if arg.get_action().takes_values() && !arg.get_default_values().is_empty() {
        default = arg.get_default_values()[0].to_string_lossy().into_owned();
    } else if default == "the first of these" {
        default = arg.get_possible_values()[0].get_name().to_owned();
    }
    [linked(arg), format!("{required}{meaning}"), default]
}

/// The exact or the approximate algorithms, with links to their pages.
fn overview(exact: bool) -> String {
    let algorithms = registry::algorithms().iter();
    let row = |algorithm: &Algorithm| {
        let name = format!("[`{0}`]({0}.md)", algorithm.name);
        let description = in_markdown(algorithm.summary, algorithm.name);
        [name, algorithm.family.to_owned(), description]
    };
    let rows = algorithms.filter(|algorithm| algorithm.exact == exact);
    table(["name", "family", "description"], rows.map(row).collect())
}

/// The table at the head of the page of an algorithm.
fn facts(algorithm: &Algorithm) -> String {
    let mut parameters = algorithm.parameters.iter();
    let is_parallel = parameters.any(|parameter| parameter.name == "threads");
    let threads = ["one thread", "a number of threads"][usize::from(is_parallel)];
    let returns = match algorithm {
        Algorithm { field: Some(_), .. } => {
            "the exact distance of every vertex and its nearest source, and the windows from which \
             `geobench voronoi` makes the diagram; infinity where no path leads"
        }
        Algorithm { exact: true, .. } => {
            "the exact distance of every vertex; infinity where no path leads"
        }
        _ => "an approximate distance of every vertex; infinity where no path leads",
    };
    let junctions = ["refuses them", "crosses them"][usize::from(algorithm.crosses_junctions)];
    let rows = [
        ("family", format!("`{}`", algorithm.family)),
        ("paper", algorithm.paper.to_owned()),
        ("takes", format!("a mesh, one or more sources; {threads}")),
        ("returns", returns.to_owned()),
        ("[junctions](junctions.md)", junctions.to_owned()),
        (
            "cost for n faces, at worst",
            in_markdown(algorithm.complexity, algorithm.name),
        ),
        ("keeps", in_markdown(algorithm.keeps, algorithm.name)),
        ("choose it", in_markdown(algorithm.choose, algorithm.name)),
    ];
    table(
        ["", ""],
        rows.map(|(name, fact)| [name.to_owned(), fact]).into(),
    )
}

fn parameters(algorithm: &Algorithm) -> String {
    let row = |parameter: &Parameter| {
        let Parameter {
            name,
            default,
            allowed,
            meaning,
            only_with,
            ..
        } = parameter;
        let mut meaning = in_markdown(meaning, algorithm.name);
        if let Some((other, values)) = only_with {
            let values = values.join("` or `");
            write!(meaning, ". Only with `{other}={values}`").unwrap();
        }
        [
            format!("`{name}`"),
            allowed.to_string(),
            format!("`{default}`"),
            meaning,
        ]
    };
    let rows = algorithm.parameters.iter().map(row).collect();
    table(["name", "values", "default", "meaning"], rows)
}

/// A text of the registry on the page of `own`: with links to other algorithms, and powers.
fn in_markdown(text: &str, own: &str) -> String {
    const ENDS: [char; 6] = [' ', ',', ';', ':', ')', '\''];
    let text = text
        .replace("^2", "²")
        .replace("^3", "³")
        .replace("sqrt(n)", "√n");
    let linked = text.split_inclusive(ENDS).map(|word| {
        let name = word.trim_end_matches(ENDS);
        let is_other = |algorithm: &Algorithm| algorithm.name == name && name != own;
        if registry::algorithms().iter().any(is_other) {
            format!("[`{name}`]({name}.md){}", &word[name.len()..])
        } else {
            word.to_owned()
        }
    });
    linked.collect()
}
