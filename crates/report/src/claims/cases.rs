//! Computes the cases of a test from results: their values, and whether the claim holds for each.

use geobench_harness::exec::source::SourceSpec;
use geobench_harness::figures::Figure;
use geobench_harness::measure::number::grouped;
use geobench_harness::measure::statistics::{FEWEST_FOR_FIT, FEWEST_FOR_INTERVAL, range_of};
use geobench_harness::schema::{
    Cell, ModelRecord, PhaseSeconds, PlannedAlgorithm, ResultFile, SourceLabel, Status,
};
use geobench_registry::{Selection, Value, select_one};

use super::expression::{Expression, ExpressionLeaves, Quantity};
use super::file::{
    Combine, GrowthAxis, ModelSize, Operand, Show, SimdFilter, Test, labels, number_of,
};
use super::judged::ClaimCase;
use crate::table::group::{Estimate, distinct};

/// The results of a suite, and the test that is computed from them.
#[derive(Clone, Copy)]
pub(super) struct Results<'r> {
    pub(super) result: &'r ResultFile,
    pub(super) test: &'r Test,
    pub(super) programs: JudgedPrograms,
}

/// Which programs a test is computed with.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum JudgedPrograms {
    /// Ours, as the test names them.
    Named,
    /// Ours, with the second heap in place of the first one.
    SecondHeap,
    /// Those of the authors.
    Authors,
}

/// Public programs of authors, as outside algorithms, by the names of the algorithms here.
const AUTHORS: [(&str, &str); 3] = [
    ("vtp", "ext:vtp"),
    ("mmp", "ext:kirsanov"),
    ("ich", "ext:ich"),
];

/// The value of the parameter `queue` for a binary heap, and for the heap of four children a node.
const HEAPS: [&str; 2] = ["heap", "heap4"];

/// Whether `cell` is of an outside program in [`AUTHORS`].
pub(super) fn is_authors(cell: &Cell) -> bool {
    AUTHORS.iter().any(|(_, label)| cell.algorithm == *label)
}

/// Whether the algorithm takes windows from a binary heap.
fn has_heap(selection: &Selection) -> bool {
    let mut settings = selection.settings();
    settings.any(|(name, value)| name == "queue" && value == Value::Word(HEAPS[0]))
}

/// The same algorithm with the second heap, if it has a heap.
fn with_second_heap(selection: &Selection) -> Option<Selection> {
    let label = selection.label();
    let (name, rest) = label.split_once('{').unwrap_or((label, "}"));
    let rest = if rest == "}" {
        rest.to_owned()
    } else {
        format!(",{rest}")
    };
    let other = select_one(&format!("{name}{{queue={}{rest}", HEAPS[1])).ok()?;
    has_heap(selection).then(|| other.with_threads(1))
}

/// The reason why there is no value.
type Reason = String;

/// An expression with the numbers that it is computed from.
struct Built {
    leaves: ExpressionLeaves,
    node: Expression,
    /// For a growth, the range of its points on the axis.
    range: Option<[f64; 2]>,
}

/// A point of a series: a model in a group.
#[derive(Clone, Copy)]
struct GroupModel<'r> {
    group: Option<&'r str>,
    model: &'r ModelRecord,
}

impl<'r> Results<'r> {
    /// The groups of the suite that the test selects.
    fn groups(&self) -> Vec<Option<&'r str>> {
        let cells = self.result.cells.iter();
        let groups = distinct(cells.map(|cell| cell.group.as_deref()));
        let wanted = |group: Option<&str>| {
            let wanted = &self.test.groups;
            self.programs == JudgedPrograms::Authors
                || wanted.is_empty()
                || group.is_some_and(|name| wanted.iter().any(|one| one == name))
        };
        groups.into_iter().filter(|group| wanted(*group)).collect()
    }

    /// The models of a group that the test selects, and that are like those of the claim.
    fn models(&self, group: Option<&str>) -> Vec<&'r ModelRecord> {
        let models = self.selected(group).into_iter();
        let is_like = |model: &&ModelRecord| {
            let sources = self.sources(group, model).unwrap_or(1.0) as u64;
            let least = (self.test.at_least_faces).max(self.test.faces_per_source * sources);
            least == 0 || model.faces.is_some_and(|faces| faces >= least)
        };
        models.filter(is_like).collect()
    }

    /// The models of a group that the test selects.
    fn selected(&self, group: Option<&str>) -> Vec<&'r ModelRecord> {
        let models = self.result.models.iter().filter(|model| {
            let mut cells = self.result.cells.iter();
            let patterns = &self.test.models;
            let named = |pattern: &String| is_like(pattern, &model.name);
            cells.any(|cell| cell.group.as_deref() == group && cell.model == model.name)
                && (self.programs == JudgedPrograms::Authors
                    || patterns.is_empty()
                    || patterns.iter().any(named))
        });
        models.collect()
    }

    /// The planned algorithms of a group that have the name of `selection`, with any parameters.
    fn namesakes(
        &self,
        group: Option<&str>,
        selection: &Selection,
    ) -> impl Iterator<Item = &PlannedAlgorithm> {
        let name = selection.algorithm().name;
        let groups = self.result.plan.iter().flat_map(|plan| &plan.groups);
        let planned = groups.filter(move |planned| planned.name.as_deref() == group);
        let planned = planned.flat_map(|planned| &planned.algorithms);
        planned.filter(move |planned| planned.label.split('{').next() == Some(name))
    }

    /// The label of `selection` in the cells of a group: that of the planned algorithm with the
    /// same name and exactly the same parameters. Labels cannot be compared directly: they omit
    /// default values, and defaults change between versions. Outside programs have fixed labels.
    fn label(&self, group: Option<&str>, selection: &Selection) -> Result<&str, Reason> {
        if self.programs == JudgedPrograms::Authors {
            let mut known = AUTHORS.iter();
            let program = known.find(|(name, _)| *name == selection.label());
            let program = program.map(|(_, label)| *label);
            return program
                .ok_or_else(|| format!("no program of authors is {}", selection.label()));
        }
        let second = match self.programs {
            JudgedPrograms::SecondHeap => with_second_heap(selection),
            _ => None,
        };
        let selection = second.as_ref().unwrap_or(selection);
        let missing = |why: &str| Err(format!("{} {why}", selection.label()));
        if self.result.plan.is_none() {
            return missing("cannot be told from others: the result does not hold its plan");
        }
        let mut namesakes = self.namesakes(group, selection).peekable();
        if namesakes.peek().is_none() {
            return missing("was not run");
        }
        let Some(same) = namesakes.find(|planned| is_same(selection, planned)) else {
            return missing("was run with other parameters than the claim has");
        };
        Ok(&same.label)
    }

    /// The cells of an algorithm on a model, one for each source.
    fn cells(
        &self,
        group: Option<&str>,
        selection: &Selection,
        model: &str,
    ) -> Result<Vec<&Cell>, Reason> {
        let label = self.label(group, selection)?;
        let cells = self.result.cells.iter();
        let cells: Vec<&Cell> = cells
            .filter(|c| c.group.as_deref() == group && c.algorithm == label && c.model == model)
            .collect();
        if cells.is_empty() {
            Err(format!("{label} has no cell"))
        } else {
            Ok(cells)
        }
    }

    /// The figure of a cell.
    fn quantity(
        &self,
        figure: &Figure,
        cell: &Cell,
        model: &ModelRecord,
    ) -> Result<Quantity, Reason> {
        let label = &cell.algorithm;
        if cell.status != Status::Ok {
            return Err(format!("{label}: {}", cell.status.in_words()));
        }
        if is_timed(figure) && self.result.tool.profile != "release" {
            return Err("it was measured with a debug build".to_owned());
        }
        let is_counted = figure.key == "instructions";
        if is_timed(figure) && !is_counted && self.result.jobs().is_some() {
            return Err("cells ran at the same time, which disturbs times".to_owned());
        }
        let may_be_vectors =
            self.test.simd == SimdFilter::Any || self.programs == JudgedPrograms::Authors;
        if is_timed(figure) && !may_be_vectors {
            // A ratio of vector code to scalar code would compare implementations, not algorithms.
            let simd = match figure.key {
                "instructions" if cell.instructions.is_none() => Some("scalar"),
                "instructions" => cell.instructions_simd.as_deref(),
                _ => cell.simd.as_deref(),
            };
            match simd {
                Some("scalar") => {}
                Some(other) => {
                    return Err(format!(
                        "{label} ran with vector instructions ({other}); only scalar runs decide"
                    ));
                }
                None => {
                    return Err(
                        "the result does not say which vector instructions ran; only scalar runs \
                         decide"
                            .to_owned(),
                    );
                }
            }
        }
        if figure.key == "time" {
            return match &cell.time.samples[..] {
                [] => Err(format!("{label} has no times")),
                samples => Ok(Quantity::Samples(samples.to_vec())),
            };
        }
        if let Some(phase) = phase_of(figure) {
            return phase_quantity(figure, phase, cell);
        }
        let value = figure.of(cell, model.vertices);
        value
            .map(Quantity::Exact)
            .ok_or_else(|| format!("{label} has no `{}`", figure.key))
    }

    /// All cases of the test.
    pub(super) fn cases(&self) -> Vec<ClaimCase> {
        let mut cases = Vec::new();
        for operand in &self.test.of {
            let groups: Vec<_> = self
                .groups()
                .into_iter()
                .filter(|group| !self.models(*group).is_empty())
                .collect();
            // Groups that lack one of the algorithms are skipped, unless all groups do.
            let has_all = |group: Option<&str>| {
                let all = operand.algorithms.iter();
                let mut all = all.chain(self.test.to.iter().flat_map(|to| &to.algorithms));
                self.programs == JudgedPrograms::Authors
                    || all.all(|selection| self.namesakes(group, selection).next().is_some())
            };
            let able: Vec<_> = groups
                .iter()
                .copied()
                .filter(|group| has_all(*group))
                .collect();
            let groups = if able.is_empty() { groups } else { able };
            let mut own = match (self.test.ends, self.test.combine) {
                (Some(ends), _) => self.endings(operand, &groups, ends),
                (None, Combine::Each) if self.test.over.is_some() => {
                    let series = self.series(&groups).into_iter();
                    series
                        .map(|(on, pairs)| {
                            self.case(operand, on, |figure| self.growth(operand, &pairs, figure))
                        })
                        .collect()
                }
                (None, Combine::Each) => groups
                    .iter()
                    .flat_map(|group| {
                        self.models(*group).into_iter().map(|model| {
                            let on = self.place(model, *group, &groups);
                            self.case(operand, &on, |figure| {
                                let mut leaves = ExpressionLeaves::default();
                                let node = self.on(operand, *group, model, figure, &mut leaves)?;
                                Ok(Built {
                                    leaves,
                                    node,
                                    range: None,
                                })
                            })
                        })
                    })
                    .collect(),
                (None, combine) => {
                    let models = groups.iter().map(|group| self.models(*group).len());
                    let on = format!("{} of {} models", words(combine), models.sum::<usize>());
                    vec![self.case(operand, &on, |figure| {
                        self.combined(operand, &groups, figure, combine)
                    })]
                }
            };
            if own.is_empty() {
                own.extend(self.unlike(operand));
            }
            self.judge_sizes(operand, &mut own);
            cases.extend(own);
        }
        cases
    }

    /// The case that tells why no model is like those of the claim, if there are models at all.
    fn unlike(&self, operand: &Operand) -> Option<ClaimCase> {
        let groups = self.groups().into_iter();
        let models =
            groups.flat_map(|group| self.selected(group).into_iter().map(move |m| (group, m)));
        let (group, greatest) = models.max_by_key(|(_, model)| model.faces)?;
        let faces = grouped(greatest.faces?);
        let (least, per) = (self.test.at_least_faces, self.test.faces_per_source);
        let reason = if per > 0 {
            let sources = self.sources(group, greatest).unwrap_or(1.0) as u64;
            let plural = if sources == 1 { "" } else { "s" };
            format!(
                "the largest model has {faces} faces for {} source{plural}, the claim is about {} faces for each",
                grouped(sources),
                grouped(per)
            )
        } else {
            format!(
                "the largest model has {faces} faces, the claim is about {}",
                grouped(least)
            )
        };
        Some(ClaimCase {
            reason: Some(reason),
            of: labels(&operand.algorithms),
            ..ClaimCase::open(self.test.figure.key, "no model")
        })
    }

    /// The name of a model in a case: with its group if several of `groups` have the model.
    fn place(&self, model: &ModelRecord, group: Option<&str>, groups: &[Option<&str>]) -> String {
        let has = |group: Option<&str>| {
            let mut cells = self.result.cells.iter();
            cells.any(|cell| cell.group.as_deref() == group && cell.model == model.name)
        };
        match group {
            Some(group) if groups.iter().filter(|group| has(**group)).count() > 1 => {
                format!("{} in {group}", model.name)
            }
            _ => model.name.clone(),
        }
    }

    /// Builds a case from the first figure that decides. If none does, the case has the reason why
    /// the first figure does not.
    fn case(
        &self,
        operand: &Operand,
        on: &str,
        build: impl Fn(&'static Figure) -> Result<Built, Reason>,
    ) -> ClaimCase {
        let mut first: Option<ClaimCase> = None;
        let blank = |figure: &str| ClaimCase {
            of: self.in_words(operand),
            ..ClaimCase::open(figure, on)
        };
        let figures = std::iter::once(&self.test.figure).chain(&self.test.others);
        for (index, &figure) in figures.enumerate() {
            let mut case = blank(figure.key);
            match build(figure).map(|built| self.decide(&built, operand, figure, &mut case)) {
                Ok(Ok(())) if index == 0 => return case,
                Ok(Ok(())) => {
                    // The paper's numbers are values of the first figure. Another figure can
                    // confirm only the direction, so the size counts as not fitting.
                    let printed = !self.test.printed(operand).is_empty();
                    case.fits = printed.then_some(false);
                    let why = first.and_then(|case| case.reason).unwrap_or_default();
                    case.reason = Some(format!("decided by {}, because {why}", figure.key));
                    return case;
                }
                Ok(Err(reason)) | Err(reason) => {
                    case.reason = Some(reason);
                    first.get_or_insert(case);
                }
            }
        }
        first.unwrap_or_else(|| blank(""))
    }

    /// Decides whether the claim holds for the value of an expression, and stores value and outcome
    /// in `case`. Returns the reason if the value does not decide.
    fn decide(
        &self,
        built: &Built,
        operand: &Operand,
        figure: &Figure,
        case: &mut ClaimCase,
    ) -> Result<(), Reason> {
        let Some(value) = built.leaves.value(&built.node) else {
            return Err(format!("`{}` is 0", figure.key));
        };
        (case.value, case.ci95) = (Some(value.value), value.interval);
        case.range = built.range;
        let Some(holds) = self.test.holds else {
            // The sizes decide.
            return Ok(());
        };
        let is_small = |width: f64| {
            let printed = self.test.printed(operand).into_iter();
            let limits = [holds.least, holds.most]
                .into_iter()
                .filter(|limit| limit.is_finite());
            let differences = printed.flat_map(|number| {
                limits
                    .clone()
                    .map(move |limit| (number.value - limit).abs())
            });
            differences
                .max_by(f64::total_cmp)
                .is_some_and(|claimed| claimed < width)
        };
        let too_small = || "the claimed difference is smaller than the 95 % interval".to_owned();
        let sure = match value {
            Estimate {
                interval: Some([low, high]),
                ..
            } if low.is_nan() || high.is_nan() => {
                return Err("the 95 % interval has no ends".to_owned());
            }
            Estimate {
                interval: Some([low, high]),
                ..
            } => {
                let same = [low, high].map(|end| holds.holds(end));
                match same {
                    [true, true] => true,
                    _ if is_small(high - low) => return Err(too_small()),
                    [false, false] if !holds.touches([low, high]) => false,
                    _ => return Err("the 95 % interval holds both sides".to_owned()),
                }
            }
            _ if !built.leaves.are_exact() => {
                let samples = built.leaves.fewest_samples();
                let s = if samples == 1 { "" } else { "s" };
                return Err(format!(
                    "{samples} sample{s}; an interval takes {FEWEST_FOR_INTERVAL}"
                ));
            }
            Estimate { value, .. } => holds.holds(value),
        };
        case.holds = Some(sure);
        Ok(())
    }

    /// Sets whether the sizes of the cases of an expression agree with the paper's numbers. Figures
    /// of the paper's own models must be within 5 %. Otherwise the range of our values, with their
    /// intervals, must meet that of the paper's numbers, with their deviations; a single value
    /// without an interval counts with 5 %.
    fn judge_sizes(&self, operand: &Operand, cases: &mut [ClaimCase]) {
        const CLOSE: f64 = 0.05;
        let printed = self.test.printed(operand);
        let first = |case: &ClaimCase| case.figure == self.test.figure.key && case.value.is_some();
        let of_models =
            self.test.to.is_none() && printed.iter().any(|number| number.place.is_some());
        let ends = |case: &ClaimCase| {
            let value = case.value.unwrap_or(f64::NAN);
            case.ci95.unwrap_or([value; 2])
        };
        let mut agrees = None;
        if !of_models
            && let Some([mut low, mut high]) =
                range_of(cases.iter().filter(|c| first(c)).flat_map(ends))
        {
            if low == high {
                (low, high) = (low - CLOSE * low.abs(), high + CLOSE * high.abs());
            }
            let ends = printed
                .iter()
                .flat_map(|n| [n.value - n.deviation, n.value + n.deviation]);
            agrees = range_of(ends).map(|[least, most]| low <= most && high >= least);
        }
        for case in cases.iter_mut().filter(|case| first(case)) {
            case.fits = agrees;
            if of_models {
                let mut models = self.result.models.iter();
                let model = models.find(|model| model.name == case.on);
                let own = printed.iter().find(|number| {
                    let same = |(name, faces): &(String, u64)| {
                        let (model, ours) = (model?, model?.faces?);
                        let close = ours.abs_diff(*faces) * 100 <= *faces;
                        Some(close && model.name.to_lowercase().contains(name))
                    };
                    number.place.as_ref().and_then(same).unwrap_or(false)
                });
                let value = case.value.unwrap_or(f64::NAN);
                case.fits = own.map(|own| (value - own.value).abs() <= CLOSE * own.value.abs());
            }
            if self.test.holds.is_none() && self.test.ends.is_none() {
                case.holds = case.fits;
                if case.fits.is_none() {
                    case.reason = Some("it is not a model of the paper".to_owned());
                }
            }
        }
    }

    /// The expression on one model: the median over its sources.
    fn on(
        &self,
        operand: &Operand,
        group: Option<&str>,
        model: &ModelRecord,
        figure: &'static Figure,
        leaves: &mut ExpressionLeaves,
    ) -> Result<Expression, Reason> {
        let cells = |operand: &Operand| {
            let all = operand.algorithms.iter();
            all.map(|selection| self.cells(group, selection, &model.name))
                .collect::<Result<Vec<_>, _>>()
        };
        let (over, under) = (
            cells(operand)?,
            self.test.to.as_ref().map(cells).transpose()?,
        );
        let sources = distinct(over.iter().flatten().map(|cell| cell.source.clone()));
        let own = operand.figure(figure);
        let mut nodes = Vec::new();
        for source in sources {
            let at = |cells: &[Vec<&Cell>], figure: &Figure| {
                let of_source = |cells: &Vec<&Cell>| {
                    let cell = cells.iter().find(|cell| cell.source == source);
                    let cell =
                        cell.ok_or_else(|| "not all ran from the same sources".to_owned())?;
                    self.quantity(figure, cell, model)
                };
                cells.iter().map(of_source).collect::<Result<Vec<_>, _>>()
            };
            let over = at(&over, own)?;
            let under = match (&under, &self.test.to) {
                (Some(under), Some(to)) => at(under, to.figure(figure))?,
                _ => Vec::new(),
            };
            nodes.push(self.source(operand, over, under, leaves));
        }
        let node = match nodes.len() {
            1 => nodes.remove(0),
            _ => Expression::Median(nodes),
        };
        let node = match self.test.per {
            None => node,
            Some(size) => {
                let size = match size {
                    ModelSize::Vertices => model.vertices,
                    ModelSize::Faces => model.faces,
                };
                let size = size.ok_or("the size of the model is not known")?;
                Expression::Per(Box::new(node), size as f64)
            }
        };
        Ok(match self.test.show {
            Show::Value | Show::Exponent => node,
            Show::Saving => Expression::Saving(Box::new(node)),
        })
    }

    /// The expression on one model from one source, from the quantities of the operand (`over`) and
    /// of the base (`under`).
    fn source(
        &self,
        operand: &Operand,
        over: Vec<Quantity>,
        under: Vec<Quantity>,
        leaves: &mut ExpressionLeaves,
    ) -> Expression {
        if let Some(best) = &self.test.best {
            let beside = operand.algorithms.iter();
            let beside = beside.map(|one| number_of(one, best.get_ref()).unwrap_or(f64::NAN));
            let all = beside.zip(over.into_iter().map(|quantity| leaves.node(quantity)));
            return Expression::Best(all.collect());
        }
        let least = |quantities: Vec<Quantity>, leaves: &mut ExpressionLeaves| {
            let mut nodes: Vec<Expression> =
                quantities.into_iter().map(|q| leaves.node(q)).collect();
            match nodes.len() {
                1 => nodes.remove(0),
                _ => Expression::Least(nodes),
            }
        };
        match (
            <[Quantity; 1]>::try_from(over),
            <[Quantity; 1]>::try_from(under),
        ) {
            (Ok([over]), Ok([under])) => leaves.ratio(over, under),
            (over, under) => {
                let over = least(over.map_or_else(|many| many, Vec::from), leaves);
                let under = under.map_or_else(|many| many, Vec::from);
                if under.is_empty() {
                    return over;
                }
                Expression::Ratio(Box::new(over), Box::new(least(under, leaves)))
            }
        }
    }

    /// The series over which a growth is computed. A series is the models of one group. If the axis
    /// is the number of sources, it is one model in all groups. If each group has one model, it is
    /// those of all groups.
    fn series(&self, groups: &[Option<&'r str>]) -> Vec<(&'r str, Vec<GroupModel<'r>>)> {
        let all = groups.iter().flat_map(|&group| {
            let models = self.models(group).into_iter();
            models.map(move |model| GroupModel { group, model })
        });
        let are_single = groups.iter().all(|group| self.models(*group).len() == 1);
        let of_series = |pair: &GroupModel<'r>| match self.test.over {
            _ if are_single => "all models",
            Some(GrowthAxis::Sources) => pair.model.name.as_str(),
            _ => pair.group.unwrap_or("all models"),
        };
        let all: Vec<GroupModel<'r>> = all.collect();
        let names = distinct(all.iter().map(of_series));
        let series = names.into_iter().map(|name| {
            let pairs = all.iter().filter(|pair| of_series(pair) == name);
            (name, pairs.copied().collect())
        });
        series.collect()
    }

    /// The value of a point of a series on the growth axis.
    fn along(&self, pair: GroupModel<'_>) -> Option<f64> {
        let GroupModel { group, model } = pair;
        match self.test.over {
            Some(GrowthAxis::Anisotropy) => model.anisotropy,
            Some(GrowthAxis::Sources) => self.sources(group, model),
            _ => model.faces.map(|faces| faces as f64),
        }
    }

    /// The number of sources of each run on a model.
    fn sources(&self, group: Option<&str>, model: &ModelRecord) -> Option<f64> {
        let mut cells = self.result.cells.iter();
        let same = |c: &&Cell| c.group.as_deref() == group && c.model == model.name;
        match cells.find(same)?.source.as_ref()? {
            SourceLabel::Vertex(_) => Some(1.0),
            SourceLabel::Other(text) => Some(text.parse::<SourceSpec>().ok()?.count() as f64),
        }
    }

    /// The growth of the expression over a series.
    fn growth(
        &self,
        operand: &Operand,
        series: &[GroupModel<'_>],
        figure: &'static Figure,
    ) -> Result<Built, Reason> {
        let (mut leaves, mut points) = (ExpressionLeaves::default(), Vec::new());
        let mut missing = None;
        for &pair @ GroupModel { group, model } in series {
            let Some(x) = self.along(pair) else {
                continue;
            };
            // Points where an algorithm has no result are left out.
            let mut longer = leaves.clone();
            match self.on(operand, group, model, figure, &mut longer) {
                Ok(node) => {
                    leaves = longer;
                    points.push((x, node));
                }
                Err(reason) => missing = missing.or(Some(reason)),
            }
        }
        let abscissas: Vec<f64> = points.iter().map(|(x, _)| *x).collect();
        if distinct(abscissas).len() < FEWEST_FOR_FIT {
            let few = format!("fewer than {FEWEST_FOR_FIT} models of the series have a value");
            return Err(missing.map_or(few.clone(), |why| format!("{few}: {why}")));
        }
        Ok(Built {
            range: range_of(points.iter().map(|(x, _)| *x)),
            leaves,
            node: match self.test.show {
                Show::Exponent => Expression::Exponent(points),
                _ => Expression::Growth(points),
            },
        })
    }

    /// The expression over all models, combined to one value.
    fn combined(
        &self,
        operand: &Operand,
        groups: &[Option<&str>],
        figure: &'static Figure,
        combine: Combine,
    ) -> Result<Built, Reason> {
        let (mut leaves, mut nodes) = (ExpressionLeaves::default(), Vec::new());
        for &group in groups {
            for model in self.models(group) {
                nodes.push(self.on(operand, group, model, figure, &mut leaves)?);
            }
        }
        if nodes.is_empty() {
            return Err("no model".to_owned());
        }
        let node = match combine {
            Combine::Median | Combine::Each => Expression::Median(nodes),
            Combine::Mean => Expression::Mean(nodes),
            Combine::GeometricMean => Expression::GeometricMean(nodes),
            Combine::Spread => Expression::Spread(nodes),
        };
        Ok(Built {
            leaves,
            node,
            range: None,
        })
    }

    /// The cases of a test on statuses: runs that must end with the status `ends`.
    fn endings(&self, operand: &Operand, groups: &[Option<&str>], ends: Status) -> Vec<ClaimCase> {
        let mut cases = Vec::new();
        for &group in groups {
            let models = self.models(group).into_iter();
            let models =
                models.flat_map(|model| operand.algorithms.iter().map(move |one| (model, one)));
            for (model, one) in models {
                let found = self.cells(group, one, &model.name);
                let found = found.map(|cells| cells.iter().any(|cell| cell.status == ends));
                cases.push(ClaimCase {
                    holds: found.as_ref().ok().copied(),
                    reason: found.err(),
                    of: one.label().to_owned(),
                    ..ClaimCase::open("status", &model.name)
                });
            }
        }
        cases
    }

    /// Whether the test is on times of programs, so that it rests on the queue if one of its
    /// algorithms has a heap.
    pub(super) fn rests_on_the_queue(&self) -> bool {
        let figures = std::iter::once(&self.test.figure).chain(&self.test.others);
        let operands = self.test.of.iter().chain(&self.test.to);
        let mut algorithms = operands.flat_map(|operand| &operand.algorithms);
        figures.into_iter().any(|figure| is_timed(figure)) && algorithms.any(has_heap)
    }

    /// Whether the test can be computed from programs of authors: they report times alone.
    pub(super) fn can_be_checked(&self) -> bool {
        self.test.figure.key == "time" && self.test.over.is_none() && self.test.best.is_none()
    }

    /// The expression of an operand in words.
    fn in_words(&self, operand: &Operand) -> String {
        let own = operand.figure.map(|figure| format!("{} of ", figure.key));
        let own = own.unwrap_or_default() + &operand.in_words();
        match &self.test.to {
            None => own,
            Some(to) => {
                let figure = to.figure.map(|figure| format!("{} of ", figure.key));
                format!("{own} to {}{}", figure.unwrap_or_default(), to.in_words())
            }
        }
    }
}

/// The phase that a figure is about, if it is about one.
fn phase_of(figure: &Figure) -> Option<fn(&PhaseSeconds) -> Option<f64>> {
    match figure.key {
        "phase_propagation" => Some(|phases| phases.propagation),
        "phase_pruning" => Some(|phases| phases.pruning),
        "phase_management" | "management_share" => Some(|phases| phases.management),
        _ => None,
    }
}

/// A phase of a cell: its share of the profile samples or, for times, that share of the timed runs.
fn phase_quantity(
    figure: &Figure,
    phase: fn(&PhaseSeconds) -> Option<f64>,
    cell: &Cell,
) -> Result<Quantity, Reason> {
    let phases = &cell.phases;
    let parts = [phases.propagation, phases.pruning, phases.management];
    let all = parts
        .into_iter()
        .sum::<Option<f64>>()
        .filter(|all| *all > 0.0);
    let (Some(all), Some(own)) = (all, phase(phases)) else {
        return Err(format!("{} has no phases", cell.algorithm));
    };
    let Some(samples) = phases.samples else {
        return Err("the phases were not sampled, so they have no interval".to_owned());
    };
    Ok(match figure.key {
        "management_share" => Quantity::Share(own / all, samples),
        _ if cell.time.samples.is_empty() => {
            return Err(format!("{} has no times", cell.algorithm));
        }
        _ => Quantity::TimeShare(cell.time.samples.clone(), own / all, samples),
    })
}

/// Whether a figure depends on the build and the machine code.
fn is_timed(figure: &Figure) -> bool {
    const KEYS: &[&str] = &[
        "time",
        "outside_time",
        "claimed_time",
        "setup",
        "extraction",
        "instructions",
    ];
    KEYS.contains(&figure.key) || phase_of(figure).is_some()
}

/// Whether a planned algorithm has exactly the parameters of `selection`.
pub(super) fn is_same(selection: &Selection, planned: &PlannedAlgorithm) -> bool {
    let mut settings = selection.settings();
    let equal = |(name, value)| planned.parameters.get(name) == Some(&serde_json::json!(value));
    planned.parameters.len() == selection.settings().count() && settings.all(equal)
}

const fn words(combine: Combine) -> &'static str {
    match combine {
        Combine::Each => "each",
        Combine::Median => "median",
        Combine::Mean => "mean",
        Combine::GeometricMean => "geometric mean",
        Combine::Spread => "greatest to least",
    }
}

/// Whether `text` matches `pattern`, in which `*` stands for any text.
pub(super) fn is_like(pattern: &str, text: &str) -> bool {
    match pattern.split_once('*') {
        None => pattern == text,
        Some((start, rest)) => text.strip_prefix(start).is_some_and(|text| {
            let mut starts = text.char_indices().map(|(at, _)| at).chain([text.len()]);
            starts.any(|at| is_like(rest, &text[at..]))
        }),
    }
}
