//! The built-in suite: generated models that need no file.

/// Closed and open surfaces, with and without handles, of even and of slender triangles, each of
/// some 5,000 to 20,000 faces; all algorithms together take well under a minute.
pub const MODELS: &[&str] = &[
    "gen:sphere,subdiv=4",
    "gen:torus,faces=20000,bump=0.1,seed=7",
    "gen:knot,faces=10000",
    "gen:terrain,n=100,seed=1",
    "gen:holes",
    "gen:anisotropic,faces=10000,g=4",
];
