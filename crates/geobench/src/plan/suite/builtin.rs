//! What runs where nothing is named: generated models that need no file, and the algorithms that
//! the papers compare with each other.

/// Closed and open surfaces, with and without handles, of even and of slender triangles, each of
/// some 3,000 to 20,000 faces; the [`ALGORITHMS`] take well under a minute for all.
pub const MODELS: &[&str] = &[
    "gen:sphere,subdiv=4",
    "gen:torus,faces=20000,bump=0.1,seed=7",
    "gen:knot,faces=10000",
    "gen:terrain,n=100,seed=1",
    "gen:holes",
    "gen:anisotropic,faces=10000,g=4",
];

/// Surfaces of the same kinds on which even the slowest algorithm ends within seconds, to compare
/// answers and not times.
pub const SMALL_MODELS: &[&str] = &[
    "gen:sphere,subdiv=3",
    "gen:torus,faces=1200,bump=0.1,seed=7",
    "gen:knot,faces=1500",
    "gen:terrain,n=24,seed=1",
    "gen:holes",
    "gen:anisotropic,faces=1200,g=4",
];

/// The algorithms of the comparisons in the papers. The others are variants of these, made to
/// show what one of their parts does, and some are slower by orders of magnitude.
pub const ALGORITHMS: &[&str] = &["mmp", "ich", "fwp-mmp", "fwp-ch", "vtp"];
