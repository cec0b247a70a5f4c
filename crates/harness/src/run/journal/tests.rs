//! Tests of the journal with a mock backend.

use std::fs;
use std::path::PathBuf;
use std::thread;
use std::time::Duration;

use super::{Journal, JournalHeader};
use crate::exec::mock::{MockBackend, crash_ich, spoil_vtp};
use crate::exec::{Failure, InstructionCounter, Listener, Pass};
use crate::plan::sampling::Sampling;
use crate::plan::{Plan, Reference};
use crate::run::mock::{NullListener, plan};
use crate::run::{Records, run};
use crate::schema::{
    Cell, Host, InstructionCount, IsolationRecord, ModelRecord, PhaseSeconds, SessionRecord,
    Status, Tool,
};
use geobench_registry as registry;
use tempfile::TempDir;

/// A temporary directory for a journal.
struct Desk {
    directory: TempDir,
}

impl Desk {
    fn new() -> Self {
        Self {
            directory: tempfile::tempdir().unwrap(),
        }
    }

    fn path(&self) -> PathBuf {
        self.directory.path().join("j.jsonl")
    }

    fn text(&self) -> String {
        fs::read_to_string(self.path()).unwrap()
    }

    fn open(&self, plan: &Plan) -> anyhow::Result<Journal> {
        Journal::open(&self.path(), &header(plan), &session())
    }

    /// Opens the journal and executes the plan.
    fn run(&self, plan: &Plan, backend: &MockBackend) -> Records {
        self.run_jobs(plan, backend, 1)
    }

    /// Opens the journal and executes the plan, with up to `jobs` concurrent cells.
    fn run_jobs(&self, plan: &Plan, backend: &MockBackend, jobs: usize) -> Records {
        let mut journal = self.open(plan).unwrap();
        let listener = &mut NullListener;
        run(plan, backend, Some(&mut journal), None, listener, jobs).unwrap()
    }

    /// The error message of opening the journal, with `J` for its path.
    fn refused(&self, plan: &Plan) -> String {
        let before = fs::read(self.path()).unwrap();
        let message = format!("{:#}", self.open(plan).unwrap_err());
        assert_eq!(fs::read(self.path()).unwrap(), before, "it is left alone");
        message.replace(&self.path().display().to_string(), "J")
    }
}

fn tool() -> Tool {
    Tool {
        version: "1.2.3".into(),
        commit: Some("c0ffee".into()),
        rustc: None,
        rustflags: None,
        profile: "release".into(),
        features: Vec::new(),
    }
}

fn isolation() -> IsolationRecord {
    IsolationRecord {
        process: true,
        cpus: None,
        jobs: None,
    }
}

fn header(plan: &Plan) -> JournalHeader {
    JournalHeader::new(
        tool(),
        crate::plan::record(std::slice::from_ref(plan), isolation()),
    )
}

fn session() -> SessionRecord {
    SessionRecord {
        shard: None,
        host: Host {
            cpu: None,
            cores: 1,
            memory_bytes: None,
            os: "some system".into(),
            kernel: None,
            load_start: None,
            simd: None,
            node: None,
        },
        command: vec!["geobench".into()],
        started: "2025-01-01T00:00:00Z".into(),
        finished: None,
        tool: None,
        programs: Vec::new(),
    }
}

fn small() -> Plan {
    let mut plan = plan(&["horse", "cow"], "mmp,vtp,ich", "0");
    plan.sampling = Sampling::Fixed(2);
    plan
}

/// The cells as JSON, without their times, which differ from run to run.
fn essence(records: &Records) -> String {
    let mut records = records.clone();
    for cell in &mut records.cells {
        let count = cell.time.samples.len();
        cell.time = crate::schema::Time {
            samples: vec![0.0; count],
            places: cell.time.places.clone(),
            ..Default::default()
        };
        cell.phases = PhaseSeconds::default();
    }
    serde_json::to_string(&records.cells).unwrap()
}

#[test]
fn complete_models_are_neither_run_nor_loaded() {
    let desk = Desk::new();
    let first = MockBackend::default();
    let whole = desk.run(&small(), &first);
    let lines = desk.text().lines().count();
    // One line each for the header, the session, the two models and every run.
    assert_eq!(lines, 2 + 2 + first.log().len());

    let second = MockBackend {
        refuse: vec!["horse", "cow"],
        ..MockBackend::default()
    };
    let again = desk.run(&small(), &second);
    assert_eq!(second.log(), [""; 0]);
    assert_eq!(
        serde_json::to_string(&again.cells).unwrap(),
        serde_json::to_string(&whole.cells).unwrap(),
        "times included"
    );
    assert_eq!(desk.text().lines().count(), lines + 1, "one more session");
}

fn is_run(line: &str) -> bool {
    line.starts_with("{\"run\"")
}

/// Truncates the journal after every line and within it, and resumes from there.
#[test]
fn wherever_a_run_is_killed_it_goes_on_to_the_same_result() {
    for alter in [None, Some(spoil_vtp as _), Some(crash_ich as _)] {
        let backend = || MockBackend {
            alter,
            ..MockBackend::default()
        };
        let desk = Desk::new();
        let undisturbed = backend();
        let whole = essence(&desk.run(&small(), &undisturbed));
        let text = desk.text();
        let lines: Vec<&str> = text.split_inclusive('\n').collect();
        for kept in 0..=lines.len() {
            let mut part: String = lines[..kept].concat();
            if let Some(next) = lines.get(kept) {
                part.push_str(&next[..(kept * 37) % next.len()]);
            }
            fs::write(desk.path(), &part).unwrap();
            let rest = backend();
            assert_eq!(essence(&desk.run(&small(), &rest)), whole, "{kept}");
            let runs_kept = lines[..kept].iter().filter(|l| is_run(l)).count();
            let timed = |log: &[String]| log.iter().filter(|l| !l.starts_with("warm")).count();
            let timed_in = lines[..kept]
                .iter()
                .filter(|l| is_run(l) && !l.contains("warm_up"))
                .count();
            assert_eq!(
                timed(&rest.log()) + timed_in,
                timed(&undisturbed.log()),
                "{kept}: every run but warm-ups is made exactly once"
            );
            let repeated = rest.log().len() + runs_kept - undisturbed.log().len();
            assert!(repeated <= 4, "{kept}: {repeated} warm-ups are repeated");
            let finished = desk.text();
            assert!(finished.starts_with(&lines[..kept].concat()));
        }
    }
}

#[test]
fn cells_that_ran_at_the_same_time_are_not_repeated() {
    for alter in [None, Some(spoil_vtp as _), Some(crash_ich as _)] {
        let backend = || MockBackend {
            alter,
            ..MockBackend::default()
        };
        let desk = Desk::new();
        let undisturbed = backend();
        let whole = essence(&desk.run_jobs(&small(), &undisturbed, 3));
        let text = desk.text();
        let lines: Vec<&str> = text.split_inclusive('\n').collect();
        for kept in 2..=lines.len() {
            fs::write(desk.path(), lines[..kept].concat()).unwrap();
            let rest = backend();
            assert_eq!(essence(&desk.run_jobs(&small(), &rest, 3)), whole, "{kept}");
            let timed = |log: &[String]| log.iter().filter(|l| !l.starts_with("warm")).count();
            let timed_in = lines[..kept]
                .iter()
                .filter(|l| is_run(l) && !l.contains("warm_up"))
                .count();
            assert_eq!(
                timed(&rest.log()) + timed_in,
                timed(&undisturbed.log()),
                "{kept}: every run but warm-ups is made exactly once"
            );
        }
    }
}

/// Returns made-up instruction counts. Holds the number of calls.
#[derive(Default)]
struct Counting(u64);

impl Listener for Counting {
    fn instruction_counter(&mut self, _: &ModelRecord, _: &Cell) -> Option<InstructionCounter> {
        self.0 += 1;
        let found = InstructionCount {
            count: 1000 + self.0,
            simd: Some("avx2".to_owned()),
        };
        Some(Box::new(|_, _| Ok(found)))
    }
}

#[test]
fn instructions_are_counted_once() {
    let desk = Desk::new();
    let go = |listener: &mut Counting| {
        let mut journal = desk.open(&small()).unwrap();
        let backend = MockBackend::default();
        run(&small(), &backend, Some(&mut journal), None, listener, 1).unwrap()
    };
    let mut first = Counting::default();
    let whole = go(&mut first);
    assert_eq!(first.0, 6);
    assert_eq!(whole.cells[5].instructions, Some(1006));
    let mut second = Counting::default();
    assert_eq!(go(&mut second).cells, whole.cells);
    assert_eq!(second.0, 0);
}

#[test]
fn a_cell_that_failed_is_not_tried_again() {
    let desk = Desk::new();
    let plan = plan(&["horse"], "mmp,vtp,ich", "0,3");
    let crashing = MockBackend {
        alter: Some(crash_ich),
        ..MockBackend::default()
    };
    desk.run(&plan, &crashing);
    // As if killed after ich failed in the first round.
    let text = desk.text();
    let end = text.find("crashed").unwrap();
    let end = end + text[end..].find('\n').unwrap() + 1;
    fs::write(desk.path(), &text[..end]).unwrap();
    let rest = MockBackend::default();
    let records = desk.run(&plan, &rest);
    assert!(!rest.log().contains(&"time ich 0".to_owned()));
    assert!(!rest.log().contains(&"warm ich 0".to_owned()));
    assert!(rest.log().contains(&"time ich 3".to_owned()));
    let statuses: Vec<Status> = records.cells.iter().map(|c| c.status).collect();
    assert_eq!(statuses[2], Status::Crashed);
    assert!(statuses[3..].iter().all(|&s| s == Status::Ok));
}

#[test]
fn a_reference_that_failed_is_not_tried_again() {
    let desk = Desk::new();
    let mut plan = plan(&["horse"], "vtp,ich", "0");
    plan.reference = Reference::Algorithm(registry::select_one("mmp").unwrap());
    let failing = MockBackend {
        alter: Some(|step, _| {
            (step.algorithm.label() == "mmp").then(|| Failure {
                status: Status::Timeout,
                message: "too long".into(),
            })
        }),
        ..MockBackend::default()
    };
    let whole = desk.run(&plan, &failing);
    let text = desk.text();
    let some: Vec<&str> = text.split_inclusive('\n').take(8).collect();
    fs::write(desk.path(), some.concat()).unwrap();
    let rest = MockBackend::default();
    let records = desk.run(&plan, &rest);
    assert!(rest.log().iter().all(|line| !line.contains("mmp")));
    assert_eq!(essence(&records), essence(&whole));
    assert_eq!(
        records.cells[1].message.as_deref(),
        Some("not checked: the reference mmp failed: too long")
    );
}

#[test]
fn a_journal_of_another_run_is_refused_with_the_difference() {
    let desk = Desk::new();
    desk.run(&small(), &MockBackend::default());
    let refused = |change: fn(&mut Plan)| {
        let mut plan = small();
        change(&mut plan);
        let message = desk.refused(&plan);
        let message = message.strip_prefix("journal J: belongs to another run: ");
        let message =
            message.and_then(|m| m.strip_suffix("; repeat that run or name another file"));
        message.unwrap().to_owned()
    };
    assert_eq!(
        refused(|p| p.tolerance = 1e-6),
        "`plan.groups[0].tolerance` is 1e-9 there and 1e-6 now"
    );
    assert_eq!(
        refused(|p| p.seed = 9),
        "`plan.groups[0].seed` is 1 there and 9 now"
    );
    assert_eq!(
        refused(|p| p.reference = Reference::None),
        "`plan.groups[0].reference` is \"mmp\" there and \"none\" now"
    );
    assert_eq!(
        refused(|p| crate::plan::restrict(std::slice::from_mut(p), "1/2".parse().unwrap())),
        "`plan.shard` is null there and {\"count\":2,\"index\":1} now"
    );

    let mut newer = tool();
    newer.commit = Some("decaf".into());
    let record = crate::plan::record(&[small()], isolation());
    let error = Journal::open(&desk.path(), &JournalHeader::new(newer, record), &session());
    let message = error.unwrap_err().to_string();
    assert!(message.contains("`tool.commit` is \"c0ffee\" there and \"decaf\" now"));
}

#[test]
fn a_journal_grows_by_algorithms_models_sources_and_runs() {
    let desk = Desk::new();
    let first = MockBackend::default();
    let before = desk.run(&small(), &first);
    let mut larger = plan(&["horse", "cow", "cat"], "mmp,vtp,ich,fwp-ch", "0,1");
    larger.sampling = Sampling::Fixed(3);
    let second = MockBackend::default();
    let records = desk.run(&larger, &second);
    assert_eq!(records.cells.len(), 3 * 2 * 4);
    for cell in &before.cells {
        let same = |c: &&Cell| {
            (&c.model, &c.algorithm, &c.source) == (&cell.model, &cell.algorithm, &cell.source)
        };
        let grown = records.cells.iter().find(same).unwrap();
        assert_eq!(grown.time.samples[..2], cell.time.samples);
        // The first two rounds keep the positions of the old plan, which had three algorithms.
        assert_eq!(grown.time.places[..2], cell.time.places);
        assert_eq!(grown.time.samples.len(), 3);
        assert_eq!(grown.time.places.len(), 3);
    }
    // One run of each of the 6 old cells, three of each of the 18 new ones.
    let timed = second
        .log()
        .into_iter()
        .filter(|run| run.starts_with("time"));
    assert_eq!(timed.count(), 6 + 18 * 3);

    // The journal has all runs of both plans now.
    let text = desk.text();
    let third = MockBackend::default();
    assert_eq!(desk.run(&larger, &third).cells, records.cells);
    assert_eq!(desk.run(&small(), &third).cells, before.cells);
    assert_eq!(third.log(), [""; 0]);
    assert_eq!(desk.text().lines().count(), text.lines().count() + 2);
    assert_eq!(desk.text().matches("{\"plan\":").count(), 1);
}

#[test]
fn a_model_that_has_changed_is_refused() {
    let desk = Desk::new();
    desk.run(&small(), &MockBackend::default());
    let text = desk.text().replace("00ff", "beef");
    let cut = text.rfind("{\"run\"").unwrap();
    fs::write(desk.path(), &text[..cut]).unwrap();
    let mut journal = desk.open(&small()).unwrap();
    let error = run(
        &small(),
        &MockBackend::default(),
        Some(&mut journal),
        None,
        &mut NullListener,
        1,
    )
    .unwrap_err();
    assert_eq!(
        error.to_string(),
        "cow.obj: the model is not the one that the journal holds results of: its SHA-256 is 00ff, and was beef"
    );
}

#[test]
fn only_the_last_line_may_be_torn() {
    let desk = Desk::new();
    desk.run(&small(), &MockBackend::default());
    let text = desk.text();
    let lines: Vec<&str> = text.split_inclusive('\n').collect();
    let with = |line: usize, replacement: &str| {
        let mut lines = lines.clone();
        lines[line] = replacement;
        fs::write(desk.path(), lines.concat()).unwrap();
    };
    let refused = |line, replacement: &str| {
        with(line, replacement);
        desk.refused(&small())
    };
    let last = lines.len() - 1;
    for (line, torn) in [(6, &lines[6][..20]), (last, "{\"run\":\n"), (6, "\n")] {
        let message = refused(line, torn);
        // A line without its line break is joined with the next one.
        assert!(
            message.starts_with(&format!("journal J, line {}: not a line", line + 1)),
            "{message}"
        );
    }
    let timed = lines
        .iter()
        .position(|l| l.contains("\"time\",\"round\""))
        .unwrap();
    assert_eq!(
        refused(timed + 1, lines[timed]),
        format!(
            "journal J, line {}: the run is on an earlier line already; take the line out, or name another file",
            timed + 2
        )
    );
    for (from, to, problem) in [
        ("\"horse\"", "\"hearse\"", "no model `hearse`"),
        ("\"round\":0", "\"round\":7", "no round 7"),
        ("\"group\":null", "\"group\":\"x\"", "no group `x`"),
    ] {
        let message = refused(timed, &lines[timed].replacen(from, to, 1));
        assert!(message.contains(problem), "{message}");
    }
    // A first line alone, without its end: it is completed.
    fs::write(desk.path(), lines[0].trim_end()).unwrap();
    let mut longer = small();
    longer.sampling = Sampling::Fixed(7);
    desk.run(&longer, &MockBackend::default());
    desk.run(&longer, &MockBackend::default());
    for foreign in ["hello\n", "{}\n", "{\"schema\": 1}", "no line"] {
        fs::write(desk.path(), foreign).unwrap();
        assert_eq!(
            desk.refused(&small()),
            "journal J: not a journal of geobench; name a file that does not exist to start a new one"
        );
    }
}

#[test]
fn a_journal_is_written_by_one_process_at_a_time() {
    let desk = Desk::new();
    let first = desk.open(&small()).unwrap();
    let error = desk.open(&small()).unwrap_err();
    assert!(
        error
            .to_string()
            .ends_with(": another process is writing it"),
        "{error}"
    );
    drop(first);
    assert_eq!(desk.open(&small()).unwrap().sessions().len(), 2);
}

/// The child of a killed process holds the lock until exec. Before `open` waited for the lock, a
/// run that was resumed at once was refused about once in a hundred times.
#[test]
fn a_journal_that_is_let_go_of_soon_is_waited_for() {
    let desk = Desk::new();
    let first = desk.open(&small()).unwrap();
    let holder = thread::spawn(move || {
        thread::sleep(Duration::from_millis(50));
        drop(first);
    });
    assert_eq!(desk.open(&small()).unwrap().sessions().len(), 2);
    holder.join().unwrap();
}

#[test]
fn findings_are_read_as_they_were_written() {
    let desk = Desk::new();
    desk.run(&small(), &MockBackend::default());
    let text = desk.text();
    for line in text.lines().skip(1) {
        let read: super::JournalLine = serde_json::from_str(line).unwrap();
        assert_eq!(serde_json::to_string(&read).unwrap(), line);
    }
    assert!(Pass::Warmup < Pass::Time && Pass::Time < Pass::Count);
}
