//! Writing and reading back changes no bit.

use geobench_mesh::TriangleSoup;
use geobench_mesh::io::{Format, PlyEncoding, PlyWriter, read, write, write_obj};
use proptest::prelude::*;

use crate::parse;

/// Any finite coordinates, however extreme, and triangles that may name missing vertices.
fn soups() -> impl Strategy<Value = TriangleSoup> {
    let finite = any::<u64>()
        .prop_map(f64::from_bits)
        .prop_filter("finite", |x| x.is_finite());
    let coordinate = prop_oneof![finite, Just(-0.0), -10.0..10.0];
    let positions = prop::collection::vec(prop::array::uniform3(coordinate), 0..20);
    let vertex = prop_oneof![20 => 0..20u32, 1 => any::<u32>()];
    let triangles = prop::collection::vec(prop::array::uniform3(vertex), 1..20);
    (positions, triangles).prop_map(|(p, t)| TriangleSoup::new(p, t))
}

/// Bits, because 0 and -0 are equal.
fn bits(soup: &TriangleSoup) -> Vec<u64> {
    let positions = soup.positions.as_flattened();
    positions.iter().map(|x| x.to_bits()).collect()
}

proptest! {
    #[test]
    fn every_bit_comes_back(soup in soups()) {
        let mut files = vec![(Format::Obj, Vec::new())];
        write_obj(&mut files[0].1, &soup.positions, &soup.triangles).unwrap();
        let scalars: Vec<f64> = soup.positions.iter().map(|p| 1.0 / p[0]).collect();
        let colors = vec![[1, 2, 3]; soup.positions.len()];
        for encoding in [PlyEncoding::LittleEndian, PlyEncoding::BigEndian, PlyEncoding::Ascii] {
            let writer = PlyWriter::new(&soup.positions, &soup.triangles)
                .encoding(encoding)
                .comment("two\nlines");
            let with_more = writer.clone().scalars("quality", &scalars).colors(&colors);
            for writer in [writer, with_more] {
                let mut file = Vec::new();
                writer.write(&mut file).unwrap();
                files.push((Format::Ply, file));
            }
        }
        for (format, file) in files {
            let back = parse(format, &file).unwrap();
            prop_assert_eq!(bits(&back), bits(&soup));
            prop_assert_eq!(&back.triangles, &soup.triangles);
            prop_assert!(back.file_faces.is_empty());
        }
    }
}

#[test]
fn files_come_back_by_name() {
    let dir = tempfile::tempdir().unwrap();
    let soup = TriangleSoup::new(vec![[0.1, -0.0, 1e-310]; 3], vec![[0, 1, 2], [2, 1, 7]]);
    for name in [
        "a.obj", "a.PLY", "a.obj.gz", "a.ply.gz", "a.off", "a.off.gz",
    ] {
        let path = dir.path().join(name);
        write(&path, &soup).unwrap();
        let packed = std::fs::read(&path).unwrap().starts_with(b"\x1f\x8b");
        assert_eq!(packed, name.ends_with("gz"), "{name}");
        let back = read(&path).unwrap();
        assert_eq!(back, soup, "{name}");
        assert_eq!(bits(&back), bits(&soup), "{name}");
    }
}

#[test]
fn stl_files_have_the_triangles_in_single_precision() {
    let dir = tempfile::tempdir().unwrap();
    let positions = vec![[0.5, 0.0, 0.0], [0.1, 1.0, 0.0], [0.0, 0.0, 0.25], [4.0; 3]];
    let soup = TriangleSoup::new(positions, vec![[0, 1, 2], [2, 1, 3]]);
    for name in ["a.stl", "a.stl.gz"] {
        let path = dir.path().join(name);
        write(&path, &soup).unwrap();
        let back = read(&path).unwrap();
        assert_eq!(back.triangles.len(), 2, "{name}");
        for (corners, expected) in back.triangles.iter().zip(&soup.triangles) {
            let found = corners.map(|v| back.positions[v as usize]);
            let expected = expected.map(|v| soup.positions[v as usize]);
            assert_eq!(found, expected.map(|p| p.map(|x| f64::from(x as f32))));
        }
    }
    let missing = TriangleSoup::new(vec![[0.0; 3]; 3], vec![[0, 1, 7]]);
    let error = write(&dir.path().join("b.stl"), &missing).unwrap_err();
    assert!(error.to_string().contains("vertex 7"), "{error}");
}

#[test]
fn a_property_needs_a_value_for_each_vertex() {
    let positions = [[0.0; 3]; 3];
    let writer = PlyWriter::new(&positions, &[[0, 1, 2]]).scalars("quality", &[1.0]);
    let error = writer.write(&mut Vec::new()).unwrap_err();
    assert_eq!(
        error.to_string(),
        "a vertex property has 1 values for 3 vertices"
    );
}
