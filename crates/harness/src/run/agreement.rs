//! Clusters of agreeing answers, to detect a wrong reference.
//!
//! The answers for one model and source are put into clusters. An answer joins the first cluster
//! whose first answer it agrees with. Cluster 0 is that of the reference. If most answers are in
//! another cluster, the reference is probably wrong; a [proof](crate::run::proof) decides it.

use std::collections::{BTreeMap, BTreeSet};

use geobench_registry as registry;

use crate::run::check::Deviation;
use crate::run::proof::{BOUNDS, is_certificate, is_proof};
use crate::schema::Cell;

/// The first answer of each cluster except cluster 0.
#[derive(Debug, Default)]
pub struct Clusters {
    /// Distances by cluster, from cluster 1 on. `None` if the answer was given before an
    /// interruption and could not be restored.
    first: Vec<Option<Vec<f64>>>,
}

impl Clusters {
    /// Adds a cluster of an answer that agrees with no other, and returns its number.
    pub fn add(&mut self, distances: &[f64]) -> u32 {
        self.first.push(Some(distances.to_vec()));
        self.first.len() as u32
    }

    /// The first answer of a cluster other than that of the reference.
    pub fn first(&self, cluster: u32) -> Option<&Vec<f64>> {
        let index = (cluster as usize).checked_sub(1)?;
        self.first.get(index)?.as_ref()
    }

    /// The first answers of the clusters, in their order.
    pub(crate) fn into_first(self) -> Vec<Option<Vec<f64>>> {
        self.first
    }

    /// The first cluster for whose first answer `agrees` returns true.
    pub fn find(&self, mut agrees: impl FnMut(&[f64]) -> bool) -> Option<u32> {
        let index = self.first.iter().position(|first| match first {
            Some(first) => agrees(first),
            None => false,
        });
        index.map(|index| index as u32 + 1)
    }

    /// The number that the next new cluster will have.
    pub fn next(&self) -> u32 {
        self.first.len() as u32 + 1
    }

    /// Sets the first answer of a cluster from before an interruption. Cluster 0 is ignored.
    pub fn restore(&mut self, cluster: u32, distances: Option<Vec<f64>>) {
        let Some(index) = (cluster as usize).checked_sub(1) else {
            return;
        };
        if self.first.len() <= index {
            self.first.resize(index + 1, None);
        }
        self.first[index] = distances;
    }
}

/// One answer and its cluster.
#[derive(Clone, Debug)]
pub struct Vote {
    /// Name of the algorithm or path of the file.
    pub name: String,
    /// Whether the answer was read from a file.
    pub is_file: bool,
    /// The cluster, 0 for that of the reference.
    pub cluster: u32,
    /// Largest relative difference from the reference; `None` if it is not finite.
    pub max_rel: Option<f64>,
    /// The vertex with that difference, if the answer does not agree with the reference.
    pub worst_vertex: Option<u64>,
}

impl Vote {
    /// The answer of the reference itself.
    pub fn of_reference(name: &str, is_file: bool) -> Self {
        Self {
            name: name.to_owned(),
            is_file,
            cluster: REFERENCE,
            max_rel: Some(0.0),
            worst_vertex: None,
        }
    }

    /// Stores the comparison with the reference.
    pub fn compared(&mut self, comparison: &Deviation) {
        self.max_rel = Some(comparison.max_rel).filter(|size| size.is_finite());
        self.worst_vertex = comparison.worst.map(|worst| worst.vertex as u64);
    }
}

/// The cluster of the reference.
pub const REFERENCE: u32 = 0;

/// The answers for one model and source, by cluster.
struct Ballot<'v> {
    votes: &'v [Vote],
    clusters: BTreeMap<u32, Vec<&'v Vote>>,
}

/// Describes the clusters in a single line. `None` if all answers agree.
pub fn summary(votes: &[Vote]) -> Option<String> {
    Ballot::of(votes).map(|ballot| ballot.summary())
}

impl<'v> Ballot<'v> {
    /// Groups the answers. `None` if all are in one cluster.
    fn of(votes: &'v [Vote]) -> Option<Self> {
        let mut clusters: BTreeMap<u32, Vec<&Vote>> = BTreeMap::new();
        for vote in votes {
            clusters.entry(vote.cluster).or_default().push(vote);
        }
        (clusters.len() > 1).then_some(Self { votes, clusters })
    }

    /// What the answers are called: `algorithms`, or `answers` if files are among them.
    fn noun(&self) -> &'static str {
        if self.votes.iter().any(|vote| vote.is_file) {
            "answers"
        } else {
            "algorithms"
        }
    }

    fn reference(&self) -> Option<&'v Vote> {
        let cluster = self.clusters.get(&REFERENCE)?;
        cluster.first().copied()
    }

    fn size(&self, cluster: u32) -> usize {
        self.clusters.get(&cluster).map_or(0, Vec::len)
    }

    /// The cluster that has more than half of the answers, if one has.
    fn majority(&self) -> Option<u32> {
        let mut clusters = self.clusters.keys().copied();
        clusters.find(|&cluster| 2 * self.size(cluster) > self.votes.len())
    }

    fn summary(&self) -> String {
        let (all, noun) = (self.votes.len(), self.noun());
        let Some(majority) = self.majority() else {
            let either = if all == 2 { "either" } else { "any of them" };
            let clusters: Vec<String> = self.clusters.keys().map(|&c| self.described(c)).collect();
            return format!(
                "no majority among the {all} {noun}, {either} may be wrong: {}",
                clusters.join("; ")
            );
        };
        let size = self.size(majority);
        let mut parts = vec![match (self.reference(), majority) {
            (None, _) => format!("{size} of {all} {noun} agree with each other"),
            (Some(vote), REFERENCE) => format!(
                "{size} of {all} {noun} agree with each other, the reference `{}` among them",
                vote.name
            ),
            (Some(vote), _) => {
                let apart = if self.size(REFERENCE) == 1 {
                    format!(
                        "{size} of {all} {noun} agree with each other; the reference `{}` is the \
                         odd one out: it",
                        vote.name
                    )
                } else {
                    format!(
                        "{size} of {all} {noun} agree with each other and not with the reference \
                         `{}`: it",
                        vote.name
                    )
                };
                let how = self.difference(majority);
                let how = how.map_or_else(String::new, |how| format!(" by up to {how}"));
                format!("{apart} differs from them{how}")
            }
        }];
        let others = self.clusters.keys().copied().filter(|&c| c != majority);
        parts.extend(
            others
                .filter(|&c| c != REFERENCE || self.size(c) > 1)
                .map(|c| self.described(c)),
        );
        parts.join("; ")
    }

    /// Names the answers of a cluster and their largest difference from the reference.
    fn described(&self, cluster: u32) -> String {
        let members = &self.clusters[&cluster];
        let names = names(members);
        let what = match (cluster, self.reference()) {
            (REFERENCE, Some(reference)) if members.len() == 1 => {
                return format!("the reference `{}`", reference.name);
            }
            (REFERENCE, Some(reference)) => {
                let others = self::names(&members[1..]);
                let agree = if members.len() == 2 {
                    "agrees"
                } else {
                    "agree"
                };
                return format!("{others} {agree} with the reference `{}`", reference.name);
            }
            _ if members.len() == 1 => names,
            _ => format!("{names} agree with each other"),
        };
        match (self.reference(), self.difference(cluster)) {
            (Some(reference), Some(how)) => {
                let verb = match members.len() {
                    1 => " differs",
                    _ => " and differ",
                };
                format!("{what}{verb} from `{}` by up to {how}", reference.name)
            }
            _ if members.len() == 1 => format!("{what} agrees with no other"),
            _ => what,
        }
    }

    /// Largest difference of a cluster from the reference, with its vertex. `None` without an
    /// answer of the reference or without such a vertex.
    fn difference(&self, cluster: u32) -> Option<String> {
        self.reference()?;
        let size = |vote: &&&Vote| vote.max_rel.unwrap_or(f64::INFINITY);
        let members = self.clusters[&cluster].iter();
        let worst = members.max_by(|a, b| size(a).total_cmp(&size(b)))?;
        let vertex = worst.worst_vertex?;
        Some(match worst.max_rel {
            Some(relative) => format!("{relative:.3e} relative, at vertex {vertex}"),
            None => format!("an infinite distance, at vertex {vertex}"),
        })
    }

    /// Addition to the message of a cell in `cluster`: the sizes of this cluster and of that of the
    /// reference.
    fn remark(&self, cluster: u32) -> String {
        let (all, noun) = (self.votes.len(), self.noun());
        let this = format!("{} with this one", self.size(cluster));
        let mut text = if cluster != REFERENCE && self.reference().is_some() {
            let expected = self.size(REFERENCE);
            format!("{all} {noun}: {expected} with the reference's answer, {this}")
        } else {
            format!("{all} {noun}: {this}")
        };
        text += match self.majority() {
            None => ", no majority",
            Some(majority) if majority != REFERENCE && self.size(REFERENCE) == 1 => {
                ", the reference is the odd one out"
            }
            Some(_) => "",
        };
        text
    }
}

/// The names as an enumeration: `a`, `b` and `c`, each in backquotes.
fn names(votes: &[&Vote]) -> String {
    let names: Vec<String> = votes
        .iter()
        .map(|vote| format!("`{}`", vote.name))
        .collect();
    match &names[..] {
        [] => String::new(),
        [one] => one.clone(),
        [init @ .., last] => format!("{} and {last}", init.join(", ")),
    }
}

/// The answers of `cells`, which share a model and source. That of the reference comes first.
fn votes(cells: &[Cell]) -> Vec<Vote> {
    // Proven distances take the place of a refuted reference.
    let mut references = cells
        .iter()
        .filter_map(|cell| cell.check.reference.as_deref());
    let first = references.clone().next();
    let reference = references.find(|name| is_proof(name)).or(first);
    let mut votes = Vec::new();
    // Bounds are no answer.
    if let Some(name) = reference.filter(|&name| name != BOUNDS) {
        votes.push(Vote::of_reference(
            name,
            registry::select_one(name).is_err(),
        ));
    }
    let others = cells
        .iter()
        .filter(|cell| Some(&*cell.algorithm) != reference);
    votes.extend(others.filter_map(|cell| {
        Some(Vote {
            name: cell.algorithm.clone(),
            is_file: false,
            cluster: cell.check.cluster?,
            max_rel: cell.check.max_rel,
            worst_vertex: cell.check.worst_vertex,
        })
    }));
    votes
}

/// Appends to the messages of `cells`, which share a model and source, which answers agree. Cells
/// outside the cluster of the reference get the sizes of both clusters. The cell of the reference
/// gets a description of all clusters, unless its own has the majority. If all answers agree,
/// nothing changes.
pub(crate) fn explain(cells: &mut [Cell]) {
    let votes = votes(cells);
    let Some(ballot) = Ballot::of(&votes) else {
        return;
    };
    let trusted = ballot.majority() == Some(REFERENCE);
    for cell in cells {
        let is_reference = cell.check.reference.as_deref() == Some(&cell.algorithm);
        let addition = match cell.check.cluster {
            Some(_) if is_reference && !trusted => ballot.summary(),
            Some(cluster) if !is_reference && cluster != REFERENCE => {
                let proven = cell.check.proven.map_or("", |_| "; proven wrong");
                ballot.remark(cluster) + proven
            }
            _ => continue,
        };
        cell.message = Some(match cell.message.take() {
            Some(message) => format!("{message}; {addition}"),
            None => addition,
        });
    }
}

/// What a proof says about the answers of `cells`, which share a model and source. `None` if none
/// was sought.
fn decision(cells: &[Cell]) -> Option<String> {
    let proof = cells.iter().find_map(|cell| cell.check.proof.as_ref())?;
    let is_left = |cell: &&Cell| cell.check.cluster.is_some() && cell.check.proven.is_none();
    let names = |of: &dyn Fn(&&Cell) -> bool| -> Vec<&str> {
        let cells = cells.iter().filter(of);
        cells.map(|cell| cell.algorithm.as_str()).collect()
    };
    let [right, wrong] = [true, false].map(|is| names(&|cell| cell.check.proven == Some(is)));
    let reference = cells
        .iter()
        .find_map(|cell| cell.check.reference.as_deref());
    let has_bounds = reference == Some(BOUNDS);
    let left = names(&is_left);
    if !has_bounds && right.is_empty() && wrong.is_empty() {
        return Some(proof.clone());
    }
    // The reference beside these answers is right itself, within the bounds, or is the proof.
    let reference = reference.filter(|&name| {
        !has_bounds
            && !is_certificate(name)
            && cells.iter().all(|cell| cell.algorithm.as_str() != name)
    });
    if !has_bounds && left.is_empty() {
        return Some(proven_right(reference.into_iter().chain(right)));
    }
    let groups = cells.iter().filter(is_left);
    let groups = groups.filter_map(|cell| cell.check.cluster);
    let groups: BTreeSet<u32> = groups.chain(reference.map(|_| REFERENCE)).collect();
    let left: Vec<&str> = reference.into_iter().chain(left).collect();
    let what = within_bounds(&wrong, &left, groups.len());
    Some(format!("{proof}; {what}"))
}

/// Names the answers outside of proven bounds, and those within, which form this many groups.
pub fn within_bounds(wrong: &[&str], left: &[&str], groups: usize) -> String {
    let mut parts = Vec::new();
    if !wrong.is_empty() {
        parts.push(format!("proven wrong: {}", wrong.join(", ")));
    }
    let left = left.join(", ");
    parts.push(match groups {
        0 => "no answer is within the proven bounds".to_owned(),
        1 => format!("not refuted, a single group: {left}"),
        _ => format!("not refuted, {groups} groups that disagree: {left}"),
    });
    parts.join("; ")
}

/// Names the answers that are proven right.
pub fn proven_right<'n>(names: impl Iterator<Item = &'n str>) -> String {
    let names: Vec<&str> = names.collect();
    if names.is_empty() {
        return "no answer agrees with the proven distances".to_owned();
    }
    format!("proven right: {}", names.join(", "))
}

/// One line for each model and source of `cells` whose answers disagree, or whose reference is
/// proven wrong: which of them agree, and which are proven right. Cells of the same model and
/// source must be adjacent.
pub fn summaries(cells: &[Cell]) -> Vec<String> {
    let same = |a: &Cell, b: &Cell| (&a.model, &a.source) == (&b.model, &b.source);
    let summary = |cells: &[Cell]| {
        let first = cells.first()?;
        let replaced = cells.iter().find_map(|cell| cell.check.replaced.as_ref());
        let replaced = replaced.map(|name| format!("the reference `{name}` is proven wrong"));
        let parts = [replaced, summary(&votes(cells)), decision(cells)];
        let parts: Vec<String> = parts.into_iter().flatten().collect();
        if parts.is_empty() {
            return None;
        }
        let source = first
            .source
            .as_ref()
            .map_or_else(String::new, |s| format!(", source {s}"));
        Some(format!("{}{source}: {}", first.model, parts.join("; ")))
    };
    cells.chunk_by(same).filter_map(summary).collect()
}

#[cfg(test)]
mod tests {
    use geobench_mesh::Tolerance;

    use super::*;
    use crate::run::answer_layout::AnswerLayout;

    /// `mmp` and others, each with its cluster; the reference is `mmp`.
    fn votes(others: &[(&str, u32)]) -> Vec<Vote> {
        let mut votes = vec![Vote::of_reference("mmp", false)];
        votes.extend(others.iter().map(|&(name, cluster)| Vote {
            name: name.to_owned(),
            is_file: false,
            cluster,
            max_rel: Some(0.25 * f64::from(cluster)),
            worst_vertex: (cluster > 0).then_some(7),
        }));
        votes
    }

    fn said(others: &[(&str, u32)]) -> String {
        summary(&votes(others)).unwrap()
    }

    #[test]
    fn agreement_is_quiet() {
        assert_eq!(summary(&votes(&[])), None);
        assert_eq!(summary(&votes(&[("ich", 0), ("vtp", 0)])), None);
        assert_eq!(summary(&votes(&[("ich", 1), ("vtp", 1)])[1..]), None);
    }

    #[test]
    fn a_reference_against_all_others_is_the_odd_one_out() {
        assert_eq!(
            said(&[("ich", 1), ("vtp", 1)]),
            "2 of 3 algorithms agree with each other; the reference `mmp` is the odd one out: \
             it differs from them by up to 2.500e-1 relative, at vertex 7"
        );
        assert_eq!(
            said(&[("ich", 1), ("vtp", 1), ("ch", 1), ("ftp", 2)]),
            "3 of 5 algorithms agree with each other; the reference `mmp` is the odd one out: \
             it differs from them by up to 2.500e-1 relative, at vertex 7; \
             `ftp` differs from `mmp` by up to 5.000e-1 relative, at vertex 7"
        );
        assert_eq!(
            said(&[("ich", 1), ("vtp", 1), ("ch", 1), ("ftp", 0)]),
            "3 of 5 algorithms agree with each other and not with the reference `mmp`: \
             it differs from them by up to 2.500e-1 relative, at vertex 7; \
             `ftp` agrees with the reference `mmp`"
        );
        let mut votes = votes(&[("ich", 1), ("vtp", 1)]);
        votes[2].max_rel = None;
        let said = summary(&votes).unwrap();
        assert!(said.ends_with("differs from them by up to an infinite distance, at vertex 7"));
    }

    #[test]
    fn those_that_are_wrong_are_named() {
        assert_eq!(
            said(&[("ich", 0), ("vtp", 1)]),
            "2 of 3 algorithms agree with each other, the reference `mmp` among them; \
             `vtp` differs from `mmp` by up to 2.500e-1 relative, at vertex 7"
        );
        assert_eq!(
            said(&[("ich", 0), ("vtp", 1), ("ftp", 1), ("ch", 0)]),
            "3 of 5 algorithms agree with each other, the reference `mmp` among them; \
             `vtp` and `ftp` agree with each other and differ from `mmp` by up to 2.500e-1 \
             relative, at vertex 7"
        );
    }

    #[test]
    fn half_is_no_majority() {
        assert_eq!(
            said(&[("ich", 1)]),
            "no majority among the 2 algorithms, either may be wrong: the reference `mmp`; \
             `ich` differs from `mmp` by up to 2.500e-1 relative, at vertex 7"
        );
        assert_eq!(
            said(&[("ich", 0), ("vtp", 1), ("ftp", 1)]),
            "no majority among the 4 algorithms, any of them may be wrong: \
             `ich` agrees with the reference `mmp`; `vtp` and `ftp` agree with each other and \
             differ from `mmp` by up to 2.500e-1 relative, at vertex 7"
        );
    }

    #[test]
    fn without_an_answer_of_the_reference_the_others_are_compared_all_the_same() {
        let votes = votes(&[("ich", 1), ("vtp", 1), ("ftp", 2)]);
        assert_eq!(
            summary(&votes[1..]).unwrap(),
            "2 of 3 algorithms agree with each other; `ftp` agrees with no other"
        );
    }

    #[test]
    fn answers_join_the_first_cluster_that_they_agree_with() {
        let rule = Tolerance::relative(1e-9);
        let layout = AnswerLayout::default();
        let assign = |clusters: &mut Clusters, distances: &[f64]| {
            let known = clusters.find(|first| layout.agrees(distances, first, &rule));
            known.unwrap_or_else(|| clusters.add(distances))
        };
        let mut clusters = Clusters::default();
        assert_eq!(assign(&mut clusters, &[0.0, 1.0]), 1);
        assert_eq!(assign(&mut clusters, &[0.0, 2.0]), 2);
        assert_eq!(assign(&mut clusters, &[0.0, 1.0 + 1e-12]), 1);
        // Answers with another number of vertices or with NaN agree with nothing.
        assert_eq!(assign(&mut clusters, &[0.0]), 3);
        assert_eq!(assign(&mut clusters, &[0.0, f64::NAN]), 4);
        assert_eq!(assign(&mut clusters, &[0.0, f64::NAN]), 5);
        let mut later = Clusters::default();
        later.restore(2, Some(vec![5.0]));
        later.restore(0, None);
        assert_eq!(assign(&mut later, &[5.0]), 2);
        assert_eq!(assign(&mut later, &[6.0]), 3);
    }
}
