//! Files of claims: quotes from a paper, and the tests that decide them.

use std::path::{Path, PathBuf};
use std::str::FromStr;

use geobench_harness::figures::{Figure, time};
use geobench_harness::schema::Status;
use geobench_harness::usage::document::{DocumentError, TomlDocument, parsed, text_or_table};
use geobench_registry::{Selection, Value, select_one};
use serde::{Deserialize, Deserializer};
use toml::Spanned;

use crate::page::papers::PaperTable;

/// The claims of a paper.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ClaimsFile {
    /// The paper's number.
    pub paper: String,
    /// Authors, year and subject.
    pub title: String,
    #[serde(default, rename = "claim")]
    claims: Vec<Spanned<PaperClaim>>,
    /// Whether the claims are those of a paper, which other models than those of its suites do not
    /// decide. Those in a file of a user are about the models that the user takes.
    #[serde(skip)]
    pub(super) is_of_paper: bool,
}

/// A claim.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PaperClaim {
    id: Spanned<String>,
    /// Section, table or figure.
    pub place: String,
    /// A short quote from the paper.
    pub quote: String,
    /// The tested statement, in our words.
    pub claim: String,
    /// The suite whose results decide.
    pub suite: Option<String>,
    /// What the claim waits for, such as an algorithm that does not exist yet. Until then it cannot
    /// be judged.
    pub awaits: Option<String>,
    /// An explanation for readers, in addition to the numbers.
    pub remark: Option<String>,
    /// How the paper's counts differ from ours. If set, it is the cause where the claim fails.
    pub counting: Option<String>,
    /// What a judgement would take, if models or sizes are unlike the paper's.
    pub takes: Option<String>,
    #[serde(default, rename = "test")]
    tests: Vec<Spanned<Test>>,
}

/// A test: an expression over results and the values for which the claim holds. `docs/claims.md`
/// defines the keys.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Test {
    #[serde(default, rename = "group")]
    pub(super) groups: Vec<String>,
    #[serde(default)]
    pub(super) models: Vec<String>,
    pub(super) of: Vec<Operand>,
    pub(super) to: Option<Operand>,
    /// The figure that decides.
    #[serde(default = "time")]
    pub(super) figure: &'static Figure,
    /// The figures that decide where `figure` cannot, in order of preference.
    #[serde(default, rename = "else")]
    pub(super) others: Vec<&'static Figure>,
    pub(super) per: Option<ModelSize>,
    pub(super) over: Option<GrowthAxis>,
    #[serde(default)]
    pub(super) combine: Combine,
    #[serde(default)]
    pub(super) show: Show,
    /// If set, the value is this parameter of the algorithm with the least figure.
    pub(super) best: Option<Spanned<String>>,
    /// The values for which the claim holds. Without this and `ends`, the paper's numbers are the
    /// claim.
    pub(super) holds: Option<Range>,
    pub(super) paper: Option<Spanned<Paper>>,
    /// The status with which runs must end. Such a test has no expression.
    pub(super) ends: Option<Status>,
    /// Smaller models are unlike those of the claim.
    #[serde(default)]
    pub(super) at_least_faces: u64,
    /// Models with fewer faces for each source are unlike those of the claim.
    #[serde(default)]
    pub(super) faces_per_source: u64,
    #[serde(default)]
    pub(super) simd: SimdFilter,
}

/// Selects the runs whose times and instructions decide, by their SIMD level.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub(super) enum SimdFilter {
    /// Runs without vector instructions.
    #[default]
    Scalar,
    /// All runs.
    Any,
}

/// An operand of an expression: a figure of one or several algorithms.
#[derive(Clone, Debug)]
pub(super) struct Operand {
    /// The algorithms. The least of their figures is used.
    pub(super) algorithms: Vec<Selection>,
    /// The figure, if it differs from that of the test.
    pub(super) figure: Option<&'static Figure>,
}

/// A size of a model.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub(super) enum ModelSize {
    Vertices,
    Faces,
}

/// The axis of a growth.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub(super) enum GrowthAxis {
    Faces,
    Anisotropy,
    /// The number of sources of a run. A series is one model in several groups.
    Sources,
}

/// How the values of several models are combined.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub(super) enum Combine {
    /// Not combined: every model is a case of its own.
    #[default]
    Each,
    Median,
    Mean,
    GeometricMean,
    Spread,
}

/// The form in which a ratio is shown.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub(super) enum Show {
    #[default]
    Value,
    /// One minus the ratio.
    Saving,
    /// Of a growth, the power of the axis instead of the factor.
    Exponent,
}

/// The values for which a claim holds: `> 1`, `< 2` or `0.9 to 1.1`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Range {
    pub(super) least: f64,
    pub(super) most: f64,
}

impl Range {
    /// Whether `value` is in the range. `> 1` excludes 1; `0.9 to 1.1` includes both ends.
    pub(super) fn holds(&self, value: f64) -> bool {
        if self.most == f64::INFINITY {
            value > self.least
        } else if self.least == f64::NEG_INFINITY {
            value < self.most
        } else {
            (self.least..=self.most).contains(&value)
        }
    }

    /// Whether an interval overlaps the range, with its ends.
    pub(super) fn touches(&self, [low, high]: [f64; 2]) -> bool {
        low <= self.most && high >= self.least
    }
}

impl FromStr for Range {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let number = |text: &str| text.trim().parse::<f64>().ok().filter(|x| x.is_finite());
        let (least, most) = if let Some(text) = text.strip_prefix('>') {
            (number(text), Some(f64::INFINITY))
        } else if let Some(text) = text.strip_prefix('<') {
            (Some(f64::NEG_INFINITY), number(text))
        } else {
            let (least, most) = text.split_once(" to ").unwrap_or((text, ""));
            (number(least), number(most))
        };
        match (least, most) {
            (Some(least), Some(most)) if least <= most => Ok(Self { least, most }),
            _ => Err(format!(
                "`{text}` is no range; write `> 1`, `< 1` or `0.9 to 1.1`"
            )),
        }
    }
}

impl<'de> Deserialize<'de> for Range {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        parsed(deserializer, str::parse)
    }
}

/// The paper's numbers.
#[derive(Clone, Debug, Deserialize)]
#[serde(try_from = "WrittenPaper")]
pub(super) enum Paper {
    /// Numbers as printed, or computed from printed ones.
    Numbers(Vec<f64>),
    /// The numbers of a table of `bench-configs/papers`.
    Table(PaperTable),
}

#[derive(Deserialize)]
#[serde(
    untagged,
    expecting = "a number, a list of numbers or the name of a table is expected"
)]
enum WrittenPaper {
    Number(f64),
    Numbers(Vec<f64>),
    Table(String),
}

impl TryFrom<WrittenPaper> for Paper {
    type Error = String;

    fn try_from(written: WrittenPaper) -> Result<Self, String> {
        match written {
            WrittenPaper::Number(number) => Ok(Self::Numbers(vec![number])),
            WrittenPaper::Numbers(numbers) if numbers.is_empty() => {
                Err("at least one number is expected".to_owned())
            }
            WrittenPaper::Numbers(numbers) => Ok(Self::Numbers(numbers)),
            WrittenPaper::Table(name) => PaperTable::named(&name)
                .map(Self::Table)
                .map_err(|error| format!("{error:#}")),
        }
    }
}

impl<'de> Deserialize<'de> for Operand {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        #[derive(Deserialize)]
        #[serde(deny_unknown_fields)]
        struct Raw {
            algorithm: Option<String>,
            #[serde(default)]
            least: Vec<String>,
            figure: Option<&'static Figure>,
        }
        text_or_table(
            deserializer,
            |text| {
                Ok(Self {
                    algorithms: vec![named(text)?],
                    figure: None,
                })
            },
            |raw: Raw| {
                let names = raw.algorithm.iter().chain(&raw.least);
                let algorithms: Vec<Selection> =
                    names.map(|name| named(name)).collect::<Result<_, _>>()?;
                if raw.algorithm.is_some() != raw.least.is_empty() {
                    return Err("give either `algorithm` or `least`, a list of some".to_owned());
                }
                Ok(Self {
                    algorithms,
                    figure: raw.figure,
                })
            },
        )
    }
}

impl ClaimsFile {
    /// Reads a file.
    ///
    /// # Errors
    ///
    /// When the file cannot be read or is not valid. The message names the file, the line and the
    /// key.
    pub fn read(path: &Path) -> Result<Self, DocumentError> {
        Self::of(&TomlDocument::open(path)?)
    }

    /// Reads the text of the file `path`.
    ///
    /// # Errors
    ///
    /// When the text is not valid, as in [`read`](Self::read).
    pub fn parse(path: &Path, text: &str) -> Result<Self, DocumentError> {
        Self::of(&TomlDocument::new(path, text))
    }

    fn of(document: &TomlDocument<'_>) -> Result<Self, DocumentError> {
        let file: Self = document.read(document.parse()?)?;
        for (place, claim) in file.claims.iter().enumerate() {
            check_claim(document, claim)?;
            let id = &claim.get_ref().id;
            let mut before = file.claims[..place].iter();
            if before.any(|other| other.get_ref().id() == id.get_ref()) {
                let problem = format!("two are called `{}`", id.get_ref());
                return Err(document.error_at("id", Some(id.span()), &problem));
            }
        }
        Ok(file)
    }

    /// The claims, in the order of the file.
    pub fn claims(&self) -> impl Iterator<Item = &PaperClaim> {
        self.claims.iter().map(Spanned::get_ref)
    }
}

impl PaperClaim {
    /// The id of the claim, unique in its file.
    pub fn id(&self) -> &str {
        self.id.get_ref()
    }

    pub(super) fn tests(&self) -> impl Iterator<Item = &Test> {
        self.tests.iter().map(Spanned::get_ref)
    }
}

fn check_claim(
    document: &TomlDocument<'_>,
    claim: &Spanned<PaperClaim>,
) -> Result<(), DocumentError> {
    let (span, claim) = (claim.span(), claim.get_ref());
    let problem = match (&claim.suite, &claim.awaits, &claim.tests[..]) {
        (_, None, []) => Some("it has no [[claim.test]] and does not say what it `awaits`"),
        (None, None, _) => Some("it names no `suite` whose results decide"),
        _ => None,
    };
    if let Some(problem) = problem {
        return Err(document.error_at("claim", Some(span), problem));
    }
    let mut tests = claim.tests.iter();
    tests.try_for_each(|test| check_test(document, test))
}

fn check_test(document: &TomlDocument<'_>, test: &Spanned<Test>) -> Result<(), DocumentError> {
    let (span, test) = (test.span(), test.get_ref());
    let error = |key: &str, problem: &str| Err(document.error_at(key, Some(span.clone()), problem));
    if test.of.is_empty() {
        return error("of", "at least one algorithm is expected");
    }
    if (
        test.holds.is_some(),
        test.ends.is_some(),
        test.paper.is_some(),
    ) == (false, false, false)
        || (test.holds.is_some() && test.ends.is_some())
    {
        let problem = "a test has `holds` or `ends`, or a `paper` whose numbers are the claim";
        return error("holds", problem);
    }
    if test.show == Show::Exponent && test.over.is_none() {
        return error("show", "only a growth, `over` an axis, has an exponent");
    }
    if test.over.is_some() && test.combine != Combine::Each {
        return error("over", "growth has one value; leave `combine` out");
    }
    if let Some(best) = &test.best {
        let parameter = best.get_ref();
        let all = test.of.iter().flat_map(|operand| &operand.algorithms);
        for selection in all {
            if number_of(selection, parameter).is_none() {
                let problem = format!(
                    "{} has no number for the parameter `{parameter}`",
                    selection.label()
                );
                return Err(document.error_at("best", Some(best.span()), &problem));
            }
        }
    }
    if let Some(paper) = &test.paper
        && let Paper::Table(_) = paper.get_ref()
        && let Some(operand) = (test.of.iter()).find(|operand| test.printed(operand).is_empty())
    {
        let problem = format!(
            "the table has no number of {} for this test",
            operand.in_words()
        );
        return Err(document.error_at("paper", Some(paper.span()), &problem));
    }
    Ok(())
}

/// A number of a paper.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct PaperNumber {
    /// The model in lower case and its number of faces, if known.
    pub(super) place: Option<(String, u64)>,
    pub(super) value: f64,
    /// The standard deviation of a mean, else 0.
    pub(super) deviation: f64,
}

impl Operand {
    /// Its algorithms in words.
    pub(super) fn in_words(&self) -> String {
        match &self.algorithms[..] {
            [one] => one.label().to_owned(),
            [first, .., last] => {
                let count = self.algorithms.len();
                format!(
                    "the best of {count} from {} to {}",
                    first.label(),
                    last.label()
                )
            }
            [] => String::new(),
        }
    }

    /// The figure of this operand in a test on `figure`.
    pub(super) fn figure(&self, figure: &'static Figure) -> &'static Figure {
        self.figure.unwrap_or(figure)
    }
}

/// The algorithm of this name, on one thread unless the name has a number of threads, as in suites.
fn named(name: &str) -> Result<Selection, String> {
    let one = select_one(name).map_err(|error| error.to_string())?;
    Ok(one.with_threads(1))
}

/// The labels of `selections`, separated by commas.
pub(super) fn labels(selections: &[Selection]) -> String {
    let labels: Vec<&str> = selections.iter().map(Selection::label).collect();
    labels.join(", ")
}

impl Test {
    /// The paper's numbers for `operand`. Rows of tables are found by the label of the algorithm,
    /// or by its name if no row has the label.
    pub(super) fn printed(&self, operand: &Operand) -> Vec<PaperNumber> {
        let saved = |number: f64| match self.show {
            Show::Value | Show::Exponent => number,
            Show::Saving => 1.0 - number,
        };
        let table = match self.paper.as_ref().map(Spanned::get_ref) {
            None => return Vec::new(),
            Some(Paper::Numbers(numbers)) => {
                let number = |&value: &f64| PaperNumber {
                    place: None,
                    value,
                    deviation: 0.0,
                };
                return numbers.iter().map(number).collect();
            }
            Some(Paper::Table(table)) => table,
        };
        let [over] = &operand.algorithms[..] else {
            return Vec::new();
        };
        let is = |label: &str, selection: &Selection| {
            let mut rows = table.printed.iter();
            if rows.any(|row| row.algorithm == selection.label()) {
                label == selection.label()
            } else {
                label.split('{').next() == Some(selection.algorithm().name)
            }
        };
        let of = |selection: &Selection, figure: &Figure| -> Vec<_> {
            let rows = table.printed.iter();
            let rows = rows.filter(|row| row.to.is_none() && row.figure.key == figure.key);
            rows.filter(|row| is(&row.algorithm, selection)).collect()
        };
        let number = |row: &crate::page::papers::Printed, value: f64| PaperNumber {
            place: row.faces.map(|faces| (row.model.to_lowercase(), faces)),
            value,
            deviation: row.deviation.unwrap_or(0.0),
        };
        let own = of(over, operand.figure(self.figure)).into_iter();
        let Some(to) = &self.to else {
            return own.map(|row| number(row, row.value)).collect();
        };
        let [under] = &to.algorithms[..] else {
            return Vec::new();
        };
        let bases = of(under, to.figure(self.figure));
        let ratios = own.filter_map(|row| {
            let base = bases.iter().find(|base| base.model == row.model)?;
            Some(number(row, saved(row.value / base.value)))
        });
        let printed = table.printed.iter().filter(|row| {
            let to = row.to.as_deref().is_some_and(|label| is(label, under));
            to && is(&row.algorithm, over) && row.figure.key == self.figure.key
        });
        let printed = printed.map(|row| number(row, saved(row.value)));
        ratios.chain(printed).collect()
    }
}

/// The path of the file of claims called `name`, for messages.
pub(super) fn path(name: &str) -> PathBuf {
    PathBuf::from(format!("bench-configs/papers/claims/{name}.toml"))
}

/// The value of a parameter of `selection`, if it is a number.
pub(super) fn number_of(selection: &Selection, parameter: &str) -> Option<f64> {
    let mut parameters = selection.algorithm().parameters.iter();
    match selection.value(parameters.find(|known| known.name == parameter)?) {
        Value::Integer(n) => Some(n as f64),
        Value::Real(x) => Some(x),
        Value::Word(_) => None,
    }
}
