//! Proofs that decide which of several disagreeing answers are right.

use geobench_registry::CERTIFICATE;
use serde::{Deserialize, Serialize};

use crate::exec::Failure;
use crate::schema::Check;

/// The largest model that is proven unasked. A proof takes about ten times as long as a run of
/// `mmp`: at this size seconds, and minutes where faces are slender. The limits of runs apply.
pub const MOST_FACES: u64 = 50_000;

/// Whether `reference` is the certificate, with any parameters.
pub(crate) fn is_certificate(reference: &str) -> bool {
    reference
        .strip_prefix(CERTIFICATE)
        .is_some_and(|rest| rest.is_empty() || rest.starts_with('{'))
}

/// The name of proven bounds in the place of a reference.
pub const BOUNDS: &str = "proven bounds";

/// Whether the reference of this name is a proof that has taken the place of another reference.
pub(crate) fn is_proof(reference: &str) -> bool {
    [CERTIFICATE, BOUNDS].contains(&reference)
}

/// Why a model with this number of faces is not proven unasked; `None` if it is.
pub fn too_large(faces: Option<u64>) -> Option<String> {
    let faces = faces.filter(|&faces| faces > MOST_FACES)?;
    Some(format!(
        "the model has {faces} faces; up to {MOST_FACES} are proven unasked"
    ))
}

/// The words where disagreeing answers are not decided.
pub fn nothing_proven(why: &str) -> String {
    format!("nothing is proven: {why}")
}

/// What a proof says about the disagreeing answers for one model and source.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub(crate) enum Decision {
    /// The reference of this name is right.
    Confirmed(String),
    /// The reference is wrong or failed. The proven distances took its place.
    Replaced {
        /// Name of a wrong reference; null if it failed.
        reference: Option<String>,
        /// The groups of answers so far.
        groups: Vec<RevisedGroup>,
        /// Set if proven bounds took its place: why there are no proven distances.
        #[serde(default)]
        why: Option<String>,
    },
    /// No distances are proven, for this reason. The reference is within the proven bounds.
    Unrefuted(String),
    /// There is no proof, for this reason.
    Undecided(String),
}

/// A group of agreeing answers, compared with proven distances.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct RevisedGroup {
    /// Its number beside the refuted reference.
    pub(crate) before: u32,
    /// The comparison with the proven distances, with its number beside these.
    pub(crate) check: Check,
    /// Set if its answers are wrong.
    pub(crate) failure: Option<Failure>,
}

impl Decision {
    /// The entries of a cell: whether it is proven right, by which proof, and which reference the
    /// proof has replaced. A cell without a group gets no verdict.
    pub(crate) fn describe(&self, check: &mut Check) {
        let (text, replaced) = match self {
            Self::Confirmed(reference) => (
                format!("{CERTIFICATE}: the reference {reference} is right"),
                None,
            ),
            Self::Replaced {
                reference: Some(wrong),
                groups,
                why,
            } => {
                let of_reference = groups.iter().find(|group| group.before == 0);
                let how = of_reference.and_then(|group| group.failure.as_ref());
                let how = how.map_or_else(String::new, |how| format!(": {}", how.message));
                let by = match why {
                    Some(why) => format!("{BOUNDS}, since {why}"),
                    None => CERTIFICATE.to_owned(),
                };
                (
                    format!("{by}: the reference {wrong} is wrong{how}"),
                    Some(wrong.clone()),
                )
            }
            Self::Replaced {
                reference: None,
                why: None,
                ..
            } => (format!("{CERTIFICATE}, since the reference failed"), None),
            Self::Replaced { why: Some(why), .. } | Self::Unrefuted(why) | Self::Undecided(why) => {
                (nothing_proven(why), None)
            }
        };
        // Where there are bounds only, the comparison with them has set it.
        if !matches!(
            self,
            Self::Unrefuted(_) | Self::Replaced { why: Some(_), .. }
        ) {
            let is_decided = !matches!(self, Self::Undecided(_));
            check.proven = check.cluster.filter(|_| is_decided).map(|group| group == 0);
        }
        check.proof = Some(text);
        check.replaced = replaced;
    }
}
