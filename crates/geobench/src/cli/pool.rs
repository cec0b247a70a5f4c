//! `geobench pool`.

use super::Verdict;
use super::args::PoolOptions;
use crate::history::pool as rounds;
use crate::schema::result_file;
use crate::table::output;

pub(super) fn pool(options: &PoolOptions) -> anyhow::Result<Verdict> {
    let outputs = output::results(&options.output)?;
    let files = options
        .rounds
        .iter()
        .map(|path| Ok((path.display().to_string(), result_file::read(path)?)))
        .collect::<anyhow::Result<_>>()?;
    let joined = rounds::pool(files, options.pairing.clone())?;
    for (format, file) in &outputs {
        file.write(format.render(&joined)?.as_bytes())?;
    }
    Ok(Verdict::Passed)
}
