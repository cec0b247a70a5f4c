//! Windows carried through strips of triangles folded in space, against lengths measured there.

use geobench_mesh::vector::{cross, norm, sub, unit};
use geobench_mesh::{HalfEdgeId, Mesh, TriangleSoup, VertexId};
use geobench_window::{Crossing, Faces, Side, Window, spawn_window};
use proptest::prelude::*;

type Point = [f64; 3];

fn add(a: Point, b: Point, t: f64) -> Point {
    [0, 1, 2].map(|i| a[i] + t * b[i])
}

/// One more triangle of a strip: on which exit of the last one it lies, where its apex stands
/// along that edge and above it, and by what angle it is folded.
#[derive(Clone, Debug)]
struct Step {
    left: bool,
    along: f64,
    height: f64,
    fold: f64,
}

fn steps() -> impl Strategy<Value = Vec<Step>> {
    let step = (any::<bool>(), -0.3..1.3f64, 0.2..1.5f64, -2.5..2.5f64).prop_map(
        |(left, along, height, fold)| Step {
            left,
            along,
            height,
            fold,
        },
    );
    prop::collection::vec(step, 1..9)
}

/// The triangles of a strip. The first is (0, 1, 2), and vertex 0 is the source of the windows.
fn strip(steps: &[Step]) -> TriangleSoup {
    let mut positions: Vec<Point> = vec![[0.0, 0.0, 0.0], [1.0, 0.1, 0.0], [0.3, 0.9, 0.0]];
    let mut triangles = vec![[0u32, 1, 2]];
    // The half-edge a → b by which the strip leaves its last triangle, whose third vertex is c.
    let (mut a, mut b, mut c) = (1u32, 2, 0);
    for (i, step) in steps.iter().enumerate() {
        let [pa, pb, pc] = [a, b, c].map(|v| positions[v as usize]);
        let edge = sub(pb, pa);
        let normal = unit(cross(edge, sub(pc, pa)));
        let outward = unit(cross(edge, normal));
        let (sin, cos) = step.fold.sin_cos();
        let up = [0, 1, 2].map(|i| cos * outward[i] + sin * normal[i]);
        let apex = add(add(pa, edge, step.along), up, step.height);
        let new = positions.len() as u32;
        positions.push(apex);
        triangles.push([b, a, new]);
        // Entered through b → a; its left exit is new → b, its right one a → new.
        let goes_left = steps.get(i + 1).is_some_and(|next| next.left);
        (a, b, c) = if goes_left { (new, b, a) } else { (a, new, b) };
    }
    TriangleSoup::new(positions, triangles)
}

/// A half-edge on the way, with the window that arrived there.
struct Station {
    h: HalfEdgeId,
    window: Window,
}

/// The left and the right child of a window that crosses a triangle, and the distance that it
/// offers to the apex.
fn crossed(faces: &Faces, h: HalfEdgeId, w: &Window) -> ([Option<Window>; 2], f64) {
    let view = faces.face_view(h);
    let crossing = Crossing::new(&view.frame, w);
    let [left, right] = [Side::Left, Side::Right].map(|side| view.exit(side));
    if crossing.covers_apex() {
        let children = [crossing.left_child(&left), crossing.right_child(&right)];
        return (children, crossing.straight_distance());
    }
    match crossing.side() {
        Side::Left => (
            [crossing.only_child(&left), None],
            crossing.bent_distance(&left),
        ),
        Side::Right => (
            [None, crossing.only_child(&right)],
            crossing.bent_distance(&right),
        ),
    }
}

/// Carries the window of vertex 0 through the strip as far as it goes.
fn carry(faces: &Faces, steps: &[Step]) -> Vec<Station> {
    let (h, window) = spawn_window(faces, HalfEdgeId::new(0), 0.0).unwrap();
    let mut stations = vec![Station { h, window }];
    for step in &steps[1..] {
        let Station { h, window: w } = &stations[stations.len() - 1];
        let side = usize::from(!step.left);
        let (children, _) = crossed(faces, *h, w);
        let Some(window) = children[side] else { break };
        let h = faces.exits(*h)[side].unwrap();
        stations.push(Station { h, window });
    }
    stations
}

/// The point at abscissa `x` of half-edge `h`, in space.
fn point_on(mesh: &Mesh, h: HalfEdgeId, x: f64) -> Point {
    let [a, b] = [mesh.tail(h), mesh.head(h)].map(|v| mesh.positions()[v.index()]);
    add(a, sub(b, a), x / mesh.length(h))
}

/// Length in space of the path that reaches `x` on the last station, found by walking back from
/// there towards the image of the source, triangle by triangle.
fn length_in_space(mesh: &Mesh, faces: &Faces, stations: &[Station], x: f64) -> f64 {
    let (mut x, mut length) = (x, 0.0);
    for pair in stations.windows(2).rev() {
        let (from, to) = (&pair[0], &pair[1]);
        // In the frame of `to` its edge and the vertex behind it bound the triangle just crossed;
        // the edge of `from` joins that vertex with the tail (after a left exit) or the head.
        let behind = faces.apex_below(faces.twin(to.h).unwrap());
        let came_left = mesh.tail(from.h) == mesh.tail(to.h);
        let corner = if came_left {
            [0.0, 0.0]
        } else {
            [faces.length(to.h), 0.0]
        };
        let side = [behind[0] - corner[0], behind[1] - corner[1]];
        let w = &to.window;
        let ray = [w.px - x, w.py];
        // corner + u·side = (x, 0) + t·ray, solved for u.
        let u = ((x - corner[0]) * ray[1]) / (side[0] * ray[1] - side[1] * ray[0]);
        let from_corner = u * side[0].hypot(side[1]);
        let before = if came_left {
            from_corner
        } else {
            faces.length(from.h) - from_corner
        };
        length += norm(sub(point_on(mesh, to.h, x), point_on(mesh, from.h, before)));
        x = before;
    }
    length + norm(sub(point_on(mesh, stations[0].h, x), mesh.positions()[0]))
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(3000))]

    #[test]
    fn propagating_then_measuring_equals_measuring_in_space(
        steps in steps(), t in 0.001..0.999f64,
    ) {
        let (mesh, _) = Mesh::from_soup(strip(&steps)).unwrap();
        let faces = Faces::new(&mesh);
        let stations = carry(&faces, &steps);
        let w = &stations.last().unwrap().window;
        let x = w.b0 + t * (w.b1 - w.b0);
        let length = length_in_space(&mesh, &faces, &stations, x);
        prop_assert!(
            (w.distance(x) - length).abs() <= 1e-11 * length,
            "{} triangles: {} unfolded, {length} in space", stations.len(), w.distance(x)
        );
    }

    #[test]
    fn the_children_of_a_split_meet_in_the_apex(steps in steps()) {
        let (mesh, _) = Mesh::from_soup(strip(&steps)).unwrap();
        let faces = Faces::new(&mesh);
        let stations = carry(&faces, &steps);
        let Station { h, window: w } = stations.last().unwrap();
        let frame = faces.frame(*h);
        let ([left, right], d) = crossed(&faces, *h, w);
        if let (Some(left), Some(right)) = (left, right) {
            prop_assert_eq!(left.b1, frame.la);
            prop_assert_eq!(right.b0, 0.0);
            prop_assert!((left.distance(frame.la) - d).abs() <= 1e-13 * d);
            prop_assert!((right.distance(0.0) - d).abs() <= 1e-13 * d);
        } else {
            prop_assert!(left.is_some() || right.is_some() || w.b1 - w.b0 < 1e-9);
        }
    }

    #[test]
    fn the_apex_offer_is_the_length_of_a_path_and_no_less_than_the_straight_one(steps in steps()) {
        let (mesh, _) = Mesh::from_soup(strip(&steps)).unwrap();
        let faces = Faces::new(&mesh);
        let stations = carry(&faces, &steps);
        let Station { h, window: w } = stations.last().unwrap();
        let frame = faces.frame(*h);
        let (_, d) = crossed(&faces, *h, w);
        let straight = (frame.cx - w.px).hypot(frame.cy - w.py);
        prop_assert!(d >= straight * (1.0 - 1e-14));
        let apex = mesh.positions()[mesh.apex_vertex(*h).index()];
        let bend = Crossing::new(&frame, w).separation().clamp(w.b0, w.b1);
        let path = length_in_space(&mesh, &faces, &stations, bend)
            + norm(sub(apex, point_on(&mesh, *h, bend)));
        prop_assert!((d - path).abs() <= 1e-11 * path, "{d} offered, {path} in space");
    }
}

fn two_folds() -> Mesh {
    let steps = [
        Step {
            left: true,
            along: 0.4,
            height: 0.7,
            fold: 0.3,
        },
        Step {
            left: false,
            along: 0.1,
            height: 1.1,
            fold: -1.0,
        },
    ];
    Mesh::from_soup(strip(&steps)).unwrap().0
}

#[test]
fn frames_agree_with_the_mesh() {
    let mesh = two_folds();
    let faces = Faces::new(&mesh);
    for h in mesh.half_edges() {
        let frame = faces.frame(h);
        let [x, y] = mesh.apex(h);
        assert_eq!(frame.l, mesh.length(h));
        assert_eq!(frame.cx, x);
        assert!((frame.cy - y).abs() < 1e-15);
        let [ux, uy] = frame.left;
        assert!((ux * frame.la - x).abs() < 1e-15 && (uy * frame.la - y).abs() < 1e-15);
        let [vx, vy] = frame.right;
        assert!((x + vx * frame.lb - frame.l).abs() < 1e-15 && (y + vy * frame.lb).abs() < 1e-15);
        assert_eq!(
            faces.corners(h),
            [mesh.tail(h), mesh.head(h), mesh.apex_vertex(h)]
        );
        assert_eq!(faces.twin(h), mesh.twin(h));
        assert_eq!(faces.length(h), mesh.length(h));
    }
}

#[test]
fn the_window_of_a_vertex_spans_the_opposite_edge() {
    let mesh = two_folds();
    let faces = Faces::new(&mesh);
    let (h, w) = spawn_window(&faces, HalfEdgeId::new(0), 2.5).unwrap();
    assert_eq!(mesh.face_vertices(h.face()).map(VertexId::raw), [2, 1, 3]);
    assert_eq!((w.b0, w.b1, w.sigma), (0.0, mesh.length(h), 2.5));
    let to_tail = mesh.length(HalfEdgeId::new(2));
    assert!((w.distance(0.0) - 2.5 - to_tail).abs() < 1e-15);
}
