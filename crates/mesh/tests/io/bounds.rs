//! Small files that ask for much memory or time.

use std::fmt::Write;
use std::path::Path;

use geobench_mesh::io::{FileError, Format, ReadOptions};

use crate::scene_samples::{gifti, three_mf_of};
use crate::scenes::{TRIANGLE, collada, gltf};
use crate::{fails, parse};

#[test]
fn nodes_in_circles_and_trees_of_copies_are_refused() {
    let circle = "{\"mesh\":0,\"children\":[1]},{\"children\":[0]}";
    fails(Format::Gltf, gltf(circle, "[0]", ""), "contains itself");
    fails(
        Format::Collada,
        collada("<node id=\"n\"><instance_node url=\"#n\"/></node>"),
        "contains itself",
    );
    let object = "<object id=\"1\"><components><component objectid=\"1\"/></components></object>";
    let circle = format!(
        "<model><resources>{object}</resources><build><item objectid=\"1\"/></build></model>"
    );
    fails(Format::ThreeMf, three_mf_of(&circle), "contains itself");

    // Each of 40 levels has the next one twice: a million million copies.
    let limit = "more memory than the limit";
    let nodes = (1..41).map(|i| format!("{{\"children\":[{i},{i}]}}"));
    let nodes = nodes.collect::<Vec<_>>().join(",") + ",{\"mesh\":0}";
    fails(Format::Gltf, gltf(&nodes, "[0]", ""), limit);
    let mut nodes = String::new();
    let mut objects = format!("<object id=\"40\">{TRIANGLE}</object>");
    for i in 0..40 {
        let next = i + 1;
        let both = format!("<instance_node url=\"#n{next}\"/>").repeat(2);
        write!(nodes, "<node id=\"n{i}\">{both}</node>").unwrap();
        let both = format!("<component objectid=\"{next}\"/>").repeat(2);
        write!(
            objects,
            "<object id=\"{i}\"><components>{both}</components></object>"
        )
        .unwrap();
    }
    nodes += "<node id=\"n40\"><instance_geometry url=\"#g\"/></node>";
    fails(Format::Collada, collada(&nodes), limit);
    let model = format!(
        "<model><resources>{objects}</resources><build><item objectid=\"0\"/></build></model>"
    );
    fails(Format::ThreeMf, three_mf_of(&model), limit);
}

/// Small elements that name one large array again and again.
#[test]
fn arrays_are_not_read_without_bound() {
    let options = ReadOptions {
        max_decompressed: Some(1 << 16),
        ..ReadOptions::default()
    };
    let fails = |format, file: &str| {
        let error = options.read_bytes(file.as_bytes(), format, Path::new("test"));
        let error = error.unwrap_err();
        assert!(matches!(error, FileError::OverLimit { .. }), "{error}");
        let error = error.to_string();
        assert!(error.contains("limit of decompressed sizes"), "{error}");
        assert!(
            error.ends_with("; raise the limit if the file can be trusted"),
            "{error}"
        );
    };
    let primitive = "{\"attributes\":{\"POSITION\":0}}";
    let many =
        vec![format!("{primitive},{{\"attributes\":{{\"POSITION\":0}},\"indices\":1}}"); 2000];
    let file = gltf("{\"mesh\":0}", "[0]", "").replace(primitive, &many.join(","));
    let index = "{\"bufferView\":0,\"componentType\":5121,\"count\":12,\"type\":\"SCALAR\"}";
    fails(
        Format::Gltf,
        &file.replace("\"VEC3\"}]", &format!("\"VEC3\"}},{index}]")),
    );
    let geometry = "<geometry id=\"h\"><mesh><triangles><input semantic=\"VERTEX\" source=\"#v\" \
                    offset=\"0\"/><p>0 1 2</p></triangles></mesh></geometry>";
    let (mut nodes, mut all) = (String::new(), String::new());
    for i in 0..2000 {
        write!(nodes, "<instance_geometry url=\"#h{i}\"/>").unwrap();
        all += &geometry.replace("\"h\"", &format!("\"h{i}\""));
    }
    let file = collada(&format!("<node>{nodes}</node>"));
    fails(
        Format::Collada,
        &file.replace("</library_geometries>", &(all + "</library_geometries>")),
    );
    let array = "<DataArray type=\"Float32\" format=\"appended\" offset=\"0\"/>";
    let piece = format!("<Piece><Points>{array}</Points></Piece>").repeat(2000);
    let zeros = "A".repeat(48);
    fails(
        Format::VtkXml,
        &format!(
            "<VTKFile type=\"PolyData\"><PolyData>{piece}</PolyData><AppendedData \
             encoding=\"base64\">_JAAAAA=={zeros}</AppendedData></VTKFile>"
        ),
    );
    // Compressed data over the limit is not damaged.
    let options = ReadOptions {
        max_decompressed: Some(8),
        ..ReadOptions::default()
    };
    let error = options.read_bytes(&gifti(true), Format::Gifti, Path::new("test"));
    let error = error.unwrap_err();
    assert!(matches!(error, FileError::OverLimit { .. }), "{error}");
}

#[test]
fn bombs_and_deep_documents_are_refused() {
    let bomb =
        "<!DOCTYPE x [<!ENTITY a \"aaaaaaaaaa\"><!ENTITY b \"&a;&a;&a;\">]><GIFTI>&b;</GIFTI>";
    for format in [Format::Gifti, Format::Collada, Format::VtkXml] {
        fails(format, bomb, "it defines entities, which are not read");
        let deep = "<a>".repeat(200_000) + &"</a>".repeat(200_000);
        assert!(parse(format, deep).is_err());
        // The parser takes quadratic time for these.
        let attributes: Vec<String> = (0..100_000).map(|i| format!(" a{i}='1'")).collect();
        let attributes = attributes.concat();
        let wide = format!("<GIFTI><a{attributes}/></GIFTI>");
        fails(format, &wide, "an element has more than 1000 attributes");
        let wide = wide.replace('=', " =\n");
        fails(format, wide, "an element has more than 1000 attributes");
        let nested = (0..2000).map(|i| format!("<a xmlns:a{i}='x' xmlns:b{i}='y'>"));
        let nested: Vec<String> = nested.collect();
        fails(format, nested.concat(), "more than 100 prefixes");
    }
    // A message quotes little of a file.
    let long = "é".repeat(100_000);
    let error = parse(Format::Gifti, format!("<{long}></GIFTI>")).unwrap_err();
    let message = error.to_string();
    assert!(message.contains(" … ") && message.len() < 1000, "{message}");
    let deep = "[".repeat(200_000) + &"]".repeat(200_000);
    fails(
        Format::Gltf,
        "{".to_owned() + &deep,
        "line 1: this is no valid JSON",
    );
    fails(
        Format::Gltf,
        "\u{1}\u{2}rubbish",
        "it starts neither with glTF, as a .glb does",
    );
    // A megabyte of blanks in a kilobyte.
    let blanks = " ".repeat(1 << 20);
    let options = ReadOptions {
        max_decompressed: Some(1 << 16),
        ..ReadOptions::default()
    };
    let archive = three_mf_of(&format!("<model>{blanks}</model>"));
    let error = options.read_bytes(&archive, Format::ThreeMf, Path::new("test"));
    let error = error.unwrap_err().to_string();
    assert!(
        error.contains("decompress to more than the limit"),
        "{error}"
    );
}

#[test]
fn counts_that_files_cannot_hold_are_refused() {
    let header = "# vtk DataFile Version 3.0\nx\nASCII\nDATASET POLYDATA\n";
    for (rest, message) in [
        ("POINTS 4000000000 float\n", "line 5: the file is too short"),
        (
            "POINTS 3 float\n0 0 0 1 0",
            "line 6: the file ends where a coordinate",
        ),
        ("POINTS 3 colour\n", "\"colour\" is no type of numbers"),
        ("POINTS 1 int\n1 x 3\n", "line 6: \"x\" is not a number"),
        (
            "POINTS 1 int\n1 2 3\nPOLYGONS 1 4\n9 1 1 1\n",
            "the numbers end within cell 0",
        ),
        (
            "POINTS 1 int\n1 2 3\nSOMETHING\n",
            "line 7: the keyword \"SOMETHING\" is unknown",
        ),
    ] {
        fails(Format::Vtk, format!("{header}{rest}"), message);
    }
    // Cells of which a part would be lost.
    let points = "POINTS 4 int\n0 0 0 1 0 0 1 1 0 0 1 0\n";
    let grid = header.replace("POLYDATA", "UNSTRUCTURED_GRID");
    let offsets = |ends: &str| {
        format!(
            "{header}{points}POLYGONS 3 6\nOFFSETS vtktypeint64\n{ends}\n\
             CONNECTIVITY vtktypeint64\n0 1 2 0 2 3\n"
        )
    };
    for (text, message) in [
        (
            format!("{header}{points}POLYGONS 1 8\n3 0 1 2 3 0 2 3\n"),
            "4 numbers follow the last cell",
        ),
        (offsets("3 3 6"), "the first of the offsets is not 0"),
        (offsets("0 3 5"), "the last cell ends at 5 of 6 corners"),
        (
            format!("{grid}{points}CELLS 1 5\n4 0 1 2 3\nCELL_TYPES 1\n5\n"),
            "cell 0, counted from 0, is of type 5 with 4 corners",
        ),
        (
            format!("{grid}{points}CELLS 1 4\n3 0 1 2\nCELL_TYPES 1\n9\n"),
            "cell 0, counted from 0, is of type 9 with 3 corners",
        ),
    ] {
        fails(Format::Vtk, text, message);
    }
    assert!(parse(Format::Vtk, offsets("0 3 6")).is_ok());
    fails(
        Format::Vtk,
        "# vtk DataFile Version 3.0\nx\nASCII\nDATASET STRUCTURED_POINTS\n",
        "has no faces of its own",
    );
    let sparse = "{\"mesh\":0}";
    let wide = gltf(sparse, "[0]", "").replace("\"count\":3", "\"count\":18446744073709551615");
    fails(Format::Gltf, wide, "accessor 0");
    let wide = gltf(sparse, "[0]", "").replace("\"count\":3", "\"count\":300");
    fails(
        Format::Gltf,
        wide,
        "accessor 0: its 300 elements end behind bufferView 0",
    );
    let none = gltf(sparse, "[0]", "").replace("\"bufferView\":0,", "");
    let none = none.replace("\"count\":3", "\"count\":9000000000");
    fails(Format::Gltf, none, "more memory than the limit");
    let surface = b"\xff\xff\xfea\n\n\xff\xff\xff\xff\xff\xff\xff\xff";
    fails(
        Format::FreeSurfer,
        surface,
        "vertex 0 (byte 14): the file ends before it",
    );
}
