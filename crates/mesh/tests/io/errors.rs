//! Broken files: one clear message each, with the place.

use std::path::Path;

use geobench_mesh::io::{FileError, Format, read, write};
use geobench_mesh::{DefectKind, FileForm};

use crate::samples;
use crate::{gzip, parse};

/// Asserts that reading fails with exactly this message, without the path.
#[track_caller]
fn fails(format: Format, bytes: impl AsRef<[u8]>, message: &str) {
    let error = parse(format, bytes).unwrap_err().to_string();
    assert_eq!(error, format!("test: {message}"));
}

#[test]
fn files_that_cannot_be_opened_are_errors() {
    let dir = tempfile::tempdir().unwrap();
    let check = |name: &str, content: Option<&[u8]>, message: &str| {
        let path = dir.path().join(name);
        if let Some(content) = content {
            std::fs::write(&path, content).unwrap();
        }
        let error = read(&path).unwrap_err().to_string();
        assert_eq!(error, format!("{}: {message}", path.display()));
    };
    check("no.obj", None, "no such file; check the path");
    check("", None, "is a directory; name a mesh file in it");
    let unknown = "the ending does not tell a mesh format; use .obj, .ply, .off, .stl, .vtk, .vtp, .vtu, \
         .gltf, .glb, .3mf, .dae, .gii or .freesurfer, each also with .gz, or a FreeSurfer name such \
         as lh.white";
    check("cow.txt", Some(b"OFF"), unknown);
    check("cow", Some(b"OFF"), unknown);
    check("a.zip", Some(b"PK"), unknown);
    let packed = "it is compressed by xz, which is not read; unpack it first (xz -d), or compress it \
                  with gzip";
    check("cow.off.XZ", Some(b"x"), packed);
    for name in ["a.obj", "a.ply", "a.off", "a.stl"] {
        check(name, Some(b""), "the file is empty; write it anew");
    }
    check(
        "a.ply.gz",
        Some(&gzip(b"")),
        "the file is empty; write it anew",
    );
    std::fs::create_dir(dir.path().join("d.obj")).unwrap();
    check("d.obj", None, "is a directory; name a mesh file in it");
}

#[test]
fn damaged_compression() {
    for (name, format, bytes) in samples::all() {
        let packed = gzip(&bytes);
        for cut in [2, 12, packed.len() / 2, packed.len() - 1] {
            let error = parse(format, &packed[..cut]).unwrap_err();
            assert!(matches!(error, FileError::Gzip { .. }), "{name} {error}");
        }
    }
}

#[test]
fn the_wrong_ending_is_recognised() {
    let all = samples::all();
    for (format, sample, name) in [
        (Format::Obj, 1, "PLY"),
        (Format::Off, 2, "PLY"),
        (Format::Ply, 5, "STL"),
        (Format::Obj, 5, "STL"),
    ] {
        let error = parse(format, &all[sample].2).unwrap_err().to_string();
        let hint = format!("(it starts like a file in {name} format: correct its ending)");
        assert!(error.ends_with(&hint), "{error}");
    }
}

#[test]
fn broken_obj() {
    let fails = |text: &[u8], message: &str| fails(Format::Obj, text, message);
    fails(
        b"\x00\x01\xff\n",
        "there is neither a vertex nor a face in it; is it a file of this format?",
    );
    fails(
        b"# x\nv 0\n",
        "line 2: a vertex has three coordinates, here are 1",
    );
    fails(b"v 0 0 0\nv 0 x 0\n", "line 2: \"x\" is not a number");
    fails(
        b"v 0 0 \\\n0\nv 1 \xff\xfe 2\n",
        "line 3: \"\u{fffd}\u{fffd}\" is not a number",
    );
    fails(
        b"v 0 0 0 0\n",
        "line 1: the fourth number of the vertex, \"0\", is a weight to some programs, which divide \
         by it, and nothing to others; remove it, or divide by it",
    );
    fails(
        b"v 0 0 0\nf 1 0 1\n",
        "line 2: \"0\" names vertex 0, but the vertices of an OBJ file count from 1",
    );
    fails(
        b"v 0 0 0\n\nf 1 1 -2\nv 1 1 1\n",
        "line 3: \"-2\" reaches back before the first vertex; there are 1 up to here",
    );
    fails(
        b"v 0 0 0\nf 1 1 4294967297\n",
        "line 2: \"4294967297\" is beyond the 4294967296 vertices a mesh can have",
    );
    for word in [
        "a",
        "1.5",
        "/1",
        "1/a",
        "1;2",
        "99999999999999999999999999999999999999999",
    ] {
        let error = parse(Format::Obj, format!("v 0 0 0\ng\nf 1 1 {word}\n")).unwrap_err();
        assert!(error.to_string().starts_with("test: line 3: \""), "{error}");
    }
    fails(
        b"v 0 0 0\nv 1 1 1\nl 1 2\n",
        "there is no face in it, only vertices (2); a surface is needed",
    );
}

#[test]
fn broken_off() {
    let fails = |text: &[u8], message: &str| fails(Format::Off, text, message);
    fails(
        b"OFF BINARY\n\0\0",
        "line 1: binary OFF is not read; convert the file to text OFF or binary PLY",
    );
    fails(
        b"4OFF\n",
        "line 1: \"4OFF\" has points in four dimensions, which are not read",
    );
    fails(
        b"#\nmesh\n",
        "line 2: \"mesh\" is not how an OFF file starts; expected OFF",
    );
    fails(b"# \n\n", "there are only blank lines and comments in it");
    fails(b"OFF\n\n", "line 1: the file ends before its counts");
    fails(
        b"OFF\n3\n",
        "line 2: \"3\" does not say how many vertices, faces and edges there are",
    );
    fails(
        b"OFF\n-3 1 0\n",
        "line 2: \"-3 1 0\" does not say how many vertices, faces and edges there are",
    );
    fails(
        b"OFF 2 1 0\n0 0 0\n",
        "line 2: the file ends after 1 of the 2 vertices it declares",
    );
    fails(
        b"OFF 1 2 0\n0 0 0\n3 0 0 0\n",
        "line 3: the file ends after 1 of the 2 faces it declares",
    );
    fails(
        b"OFF 1 1 0\n0 \xe4 0\n3 0 0 0\n",
        "line 2: \"\u{fffd}\" is not a number",
    );
    fails(
        b"OFF 1 1 0\n0 0 0\n3 0 0\n",
        "line 3: the face is to have 3 corners, but only 2 are there",
    );
    fails(
        b"OFF 1 1 0\n0 0 0\n3 0 -1 0\n",
        "line 3: \"-1\" is no vertex number: they run from 0 to 4294967295",
    );
    fails(
        b"OFF 1 1 0\n0 0 0\n-3 0 1 0\n",
        "line 3: \"-3\" is no number of corners",
    );
    fails(
        b"OFF 1 1 0\n0 0 0\n3 0 1 0\n3 0 1 2\n",
        "line 4: \"3 0 1 2\" comes after the 1 faces that the header declares; correct the counts",
    );
    fails(
        b"OFF 1 0 0\n0 0 0\n",
        "there is no face in it, only vertices (1); a surface is needed",
    );
}

/// A header with these counts; vertices have `x y z`, faces an `int` list.
fn ply_header(format: &str, vertices: &str, faces: &str) -> Vec<u8> {
    format!(
        "ply\nformat {format} 1.0\nelement vertex {vertices}\nproperty float x\nproperty float y\n\
         property float z\nelement face {faces}\nproperty list uchar int vertex_indices\nend_header\n"
    )
    .into_bytes()
}

#[test]
fn broken_ply_headers() {
    let fails = |text: &str, message: &str| fails(Format::Ply, text, message);
    fails("plx\n", "line 1: a PLY file starts with a line \"ply\"");
    fails(
        "ply\nformat ascii 1.0\n",
        "line 2: the file ends before end_header; fetch it again",
    );
    fails(
        "ply\ncomment\nformat utf8 1.0\nend_header\n",
        "line 3: \"format utf8 1.0\" is no valid line of a PLY header",
    );
    fails(
        "ply\nformat ascii 1.0\nproperty float x\nend_header\n",
        "line 3: \"property float x\" is no valid line of a PLY header",
    );
    fails(
        "ply\nformat ascii 1.0\nelement vertex -1\nend_header\n",
        "line 3: \"element vertex -1\" is no valid line of a PLY header",
    );
    fails(
        "ply\nelement vertex 1\nend_header\n",
        "the header needs a line like \"format ascii 1.0\"",
    );
    fails(
        "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty int x\nend_header\n",
        "line 5: \"property int x\" declares a name a second time; remove one",
    );
    let vertex = "element vertex 0\nproperty float x\nproperty float y\nproperty float z\n";
    for (elements, message) in [
        (
            String::new(),
            "the header declares no element vertex, so there is no mesh",
        ),
        (
            vertex.replace("float z", "list int int z"),
            "the header declares no coordinate z for the element vertex",
        ),
        (
            vertex.to_owned(),
            "the header declares no element face; a surface is needed, not a point cloud",
        ),
        (
            format!("{vertex}element tristrips 1\n"),
            "the header declares no list vertex_indices for the element tristrips",
        ),
        (
            format!("{vertex}element range_grid 1\n"),
            "its points form a range_grid, which is not read; convert the grid to faces",
        ),
        (
            format!("{vertex}element face 1\nproperty int vertex_index\n"),
            "the header declares no list vertex_indices for the element face",
        ),
        (
            format!("{vertex}element face 1\nproperty list float int vertex_index\n"),
            "the header counts the list vertex_index with a type that is not an integer",
        ),
    ] {
        let file = format!("ply\nformat ascii 1.0\n{elements}end_header\n");
        fails(&file, message);
    }
}

#[test]
fn broken_text_ply() {
    let fails = |counts: (&str, &str), payload: &[u8], message: &str| {
        let mut file = ply_header("ascii", counts.0, counts.1);
        file.extend_from_slice(payload);
        fails(Format::Ply, &file, message);
    };
    fails(
        ("2", "1"),
        b"0 0 0\n\n1 1\n",
        "line 12: the line ends before the property z",
    );
    fails(
        ("1", "1"),
        b"0 0 0 0\n",
        "line 10: \"0\" follows the properties that the header declares for vertex",
    );
    fails(
        ("1", "1"),
        b"0 0 \xff\n",
        "line 10: \"\u{fffd}\" is not a number",
    );
    fails(
        ("1", "2"),
        b"0 0 0\n3 0 0 0\n",
        "line 11: the file ends after 1 of the 2 elements face its header declares",
    );
    fails(
        ("1", "1"),
        b"0 0 0\n3 0 0\n",
        "line 11: the line ends before the property vertex_indices",
    );
    fails(
        ("1", "1"),
        b"0 0 0\n-3 0 0\n",
        "line 11: \"-3\" is no length of a list",
    );
    fails(
        ("1", "1"),
        b"0 0 0\n3 0 1 -1\n",
        "line 11: \"-1\" is no vertex number: they run from 0 to 4294967295",
    );
    fails(
        ("1", "1"),
        b"0 0 0\n3 0 0 0\n3 0 0 0\n",
        "line 12: \"3\" comes after all the elements that the header declares; correct its \
         counts",
    );
}

#[test]
fn broken_binary_ply() {
    let mut file = ply_header("binary_little_endian", "1", "2");
    let start = file.len();
    file.extend_from_slice(&[0; 12]);
    for vertex in [0i32, 0, 0, 0, -1, 0] {
        if (file.len() - start - 12).is_multiple_of(13) {
            file.push(3);
        }
        file.extend_from_slice(&vertex.to_le_bytes());
    }
    fails(
        Format::Ply,
        &file,
        &format!(
            "face 1 (byte {}): -1 is no vertex number: they run from 0 to 4294967295",
            start + 25
        ),
    );
    fails(
        Format::Ply,
        &file[..start + 30],
        &format!(
            "face 1 (byte {}): the file ends within it; the file is cut off or its header wrong",
            start + 25
        ),
    );
    fails(
        Format::Ply,
        &file[..start + 9],
        "the header declares 1 elements vertex, which need 12 bytes or more, but only 9 are left; \
         the file is cut off or its header wrong",
    );
}

#[test]
fn faces_that_a_binary_ply_header_does_not_count_are_not_lost_in_silence() {
    let mut file = ply_header("binary_little_endian", "3", "1");
    file.extend_from_slice(&[0; 36]);
    let face = [3, 0, 0, 0, 0, 1, 0, 0, 0, 2, 0, 0, 0];
    file.extend_from_slice(&face);
    file.extend_from_slice(b"\n\0");
    assert_eq!(parse(Format::Ply, &file).unwrap().triangles, [[0, 1, 2]]);
    file.truncate(file.len() - 2);
    file.extend_from_slice(&face);
    fails(
        Format::Ply,
        &file,
        "13 bytes come after all the elements that the header declares; correct its counts, or \
         cut them off",
    );
}

#[test]
fn lying_headers_reserve_nothing() {
    // If the reader trusted any of these counts, the test would need gigabytes or hours.
    for count in ["4000000000", "18446744073709551615"] {
        for format in ["ascii", "binary_little_endian", "binary_big_endian"] {
            for (vertices, faces) in [(count, "1"), ("1", count), (count, count)] {
                let mut file = ply_header(format, vertices, faces);
                file.extend_from_slice(&[b'0'; 40]);
                assert!(parse(Format::Ply, &file).is_err());
            }
        }
        for counts in [format!("{count} 1 0"), format!("1 {count} 0")] {
            let file = format!("OFF {counts}\n0 0 0\n3 0 0 0\n");
            assert!(parse(Format::Off, file).is_err());
        }
        let off = format!("OFF 1 1 0\n0 0 0\n{count} 0 0 0\n");
        assert!(parse(Format::Off, off).is_err());
    }
    // A list of 4294967295 corners, and ten billion elements that take no byte.
    let lists = "ply\nformat binary_little_endian 1.0\nelement void 10000000000\nelement vertex 1\n\
                 property uchar x\nproperty uchar y\nproperty uchar z\nelement face 1\n\
                 property list uint double vertex_indices\nend_header\n\0\0\0\u{7f}\u{7f}\u{7f}\u{7f}";
    fails(
        Format::Ply,
        lists,
        &format!(
            "face 0 (byte {}): the file ends within it; the file is cut off or its header wrong",
            lists.len() - 4
        ),
    );
    let mut stl = vec![0; 200];
    stl[80..84].fill(0xff);
    assert!(parse(Format::Stl, stl).is_err());
}

#[test]
fn broken_stl() {
    let fails = |bytes: &[u8], message: &str| fails(Format::Stl, bytes, message);
    fails(
        b"hello",
        "this is no STL: it neither starts with solid nor holds a binary header",
    );
    fails(b"solid\nendsolid\n", "there is no triangle in it");
    fails(
        b"solid\nfacet normal 0 0 1\nouter loop\nvertex 0 0\n",
        "line 4: a vertex has three coordinates, here are 2",
    );
    fails(
        b"solid\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nendloop\n",
        "line 6: expected vertex, found \"endloop\"",
    );
    fails(
        b"solid\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\n",
        "line 4: the file ends where vertex should follow; fetch it again",
    );
    fails(b"solid\n\n", "there is no triangle in it");
    fails(
        b"solid\nface\n",
        "line 2: expected facet or endsolid, found \"face\"",
    );
    fails(
        b"solid\nendsolid\nfacet\n",
        "line 3: expected solid, found \"facet\"",
    );
    fails(
        b"solid\nfacet\nouter loop\nvertex 0 \xff 0\n",
        "line 4: \"\u{fffd}\" is not a number",
    );
    let binary = &samples::all()[6].2;
    fails(
        &[&[0; 80][..], &binary[80..180]].concat(),
        "triangle 1 (byte 134): the file ends within it, though the header declares 2 triangles; \
         fetch it again",
    );
    // What is no STL at all, the other order of bytes, and a byte of attributes for each triangle.
    fails(
        format!("<html> {}", "x".repeat(100)).as_bytes(),
        "line 1: expected solid, found \"<html>\"",
    );
    let mut swapped = binary.clone();
    swapped[80..84].reverse();
    fails(
        &swapped,
        "its numbers have the high byte first, and those of STL the low byte; save it again",
    );
    let triangle = |i: usize| [&binary[84 + 50 * i..132 + 50 * i], &[1, 0, 7]].concat();
    fails(
        &[&binary[..84], &triangle(0), &triangle(1)].concat(),
        "attributes follow each of its triangles, which are not read; save it without",
    );
}

#[test]
fn a_face_that_a_cut_file_ends_within_is_not_lost_in_silence() {
    let vertices = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
    let soup = parse(Format::Obj, format!("{vertices}f 1 2 3\nf 3 2")).unwrap();
    assert_eq!(soup.triangles, [[0, 1, 2]]);
    let (_, report) = geobench_mesh::Mesh::from_soup(soup).unwrap();
    let summaries = report.summaries();
    assert_eq!(summaries.len(), 1);
    assert_eq!(
        summaries[0].text,
        "1 face has fewer than three corners and is left out (face 1)"
    );
    fails(
        Format::Obj,
        format!("{vertices}f 1 2"),
        "no face in it has three corners or more (1 have fewer); a surface is needed",
    );
}

#[test]
fn triangles_that_a_binary_stl_header_does_not_count_are_not_lost_in_silence() {
    let mut file = samples::all()[6].2.clone();
    file[80] = 1;
    fails(
        Format::Stl,
        &file,
        "the header declares 1 triangles, but the file has room for 1 more after them; correct the \
         count in bytes 80 to 83, or cut off what follows",
    );
    // A stream, whose header counts nothing.
    file[80] = 0;
    let soup = parse(Format::Stl, &file).unwrap();
    assert_eq!(soup.triangles.len(), 2);
    assert_eq!(soup.notes[0].to_string(), FileForm::NoCount.to_string());
    // Padding that is shorter than a triangle, or zero.
    file[80] = 2;
    let padded = [&file[..], &[7; 49]].concat();
    assert_eq!(parse(Format::Stl, &padded).unwrap().triangles.len(), 2);
    let padded = [&file[..], &[0; 500]].concat();
    assert_eq!(parse(Format::Stl, &padded).unwrap().triangles.len(), 2);
}

#[test]
fn truncated_files_are_refused() {
    for (name, format, bytes) in samples::all() {
        let whole = parse(format, &bytes).unwrap();
        for cut in 0..bytes.len() {
            let Ok(soup) = parse(format, &bytes[..cut]) else {
                continue;
            };
            // An OBJ file does not declare its content. In other formats only skipped parts may be
            // missing, or a note says so.
            let has_note = soup
                .notes
                .iter()
                .any(|note| note.kind() == DefectKind::FileForm);
            if format != Format::Obj && !has_note {
                assert_eq!(soup, whole, "{name} cut at {cut} of {}", bytes.len());
            }
        }
    }
}

#[test]
fn files_that_cannot_be_written_are_errors() {
    let soup = parse(Format::Obj, "v 0 0 0\nf 1 1 1\n").unwrap();
    let error = write(Path::new("a.gts"), &soup).unwrap_err().to_string();
    assert_eq!(
        error,
        "a.gts: the ending does not tell a format that can be written; use .obj, .ply, .off or .stl, \
         each also with .gz"
    );
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("none/a.obj");
    let error = write(&path, &soup).unwrap_err().to_string();
    assert!(error.contains("none/a.obj: cannot be written: "), "{error}");
}
