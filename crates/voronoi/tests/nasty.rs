//! Remeshing of random nasty meshes takes little time and memory; it gives a mesh or a reason.

#[path = "../../mesh/tests/processor_time/mod.rs"]
mod processor_time;

use std::env;
use std::time::Duration;

use geobench_mesh::{Mesh, TriangleSoup};
use geobench_oracle::nasty;
use geobench_voronoi::{RemeshOptions, remesh};
use processor_time::ProcessorTime;

/// The number in the environment variable `name`, for more seeds than by default.
fn number(name: &str, default: u64) -> u64 {
    env::var(name).map_or(default, |text| text.parse().unwrap())
}

/// The most memory of this process so far, in KiB; 0 where the system does not tell it.
fn peak() -> u64 {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"));
    let number = line.and_then(|line| line.split_whitespace().next());
    number.map_or(0, |number| number.parse().unwrap())
}

#[test]
fn nasty_meshes_are_remeshed_or_refused() {
    const MOST_MEMORY: u64 = 1 << 20;
    const MOST_TIME: Duration = Duration::from_secs(30);
    for seed in number("FROM", 0)..number("TO", 200) {
        let model = nasty::mesh(seed).model;
        let positions = model.positions().unwrap().to_vec();
        let Ok((mesh, _)) = Mesh::from_soup(TriangleSoup::new(positions, model.triangles)) else {
            continue;
        };
        for sites in [1, 3, 10] {
            let options = RemeshOptions {
                sites,
                lloyd: 1,
                seed,
            };
            let start = ProcessorTime::now();
            // A mesh or a reason.
            let made = remesh(&mesh, &options);
            let (time, memory) = (start.elapsed(), peak());
            assert!(
                time < MOST_TIME && memory < MOST_MEMORY,
                "{}: {sites} sites took {time:?} and {memory} KiB: {:?}",
                model.name,
                made.map(|made| made.sites.len())
            );
        }
    }
}
