//! The wedge of directions in which a shortest path that bends at a vertex can continue.

use std::f32::consts::PI;

use super::layout::{MeshLayout, half_edge, parts, prev};

/// By how much, in radians, the wedge is widened: far more than the errors of the angles. The place
/// of `PathOrigin` errs by the [`blur`](crate::precision::blur) of the mesh, so beside edges that
/// are shorter than that over this angle no wedge is known.
pub(super) const WIDENING: f32 = 1e-3;

/// The last crossing of a path before it reached a vertex.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct PathOrigin {
    /// The half-edge of the crossing, opposite to the vertex.
    pub(crate) h: u32,
    /// The abscissa of the crossing.
    pub(crate) entry: f64,
}

/// The faces around a vertex into which a path that reaches the vertex can continue.
#[derive(Clone, Copy, Debug)]
pub(crate) struct SpawnWedge {
    /// The first of them in the ring of the vertex. `count` is their number.
    pub(crate) first: usize,
    pub(crate) count: usize,
}

impl SpawnWedge {
    /// All faces around a vertex.
    pub(crate) fn all(degree: usize) -> Self {
        Self {
            first: 0,
            count: degree,
        }
    }

    /// The wedge for a path that reaches `v` from `origin`.
    ///
    /// A shortest path bends at an interior vertex only if it leaves an angle of π or more on both
    /// sides. The possible directions form a wedge as wide as the excess over 2π, opposite to the
    /// direction of arrival.
    pub(crate) fn of(layout: &MeshLayout, v: u32, origin: PathOrigin) -> Self {
        let places = layout.ring_places(v);
        let (ring, angles) = (&layout.rings[places.clone()], &layout.angles[places]);
        let (f, corner) = parts(origin.h);
        let own = half_edge(f as u32, prev(corner));
        let Some(start) = ring.iter().position(|&h| h == own) else {
            return Self::all(ring.len());
        };
        // The angle at the apex, counter-clockwise from the side that ends at the tail to the path.
        let [x, y] = layout.faces[f].apex(corner);
        let across = y * origin.entry;
        let along = y * y - x * (origin.entry - x);
        let size = across.abs() + along.abs();
        let turned = libm::atan2f((across / size) as f32, (along / size) as f32);
        let (from, to) = (
            PI - WIDENING,
            layout.vertices[v as usize].total_angle - PI + WIDENING,
        );
        // The first corner that ends within the wedge, and the last that starts within it.
        let mut wedge = Self { first: 0, count: 0 };
        let (mut place, mut before) = (start, -turned);
        for _ in 0..ring.len() {
            let after = before + angles[place];
            if after >= from && before <= to {
                if wedge.count == 0 {
                    wedge.first = place;
                }
                wedge.count += 1;
            }
            before = after;
            place = if place + 1 == ring.len() {
                0
            } else {
                place + 1
            };
        }
        wedge
    }
}
