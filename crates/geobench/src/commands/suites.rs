//! `geobench suites`.

use clap::Args;
use geobench_harness::plan::suite::SUITES;
use geobench_report::table::terminal::listing;
use geobench_report::table::{Column, Entry, Look, Table};

use crate::args::{FormatOption, ListFormat};
use crate::terminal;
use crate::verdict::Verdict;

#[derive(Args, Debug)]
pub(crate) struct SuitesOptions {
    #[command(flatten)]
    format: FormatOption<ListFormat>,
}

pub(crate) fn suites(options: &SuitesOptions, look: Look) -> anyhow::Result<Verdict> {
    let text = match options.format.chosen() {
        ListFormat::Json => {
            let list = SUITES.iter();
            let list =
                list.map(|suite| serde_json::json!({"name": suite.name, "shows": suite.line()}));
            geobench_export::json_lines(&list.collect::<Vec<_>>())?
        }
        ListFormat::Table => {
            let rows = SUITES.iter().map(|suite| {
                let row = [suite.name.to_owned(), suite.line()];
                row.map(Entry::new).to_vec()
            });
            let columns = Column::of(["suite", "what it shows"], [""; 0]);
            listing(&Table::new(columns, rows.collect()), look)
        }
    };
    terminal::print_rendered(&text)?;
    Ok(Verdict::Passed)
}
