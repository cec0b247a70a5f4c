//! The real models that the project shares, if they are there.

use std::io::Write;
use std::path::PathBuf;

use geobench_mesh::io::{Format, read};

use crate::tobj;

/// Name, vertices, faces, and the first vertex and the last face as the files spell them.
type Expected = (&'static str, usize, usize, [f64; 3], [u32; 3]);

/// The directory that holds the models: `$GEOBENCH_SHARED/models`, or beside the repository.
pub(crate) fn models() -> PathBuf {
    let shared = std::env::var_os("GEOBENCH_SHARED").map_or_else(
        || PathBuf::from(concat!(env!("CARGO_MANIFEST_DIR"), "/../../../shared")),
        PathBuf::from,
    );
    shared.join("models")
}

#[test]
fn shared_models_load() {
    let expected: [Expected; 9] = [
        (
            "cow.off",
            2904,
            5804,
            [2.292_449, -0.871_852, -0.8824],
            [1986, 2897, 1984],
        ),
        ("cube20.obj", 2402, 4800, [0.0, 0.0, 0.0], [2401, 881, 1679]),
        (
            "grid60.obj",
            3721,
            7200,
            [0.0, 0.0, 0.0],
            [3658, 3720, 3659],
        ),
        (
            "horse.obj",
            48485,
            96966,
            [
                -0.002_022_000_029_683_113,
                -0.040_178_500_115_871_43,
                -0.000_863_000_284_880_399_7,
            ],
            [36524, 36444, 36443],
        ),
        (
            "igea.ply",
            134_345,
            268_686,
            [
                0.008_178_000_338_375_568,
                -0.049_651_000_648_736_954,
                0.014_658_000_320_196_152,
            ],
            [133_838, 134_344, 133_836],
        ),
        (
            "int80.obj",
            6561,
            12800,
            [0.0, 0.0, 3.0],
            [6478, 6560, 6479],
        ),
        (
            "spot.obj",
            2930,
            5856,
            [0.348_799, -0.334_989, -0.083_233_1],
            [2923, 733, 2929],
        ),
        (
            "stanford-bunny.obj",
            34834,
            69451,
            [-0.03783, 0.12794, 0.004_475],
            [16683, 16743, 16742],
        ),
        (
            "suzanne.obj",
            441,
            854,
            [-2.290_937, 1.345_436, 4.84608],
            [256, 324, 438],
        ),
    ];
    for (name, vertices, faces, first, last) in expected {
        let path = models().join(name);
        if !path.exists() {
            // Not eprintln, which the test harness hides when the test passes.
            let message = format!("SKIPPED: no {}; set GEOBENCH_SHARED\n", path.display());
            std::io::stderr().write_all(message.as_bytes()).unwrap();
            continue;
        }
        let soup = read(&path).unwrap();
        assert_eq!(soup.positions.len(), vertices, "{name}");
        assert_eq!(soup.triangles.len(), faces, "{name}");
        assert_eq!(soup.positions[0], first, "{name}");
        assert_eq!(soup.triangles.last(), Some(&last), "{name}");
        assert!(soup.file_faces.is_empty(), "{name}");
        if Format::from_path(&path) == Some(Format::Obj) {
            let other = tobj(std::fs::read(&path).unwrap()).unwrap();
            assert!(other == soup, "{name}");
        }
    }
}
