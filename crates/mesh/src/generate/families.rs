//! The table of families that can be generated.

use std::fmt::{self, Write as _};

use super::keys::{Key, Kind, Params};
use super::modifiers::MODIFIER_KEYS;
use super::{
    GenerateError, anisotropic, block, corridor, knot, plate, revolve, solid, terrain, torus,
};
use crate::soup::TriangleSoup;

/// A family of models: one line of the table.
pub struct Family {
    /// The name after `gen:`.
    pub name: &'static str,
    /// Other names for it.
    pub aliases: &'static [&'static str],
    /// A description of one line.
    pub summary: &'static str,
    /// The keys of this family. All families take [`MODIFIER_KEYS`] as well.
    pub keys: &'static [Key],
    /// Whether the shape depends on the seed.
    pub seeding: Seeding,
    /// How the shape is made; `None` for a file, which the caller reads.
    pub(super) shape: Option<Shape>,
}

/// When a shape depends on the seed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Seeding {
    /// It does not.
    Never,
    /// It does.
    Always,
    /// It does where the value of this key, a number, is not 0.
    With(&'static str),
}

/// How a shape is made.
pub(super) struct Shape {
    /// The exact number of triangles, without making the shape, or why it cannot be made.
    pub(super) faces: fn(&Params<'_>) -> Result<u64, GenerateError>,
    pub(super) build: fn(&Params<'_>) -> Result<TriangleSoup, GenerateError>,
}

impl fmt::Debug for Family {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_tuple("Family").field(&self.name).finish()
    }
}

/// The shape of a family that can make every one of its specs.
macro_rules! shape {
    ($faces:path, $build:path) => {
        Some(Shape {
            faces: |params| Ok($faces(params)),
            build: |params| Ok($build(params)),
        })
    };
}

/// All families: flat ones, solids, round ones, special ones, and files.
pub const FAMILIES: &[Family] = &[
    Family {
        name: "grid",
        aliases: &["plane"],
        summary: "flat rectangle of square cells cut in two",
        keys: plate::GRID_KEYS,
        seeding: Seeding::With("jitter"),
        shape: shape!(plate::grid_faces, plate::grid),
    },
    Family {
        name: "holes",
        aliases: &["plate"],
        summary: "flat plate with rows of rectangular holes",
        keys: plate::HOLES_KEYS,
        seeding: Seeding::With("jitter"),
        shape: shape!(plate::holes_faces, plate::holes),
    },
    Family {
        name: "strip",
        aliases: &["needles"],
        summary: "flat strip of needles, all vertices on the boundary",
        keys: plate::STRIP_KEYS,
        seeding: Seeding::Never,
        shape: shape!(plate::strip_faces, plate::strip),
    },
    Family {
        name: "corridor",
        aliases: &[],
        summary: "flat corridor that reaches the bounds: n^2 windows, and n^3 with holes and no order",
        keys: corridor::KEYS,
        seeding: Seeding::Never,
        shape: shape!(corridor::faces, corridor::build),
    },
    Family {
        name: "terrain",
        aliases: &[],
        summary: "fractal landscape over the unit square, with boundary and many saddles",
        keys: terrain::KEYS,
        seeding: Seeding::Always,
        shape: shape!(terrain::faces, terrain::build),
    },
    Family {
        name: "tetrahedron",
        aliases: &[],
        summary: "regular tetrahedron with edges of length 1",
        keys: solid::TETRAHEDRON_KEYS,
        seeding: Seeding::Never,
        shape: shape!(solid::tetrahedron_faces, solid::tetrahedron),
    },
    Family {
        name: "cube",
        aliases: &[],
        summary: "cube with one corner at the origin",
        keys: block::CUBE_KEYS,
        seeding: Seeding::Never,
        shape: shape!(block::cube_faces, block::cube),
    },
    Family {
        name: "box",
        aliases: &["cuboid"],
        summary: "box with one corner at the origin",
        keys: block::BOX_KEYS,
        seeding: Seeding::Never,
        shape: shape!(block::box_faces, block::cuboid),
    },
    Family {
        name: "octahedron",
        aliases: &[],
        summary: "regular octahedron with edges of length 1",
        keys: solid::OCTAHEDRON_KEYS,
        seeding: Seeding::Never,
        shape: shape!(solid::octahedron_faces, solid::octahedron),
    },
    Family {
        name: "icosahedron",
        aliases: &[],
        summary: "regular icosahedron with edges of length 1",
        keys: solid::ICOSAHEDRON_KEYS,
        seeding: Seeding::Never,
        shape: shape!(solid::icosahedron_faces, solid::icosahedron),
    },
    Family {
        name: "sphere",
        aliases: &["icosphere"],
        summary: "sphere of radius 1 from a subdivided icosahedron",
        keys: solid::SPHERE_KEYS,
        seeding: Seeding::Never,
        shape: shape!(solid::icosahedron_faces, solid::sphere),
    },
    Family {
        name: "uvsphere",
        aliases: &[],
        summary: "sphere of radius 1 from meridians and parallels",
        keys: revolve::UVSPHERE_KEYS,
        seeding: Seeding::Never,
        shape: shape!(revolve::uvsphere_faces, revolve::uvsphere),
    },
    Family {
        name: "cylinder",
        aliases: &["prism"],
        summary: "cylinder of radius 1, exactly a prism",
        keys: revolve::CYLINDER_KEYS,
        seeding: Seeding::Never,
        shape: shape!(revolve::cylinder_faces, revolve::cylinder),
    },
    Family {
        name: "cone",
        aliases: &["pyramid"],
        summary: "cone of a given angle at the apex, vertex 0, its edges of length 1",
        keys: revolve::CONE_KEYS,
        seeding: Seeding::Never,
        shape: Some(Shape {
            faces: revolve::cone_faces,
            build: |params| Ok(revolve::cone(params)),
        }),
    },
    Family {
        name: "torus",
        aliases: &[],
        summary: "torus, plain or bumpy",
        keys: torus::KEYS,
        seeding: Seeding::With("bump"),
        shape: shape!(torus::faces, torus::build),
    },
    Family {
        name: "knot",
        aliases: &["trefoil"],
        summary: "tube along a trefoil knot",
        keys: knot::KEYS,
        seeding: Seeding::Never,
        shape: shape!(knot::faces, knot::build),
    },
    Family {
        name: "anisotropic",
        aliases: &[],
        summary: "torus with triangles stretched to a wanted mean g, its shape unchanged",
        keys: anisotropic::KEYS,
        seeding: Seeding::Never,
        shape: Some(Shape {
            faces: anisotropic::faces,
            build: anisotropic::build,
        }),
    },
    Family {
        name: "file",
        aliases: &[],
        summary: "a model file, for the keys that change any model",
        keys: FILE_KEYS,
        seeding: Seeding::Never,
        shape: None,
    },
];

const FILE_KEYS: &[Key] = &[Key {
    name: "path",
    kind: Kind::Path,
    summary: "the file; in quotation marks, doubled within, if it has a comma",
}];

/// All families and keys as text, one to a line.
pub fn help() -> String {
    let mut text = String::from("gen:FAMILY[,key=value...] with these families and keys:\n");
    for family in FAMILIES {
        // Writing to a string cannot fail.
        let _ = write!(text, "\n  {:<13}{}", family.name, family.summary);
        if !family.aliases.is_empty() {
            let _ = write!(text, " (also {})", family.aliases.join(", "));
        }
        text.push('\n');
        for key in family.keys {
            describe(&mut text, key);
        }
    }
    text.push_str("\n  every family also takes\n");
    for key in MODIFIER_KEYS {
        describe(&mut text, key);
    }
    text
}

fn describe(text: &mut String, key: &Key) {
    let default = key
        .default()
        .map_or_else(String::new, |value| format!("={value}"));
    let setting = format!("{}{default}", key.name);
    let range = match key.kind {
        Kind::Path => String::new(),
        _ => format!(" ({})", key.range()),
    };
    let _ = writeln!(text, "    {setting:<18} {}{range}", key.summary);
}
