//! Formats with nodes, pieces or embedded arrays: what is read from them, and what is refused.

use std::path::Path;

use geobench_mesh::io::{Format, read, read_bytes};
use geobench_mesh::{Defect, FileForm, TriangleSoup};

use crate::scene_samples::{self, three_mf_of};
use crate::{fails, parse};

fn parts(soup: &TriangleSoup) -> Option<u32> {
    soup.notes.iter().find_map(|note| match note {
        Defect::Parts { parts } => Some(*parts),
        _ => None,
    })
}

/// A mesh of 3MF.
pub(crate) const TRIANGLE: &str = "<mesh><vertices><vertex x=\"0\" y=\"0\" z=\"0\"/>\
    <vertex x=\"1\" y=\"0\" z=\"0\"/><vertex x=\"0\" y=\"2\" z=\"0\"/></vertices>\
    <triangles><triangle v1=\"0\" v2=\"1\" v3=\"2\"/></triangles></mesh>";

#[test]
fn placed_meshes_are_parts_and_transforms_are_applied() {
    // A quarter turn about z, and twice as large, both by row vectors.
    let soup = parse(
        Format::ThreeMf,
        three_mf_of(&format!(
            "<model><resources><object id=\"7\">{TRIANGLE}</object></resources><build>\
             <item objectid=\"7\"/><item objectid=\"7\" transform=\"0 2 0 -2 0 0 0 0 2 5 6 7\"/>\
             </build></model>"
        )),
    )
    .unwrap();
    assert_eq!(parts(&soup), Some(2));
    assert_eq!(soup.triangles, [[0, 1, 2], [3, 4, 5]]);
    assert_eq!(
        soup.positions[3..],
        [[5.0, 6.0, 7.0], [5.0, 8.0, 7.0], [1.0, 6.0, 7.0]]
    );

    let nodes = "{\"mesh\":0,\"scale\":[2,2,2],\"rotation\":[0,0,0.7071067811865476,0.7071067811865476],\
                 \"translation\":[5,6,7]},{\"mesh\":0}";
    let soup = parse(Format::Gltf, gltf(nodes, "[0,1]", "")).unwrap();
    assert_eq!(parts(&soup), Some(2));
    let expected = [[5.0, 6.0, 7.0], [5.0, 8.0, 7.0], [1.0, 6.0, 7.0]];
    let found = soup.positions[..3].as_flattened().iter();
    let off = found
        .zip(expected.as_flattened())
        .map(|(a, b)| (a - b).abs());
    assert!(off.fold(0.0, f64::max) < 1e-14, "{soup:?}");

    let text = "<rotate>0 0 1 90</rotate><scale>2 2 2</scale>";
    let soup = parse(
        Format::Collada,
        collada(&format!(
            "<node><translate>5 6 7</translate>{text}<instance_geometry url=\"#g\"/>\
         <instance_geometry url=\"#g\"/></node>"
        )),
    )
    .unwrap();
    assert_eq!(parts(&soup), Some(2));
    let found = soup.positions[..3].as_flattened().iter();
    let off = found
        .zip(expected.as_flattened())
        .map(|(a, b)| (a - b).abs());
    assert!(off.fold(0.0, f64::max) < 1e-14, "{soup:?}");
}

/// A triangle in a buffer of the JSON, with these nodes and further members.
pub(crate) fn gltf(nodes: &str, roots: &str, more: &str) -> String {
    // (0, 0, 0), (1, 0, 0), (0, 2, 0) as f32.
    let data = "AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAAEAAAAAA";
    format!(
        "{{\"asset\":{{\"version\":\"2.0\"}},\"scenes\":[{{\"nodes\":{roots}}}],\"nodes\":[{nodes}],\
         \"meshes\":[{{\"primitives\":[{{\"attributes\":{{\"POSITION\":0}}}}]}}],\
         \"accessors\":[{{\"bufferView\":0,\"componentType\":5126,\"count\":3,\"type\":\"VEC3\"}}],\
         \"bufferViews\":[{{\"buffer\":0,\"byteLength\":36}}],\
         \"buffers\":[{{\"byteLength\":36,\"uri\":\"data:;base64,{data}\"}}]{more}}}"
    )
}

/// A triangle that these nodes place.
pub(crate) fn collada(nodes: &str) -> String {
    format!(
        "<COLLADA><library_geometries><geometry id=\"g\"><mesh><source id=\"p\">\
         <float_array id=\"a\">0 0 0 1 0 0 0 2 0</float_array><technique_common>\
         <accessor source=\"#a\" count=\"3\" stride=\"3\"/></technique_common></source>\
         <vertices id=\"v\"><input semantic=\"POSITION\" source=\"#p\"/></vertices><trifans>\
         <input semantic=\"VERTEX\" source=\"#v\" offset=\"0\"/><p>0 1 2</p></trifans></mesh></geometry>\
         </library_geometries><library_visual_scenes><visual_scene id=\"s\">{nodes}</visual_scene>\
         </library_visual_scenes><scene><instance_visual_scene url=\"#s\"/></scene></COLLADA>"
    )
}

#[test]
fn scenes_without_faces_are_errors() {
    let file = collada("<node><instance_geometry url=\"#g\"/></node>");
    fails(
        Format::Collada,
        file.replace("trifans", "lines"),
        "has no faces, at most points and lines",
    );
    fails(
        Format::Collada,
        file.replace("\"VERTEX\"", "\"NORMAL\""),
        "line 1: <trifans>: has no input VERTEX",
    );
    fails(Format::Collada, collada(""), "no mesh is placed in it");
    fails(
        Format::ThreeMf,
        three_mf_of(&format!(
            "<model><resources><object id=\"7\">{TRIANGLE}</object></resources><build/></model>"
        )),
        "no mesh is placed in it",
    );
    let points =
        gltf("{\"mesh\":0}", "[0]", "").replace("{\"attributes", "{\"mode\":0,\"attributes");
    fails(
        Format::Gltf,
        points,
        "has no faces, at most points and lines",
    );
    let hole = "polygons><input semantic=\"VERTEX\" source=\"#v\" offset=\"0\"/>\n<ph><p>0 1 2</p>\
                <h>0 1 2</h></ph></polygons></mesh>";
    let (before, rest) = file.split_once("trifans>").unwrap();
    let (_, after) = rest.split_once("</mesh>").unwrap();
    fails(
        Format::Collada,
        format!("{before}{hole}{after}"),
        "line 2: <h>: a polygon with a hole is not read",
    );
}

#[test]
fn collada_applies_lookat_and_refuses_skew_above_geometry_only() {
    let skew = "<skew>45 0 1 0 1 0 0</skew>";
    let placed = "<instance_geometry url=\"#g\"/>";
    let camera = "<node><lookat>0 0 1 0 0 0 0 1 0</lookat><instance_camera url=\"#c\"/></node>";
    let file = collada(&format!(
        "{camera}<node>{skew}</node><node><lookat>5 6 7 5 6 9 0 2 0</lookat>{placed}</node>"
    ));
    let soup = parse(Format::Collada, file).unwrap();
    // Half a turn about the axis that is up.
    let expected = [[5.0, 6.0, 7.0], [4.0, 6.0, 7.0], [5.0, 8.0, 7.0]];
    assert_eq!(soup.positions, expected);
    for nodes in [
        format!("<node>{skew}{placed}</node>"),
        format!("<node>{skew}<node><node>{placed}</node></node></node>"),
    ] {
        fails(
            Format::Collada,
            collada(&nodes),
            "<skew>: what it transforms is not read",
        );
    }
}

#[test]
fn gltf_reads_without_harmless_extensions_only() {
    let file = |more: &str| gltf("{\"mesh\":0}", "[0]", more);
    let needs = |name: &str| file(&format!(",\"extensionsRequired\":[\"{name}\"]"));
    for name in [
        "KHR_mesh_quantization",
        "KHR_materials_unlit",
        "KHR_texture_transform",
        "KHR_lights_punctual",
    ] {
        assert!(parse(Format::Gltf, needs(name)).is_ok(), "{name}");
    }
    for name in [
        "EXT_mesh_gpu_instancing",
        "KHR_draco_mesh_compression",
        "X_y",
    ] {
        fails(Format::Gltf, needs(name), name);
    }
    // Draco in a primitive, although the file does not say that it is needed.
    let draco = "{\"extensions\":{\"KHR_draco_mesh_compression\":{\"bufferView\":0}},\"attributes";
    let with = file("").replace("{\"attributes", draco);
    assert!(parse(Format::Gltf, &with).is_ok());
    fails(
        Format::Gltf,
        with.replace("{\"bufferView\":0,\"componentType", "{\"componentType"),
        "mesh 0, primitive 0: its positions are compressed by KHR_draco_mesh_compression",
    );
    let (before, rest) = file("")
        .split_once("\"uri\"")
        .map(|(a, b)| (a.to_owned(), b.to_owned()))
        .unwrap();
    let (_, after) = rest.split_once("\"}").unwrap();
    let fallback = "\"extensions\":{\"EXT_meshopt_compression\":{\"fallback\":true}}}";
    fails(
        Format::Gltf,
        format!("{before}{fallback}{after}"),
        "compressed by EXT_meshopt_compression",
    );
}

#[test]
fn a_matrix_is_a_transform_or_an_error() {
    let nodes = "{\"mesh\":0,\"matrix\":[1,0,0,5,0,1,0,0,0,0,1,0,0,0,0,1]}";
    let problem = "the last row of its matrix is not 0 0 0 1";
    fails(
        Format::Gltf,
        gltf(nodes, "[0]", ""),
        &format!("node 0: {problem}"),
    );
    // Columns in place of rows, and a scale in the last number.
    for last in ["5 0 0 1", "0 0 0 2"] {
        let matrix = format!("<matrix>1 0 0 0 0 1 0 0 0 0 1 0 {last}</matrix>");
        let nodes = format!("<node>{matrix}<instance_geometry url=\"#g\"/></node>");
        fails(
            Format::Collada,
            collada(&nodes),
            &format!("<matrix>: {problem}"),
        );
    }
}

/// A word that is no number was passed over.
#[test]
fn a_transform_is_of_numbers_only() {
    for numbers in [
        "1 0 0 0 1 0 0 0 1 5 0",
        "x 1 0 0 0 1 0 0 0 1 5 0 0",
        "1 0 0 0 1 0 0 0 1 5,5 0 0",
    ] {
        let model = format!(
            "<model><resources><object id=\"7\">{TRIANGLE}</object></resources><build>\
             <item objectid=\"7\" transform=\"{numbers}\"/></build></model>"
        );
        fails(
            Format::ThreeMf,
            three_mf_of(&model),
            "its transform has not twelve numbers",
        );
    }
    let nodes = "{\"mesh\":0,\"scale\":[2,\"2\",2,2]}";
    fails(
        Format::Gltf,
        gltf(nodes, "[0]", ""),
        "node 0: scale has not 3 numbers",
    );
}

#[test]
fn skins_and_morphs_are_noted_and_copies_by_an_extension_refused() {
    let unposed = |soup: TriangleSoup| soup.notes.contains(&Defect::Unposed { meshes: 1 });
    let read = |node: &str| parse(Format::Gltf, gltf(node, "[0]", ""));
    assert!(!unposed(read("{\"mesh\":0}").unwrap()));
    assert!(unposed(read("{\"mesh\":0,\"skin\":0}").unwrap()));
    for (weight, is_noted) in [("0", false), ("0.5", true)] {
        let nodes = format!("{{\"mesh\":0,\"weights\":[{weight}]}}");
        let target = "{\"targets\":[{\"POSITION\":0}],\"attributes";
        let file = gltf(&nodes, "[0]", "").replace("{\"attributes", target);
        assert_eq!(unposed(parse(Format::Gltf, file).unwrap()), is_noted);
    }
    let skin = "<library_controllers><controller id=\"c\"><skin source=\"#g\"/></controller>\
                </library_controllers><library_visual_scenes>";
    let file = collada("<node><instance_controller url=\"#c\"/></node>");
    let file = file.replace("<library_visual_scenes>", skin);
    assert!(unposed(parse(Format::Collada, file).unwrap()));
    let copies = "{\"mesh\":0,\"extensions\":{\"EXT_mesh_gpu_instancing\":{}}}";
    let error = read(copies).unwrap_err().to_string();
    assert!(error.contains("node 0: its copies"), "{error}");
}

#[test]
fn three_mf_reads_without_harmless_extensions_only() {
    let model = |name: &str| {
        three_mf_of(&format!(
            "<model xmlns:x=\"http://schemas.microsoft.com/3dmanufacturing/{name}\" \
             requiredextensions=\"x\"><resources><object id=\"7\">{TRIANGLE}</object>\
             </resources><build><item objectid=\"7\"/></build></model>"
        ))
    };
    for name in [
        "material/2015/02",
        "production/2015/06",
        "trianglesets/2021/07",
    ] {
        assert!(parse(Format::ThreeMf, model(name)).is_ok(), "{name}");
    }
    fails(
        Format::ThreeMf,
        model("beamlattice/2017/02"),
        "it needs the extension http://schemas.microsoft.com/3dmanufacturing/beamlattice/2017/02",
    );
    fails(
        Format::ThreeMf,
        three_mf_of(
            "<model><resources><object id=\"7\"><shape/></object></resources><build>\
             <item objectid=\"7\"/></build></model>",
        ),
        "<object> \"7\": has neither a mesh nor components",
    );
}

#[test]
fn xml_may_be_in_utf_16() {
    let file = collada("<node><instance_geometry url=\"#g\"/></node>");
    let bytes: Vec<u8> = file.encode_utf16().flat_map(u16::to_be_bytes).collect();
    for file in [&bytes[..], &[b"\xfe\xff", &bytes[..]].concat()] {
        let soup = parse(Format::Collada, file).unwrap();
        assert_eq!(soup.triangles, [[0, 1, 2]]);
    }
    fails(
        Format::Collada,
        file.replace("0 1 2<", "0 1 -2<"),
        "<p>: \"-2\" is not a whole number from 0",
    );
}

/// The length of a chunk is to include blanks that make it a multiple of four.
#[test]
fn the_json_of_a_binary_gltf_may_have_any_length() {
    let samples = scene_samples::all();
    let mut samples = samples.iter().map(|sample| &sample.2);
    let bytes = samples.find(|bytes| bytes.starts_with(b"glTF")).unwrap();
    let whole = parse(Format::Gltf, bytes).unwrap();
    let length = u32::from_le_bytes(bytes[12..16].try_into().unwrap()) as usize;
    let (json, rest) = bytes[20..].split_at(length);
    let mut json = json.trim_ascii_end().to_vec();
    while json.len() % 4 != 2 {
        json.insert(json.len() - 1, b' ');
    }
    for uncounted in [&b""[..], b"  "] {
        let word = |length: usize| (length as u32).to_le_bytes();
        let total = word(20 + json.len() + uncounted.len() + rest.len());
        let json_length = word(json.len());
        let header = [&b"glTF\x02\0\0\0"[..], &total, &json_length, b"JSON"].concat();
        let file = [&header[..], &json, uncounted, rest].concat();
        assert_eq!(parse(Format::Gltf, file).unwrap(), whole);
    }
}

#[test]
fn a_binary_gltf_that_is_cut_off_is_named() {
    let samples = scene_samples::all();
    let sample = samples
        .iter()
        .map(|sample| &sample.2)
        .find(|bytes| bytes.starts_with(b"glTF"));
    let bytes = sample.unwrap();
    let cut = &bytes[..bytes.len() - 8];
    let (there, declared) = (cut.len(), bytes.len());
    fails(
        Format::Gltf,
        cut,
        &format!("the file is cut off: it has {there} of the {declared} bytes"),
    );
    // A header that declares another length.
    let with_length = |length: usize| {
        let mut file = bytes.clone();
        file[8..12].copy_from_slice(&(length as u32).to_le_bytes());
        file
    };
    fails(
        Format::Gltf,
        with_length(declared + 4),
        &format!("it has {declared} of the {} bytes", declared + 4),
    );
    fails(
        Format::Gltf,
        with_length(declared - 4),
        "its second chunk ends behind",
    );
    fails(Format::Gltf, with_length(0), "ends within its header");
    let padded = [&bytes[..], &[0; 7]].concat();
    assert!(parse(Format::Gltf, padded).is_ok());
}

#[test]
fn errors_name_the_file_and_the_element() {
    fails(
        Format::Collada,
        collada("<node>\n<instance_geometry url=\"#h\"/></node>"),
        "test: line 2: <instance_geometry>: url=\"#h\" names no element of the file",
    );
    fails(
        Format::Collada,
        collada("<node><matrix>1 2 3</matrix></node>"),
        "<matrix>: has 3 numbers, not 16",
    );
    fails(
        Format::ThreeMf,
        three_mf_of("<model><build><item objectid=\"4\"/></build></model>"),
        "3D/main.model: <item>: there is no object 4",
    );
    let vertex = TRIANGLE.replace("v3=\"2\"", "v3=\"3\"");
    fails(
        Format::ThreeMf,
        three_mf_of(&format!(
            "<model><resources><object id=\"1\">{vertex}</object></resources><build>\
             <item objectid=\"1\"/></build></model>"
        )),
        "object 1: face 0 names vertex 3, but there are 3, counted from 0",
    );
    fails(
        Format::Gltf,
        gltf(
            "{\"mesh\":0}",
            "[0]",
            ",\"extensionsRequired\":[\"KHR_draco_mesh_compression\"]",
        ),
        "compressed by KHR_draco_mesh_compression; save it without compression",
    );
    fails(
        Format::ThreeMf,
        "PK",
        "the ZIP archive is damaged or cut off",
    );
    fails(
        Format::FreeSurfer,
        b"\xff\xff\xff\0\0\x01\0\0\x01",
        "save it as triangles",
    );
    fails(
        Format::VtkXml,
        "<VTKFile type=\"ImageData\"/>",
        "the type is ImageData; save the surface as PolyData",
    );
    // A tetrahedron is no face.
    let points = "POINTS 4 int\n0 0 0 1 0 0 0 1 0 0 0 1\n";
    fails(
        Format::Vtk,
        format!(
            "# vtk DataFile Version 3.0\nx\nASCII\nDATASET UNSTRUCTURED_GRID\n{points}\
             CELLS 1 5\n4 0 1 2 3\nCELL_TYPES 1\n10\n"
        ),
        "cell 0, counted from 0, is of type 10",
    );
}

#[test]
fn polygons_strips_and_pixels_are_cut() {
    let points = "POINTS 4 int\n0 0 0 1 0 0 1 1 0 0 1 0\n";
    let header = "# vtk DataFile Version 3.0\nx\nASCII\nDATASET";
    let grid = |kind, corners: &str| {
        let text = format!(
            "{header} UNSTRUCTURED_GRID\n{points}CELLS 2 7\n4 {corners}\n1 0\nCELL_TYPES 2\n{kind} 1\n"
        );
        parse(Format::Vtk, text).unwrap().triangles
    };
    assert_eq!(grid(9, "0 1 2 3"), [[0, 1, 2], [0, 2, 3]]);
    assert_eq!(grid(8, "0 1 3 2"), [[0, 1, 2], [0, 2, 3]]);
    assert_eq!(grid(6, "0 1 3 2"), [[0, 1, 3], [3, 1, 2]]);
    let text = format!("{header} POLYDATA\n{points}TRIANGLE_STRIPS 1 5\n4 0 1 3 2\n");
    let soup = parse(Format::Vtk, text).unwrap();
    assert_eq!(soup.triangles, [[0, 1, 3], [3, 1, 2]]);
    let polygon = collada("<node><instance_geometry url=\"#g\"/></node>")
        .replace("0 0 0 1 0 0 0 2 0", "0 0 0 1 0 0 1 1 0 0 1 0")
        .replace("count=\"3\"", "count=\"4\"")
        .replace("trifans", "polygons")
        .replace("0 1 2<", "0 1 2 3<");
    let soup = parse(Format::Collada, polygon).unwrap();
    assert_eq!(soup.triangles, [[0, 1, 2], [0, 2, 3]]);
    assert_eq!(soup.file_faces, [0, 0]);
}

#[test]
fn gltf_reads_quantised_and_sparse_positions() {
    let file = gltf("{\"mesh\":0}", "[0]", "").replace(
        "{\"bufferView\":0,\"componentType\":5126,\"count\":3",
        "{\"bufferView\":0,\"componentType\":5122,\"normalized\":true,\"count\":3",
    );
    // The low halves of 1 and 2 as f32 are 0, the high halves 0x3f80 and 0x4000.
    let soup = parse(Format::Gltf, file).unwrap();
    assert_eq!(soup.positions[2], [0.0, f64::from(0x3f80) / 32767.0, 0.0]);
    let file = gltf("{\"mesh\":0}", "[0]", "").replace(
        "\"count\":3,\"type\":\"VEC3\"",
        "\"count\":3,\"type\":\"VEC3\",\"sparse\":{\"count\":1,\"indices\":{\"bufferView\":0,\
         \"componentType\":5125},\"values\":{\"bufferView\":0,\"byteOffset\":12}}",
    );
    // The first index is 0, the first value (1, 0, 0).
    let soup = parse(Format::Gltf, file).unwrap();
    assert_eq!(soup.positions[..2], [[1.0, 0.0, 0.0]; 2]);
}

/// A rotation in single precision moves no two vertices apart.
#[test]
fn gltf_rotations_are_of_unit_length() {
    let turned = |rotation: &str| {
        let nodes = format!("{{\"mesh\":0,\"rotation\":{rotation}}}");
        parse(Format::Gltf, gltf(&nodes, "[0]", ""))
    };
    let soup = turned("[0,0,0.70710677,0.70710677]").unwrap();
    let [a, b, _] = soup.positions[..] else {
        panic!("{soup:?}");
    };
    assert!(((b[1] - a[1]) - 1.0).abs() < 1e-15, "{soup:?}");
    for rotation in ["[0,0,1,1]", "[0,0,0,0]"] {
        let error = turned(rotation).unwrap_err().to_string();
        assert!(
            error.contains("node 0: rotation is no unit quaternion"),
            "{error}"
        );
    }
}

#[test]
fn gltf_reads_buffers_in_its_folder_only() {
    let folder = tempfile::tempdir().unwrap();
    let inner = folder.path().join("sub");
    std::fs::create_dir(&inner).unwrap();
    let bytes: Vec<u8> = [0_f32, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 2.0, 0.0]
        .iter()
        .flat_map(|x| x.to_le_bytes())
        .collect();
    std::fs::write(inner.join("a b.bin"), &bytes).unwrap();
    std::fs::write(folder.path().join("up.bin"), &bytes).unwrap();
    let path = inner.join("model.gltf");
    let write = |uri: &str| {
        let text = gltf("{\"mesh\":0}", "[0]", "");
        let (before, rest) = text.split_once("data:").unwrap();
        let (_, after) = rest.split_once('"').unwrap();
        std::fs::write(&path, format!("{before}{uri}\"{after}")).unwrap();
        read(&path)
            .map(|soup| soup.positions[2])
            .map_err(|error| error.to_string())
    };
    assert_eq!(write("a%20b.bin"), Ok([0.0, 2.0, 0.0]));
    let elsewhere = folder.path().join("up.bin");
    for uri in ["../up.bin", elsewhere.to_str().unwrap(), "http://x.y/z.bin"] {
        assert!(
            write(uri).unwrap_err().contains("is not in the folder"),
            "{uri}"
        );
    }
    assert!(
        write("none.bin")
            .unwrap_err()
            .contains("must lie beside the file")
    );
    assert!(write(".").unwrap_err().contains("must lie beside the file"));
}

#[test]
fn parts_of_an_archive_may_be_utf_16() {
    let model = format!(
        "<?xml version=\"1.0\" encoding=\"UTF-16\"?><model><resources><object id=\"7\">{TRIANGLE}\
         </object></resources><build><item objectid=\"7\"/></build></model>"
    );
    let with_mark = format!("\u{feff}{model}");
    for text in [&model, &with_mark] {
        for bytes_of in [u16::to_le_bytes, u16::to_be_bytes] {
            let part: Vec<u8> = text.encode_utf16().flat_map(bytes_of).collect();
            let soup = parse(
                Format::ThreeMf,
                scene_samples::zip(&[("3D/3dmodel.model", &part)]),
            );
            assert_eq!(soup.unwrap().triangles, [[0, 1, 2]]);
        }
    }
}

#[test]
fn models_in_other_parts_of_an_archive_are_read() {
    let other =
        format!("<model><resources><object id=\"1\">{TRIANGLE}</object></resources></model>");
    let main = "<model xmlns:p=\"http://schemas.microsoft.com/3dmanufacturing/production/2015/06\">\
                <resources><object id=\"1\"><components>\
                <component objectid=\"1\" p:path=\"/3D/o.model\"/></components></object></resources>\
                <build><item objectid=\"1\"/></build></model>";
    let archive = scene_samples::zip(&[
        ("3D/3dmodel.model", main.as_bytes()),
        ("3D/o.model", other.as_bytes()),
    ]);
    let soup = read_bytes(&archive, Format::ThreeMf, Path::new("test")).unwrap();
    assert_eq!(soup.triangles, [[0, 1, 2]]);
}

#[test]
fn collada_notes_counts_that_differ() {
    let samples = scene_samples::all();
    let sample = samples.iter().find(|sample| sample.0 == "COLLADA");
    let text = String::from_utf8(sample.unwrap().2.clone()).unwrap();
    let soup = parse(Format::Collada, &text).unwrap();
    assert!(soup.notes.is_empty(), "{:?}", soup.notes);
    for (from, to, line) in [
        ("count=\"12\"", "count=\"15\"", 5),
        ("<polylist count=\"1\"", "<polylist count=\"2\"", 7),
        ("<triangles count=\"1\"", "<triangles count=\"\"", 8),
    ] {
        assert!(text.contains(from), "{from}");
        let other = parse(Format::Collada, text.replacen(from, to, 1)).unwrap();
        assert_eq!(other.triangles, soup.triangles);
        let form = FileForm::OtherCount;
        assert_eq!(other.notes, [Defect::FileForm { line, form }], "{from}");
    }
    let strips = collada("<node><instance_geometry url=\"#g\"/></node>")
        .replace("<trifans>", "<trifans count=\"1\">");
    assert!(parse(Format::Collada, strips).unwrap().notes.is_empty());
    // Finding a line takes a pass over the file: minutes if for each of these counts.
    let file = collada("<node><instance_geometry url=\"#g\"/></node>");
    let list = "<trifans count=\"7\"><input semantic=\"VERTEX\" source=\"#v\" offset=\"0\"/>\
                <p>0 1 2</p></trifans>";
    let many = file.replace("<trifans>", &(list.repeat(100_000) + "<trifans>"));
    let soup = parse(Format::Collada, many).unwrap();
    let form = FileForm::OtherCount;
    assert_eq!(soup.notes, [Defect::FileForm { line: 1, form }]);
    assert_eq!(soup.triangles.len(), 100_001);
}

/// What is no number was passed over, so that another surface was read.
#[test]
fn numbers_that_name_nothing_and_counts_that_lie_are_refused() {
    let samples = scene_samples::all();
    let sample = |name: &str| {
        let (_, format, bytes) = samples.iter().find(|sample| sample.0 == name).unwrap();
        (*format, String::from_utf8(bytes.clone()).unwrap())
    };
    let damaged = |name: &str, from: &str, to: &str, message: &str| {
        let (format, text) = sample(name);
        assert!(text.contains(from), "{from}");
        fails(format, text.replacen(from, to, 1), message);
    };
    for (from, to, message) in [
        (
            "\"scene\":0",
            "\"scene\":-1",
            "scene is -1, not a whole number",
        ),
        (
            "\"indices\":1",
            "\"indices\":\"x\"",
            "mesh 0, primitive 0: indices is \"x\"",
        ),
        (
            "\"mode\":5",
            "\"mode\":1.5",
            "mesh 0, primitive 1: mode is 1.5",
        ),
        ("\"mesh\":0", "\"mesh\":[0]", "node 0: mesh is [0]"),
        (
            "\"bufferView\":0",
            "\"bufferView\":-1",
            "accessor 0: bufferView is -1",
        ),
        (
            "\"byteOffset\":48",
            "\"byteOffset\":\"48\"",
            "accessor 1: byteOffset is \"48\"",
        ),
        (
            "\"count\":3",
            "\"count\":2",
            "mesh 0, primitive 0: it has 2 corners, not three each",
        ),
    ] {
        damaged("glTF", from, to, message);
    }
    for name in ["NumberOfPoints=\"4\"", "NumberOfPolys=\"2\""] {
        let other = name.replace(['4', '2'], "7");
        let message = format!("{} is 7, and there are", &name[..name.len() - 4]);
        damaged("text VTP", name, &other, &message);
    }
    damaged(
        "text VTP",
        "0 1 2 0 2 3",
        "0 1 2 0 2 3 1",
        "the last cell ends at 6 of 7 corners",
    );
}
