//! UV sphere, cylinder and cone: rings of vertices around the z-axis.

use super::GenerateError;
use super::keys::{Key, Kind, Params};
use super::lattice::{stacked, stacked_count};
use super::plate::MAX_SIDE;
use super::turn::turn;
use crate::soup::TriangleSoup;
use std::f64::consts::PI;

const SLICES: [u64; 2] = [3, MAX_SIDE];

pub(super) const UVSPHERE_KEYS: &[Key] = &[
    Key::whole("slices", 64, SLICES, "meridians"),
    Key::whole("stacks", 32, [2, MAX_SIDE], "bands between the poles"),
];

pub(super) const CYLINDER_KEYS: &[Key] = &[
    Key::whole("slices", 64, SLICES, "sides of its base, a regular polygon"),
    Key::whole("stacks", 24, [1, MAX_SIDE], "bands along its height"),
    Key::real("height", 2.0, [1e-6, 1e6], "height, the radius being 1"),
    ENDS,
];

pub(super) const CONE_KEYS: &[Key] = &[
    Key::real(
        "angle",
        180.0,
        [1.0, 3600.0],
        "total angle at the apex in degrees; a saddle above 360",
    ),
    Key::whole(
        "slices",
        48,
        SLICES,
        "flat sides, each with its share of the angle; even above 360 degrees",
    ),
    Key::whole(
        "stacks",
        32,
        [1, MAX_SIDE],
        "bands from the apex to the rim",
    ),
    ENDS,
];

const ENDS: Key = Key {
    name: "ends",
    kind: Kind::Choice(&["open", "capped"]),
    summary: "whether bases are left out, or are fans around a centre",
};

pub(super) fn uvsphere_faces(params: &Params<'_>) -> u64 {
    let (slices, stacks) = (params.whole("slices"), params.whole("stacks"));
    stacked_count(slices, stacks - 1, true, true)
}

/// Radius 1; the north pole is vertex 0, the south pole the last one.
pub(super) fn uvsphere(params: &Params<'_>) -> TriangleSoup {
    let (slices, stacks) = (params.count("slices"), params.whole("stacks"));
    let circle = circle(slices);
    let mut positions = vec![[0.0, 0.0, 1.0]];
    for ring in 1..stacks {
        let [z, radius] = turn(ring, 2 * stacks);
        positions.extend(circle.iter().map(|[x, y]| [radius * x, radius * y, z]));
    }
    positions.push([0.0, 0.0, -1.0]);
    let triangles = stacked(slices, stacks as usize - 1, true, true);
    TriangleSoup::new(positions, triangles)
}

pub(super) fn cylinder_faces(params: &Params<'_>) -> u64 {
    let capped = params.is("ends", "capped");
    let (slices, stacks) = (params.whole("slices"), params.whole("stacks"));
    stacked_count(slices, stacks + 1, capped, capped)
}

/// A prism over a regular polygon inscribed in the unit circle, from z = 0 to its height.
pub(super) fn cylinder(params: &Params<'_>) -> TriangleSoup {
    let (slices, stacks) = (params.count("slices"), params.count("stacks"));
    let height = params.real("height");
    let capped = params.is("ends", "capped");
    let circle = circle(slices);
    let mut positions = Vec::new();
    if capped {
        positions.push([0.0, 0.0, height]);
    }
    for ring in 0..=stacks {
        let z = height * (stacks - ring) as f64 / stacks as f64;
        positions.extend(circle.iter().map(|&[x, y]| [x, y, z]));
    }
    if capped {
        positions.push([0.0; 3]);
    }
    TriangleSoup::new(positions, stacked(slices, stacks + 1, capped, capped))
}

pub(super) fn cone_faces(params: &Params<'_>) -> Result<u64, GenerateError> {
    let (slices, angle) = (params.whole("slices"), params.real("angle"));
    let unfit = |why| {
        Err(GenerateError::Unfit {
            family: "cone",
            why,
        })
    };
    if angle > 360.0 && slices % 2 == 1 {
        return unfit(format!(
            "an apex angle above 360 degrees needs an even number of slices, not {slices}"
        ));
    }
    if angle >= 175.0 * slices as f64 {
        return unfit(format!(
            "each slice may take less than 175 degrees of the apex angle: slices={slices} is too few"
        ));
    }
    let capped = params.is("ends", "capped");
    Ok(stacked_count(slices, params.whole("stacks"), true, capped))
}

/// A polyhedral cone with its apex, vertex 0, at the origin and sloping edges of length 1 from it.
///
/// Every side is a flat isosceles triangle, so the surface is exactly a cone of the total angle.
/// Up to 360 degrees it is a pyramid; above, its edges rise and fall in turn.
pub(super) fn cone(params: &Params<'_>) -> TriangleSoup {
    let (slices, stacks) = (params.count("slices"), params.count("stacks"));
    let angle = params.real("angle") * (PI / 180.0);
    let capped = params.is("ends", "capped");
    let n = slices as f64;
    // Neighbouring edges, unit vectors at elevations e and ±e, must span angle / n.
    let half = libm::sin(angle / n / 2.0);
    let (radius, rising) = if angle <= 2.0 * PI {
        // Half the base side is both sin(angle / 2n) and radius · sin(π / n).
        ((half / libm::sin(PI / n)).min(1.0), false)
    } else {
        // 1 + cos(angle / n) = radius² (1 + cos(2π / n)).
        (libm::cos(angle / n / 2.0) / libm::cos(PI / n), true)
    };
    let drop = ((1.0 - radius) * (1.0 + radius)).max(0.0).sqrt();
    let circle = circle(slices);
    let mut positions = vec![[0.0; 3]];
    for ring in 1..=stacks {
        let t = ring as f64 / stacks as f64;
        positions.extend(circle.iter().enumerate().map(|(j, [x, y])| {
            let z = if rising && j % 2 == 1 { drop } else { -drop };
            [t * radius * x, t * radius * y, t * z]
        }));
    }
    if capped {
        // In the plane of a pyramid's base; below a flat or rising cone, to enclose something.
        let depth = if rising || drop == 0.0 { 1.0 } else { drop };
        positions.push([0.0, 0.0, -depth]);
    }
    TriangleSoup::new(positions, stacked(slices, stacks, true, capped))
}

/// The corners of a regular polygon on the unit circle.
fn circle(slices: usize) -> Vec<[f64; 2]> {
    let slices = slices as u64;
    (0..slices).map(|j| turn(j, slices)).collect()
}
