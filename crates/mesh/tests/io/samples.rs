//! Small valid files, built byte by byte so that the readers are not tested against the writers.

use std::fmt::Write;

use geobench_mesh::io::Format;

use crate::scene_samples;

/// Two triangles that share an edge, in every format and variant: the corners of a square that
/// is bent along its diagonal.
pub(crate) fn all() -> Vec<(&'static str, Format, Vec<u8>)> {
    let mut all = vec![
        ("OBJ", Format::Obj, obj()),
        ("text PLY", Format::Ply, text_ply()),
        ("little-endian PLY", Format::Ply, binary_ply(true)),
        ("big-endian PLY", Format::Ply, binary_ply(false)),
        ("OFF", Format::Off, off()),
        ("text STL", Format::Stl, text_stl()),
        ("binary STL", Format::Stl, binary_stl()),
    ];
    all.extend(scene_samples::all());
    all
}

/// All samples, and some with polygons, to be damaged.
pub(crate) fn to_damage() -> Vec<(Format, Vec<u8>)> {
    let comb = "OFF\n13 3 0\n0 0 0\n7 0 0\n7 5 0\n6 5 0\n6 1 0\n4 1 0\n4 5 0\n3 5 0\n3 1 0\n1 1 0\n\
                1 5 0\n0 5 0\n3 2 9\n12 0 1 2 3 4 5 6 7 8 9 10 11\n5 0 1 12 2 3\n4 12 11 0 1\n";
    let fan = "v 0 0 0\nv 1 0 0\nv 1 1 .1\nv 0 1 0\nv -1 1 1e-3\nv -1 0 0\nv -1 -1 -2.5E1\n\
               f 1 2 3 4 5 6\nf 1/1 -1/2 -2/3\nf 1//1 2//1 \\\n7//2\nv 3 3 3 2\nf 8 7 6 5 4 3 2 1\n";
    let quads = "ply\nformat ascii 1.0\nelement vertex 5\nproperty double x\nproperty double y\n\
                 property double z\nelement face 2\nproperty list uint8 int32 vertex_index\nend_header\n\
                 0 0 0\n1 0 0\n1 1 0\n0 1 0\n.5 .5 3\n4 0 1 2 3\n3 0 1 4\n";
    let polygons = [
        (Format::Off, comb),
        (Format::Obj, fan),
        (Format::Ply, quads),
    ];
    let plain = all().into_iter().map(|(_, format, bytes)| (format, bytes));
    plain
        .chain(polygons.map(|(format, text)| (format, text.as_bytes().to_vec())))
        .collect()
}

/// The vertices of all samples, in order.
pub(crate) const POSITIONS: [[f64; 3]; 4] = [
    [0.0, 0.0, 0.5],
    [1.0, 0.0, 0.25],
    [1.0, 1.5, 0.0],
    [0.0, -1.0, 2.0],
];

/// The triangles of all samples, in order.
pub(crate) const TRIANGLES: [[u32; 3]; 2] = [[0, 1, 2], [0, 2, 3]];

fn obj() -> Vec<u8> {
    b"# a remark\nmtllib none.mtl\no thing\nv 0 0 0.5\nv 1 0 0.25 1.0\nvt 0 0\nvn 0 0 1\n\
      v 1 1.5 0 0.5 0.5 0.5\nv 0 -1 2\ng first\nusemtl red\nf 1/1/1 2//1 3/1\ng second\n\
      usemtl blue\nl 1 2 3\np 1\nf -4 -2 -1\n"
        .to_vec()
}

fn text_ply() -> Vec<u8> {
    b"ply\r\nformat ascii 1.0\r\ncomment a remark\r\nobj_info more\r\nelement vertex 4\r\n\
      property float x\r\nproperty float y\r\nproperty uchar red\r\nproperty double z\r\n\
      element face 2\r\nproperty list uchar int vertex_indices\r\nproperty float area\r\n\
      element edge 1\r\nproperty int vertex1\r\nproperty int vertex2\r\nend_header\r\n\
      0 0 7 0.5\r\n1 0 7 0.25\r\n1 1.5 7 0\r\n0 -1 7 2\r\n3 0 1 2 9.5\r\n\r\n3 0 2 3 nan\r\n0 1\r\n"
        .to_vec()
}

/// Faces before vertices, coordinates of three types, and much to skip.
fn binary_ply(little: bool) -> Vec<u8> {
    let order = if little { "little" } else { "big" };
    let mut file = format!(
        "ply\nformat binary_{order}_endian 1.0\nelement material 1\nproperty list ushort uchar name\n\
         element face 2\nproperty uchar flags\nproperty list ushort short vertex_index\n\
         property list uchar float texcoord\nelement vertex 4\nproperty float x\n\
         property float nx\nproperty double y\nproperty float z\nend_header\n"
    )
    .into_bytes();
    macro_rules! put {
        ($($value:expr),*) => {
            $(file.extend_from_slice(&if little {
                $value.to_le_bytes()
            } else {
                $value.to_be_bytes()
            });)*
        };
    }
    put!(3u16, b'r', b'e', b'd');
    for [a, b, c] in TRIANGLES.map(|t| t.map(|v| v as i16)) {
        put!(255u8, 3u16, a, b, c, 2u8, 0.5f32, 0.25f32);
    }
    for [x, y, z] in POSITIONS {
        put!(x as f32, 9f32, y, z as f32);
    }
    file
}

fn off() -> Vec<u8> {
    b"COFF # colours\n\n# counts\n4 2 5\n0 0 0.5 255 0 0\n1 0 0.25 255 0 0 # second\n\t1 1.5 0\n\n\
      0 -1 2\n3 0 1 2 0.5 0.5 0.5\n3 0 2 3\n"
        .to_vec()
}

fn text_stl() -> Vec<u8> {
    let mut file = String::from("solid bent square\n");
    for triangle in TRIANGLES {
        file += "  facet normal 0 0 1\n    outer loop\n";
        for [x, y, z] in triangle.map(|v| POSITIONS[v as usize]) {
            writeln!(file, "      vertex {x} {y:e} {z}").unwrap();
        }
        file += "    endloop\n  endfacet\n";
    }
    file += "endsolid bent square\n";
    file.into_bytes()
}

fn binary_stl() -> Vec<u8> {
    let mut file = vec![b' '; 80];
    file[..20].copy_from_slice(b"solid but not a text");
    file.extend_from_slice(&2u32.to_le_bytes());
    for triangle in TRIANGLES {
        file.extend_from_slice(&[0; 12]);
        for x in triangle.map(|v| POSITIONS[v as usize]).as_flattened() {
            file.extend_from_slice(&(*x as f32).to_le_bytes());
        }
        file.extend_from_slice(&[1, 2]);
    }
    file
}
