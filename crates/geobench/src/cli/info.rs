//! `geobench info`.

use super::Verdict;
use super::args::InfoOptions;
use super::terminal::Terminal;

pub(super) fn info(options: &InfoOptions, terminal: &Terminal) -> anyhow::Result<Verdict> {
    let _ = (options, terminal);
    anyhow::bail!("not yet")
}
