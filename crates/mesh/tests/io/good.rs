//! Files as they are found in the wild, and what must be read from them.

use geobench_mesh::TriangleSoup;
use geobench_mesh::io::{Format, is_mesh_file, read};

use crate::samples::{self, POSITIONS, TRIANGLES};
use crate::{gzip, parse, tobj};

/// Reads an OBJ file. The second reader makes the same of it, unless a vertex is missing.
fn obj(text: &str) -> TriangleSoup {
    let soup = parse(Format::Obj, text).unwrap();
    let vertices = 0..soup.positions.len() as u32;
    match tobj(text) {
        // As text, since NaN is not equal to itself.
        Ok(other) => assert_eq!(format!("{other:?}"), format!("{soup:?}")),
        Err(error) => {
            let message = "test: tobj cannot read it: face vertex index out of bounds";
            assert_eq!(error.to_string(), message);
            let corners = soup.triangles.as_flattened();
            assert!(corners.iter().any(|corner| !vertices.contains(corner)));
        }
    }
    soup
}

#[test]
fn every_sample_holds_the_same_mesh() {
    for (name, format, bytes) in samples::all() {
        for bytes in [&bytes, &gzip(&bytes)] {
            let soup = parse(format, bytes).unwrap();
            assert_eq!(soup.positions, POSITIONS, "{name}");
            assert_eq!(soup.triangles, TRIANGLES, "{name}");
            assert!(soup.file_faces.is_empty(), "{name}");
        }
    }
}

#[test]
fn files_are_found_and_read_by_their_names() {
    let dir = tempfile::tempdir().unwrap();
    let all = samples::all();
    for (name, extension, sample) in [
        ("a.OBJ", "obj", 0),
        ("b.ply", "ply", 2),
        ("c.off.gz", "off", 4),
        ("d.stl", "stl", 6),
    ] {
        let path = dir.path().join(name);
        let bytes = &all[sample].2;
        // Compressed content is recognised with and without the ending.
        for bytes in [bytes, &gzip(bytes)] {
            std::fs::write(&path, bytes).unwrap();
            assert_eq!(read(&path).unwrap().triangles, TRIANGLES, "{extension}");
        }
        assert!(is_mesh_file(&path));
    }
    assert!(!is_mesh_file(&dir.path().join("notes.txt")));
}

#[test]
fn obj_keeps_the_numbers_of_the_file() {
    // Used backwards, the first vertex not at all, one only after its use.
    let soup = obj("v 9 9 9\nv 0 0 0\nv 1 0 0\nf 5 3 2\nv 0 1 0\nv 0.1 1e-3 -0.0\nf 4 5 2\n");
    assert_eq!(soup.positions.len(), 5);
    assert_eq!(soup.positions[4], [0.1, 1e-3, -0.0]);
    assert!(soup.positions[4][2].is_sign_negative());
    assert_eq!(soup.triangles, [[4, 2, 1], [3, 4, 1]]);
}

#[test]
fn obj_is_not_split_by_seams_groups_or_materials() {
    let soup = obj(
        "mtllib missing.mtl\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\nvt 1 1\nvn 0 0 1\n\
         o a\ng a b\nusemtl x\ns 1\nf 1/1/1 2/2/1 3/1/1\nusemtl y\ng\nf 1/2/1 3/2/1 4//1\n\
         usemtl\no\nf 1/9/9 2/9/9 4/9/9\n",
    );
    assert_eq!(soup.positions.len(), 4);
    assert_eq!(soup.triangles, [[0, 1, 2], [0, 2, 3], [0, 1, 3]]);
}

#[test]
fn obj_lines_may_be_written_in_any_way() {
    let soup = obj(
        "\u{feff}v\t0 0\t0\r\n  v 1 0 0 # one\r\nv 1 \\\r\n 1 0\r\nv 0 1 0 0.1 0.2 0.3\r\n\
         v 1 2 3 1.0\r\nv 7 7 7 1 1 1 1\r\n\r\n#f 9 9 9\r\nf 1 \\ # more\n2 \\\n 3#4\nf -6 -4 -3 \nf +1 5 6",
    );
    assert_eq!(soup.positions[2], [1.0, 1.0, 0.0]);
    assert_eq!(soup.positions[4], [1.0, 2.0, 3.0]);
    assert_eq!(soup.positions[5], [7.0, 7.0, 7.0]);
    assert_eq!(soup.triangles, [[0, 1, 2], [0, 2, 3], [0, 4, 5]]);
}

#[test]
fn obj_relative_numbers_count_from_where_they_stand() {
    let soup = obj("v 0 0 0\nv 1 0 0\nv 0 1 0\nf -3 -2 -1\nv 5 5 5\nf -1 -2 -3\nf 4 9 1\n");
    // The missing vertex 9 changes neither its neighbours nor the relative ones.
    assert_eq!(soup.triangles, [[0, 1, 2], [3, 2, 1], [3, 8, 0]]);
    assert_eq!(soup.positions.len(), 4);
}

#[test]
fn vertices_beyond_the_last_are_left_to_validation() {
    let obj = obj("v 0 0 0\nf 1 2 4294967296\nf 4294967296 1 2\n");
    assert_eq!(obj.triangles, [[0, 1, u32::MAX], [u32::MAX, 0, 1]]);
    let off = parse(Format::Off, "OFF 1 1 0\n0 0 0\n3 0 1 4294967295\n").unwrap();
    assert_eq!(off.triangles, [[0, 1, u32::MAX]]);
    let ply = "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\n\
               property float z\nelement face 1\nproperty list int uint vertex_index\nend_header\n\
               0 0 0\n4 0 1 2 4294967295\n";
    let ply = parse(Format::Ply, ply).unwrap();
    assert_eq!(ply.triangles, [[0, 1, 2], [0, 2, u32::MAX]]);
}

#[test]
fn coordinates_that_are_not_finite_are_left_to_validation() {
    let soup = obj("v nan inf -inf\nv 1e999 0 0\nv 0 0 0\nf 1 2 3\n");
    assert!(soup.positions[0][0].is_nan());
    assert_eq!(soup.positions[0][1..], [f64::INFINITY, f64::NEG_INFINITY]);
    assert_eq!(soup.positions[1][0], f64::INFINITY);
}

#[test]
fn polygons_are_cut_the_same_way_in_every_format() {
    // A convex pentagon, a dart whose reflex corner is the second, a face of two corners.
    let vertices = "0 0 0\n2 0 0\n3 1 0\n1 3 0\n-1 1 0\n1 1 0\n1 4 0\n";
    let triangles = [[0, 1, 2], [0, 2, 3], [0, 3, 4], [2, 6, 5], [4, 5, 6]];
    let v = vertices.replace('\n', "\nv ");
    let v = v.trim_end_matches("v ");
    let obj = format!("v {v}f 1 2 3 4 5\nf 1 2\nf 5 6 3 7\n");
    let off = format!("OFF\n7 3 0\n{vertices}5 0 1 2 3 4\n2 0 1\n4 4 5 2 6\n");
    let ply = format!(
        "ply\nformat ascii 1.0\nelement vertex 7\nproperty double x\nproperty double y\n\
         property double z\nelement face 3\nproperty list uchar int vertex_indices\nend_header\n\
         {vertices}5 0 1 2 3 4\n2 0 1\n4 4 5 2 6\n"
    );
    for (format, file) in [(Format::Obj, obj), (Format::Off, off), (Format::Ply, ply)] {
        let soup = parse(format, file).unwrap();
        let sorted = |t: &[u32; 3]| {
            let mut t = *t;
            let first = (0..3).min_by_key(|&i| t[i]).unwrap();
            t.rotate_left(first);
            t
        };
        let found: Vec<_> = soup.triangles.iter().map(sorted).collect();
        assert_eq!(found, triangles.map(|t| sorted(&t)), "{format:?}");
        assert_eq!(soup.file_faces, [0, 0, 0, 2, 2], "{format:?}");
    }
}

#[test]
fn off_headers_may_be_written_in_any_way() {
    let body = "0 0 0 1 1\n1 0 0 1 1\n0 1 0 1 1\n3 0 1 2\n";
    for header in [
        "OFF\n3 1 3\n",
        "OFF 3 1 3\r\n",
        "OFF 3 1\n",
        "# first\n\n OFF # keyword\n# counts\n 3 1 0 # here\n",
        "STCNOFF\n3 1 0\n",
        "NOFF 3 1 0\n",
        "off\n3 1 0\n",
        "\u{feff}OFF\n3 1 0\n",
        "3 1 0\n",
    ] {
        let soup = parse(Format::Off, format!("{header}{body}")).unwrap();
        assert_eq!(soup.positions[1], [1.0, 0.0, 0.0], "{header}");
        assert_eq!(soup.triangles, [[0, 1, 2]], "{header}");
    }
}

#[test]
fn text_keeps_f64_whatever_the_header_declares() {
    let soup = parse(
        Format::Ply,
        "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n\
         property float z\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n\
         0.1 .5 1.\n1e-300 0.12345678901234567 0\n1 2 3\n3 0 1 2\n",
    )
    .unwrap();
    assert_eq!(soup.positions[0], [0.1, 0.5, 1.0]);
    assert_eq!(soup.positions[1], [1e-300, 0.123_456_789_012_345_67, 0.0]);

    let stl = "SOLID\nfacet normal nan nan nan\nOUTER LOOP\nvertex 0.1 0 0\nvertex 1 0 0\n\
               vertex 0 0.7 0\nendloop\nendfacet\nendsolid\n";
    assert_eq!(parse(Format::Stl, stl).unwrap().positions[0][0], 0.1);
}

#[test]
fn ply_headers_with_foreign_remarks_are_read() {
    let file =
        b"ply\nformat binary_little_endian 1.0\ncomment caf\xe9\n\nelement nothing 4000000000\n\
                 element vertex 3\nproperty uchar x\nproperty char y\nproperty short z\n\
                 element face 1\nproperty list int double vertex_indices\nend_header\n\
                 \x01\xff\xfe\xff\x02\x00\x00\x00\x03\x00\x00\x01\
                 \x03\x00\x00\x00\x00\x00\x00\x00\x00\x00\x00\x00\x00\x00\x00\x00\x00\x00\xf0\x3f\
                 \x00\x00\x00\x00\x00\x00\x00\x40";
    let soup = parse(Format::Ply, file).unwrap();
    assert_eq!(
        soup.positions,
        [[1.0, -1.0, -2.0], [2.0, 0.0, 0.0], [3.0, 0.0, 256.0]]
    );
    assert_eq!(soup.triangles, [[0, 1, 2]]);
}

#[test]
fn stl_corners_are_welded_exactly() {
    let mut file = String::from("solid a\n");
    let next = 1.0f64.next_up();
    for corners in [
        "0 0 0,1 0 0,0 1 0".to_owned(),
        "-0 1 0,1.0 -0.0 0,1 1 0".to_owned(),
        format!("0 0 0,{next:?} 0 0,1 1 0"),
    ] {
        file += "facet normal 0 0 0\nouter loop\n";
        for corner in corners.split(',') {
            file = file + "vertex " + corner + "\n";
        }
        file += "endloop\nendfacet\n";
    }
    file += "endsolid a\nsolid b\nendsolid b\n";
    let soup = parse(Format::Stl, file).unwrap();
    assert_eq!(soup.triangles, [[0, 1, 2], [2, 1, 3], [0, 4, 3]]);
    assert_eq!(soup.positions[4], [next, 0.0, 0.0]);
    assert!(
        soup.positions
            .as_flattened()
            .iter()
            .all(|x| x.is_sign_positive())
    );
}

#[test]
fn stl_corners_are_welded_however_many_there_are() {
    // Every corner at a place of its own at first, then all of them again.
    let count = 5000u32;
    let mut file = vec![0; 80];
    file.extend_from_slice(&(2 * count).to_le_bytes());
    for triangle in (0..count).chain(0..count) {
        file.extend_from_slice(&[0; 12]);
        for corner in 3 * triangle..3 * triangle + 3 {
            for x in [corner as f32, 0.0, -0.0] {
                file.extend_from_slice(&x.to_le_bytes());
            }
        }
        file.extend_from_slice(&[0; 2]);
    }
    let soup = parse(Format::Stl, file).unwrap();
    assert_eq!(soup.positions.len(), 3 * count as usize);
    let (first, again) = soup.triangles.split_at(count as usize);
    assert_eq!(first, again);
    assert!(first.as_flattened().iter().copied().eq(0..3 * count));
}
