//! The junctions that windows have crossed.

use std::collections::HashMap;

use geobench_mesh::HalfEdgeId;
use geobench_window::Window;
use geobench_window::blocks::number;
use geobench_window::continuous::Surface;

/// The sequence of gates that a window has crossed since its root, by number. Windows of equal
/// routes have equal sequences.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) struct Route(pub(crate) u32);

impl Route {
    /// The route without junctions.
    pub(crate) const DIRECT: Self = Self(0);
}

/// The numbers of all routes of a run.
#[derive(Clone, Debug, Default)]
pub(crate) struct Routes {
    /// The numbers from 1 on, by the route up to the last gate and that gate.
    numbers: HashMap<(Route, HalfEdgeId), Route>,
}

impl Routes {
    pub(crate) fn clear(&mut self) {
        self.numbers.clear();
    }

    /// Passes a window that has come by `route` to all half-edges beyond the gate `h`, each with
    /// its half-edge and the route from there. `None` if `h` is no gate.
    pub(crate) fn cross<'a>(
        &mut self,
        h: HalfEdgeId,
        window: &Window,
        route: Route,
        surface: &'a Surface,
    ) -> Option<impl Iterator<Item = (HalfEdgeId, Window, Route)> + use<'a>> {
        let entrances = surface.faces().beyond(h)?;
        let next = Route(number(self.numbers.len() + 1));
        let route = *self.numbers.entry((route, h)).or_insert(next);
        let (window, l) = (*window, surface.faces().length(h));
        Some(entrances.filter_map(move |entrance| {
            let carried = entrance.carry(&window, l)?;
            Some((entrance.half_edge, carried, route))
        }))
    }
}

#[cfg(test)]
mod tests {
    use geobench_mesh::Mesh;

    use super::*;

    #[test]
    fn equal_numbers_are_equal_sequences_of_gates() {
        let positions = vec![
            [0.0; 3],
            [1.0, 0.0, 0.0],
            [0.0, 1.0, 0.0],
            [0.0, -1.0, 0.0],
            [0.0, 0.0, 1.0],
        ];
        let mesh = Mesh::new(positions, vec![[0, 1, 2], [1, 0, 3], [0, 1, 4]]).unwrap();
        let surface = Surface::new(&mesh);
        let sides: Vec<HalfEdgeId> = mesh.junction_sides().collect();
        let gate = |i: usize| {
            let own = surface.faces().number(sides[i]);
            surface.faces().twin(own).unwrap()
        };
        let mut routes = Routes::default();
        let window = Window {
            b1: 0.25,
            py: -1.0,
            ..Window::default()
        };
        let mut cross = |i, route| -> Vec<(HalfEdgeId, Window, Route)> {
            let crossed = routes.cross(gate(i), &window, Route(route), &surface);
            crossed.unwrap().collect()
        };
        let first = cross(0, 0);
        let entrances: Vec<HalfEdgeId> = first.iter().map(|(h, ..)| *h).collect();
        let others = [1, 2].map(|i: usize| surface.faces().number(sides[i]));
        assert_eq!(entrances, others);
        // The gate has the direction opposite to that of its half-edge.
        assert_eq!([first[0].1.b0, first[1].1.b0], [0.0, 0.75]);
        let number = |crossed: Vec<(HalfEdgeId, Window, Route)>| crossed[0].2.0;
        assert_eq!(number(first), 1);
        assert_eq!([number(cross(1, 0)), number(cross(0, 1))], [2, 3]);
        assert_eq!([number(cross(0, 0)), number(cross(0, 1))], [1, 3]);
        assert!(
            routes
                .cross(others[0], &window, Route::DIRECT, &surface)
                .is_none()
        );
    }
}
