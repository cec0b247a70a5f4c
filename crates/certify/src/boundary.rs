//! Distances on boundary edges. Solvers store no windows there, because no face lies beyond.

use geobench_mesh::vector::{cross_2d, dot, sub};
use geobench_mesh::{HalfEdgeId, Mesh};

use crate::envelope::WindowData;

/// Windows that reach boundary edge `h` from inside its face, in the frame of `h`: one from the
/// opposite corner, as a pseudo-source, and those that enter the face through its other two sides
/// and leave it through `h`. Plain floating-point arithmetic suffices, because the proof assumes
/// nothing about windows.
pub(crate) fn windows_from_inside<W>(
    mesh: &Mesh,
    h: HalfEdgeId,
    distance_opposite: f64,
    windows: impl Fn(HalfEdgeId) -> W,
) -> Vec<WindowData>
where
    W: IntoIterator<Item = WindowData>,
{
    let length = mesh.length(h);
    let mut found = vec![WindowData {
        interval: [0.0, length],
        image: mesh.apex(h),
        sigma: distance_opposite,
    }];
    let mut through = |side: HalfEdgeId| {
        let (apex, end) = (mesh.apex(side), [mesh.length(side), 0.0]);
        // The ends of the edge of `h` in the frame of `side`.
        let follows = side.next() == h;
        let (tail, head) = if follows {
            (end, apex)
        } else {
            (apex, [0.0; 2])
        };
        let along = sub(head, tail);
        // Not by `length`: on an edge that is far shorter than `side` the corners are rounded, and
        // a vector that is not of unit length would scale the image.
        let rounded = dot(along, along).sqrt();
        let unit = along.map(|x| x / rounded);
        let leave = |window: WindowData| {
            let image = [window.image[0], -window.image[1].abs()];
            let offset = sub(image, tail);
            // The abscissa on `h` at which the ray through point `b` of `side` leaves the face.
            let exit = |b: f64| {
                let ray = sub([b, 0.0], image);
                let [start, end] = [tail, head].map(|point| cross_2d(ray, sub(point, image)));
                // The corner that both sides share cannot lie beyond the ray, except by rounding.
                let (start, end) = if follows {
                    (start.min(0.0), end)
                } else {
                    (start, end.max(0.0))
                };
                if start >= 0.0 && end >= 0.0 {
                    0.0
                } else if end <= 0.0 {
                    length
                } else {
                    length * (start / (start - end))
                }
            };
            let interval = [exit(window.interval[1]), exit(window.interval[0])];
            (interval[0] < interval[1]).then(|| WindowData {
                interval,
                image: [dot(offset, unit), cross_2d(unit, offset)],
                sigma: window.sigma,
            })
        };
        found.extend(windows(side).into_iter().filter_map(leave));
    };
    through(h.next());
    through(h.prev());
    found
}
