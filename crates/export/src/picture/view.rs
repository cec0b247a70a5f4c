//! The direction of view of a picture.

use std::str::FromStr;

/// A direction of view: `AZIMUTH,ELEVATION[,y|z]`, in degrees and the axis that is up, y by
/// default.
///
/// With y up, azimuth 0 looks from +z and 90 from +x, as `OrbitControls` of three.js has it. With z
/// up, azimuth 0 looks from +x and 90 from +y, as `view_init(elev, azim)` of matplotlib. At
/// elevation 90 the model is seen from above.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct View {
    /// Degrees around the axis.
    azimuth: f64,
    /// Degrees above the horizon.
    elevation: f64,
    /// Whether z is up, else y.
    z_up: bool,
}

impl FromStr for View {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        let parts: Vec<&str> = text.split(',').map(str::trim).collect();
        let number = |k: usize, most: f64| {
            let number: f64 = parts.get(k)?.parse().ok()?;
            (number.abs() <= most).then_some(number)
        };
        let z_up = match parts.get(2) {
            None => Some(false),
            Some(axis) if axis.eq_ignore_ascii_case("y") => Some(false),
            Some(axis) if axis.eq_ignore_ascii_case("z") => Some(true),
            Some(_) => None,
        };
        match (number(0, 360.0), number(1, 90.0), z_up) {
            (Some(azimuth), Some(elevation), Some(z_up)) if parts.len() <= 3 => Ok(Self {
                azimuth,
                elevation,
                z_up,
            }),
            _ => Err(
                "give AZIMUTH,ELEVATION[,y|z] in degrees, -360 to 360 and -90 to 90, such as 30,20"
                    .to_owned(),
            ),
        }
    }
}

impl View {
    /// The directions to the right, up, and towards the viewer.
    pub(super) fn axes(self) -> [[f64; 3]; 3] {
        // `libm` gives the same view on every machine.
        let turn = |degrees: f64| {
            let angle = degrees.to_radians();
            [libm::cos(angle), libm::sin(angle)]
        };
        let ([ca, sa], [ce, se]) = (turn(self.azimuth), turn(self.elevation));
        if self.z_up {
            [
                [-sa, ca, 0.0],
                [-se * ca, -se * sa, ce],
                [ce * ca, ce * sa, se],
            ]
        } else {
            [
                [ca, 0.0, -sa],
                [-se * sa, ce, -se * ca],
                [ce * sa, se, ce * ca],
            ]
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn axes(text: &str) -> [[f64; 3]; 3] {
        let axes = text.parse::<View>().unwrap().axes();
        axes.map(|axis| axis.map(|x| x.round() + 0.0))
    }

    #[test]
    fn views_follow_both_conventions() {
        let [x, y, z] = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
        let minus = |v: [f64; 3]| v.map(|x| 0.0 - x);
        assert_eq!(axes("0,0"), [x, y, z]);
        assert_eq!(axes("90,0,Y"), [minus(z), y, x]);
        assert_eq!(axes("0,90"), [x, minus(z), y]);
        assert_eq!(axes("0, 0, z"), [y, z, x]);
        assert_eq!(axes("-90,0,z"), [x, z, minus(y)]);
        assert_eq!(axes("-90,90,z"), [x, y, z]);
        for text in ["", "1", "0,91", "nan,0", "0,0,x", "0,0,y,1", "400,0"] {
            assert!(text.parse::<View>().is_err(), "{text}");
        }
    }
}
