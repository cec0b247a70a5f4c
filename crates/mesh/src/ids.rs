//! Typed 4-byte numbers of mesh elements.

use std::fmt;

macro_rules! id {
    ($(#[$doc:meta])* $name:ident, $noun:literal) => {
        $(#[$doc])*
        #[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Default)]
        #[repr(transparent)]
        pub struct $name(u32);

        impl $name {
            #[doc = concat!("The id of ", $noun, " number `index`, counted from 0.")]
            #[inline]
            pub const fn new(index: u32) -> Self {
                Self(index)
            }

            /// The number.
            #[inline]
            pub const fn raw(self) -> u32 {
                self.0
            }

            /// The number as an index of arrays.
            #[inline]
            pub const fn index(self) -> usize {
                self.0 as usize
            }
        }

        impl fmt::Display for $name {
            fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                fmt::Display::fmt(&self.0, f)
            }
        }

        impl fmt::Debug for $name {
            fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                write!(f, concat!($noun, " {}"), self.0)
            }
        }
    };
}

id!(
    /// A vertex: its 0-based number in the file.
    VertexId,
    "vertex"
);
id!(
    /// A face: its 0-based number among the triangles of the mesh.
    FaceId,
    "face"
);
id!(
    /// A half-edge. Half-edge `3 * face + corner` runs from that corner to the next one.
    HalfEdgeId,
    "half-edge"
);

impl From<u32> for VertexId {
    fn from(index: u32) -> Self {
        Self(index)
    }
}

impl From<u32> for FaceId {
    fn from(index: u32) -> Self {
        Self(index)
    }
}

impl FaceId {
    /// The half-edge that leaves corner `corner` (0, 1 or 2) of this face.
    #[inline]
    pub const fn half_edge(self, corner: u32) -> HalfEdgeId {
        HalfEdgeId(3 * self.0 + corner)
    }

    /// The half-edges of this face; the first one leaves corner 0.
    #[inline]
    pub const fn half_edges(self) -> [HalfEdgeId; 3] {
        [self.half_edge(0), self.half_edge(1), self.half_edge(2)]
    }
}

impl HalfEdgeId {
    /// The face of this half-edge, which lies on its left.
    #[inline]
    pub const fn face(self) -> FaceId {
        FaceId(self.0 / 3)
    }

    /// The corner of the face at which this half-edge starts.
    #[inline]
    pub const fn corner(self) -> u32 {
        self.0 % 3
    }

    /// The next half-edge around the face.
    #[inline]
    #[must_use]
    pub const fn next(self) -> Self {
        Self(if self.0 % 3 == 2 {
            self.0 - 2
        } else {
            self.0 + 1
        })
    }

    /// The previous half-edge around the face.
    #[inline]
    #[must_use]
    pub const fn prev(self) -> Self {
        Self(if self.0.is_multiple_of(3) {
            self.0 + 2
        } else {
            self.0 - 1
        })
    }
}
