//! `geobench verify`.

use anyhow::Context;
use clap::Args;
use geobench_harness::exec::expected::{Expected, StoredDistances, stored_sources};
use geobench_harness::exec::goal::GoalSpec;
use geobench_harness::exec::interrupt;
use geobench_harness::exec::model::{self, ModelRef};
use geobench_harness::exec::source::{PointSpec, SourceSpec};
use geobench_harness::exec::{Backend, Pass, Session, Step};
use geobench_harness::measure::number::scientific;
use geobench_harness::plan::{self, suite};
use geobench_harness::run::agreement::{self, Clusters, Vote};
use geobench_harness::run::answer_layout::AnswerLayout;
use geobench_harness::run::check::{self, Deviation};
use geobench_harness::schema::{ModelRecord, Status};
use geobench_registry::{self as registry, Selection, SimdChoice};

use crate::args::{Algorithms, MODELS_HELP, algorithms, threads, tolerance};
use crate::isolation::IsolationOptions;
use crate::points::GoalOptions;
use crate::terminal;
use crate::verdict::Verdict;

#[derive(Args, Debug)]
#[command(after_help = MODELS_HELP)]
pub(crate) struct VerifyOptions {
    /// Models; without any, a built-in suite of generated ones
    #[arg(value_name = "MODEL")]
    models: Vec<String>,

    /// Algorithms by name, by family, or exact, or all; separated by commas [default: exact,
    /// without ch where it would take hours]
    #[arg(long, value_name = "LIST", value_parser = algorithms)]
    algo: Option<Algorithms>,

    /// Sources: first, a vertex number, random:N[,seed=S], all, edge:A-B,T, face:F,U,V,W, at:X,Y,Z
    /// or a list of these; may be repeated. Vertices for which distances are stored
    /// (MODEL.sSOURCE.csv) are added
    #[arg(
        long,
        value_name = "SRC",
        default_value = "first",
        allow_negative_numbers = true
    )]
    source: Vec<SourceSpec>,

    #[command(flatten)]
    goal: GoalOptions,

    /// Largest relative difference that passes
    #[arg(long, value_name = "T", allow_negative_numbers = true, default_value_t = 1e-9, value_parser = tolerance)]
    tolerance: f64,

    /// Threads of the parallel algorithms (pvtp, pch), of the set-up of svg, and of outside programs
    /// whose command has {threads}
    #[arg(long, value_name = "N", allow_negative_numbers = true, default_value_t = 1, value_parser = threads())]
    threads: u32,

    /// Instructions of every algorithm: auto (the widest of the processor), scalar, avx2 or avx512;
    /// narrower ones where the processor lacks them. Distances and counts do not depend on it
    #[arg(long, value_name = "SIMD", default_value_t)]
    simd: SimdChoice,

    /// Where answers disagree, prove which are right, as `geobench certify` does
    #[arg(long)]
    certify: bool,

    #[command(flatten)]
    isolation: IsolationOptions,

    /// Print only disagreements
    #[arg(long)]
    quiet: bool,
}

/// The reference algorithm. It runs even if it is not selected.
const REFERENCE: &str = "mmp-fast";

/// The algorithm that returns only distances that it has proven.
const CERTIFICATE: &str = "certificate";

pub(crate) fn verify(options: &VerifyOptions) -> anyhow::Result<Verdict> {
    let models = if options.models.is_empty() {
        model::collect(suite::SMALL_MODELS)?
    } else {
        model::collect(&options.models)?
    };
    let mut algorithms = match &options.algo {
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
        .map(|algorithm| algorithm.with_threads(options.threads as usize))
        .map(|algorithm| algorithm.with_simd(options.simd))
        .collect();
    options.isolation.check(1)?;
    let goal = options.goal.goal()?;
    let algorithms = if goal.is_everything() {
        algorithms
    } else {
        able_to_end_early(algorithms, options)?
    };
    let crowding = options.isolation.crowding(&algorithms, 1);
    if let Some(crowding) = crowding.filter(|_| !options.quiet) {
        terminal::warning(&crowding);
    }
    let limits = options.isolation.limits();
    let backend = options.isolation.backend(limits, true)?;
    interrupt::listen().context("cannot listen to signals")?;
    let mut tally = VerifyTally::default();
    for model in &models {
        if interrupt::requested() {
            break;
        }
        match backend.open(model) {
            Ok(mut session) => LoadedModelCheck {
                options,
                algorithms: &algorithms,
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
    if !options.quiet || tally.wrong > 0 {
        terminal::print(&format!(
            "{} of {} answers agree\n",
            tally.answers - tally.wrong,
            tally.answers
        ))?;
    }
    if interrupt::requested() {
        terminal::error("interrupted");
        return Ok(Verdict::Interrupted);
    }
    Ok(match tally {
        VerifyTally { wrong: 1.., .. } => Verdict::Failed,
        VerifyTally {
            bad_input: true, ..
        } => Verdict::BadInput,
        _ => Verdict::Passed,
    })
}

/// Removes the algorithms that cannot end early, and prints which.
///
/// # Errors
///
/// If the user has named such an algorithm.
fn able_to_end_early(
    mut algorithms: Vec<Selection>,
    options: &VerifyOptions,
) -> anyhow::Result<Vec<Selection>> {
    if options.algo.is_some() {
        plan::check_ends_early(&algorithms)?;
    }
    let left_out = algorithms.extract_if(.., |one| !one.ends_early());
    let names: Vec<String> = left_out.map(|one| one.label().to_owned()).collect();
    if !names.is_empty() && !options.quiet {
        terminal::print(&format!(
            "left out, because they cannot end early: {}\n",
            names.join(", ")
        ))?;
    }
    Ok(algorithms)
}

/// Counts over all models, sources and algorithms.
#[derive(Default)]
struct VerifyTally {
    answers: usize,
    wrong: usize,
    /// Whether a model, a source or a file of stored distances could not be used.
    bad_input: bool,
}

/// The check of all algorithms on one loaded model.
struct LoadedModelCheck<'a> {
    options: &'a VerifyOptions,
    algorithms: &'a [Selection],
    goal: &'a GoalSpec,
    model: &'a ModelRef,
    record: &'a ModelRecord,
}

impl LoadedModelCheck<'_> {
    /// Checks the model from the requested sources, and from those with stored distances.
    fn verify(&self, session: &mut dyn Session, tally: &mut VerifyTally) -> anyhow::Result<()> {
        let vertices = self.record.vertex_count();
        let sources = SourceSpec::of_all(self.options.source.iter().cloned());
        let mut sources = match sources.and_then(|sources| sources.points(vertices)) {
            Ok(sources) => sources,
            Err(error) => {
                terminal::error(&format!("{}: {error}", self.model.path));
                tally.bad_input = true;
                return Ok(());
            }
        };
        let stored = self.model.file_path().map_or_else(Vec::new, stored_sources);
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

    /// Whether to skip `algorithm`: it was not selected with `--algo`, and the model has more faces
    /// than it solves in about a minute.
    fn is_too_slow(&self, algorithm: &Selection) -> bool {
        let faces = self.record.faces.unwrap_or(0);
        let comfortable = algorithm.algorithm().comfortable_faces;
        self.options.algo.is_none() && comfortable.is_some_and(|most| faces > most)
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
            Some(path) if stored_sources(path).contains(&vertex) => {
                match Expected::BesideModels.find(path, &vertex.into(), vertices) {
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

    /// Prints that an algorithm was skipped because the model is too large.
    fn tell_left_out(&self, algorithm: &Selection, source: PointSpec) -> anyhow::Result<()> {
        if self.options.quiet {
            return Ok(());
        }
        terminal::print(&format!(
            "{}: source {source}: {}: left out, the model has too many faces for it; name it with --algo to run it\n",
            self.record.name,
            algorithm.label()
        ))
    }

    /// Counts the judgement of an algorithm's answer and prints it.
    fn tell_judgement(
        &self,
        algorithm: &Selection,
        source: PointSpec,
        verdict: &Judgement,
        tally: &mut VerifyTally,
    ) -> anyhow::Result<()> {
        tally.answers += 1;
        tally.wrong += usize::from(verdict.wrong);
        if self.options.quiet && !verdict.wrong {
            return Ok(());
        }
        terminal::print(&format!(
            "{}: source {source}: {}: {}\n",
            self.record.name,
            algorithm.label(),
            verdict.text()
        ))
    }

    /// Runs all algorithms from `source` and prints one line for each. If answers disagree, prints
    /// which of them agree.
    fn verify_source(
        &self,
        source: PointSpec,
        session: &mut dyn Session,
        tally: &mut VerifyTally,
    ) -> anyhow::Result<()> {
        let vertices = self.record.vertex_count();
        let stored = self.stored(source, vertices, tally);
        let layout = AnswerLayout::new(self.goal, vertices);
        let count = layout.count(vertices);
        let spec = SourceSpec::from(source);
        let mut reference: Option<Vec<f64>> = None;
        let mut clusters = Clusters::default();
        let mut votes = Vec::new();
        for algorithm in self.algorithms {
            if interrupt::requested() {
                return Ok(());
            }
            if self.is_too_slow(algorithm) {
                self.tell_left_out(algorithm, source)?;
                continue;
            }
            let mut verdict = Judgement::default();
            let step = Step {
                model: &self.record.name,
                algorithm,
                source: &spec,
                goal: self.goal,
                pass: Pass::Warmup,
                solves: 1,
            };
            let done = session.execute(&step);
            if interrupt::requested() {
                return Ok(());
            }
            // The model lacks the source or a target.
            if let Err(failure) = &done
                && failure.status == Status::Refused
                && algorithm.label() == REFERENCE
            {
                terminal::error(&format!("{}: {}", self.record.name, failure.message));
                tally.bad_input = true;
                return Ok(());
            }
            match done {
                Err(failure) => verdict.wrong(&failure.message),
                Ok(observation) => {
                    let found = observation.distances;
                    // The note is about the position of the source. One line with it is enough.
                    verdict
                        .remarks
                        .extend(observation.note.filter(|_| reference.is_none()));
                    let tolerance = algorithm.tolerance(self.options.tolerance);
                    verdict.may_differ = algorithm.may_differ();
                    let mut vote = Vote::of_reference(algorithm.label(), false);
                    let mut agrees = algorithm.label() == REFERENCE;
                    if let Some(reference) = &reference {
                        match check::check_length(&found, reference.len()) {
                            Ok(()) => {
                                let expected = reference.iter().copied().enumerate();
                                let may_differ = verdict.may_differ;
                                let comparison =
                                    layout.compare(&found, expected, tolerance, may_differ);
                                verdict.judge(REFERENCE, &comparison, &layout);
                                vote.compared(&comparison);
                                agrees = comparison.agrees();
                            }
                            Err(error) => verdict.wrong(&error.to_string()),
                        }
                    }
                    if !algorithm.is_approximate() {
                        if !agrees {
                            vote.cluster = clusters.assign(&found, tolerance, &layout);
                        }
                        votes.push(vote);
                    }
                    if let Some(field) = stored.as_ref().filter(|_| found.len() == count) {
                        verdict.judge_by_stored(field, &found, &layout, tolerance);
                    }
                    if algorithm.label() == REFERENCE {
                        reference = Some(found);
                    } else if reference.is_none() {
                        verdict.wrong("the reference failed, so there is nothing to agree with");
                    }
                }
            }
            self.tell_judgement(algorithm, source, &verdict, tally)?;
        }
        if let (Some(reference), Some(field)) = (&reference, &stored)
            && reference.len() == count
        {
            let name = field.path.display().to_string();
            let expected = layout.of_stored(&field.distances);
            votes.push(self.vote_of(&name, &expected, reference, &clusters, &layout));
        }
        if let Some(summary) = agreement::summary(&votes) {
            let name = &self.record.name;
            let verdict = match (&reference, self.options.certify) {
                (Some(reference), true) => {
                    self.prove(&spec, session, reference, &clusters, &votes, &layout)
                }
                _ => "--certify proves which are right".to_owned(),
            };
            terminal::print(&format!("{name}: source {source}: {summary}\n"))?;
            terminal::print(&format!("{name}: source {source}: {verdict}\n"))?;
        }
        Ok(())
    }

    /// Computes proven distances with [`CERTIFICATE`] and describes which answers agree with them.
    fn prove(
        &self,
        source: &SourceSpec,
        session: &mut dyn Session,
        reference: &[f64],
        clusters: &Clusters,
        votes: &[Vote],
        layout: &AnswerLayout,
    ) -> String {
        let certificate = match registry::select_one(CERTIFICATE) {
            Ok(certificate) => certificate,
            Err(error) => return error.to_string(),
        };
        let found = session.execute(&Step {
            model: &self.record.name,
            algorithm: &certificate,
            source,
            goal: self.goal,
            pass: Pass::Warmup,
            solves: 1,
        });
        let proven = match found {
            Ok(observation) => observation.distances,
            Err(failure) => return format!("nothing is proven: {}", failure.message),
        };
        let agrees = |answer: &[f64]| layout.agrees(answer, &proven, self.options.tolerance);
        let right = if agrees(reference) {
            Some(agreement::REFERENCE)
        } else {
            clusters.find(agrees)
        };
        let names: Vec<&str> = votes
            .iter()
            .filter(|vote| right == Some(vote.cluster))
            .map(|vote| vote.name.as_str())
            .collect();
        if names.is_empty() {
            return "no answer agrees with the proven distances".to_owned();
        }
        format!("proven right: {}", names.join(", "))
    }

    /// Stored distances of a file as a vote. They may lack some vertices, so they join the first
    /// cluster that agrees at the vertices that they have.
    fn vote_of(
        &self,
        name: &str,
        distances: &[(usize, f64)],
        reference: &[f64],
        clusters: &Clusters,
        layout: &AnswerLayout,
    ) -> Vote {
        let tolerance = self.options.tolerance;
        let compare = |answer: &[f64]| {
            let stored = distances.iter().copied();
            layout.compare(answer, stored, tolerance, false)
        };
        let mut vote = Vote::of_reference(name, true);
        let comparison = compare(reference);
        if !comparison.agrees() {
            vote.compared(&comparison);
            let has_all = |answer: &[f64]| answer.len() == reference.len();
            let found = clusters.find(|answer| has_all(answer) && compare(answer).agrees());
            vote.cluster = found.unwrap_or_else(|| clusters.next());
        }
        vote
    }
}

/// The verdict on one answer.
#[derive(Default)]
struct Judgement {
    wrong: bool,
    /// Whether the answer may differ by any finite amount.
    may_differ: bool,
    remarks: Vec<String>,
}

impl Judgement {
    /// Marks the answer as wrong, for the reason `why`.
    fn wrong(&mut self, why: &str) {
        self.wrong = true;
        self.remarks.push(why.to_owned());
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
        let comparison = layout.compare(found, expected, tolerance, self.may_differ);
        let mut name = field.path.display().to_string();
        if comparison.compared < found.len() {
            let (compared, count, noun) = (comparison.compared, found.len(), layout.noun());
            name = format!("{name} at {compared} of {count} {noun}");
        }
        self.judge(&name, &comparison, layout);
    }

    /// Adds a remark on the comparison with `reference`, and marks a disagreement as wrong.
    fn judge(&mut self, reference: &str, comparison: &Deviation, layout: &AnswerLayout) {
        match &comparison.worst {
            Some(_) if self.may_differ && comparison.max_rel.is_finite() => {
                self.remarks.push(format!(
                    "approximate: {reference} differs by up to {} relative",
                    scientific(comparison.max_rel)
                ));
            }
            Some(worst) => self.wrong(&format!(
                "differs from {reference}: {}; {} of {} {} differ",
                layout.describe(worst),
                comparison.disagreeing,
                comparison.compared,
                layout.noun()
            )),
            None => self.remarks.push(format!(
                "agrees with {reference}, largest relative difference {}",
                scientific(comparison.max_rel)
            )),
        }
    }

    /// The verdict with its remarks. Only an answer of the reference has no remarks.
    fn text(&self) -> String {
        let word = if self.wrong { "WRONG" } else { "ok" };
        if self.remarks.is_empty() {
            return format!("{word} (reference)");
        }
        format!("{word}: {}", self.remarks.join("; "))
    }
}
