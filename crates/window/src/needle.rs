//! Tips of needles: vertices of such a small angle that windows would wind around them.

use std::f64::consts::PI;

use geobench_mesh::{HalfEdgeId, Mesh, VertexId};

use crate::precision::MARGIN;
use crate::window::Window;

/// The greatest total angle of a needle tip, in radians. A window winds around a wider one at most π/`TIP` = 8 times, which needs no rule.
const TIP: f64 = PI / 8.0;

/// How much wider a fan is taken to be than the sum of its angles, relatively: far more than that sum errs.
const SLACK: f64 = 1e-6;

/// The closed fans of a mesh whose angles are small, found again by the half-edges around them.
///
/// A straight line past a vertex T of total angle θ winds around it up to π/θ times, and its windows with it, while a shortest path
/// never crosses one edge at T twice: the chord between both crossings, of a triangle with the angle θ at T, is longer than the piece of the
/// edge between them. So let a window arrive at an edge with end T, its interval reaching T. The triangle of its source, T and the point x
/// where a ray arrives holds no vertex, since the window sees all points between T and x. The ray has therefore turned around T by the
/// angle of that triangle at T, that between the edge and the source. Less than θ of it may lie before the first edge of the fan that it
/// crossed; if the angle exceeds 2θ, it has crossed that edge twice. Then no ray of the window is part of a shortest path.
#[derive(Clone, Debug, Default)]
pub struct NeedleTips {
    /// By half-edge: the greatest angle that a window may have turned around its tail and its head. Empty if there is no tip at all.
    limits: Vec<[f32; 2]>,
}

impl NeedleTips {
    /// Looks for the tips of `mesh`, whose half-edges have the numbers that `number` gives, all less than `numbers`. O(faces).
    pub fn of(mesh: &Mesh, numbers: usize, number: impl Fn(HalfEdgeId) -> usize) -> Self {
        let mut tips = Self::default();
        for v in mesh.vertices() {
            let wide = mesh.total_angle(v) >= TIP && !mesh.is_pinched(v);
            if !wide {
                for (fan, angle) in closed_fans(mesh, v).filter(|(_, angle)| *angle < TIP) {
                    tips.limits.resize(numbers, [f32::INFINITY; 2]);
                    #[allow(clippy::cast_possible_truncation)] // Rounded by less than the slack.
                    let limit = (2.0 * angle * (1.0 + SLACK)) as f32;
                    for &h in fan {
                        tips.limits[number(h)][0] = limit;
                        tips.limits[number(h.prev())][1] = limit;
                    }
                }
            }
        }
        tips
    }

    /// Whether there is none, as on nearly all meshes: then no window needs to be asked for.
    #[inline]
    pub fn is_empty(&self) -> bool {
        self.limits.is_empty()
    }

    /// Whether `window`, which has arrived at half-edge number `h` of length `l`, has turned around an end of it by so much that none of
    /// its rays is part of a shortest path.
    #[inline]
    pub fn drop(&self, h: usize, l: f64, window: &Window) -> bool {
        let Some(&[tail, head]) = self.limits.get(h) else {
            return false;
        };
        let turned = |along: f64| libm::atan2(-window.py, along);
        (window.b0 <= MARGIN * l && tail < f32::INFINITY && turned(window.px) > f64::from(tail))
            || (window.b1 >= l - MARGIN * l
                && head < f32::INFINITY
                && turned(l - window.px) > f64::from(head))
    }
}

/// The fans around `v` that have no boundary: the half-edges that start there, and the sum of their angles in radians.
fn closed_fans(mesh: &Mesh, v: VertexId) -> impl Iterator<Item = (&[HalfEdgeId], f64)> {
    let follows = |a: &HalfEdgeId, b: &HalfEdgeId| mesh.twin(a.prev()) == Some(*b);
    let fans = mesh.outgoing(v).chunk_by(follows);
    let closed = move |fan: &&[HalfEdgeId]| follows(&fan[fan.len() - 1], &fan[0]);
    fans.filter(closed).map(|fan| {
        let angles = fan.iter().map(|&h| {
            let [x, y] = mesh.apex(h);
            libm::atan2(y, x)
        });
        (fan, angles.sum())
    })
}

#[cfg(test)]
mod tests {
    use geobench_mesh::TriangleSoup;

    use super::*;

    /// An open cone with its tip at `height` over a regular polygon of radius 1.
    fn cone(height: f64) -> Mesh {
        let corners = 10;
        let mut positions = vec![[0.0, 0.0, height]];
        positions.extend((0..corners).map(|i| {
            let angle = 2.0 * PI * f64::from(i) / f64::from(corners);
            [angle.cos(), angle.sin(), 0.0]
        }));
        let faces = (0..corners).map(|i| [0, 1 + i, 1 + (i + 1) % corners]);
        let soup = TriangleSoup::new(positions, faces.collect());
        Mesh::from_soup(soup).unwrap().0
    }

    #[test]
    fn only_sharp_tips_are_found() {
        let tips = |height| {
            let mesh = cone(height);
            NeedleTips::of(&mesh, mesh.half_edge_count(), HalfEdgeId::index)
        };
        assert!(tips(1.0).is_empty() && tips(10.0).is_empty());
        assert!(!tips(100.0).is_empty() && !tips(1e8).is_empty());
    }

    #[test]
    fn windows_that_have_turned_too_far_are_dropped() {
        let mesh = cone(100.0);
        let tips = NeedleTips::of(&mesh, mesh.half_edge_count(), HalfEdgeId::index);
        let h = mesh.outgoing(VertexId::new(0))[0];
        let l = mesh.length(h);
        let turned_by = |angle: f64| Window {
            b0: 0.0,
            b1: l,
            px: 0.5 * l * angle.cos(),
            py: -0.5 * l * angle.sin(),
            sigma: 0.0,
        };
        let whole = mesh.total_angle(VertexId::new(0));
        let is_dropped = |window| tips.drop(h.index(), l, &window);
        assert!(!is_dropped(turned_by(1.99 * whole)));
        assert!(is_dropped(turned_by(2.01 * whole)));
        let beside = Window {
            b0: 1e-3 * l,
            ..turned_by(2.01 * whole)
        };
        assert!(!is_dropped(beside));
        // The same seen against the edge.
        let back = h.prev();
        let mirrored = turned_by(2.01 * whole);
        let mirrored = Window {
            px: mesh.length(back) - mirrored.px,
            b1: mesh.length(back),
            ..mirrored
        };
        assert!(tips.drop(back.index(), mesh.length(back), &mirrored));
    }
}
