//! Schedules: the order in which faces join the traversed area.

use geobench_window::queue::Heap;
use geobench_window::{Counter, Probe};

/// An element of a schedule.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Scheduled {
    /// A vertex.
    Vertex(u32),
    /// A face, which joins the traversed area alone.
    Face(u32),
}

/// An order in which the traversed area grows. Distances do not depend on it; counts and time do.
pub trait Schedule: Send {
    /// Whether all faces around a vertex join at the turn of the vertex. Else faces have turns of
    /// their own, and [`wait`](Schedule::wait) must be called for windows that wait for them.
    const BY_VERTEX: bool;

    /// An empty schedule for a mesh with this number of faces. Vertices and faces have the numbers
    /// of the solver.
    fn new(faces: usize) -> Self;

    /// Changes the number of faces, before the next [`reset`](Self::reset).
    fn resize(&mut self, faces: usize) {
        let _ = faces;
    }

    /// Removes all elements.
    fn reset(&mut self);

    /// Gives vertex `v` a turn at distance `d`.
    fn push_vertex<P: Probe>(&mut self, v: u32, d: f64, probe: &mut P);

    /// Tells that windows now wait for `face`. `offer` is the length of their shortest path to the
    /// vertex opposite their edge.
    fn wait<P: Probe>(&mut self, face: u32, offer: f64, probe: &mut P);

    /// The distance of the next element; infinite if there is none.
    fn next(&self) -> f64;

    /// Takes the next element, with its distance in the queue.
    fn pop(&mut self) -> Option<(f64, Scheduled)>;
}

/// Nearest vertex first (Qin et al. 2016, section 5.2).
#[derive(Clone, Debug)]
pub struct NearestVertex {
    front: Heap<u32>,
}

impl Schedule for NearestVertex {
    const BY_VERTEX: bool = true;

    fn new(_: usize) -> Self {
        Self {
            front: Heap::default(),
        }
    }

    fn reset(&mut self) {
        self.front.clear();
    }

    #[inline]
    fn push_vertex<P: Probe>(&mut self, v: u32, d: f64, probe: &mut P) {
        push(&mut self.front, d, v, probe);
    }

    fn wait<P: Probe>(&mut self, _: u32, _: f64, _: &mut P) {}

    fn next(&self) -> f64 {
        self.front.peek().map_or(f64::INFINITY, |(d, _)| d)
    }

    #[inline]
    fn pop(&mut self) -> Option<(f64, Scheduled)> {
        let (d, v) = self.front.pop()?;
        Some((d, Scheduled::Vertex(v)))
    }
}

/// The face whose far vertex the waiting windows reach on the shortest path (Qin et al. 2016,
/// section 5.1). Pseudo-sources have turns in the same queue, by their distances.
#[derive(Clone, Debug)]
pub struct NearestFace {
    front: Heap<Scheduled>,
    /// For each face, the least offer so far, which is its label in the queue.
    offers: Vec<f64>,
}

impl Schedule for NearestFace {
    const BY_VERTEX: bool = false;

    fn new(faces: usize) -> Self {
        Self {
            front: Heap::default(),
            offers: vec![f64::INFINITY; faces],
        }
    }

    fn resize(&mut self, faces: usize) {
        self.offers.resize(faces, f64::INFINITY);
    }

    fn reset(&mut self) {
        self.front.clear();
        self.offers.fill(f64::INFINITY);
    }

    fn push_vertex<P: Probe>(&mut self, v: u32, d: f64, probe: &mut P) {
        push(&mut self.front, d, Scheduled::Vertex(v), probe);
    }

    fn wait<P: Probe>(&mut self, face: u32, offer: f64, probe: &mut P) {
        let least = &mut self.offers[face as usize];
        if offer < *least {
            *least = offer;
            push(&mut self.front, offer, Scheduled::Face(face), probe);
        }
    }

    fn next(&self) -> f64 {
        self.front.peek().map_or(f64::INFINITY, |(d, _)| d)
    }

    fn pop(&mut self) -> Option<(f64, Scheduled)> {
        self.front.pop()
    }
}

#[inline]
fn push<T: Copy + Ord, P: Probe>(front: &mut Heap<T>, label: f64, turn: T, probe: &mut P) {
    front.push(label, turn);
    probe.add(Counter::QueuePushes, 1);
    probe.raise(Counter::QueuePeak, front.len() as u64);
}
