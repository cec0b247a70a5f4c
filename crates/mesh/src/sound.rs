//! A fast path for triangles without defects.
//!
//! Most models are sound. A few passes establish that and build the mesh. If a pass finds anything
//! else, this module returns `None`, and the checks of [`inspection`](crate::inspection) start from
//! the beginning and name every defect. Two notes are made here: isolated vertices and several
//! components.
//!
//! Around each vertex the half-edges that leave it are matched with those that arrive at it. If all
//! of them match and form one fan, every edge has at most two faces, which agree in orientation,
//! and no vertex is pinched.
//!
//! In a thread pool (`rayon`) each pass runs in parallel, with the same result.

use std::collections::BTreeMap;
use std::ops::Range;
use std::sync::Arc;
use std::sync::atomic::{AtomicU32, Ordering};

use crate::build::is_saddle;
use crate::defect::{Defect, LONGEST_EDGE, SHORTEST_EDGE};
use crate::disjoint_sets::DisjointSets;
use crate::frames::{FLAT_HEIGHT, measure};
use crate::ids::{FaceId, HalfEdgeId, VertexId};
use crate::inspection::component_sizes;
use crate::junctions::Junctions;
use crate::mesh::{Extremes, Mesh, MeshData, NO_TWIN, VertexFlags};
use crate::precision::SLIVER_HEIGHT;
use crate::rows::RowTable;
use crate::soup::TriangleSoup;
use crate::stand_ins::StandIns;
use crate::threads;
use crate::vector::column;

/// The data of a sound mesh, without its positions and triangles.
pub(crate) struct Sound {
    pub(crate) twins: Vec<u32>,
    pub(crate) lengths: Vec<[f64; 3]>,
    pub(crate) outgoing_starts: Vec<u32>,
    pub(crate) outgoing: Vec<HalfEdgeId>,
    pub(crate) total_angles: Vec<f64>,
    pub(crate) flags: Vec<VertexFlags>,
    extremes: Extremes,
    /// Defects of severity [`Noted`](crate::Severity::Noted).
    pub(crate) notes: Vec<Defect>,
}

impl Sound {
    /// The data of the mesh; `None` if any triangle is defective or nearly so.
    pub(crate) fn of(soup: &TriangleSoup) -> Option<Self> {
        let (positions, triangles) = (&soup.positions[..], &soup.triangles[..]);
        let fit = positions.len() < NO_TWIN as usize && triangles.len() < NO_TWIN as usize / 3;
        if !fit || triangles.is_empty() || !are_usable(positions.len(), triangles) {
            return None;
        }
        let (outgoing_starts, mut outgoing) = group_by_tail(positions.len(), triangles);
        let shapes = TriangleMeasures::of(positions, triangles)?;
        let mut total_angles = shapes.total_angles;
        let fans = link_fans(
            triangles,
            &outgoing_starts,
            &mut outgoing,
            &shapes.corners,
            &mut total_angles,
        )?;
        let extremes = shapes.extremes;
        let mut flags = fans.flags;
        for face in shapes.slivers {
            for v in triangles[face.index()] {
                flags[v as usize].beside_sliver = true;
            }
        }
        let mut notes = Vec::new();
        let mut copies = soup.copies.iter().map(|copy| copy[0]).peekable();
        for (vertex, range) in outgoing_starts.windows(2).enumerate() {
            if range[0] == range[1] && copies.next_if_eq(&(vertex as u32)).is_none() {
                if !positions[vertex].iter().all(|x| x.is_finite()) {
                    return None;
                }
                let vertex = vertex as u32;
                notes.push(Defect::IsolatedVertex { vertex });
            }
        }
        if !is_connected(fans.nearby, triangles, notes.len() + soup.copies.len()) {
            let triangles = component_sizes(positions.len(), triangles);
            notes.push(Defect::SeveralComponents { triangles });
        }
        Some(Self {
            twins: fans.twins,
            lengths: shapes.lengths,
            outgoing_starts,
            outgoing,
            total_angles,
            flags,
            extremes,
            notes,
        })
    }

    /// Builds the mesh of the positions and triangles that were checked.
    pub(crate) fn into_mesh(
        self,
        positions: Vec<[f64; 3]>,
        triangles: Vec<[u32; 3]>,
        copies: Vec<[u32; 2]>,
    ) -> Mesh {
        let tails = triangles.into_flattened().into_iter();
        let data = MeshData {
            positions,
            tails: tails.map(VertexId::new).collect(),
            twins: self.twins,
            lengths: self.lengths.into_flattened(),
            outgoing_rows: RowTable::of_starts(&self.outgoing_starts),
            outgoing: self.outgoing,
            total_angles: self.total_angles,
            flags: self.flags,
            extremes: self.extremes,
            frames: BTreeMap::new(),
            stand_ins: StandIns {
                copies,
                ..StandIns::default()
            },
            junctions: Junctions::default(),
        };
        Mesh {
            data: Arc::new(data),
        }
    }
}

/// Whether each triangle has three different vertices that exist.
fn are_usable(vertex_count: usize, triangles: &[[u32; 3]]) -> bool {
    let usable = |range: Range<usize>| {
        // Without an early exit, which would prevent vectorisation.
        let mut highest = 0;
        let mut repeats = false;
        for &[a, b, c] in &triangles[range] {
            highest = a.max(b).max(c).max(highest);
            repeats |= a == b || b == c || c == a;
        }
        (highest as usize) < vertex_count && !repeats
    };
    threads::each(threads::ranges(triangles.len(), 4), usable)
        .into_iter()
        .all(|ok| ok)
}

/// The half-edges grouped by tail, ascending in each group, and the start of each group.
fn group_by_tail(vertex_count: usize, triangles: &[[u32; 3]]) -> (Vec<u32>, Vec<HalfEdgeId>) {
    let tails = triangles.as_flattened();
    // Each thread reads all half-edges and takes those that start at its vertices.
    let ranges = threads::ranges(vertex_count, 1);
    let mut starts = vec![0u32; vertex_count + 1];
    let counts = threads::cut(&mut starts, ranges.iter().map(ExactSizeIterator::len));
    let parts = ranges.iter().zip(counts).collect();
    threads::each(parts, |(range, counts)| {
        let first = range.start as u32;
        for &v in tails {
            if let Some(count) = counts.get_mut(v.wrapping_sub(first) as usize) {
                *count += 1;
            }
        }
    });
    let mut total = 0;
    for start in &mut starts {
        total += std::mem::replace(start, total);
    }
    let mut places = starts.clone();
    let mut outgoing = vec![HalfEdgeId::default(); tails.len()];
    let own = |range: &Range<usize>| (starts[range.end] - starts[range.start]) as usize;
    let lists = threads::cut(&mut outgoing, ranges.iter().map(own));
    let places = threads::cut(&mut places, ranges.iter().map(ExactSizeIterator::len));
    let parts = ranges.iter().zip(places.into_iter().zip(lists)).collect();
    threads::each(parts, |(range, (places, list))| {
        let (first, base) = (range.start as u32, starts[range.start]);
        for (h, &v) in tails.iter().enumerate() {
            if let Some(place) = places.get_mut(v.wrapping_sub(first) as usize) {
                list[(*place - base) as usize] = HalfEdgeId::new(h as u32);
                *place += 1;
            }
        }
    });
    (starts, outgoing)
}

/// Measures of the triangles.
struct TriangleMeasures {
    lengths: Vec<[f64; 3]>,
    /// Sum of the angles at each vertex, in the order of half-edges. Not set if `corners` is used.
    total_angles: Vec<f64>,
    /// The angle of each corner; used with several threads.
    corners: Vec<[f64; 3]>,
    /// Slivers.
    slivers: Vec<FaceId>,
    extremes: Extremes,
}

/// Number of triangles that are measured together.
const TOGETHER: usize = 8;

impl TriangleMeasures {
    /// `None` if a triangle may be flat, or an edge is too long, too short or not finite.
    fn of(positions: &[[f64; 3]], triangles: &[[u32; 3]]) -> Option<Self> {
        let ranges = threads::ranges(triangles.len(), 4);
        let mut lengths = vec![[0.0; 3]; triangles.len()];
        let mut total_angles = vec![0.0; positions.len()];
        if let [_] = ranges[..] {
            let (slivers, extremes) =
                measure_all(positions, triangles, 0, &mut lengths, |t, angles| {
                    for (&v, angle) in triangles[t].iter().zip(angles) {
                        total_angles[v as usize] += angle;
                    }
                })?;
            return Some(Self {
                lengths,
                total_angles,
                corners: Vec::new(),
                slivers,
                extremes,
            });
        }
        let mut corners = vec![[0.0; 3]; triangles.len()];
        let sizes = || ranges.iter().map(ExactSizeIterator::len);
        let parts = threads::cut(&mut lengths, sizes())
            .into_iter()
            .zip(threads::cut(&mut corners, sizes()));
        let parts = ranges.iter().zip(parts).collect();
        let found = threads::each(parts, |(range, (lengths, corners))| {
            let first = range.start;
            let own = &triangles[range.clone()];
            measure_all(positions, own, first, lengths, |t, angles| {
                corners[t] = angles;
            })
        });
        let mut all = Self {
            lengths,
            total_angles,
            corners,
            slivers: Vec::new(),
            extremes: Extremes::default(),
        };
        for part in found {
            let (slivers, extremes) = part?;
            all.slivers.extend(slivers);
            all.extremes = all.extremes.with(extremes);
        }
        Some(all)
    }
}

/// Measures `triangles`, whose first one has the number `first`. Returns slivers and extremes, or
/// `None` if a triangle may be flat or has an edge of invalid length.
fn measure_all(
    positions: &[[f64; 3]],
    triangles: &[[u32; 3]],
    first: usize,
    lengths: &mut [[f64; 3]],
    mut take_angles: impl FnMut(usize, [f64; 3]),
) -> Option<(Vec<FaceId>, Extremes)> {
    let mut slivers = Vec::new();
    let mut extremes = Extremes::default();
    let mut corners = [[[0.0; TOGETHER]; 3]; 3];
    for (block, triangles) in triangles.chunks(TOGETHER).enumerate() {
        let base = block * TOGETHER;
        for (i, triangle) in triangles.iter().enumerate() {
            for (corner, &v) in corners.iter_mut().zip(triangle) {
                let position = positions[v as usize];
                for (axis, x) in corner.iter_mut().zip(position) {
                    axis[i] = x;
                }
            }
        }
        let found = measure(&corners);
        for i in 0..triangles.len() {
            let own = column(&found.lengths, i);
            let (longest, twice_area) = (found.longest[i], found.twice_areas[i]);
            let in_range = |l: &f64| (SHORTEST_EDGE..=LONGEST_EDGE).contains(l);
            let upright = twice_area > FLAT_HEIGHT * longest * longest;
            if !(own.iter().all(in_range) && upright) {
                return None;
            }
            if twice_area < SLIVER_HEIGHT * longest * longest {
                slivers.push(FaceId::new((first + base + i) as u32));
            }
            extremes = extremes.with(Extremes::of(longest, twice_area));
            lengths[base + i] = own;
            take_angles(base + i, column(&found.angles, i));
        }
    }
    Some((slivers, extremes))
}

/// The result of linking the fans of all vertices.
struct Fans {
    twins: Vec<u32>,
    flags: Vec<VertexFlags>,
    /// The lowest vertex adjacent to each vertex, or the vertex itself.
    nearby: Vec<u32>,
}

/// Sorts the half-edges that start at each vertex counter-clockwise and pairs all half-edges.
/// `None` if they do not form one fan at each vertex, or if a fan consists of two faces with the
/// same vertices.
fn link_fans(
    triangles: &[[u32; 3]],
    starts: &[u32],
    outgoing: &mut [HalfEdgeId],
    corners: &[[f64; 3]],
    total_angles: &mut [f64],
) -> Option<Fans> {
    let vertices = total_angles.len();
    let twins: Vec<AtomicU32> = (0..outgoing.len())
        .map(|_| AtomicU32::new(NO_TWIN))
        .collect();
    let mut flags = vec![VertexFlags::default(); vertices];
    let mut nearby = vec![0; vertices];
    let ranges = threads::ranges(vertices, 4);
    let sizes = || ranges.iter().map(ExactSizeIterator::len);
    let rings = ranges
        .iter()
        .map(|range| (starts[range.end] - starts[range.start]) as usize);
    let parts = (ranges.iter())
        .zip(threads::cut(outgoing, rings))
        .zip(threads::cut(total_angles, sizes()))
        .zip(threads::cut(&mut flags, sizes()))
        .zip(threads::cut(&mut nearby, sizes()))
        .collect();
    let linked = threads::each(
        parts,
        |((((range, mut outgoing), angles), flags), nearby)| {
            let mut fan = Fan::default();
            for (i, v) in range.clone().enumerate() {
                let degree = (starts[v + 1] - starts[v]) as usize;
                let (ring, rest) = std::mem::take(&mut outgoing).split_at_mut(degree);
                outgoing = rest;
                if ring.is_empty() {
                    nearby[i] = v as u32;
                    continue;
                }
                if !corners.is_empty() {
                    let angle = |h: &HalfEdgeId| corners[h.face().index()][h.corner() as usize];
                    angles[i] = ring.iter().map(angle).sum();
                }
                let Some(open) = fan.link(triangles, ring, &twins) else {
                    return false;
                };
                nearby[i] = fan.lowest().min(v as u32);
                flags[i] = VertexFlags {
                    boundary: open,
                    saddle: is_saddle(angles[i], open),
                    ..VertexFlags::default()
                };
            }
            true
        },
    );
    linked.into_iter().all(|ok| ok).then(|| Fans {
        twins: twins.into_iter().map(AtomicU32::into_inner).collect(),
        flags,
        nearby,
    })
}

/// The half-edges that start at one vertex, in ascending order: the *ring*.
#[derive(Default)]
struct Fan {
    heads: RingEnds,
    apexes: RingEnds,
    /// Indices into the ring, in the order of the fan.
    order: Vec<u32>,
    sorted: Vec<HalfEdgeId>,
}

/// The other vertices of the half-edges of a ring, on one side.
#[derive(Default)]
struct RingEnds {
    list: Vec<u32>,
    /// The vertices, then [`NO_TWIN`], which is no vertex; used for short lists.
    few: [u32; FEW],
    /// The vertices with their indices, sorted; used for longer lists.
    sorted: Vec<(u32, u32)>,
}

/// Length up to which a list is compared as a whole, by vector instructions.
const FEW: usize = 8;

impl RingEnds {
    fn set(&mut self, ends: impl Iterator<Item = u32>) {
        self.list.clear();
        self.list.extend(ends);
        if self.list.len() <= FEW {
            self.few = [NO_TWIN; FEW];
            for (place, &end) in self.few.iter_mut().zip(&self.list) {
                *place = end;
            }
        } else {
            self.sorted.clear();
            self.sorted.extend(self.list.iter().copied().zip(0..));
            self.sorted.sort_unstable();
        }
    }

    /// The only index at which `x` occurs.
    #[inline]
    fn only(&self, x: u32) -> Found {
        let (count, place) = if self.list.len() <= FEW {
            // All bits, since an early exit is hard to predict.
            let mut found = 0u32;
            for (i, &y) in self.few.iter().enumerate() {
                found |= u32::from(x == y) << i;
            }
            (found.count_ones(), found.trailing_zeros())
        } else {
            let first = self.sorted.partition_point(|entry| entry.0 < x);
            let found = self.sorted[first..].iter().take_while(|entry| entry.0 == x);
            let place = self.sorted.get(first).map_or(0, |entry| entry.1);
            (found.count() as u32, place)
        };
        match count {
            0 => Found::Nowhere,
            1 => Found::At(place),
            _ => Found::Often,
        }
    }
}

enum Found {
    Nowhere,
    At(u32),
    Often,
}

impl Fan {
    /// The lowest vertex adjacent to the vertex of the ring.
    fn lowest(&self) -> u32 {
        let beside = self.heads.list.iter().chain(&self.apexes.list);
        beside.copied().min().unwrap_or(NO_TWIN)
    }

    /// Orders an ascending ring as one fan and pairs the half-edges that arrive at its vertex.
    /// Returns whether the fan is open.
    fn link(
        &mut self,
        triangles: &[[u32; 3]],
        ring: &mut [HalfEdgeId],
        twins: &[AtomicU32],
    ) -> Option<bool> {
        let degree = ring.len();
        let corner = |h: &HalfEdgeId, after: [usize; 3]| {
            triangles[h.face().index()][after[h.corner() as usize]]
        };
        self.heads.set(ring.iter().map(|h| corner(h, [1, 2, 0])));
        self.apexes.set(ring.iter().map(|h| corner(h, [2, 0, 1])));
        let open = self.arrange()?;
        if !open && degree == 2 {
            return None;
        }
        self.sorted.clear();
        self.sorted
            .extend(self.order.iter().map(|&i| ring[i as usize]));
        ring.copy_from_slice(&self.sorted);
        for pair in ring.windows(2) {
            twins[pair[0].prev().index()].store(pair[1].raw(), Ordering::Relaxed);
        }
        if !open {
            twins[ring[degree - 1].prev().index()].store(ring[0].raw(), Ordering::Relaxed);
        }
        Some(open)
    }

    /// Finds the order of the fan. A closed fan starts with its first half-edge. Returns whether
    /// the fan is open.
    fn arrange(&mut self) -> Option<bool> {
        let Self {
            heads,
            apexes,
            order,
            ..
        } = self;
        let degree = heads.list.len();
        order.clear();
        order.push(0);
        let mut last = 0;
        let mut open = false;
        loop {
            match heads.only(apexes.list[last as usize]) {
                Found::At(0) => break,
                Found::At(next) if order.len() < degree => last = next,
                Found::Nowhere => {
                    open = true;
                    break;
                }
                _ => return None,
            }
            order.push(last);
        }
        if open {
            order.reverse();
            let mut first = 0;
            loop {
                match apexes.only(heads.list[first as usize]) {
                    Found::At(before) if order.len() < degree => first = before,
                    Found::Nowhere => break,
                    _ => return None,
                }
                order.push(first);
            }
            order.reverse();
        }
        (order.len() == degree).then_some(open)
    }
}

/// Whether all vertices that have a triangle are connected. `isolated` is the number of those that
/// have none. `nearby` gives a vertex adjacent to each, with a lower number if there is one.
fn is_connected(mut nearby: Vec<u32>, triangles: &[[u32; 3]], isolated: usize) -> bool {
    let mut roots = 0;
    for v in 0..nearby.len() {
        let next = nearby[v];
        roots += usize::from(next as usize == v);
        nearby[v] = nearby[next as usize];
    }
    if roots <= isolated + 1 {
        return true;
    }
    let mut parts = DisjointSets::of(nearby);
    for &[a, b, c] in triangles {
        parts.union(a, b);
        parts.union(a, c);
    }
    parts.count() == isolated + 1
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::generate::{Spec, generate};
    use crate::report::Report;
    use crate::{DefectKind, InvalidMesh, SplitMix64};

    /// Whether the fast path accepts the soup. If so, it must give the same mesh as the checks.
    fn is_quick(soup: &TriangleSoup) -> bool {
        let checked = Mesh::from_inspected(soup.clone());
        let Some(mut sound) = Sound::of(soup) else {
            let odd = |kind| {
                !matches!(
                    kind,
                    DefectKind::IsolatedVertex | DefectKind::SeveralComponents
                )
            };
            let (Ok((_, report)) | Err(InvalidMesh { report })) = &checked;
            let mut kinds = report.defects.iter().map(Defect::kind);
            assert!(kinds.any(odd), "{soup:?} is sound");
            return false;
        };
        let (expected, report) = checked.expect("only what is sound is taken");
        assert_eq!(Report::new(std::mem::take(&mut sound.notes)), report);
        let (mut found, mut expected) = (
            (*sound
                .into_mesh(soup.positions.clone(), soup.triangles.clone(), Vec::new())
                .data)
                .clone(),
            (*expected.data).clone(),
        );
        for (a, b) in found.total_angles.iter().zip(&expected.total_angles) {
            assert!((a - b).abs() <= 1e-14 * b, "{a} {b}");
        }
        (found.total_angles, expected.total_angles) = (Vec::new(), Vec::new());
        // Computed from areas of which one has one rounding more.
        let least =
            [&mut found, &mut expected].map(|data| std::mem::take(&mut data.extremes.least_height));
        assert!((least[0] / least[1] - 1.0).abs() < 1e-14);
        assert_eq!(found, expected);
        true
    }

    #[test]
    fn both_ways_lead_to_the_same_mesh_on_random_triangles() {
        let mut random = SplitMix64::new(11);
        let mut quick = 0;
        for _ in 0..100_000 {
            let vertices = 3 + random.below(5);
            let positions = (0..vertices)
                .map(|_| [(); 3].map(|()| random.unit()))
                .collect();
            let count = 1 + random.below(7);
            let triangles = (0..count).map(|_| [(); 3].map(|()| random.below(vertices) as u32));
            let soup = TriangleSoup::new(positions, triangles.collect());
            quick += u32::from(is_quick(&soup));
        }
        assert!(quick > 1000, "{quick}");
    }

    fn generated(spec: &str) -> TriangleSoup {
        generate(&spec.parse::<Spec>().unwrap()).unwrap()
    }

    /// Shuffles triangles and rotates their corners.
    fn shuffled(mut soup: TriangleSoup, random: &mut SplitMix64) -> TriangleSoup {
        for i in (1..soup.triangles.len()).rev() {
            soup.triangles.swap(i, random.below(i + 1));
            soup.triangles[i].rotate_left(random.below(3));
        }
        soup
    }

    #[test]
    fn both_ways_lead_to_the_same_mesh_on_surfaces_with_holes() {
        let mut random = SplitMix64::new(12);
        for spec in [
            "sphere,subdiv=2",
            "torus,faces=300",
            "terrain,n=9,seed=2",
            "grid,n=6",
            // Fans of 9 and of 40 faces.
            "cylinder,slices=9,stacks=2,ends=capped",
            "cylinder,slices=40,stacks=1,ends=capped",
        ] {
            for holes in 0..40 {
                let mut soup = shuffled(generated(spec), &mut random);
                let left = soup.triangles.len().saturating_sub(holes * holes % 97);
                soup.triangles.truncate(left.max(10));
                assert!(is_quick(&soup) || holes > 0, "{spec}");
                // One defect in each.
                let count = soup.triangles.len();
                match random.below(5) {
                    0 => soup.triangles[random.below(count)].swap(0, 1),
                    1 => {
                        let repeated = soup.triangles[random.below(count)][0];
                        soup.triangles[random.below(count)][2] = repeated;
                    }
                    2 => soup.triangles.push(soup.triangles[random.below(count)]),
                    3 => soup.positions[random.below(9)] = soup.positions[9],
                    _ => soup.positions[random.below(9)][1] = f64::NAN,
                }
                is_quick(&soup);
            }
        }
    }

    #[test]
    fn several_threads_build_the_same_mesh() {
        let mut soup = generated("terrain,n=150,seed=1");
        let second = soup
            .triangles
            .iter()
            .map(|t| t.map(|v| v + soup.positions.len() as u32));
        soup.triangles = soup.triangles.iter().copied().chain(second).collect();
        soup.positions = [
            soup.positions.clone(),
            soup.positions.clone(),
            vec![[0.0; 3]; 3],
        ]
        .concat();
        for soup in [soup.clone(), shuffled(soup, &mut SplitMix64::new(13))] {
            let (alone, report) = Mesh::from_soup(soup.clone()).unwrap();
            let kinds: Vec<_> = report.defects.iter().map(Defect::kind).collect();
            assert_eq!(kinds.len(), 5, "{kinds:?}");
            for threads in [2, 3, 16] {
                let pool = rayon::ThreadPoolBuilder::new()
                    .num_threads(threads)
                    .build()
                    .unwrap();
                let (mesh, again) = pool.install(|| Mesh::from_soup(soup.clone())).unwrap();
                assert_eq!(again, report);
                assert_eq!(*mesh.data, *alone.data);
            }
        }
    }
}
