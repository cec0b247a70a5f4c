//! Distances on boundary edges, across which solvers send no windows.

use geobench_mesh::{HalfEdgeId, Mesh};

use crate::envelope::WindowData;

/// What the corner opposite, and the windows that enter the face of `h` through each of its other
/// sides, give on the edge of `h`, in the frame of `h`. Rounding is no concern: a proof holds for any
/// windows.
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
        // The edge of `h` in the frame of `side`.
        let follows = side.next() == h;
        let (tail, head) = if follows {
            (end, apex)
        } else {
            (apex, [0.0; 2])
        };
        let along = minus(head, tail);
        let unit = along.map(|x| x / length);
        let leave = |window: WindowData| {
            let image = [window.image[0], -window.image[1].abs()];
            let offset = minus(image, tail);
            // Where the ray through an end of the window leaves the face, as a part of the edge.
            let exit = |b: f64| {
                let ray = minus([b, 0.0], image);
                let [start, end] = [tail, head].map(|point| cross(ray, minus(point, image)));
                // The end that both sides share is never beyond the ray, whatever rounding says.
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
                image: [dot(offset, unit), cross(unit, offset)],
                sigma: window.sigma,
            })
        };
        found.extend(windows(side).into_iter().filter_map(leave));
    };
    through(h.next());
    through(h.prev());
    found
}

fn minus(a: [f64; 2], b: [f64; 2]) -> [f64; 2] {
    [a[0] - b[0], a[1] - b[1]]
}

fn dot(a: [f64; 2], b: [f64; 2]) -> f64 {
    a[0] * b[0] + a[1] * b[1]
}

fn cross(a: [f64; 2], b: [f64; 2]) -> f64 {
    a[0] * b[1] - a[1] * b[0]
}
