//! Sums of violations along chains of links.

use geobench_mesh::FaceId;

use crate::side_pair::ChainLink;

/// For each node, the greatest sum of violations on a chain of links that ends in it.
///
/// A chain that passes node `n` adds `own[n]`. A chain that crosses face `f` adds `in_face[f]`. A
/// chain crosses each face once, and passes each node in one run. On a cycle the order is unknown,
/// so all nodes of a strongly connected component, and all faces between them, add up.
pub(crate) fn greatest_sums(own: &[f64], links: &[ChainLink], in_face: &[f64]) -> Vec<f64> {
    let graph = Graph::new(own.len(), links);
    let (component, order) = graph.components();
    let count = order
        .last()
        .map_or(0, |&n| component[n as usize] as usize + 1);
    // The sum of each component: of its nodes, and of the faces that its inner links cross.
    let mut loss = vec![0.0; count];
    for (n, &lost) in own.iter().enumerate() {
        loss[component[n] as usize] += lost;
    }
    let inside = |link: &&ChainLink| component[link.from as usize] == component[link.to as usize];
    let inside = links.iter().filter(inside);
    let mut inside: Vec<(u32, u32)> = inside
        .map(|link| (component[link.from as usize], link.face.raw()))
        .collect();
    inside.sort_unstable();
    inside.dedup();
    for (component, face) in inside {
        loss[component as usize] += in_face[face as usize];
    }
    // Component numbers grow from the ends of chains to their beginnings.
    let mut before = vec![0.0_f64; count];
    for n in order.into_iter().rev() {
        let here = component[n as usize] as usize;
        let sum = before[here] + loss[here];
        for link in graph.of(n) {
            let there = component[link.to as usize] as usize;
            if there != here {
                before[there] = before[there].max(sum + in_face[link.face.index()]);
            }
        }
    }
    let sum = |&c: &u32| before[c as usize] + loss[c as usize];
    component.iter().map(sum).collect()
}

/// The outgoing links of each node.
struct Graph {
    starts: Vec<usize>,
    links: Vec<OutLink>,
}

/// The target of a link, and the face that it crosses.
#[derive(Clone, Copy)]
struct OutLink {
    to: u32,
    face: FaceId,
}

impl Graph {
    /// Counting sort by the node that a link leaves. O(nodes + links).
    fn new(nodes: usize, links: &[ChainLink]) -> Self {
        let mut starts = vec![0; nodes + 1];
        for link in links {
            starts[link.from as usize] += 1;
        }
        let mut end = 0;
        for start in &mut starts {
            end += *start;
            *start = end;
        }
        let none = OutLink {
            to: 0,
            face: FaceId::new(0),
        };
        let mut sorted = vec![none; links.len()];
        // Fills the range of each node from its end to its start.
        for link in links.iter().rev() {
            let start = &mut starts[link.from as usize];
            *start -= 1;
            sorted[*start] = OutLink {
                to: link.to,
                face: link.face,
            };
        }
        Self {
            starts,
            links: sorted,
        }
    }

    fn of(&self, n: u32) -> &[OutLink] {
        &self.links[self.starts[n as usize]..self.starts[n as usize + 1]]
    }

    /// The strongly connected component of each node (R. Tarjan, 1972), and the nodes in the order
    /// of their components. A link leads to a component with the same or a lower number.
    fn components(&self) -> (Vec<u32>, Vec<u32>) {
        const NONE: u32 = u32::MAX;
        let nodes = self.starts.len() - 1;
        let mut component = vec![NONE; nodes];
        let mut order = Vec::with_capacity(nodes);
        // Tarjan's index of each node in order of discovery, and its low-link.
        let (mut met, mut low) = (vec![NONE; nodes], vec![0; nodes]);
        let (mut next_met, mut next_component) = (0, 0);
        let mut open: Vec<u32> = Vec::new();
        // The depth-first stack: each node with the number of its links that are done.
        let mut path: Vec<(u32, usize)> = Vec::new();
        for root in 0..nodes as u32 {
            if met[root as usize] != NONE {
                continue;
            }
            path.push((root, 0));
            while let Some((n, done)) = path.pop() {
                let i = n as usize;
                if done == 0 {
                    met[i] = next_met;
                    low[i] = next_met;
                    next_met += 1;
                    open.push(n);
                }
                if let Some(link) = self.of(n).get(done) {
                    let to = link.to as usize;
                    if met[to] == NONE {
                        // Looks at this link again after the target is done. The target then has an
                        // index.
                        path.push((n, done + 1));
                        path.push((link.to, 0));
                        continue;
                    }
                    if component[to] == NONE {
                        low[i] = low[i].min(met[to]);
                    }
                    path.push((n, done + 1));
                    continue;
                }
                if low[i] == met[i] {
                    while let Some(member) = open.pop() {
                        component[member as usize] = next_component;
                        order.push(member);
                        if member == n {
                            break;
                        }
                    }
                    next_component += 1;
                }
                if let Some(&(parent, _)) = path.last() {
                    let parent = parent as usize;
                    low[parent] = low[parent].min(low[i]);
                }
            }
        }
        (component, order)
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn link(from: u32, to: u32, face: u32) -> ChainLink {
        ChainLink {
            from,
            to,
            face: FaceId::new(face),
            excess: 0.0,
        }
    }

    #[test]
    fn losses_add_up_along_the_worst_chain() {
        let links = [link(0, 1, 0), link(1, 2, 1), link(0, 2, 2)];
        let sums = greatest_sums(&[0.5, 0.0, 0.0], &links, &[1.0, 2.0, 4.0]);
        assert_eq!(sums, [0.5, 1.5, 4.5]);
    }

    #[test]
    fn a_cycle_loses_each_of_its_faces_once() {
        let links = [link(0, 1, 0), link(1, 0, 0), link(0, 1, 1), link(1, 2, 2)];
        let sums = greatest_sums(&[0.25, 0.0, 0.0], &links, &[1.0, 2.0, 4.0]);
        assert_eq!(sums, [3.25, 3.25, 7.25]);
    }

    /// Reference by exhaustive search: the greatest sum on a chain that ends in `n`, each face
    /// once.
    fn greatest(n: u32, links: &[ChainLink], in_face: &[f64], used: u32) -> f64 {
        let before = links.iter().filter(|link| link.to == n);
        let unused = before.filter(|link| used & (1 << link.face.raw()) == 0);
        unused
            .map(|link| {
                let face = link.face.raw();
                in_face[face as usize] + greatest(link.from, links, in_face, used | (1 << face))
            })
            .fold(0.0, f64::max)
    }

    proptest! {
        #[test]
        fn no_chain_loses_more(
            ends in prop::collection::vec((0..6u32, 0..6u32, 0..8u32), 0..10),
        ) {
            let ends = ends.into_iter().filter(|(from, to, _)| from != to);
            let links: Vec<ChainLink> = ends.map(|(from, to, face)| link(from, to, face)).collect();
            let in_face: Vec<f64> = (0..8).map(|i| f64::from(1 << i)).collect();
            let sums = greatest_sums(&[0.0; 6], &links, &in_face);
            for n in 0..6 {
                prop_assert!(sums[n as usize] >= greatest(n, &links, &in_face, 0));
            }
        }
    }
}
