//! The results of a run, and the files that they go into.

use std::fs::File;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use anyhow::{Context, bail};
use geobench_export::output::{self, OutputFile};
use geobench_harness::measure::host;
use geobench_harness::plan::Plan;
use geobench_harness::run::{self, Earlier};
use geobench_harness::schema::unfinished::{self, Unfinished};
use geobench_harness::schema::{
    Cell, ModelRecord, ProgramRecord, ResultFile, SessionRecord, changed_program, result_file,
};
use geobench_report::history::join::{self, Joined};
use geobench_report::table::ResultFormat;

/// The results of a run so far, and the files to which they are written while it goes on, so that a
/// killed run loses only unfinished models.
pub(crate) struct ResultStore {
    pub(crate) result: ResultFile,
    outputs: Vec<(ResultFormat, OutputFile)>,
    /// The file of `--add-to`. Other processes may add to it meanwhile.
    add_to: Option<PathBuf>,
    /// The models that have ended, for when this process is killed.
    unfinished: Option<Unfinished>,
    write_due: WriteDue,
}

impl ResultStore {
    /// A store of `result`, which goes into `outputs` and is added to the file of `--add-to`.
    pub(crate) fn new(
        result: ResultFile,
        outputs: Vec<(ResultFormat, OutputFile)>,
        add_to: Option<PathBuf>,
    ) -> Self {
        Self {
            result,
            outputs,
            add_to,
            unfinished: None,
            write_due: WriteDue::default(),
        }
    }

    /// Adds the cells of a model that has ended, and writes the results so far to all regular files
    /// if that is due. Returns the writes that failed, which [`write_all`](Self::write_all)
    /// repeats.
    pub(crate) fn add(
        &mut self,
        model: &ModelRecord,
        cells: &[Cell],
    ) -> anyhow::Result<Vec<anyhow::Error>> {
        self.note_time();
        self.result.cells.extend_from_slice(cells);
        let path = stored_file(&self.outputs).filter(|_| self.unfinished.is_none());
        if let (Some(path), None) = (path, &self.add_to) {
            self.unfinished = Unfinished::create(path, &self.result).ok();
        }
        let store = self.unfinished.as_mut();
        let stored = store.map(|store| store.add(&self.result.groups, model, cells));
        let is_stored = matches!(stored, Some(Ok(())));
        if is_stored && !self.write_due.now(self.result.cells.len()) {
            return Ok(Vec::new());
        }
        let start = Instant::now();
        let (whole, _lock) = match self.whole() {
            Ok((joined, lock)) => (joined.file, lock),
            Err(error) => return Ok(vec![error]),
        };
        let mut failed = Vec::new();
        for (format, file) in self.outputs.iter().filter(|(_, file)| file.is_replaced()) {
            failed.extend(file.write(format.render(&whole)?.as_bytes()).err());
        }
        // The file of `--add-to` then has what a killed run has left in a store. Without a store,
        // as when another process that adds to the file has it, each model is written.
        if let (Some(path), None, []) = (&self.add_to, &self.unfinished, &failed[..]) {
            self.unfinished = Unfinished::create(path, &whole).ok();
        }
        self.write_due.done(self.result.cells.len(), start);
        Ok(failed)
    }

    /// Writes the final results, with those of the file of `--add-to`, to all files, and returns
    /// them with notes on how they were joined.
    ///
    /// # Errors
    ///
    /// If one of them cannot be written, or that of `--add-to` not read. The results are then saved
    /// in a temporary file, which the error names.
    pub(crate) fn write_all(&mut self) -> anyhow::Result<Joined> {
        self.note_time();
        let (joined, _lock) = match self.whole() {
            Ok(whole) => whole,
            Err(error) => bail!("{error:#}; {}", rescue(&self.result)?),
        };
        let mut failed = Vec::new();
        for (format, file) in &self.outputs {
            if let Err(error) = file.write(format.render(&joined.file)?.as_bytes()) {
                failed.push(format!("{error:#}"));
            }
        }
        if !failed.is_empty() {
            bail!("{}; {}", failed.join("; "), rescue(&joined.file)?);
        }
        match (self.unfinished.take(), &self.add_to) {
            (Some(store), _) => store.remove(),
            (None, Some(path)) => unfinished::remove_abandoned(path),
            (None, None) => {}
        }
        Ok(joined)
    }

    /// The results so far, together with those that the file of `--add-to` has now. While the lock
    /// is kept, no other process adds to that file.
    fn whole(&self) -> anyhow::Result<(Joined, Option<File>)> {
        let new = self.result.clone();
        let Some(path) = &self.add_to else {
            let notes = Vec::new();
            return Ok((Joined { file: new, notes }, None));
        };
        let name = path.display().to_string();
        let lock = output::lock(path).with_context(|| format!("{name}: cannot be locked"))?;
        let mut file = result_file::read(path)?;
        // Each write after the first finds what this run has written before.
        let is_own = |session: &SessionRecord| {
            let mut of_new = new.sessions.iter();
            of_new.any(|own| (&own.started, &own.command) == (&session.started, &session.command))
        };
        file.sessions.retain(|session| !is_own(session));
        let joined = join::extend((&name, file), ("this run", new))?;
        Ok((joined, Some(lock)))
    }

    /// Sets the end time of the results and of this session to now.
    fn note_time(&mut self) {
        self.result.finished = host::now();
        if let Some(session) = self.result.sessions.last_mut() {
            session.finished = Some(self.result.finished.clone());
        }
    }
}

/// The output beside which the results so far are stored: the first file of results, which the
/// store then completes for every command that reads it, else the first file.
pub(crate) fn stored_file(outputs: &[(ResultFormat, OutputFile)]) -> Option<&Path> {
    let files = || outputs.iter().filter(|(_, file)| file.is_replaced());
    let results = files().find(|(format, _)| *format == ResultFormat::Json);
    results
        .or_else(|| files().next())
        .map(|(_, file)| file.path())
}

/// When the results so far are written to the output files: each time that they have grown by a
/// quarter, so that all writes together take linear time, and at least once a minute, unless a
/// write itself takes long.
#[derive(Debug, Default)]
struct WriteDue {
    /// Number of cells at the last write, and its end and duration.
    last: Option<(usize, Instant, Duration)>,
}

impl WriteDue {
    const MOST_AGE: Duration = Duration::from_secs(60);

    /// Whether results with this number of cells are to be written now.
    fn now(&self, cells: usize) -> bool {
        self.last.is_none_or(|(known, end, took)| {
            4 * cells >= 5 * known || end.elapsed() >= Self::MOST_AGE.max(100 * took)
        })
    }

    /// Notes a write that began at `start`.
    fn done(&mut self, cells: usize, start: Instant) {
        self.last = Some((cells, Instant::now(), start.elapsed()));
    }
}

/// Reads the file of `--add-to`.
///
/// # Errors
///
/// If the file cannot be read, or if results of `plans` cannot be combined with it: it is from
/// another machine and times would be added, it is a part of a benchmark, or it has other goals,
/// vector instructions or outside `programs`.
pub(crate) fn earlier(
    path: &Path,
    plans: &[Plan],
    programs: &[ProgramRecord],
) -> anyhow::Result<ResultFile> {
    let name = path.display().to_string();
    let file = result_file::read(path)?;
    let here = host::host();
    let times_nothing = || {
        let known = Earlier::new(&file);
        plans.iter().all(|plan| run::is_known(plan, &known))
    };
    if !here.is_same_machine(&file.host) && !times_nothing() {
        bail!(
            "{name}: from another machine, so that times added here would not compare: {} and not {}",
            file.host.in_words(),
            here.in_words()
        );
    }
    if file.plan.as_ref().is_some_and(|plan| plan.shard.is_some()) {
        bail!("{name}: a part of a benchmark; join the parts with `geobench merge` first");
    }
    if let Some(difference) = changed_program(file.programs(), programs) {
        bail!("{name}: its times are of another program: {difference}; name another file");
    }
    for plan in plans {
        let of_group = |cell: &&Cell| cell.group == plan.group.name;
        let goal = plan.goal.label();
        let mut cells = file.cells.iter().filter(of_group);
        if let Some(cell) = cells.find(|cell| cell.goal != goal) {
            let word = |goal: Option<String>| goal.unwrap_or_else(|| "to all vertices".to_owned());
            bail!(
                "{name}: its runs are {}, and this one {}; give the same --target and --radius or \
                 name another file",
                word(cell.goal.clone()),
                word(goal)
            );
        }
        for algorithm in &plan.algorithms {
            let label = algorithm.label();
            let of_same = |cell: &&Cell| cell.group == plan.group.name && cell.algorithm == label;
            let found = file
                .cells
                .iter()
                .filter(of_same)
                .find(|cell| cell.simd.is_some());
            if let Some(cell) = found.filter(|cell| cell.simd != algorithm.simd()) {
                let [there, here] = [cell.simd.clone(), algorithm.simd()];
                let word = |simd: Option<String>| simd.unwrap_or_else(|| "no choice of".to_owned());
                bail!(
                    "{name}: its cells of {label} have {} instructions, and this run {}; give the \
                     same --simd or name another file",
                    word(there),
                    word(here)
                );
            }
        }
    }
    Ok(file)
}

/// Saves results in a temporary file after writing them elsewhere has failed. Returns a message
/// with the path, or with the error.
fn rescue(result: &ResultFile) -> anyhow::Result<String> {
    let json = ResultFormat::Json.render(result)?;
    let save = || -> std::io::Result<PathBuf> {
        let mut file = tempfile::Builder::new()
            .prefix("geobench-")
            .suffix(".json")
            .tempfile()?;
        file.write_all(json.as_bytes())?;
        Ok(file.keep()?.1)
    };
    Ok(match save() {
        Ok(path) => format!("the results are in {}", path.display()),
        Err(error) => format!("nor could the results be saved as a temporary file: {error}"),
    })
}
