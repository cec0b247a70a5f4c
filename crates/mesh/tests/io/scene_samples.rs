//! The samples of the formats of VTK, of scenes and of brains.

use std::io::Write;

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use flate2::Compression;
use flate2::write::{DeflateEncoder, ZlibEncoder};
use geobench_mesh::io::Format;

use crate::samples::{POSITIONS, TRIANGLES};

pub(crate) fn all() -> Vec<(&'static str, Format, Vec<u8>)> {
    vec![
        ("text VTK", Format::Vtk, text_vtk()),
        ("binary VTK", Format::Vtk, binary_vtk()),
        ("text VTP", Format::VtkXml, text_vtp()),
        ("compressed VTU", Format::VtkXml, encoded_vtu(true)),
        ("VTU in base64", Format::VtkXml, encoded_vtu(false)),
        ("appended VTP", Format::VtkXml, appended_vtp()),
        ("glTF", Format::Gltf, gltf()),
        ("GLB", Format::Gltf, glb()),
        ("3MF", Format::ThreeMf, three_mf()),
        ("COLLADA", Format::Collada, collada()),
        ("text GIFTI", Format::Gifti, gifti(false)),
        ("compressed GIFTI", Format::Gifti, gifti(true)),
        ("FreeSurfer", Format::FreeSurfer, freesurfer()),
    ]
}

/// The coordinates as text, and the corners.
fn coordinates() -> String {
    let all = POSITIONS.as_flattened().iter().map(f64::to_string);
    all.collect::<Vec<_>>().join(" ")
}

fn floats() -> Vec<u8> {
    let all = POSITIONS.as_flattened().iter();
    all.flat_map(|&x| (x as f32).to_le_bytes()).collect()
}

fn corners() -> Vec<u8> {
    TRIANGLES
        .as_flattened()
        .iter()
        .flat_map(|v| v.to_le_bytes())
        .collect()
}

fn text_vtk() -> Vec<u8> {
    format!(
        "# vtk DataFile Version 4.2\na remark\nASCII\nDATASET POLYDATA\nPOINTS 4 float\n{}\n\
         METADATA\nINFORMATION 0\n\nLINES 1 3\n2 0 1\nPOLYGONS 2 8\n3 0 1 2\n3 0 2 3\n\
         CELL_DATA 2\nSCALARS area float\nLOOKUP_TABLE default\n1 2\n",
        coordinates()
    )
    .into_bytes()
}

/// An unstructured grid of version 5.1, with offsets.
fn binary_vtk() -> Vec<u8> {
    let mut file =
        b"# vtk DataFile Version 5.1\r\na remark\r\nBINARY\r\nDATASET UNSTRUCTURED_GRID\r\n\
                     FIELD FieldData 1\nTIME 1 1 double\n"
            .to_vec();
    file.extend_from_slice(&1.5_f64.to_be_bytes());
    file.extend_from_slice(b"\nPOINTS 4 double\n");
    let all = POSITIONS.as_flattened().iter();
    file.extend(all.flat_map(|x| x.to_be_bytes()));
    file.extend_from_slice(b"\nCELLS 3 6\nOFFSETS vtktypeint64\n");
    file.extend([0_i64, 3, 6].iter().flat_map(|n| n.to_be_bytes()));
    file.extend_from_slice(b"\nCONNECTIVITY vtktypeint64\n");
    let corners = TRIANGLES.as_flattened().iter();
    file.extend(corners.flat_map(|&n| i64::from(n).to_be_bytes()));
    file.extend_from_slice(b"\nCELL_TYPES 2\n");
    file.extend([5_i32, 5].iter().flat_map(|n| n.to_be_bytes()));
    file.extend_from_slice(b"\nPOINT_DATA 4\n");
    file
}

fn text_vtp() -> Vec<u8> {
    format!(
        "<?xml version=\"1.0\"?>\n<!-- a remark -->\n\
         <VTKFile type=\"PolyData\" version=\"0.1\" byte_order=\"LittleEndian\">\n<PolyData>\n\
         <Piece NumberOfPoints=\"4\" NumberOfPolys=\"2\">\n<PointData/>\n<Points>\
         <DataArray type=\"Float32\" NumberOfComponents=\"3\" format=\"ascii\">{}</DataArray>\
         </Points>\n<Verts><DataArray type=\"Int32\" Name=\"connectivity\"/></Verts>\n\
         <Polys><DataArray type=\"Int32\" Name=\"connectivity\" format=\"ascii\">0 1 2 0 2 3\
         </DataArray><DataArray type=\"Int32\" Name=\"offsets\" format=\"ascii\">3 6</DataArray>\
         </Polys>\n</Piece>\n</PolyData>\n</VTKFile>\n",
        coordinates()
    )
    .into_bytes()
}

/// An array of VTK in base64, behind its sizes.
fn encoded(bytes: &[u8], is_compressed: bool) -> String {
    if !is_compressed {
        let size = (bytes.len() as u64).to_le_bytes();
        return STANDARD.encode([&size[..], bytes].concat());
    }
    // Two blocks.
    let blocks: Vec<Vec<u8>> = bytes.chunks(bytes.len().div_ceil(2)).map(zlib).collect();
    let block = bytes.len().div_ceil(2);
    let mut header = vec![blocks.len(), block, bytes.len() % block];
    header.extend(blocks.iter().map(Vec::len));
    let header: Vec<u8> = header
        .iter()
        .flat_map(|&n| (n as u64).to_le_bytes())
        .collect();
    STANDARD.encode(header) + &STANDARD.encode(blocks.concat())
}

fn zlib(bytes: &[u8]) -> Vec<u8> {
    let mut encoder = ZlibEncoder::new(Vec::new(), Compression::default());
    encoder.write_all(bytes).unwrap();
    encoder.finish().unwrap()
}

fn encoded_vtu(is_compressed: bool) -> Vec<u8> {
    let offsets: Vec<u8> = [3_u32, 6].iter().flat_map(|n| n.to_le_bytes()).collect();
    let array = |name: &str, kind: &str, bytes: &[u8]| {
        format!(
            "<DataArray type=\"{kind}\" Name=\"{name}\" format=\"binary\">\n  {}\n</DataArray>\n",
            encoded(bytes, is_compressed)
        )
    };
    let compressor = if is_compressed {
        "compressor=\"vtkZLibDataCompressor\""
    } else {
        ""
    };
    [
        "<VTKFile type=\"UnstructuredGrid\" header_type=\"UInt64\" ",
        compressor,
        ">\n<UnstructuredGrid><Piece>\n<Points>",
        &array("Points", "Float32", &floats()),
        "</Points><Cells>",
        &array("connectivity", "UInt32", &corners()),
        &array("offsets", "UInt32", &offsets),
        &array("types", "UInt8", &[5, 5]),
        "</Cells></Piece></UnstructuredGrid></VTKFile>",
    ]
    .concat()
    .into_bytes()
}

/// Raw data behind the XML, which need not be text.
fn appended_vtp() -> Vec<u8> {
    let offsets: Vec<u8> = [3_u32, 6].iter().flat_map(|n| n.to_le_bytes()).collect();
    let mut data = Vec::new();
    let mut array = |name: &str, kind: &str, bytes: &[u8]| {
        let offset = data.len();
        data.extend_from_slice(&(bytes.len() as u32).to_le_bytes());
        data.extend_from_slice(bytes);
        format!(
            "<DataArray type=\"{kind}\" Name=\"{name}\" format=\"appended\" offset=\"{offset}\"/>"
        )
    };
    let mut file = [
        "<VTKFile type=\"PolyData\"><PolyData><Piece><Points>",
        &array("P", "Float32", &floats()),
        "</Points><Polys>",
        &array("connectivity", "Int32", &corners()),
        &array("offsets", "Int32", &offsets),
        "</Polys></Piece></PolyData>\n<AppendedData encoding=\"raw\">\n _",
    ]
    .concat()
    .into_bytes();
    file.extend_from_slice(&data);
    file.extend_from_slice(b"\n</AppendedData></VTKFile>");
    file
}

/// The JSON of glTF. A node moves the mesh away and the node in it back; the corners of the second
/// triangle are bytes.
fn json(buffer: &str) -> String {
    format!(
        "{{\"asset\":{{\"version\":\"2.0\"}},\"scene\":0,\"scenes\":[{{\"nodes\":[1]}}],\
         \"nodes\":[{{\"mesh\":0,\"matrix\":[1,0,0,0,0,1,0,0,0,0,1,0,0,-4,0,1]}},\
         {{\"translation\":[0,4,0],\"children\":[0]}}],\
         \"meshes\":[{{\"primitives\":[{{\"attributes\":{{\"POSITION\":0}},\"indices\":1}},\
         {{\"attributes\":{{\"POSITION\":0}},\"indices\":2,\"mode\":5}}]}}],\
         \"accessors\":[{{\"bufferView\":0,\"componentType\":5126,\"count\":4,\"type\":\"VEC3\"}},\
         {{\"bufferView\":1,\"componentType\":5125,\"count\":3,\"type\":\"SCALAR\"}},\
         {{\"bufferView\":2,\"componentType\":5121,\"count\":3,\"type\":\"SCALAR\"}}],\
         \"bufferViews\":[{{\"buffer\":0,\"byteLength\":48}},\
         {{\"buffer\":0,\"byteOffset\":48,\"byteLength\":12}},\
         {{\"buffer\":0,\"byteOffset\":60,\"byteLength\":3}}],\
         \"buffers\":[{{\"byteLength\":63{buffer}}}]}}"
    )
}

fn buffer() -> Vec<u8> {
    [&floats()[..], &corners()[..12], &[0, 2, 3]].concat()
}

fn gltf() -> Vec<u8> {
    let data = STANDARD.encode(buffer());
    json(&format!(
        ",\"uri\":\"data:application/octet-stream;base64,{data}\""
    ))
    .into_bytes()
}

fn glb() -> Vec<u8> {
    let mut json = json("").into_bytes();
    json.resize(json.len().next_multiple_of(4), b' ');
    let mut data = buffer();
    data.push(0);
    let mut file = b"glTF".to_vec();
    let total = (12 + 8 + json.len() + 8 + data.len()) as u32;
    for n in [2, total, json.len() as u32] {
        file.extend_from_slice(&n.to_le_bytes());
    }
    file.extend_from_slice(b"JSON");
    file.extend_from_slice(&json);
    file.extend_from_slice(&(data.len() as u32).to_le_bytes());
    file.extend_from_slice(b"BIN\0");
    file.extend_from_slice(&data);
    file
}

/// A ZIP archive of these files, every second one compressed.
pub(crate) fn zip(files: &[(&str, &[u8])]) -> Vec<u8> {
    let mut archive = Vec::new();
    let mut directory = Vec::new();
    for (i, (name, text)) in files.iter().enumerate() {
        let (method, data) = if i % 2 == 0 {
            (0_u16, text.to_vec())
        } else {
            let mut encoder = DeflateEncoder::new(Vec::new(), Compression::default());
            encoder.write_all(text).unwrap();
            (8, encoder.finish().unwrap())
        };
        let mut crc = flate2::Crc::new();
        crc.update(text);
        let mut shared = Vec::new();
        for n in [20, 0, method, 0, 0] {
            shared.extend_from_slice(&u16::to_le_bytes(n));
        }
        for n in [crc.sum(), data.len() as u32, text.len() as u32] {
            shared.extend_from_slice(&n.to_le_bytes());
        }
        for n in [name.len() as u16, 0] {
            shared.extend_from_slice(&n.to_le_bytes());
        }
        let start = archive.len() as u32;
        archive.extend_from_slice(b"PK\x03\x04");
        archive.extend_from_slice(&shared);
        archive.extend_from_slice(name.as_bytes());
        archive.extend_from_slice(&data);
        directory.extend_from_slice(b"PK\x01\x02\x14\x00");
        directory.extend_from_slice(&shared);
        directory.extend_from_slice(&[0; 10]);
        directory.extend_from_slice(&start.to_le_bytes());
        directory.extend_from_slice(name.as_bytes());
    }
    let start = archive.len() as u32;
    archive.extend_from_slice(&directory);
    archive.extend_from_slice(b"PK\x05\x06\0\0\0\0");
    for n in [files.len() as u16; 2] {
        archive.extend_from_slice(&n.to_le_bytes());
    }
    for n in [directory.len() as u32, start] {
        archive.extend_from_slice(&n.to_le_bytes());
    }
    archive.extend_from_slice(&[0; 2]);
    archive
}

/// The namespaces of 3MF, and where the model of an archive is.
const RELATIONS: &str = "<?xml version=\"1.0\"?><Relationships xmlns=\"http://schemas.openxmlformats.org/package/2006/relationships\">\
    <Relationship Target=\"/3D/main.model\" Id=\"rel0\" \
    Type=\"http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel\"/></Relationships>";

/// An archive of 3MF with this model.
pub(crate) fn three_mf_of(model: &str) -> Vec<u8> {
    zip(&[
        ("_rels/.rels", RELATIONS.as_bytes()),
        ("3D/main.model", model.as_bytes()),
    ])
}

/// The mesh is a component, which is moved, of an object that is moved back.
fn three_mf() -> Vec<u8> {
    let vertices = POSITIONS.map(|[x, y, z]| format!("<vertex x=\"{x}\" y=\"{y}\" z=\"{z}\"/>"));
    let triangles =
        TRIANGLES.map(|[a, b, c]| format!("<triangle v1=\"{a}\" v2=\"{b}\" v3=\"{c}\"/>"));
    three_mf_of(&format!(
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<model unit=\"millimeter\" \
         xmlns=\"http://schemas.microsoft.com/3dmanufacturing/core/2015/02\">\n<resources>\n\
         <object id=\"1\" type=\"model\"><mesh><vertices>{}</vertices>\n<triangles>{}</triangles>\
         </mesh></object>\n<object id=\"2\"><components>\
         <component objectid=\"1\" transform=\"1 0 0 0 1 0 0 0 1 8 0 0\"/></components></object>\n\
         </resources>\n<build><item objectid=\"2\" transform=\"1 0 0 0 1 0 0 0 1 -8 0 0\"/></build>\n\
         </model>\n",
        vertices.concat(),
        triangles.concat()
    ))
}

/// A polygon and a triangle with two inputs, in a node within a node.
fn collada() -> Vec<u8> {
    format!(
        "<?xml version=\"1.0\"?>\n<COLLADA xmlns=\"http://www.collada.org/2005/11/COLLADASchema\" \
         version=\"1.4.1\">\n<asset><unit name=\"inch\" meter=\"0.0254\"/><up_axis>Z_UP</up_axis>\
         </asset>\n<library_geometries><geometry id=\"g\"><mesh>\n<source id=\"p\">\
         <float_array id=\"a\" count=\"12\">{}</float_array><technique_common>\
         <accessor source=\"#a\" count=\"4\" stride=\"3\"><param name=\"X\" type=\"float\"/>\
         <param name=\"Y\" type=\"float\"/><param name=\"Z\" type=\"float\"/></accessor>\
         </technique_common></source>\n<vertices id=\"v\"><input semantic=\"POSITION\" source=\"#p\"/>\
         </vertices>\n<polylist count=\"1\"><input semantic=\"NORMAL\" source=\"#p\" offset=\"1\"/>\
         <input semantic=\"VERTEX\" source=\"#v\" offset=\"0\"/><vcount>3</vcount>\
         <p>0 9 1 9 2 9</p></polylist>\n<triangles count=\"1\">\
         <input semantic=\"VERTEX\" source=\"#v\" offset=\"0\"/><p>0 2 3</p></triangles>\n\
         </mesh></geometry></library_geometries>\n<library_visual_scenes><visual_scene id=\"s\">\
         <node><translate>0 0 16</translate><node><matrix>1 0 0 0 0 1 0 0 0 0 1 -16 0 0 0 1</matrix>\
         <instance_geometry url=\"#g\"/></node></node></visual_scene></library_visual_scenes>\n\
         <scene><instance_visual_scene url=\"#s\"/></scene>\n</COLLADA>\n",
        coordinates()
    )
    .into_bytes()
}

pub(crate) fn gifti(is_compressed: bool) -> Vec<u8> {
    let array = |intent: &str, kind: &str, rows: usize, text: &str, bytes: &[u8]| {
        let (encoding, data) = if is_compressed {
            ("GZipBase64Binary", STANDARD.encode(zlib(bytes)))
        } else {
            ("ASCII", text.to_owned())
        };
        format!(
            "<DataArray Intent=\"NIFTI_INTENT_{intent}\" DataType=\"NIFTI_TYPE_{kind}\" \
             ArrayIndexingOrder=\"RowMajorOrder\" Dimensionality=\"2\" Dim0=\"{rows}\" Dim1=\"3\" \
             Encoding=\"{encoding}\" Endian=\"LittleEndian\" ExternalFileName=\"\">\n<MetaData/>\n\
             <Data>{data}</Data>\n</DataArray>\n"
        )
    };
    let points = array("POINTSET", "FLOAT32", 4, &coordinates(), &floats());
    let triangles = array("TRIANGLE", "INT32", 2, "0 1 2\n0 2 3", &corners());
    format!(
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n\
         <!DOCTYPE GIFTI SYSTEM \"http://www.nitrc.org/frs/download.php/115/gifti.dtd\">\n\
         <GIFTI Version=\"1.0\" NumberOfDataArrays=\"2\">\n{points}{triangles}</GIFTI>\n"
    )
    .into_bytes()
}

fn freesurfer() -> Vec<u8> {
    let mut file = b"\xff\xff\xfecreated by nobody on a day\n\n".to_vec();
    for n in [4_u32, 2] {
        file.extend_from_slice(&n.to_be_bytes());
    }
    let all = POSITIONS.as_flattened().iter();
    file.extend(all.flat_map(|&x| (x as f32).to_be_bytes()));
    file.extend(
        TRIANGLES
            .as_flattened()
            .iter()
            .flat_map(|v| v.to_be_bytes()),
    );
    file.extend_from_slice(b"\0\0\0\x02\0\0\0\0");
    file
}
