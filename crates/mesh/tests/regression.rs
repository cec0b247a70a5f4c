//! Fixed defects, each as a test named after what went wrong.

mod processor_time;

use std::fmt::Write as _;
use std::io::Write;
use std::path::Path;
use std::time::Duration;

use flate2::Compression;
use flate2::write::GzEncoder;
use geobench_mesh::io::{self, FileError, Format, ReadOptions};
use geobench_mesh::{FaceId, Mesh};
use processor_time::ProcessorTime;

/// Gzip data of many members that each hold a mebibyte of spaces, `mebibytes` in total.
fn bomb(mebibytes: usize) -> Vec<u8> {
    let mut member = GzEncoder::new(Vec::new(), Compression::best());
    member.write_all(&vec![b' '; 1 << 20]).unwrap();
    member.finish().unwrap().repeat(mebibytes)
}

#[test]
fn a_small_gzip_file_took_gigabytes() {
    let bytes = bomb(3000);
    let limit = io::usual_decompression_limit(bytes.len() as u64);
    for format in [Format::Obj, Format::Ply, Format::Off, Format::Stl] {
        let error = io::read_bytes(&bytes, format, Path::new("bomb.gz")).unwrap_err();
        let FileError::TooLarge { limit: at, .. } = error else {
            panic!("{error}");
        };
        assert_eq!(at, limit);
        assert_eq!(
            error.to_string(),
            format!(
                "bomb.gz: its {} bytes decompress to more than {limit}, the limit; raise the limit \
                 if the file can be trusted",
                bytes.len()
            )
        );
    }
}

#[test]
fn a_gzip_file_within_the_limit_is_read() {
    let mut bytes = bomb(1);
    let mut mesh = GzEncoder::new(Vec::new(), Compression::best());
    mesh.write_all(b"\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")
        .unwrap();
    bytes.extend(mesh.finish().unwrap());
    let size = (1 << 20) + 33;
    let read = |max_decompressed| {
        let options = ReadOptions {
            max_decompressed,
            ..ReadOptions::default()
        };
        options.read_bytes(&bytes, Format::Obj, Path::new("m.gz"))
    };
    assert_eq!(read(None).unwrap().triangles, [[0, 1, 2]]);
    assert_eq!(read(Some(size)).unwrap().triangles, [[0, 1, 2]]);
    assert!(matches!(
        read(Some(size - 1)),
        Err(FileError::TooLarge { .. })
    ));
}

#[test]
fn a_polygon_of_many_corners_took_hours() {
    // A star that winds seven times around its centre: no corner is an ear.
    let corners: u32 = 200_000;
    let mut file = String::new();
    for i in 0..corners {
        let angle = f64::from(i) / f64::from(corners) * 7.0 * std::f64::consts::TAU;
        let radius = if i % 2 == 0 { 1.0 } else { 0.5 };
        let (x, y) = (radius * angle.cos(), radius * angle.sin());
        writeln!(file, "v {x} {y} 0").unwrap();
    }
    file.push('f');
    (1..=corners).for_each(|i| write!(file, " {i}").unwrap());
    let start = ProcessorTime::now();
    let error = io::read_bytes(file.as_bytes(), Format::Obj, Path::new("star.obj")).unwrap_err();
    assert_eq!(
        error.to_string(),
        "star.obj: face 0, counted from 0, has 200000 corners and is not convex, so that cutting \
         it into triangles takes too long; cut it into smaller faces"
    );
    assert!(start.elapsed() < Duration::from_secs(60));
}

/// Splits a face with one side, `short`, far shorter than the others at `points`, given as weights
/// of its corners, for each choice of the first corner.
fn check_split_of_a_needle(short: [f64; 2], points: &[[f64; 3]]) {
    let [x, y] = short;
    let positions = [[0.0; 3], [1.0, 0.0, 0.0], [1.0 + x, y, 0.0]];
    for turn in 0..3 {
        let turned = |w: [f64; 3]| [0, 1, 2].map(|k| w[(k + turn) % 3]);
        let corners = [0, 1, 2].map(|k| positions[(k + turn) % 3]);
        let mesh = Mesh::new(corners.to_vec(), vec![[0, 1, 2]]).unwrap();
        let point = |w: &[f64; 3]| mesh.point_in_face(FaceId::new(0), turned(*w)).unwrap();
        let points: Vec<_> = points.iter().map(point).collect();
        let refined = mesh.with_points(&points).unwrap();
        refined.mesh.sanity_check().unwrap();
    }
}

/// The direction of the short side was the difference of the two long ones. The parts then had
/// other angles than the face, and a distance behind it was a thousandth too short.
#[test]
fn a_point_on_a_long_side_of_a_needle_changed_its_angles() {
    for x in [-2e-14, 1e-15, 2e-14] {
        check_split_of_a_needle([x, 9e-15], &[[0.2, 0.8, 0.0]]);
        check_split_of_a_needle([x, 9e-15], &[[0.3, 0.0, 0.7], [0.3, 0.7, 0.0]]);
    }
}

/// The area was the difference of two products that agree to nine digits.
#[test]
fn a_part_beside_a_corner_had_another_area() {
    let beside = [6e-10, 0.0, 1.0 - 6e-10];
    check_split_of_a_needle([5e-11, 1.4e-10], &[[0.0, 0.63, 0.37], beside]);
    check_split_of_a_needle([5e-11, 1.4e-10], &[[0.0, 0.37, 0.63], beside]);
}

/// The direction was the sum of two nearly opposite long vectors.
#[test]
fn a_short_line_across_a_needle_had_another_length() {
    let (a, b) = (0.008_062_796_637_315_572, 0.008_062_796_638_285_685);
    let points = [[a, 1.0 - a, 0.0], [0.0, 1.0 - b, b]];
    check_split_of_a_needle([2e-11, 1.2e-10], &points.map(|[x, y, z]| [y, z, x]));
}

#[test]
fn counts_beside_the_keyword_of_an_off_file_were_refused() {
    let text = b"OFF3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";
    let soup = io::read_bytes(text, Format::Off, Path::new("a.off")).unwrap();
    assert_eq!((soup.positions.len(), soup.triangles), (3, vec![[0, 1, 2]]));
}

#[test]
fn padding_after_a_gzip_file_was_taken_for_another_member() {
    let mut member = GzEncoder::new(Vec::new(), Compression::best());
    member
        .write_all(b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")
        .unwrap();
    let mut bytes = member.finish().unwrap();
    bytes.extend([0; 100]);
    let soup = io::read_bytes(&bytes, Format::Obj, Path::new("a.obj.gz")).unwrap();
    assert_eq!(soup.triangles, [[0, 1, 2]]);
}

#[test]
fn coordinates_became_infinite_in_stl_files() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("large.stl");
    let soup = io::read_bytes(
        b"v 0 0 0\nv 1e50 0 0\nv 0 1e50 0\nf 1 2 3\n",
        Format::Obj,
        Path::new("large.obj"),
    );
    let error = io::write(&path, &soup.unwrap()).unwrap_err().to_string();
    assert!(
        error.contains("1e50 is too large for the single precision of STL"),
        "{error}"
    );
}

#[test]
fn a_convex_polygon_of_many_corners_was_refused() {
    let corners: u32 = 50_000;
    let mut file = String::new();
    for i in 0..corners {
        let (sin, cos) = (f64::from(i) / f64::from(corners) * std::f64::consts::TAU).sin_cos();
        writeln!(file, "v {cos} {sin} 0").unwrap();
    }
    file.push('f');
    (1..=corners).for_each(|i| write!(file, " {i}").unwrap());
    let soup = io::read_bytes(file.as_bytes(), Format::Obj, Path::new("disc.obj")).unwrap();
    assert_eq!(soup.triangles.len(), corners as usize - 2);
    assert_eq!(soup.triangles[..2], [[0, 1, 2], [0, 2, 3]]);
}

#[test]
fn binary_data_decided_how_the_lines_of_a_ply_header_end() {
    let header = "ply\rformat binary_little_endian 1.0\relement vertex 3\rproperty float x\r\
                  property float y\rproperty float z\relement face 1\r\
                  property list uchar int vertex_indices\rend_header\r";
    let mut file = header.as_bytes().to_vec();
    // The bytes of the first number are line feeds.
    let line_feeds = f32::from_le_bytes([b'\n'; 4]);
    for x in [line_feeds, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0] {
        file.extend(x.to_le_bytes());
    }
    file.push(3);
    file.extend([0_i32, 1, 2].map(i32::to_le_bytes).as_flattened());
    let soup = io::read_bytes(&file, Format::Ply, Path::new("m.ply")).unwrap();
    assert_eq!(soup.triangles, [[0, 1, 2]]);
    assert_eq!(soup.positions[0][0], f64::from(line_feeds));
}

#[test]
fn a_face_that_names_its_corners_twice_was_said_to_repeat_itself() {
    let (_, report) = Mesh::from_soup(
        io::read_bytes(
            b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3 1 2 3\n",
            Format::Obj,
            Path::new("m.obj"),
        )
        .unwrap(),
    )
    .unwrap();
    let texts: Vec<String> = report.summaries().into_iter().map(|s| s.text).collect();
    let texts = texts.join("\n");
    assert!(!texts.contains("face 0 repeats face 0"), "{texts}");
}
