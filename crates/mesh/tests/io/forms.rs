//! Forms of files that programs write beside the usual one, and what is read from them.

use geobench_mesh::io::{Format, ReadOptions, read};
use geobench_mesh::{Defect, DefectKind, Mesh, TriangleSoup, VertexId, Weld};

use crate::models::models;
use crate::parse;

/// A fan of three triangles, in which every file of this page is.
const FAN: [[f64; 3]; 5] = [
    [0.0, 0.0, 0.0],
    [2.0, 0.0, 0.0],
    [2.0, 1.5, 0.5],
    [0.0, 2.0, 0.0],
    [-1.0, 0.5, 1.0],
];
const FACES: [[u32; 3]; 3] = [[0, 1, 2], [0, 2, 3], [0, 3, 4]];

/// The lines `{prefix}{x}{blank}{y}{blank}{z}` of the vertices.
fn vertices(prefix: &str, blank: &str, suffix: &str) -> String {
    FAN.map(|[x, y, z]| format!("{prefix}{x}{blank}{y}{blank}{z}{suffix}\n"))
        .concat()
}

/// The fan, without notes.
#[track_caller]
fn is_fan(format: Format, text: impl AsRef<[u8]>) -> TriangleSoup {
    let soup = parse(format, text).unwrap();
    assert_eq!(soup.positions, FAN);
    assert_eq!(soup.triangles, FACES);
    soup
}

/// The notes on what was read.
fn notes(soup: &TriangleSoup) -> Vec<String> {
    soup.notes.iter().map(ToString::to_string).collect()
}

#[test]
fn blanks_of_all_kinds_separate_words() {
    let faces = "f 1 2 3\nf 1 3 4\nf 1 4 5\n";
    for blank in [
        "\u{a0}", "\u{b}", "\u{c}", "\t", "\u{2009}", "\u{3000}", "\u{feff}", " \u{a0} ",
    ] {
        is_fan(
            Format::Obj,
            vertices(&format!("v{blank}"), blank, "") + &faces.replace(' ', blank),
        );
        let off = format!(
            "OFF\n5{blank}3 0\n{}3 0 1 2\n3 0 2 3\n3 0 3 4",
            vertices("", blank, blank)
        );
        is_fan(Format::Off, off);
    }
    // The no-break space of Latin-1; its byte within a name in UTF-8 is none.
    let latin: Vec<u8> = (vertices("v ", " ", "") + faces)
        .bytes()
        .map(|b| if b == b' ' { 0xa0 } else { b })
        .collect();
    is_fan(Format::Obj, latin);
    is_fan(
        Format::Obj,
        vertices("v ", " ", "") + "g \u{e0} v 9 9 9\n" + faces,
    );
}

#[test]
fn a_vertex_that_is_no_statement_is_not_skipped() {
    for statement in [
        "v,1,2,3",
        "v1 2 3",
        "v\u{b7}1 2 3",
        "f,1,2,3",
        "\u{200b}v 1 2 3",
        "V 1 2 3",
    ] {
        let text = format!("{}{statement}\nf 1 2 3\n", vertices("v ", " ", ""));
        let error = parse(Format::Obj, text).unwrap_err().to_string();
        assert!(
            error.starts_with("test: line 6: ") && error.contains("no statement"),
            "{error}"
        );
    }
    let text = vertices("v ", " ", "") + "v 1 2 3 v 4 5 6\nf 1 2 3\n";
    let error = parse(Format::Obj, text).unwrap_err().to_string();
    assert_eq!(error, "test: line 6: \"v\" is not a number");
    // Lines that end with CR alone, beside others.
    let text = vertices("# a remark\rv ", " ", "").replacen('\n', "\r", 2);
    is_fan(Format::Obj, text + "f 1 2 3\r\nf 1 3 4\r\r\nf 1 4 5\n");
}

#[test]
fn a_skipped_statement_hides_no_vertex_and_no_face() {
    let faces = "f 1 2 3\nf 1 3 4\nf 1 4 5\n";
    // A backslash that ends a name, as programs on Windows write it.
    for before in ["g a\\", "usemtl C:\\maps\\  ", "mtllib \\\\\n\\"] {
        let text = format!("{before}\n{}{faces}", vertices("v ", " ", ""));
        let error = parse(Format::Obj, &text).unwrap_err().to_string();
        let line = before.lines().count() + 1;
        assert!(
            error.starts_with(&format!("test: line {line}: the backslash")),
            "{error}"
        );
        assert!(crate::tobj(text).is_err());
        let text = format!("{}{before}\n{faces}", vertices("v ", " ", ""));
        assert!(parse(Format::Obj, text).is_err());
    }
    // In a comment, and where the next line has no keyword.
    is_fan(
        Format::Obj,
        format!("# C:\\\n{}g a \\\nb\n{faces}", vertices("v ", " ", "")),
    );
    // The former name of a face, and another file.
    let former = vertices("v ", " ", "") + &faces.replace("f ", "fo ");
    is_fan(Format::Obj, &former);
    assert_eq!(crate::tobj(&former).unwrap().triangles, FACES);
    let error = parse(Format::Obj, former + "call b.obj\n").unwrap_err();
    assert!(
        error
            .to_string()
            .starts_with("test: line 9: call reads another")
    );
}

#[test]
fn off_is_free_of_lines() {
    let [numbers, faces] = [
        vertices("", " ", ""),
        "3 0 1 2\n3 0 2 3\n3 0 3 4\n".to_owned(),
    ];
    for text in [
        format!("OFF\n5 3 0\n{}{faces}", numbers.replace(' ', "\n")),
        format!(
            "OFF 5 3 0\n{}{}",
            numbers.replace('\n', " "),
            faces.replace('\n', " ")
        ),
        format!(
            "OFF\n5 3 0\n# all in one line\n{} # and a comment\n{faces}",
            numbers.replace('\n', " ")
        ),
        format!("NOFF 5 3 0\n{}{faces}", vertices("", " ", "\n0 0\n1")),
        format!("COFF5 3 0\n{}{faces}", vertices("", " ", " 255 0 0 255")),
        format!("nOFF\n3\n5 3 0\n{numbers}{faces}"),
        format!("nOFF 3\n5 3 0\n{numbers}{faces}"),
        format!("OFF\n5\n3\n0\n{numbers}{faces}"),
        format!("OFF\n5 3\n0\n{numbers}{faces}"),
        format!("OFF5 3 0 {numbers}{faces}").replace('\n', " "),
        format!("nOFF 3 5 3 0 {numbers}{faces}").replace('\n', " "),
        format!("NOFF\n5\n3 0 {}{faces}", vertices("", " ", " 0 0 1")).replace('\n', " "),
        format!("COFF\n5 3 0\n{}{faces}", vertices("", " ", "\n255 0 0 255")),
        format!("COFF 5 3 0 {}{faces}", vertices("", " ", " 1 0 0.5")).replace('\n', " "),
        format!("CNOFF5 3 0 {}{faces}", vertices("", " ", " 0 0 1 9 9 9 9")).replace('\n', " "),
    ] {
        is_fan(Format::Off, text);
    }
    let error = parse(Format::Off, format!("nOFF\n4\n5 3 0\n{numbers}{faces}")).unwrap_err();
    assert_eq!(
        error.to_string(),
        "test: line 2: its points have \"4\" dimensions; only 3 are read"
    );
    // Colours of faces, whatever lines the vertices are in.
    let coloured = "3 0 1 2 255 0 0\n3 0 2\n 3 1 0 0 0.5\n3 0 3 4 7\n";
    for numbers in [numbers.replace(' ', "\n"), numbers.replace('\n', " ")] {
        is_fan(Format::Off, format!("OFF\n5 3 0\n{numbers}\n{coloured}"));
        is_fan(Format::Off, format!("OFF\n5 3\n0 {numbers}{coloured}"));
        let long = coloured.replace("255 0 0", "255 0 0 1 1");
        assert!(parse(Format::Off, format!("OFF\n5 3 0\n{numbers}\n{long}")).is_err());
    }
    // A number in two parts, and one that comes twice.
    for (whole, parted) in [("1.5", "1. 5"), ("2 0\n-1", "2 2 0\n-1")] {
        assert!(numbers.contains(whole));
        let text = format!("OFF\n5 3 0\n{}{faces}", numbers.replace(whole, parted));
        let error = parse(Format::Off, text).unwrap_err().to_string();
        assert!(error.contains(": 4 numbers are in the line"), "{error}");
    }
    is_fan(
        Format::Off,
        format!("OFF\n5 3 0\n{}{faces}", vertices("", " ", " 255 0 0")),
    );
    // One number too few or too many.
    for counts in ["4 3", "6 3", "5 2", "5 4"] {
        let text = format!("OFF\n{counts} 0\n{}{faces}", numbers.replace(' ', "\n"));
        assert!(parse(Format::Off, text).is_err(), "{counts}");
    }
}

fn ply(list: &str, element: &str) -> String {
    format!(
        "ply\nformat ascii 1.0\nelement vertex 5\nproperty float x\nproperty float y\n\
         property float z\nelement {element}\nproperty list {list} vertex_indices\nend_header\n"
    )
}

#[test]
fn text_ply_is_free_of_lines() {
    let (header, faces) = (ply("uchar int", "face 3"), "3 0 1 2\n3 0 2 3\n3 0 3 4\n");
    let numbers = vertices("", " ", "");
    for payload in [
        numbers.replace(' ', "\n") + faces,
        numbers.replace('\n', " ") + &faces.replace('\n', " "),
        format!("\u{feff}{numbers}{faces}"),
    ] {
        is_fan(Format::Ply, header.clone() + &payload);
    }
    is_fan(Format::Ply, ply("uchar int64", "face 3") + &numbers + faces);
    is_fan(
        Format::Ply,
        ply("uint64 ulong", "face 3") + &numbers + faces,
    );
    let more = header.clone() + &vertices("", " ", " 255 255 255") + faces;
    let soup = is_fan(Format::Ply, more);
    assert_eq!(
        notes(&soup),
        ["line 10: more numbers than the header declares; they are ignored"]
    );
    assert!(
        parse(
            Format::Ply,
            header.clone() + &numbers + "3 0 1 2\n3 0 2 3\n3 0 3\n"
        )
        .is_err()
    );
    // A face that lacks a corner takes none of the next lines.
    let error = parse(
        Format::Ply,
        header + &numbers + "4 0 1 2\n3 0 2 3\n3 3 2 4\n",
    )
    .unwrap_err();
    assert!(
        error.to_string().contains("line 15: the line ends before"),
        "{error}"
    );
    // Four vertices with a number more and a triangle, or four without and a polygon.
    let header = ply("uchar int", "face 1").replace("vertex 5", "vertex 4");
    let text = header + "0 0 0 9\n2 0 0 9\n0 2 0 9\n7 0 1 2\n3 0 1 2\n";
    let error = parse(Format::Ply, text).unwrap_err();
    assert!(
        error.to_string().contains("line 10: \"9\" follows"),
        "{error}"
    );
}

#[test]
fn strips_of_triangles_become_faces() {
    let header = ply("int int", "tristrips 2");
    let soup = parse(
        Format::Ply,
        header + &vertices("", " ", "") + "9 1 2 0 3 -1 3 4 0 -1\n3 4 3 0\n",
    );
    let soup = soup.unwrap();
    assert_eq!(soup.triangles, [[1, 2, 0], [0, 2, 3], [3, 4, 0], [4, 3, 0]]);
    // A repeated vertex joins two parts.
    let header = ply("int int", "tristrips 1");
    let soup = parse(
        Format::Ply,
        header + &vertices("", " ", "") + "8 0 1 2 2 0 0 3 4\n",
    )
    .unwrap();
    assert_eq!(soup.triangles, [[0, 1, 2], [3, 0, 4]]);
}

#[test]
fn stl_in_words() {
    let facet = |[a, b, c]: [u32; 3], end: &str| {
        let vertex = |v: u32| {
            format!(
                "vertex {} {} {}\n",
                FAN[v as usize][0], FAN[v as usize][1], FAN[v as usize][2]
            )
        };
        format!(
            "facet normal 0 0 1\nouter loop\n{}{}{}{end}\n",
            vertex(a),
            vertex(b),
            vertex(c)
        )
    };
    let facets = |end: &str| FACES.map(|face| facet(face, end)).concat();
    let usual = facets("endloop\nendfacet");
    for text in [
        format!("solid a b\n{usual}endsolid"),
        format!("solid\n{usual}endsolidSCENE\n"),
        format!("solid\n{usual}end solid a\n"),
        format!("solid\n{}endsolid\n", facets("end loop\nend facet")),
        format!("solid\n{}endsolid\n", facets("endloop")),
        format!(
            "solid\n{}endsolid\n",
            usual.replace("outer loop", "outerloop")
        ),
        format!("solid\ncolor 1 0 0\n{usual}endsolid\n"),
        format!("solid\n{}endsolid\n", usual.replace("normal 0 0 1", "")),
        format!("solid facet a {} endsolid\n", usual.replace('\n', " ")),
    ] {
        let soup = is_fan(Format::Stl, &text);
        assert!(soup.notes.is_empty(), "{text}");
    }
    let soup = is_fan(Format::Stl, format!("solid\n{usual}"));
    assert_eq!(notes(&soup), ["line 22: the file ends without endsolid"]);
    let soup = is_fan(Format::Stl, format!("# facets\n{usual}endsolid\n"));
    let note = "line 2: a facet comes before the first solid";
    assert_eq!(notes(&soup), [note]);
    let soup = is_fan(Format::Stl, format!("\n {}", usual.to_uppercase()));
    let end = "line 22: the file ends without endsolid";
    assert_eq!(notes(&soup), [note, end]);
    for text in [
        format!("solid\n{}endsolid\n{usual}", facets("endloop")),
        format!("solid\n{usual}facet"),
        format!("solid\n{}endsolid\n", facets("endfacet")),
        format!(
            "solid\n{}endsolid\n",
            facets("vertex 0 0 0\nendloop\nendfacet")
        ),
        format!("solid\nspline\n{usual}endsolid\n"),
    ] {
        assert!(parse(Format::Stl, &text).is_err(), "{text}");
    }
}

#[test]
fn vertices_of_no_face_may_have_no_position() {
    let faces = "f 1 2 3\nf 1 3 4\nf 1 4 5\n";
    for nan in [
        "nan nan nan",
        "1.#QNAN 0 0",
        "-1.#IND 0 1.#INF",
        "0 inf 0",
        "-nan(ind) 0 0",
    ] {
        let text = format!("{}v {nan}\n{faces}", vertices("v ", " ", ""));
        let (mesh, report) = Mesh::from_soup(parse(Format::Obj, text).unwrap()).unwrap();
        assert_eq!(mesh.positions()[5], FAN[0], "{nan}");
        let mut summaries = report.summaries().into_iter().map(|summary| summary.text);
        assert!(
            summaries
                .next_back()
                .unwrap()
                .ends_with("put at a corner of the first face (vertex 5)")
        );
        let used = format!("v {nan}\n{}f 2 3 4\nf 1 2 4\n", vertices("v ", " ", ""));
        assert!(
            Mesh::from_soup(parse(Format::Obj, used).unwrap()).is_err(),
            "{nan}"
        );
    }
}

#[test]
fn a_missing_third_coordinate_is_zero() {
    let soup = parse(Format::Obj, "v 0 0\nv 2 0\nv 2 1.5\nf 1 2 3\n").unwrap();
    assert_eq!(
        soup.positions,
        [[0.0, 0.0, 0.0], [2.0, 0.0, 0.0], [2.0, 1.5, 0.0]]
    );
    assert_eq!(
        notes(&soup),
        ["line 1: a vertex has two coordinates; the third is 0"]
    );
}

#[test]
fn a_fourth_number_other_than_one_has_two_meanings() {
    let faces = "f 1 2 3\nf 1 3 4\nf 1 4 5\n";
    is_fan(Format::Obj, vertices("v ", " ", " 1") + faces);
    is_fan(Format::Obj, vertices("v ", " ", " 0.1 0.2 0.3") + faces);
    for weight in ["0", "2", "128", "nan"] {
        let text = vertices("v ", " ", &format!(" {weight}")) + faces;
        let error = parse(Format::Obj, text).unwrap_err().to_string();
        assert!(
            error.starts_with("test: line 1: the fourth number"),
            "{error}"
        );
    }
}

#[test]
fn text_stl_may_have_comments_and_an_end_mark() {
    let facet = "facet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 2 0 0\nvertex 0 2 0\n\
                 endloop\nendfacet\n";
    let solid = format!("solid x # 1\n{facet}endsolid x\n");
    for text in [
        format!("# of a program\n\n#\n{solid}"),
        format!("{solid}\0\0\0\0"),
        format!("{solid}\u{1a}"),
        format!("{solid}\u{1a}\0\0"),
        format!("solid x\n# one\n{facet}# two\nendsolid\n# three\n"),
        format!("solid\n{}endsolid\0", facet.replace("normal 0 0 1", "")),
    ] {
        let soup = parse(Format::Stl, text).unwrap();
        assert_eq!(soup.triangles, [[0, 1, 2]]);
        assert_eq!(notes(&soup), [""; 0]);
    }
}

#[test]
fn notes_say_which_departure_there_is() {
    let soup = parse(Format::Obj, "v 0 0\nv 2 0\nv 2 1.5\nf 1 2 3\n").unwrap();
    let (_, report) = Mesh::from_soup(soup).unwrap();
    let note = "line 1: a vertex has two coordinates; the third is 0";
    assert_eq!(
        report.notes(),
        [format!("1 departure from the file's format ({note})")]
    );
}

#[test]
fn a_pointer_of_git_lfs_is_named() {
    let pointer = "version https://git-lfs.github.com/spec/v1\noid sha256:4d7a\nsize 12345\n";
    for format in [
        Format::Obj,
        Format::Ply,
        Format::Stl,
        Format::ThreeMf,
        Format::Gltf,
        Format::FreeSurfer,
    ] {
        let error = parse(format, pointer).unwrap_err().to_string();
        assert!(error.contains("git lfs pull"), "{error}");
    }
}

#[test]
fn faces_that_are_left_out_are_not_missing() {
    let soup = parse(Format::Obj, "v 0 0 0\nv 0 0 0\nv 0 0 0\nf 1 2 3\n").unwrap();
    let error = Mesh::from_soup(soup).unwrap_err().to_string();
    assert!(
        error.contains("it has no faces left; distances need a surface. Also: 1 face has several"),
        "{error}"
    );
}

#[test]
fn text_in_utf_16_is_named() {
    let text = vertices("v ", " ", "") + "f 1 2 3\n";
    let little: Vec<u8> = text.encode_utf16().flat_map(u16::to_le_bytes).collect();
    let big: Vec<u8> = text.encode_utf16().flat_map(u16::to_be_bytes).collect();
    for bytes in [
        &little[..],
        &big,
        &[b"\xff\xfe", &little[..]].concat(),
        &[b"\xfe\xff", &big[..]].concat(),
    ] {
        for format in [Format::Obj, Format::Off, Format::Ply, Format::Stl] {
            let error = parse(format, bytes).unwrap_err().to_string();
            assert!(error.contains("UTF-16"), "{error}");
        }
    }
}

#[test]
fn text_in_utf_32_and_compressed_files_are_named() {
    let text = vertices("v ", " ", "") + "f 1 2 3\n";
    let of = |convert: fn(u32) -> [u8; 4]| -> Vec<u8> {
        text.chars().flat_map(|c| convert(c.into())).collect()
    };
    let (little, big) = (of(u32::to_le_bytes), of(u32::to_be_bytes));
    for format in [
        Format::Obj,
        Format::Off,
        Format::Ply,
        Format::Stl,
        Format::Vtk,
    ] {
        let is_named = |bytes: &[u8], name: &str| {
            let error = parse(format, bytes).unwrap_err().to_string();
            assert!(error.contains(name), "{error}");
        };
        for bytes in [
            &little[..],
            &big,
            &[b"\xff\xfe\0\0", &little[..]].concat(),
            &[b"\0\0\xfe\xff", &big[..]].concat(),
        ] {
            is_named(bytes, "its text is in UTF-32; save it as UTF-8");
        }
        // Archives without compression have the text of their files in them.
        for (start, name) in [
            (&b"\xfd7zXZ\0"[..], "compressed by xz"),
            (&b"BZh91AY&SY"[..], "compressed by bzip2"),
            (&b"\x28\xb5\x2f\xfd"[..], "compressed by Zstandard"),
            (&b"PK\x03\x04"[..], "compressed by ZIP"),
        ] {
            is_named(&[start, text.as_bytes()].concat(), name);
        }
    }
}

#[test]
fn a_polygon_may_repeat_its_first_corner() {
    let text = vertices("v ", " ", "") + "f 1 2 3 1\nf 1 3 4 1\nf 1 4 5 1\n";
    assert_eq!(is_fan(Format::Obj, text).file_faces, [0, 1, 2]);
}

#[test]
fn a_polygon_may_have_holes_with_bridges() {
    let text = "v 0 0 0\nv 4 0 0\nv 4 4 0\nv 0 4 0\nv 1 1 0\nv 3 1 0\nv 3 3 0\nv 1 3 0\n";
    for outline in [
        "1 2 3 4 1 5 8 7 6 5",
        "5 8 7 6 5 1 2 3 4 1",
        "6 5 1 2 3 4 1 5 8 7",
    ] {
        let soup = parse(Format::Obj, format!("{text}f {outline}\n")).unwrap();
        let area = |t: &[u32; 3]| {
            let [a, b, c] = t.map(|v| soup.positions[v as usize]);
            0.5 * ((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]))
        };
        assert!(soup.triangles.iter().all(|t| area(t) > 0.0), "{outline}");
        let (mesh, _) = Mesh::from_soup(soup).unwrap();
        assert_eq!(
            (
                mesh.face_count(),
                mesh.half_edges()
                    .filter(|&h| mesh.twin(h).is_none())
                    .count()
            ),
            (8, 8)
        );
    }
}

#[test]
fn cuts_of_polygons_share_no_edge() {
    // Two quads around vertex 2, which has two edges only; and a triangle along their diagonal.
    let text = "v 0 0 0\nv 2 0 0\nv 1 1 0.1\nv 0 2 0\nv 2 2 1\nv 3 3 3\n";
    for faces in [
        "f 1 2 3 4\nf 4 3 2 5\n",
        "f 2 3 4 1\nf 2 5 4 3\n",
        "f 1 2 3 4\nf 2 4 6\n",
        "f 2 4 6\nf 1 2 3 4\nf 4 3 2 5\n",
    ] {
        let soup = parse(Format::Obj, text.to_owned() + faces).unwrap();
        let mesh = Mesh::from_soup(soup);
        assert!(mesh.is_ok(), "{faces}: {}", mesh.unwrap_err());
    }
}

/// A warped square, whose distances depend on its cut; and one beside it.
const SQUARE: &str = "v 0 0 0\nv 1 0 0\nv 1 1 1\nv 0 1 0\nv 2 0 0\n";

#[test]
fn copies_of_a_polygon_are_cut_alike_and_left_out() {
    for (first, copies) in [
        ("1 2 3 4", "f 1 2 3 4\n"),
        ("1 2 3 4", "f 4 3 2 1\nf 2 3 4 1\n"),
        ("1 2 3 4", "f 3 4 1 2\nf 2 5 3\n"),
        ("2 3 4 1", "f 1 2 5 3\nf 3 2 1 4\n"),
        ("1 2 5 3 4", "f 3 5 2 1 4\nf 5 3 4 1 2\n"),
    ] {
        let read = |faces: &str| parse(Format::Obj, SQUARE.to_owned() + faces).unwrap();
        let alone = read(&format!("f {first}\n"));
        let soup = read(&format!("f {first}\n{copies}"));
        let sorted = |t: &[u32; 3]| {
            let mut corners = *t;
            corners.sort_unstable();
            corners
        };
        let (mesh, report) = Mesh::from_soup(soup).unwrap();
        let faces = mesh
            .faces()
            .map(|f| mesh.face_vertices(f).map(VertexId::raw));
        let kept: Vec<_> = faces.map(|t| sorted(&t)).collect();
        // Copies alone make a surface of two sides, which is used as it is.
        for triangle in alone.triangles.iter().map(sorted) {
            assert!(kept.contains(&triangle), "{copies}");
        }
        let is_copy = |d: &&Defect| {
            matches!(
                d.kind(),
                DefectKind::RepeatedFace | DefectKind::DuplicateFace
            )
        };
        assert!(report.defects.iter().any(|d| is_copy(&d)), "{report:?}");
    }
}

#[test]
fn a_welded_polygon_is_cut_for_the_welded_surface() {
    let cases = [
        // Two quads around vertex 2, with vertices of their own.
        "v 0 0 0\nv 2 0 0\nv 1 1 0.1\nv 0 2 0\nv 0 2 0\nv 1 1 0.1\nv 2 0 0\nv 2 2 1\n\
         f 1 2 3 4\nf 5 6 7 8\n",
        // Two that lie across each other.
        "v 0 0 0\nv 1 0 0\nv 1 1 1\nv 0 1 0\nv 1 0 0\nv 0 0 0\nv 0 1 0\nv 1 1 1\n\
         f 1 2 3 4\nf 5 6 7 8\n",
        // One whose edge has no length then.
        "v 0 0 0\nv 2 0 0\nv 2 0 0\nv 2 2 0\nv 1 0.5 0\nf 1 2 3 4 5\n",
    ];
    for text in cases {
        let options = ReadOptions {
            weld: Some(Weld::COINCIDENT),
            ..ReadOptions::default()
        };
        let soup = options.read_bytes(text.as_bytes(), Format::Obj, "test".as_ref());
        let soup = soup.unwrap();
        assert!(!soup.copies.is_empty());
        let (_, report) = Mesh::from_soup(soup).unwrap();
        let edges = report.defects.iter().filter(|d| {
            let kind = d.kind();
            kind == DefectKind::NonManifoldEdge || kind == DefectKind::CollapsedFace
        });
        assert_eq!(edges.count(), 0, "{report:?}");
    }
}

/// Files of other programs in the directory that the project shares, each with the fan in it unless
/// its name says otherwise.
#[test]
fn shared_forms_are_read() {
    let Ok(files) = models().with_file_name("cases").join("read").read_dir() else {
        return;
    };
    for path in files.map(|file| file.unwrap().path()) {
        let name = path.file_name().unwrap().to_str().unwrap();
        let soup = match name {
            "targets_bom.txt" => continue,
            "obj_utf16le.obj" => {
                assert!(read(&path).unwrap_err().to_string().contains("UTF-16"));
                continue;
            }
            _ => read(&path).unwrap_or_else(|error| panic!("{error}")),
        };
        let (mesh, _) = Mesh::from_soup(soup).unwrap_or_else(|error| panic!("{name}: {error}"));
        match name {
            "obj_keyhole.obj" => assert_eq!(mesh.face_count(), 8),
            "off_tokens.off" => assert_eq!(mesh.face_count(), 2),
            _ => assert_eq!(mesh.positions()[..5], FAN, "{name}"),
        }
    }
}
