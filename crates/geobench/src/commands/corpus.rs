//! `geobench corpus`.

use std::path::PathBuf;

use clap::{Args, Subcommand};
use geobench_export::json_lines;
use geobench_harness::plan::suite::options::DecompressionOption;
use geobench_report::corpus::{Corpus, CorpusModel, Presence};
use serde::Serialize;

use crate::args::{FormatOption, ListFormat};
use crate::terminal;
use crate::verdict::Verdict;

#[derive(Args, Debug)]
pub(crate) struct CorpusOptions {
    #[command(subcommand)]
    command: CorpusCommand,
}

#[derive(Debug, Subcommand)]
enum CorpusCommand {
    /// Look for the models of the corpus in a directory, and make the generated ones
    Check(CheckOptions),
}

#[derive(Args, Debug)]
#[command(
    after_help = "Exit status: 0 every model is there and is the one of the corpus; 1 one is missing or differs; \
    2 wrong usage."
)]
struct CheckOptions {
    /// Directory of models
    #[arg(value_name = "DIR")]
    directory: PathBuf,

    #[command(flatten)]
    models: CorpusOption,

    #[command(flatten)]
    format: FormatOption<ListFormat>,

    #[command(flatten)]
    decompression: DecompressionOption,
}

/// The models of a corpus.
#[derive(Args, Debug)]
pub(crate) struct CorpusOption {
    /// Models of the corpus [default: the corpus in the program]
    #[arg(long, value_name = "FILE")]
    corpus: Option<PathBuf>,
}

impl CorpusOption {
    /// Reads the corpus.
    pub(crate) fn read(&self) -> anyhow::Result<Corpus> {
        let corpus = self.corpus.as_deref();
        Ok(corpus.map_or_else(Corpus::known, Corpus::read)?)
    }
}

pub(crate) fn corpus(options: &CorpusOptions) -> anyhow::Result<Verdict> {
    let CorpusCommand::Check(options) = &options.command;
    let corpus = options.models.read()?;
    let found = corpus.check(&options.directory, options.decompression.limit())?;
    let is_whole = found
        .iter()
        .all(|(_, presence)| matches!(presence, Presence::Present(_)));
    let text = match options.format.chosen() {
        ListFormat::Table => found.iter().map(line).collect(),
        ListFormat::Json => {
            #[derive(Serialize)]
            struct Found<'a> {
                #[serde(flatten)]
                model: &'a CorpusModel,
                #[serde(flatten)]
                presence: &'a Presence,
            }
            let found = found.iter();
            let found = found.map(|(model, presence)| Found { model, presence });
            json_lines(&found.collect::<Vec<_>>())?
        }
    };
    terminal::print(&text)?;
    Ok(Verdict::of(is_whole))
}

fn line((model, presence): &(&CorpusModel, Presence)) -> String {
    match presence {
        Presence::Present(path) => format!("present  {}: {path}\n", model.name),
        Presence::Missing => format!("missing  {}: from {}\n", model.name, model.address),
        Presence::Differs(how) => format!("differs  {}: {how}\n", model.name),
    }
}
