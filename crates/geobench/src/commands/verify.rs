//! `geobench verify`.

use std::collections::BTreeSet;
use std::convert::Infallible;

use clap::Args;
use geobench_harness::exec::expected::{Expected, StoredDistances, stored_sources};
use geobench_harness::exec::goal::GoalSpec;
use geobench_harness::exec::interrupt;
use geobench_harness::exec::model::{self, ModelRef};
use geobench_harness::exec::point::PointSpec;
use geobench_harness::exec::source::SourceSpec;
use geobench_harness::exec::{Backend, Observation, Pass, Session, Step};
use geobench_harness::measure::number::{counted, scientific};
use geobench_harness::plan::suite::options::{
    AlgorithmsOption, DecompressionOption, GoalOptions, LimitOptions, SimdOption, SourceOption,
    ThreadsOption, ToleranceOption, WIDEST_SIMD_HELP, WeldOption,
};
use geobench_harness::plan::{self, suite};
use geobench_harness::run::agreement::{self, Vote};
use geobench_harness::run::answer_layout::AnswerLayout;
use geobench_harness::run::check::Deviation;
use geobench_harness::run::proof;
use geobench_harness::run::reference_check::{Answer, ReferenceCheck};
use geobench_harness::schema::{ModelRecord, Status};
use geobench_harness::usage::read_text;
use geobench_mesh::Tolerance;
use geobench_registry::{self as registry, Selection};
use geobench_window::precision;

use crate::args::{MODELS_HELP, QuietOption};
use crate::isolation::IsolationOptions;
use crate::points::{FarOption, distinct};
use crate::terminal;
use crate::verdict::Verdict;

#[derive(Args, Debug)]
#[command(
    after_help = MODELS_HELP,
    mut_arg("algorithms", |algorithms| algorithms.help(ALGORITHMS_HELP)),
    mut_arg("source", |source| source.help(SOURCES_HELP).default_value("first")),
    mut_arg("simd", |simd| simd.help(WIDEST_SIMD_HELP)),
    mut_arg("quiet", |quiet| quiet.help("Print only disagreements")),
)]
pub(crate) struct VerifyOptions {
    /// Models; without any, a built-in suite of generated ones
    #[arg(value_name = "MODEL")]
    models: Vec<String>,

    #[command(flatten)]
    algorithms: AlgorithmsOption,

    #[command(flatten)]
    source: SourceOption,

    #[command(flatten)]
    far: FarOption,

    #[command(flatten)]
    goal: GoalOptions,

    #[command(flatten)]
    tolerance: ToleranceOption,

    #[command(flatten)]
    threads: ThreadsOption,

    #[command(flatten)]
    simd: SimdOption,

    /// Where answers disagree, prove which are right also on models of more than 50,000 faces
    #[arg(long)]
    certify: bool,

    #[command(flatten)]
    isolation: IsolationOptions,

    #[command(flatten)]
    limits: LimitOptions,

    #[command(flatten)]
    decompression: DecompressionOption,

    #[command(flatten)]
    weld: WeldOption,

    #[command(flatten)]
    quiet: QuietOption,
}

const ALGORITHMS_HELP: &str = "Algorithms by name, by family, or exact, or all; separated by commas \
    [default: exact, without ch where it would take hours]";

const SOURCES_HELP: &str = "Sources: first, largest (the first vertex of the largest component), a \
    vertex number, random:N[,seed=S], all, edge:A-B,T, face:F,U,V,W, at:X,Y,Z or a list of these; may \
    be repeated. Vertices for which distances are stored (MODEL.sSOURCE.csv) are added";

/// The reference algorithm. It runs even if it is not selected.
const REFERENCE: &str = "mmp-fast";

pub(crate) fn verify(options: &VerifyOptions) -> anyhow::Result<Verdict> {
    let models = if options.models.is_empty() {
        model::collect(suite::SMALL_MODELS)?
    } else {
        model::collect(&options.models)?
    };
    let weld = options.weld.vertices();
    let models = models.into_iter().map(|model| model.welded(weld));
    let models: Vec<ModelRef> = models.collect();
    let mut algorithms = match &options.algorithms.algorithms {
        Some(named) => named.0.clone(),
        None => registry::select("exact")?,
    };
    // The reference runs first, because the others are compared with it.
    let reference = registry::select_one(REFERENCE)?;
    algorithms.retain(|a| a.label() != REFERENCE);
    algorithms.insert(0, reference);

    let programs = options.isolation.programs()?;
    let found = algorithms.iter().map(|a| a.find_programs(&programs));
    let found = found.collect::<Result<Vec<_>, _>>()?;
    let found = found.into_iter().flatten();
    let algorithms: Vec<Selection> = found
        .map(|algorithm| algorithm.with_threads(options.threads.number()))
        .map(|algorithm| algorithm.with_simd(options.simd.simd.unwrap_or_default()))
        .collect();
    options.isolation.check(1, &options.limits)?;
    let (mut source, mut goal) = (options.source.clone(), options.goal.clone());
    source.read_sources(read_text)?;
    goal.target.read_targets(read_text)?;
    options.far.apply(&mut source, &mut goal);
    let goal = goal.spec();
    let (algorithms, note) = plan::able_to_end_early(algorithms, &goal)?;
    if let Some(note) = note.filter(|_| !options.quiet.is_set) {
        terminal::print(&format!("{note}\n"))?;
    }
    let crowding = options.isolation.crowding(&algorithms, 1);
    if let Some(crowding) = crowding.filter(|_| !options.quiet.is_set) {
        terminal::warning(&crowding);
    }
    let limits = options.limits.with(&options.decompression);
    let backend = options.isolation.backend(limits, true)?;
    options.isolation.listen()?;
    let mut tally = VerifyTally::default();
    let sources = distinct(source.source.iter().flatten());
    for model in &models {
        if interrupt::requested() {
            break;
        }
        match backend.open(model) {
            Ok(mut session) => LoadedModelCheck {
                options,
                algorithms: &algorithms,
                sources: &sources,
                goal: &goal,
                model,
                record: &session.model().clone(),
            }
            .verify(&mut *session, &mut tally)?,
            Err(_) if interrupt::requested() => {}
            Err(refusal) => {
                terminal::error(&refusal.message);
                tally.bad_input = true;
            }
        }
    }
    if !options.quiet.is_set || tally.has_failed() {
        terminal::print(&format!("{}\n", tally.text()))?;
    }
    if interrupt::requested() {
        terminal::interrupted("interrupted");
        return Ok(Verdict::Interrupted);
    }
    Ok(match tally.has_failed() {
        true => Verdict::Failed,
        false if tally.bad_input => Verdict::BadInput,
        false => Verdict::Passed,
    })
}

/// Counts over all models, sources and algorithms.
#[derive(Default)]
struct VerifyTally {
    answers: usize,
    wrong: usize,
    /// Algorithms without an answer, and answers without a reference.
    failed: usize,
    /// Answers that differ from others by no more than is in doubt.
    undecided: usize,
    /// Right answers in doubt.
    doubtful: usize,
    /// Whether a model, a source or a file of stored distances could not be used.
    bad_input: bool,
}

impl VerifyTally {
    fn count(&mut self, verdict: &AnswerVerdict) {
        self.answers += usize::from(verdict.word != Word::Failed);
        match verdict.word {
            Word::Failed => self.failed += 1,
            Word::Wrong => self.wrong += 1,
            Word::InDoubt => self.undecided += 1,
            Word::Ok => self.doubtful += usize::from(verdict.doubt.is_some()),
        }
    }

    /// Whether answers disagree or are missing.
    const fn has_failed(&self) -> bool {
        self.wrong > 0 || self.undecided > 0 || self.failed > 0
    }

    fn text(&self) -> String {
        let Self { answers, wrong, .. } = self;
        let agreeing = answers - wrong - self.undecided;
        let doubtful = match self.doubtful {
            0 => String::new(),
            some => format!(", {some} of them in doubt"),
        };
        let undecided = match self.undecided {
            0 => String::new(),
            some => format!("; {some} in doubt differ"),
        };
        let failed = match self.failed {
            0 => String::new(),
            some => format!("; {some} failed"),
        };
        format!("{agreeing} of {answers} answers agree{doubtful}{undecided}{failed}")
    }
}

/// The check of all algorithms on one loaded model.
struct LoadedModelCheck<'a> {
    options: &'a VerifyOptions,
    algorithms: &'a [Selection],
    sources: &'a SourceSpec,
    goal: &'a GoalSpec,
    model: &'a ModelRef,
    record: &'a ModelRecord,
}

impl LoadedModelCheck<'_> {
    /// Checks the model from the requested sources, and from those with stored distances.
    fn verify(&self, session: &mut dyn Session, tally: &mut VerifyTally) -> anyhow::Result<()> {
        let vertices = self.record.vertex_count();
        if !self.options.quiet.is_set {
            terminal::notes_on(&self.record.name, &self.record.notes);
        }
        let sources = (self.sources).with_largest(|| self.record.first_of_largest());
        let mut sources = match sources.points(vertices) {
            Ok(sources) => sources,
            Err(error) => {
                terminal::error(&format!("{}: {error}", self.model.path));
                tally.bad_input = true;
                return Ok(());
            }
        };
        let path = self.model.file_path();
        let stored = path.map_or_else(Vec::new, |path| stored_sources(path, self.record.weld));
        for source in stored.into_iter().map(PointSpec::Vertex) {
            if !sources.contains(&source) {
                sources.push(source);
            }
        }
        for source in sources {
            self.verify_source(source, session, tally)?;
        }
        Ok(())
    }

    /// Why `algorithm` is left out: it is not named, and the model has more faces than it solves in
    /// about a minute, or junctions that it does not cross.
    fn why_left_out(&self, algorithm: &Selection) -> Option<&'static str> {
        let faces = self.record.faces.unwrap_or(0);
        let comfortable = algorithm.algorithm().comfortable_faces;
        let has_junctions = self.record.junctions.is_some();
        if !algorithm.is_optional() {
            None
        } else if comfortable.is_some_and(|most| faces > most) {
            Some("the model has too many faces for it; name it with --algo to run it")
        } else {
            (has_junctions && !algorithm.crosses_junctions()).then_some(
                "it crosses no edges with more than two faces and no surface that cannot be \
                 oriented",
            )
        }
    }

    /// The distances from `source` that are stored beside the model; `None` if there are none, or
    /// if they cannot be read, which is reported.
    fn stored(
        &self,
        source: PointSpec,
        vertices: usize,
        tally: &mut VerifyTally,
    ) -> Option<StoredDistances> {
        let PointSpec::Vertex(vertex) = source else {
            return None;
        };
        match self.model.file_path() {
            Some(path) if stored_sources(path, self.record.weld).contains(&vertex) => {
                let weld = self.record.weld;
                match Expected::BesideModels.find(path, weld, &vertex.into(), vertices) {
                    Ok(field) => Some(field),
                    Err(error) => {
                        terminal::error(&error.to_string());
                        tally.bad_input = true;
                        None
                    }
                }
            }
            _ => None,
        }
    }

    /// Prints that an algorithm was skipped, for the reason `why`.
    fn tell_left_out(
        &self,
        algorithm: &Selection,
        source: PointSpec,
        why: &str,
    ) -> anyhow::Result<()> {
        if self.options.quiet.is_set {
            return Ok(());
        }
        terminal::print(&format!(
            "{}: source {source}: {}: left out, {why}\n",
            self.record.name,
            algorithm.label()
        ))
    }

    /// Prints the judgement of an answer.
    fn tell_judgement(
        &self,
        name: &str,
        source: PointSpec,
        verdict: &AnswerVerdict,
    ) -> anyhow::Result<()> {
        if self.options.quiet.is_set && verdict.word == Word::Ok {
            return Ok(());
        }
        let model = &self.record.name;
        let text = verdict.text();
        terminal::print(&format!("{model}: source {source}: {name}: {text}\n"))
    }

    /// Runs all algorithms from `source` and prints one line for each. If answers disagree, prints
    /// which of them agree, and which are proven right.
    fn verify_source(
        &self,
        source: PointSpec,
        session: &mut dyn Session,
        tally: &mut VerifyTally,
    ) -> anyhow::Result<()> {
        let vertices = self.record.vertex_count();
        let layout = AnswerLayout::new(self.goal, vertices);
        let mut state = SourceState {
            count: layout.count(vertices),
            stored: self.stored(source, vertices, tally),
            checks: ReferenceCheck::new(layout),
            spec: SourceSpec::from(source),
            doubt: None,
        };
        let mut votes = Vec::new();
        let mut answers: Vec<JudgedAnswer> = Vec::new();
        for algorithm in self.algorithms {
            if interrupt::requested() {
                break;
            }
            if let Some(why) = self.why_left_out(algorithm) {
                self.tell_left_out(algorithm, source, why)?;
                continue;
            }
            let is_reference = algorithm.label() == REFERENCE;
            let mut verdict = AnswerVerdict::default();
            let done = session.execute(&self.step(algorithm, &state.spec));
            if interrupt::requested() {
                break;
            }
            // The model lacks the source or a target.
            if let Err(failure) = &done
                && failure.status == Status::Refused
                && is_reference
            {
                terminal::error(&format!("{}: {}", self.record.name, failure.message));
                tally.bad_input = true;
                return Ok(());
            }
            let mut cluster = None;
            match done {
                Err(failure) => {
                    verdict.failed(&failure.message);
                    if is_reference {
                        state.checks.unchecked = Some(failure.message);
                    }
                }
                Ok(observation) => {
                    let vote =
                        self.judge(algorithm, observation, &mut verdict, &mut state, session);
                    if !algorithm.is_approximate() {
                        cluster = Some(vote.cluster);
                        votes.push(vote);
                    }
                }
            }
            // From the first disagreement on, lines wait for a proof.
            let all_agree = answers.iter().all(|answer| answer.shown.is_some());
            let shown = (all_agree && verdict.word == Word::Ok).then_some(Word::Ok);
            if shown.is_some() {
                self.tell_judgement(algorithm.label(), source, &verdict)?;
            }
            answers.push(JudgedAnswer {
                name: algorithm.label().to_owned(),
                cluster,
                verdict,
                shown,
            });
        }
        if let Some(field) = &state.stored
            && (state.checks.answer.as_ref()).is_some_and(|answer| answer.vertices == state.count)
        {
            votes.push(self.vote_of(field, &state.checks));
        }
        let summary = agreement::summary(&votes).filter(|_| !interrupt::requested());
        let decision = summary.as_ref().map(|_| {
            self.decide(
                session,
                &state,
                &mut answers,
                votes.iter().find(|vote| vote.is_file),
            )
        });
        for answer in &answers {
            tally.count(&answer.verdict);
            if answer.shown != Some(answer.verdict.word) {
                self.tell_judgement(&answer.name, source, &answer.verdict)?;
            }
        }
        for text in summary.into_iter().chain(decision) {
            terminal::print(&format!("{}: source {source}: {text}\n", self.record.name))?;
        }
        Ok(())
    }

    /// Judges an answer by the reference and by stored distances. Returns its vote.
    fn judge(
        &self,
        algorithm: &Selection,
        observation: Observation,
        verdict: &mut AnswerVerdict,
        state: &mut SourceState,
        session: &mut dyn Session,
    ) -> Vote {
        let is_reference = algorithm.label() == REFERENCE;
        let checks = &mut state.checks;
        let found = observation.distances;
        // The note is about the position of the source. One line with it is enough.
        if let Some(note) = observation
            .note
            .filter(|_| is_reference && !self.options.quiet.is_set)
        {
            terminal::notes_on(&self.record.name, &[note]);
        }
        let tolerance = algorithm.tolerance(self.options.tolerance.number());
        verdict.may_differ = algorithm.may_differ();
        verdict.find_doubt(self.record.longest_edge, &found);
        let mut vote = Vote::of_reference(algorithm.label(), false);
        if is_reference {
            checks.answer = Some(Answer::of(REFERENCE, &found));
            state.doubt = verdict.doubt;
        } else if checks.answer.is_none() {
            verdict.failed("the reference failed, so there is nothing to agree with");
            vote.cluster = checks.cluster_of_differing(&found, tolerance);
        } else {
            if !verdict.may_differ {
                let step = self.step(&self.algorithms[0], &state.spec);
                checks.find_scale(&found, tolerance, session, &step);
            }
            let agrees = match checks.deviation(&found, tolerance, verdict.may_differ) {
                Ok(comparison) => {
                    verdict.judge(REFERENCE, &comparison, &checks.layout, state.doubt);
                    vote.compared(&comparison);
                    comparison.agrees()
                }
                Err(error) => {
                    verdict.wrong(&error.to_string());
                    false
                }
            };
            if !agrees && !algorithm.is_approximate() {
                vote.cluster = checks.cluster_of_differing(&found, tolerance);
            }
        }
        if let Some(field) = state.stored.as_ref().filter(|_| found.len() == state.count) {
            verdict.judge_by_stored(field, &found, &checks.layout, tolerance);
        }
        if is_reference {
            let unreachable = found.iter().filter(|d| d.is_infinite()).count();
            let count = found.len();
            let places = counted(count, checks.layout.noun());
            let remark = format!("reference for {places}, {unreachable} unreachable");
            verdict.remarks.push(remark);
            let components = self.record.components.unwrap_or(1);
            if components > 1 && self.goal.is_everything() && !self.options.quiet.is_set {
                let (source, connected) = (&state.spec, count - unreachable);
                let note = format!(
                    "source {source} is in a component of {connected} of {count} vertices; \
                     {components} components"
                );
                terminal::notes_on(&self.record.name, &[note]);
            }
        }
        vote
    }

    fn step<'s>(&'s self, algorithm: &'s Selection, source: &'s SourceSpec) -> Step<'s> {
        Step {
            model: &self.record.name,
            algorithm,
            source,
            goal: self.goal,
            pass: Pass::Warmup,
            solves: 1,
        }
    }

    /// Decides by a proof which answers are right, revises their judgements, and describes the
    /// decision. A file of stored distances is added to the answers if it is wrong.
    fn decide(
        &self,
        session: &mut dyn Session,
        state: &SourceState,
        answers: &mut Vec<JudgedAnswer>,
        file: Option<&Vote>,
    ) -> String {
        let checks = &state.checks;
        if let Some(why) = proof::too_large(self.record.faces).filter(|_| !self.options.certify) {
            return proof::nothing_proven(&format!("{why}; --certify proves which are right"));
        }
        let tolerance = self.options.tolerance.number();
        let Ok(found) = Answer::proven::<Infallible>(tolerance, |algorithm| {
            Ok(session.execute(&self.step(algorithm, &state.spec)))
        });
        let answer = match found {
            Ok(answer) => answer,
            Err(why) => return proof::nothing_proven(&why),
        };
        let distances: Vec<f64> = answer.distances.iter().map(|&(_, d)| d).collect();
        let bounds = answer.bounds.clone();
        let [_, greatest] = registry::proven_bounds();
        let certificate = match &bounds {
            Some(_) => greatest,
            None => registry::certificate(tolerance),
        };
        let step = self.step(&certificate, &state.spec);
        let mut proven = ReferenceCheck::new(checks.layout.clone());
        proven.answer = Some(answer);
        let against = match &bounds {
            Some(_) => proof::BOUNDS,
            None => "proven distances",
        };
        let mut judge = |found: &[f64], verdict: &mut AnswerVerdict| {
            proven.find_scale(found, tolerance, session, &step);
            match proven.deviation(found, tolerance, false) {
                Ok(comparison) => verdict.decide(against, &comparison, &proven.layout),
                Err(error) => verdict.wrong(&error.to_string()),
            }
        };
        for answer in answers.iter_mut() {
            if let Some(found) = answer.cluster.and_then(|cluster| checks.first(cluster)) {
                judge(&found, &mut answer.verdict);
            }
        }
        let mut right: Vec<String> = answers
            .iter()
            .filter(|answer| answer.cluster.is_some() && answer.verdict.word == Word::Ok)
            .map(|answer| answer.name.clone())
            .collect();
        if let Some(field) = state
            .stored
            .as_ref()
            .filter(|_| distances.len() == state.count)
        {
            let mut found = distances.clone();
            for (place, distance) in checks.layout.of_stored(&field.distances) {
                found[place] = distance;
            }
            let name = field.path.display().to_string();
            let mut verdict = AnswerVerdict::default();
            judge(&found, &mut verdict);
            if verdict.word == Word::Ok {
                right.push(name);
            } else {
                answers.push(JudgedAnswer {
                    name,
                    cluster: None,
                    verdict,
                    shown: None,
                });
            }
        }
        let Some(bounds) = bounds else {
            return agreement::proven_right(right.iter().map(String::as_str));
        };
        let of_file = file.filter(|vote| right.contains(&vote.name));
        let groups = left_groups(answers, of_file.map(|vote| vote.cluster));
        let is_wrong = |answer: &&JudgedAnswer| answer.verdict.word == Word::Wrong;
        let wrong: Vec<String> = answers
            .iter()
            .filter(is_wrong)
            .map(|a| a.name.clone())
            .collect();
        for answer in answers
            .iter_mut()
            .filter(|answer| answer.verdict.word == Word::Ok)
        {
            if let Some(cluster) = answer.cluster {
                answer
                    .verdict
                    .not_refuted(groups.len() == 1 || cluster == agreement::REFERENCE);
            }
        }
        let [wrong, left] =
            [&wrong, &right].map(|names| names.iter().map(String::as_str).collect::<Vec<_>>());
        let what = agreement::within_bounds(&wrong, &left, groups.len());
        format!("{}; {what}", proof::nothing_proven(&bounds.why))
    }

    /// Stored distances of a file as a vote. They may lack some vertices, so they join the first
    /// cluster that agrees at the vertices that they have.
    fn vote_of(&self, field: &StoredDistances, checks: &ReferenceCheck) -> Vote {
        let rule = rule_of(field, self.options.tolerance.number());
        let expected = checks.layout.of_stored(&field.distances);
        let compare = |answer: &[f64]| {
            let stored = expected.iter().copied();
            checks.layout.compare(answer, stored, &rule, false)
        };
        let reference = checks.first(agreement::REFERENCE).unwrap_or_default();
        let mut vote = Vote::of_reference(&field.path.display().to_string(), true);
        let comparison = compare(&reference);
        if !comparison.agrees() {
            vote.compared(&comparison);
            let has_all = |answer: &[f64]| answer.len() == reference.len();
            let agrees = |answer: &[f64]| has_all(answer) && compare(answer).agrees();
            let found = checks.clusters.find(agrees);
            vote.cluster = found.unwrap_or_else(|| checks.clusters.next());
        }
        vote
    }
}

/// The stored distances, checks and doubt of the answers for one source.
struct SourceState {
    spec: SourceSpec,
    /// Number of distances of an answer.
    count: usize,
    stored: Option<StoredDistances>,
    checks: ReferenceCheck,
    /// The doubt of the reference.
    doubt: Option<f64>,
}

/// The groups of exact answers that are not wrong, with that of a file.
fn left_groups(answers: &[JudgedAnswer], of_file: Option<u32>) -> BTreeSet<u32> {
    let left = answers
        .iter()
        .filter(|answer| answer.verdict.word == Word::Ok);
    left.filter_map(|answer| answer.cluster)
        .chain(of_file)
        .collect()
}

/// The rule for comparisons with stored distances from one source.
fn rule_of(field: &StoredDistances, tolerance: f64) -> Tolerance {
    let distances: Vec<f64> = field.distances.iter().map(|&(_, d)| d).collect();
    Tolerance::of(&distances).with_relative(tolerance)
}

/// An answer and its judgement.
struct JudgedAnswer {
    /// Name of the algorithm or path of the file.
    name: String,
    /// The cluster of an exact answer.
    cluster: Option<u32>,
    verdict: AnswerVerdict,
    /// The word in its last line.
    shown: Option<Word>,
}

/// A judgement in a word.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
enum Word {
    #[default]
    Ok,
    /// It differs, by no more than is in doubt.
    InDoubt,
    Wrong,
    /// There is no answer, or nothing to compare it with.
    Failed,
}

/// The verdict on one answer.
#[derive(Default)]
struct AnswerVerdict {
    word: Word,
    /// Whether the answer may differ by any finite amount.
    may_differ: bool,
    /// Bound of its rounding errors, if edges are too long for its distances.
    doubt: Option<f64>,
    remarks: Vec<String>,
}

impl AnswerVerdict {
    /// Marks the answer as wrong, for the reason `why`.
    fn wrong(&mut self, why: &str) {
        self.word = Word::Wrong;
        self.remarks.push(why.to_owned());
    }

    /// Says why there is nothing to judge.
    fn failed(&mut self, why: &str) {
        self.word = Word::Failed;
        self.remarks.push(why.to_owned());
    }

    /// Finds out whether the answer is in doubt on a model whose longest edge has this length.
    fn find_doubt(&mut self, longest_edge: Option<f64>, distances: &[f64]) {
        self.doubt = longest_edge.and_then(|longest| precision::doubtful_by(longest, distances));
        self.remarks.extend(self.doubt.map(|doubt| {
            format!(
                "in doubt, each distance may be off by up to {}",
                scientific(doubt)
            )
        }));
    }

    /// Compares an answer with the stored distances of a file, which may lack some vertices.
    fn judge_by_stored(
        &mut self,
        field: &StoredDistances,
        found: &[f64],
        layout: &AnswerLayout,
        tolerance: f64,
    ) {
        let expected = layout.of_stored(&field.distances);
        let rule = rule_of(field, tolerance);
        let comparison = layout.compare(found, expected, &rule, self.may_differ);
        let mut name = field.path.display().to_string();
        if comparison.compared < found.len() {
            let places = counted(found.len(), layout.noun());
            name = format!("{name} at {} of {places}", comparison.compared);
        }
        self.judge(&name, &comparison, layout, None);
    }

    /// Adds a remark on the comparison with `reference`, and marks a disagreement as wrong, or as
    /// in doubt if it is within the doubt of the answer or of the reference.
    fn judge(
        &mut self,
        reference: &str,
        comparison: &Deviation,
        layout: &AnswerLayout,
        doubt_of_reference: Option<f64>,
    ) {
        let Some(worst) = &comparison.worst else {
            self.remarks.push(format!(
                "agrees with {reference}, largest relative difference {}",
                scientific(comparison.max_rel)
            ));
            return;
        };
        if self.may_differ && comparison.max_rel.is_finite() {
            self.remarks.push(format!(
                "approximate: {reference} differs by up to {} relative",
                scientific(comparison.max_rel)
            ));
            return;
        }
        let doubt = f64::max(self.doubt.unwrap_or(0.0), doubt_of_reference.unwrap_or(0.0));
        if comparison.excess > doubt {
            self.word = Word::Wrong;
        } else if self.word == Word::Ok {
            self.word = Word::InDoubt;
        }
        self.remarks.push(format!(
            "differs from {reference}: {}; {} of {} differ",
            layout.describe(worst),
            comparison.disagreeing,
            counted(comparison.compared, layout.noun())
        ));
    }

    /// Replaces the judgement by that of a comparison with proven distances.
    fn decide(&mut self, against: &str, comparison: &Deviation, layout: &AnswerLayout) {
        self.word = Word::Ok;
        let mut remarks = std::mem::take(&mut self.remarks);
        if !comparison.agrees() {
            self.judge(against, comparison, layout, None);
        } else if against != proof::BOUNDS {
            self.remarks.push("proven right".to_owned());
        }
        self.remarks.append(&mut remarks);
    }

    /// Judges an answer within proven bounds. `is_left` if it is in the single group within them,
    /// or agrees with the reference.
    fn not_refuted(&mut self, is_left: bool) {
        if !is_left {
            self.word = Word::InDoubt;
        }
        self.remarks.insert(0, "not refuted".to_owned());
    }

    /// The verdict with its remarks.
    fn text(&self) -> String {
        let word = match self.word {
            Word::Ok => "ok",
            Word::InDoubt => "IN DOUBT",
            Word::Wrong => "WRONG",
            Word::Failed => "FAILED",
        };
        format!("{word}: {}", self.remarks.join("; "))
    }
}
