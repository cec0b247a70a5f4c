//! A run for tests.

use geobench_mesh::generate::generate;
use geobench_mesh::{Mesh, Numbering};

use super::field::Field;
use super::mail::Offer;
use super::worker::Worker;
use crate::engine::surface::{Surface, half_edge, next, parts};
use crate::fast::Options;

/// A run of two threads on a terrain, before its first turn.
pub(super) fn two_threads() -> (Field, [Worker; 2]) {
    let soup = generate(&"gen:terrain,n=20,seed=2".parse().unwrap()).unwrap();
    let (mesh, _) = Mesh::from_soup(soup).unwrap();
    let surface = Surface::new(&mesh, &Numbering::along_curve(&mesh));
    let workers = [0, 1].map(|thread| Worker::new(thread, 2, &surface, 1.0));
    let mut field = Field::new(surface, &Options::default(), 2);
    field.start();
    (field, workers)
}

/// A path of length `distance` to `vertex`, across the face at `place` of its ring.
pub(super) fn path(field: &Field, vertex: u32, place: usize, distance: f64) -> Offer {
    let (f, corner) = parts(field.surface.ring(vertex)[place]);
    Offer {
        vertex,
        h: half_edge(f as u32, next(corner)),
        entry: 0.0,
        distance,
    }
}
