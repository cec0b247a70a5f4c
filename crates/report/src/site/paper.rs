//! Pages of papers: their claims with verdicts, and their tables beside ours.

use geobench_harness::measure::number::counted;

use super::pages::section;
use super::records::SiteRecords;
use crate::claims::page::{why, with_cause};
use crate::claims::{self, ClaimVerdict, Input, JudgedPaper};
use crate::page::document::{Section, SectionItem, slug};
use crate::page::papers::{self, Tables};
use crate::page::setting::Setting;
use crate::table::group::algorithms;
use crate::table::{Column, Entry, Mark, Table, results};

/// The name of the page of a paper.
pub(super) fn address(paper: &str) -> String {
    format!("paper-{}", slug(paper))
}

/// The claims of all papers, by the newest record of each suite.
pub(super) fn judged(records: &SiteRecords) -> anyhow::Result<Vec<JudgedPaper>> {
    let mut seen = Vec::new();
    let newest = records.results.iter().filter(|record| {
        let is_full = record.result.command.iter().any(|word| word == "--full");
        let Some(suite) = record.result.suite() else {
            return true;
        };
        let is_new = !seen.contains(&(suite.clone(), is_full));
        seen.push((suite, is_full));
        is_new
    });
    let inputs: Vec<Input> = newest
        .map(|record| Input::new(record.path.clone(), record.result.clone()))
        .collect();
    Ok(claims::judge(&claims::known()?, &inputs)?.papers)
}

/// All papers with the counts of their verdicts.
pub(super) fn list(judged: &[JudgedPaper]) -> Vec<Section> {
    let row = |paper: &JudgedPaper| {
        let count = |verdict: ClaimVerdict| {
            let with = paper.claims.iter().filter(|claim| claim.verdict == verdict);
            Entry::new(with.count().to_string())
        };
        let name = format!("{}: {}", paper.paper, paper.title);
        let link = Entry::linked(name, format!("{}.html", address(&paper.paper)));
        std::iter::once(link)
            .chain(ClaimVerdict::ALL.map(count))
            .collect()
    };
    let verdicts = ClaimVerdict::ALL.map(ClaimVerdict::in_words);
    let table = Table {
        id: "papers-table".to_owned(),
        caption: "The number of claims of each paper with each verdict.".to_owned(),
        ..Table::new(
            Column::of(["Paper"], verdicts),
            judged.iter().map(row).collect(),
        )
    };
    let about = "Verdicts are computed from the records. **Confirmed**: a claim holds in every case, \
                 with sizes like the paper's. **Direction only**: it holds, sizes differ. **Partly**: in \
                 most cases. **Not**: in at most half. **Cannot be judged**: the records do not decide.";
    let blocks = vec![
        SectionItem::Prose(about.to_owned()),
        SectionItem::Table(table),
    ];
    vec![section("all-papers", "All papers", blocks)]
}

/// The page of a paper.
pub(super) fn page(records: &SiteRecords, paper: &JudgedPaper) -> Vec<Section> {
    let row = |claim: &claims::JudgedClaim| {
        let mark = match claim.verdict {
            ClaimVerdict::Not => Mark::Failed,
            _ => Mark::None,
        };
        let quote = format!("\u{201c}{}\u{201d} {}", claim.quote, claim.printed);
        vec![
            Entry::new(&claim.claim),
            Entry::marked(with_cause(claim), mark),
            Entry::new(&claim.place),
            Entry::new(quote.trim()),
            Entry::new(&claim.shown),
            Entry::new(why(claim)),
        ]
    };
    let heads = ["Claim", "Verdict", "Place", "Paper", "Here", "Why"];
    let table = Table {
        id: "claims-table".to_owned(),
        caption: format!("{}.", counted(paper.claims.len(), "claim")),
        ..Table::new(
            Column::of(heads, [""; 0]),
            paper.claims.iter().map(row).collect(),
        )
    };
    let mut sections = vec![section("claims", "Claims", vec![SectionItem::Table(table)])];
    let mut suites = Vec::new();
    for record in &records.results {
        let result = &record.result;
        let suite = result.suite_with_its_models();
        let Some(suite) = suite.filter(|suite| suite.starts_with(&format!("{}-", paper.paper)))
        else {
            continue;
        };
        if suites.contains(&suite) {
            continue;
        }
        let styles = algorithms(&result.cells);
        let claimed = algorithms(result.cells.iter().filter(|cell| cell.time.unconfirmed));
        let mut blocks = Vec::new();
        for (i, group) in results::groups(result).iter().enumerate() {
            for (k, table) in Tables::OfSuite.of(result).iter().enumerate() {
                let prefix = format!("{}-{i}-{k}", slug(&suite));
                let setting = Setting {
                    prefix: &prefix,
                    styles: &styles,
                    claimed: &claimed,
                    base: group.record.ratios_to.as_deref(),
                };
                blocks.extend(papers::compare(group, table, setting, &prefix));
            }
        }
        if !blocks.is_empty() {
            let made = format!(
                "From the [record]({}) of {}.",
                record.address(),
                record.date()
            );
            blocks.insert(0, SectionItem::Prose(made));
            sections.push(section(&format!("table-{}", slug(&suite)), &suite, blocks));
            suites.push(suite);
        }
    }
    // Sections of tables in the order of the paper.
    sections[1..].sort_by(|a, b| a.heading.cmp(&b.heading));
    sections
}
