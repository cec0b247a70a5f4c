//! VTK, GIFTI and `FreeSurfer`: fields, encodings, names of files, and data in other files.

use geobench_mesh::io::{Format, files_beside, is_mesh_file, read};

use crate::{fails, parse, scene_samples};

#[test]
fn gifti_has_two_names_for_each_form() {
    let array = |intent: &str, rows: usize, form: &str, data: &str| {
        format!(
            "<DataArray Intent=\"NIFTI_INTENT_{intent}\" Dim0=\"{rows}\" Dim1=\"3\" {form}>\
             <Data>{data}</Data></DataArray>"
        )
    };
    let triangle = array("TRIANGLE", 1, "Encoding=\"GIFTI_ENCODING_ASCII\"", "0 1 2");
    let points = |form: &str, data: &str| {
        let form = format!("DataType=\"NIFTI_TYPE_FLOAT32\" {form}");
        let points = array("POINTSET", 3, &form, data);
        parse(Format::Gifti, format!("<GIFTI>{points}{triangle}</GIFTI>"))
    };
    let expected = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 2.0, 0.0]];
    let data = "AAAAAAAAAAAAAAAAP4AAAAAAAAAAAAAAAAAAAEAAAAAAAAAA";
    for (encoding, order) in [
        ("Base64Binary", "BigEndian"),
        ("GIFTI_ENCODING_B64BIN", "GIFTI_ENDIAN_BIG"),
    ] {
        let form = format!("Encoding=\"{encoding}\" Endian=\"{order}\"");
        assert_eq!(points(&form, data).unwrap().positions, expected);
        let error = points(&form.replace("Endian=\"", "Endian=\"x"), data).unwrap_err();
        assert!(error.to_string().contains("is unknown"), "{error}");
    }
    for order in ["ColumnMajorOrder", "GIFTI_IND_ORD_COL_MAJOR"] {
        let form = format!("ArrayIndexingOrder=\"{order}\"");
        assert_eq!(
            points(&form, "0 1 0 0 0 2 0 0 0").unwrap().positions,
            expected
        );
    }
}

/// VTK writes the properties of an array behind it, also between the arrays of a field.
#[test]
fn metadata_may_follow_each_array_of_a_field() {
    let text = "# vtk DataFile Version 5.1\nx\nASCII\nDATASET POLYDATA\nFIELD FieldData 2\n\
                TIME 1 1 double\n0.5\nMETADATA\nINFORMATION 1\nNAME RANGE LOCATION vtkDataArray\n\
                DATA 2 0 1\n\nCYCLE 1 1 int\n3\nMETADATA\nINFORMATION 0\n\n\
                POINTS 3 int\n0 0 0 1 0 0 0 1 0\nPOLYGONS 1 4\n3 0 1 2\n";
    let soup = parse(Format::Vtk, text).unwrap();
    assert_eq!(soup.triangles, [[0, 1, 2]]);
}

/// Text and binary, with lines of any system; fields may come before the data set.
#[test]
fn fields_of_vtk_with_strings_and_bits_are_skipped() {
    let long = "x".repeat(300);
    let numbers =
        |numbers: &[i32]| -> Vec<u8> { numbers.iter().flat_map(|n| n.to_be_bytes()).collect() };
    let points = numbers(&[0, 0, 0, 1, 0, 0, 0, 1, 10]);
    let cell = numbers(&[3, 0, 1, 2]);
    for end in ["\n", "\r\n", "\r"] {
        let lines = |text: &str| text.replace('\n', end).into_bytes();
        let text = "# vtk DataFile Version 4.2\nx\nASCII\nFIELD a 1\nb 1 9 bit\n1 0 1 0 1 0 1 0 1\n\
             DATASET POLYDATA\nFIELD FieldData 2\nname 1 3 string\nPOINTS\n\nd%20e f\n\
             b 1 2 vtkIdType\n1 0\nPOINTS 3 int\n0 0 0 1 0 0 0 1 10\nPOLYGONS 1 4\n3 0 1 2\n";
        let binary = [
            lines(
                "# vtk DataFile Version 4.2\nx\nBINARY\nDATASET POLYDATA\nFIELD f 2\nb 1 9 bit\n",
            ),
            b"\xff\x01".to_vec(),
            lines("\nname 3 1 string\n"),
            [&b"\xc3abc\xc0\x81\x2c"[..], long.as_bytes()].concat(),
            lines("\nPOINTS 3 int\n"),
            points.clone(),
            lines("\nPOLYGONS 1 4\n"),
            cell.clone(),
        ];
        for file in [lines(text), binary.concat()] {
            let soup = parse(Format::Vtk, file).unwrap();
            assert_eq!(soup.positions[2], [0.0, 1.0, 10.0]);
            assert_eq!(soup.triangles, [[0, 1, 2]]);
        }
    }
    for (string, kind) in [("c", "ASCII"), ("\u{3}", "BINARY")] {
        let file =
            format!("# vtk DataFile Version 4.2\nx\n{kind}\nFIELD f 1\na 1 3 string\n{string}");
        fails(Format::Vtk, file, "the file ends within string");
    }
}

#[test]
fn a_second_set_of_points_replaces_nothing() {
    let points = "POINTS 3 int\n0 0 0 1 0 0 0 1 0\n";
    let cells = "CELLS 1 4\n3 0 1 2\nCELL_TYPES 1\n5\n";
    let header = "# vtk DataFile Version 3.0\nx\nASCII\nDATASET UNSTRUCTURED_GRID\n";
    for (more, keyword) in [
        (points, "POINTS"),
        (cells, "CELLS"),
        ("CELL_TYPES 1\n5\n", "CELL_TYPES"),
    ] {
        let message = format!("\"{keyword}\" comes a second time");
        fails(
            Format::Vtk,
            format!("{header}{points}{cells}{more}"),
            &message,
        );
    }
    let array = "<DataArray type=\"Float32\">0 0 0 1 0 0 0 1 0</DataArray>";
    fails(
        Format::VtkXml,
        format!(
            "<VTKFile type=\"PolyData\"><PolyData><Piece><Points>{array}{array}</Points></Piece>\
             </PolyData></VTKFile>"
        ),
        "a second array of points",
    );
}

#[test]
fn freesurfer_surfaces_have_one_line_of_text_or_two() {
    let numbers = [0_f32, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 2.0, 0.0];
    let positions = numbers.iter().flat_map(|x| x.to_be_bytes());
    let corners = [0_u32, 1, 2].into_iter().flat_map(u32::to_be_bytes);
    let data: Vec<u8> = positions.chain(corners).collect();
    let counts = b"\0\0\0\x03\0\0\0\x01";
    for text in ["created\n", "created\n\n", "created\nwith a remark\n"] {
        let file = [&b"\xff\xff\xfe"[..], text.as_bytes(), counts, &data].concat();
        let soup = parse(Format::FreeSurfer, file).unwrap();
        assert_eq!(soup.positions[2], [0.0, 2.0, 0.0]);
        assert_eq!(soup.triangles, [[0, 1, 2]]);
    }
}

/// A surface without an ending that tells its format, and data of a hemisphere.
#[test]
fn freesurfer_surfaces_have_any_name_of_a_hemisphere() {
    let folder = tempfile::tempdir().unwrap();
    let samples = scene_samples::all();
    let sample = samples.iter().find(|sample| sample.1 == Format::FreeSurfer);
    let surface = &sample.unwrap().2;
    for name in [
        "rh.pial.T1",
        "lh.white.preaparc",
        "lh.orig.nofix",
        "x.freesurfer",
    ] {
        let path = folder.path().join(name);
        std::fs::write(&path, surface).unwrap();
        assert!(is_mesh_file(&path), "{name}");
        assert_eq!(read(&path).unwrap().triangles.len(), 2, "{name}");
    }
    for (name, bytes) in [
        ("lh.thickness", b"\xff\xff\xff"),
        ("white", b"\xff\xff\xfe"),
    ] {
        let path = folder.path().join(name);
        std::fs::write(&path, bytes).unwrap();
        assert!(!is_mesh_file(&path), "{name}");
    }
}

#[test]
fn gifti_reads_data_in_its_folder_only() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.gii");
    let points = [0_f32, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 2.0, 0.0];
    let mut bytes: Vec<u8> = points.iter().flat_map(|x| x.to_be_bytes()).collect();
    bytes.extend([0_u32, 1, 2].iter().flat_map(|v| v.to_be_bytes()));
    std::fs::write(folder.path().join("a.dat"), &bytes).unwrap();
    let write = |name: &str, offset: &str| {
        let array = |intent: &str, kind: &str, rows: usize, offset: &str| {
            format!(
                "<DataArray Intent=\"NIFTI_INTENT_{intent}\" DataType=\"NIFTI_TYPE_{kind}\" \
                 Dim0=\"{rows}\" Dim1=\"3\" Encoding=\"ExternalFileBinary\" Endian=\"BigEndian\" \
                 ExternalFileName=\"{name}\" ExternalFileOffset=\"{offset}\"><Data/></DataArray>"
            )
        };
        let [points, faces] = [
            array("POINTSET", "FLOAT32", 3, ""),
            array("TRIANGLE", "INT32", 1, offset),
        ];
        std::fs::write(&path, format!("<GIFTI>{points}{faces}</GIFTI>")).unwrap();
        read(&path).map_err(|error| error.to_string())
    };
    let soup = write("a.dat", "36").unwrap();
    assert_eq!(soup.positions[2], [0.0, 2.0, 0.0]);
    assert_eq!(soup.triangles, [[0, 1, 2]]);
    assert_eq!(
        files_beside(&path),
        [folder.path().join("a.dat"), folder.path().join("a.dat")]
    );
    assert!(
        write("a.dat", "40")
            .unwrap_err()
            .contains("has 2 numbers for 1 rows")
    );
    for name in ["", "../a.dat", "none.dat", "."] {
        let error = write(name, "36").unwrap_err();
        assert!(error.contains("must lie beside this one"), "{error}");
    }
}
