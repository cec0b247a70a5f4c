//! One element of a binary payload, as `ply-rs-bw` fills it in.

use std::fmt::{self, Display};

use ply_rs_bw::ply::{Property, PropertyAccess, PropertyAccessResult};

use super::header::is_corner_list;

/// An element of which nothing is wanted.
pub(super) struct Skipped;

impl PropertyAccess for Skipped {
    fn new() -> Self {
        Self
    }
}

/// A vertex: its coordinates, whatever type they are stored in.
pub(super) struct VertexRow {
    pub(super) position: [f64; 3],
}

impl VertexRow {
    fn set(&mut self, name: &str, value: f64) -> PropertyAccessResult {
        let axis = match name {
            "x" => 0,
            "y" => 1,
            "z" => 2,
            _ => return PropertyAccessResult::Ignored,
        };
        self.position[axis] = value;
        PropertyAccessResult::Set
    }
}

/// Implements the setters of all scalar types.
macro_rules! set_scalars {
    ($($setter:ident: $type:ty),*) => {
        $(fn $setter(&mut self, name: &str, value: $type) -> PropertyAccessResult {
            self.set(name, value.into())
        })*
    };
}

impl PropertyAccess for VertexRow {
    fn new() -> Self {
        Self { position: [0.0; 3] }
    }

    set_scalars!(
        set_char: i8, set_uchar: u8, set_short: i16, set_ushort: u16, set_int: i32, set_uint: u32,
        set_float: f32, set_double: f64
    );
}

/// A face: the list of its corners in the type the file has.
pub(super) struct FaceRow {
    /// `None` only before the list has been read.
    pub(super) corners: Option<Property>,
}

impl PropertyAccess for FaceRow {
    fn new() -> Self {
        Self { corners: None }
    }

    fn set_property(&mut self, name: &str, property: Property) -> PropertyAccessResult {
        if !is_corner_list(name) {
            return PropertyAccessResult::Ignored;
        }
        self.corners = Some(property);
        PropertyAccessResult::Set
    }
}

impl FaceRow {
    /// Appends the corners to `out`, or says which one is no vertex number.
    pub(super) fn corners(self, out: &mut Vec<u32>) -> Result<(), String> {
        match self.corners {
            Some(Property::ListInt(list)) => extend(out, list),
            Some(Property::ListUInt(list)) => extend(out, list),
            Some(Property::ListChar(list)) => extend(out, list),
            Some(Property::ListUChar(list)) => extend(out, list),
            Some(Property::ListShort(list)) => extend(out, list),
            Some(Property::ListUShort(list)) => extend(out, list),
            Some(Property::ListFloat(list)) => extend(out, list.into_iter().map(Whole::from)),
            Some(Property::ListDouble(list)) => extend(out, list.into_iter().map(Whole)),
            _ => Ok(()),
        }
    }
}

/// Appends values that are vertex numbers.
fn extend<T>(out: &mut Vec<u32>, values: impl IntoIterator<Item = T>) -> Result<(), String>
where
    T: TryInto<u32> + Copy + Display,
{
    for value in values {
        out.push(
            value.try_into().map_err(|_| {
                format!("{value} is no vertex number: they run from 0 to 4294967295")
            })?,
        );
    }
    Ok(())
}

/// A vertex number in a floating-point list, of which it may be any value that is whole.
#[derive(Clone, Copy)]
struct Whole(f64);

impl From<f32> for Whole {
    fn from(value: f32) -> Self {
        Self(value.into())
    }
}

impl TryFrom<Whole> for u32 {
    type Error = ();

    fn try_from(Whole(value): Whole) -> Result<Self, ()> {
        // The cast saturates, so that what is no whole number in range becomes a different one.
        let whole = value as i64;
        if whole as f64 == value {
            whole.try_into().map_err(|_| ())
        } else {
            Err(())
        }
    }
}

impl Display for Whole {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0.fmt(f)
    }
}
