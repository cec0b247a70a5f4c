//! Temporary stand-ins for file IO, generators and measures of `geobench-mesh`.
#![allow(missing_docs, clippy::missing_errors_doc, clippy::missing_panics_doc)]
use std::path::Path;

use geobench_mesh::{Mesh, TriangleSoup};

pub fn is_mesh_file(path: &Path) -> bool {
    path.extension().is_some_and(|e| e == "obj" || e == "off")
}

pub fn read(path: &Path) -> Result<TriangleSoup, String> {
    let text = std::fs::read_to_string(path).map_err(|e| format!("{}: {e}", path.display()))?;
    let (mut p, mut t) = (Vec::new(), Vec::new());
    for (n, line) in text.lines().enumerate() {
        let w: Vec<&str> = line.split_whitespace().collect();
        let bad = |_| {
            format!(
                "{}, line {}: `{line}` is not understood",
                path.display(),
                n + 1
            )
        };
        match w.first() {
            Some(&"v") => p.push([
                w[1].parse().map_err(bad)?,
                w[2].parse().map_err(bad)?,
                w[3].parse().map_err(bad)?,
            ]),
            Some(&"f") => {
                let i: Vec<u32> = w[1..]
                    .iter()
                    .map(|x| x.split('/').next().unwrap().parse::<u32>().unwrap() - 1)
                    .collect();
                for k in 2..i.len() {
                    t.push([i[0], i[k - 1], i[k]]);
                }
            }
            _ => {}
        }
    }
    Ok(TriangleSoup::new(p, t))
}

pub fn generate(spec: &str) -> Result<TriangleSoup, String> {
    let n: u32 = spec
        .rsplit('=')
        .next()
        .and_then(|n| n.parse().ok())
        .unwrap_or(20);
    if !spec.starts_with("grid") {
        return Err(format!("there is no generator `{spec}`"));
    }
    let p = (0..=n)
        .flat_map(|y| (0..=n).map(move |x| [f64::from(x), f64::from(y), 0.0]))
        .collect();
    let id = |x: u32, y: u32| y * (n + 1) + x;
    let t = (0..n)
        .flat_map(|y| {
            (0..n).flat_map(move |x| {
                [
                    [id(x, y), id(x + 1, y), id(x + 1, y + 1)],
                    [id(x, y), id(x + 1, y + 1), id(x, y + 1)],
                ]
            })
        })
        .collect();
    Ok(TriangleSoup::new(p, t))
}

pub fn edges(mesh: &Mesh) -> u64 {
    mesh.half_edges()
        .filter(|&h| mesh.twin(h).is_none_or(|t| h < t))
        .count() as u64
}
