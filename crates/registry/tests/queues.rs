//! Queues change times and nothing else.

use std::path::Path;

use geobench_mesh::{Mesh, VertexId};
use geobench_registry::{algorithms, select_one};
use geobench_window::Counter;

/// Meshes with many equal distances, with needles, with boundaries and without any of these.
const MESHES: [&str; 8] = [
    "grid,n=12",
    "cube,n=6",
    "sphere,subdiv=3",
    "terrain,n=16,seed=1",
    "torus,faces=1500,bump=0.2,seed=3",
    "holes",
    "anisotropic,faces=1000,g=6",
    "cylinder,slices=24,stacks=8",
];

type Counts = Vec<(Counter, Option<u64>)>;

fn counts(label: &str, mesh: &Mesh, sources: &[VertexId]) -> (Vec<f64>, Counts) {
    let mut solver = select_one(label).unwrap().build(mesh);
    let (solution, counters) = solver.count(sources).unwrap();
    (solution.distances, counters.iter().collect())
}

/// The binary heap, the 4-ary heap and the calendar queue take events in one order, ties included:
/// all distances and counts are equal to the digit.
#[test]
fn heaps_and_calendar_give_the_same_counts() {
    let of_queue = |name: &str| {
        ["heap4", "calendar"].map(|queue| (name.to_owned(), format!("{name}{{queue={queue}}}")))
    };
    let queued = algorithms().iter().filter(|algorithm| {
        let mut parameters = algorithm.parameters.iter();
        parameters.any(|p| p.name == "queue" && p.allowed.words.contains(&"calendar"))
    });
    let mut pairs: Vec<(String, String)> = queued.flat_map(|a| of_queue(a.name)).collect();
    assert!(pairs.len() >= 10, "{pairs:?}");
    pairs.push(("ich".to_owned(), "ich-fast".to_owned()));
    for filter in ["vertices", "none"] {
        for queue in ["heap4", "calendar"] {
            let [heap, other] =
                ["heap", queue].map(|q| format!("lct11{{queue={q},filter={filter}}}"));
            pairs.push((heap, other));
        }
    }
    for spec in MESHES {
        let mesh = Mesh::generate(spec).unwrap();
        let last = mesh.vertex_count() as u32 - 1;
        for sources in [vec![0], vec![last / 2], vec![0, last / 3, last]] {
            let sources: Vec<VertexId> = sources.into_iter().map(VertexId::new).collect();
            for (heap, other) in &pairs {
                let same = counts(heap, &mesh, &sources) == counts(other, &mesh, &sources);
                assert!(same, "{heap} and {other} on {spec} from {sources:?}");
            }
        }
    }
}

/// The table of `docs/algorithms` has a row for each algorithm, with its queue and crossing.
#[test]
fn the_table_of_names_is_complete() {
    let path = "../../docs/algorithms/README.md";
    let page = std::fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join(path)).unwrap();
    for algorithm in algorithms() {
        let row = format!(
            "\n| `{}` | {} | {} | ",
            algorithm.name, algorithm.queue, algorithm.crossing
        );
        assert_eq!(page.matches(&row).count(), 1, "{row}");
    }
}
