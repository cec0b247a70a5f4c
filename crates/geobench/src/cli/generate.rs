//! `geobench gen`.

use super::Verdict;
use super::args::GenOptions;

pub(super) fn generate(options: &GenOptions) -> anyhow::Result<Verdict> {
    let _ = options;
    anyhow::bail!("not yet")
}
