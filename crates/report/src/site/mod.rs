//! A static site of many results: a page for each program, model and paper, and pages that compare
//! all of them. It is made from records alone and asks the network for nothing.

// Counts are never negative here, and writing pages is not a hot loop.
#![allow(clippy::cast_sign_loss, clippy::format_push_string)]

mod front;
mod measured;
mod model;
mod pages;
mod paper;
mod program;
mod records;
#[cfg(test)]
mod tests;

use std::collections::{HashMap, HashSet};
use std::fs;
use std::path::Path;

use anyhow::Context as _;
use geobench_export::output::{OutputFile, check_files, make_directory};

use self::measured::Measurement;
use self::pages::{PAGES, Pages, TREND, program_address, prose, short_hash};
pub use self::records::SiteRecords;
use crate::corpus::Corpus;
use crate::page::document::{Document, Section};
use crate::page::html;

/// A site, ready to be written: names and contents of its pages.
#[derive(Clone, Debug)]
pub struct StaticSite {
    pages: Vec<(String, String)>,
}

impl StaticSite {
    /// Builds the pages. `trend` is the page of a history.
    ///
    /// # Errors
    ///
    /// When the claims of papers or the descriptions of programs cannot be read, which does not
    /// occur.
    pub fn build(
        records: &SiteRecords,
        corpus: &Corpus,
        trend: Option<String>,
    ) -> anyhow::Result<Self> {
        let all = Measurement::all(records);
        let mut named = HashMap::new();
        for one in &all {
            named.entry(one.key()).or_insert(one.model);
        }
        let context = Pages {
            records,
            corpus,
            programs: pages::public()?,
            all: &all,
            named,
            has_trend: trend.is_some(),
        };
        let mut site = Self { pages: Vec::new() };
        let mut add = |name: &str, title: &str, sections: Vec<Section>| {
            let document = Document {
                title: title.to_owned(),
                sections,
            };
            let page = html::whole(&document, &context.links(name), "site");
            site.pages.push((name.to_owned(), page));
        };
        let judged = paper::judged(records)?;
        for (name, _, title) in PAGES {
            let sections = match name {
                "index" => front::sections(&context),
                "programs" => program::list(&context),
                "models" => model::list(&context),
                "papers" => paper::list(&judged),
                "wrong" => program::wrong(&context),
                "records" => context.records_and_machines(),
                "method" => prose("method", include_str!("prose/method.md")),
                "program" => prose("program", include_str!("prose/program.md")),
                "submit" => prose("submit", include_str!("prose/submit.md")),
                _ => prose("wishes", include_str!("prose/wishes.md")),
            };
            add(name, title, sections);
        }
        for name in context.program_names() {
            let (title, sections) = program::page(&context, name);
            add(&program_address(name), &title, sections);
        }
        let mut names = HashSet::new();
        for model in context.models() {
            let name = context.name_of(model);
            let title = if names.insert(name) {
                name.to_owned()
            } else {
                format!("{name} ({})", short_hash(model))
            };
            let address = context.model_address(model);
            add(&address, &title, model::page(&context, model));
        }
        for one in &judged {
            let title = format!("{}: {}", one.paper, one.title);
            add(
                &paper::address(&one.paper),
                &title,
                paper::page(records, one),
            );
        }
        if let Some(page) = trend {
            let links = context.links(TREND.0);
            let page = page.replacen("</header>\n", &format!("</header>\n{links}"), 1);
            site.pages.push((TREND.0.to_owned(), page));
        }
        Ok(site)
    }

    /// The names and the contents of the pages.
    pub fn pages(&self) -> impl Iterator<Item = (&str, &str)> {
        let pages = self.pages.iter();
        pages.map(|(name, page)| (name.as_str(), page.as_str()))
    }

    /// Writes the pages and copies of the records into `directory`, which is created if missing.
    /// Files of the same names are replaced; others are kept. Returns the number of pages.
    ///
    /// # Errors
    ///
    /// When something cannot be written, or would replace a file that was read. Nothing is written
    /// then.
    pub fn write(&self, records: &SiteRecords, directory: &Path) -> anyhow::Result<usize> {
        let copies = directory.join("records");
        make_directory(&copies)?;
        let mut pages = Vec::new();
        for (name, page) in &self.pages {
            let file = OutputFile::prepare(&directory.join(format!("{name}.html")))?;
            pages.push((file, page));
        }
        let mut copied = Vec::new();
        for record in &records.results {
            let file = OutputFile::prepare(&directory.join(record.address()))?;
            // A record that is its own copy stays as it is.
            if fs::canonicalize(&record.path).ok().as_deref() != Some(file.path()) {
                copied.push((file, &record.path));
            }
        }
        let written = pages.iter().map(|(file, _)| file);
        let written = written.chain(copied.iter().map(|(file, _)| file));
        check_files(written, &records.files)?;
        for (file, path) in &copied {
            let bytes =
                fs::read(path).with_context(|| format!("{}: cannot be read", path.display()))?;
            file.write(&bytes)?;
        }
        for (file, page) in &pages {
            file.write(page.as_bytes())?;
        }
        Ok(self.pages.len())
    }
}
