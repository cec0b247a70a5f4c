//! Claims with their verdicts.

use std::collections::BTreeMap;

use serde::Serialize;

/// The verdict on a claim.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum ClaimVerdict {
    /// It holds in every case, and the sizes agree with the paper's numbers, if the paper has some.
    Confirmed,
    /// It holds in every case. Some sizes differ from the paper's.
    #[serde(rename = "direction")]
    DirectionOnly,
    /// It holds in most cases. The others fail or are open.
    Partly,
    /// It holds in at most half of the cases.
    Not,
    /// The results cannot decide.
    Unjudged,
}

impl ClaimVerdict {
    pub(crate) const ALL: [Self; 5] = [
        Self::Confirmed,
        Self::DirectionOnly,
        Self::Partly,
        Self::Not,
        Self::Unjudged,
    ];

    /// In words.
    pub const fn in_words(self) -> &'static str {
        match self {
            Self::Confirmed => "confirmed",
            Self::DirectionOnly => "direction only",
            Self::Partly => "partly",
            Self::Not => "not",
            Self::Unjudged => "cannot be judged",
        }
    }
}

/// Why a claim does not hold, or not in size.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum ClaimCause {
    /// The authors' programs do not confirm it either.
    Paper,
    /// The authors' programs confirm it.
    Implementation,
    /// The paper counts something else than we do.
    Counting,
    /// Unknown.
    Open,
}

impl ClaimCause {
    /// In words.
    pub const fn in_words(self) -> &'static str {
        match self {
            Self::Paper => "paper",
            Self::Implementation => "implementation",
            Self::Counting => "counting",
            Self::Open => "open",
        }
    }
}

/// A claim with its verdict.
#[derive(Clone, Debug, Serialize)]
pub struct JudgedClaim {
    /// The name of the claim.
    pub id: String,
    /// The paper's number.
    pub paper: String,
    /// Section, table or figure.
    pub place: String,
    /// The tested statement.
    pub claim: String,
    /// A few words of the paper.
    pub quote: String,
    /// The verdict.
    pub verdict: ClaimVerdict,
    /// The cause of the verdicts `not` and `direction`; null for others.
    pub cause: Option<ClaimCause>,
    /// The cases by name.
    pub values: BTreeMap<String, ClaimCase>,
    /// Why the verdict is not better, or which figures decided instead of the first; empty if there
    /// is nothing to explain.
    pub reason: String,
    /// The suite whose results decide.
    pub suite: Option<String>,
    /// The paper's numbers in words; empty if it has none.
    pub printed: String,
    /// The cases with the authors' programs in words; empty if their results decide none.
    pub authors: String,
    /// The cases in words.
    #[serde(skip)]
    pub(crate) shown: String,
    #[serde(skip)]
    pub(super) remark: Option<String>,
    #[serde(skip)]
    pub(super) counting: Option<String>,
    #[serde(skip)]
    pub(super) takes: Option<String>,
}

/// The claims of a paper with their verdicts.
#[derive(Clone, Debug)]
pub struct JudgedPaper {
    /// The paper's number.
    pub paper: String,
    /// Authors, year and subject.
    pub title: String,
    /// The claims in the order of the file.
    pub claims: Vec<JudgedClaim>,
}

/// Verdicts on the claims of several papers.
#[derive(Clone, Debug)]
pub struct ClaimsReport {
    /// The papers.
    pub papers: Vec<JudgedPaper>,
    /// The results that were used, one line for each run: date, commit, machine, suites.
    pub(super) sources: Vec<String>,
    /// Warnings, one line each.
    pub notes: Vec<String>,
}

/// A value and whether the claim holds for it.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ClaimCase {
    /// The figure of the value.
    pub figure: String,
    /// The value; null if there is none.
    pub value: Option<f64>,
    /// Its 95 % interval; null for counts, and if there are too few samples.
    pub ci95: Option<[f64; 2]>,
    /// Whether the claim holds; null if the value does not decide.
    pub holds: Option<bool>,
    /// Whether the size agrees with the paper's numbers; null if there are none.
    pub fits: Option<bool>,
    /// Why the first figure did not decide; null if it did.
    pub reason: Option<String>,
    /// For a growth, the range of the axis: number of faces, anisotropy or number of sources.
    pub range: Option<[f64; 2]>,
    /// The expression: the algorithm, or a ratio of two. For pages.
    #[serde(skip)]
    pub(super) of: String,
    /// The model or models. For pages.
    #[serde(skip)]
    pub(super) on: String,
}

impl ClaimCase {
    /// An undecided case.
    pub(super) fn open(figure: &str, on: &str) -> Self {
        Self {
            figure: figure.to_owned(),
            value: None,
            ci95: None,
            holds: None,
            fits: None,
            reason: None,
            range: None,
            of: String::new(),
            on: on.to_owned(),
        }
    }
}
