//! Flaws of a dual that is not a triangulation of its surface.

use std::collections::{BTreeMap, BTreeSet, HashMap};

use crate::diagram::{Diagram, Dual, Obstacle};

/// Cells at which the dual is not a triangulation, so that another site is needed.
#[derive(Clone, Debug, Default)]
pub(super) struct Flaws {
    /// The cells.
    pub(super) cells: BTreeSet<u32>,
    /// The first flaw, in words; `None` if there is none.
    pub(super) reason: Option<String>,
}

impl Flaws {
    /// The flaws of `dual`: its obstacles, triangles with the same corners, sites whose triangles
    /// do not form a ring or a fan, and pairs of cells whose border runs from boundary to boundary.
    /// Such a border has no Voronoi vertex, so no triangle connects the sites.
    pub(super) fn of(diagram: &Diagram, dual: &Dual) -> Self {
        let mut flaws = Self::default();
        for obstacle in &dual.obstacles {
            let cells = match *obstacle {
                Obstacle::NoDisc { cell, .. }
                | Obstacle::NoTriangle { cell }
                | Obstacle::TwiceAtVertex { cell, .. } => vec![cell],
                Obstacle::SeveralBorders { cells } => cells.to_vec(),
            };
            flaws.add(cells, || obstacle.to_string());
        }
        let mut seen: HashMap<[u32; 3], u32> = HashMap::new();
        let mut links: BTreeMap<u32, Vec<[u32; 2]>> = BTreeMap::new();
        for &corners in &dual.triangles {
            let mut sorted = corners;
            sorted.sort_unstable();
            let count = seen.entry(sorted).or_default();
            *count += 1;
            if *count == 2 {
                let [a, b, c] = sorted;
                flaws.add(corners.to_vec(), || {
                    format!("cells {a}, {b} and {c} meet in several places")
                });
            }
            let [a, b, c] = corners;
            for (at, link) in [(a, [b, c]), (b, [c, a]), (c, [a, b])] {
                links.entry(at).or_default().push(link);
            }
        }
        for (cell, found) in (0..).zip(diagram.cells()) {
            let link = links.get(&cell).map_or(&[][..], Vec::as_slice);
            for &other in &found.neighbours {
                if !link.as_flattened().contains(&other) {
                    flaws.add(vec![cell, other], || {
                        format!("cells {cell} and {other} share a border with no Voronoi vertex")
                    });
                }
            }
            match links.get(&cell) {
                Some(link) if !is_ring_or_fan(link) => flaws.add(vec![cell], || {
                    format!("the triangles at site {cell} are no ring or fan")
                }),
                // Without triangles, the cell is an obstacle.
                Some(_) | None => {}
            }
        }
        flaws
    }

    fn add(&mut self, cells: Vec<u32>, reason: impl FnOnce() -> String) {
        self.cells.extend(cells);
        self.reason.get_or_insert_with(reason);
    }
}

/// Whether these directed edges form one closed or open line.
fn is_ring_or_fan(link: &[[u32; 2]]) -> bool {
    let next: HashMap<u32, u32> = link.iter().map(|&[a, b]| (a, b)).collect();
    let ends: BTreeSet<u32> = link.iter().map(|&[_, b]| b).collect();
    if next.len() < link.len() || ends.len() < link.len() {
        return false;
    }
    let start = link.iter().map(|&[a, _]| a).find(|a| !ends.contains(a));
    let Some(start) = start.or_else(|| link.first().map(|&[a, _]| a)) else {
        return false;
    };
    let (mut at, mut steps) = (start, 0);
    while let Some(&to) = next.get(&at) {
        at = to;
        steps += 1;
        if at == start || steps > link.len() {
            break;
        }
    }
    steps == link.len()
}

#[cfg(test)]
mod tests {
    use super::is_ring_or_fan;

    #[test]
    fn one_line_is_a_ring_or_a_fan() {
        assert!(is_ring_or_fan(&[[1, 2], [2, 3], [3, 1]]));
        assert!(is_ring_or_fan(&[[2, 3], [1, 2]]));
        assert!(is_ring_or_fan(&[[1, 2]]));
        // Two fans, two rings, a ring and a fan, a fork.
        assert!(!is_ring_or_fan(&[[1, 2], [3, 4]]));
        assert!(!is_ring_or_fan(&[[1, 2], [2, 1], [3, 4], [4, 3]]));
        assert!(!is_ring_or_fan(&[[1, 2], [3, 4], [4, 3]]));
        assert!(!is_ring_or_fan(&[[1, 2], [1, 3]]));
        assert!(!is_ring_or_fan(&[]));
    }
}
