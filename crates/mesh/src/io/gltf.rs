//! glTF 2.0, as JSON (`.gltf`) and binary (`.glb`): meshes that the nodes of a scene place.
//!
//! Triangles, strips and fans are read, also with quantised and sparse positions; points and lines
//! are not. Skins and morphs are not applied. Buffers are embedded, in the binary part, or files
//! beside the JSON, in its folder.

use std::collections::HashMap;
use std::collections::hash_map::Entry;
use std::path::{Path, PathBuf};

use serde_json::Value;

use super::arrays::{NumberType, from_base64};
use super::beside;
use super::error::Flaw;
use super::faces::FileMesh;
use super::gzip::usual_decompression_limit;
use super::scene::{Affine, Assembly, DEEPEST, NOT_AFFINE, too_deep};

/// Extensions without which there are no positions.
const COMPRESSED: [&str; 2] = ["KHR_draco_mesh_compression", "EXT_meshopt_compression"];

/// The extension of nodes that place copies of their mesh.
const INSTANCES: &str = "EXT_mesh_gpu_instancing";

/// How far the square of the length of a unit quaternion may be from 1.
const MOST_ROUNDING: f64 = 1e-3;

/// Reads a glTF file at `path`, whose placed meshes take at most `room` bytes, and
/// [`usual_decompression_limit`] of each file beside it.
pub(super) fn read(bytes: &[u8], path: &Path, room: u64) -> Result<FileMesh, Flaw> {
    let (json, binary) = parts(bytes)?;
    let json: Value = serde_json::from_slice(json).map_err(|error| {
        if !json.trim_ascii_start().starts_with(b"{") {
            return Flaw::file(
                "it starts neither with glTF, as a .glb does, nor with {, as JSON does; fetch or \
                 save it again",
            );
        }
        Flaw::line(
            error.line() as u64,
            format!("this is no valid JSON: {error}"),
        )
    })?;
    let version = json["asset"]["version"].as_str().unwrap_or_default();
    if !version.starts_with("2.") {
        return Err(Flaw::file(format!(
            "its version of glTF is {version:?}, and 2.0 is read; save it anew"
        )));
    }
    for extension in list(&json, "extensionsRequired")
        .iter()
        .filter_map(Value::as_str)
    {
        if COMPRESSED.contains(&extension) {
            return Err(Flaw::file(compressed_by(extension)));
        }
        if !is_harmless(extension) {
            return Err(Flaw::file(format!(
                "it needs the extension {extension}, which is not read; save it without"
            )));
        }
    }
    let mut document = GltfFile {
        json: &json,
        embedded: HashMap::new(),
        files: HashMap::new(),
        binary,
        path,
        scene: Assembly::new(room),
    };
    document.place()?;
    document.scene.into_mesh()
}

/// The files that a glTF file at `path` names as buffers, where they would be read.
pub(super) fn buffer_files(bytes: &[u8], path: &Path) -> Vec<PathBuf> {
    let json = parts(bytes).ok().map(|(json, _)| json);
    let json: Option<Value> = json.and_then(|json| serde_json::from_slice(json).ok());
    let Some(json) = json else {
        return Vec::new();
    };
    let names = list(&json, "buffers").iter();
    let names = names.filter_map(|buffer| buffer["uri"].as_str());
    let files = names.filter(|name| !name.starts_with("data:"));
    files
        .filter_map(|name| beside::place(path, &percent_decoded(name)))
        .collect()
}

/// The JSON of a file, and its binary part if it has one.
fn parts(bytes: &[u8]) -> Result<(&[u8], Option<&[u8]>), Flaw> {
    if bytes.starts_with(b"glTF") {
        return chunks(bytes);
    }
    let json = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes);
    Ok((json, None))
}

/// What is wrong with positions that an extension compresses.
fn compressed_by(extension: &str) -> String {
    format!("its positions are compressed by {extension}; save it without compression")
}

/// Whether a surface is the same without an extension that the file needs: quantised numbers are
/// read in any case, and the others are about looks and names.
fn is_harmless(extension: &str) -> bool {
    let kinds = [
        "KHR_mesh_quantization",
        "KHR_materials_",
        "KHR_texture_",
        "KHR_lights_",
        "KHR_technique",
        "KHR_xmp",
        "KHR_animation_pointer",
        "KHR_audio",
        "EXT_texture_",
        "EXT_lights_",
        "EXT_mesh_features",
        "EXT_instance_features",
        "EXT_structural_metadata",
        "EXT_mesh_manifold",
        "MSFT_texture_dds",
        "VRMC_materials_",
    ];
    kinds.iter().any(|kind| extension.starts_with(kind))
}

/// The JSON of a binary file, and its binary part.
fn chunks(bytes: &[u8]) -> Result<(&[u8], Option<&[u8]>), Flaw> {
    let word = |at: usize| {
        let word = bytes.get(at..at.checked_add(4)?)?;
        Some(u32::from_le_bytes(word.try_into().ok()?))
    };
    let cut = || Flaw::file("the file ends within its header or JSON; fetch it again");
    if word(4).ok_or_else(cut)? != 2 {
        return Err(Flaw::file("this is no binary file of glTF version 2"));
    }
    let declared = word(8).ok_or_else(cut)?;
    // What follows the declared length is padding.
    let bytes = bytes.get(..declared as usize).ok_or_else(|| {
        Flaw::file(format!(
            "the file is cut off: it has {} of the {declared} bytes that its header declares; fetch \
             it again",
            bytes.len()
        ))
    })?;
    let chunk = |at: usize| {
        let length = word(at)? as usize;
        let kind = bytes.get(at + 4..at + 8)?;
        Some((kind, bytes.get(at + 8..(at + 8).checked_add(length)?)?))
    };
    let (kind, json) = chunk(12).ok_or_else(cut)?;
    if kind != b"JSON" {
        return Err(Flaw::file("its first chunk is not JSON"));
    }
    // The length of a chunk is to include its padding. Some programs pad nothing, others do not
    // count the padding.
    let end = 20 + json.len();
    let is_next = |at: &usize| bytes.get(at + 4..at + 8) == Some(&b"BIN\0"[..]);
    let at = Some(end).filter(is_next).unwrap_or(end.next_multiple_of(4));
    let second = chunk(at);
    if second.is_none() && bytes.len() >= at + 8 {
        return Err(Flaw::file(format!(
            "its second chunk ends behind the {declared} bytes that its header declares; fetch it \
             again"
        )));
    }
    let binary = second
        .filter(|(kind, _)| kind == b"BIN\0")
        .map(|(_, data)| data);
    Ok((json, binary))
}

/// The elements of a list; none if it is missing.
fn list<'a>(value: &'a Value, name: &str) -> &'a [Value] {
    value[name].as_array().map_or(&[], Vec::as_slice)
}

/// A whole number; `None` if it is missing. An error is in words.
fn whole(value: &Value, name: &str) -> Result<Option<usize>, String> {
    let number = match &value[name] {
        Value::Null => return Ok(None),
        number => number.as_u64().and_then(|number| number.try_into().ok()),
    };
    let wrong = || format!("{name} is {}, not a whole number from 0", value[name]);
    number.map(Some).ok_or_else(wrong)
}

/// The N numbers of a list; `None` if it is missing.
fn fixed<const N: usize>(value: &Value, name: &str, of: &str) -> Result<Option<[f64; N]>, Flaw> {
    if value[name].is_null() {
        return Ok(None);
    }
    let numbers: Option<Vec<f64>> = list(value, name).iter().map(Value::as_f64).collect();
    let numbers = numbers.unwrap_or_default().try_into().map(Some);
    numbers.map_err(|_| Flaw::file(format!("{of}: {name} has not {N} numbers")))
}

struct GltfFile<'a> {
    json: &'a Value,
    /// The buffers in the JSON, by their number.
    embedded: HashMap<usize, Vec<u8>>,
    /// The files that hold buffers.
    files: HashMap<PathBuf, Vec<u8>>,
    binary: Option<&'a [u8]>,
    path: &'a Path,
    scene: Assembly,
}

impl GltfFile<'_> {
    /// Places the meshes of the scene.
    fn place(&mut self) -> Result<(), Flaw> {
        let json = self.json;
        let nodes = list(json, "nodes");
        let scenes = list(json, "scenes");
        let scene = whole(json, "scene").map_err(Flaw::file)?;
        let roots: Vec<usize> = match scenes.get(scene.unwrap_or(0)) {
            Some(scene) => indices(scene, "nodes"),
            None if scenes.is_empty() => {
                let mut is_root = vec![true; nodes.len()];
                for child in nodes.iter().flat_map(|node| indices(node, "children")) {
                    if let Some(is_root) = is_root.get_mut(child) {
                        *is_root = false;
                    }
                }
                (0..nodes.len()).filter(|&node| is_root[node]).collect()
            }
            None => return Err(Flaw::file("the scene that it shows does not exist")),
        };
        let mut pieces: HashMap<usize, FileMesh> = HashMap::new();
        let mut open: Vec<_> = roots
            .iter()
            .rev()
            .map(|&n| (n, Affine::IDENTITY, 0))
            .collect();
        if nodes.is_empty() && scenes.is_empty() {
            for mesh in 0..list(json, "meshes").len() {
                let piece = self.mesh(mesh)?;
                let name = format!("mesh {mesh}");
                self.scene.place(&piece, &Affine::IDENTITY, &name)?;
            }
        }
        while let Some((number, outer, depth)) = open.pop() {
            if depth > DEEPEST {
                return Err(too_deep("a node"));
            }
            self.scene.visit()?;
            let node = nodes
                .get(number)
                .ok_or_else(|| Flaw::file(format!("node {number} does not exist")))?;
            let transform = outer.after(&transform_of(node, number)?);
            let mesh = whole(node, "mesh");
            if let Some(mesh) = mesh.map_err(|p| Flaw::file(format!("node {number}: {p}")))? {
                if let Entry::Vacant(place) = pieces.entry(mesh) {
                    place.insert(self.mesh(mesh)?);
                }
                if !node["extensions"][INSTANCES].is_null() {
                    return Err(Flaw::file(format!(
                        "node {number}: its copies ({INSTANCES}) are not read; save it without"
                    )));
                }
                if is_posed(node, &list(json, "meshes")[mesh]) {
                    self.scene.note_unposed();
                }
                self.scene
                    .place(&pieces[&mesh], &transform, &format!("mesh {mesh}"))?;
            }
            let children = indices(node, "children").into_iter().rev();
            open.extend(children.map(|child| (child, transform, depth + 1)));
        }
        Ok(())
    }

    /// The triangles of a mesh. Primitives with the same positions share vertices.
    fn mesh(&mut self, number: usize) -> Result<FileMesh, Flaw> {
        let mesh = list(self.json, "meshes").get(number);
        let mesh = mesh.ok_or_else(|| Flaw::file(format!("mesh {number} does not exist")))?;
        let mut piece = FileMesh::default();
        let mut firsts: HashMap<usize, (u32, u32)> = HashMap::new();
        for (i, primitive) in list(mesh, "primitives").iter().enumerate() {
            let name = format!("mesh {number}, primitive {i}");
            let wrong = |problem: String| Flaw::file(format!("{name}: {problem}"));
            let mode = whole(primitive, "mode").map_err(wrong)?.unwrap_or(4);
            let positions = whole(&primitive["attributes"], "POSITION").map_err(wrong)?;
            let Some(positions) = positions else {
                continue;
            };
            // Points and lines.
            if mode < 4 {
                continue;
            }
            // Beside the compressed positions there may be others.
            let has_others = list(self.json, "accessors")
                .get(positions)
                .is_some_and(|accessor| accessor["bufferView"].is_number());
            let extensions = &primitive["extensions"];
            let extension = COMPRESSED.iter().find(|name| !extensions[**name].is_null());
            if let (Some(extension), false) = (extension, has_others) {
                let problem = compressed_by(extension);
                return Err(Flaw::file(format!("{name}: {problem}")));
            }
            if let Entry::Vacant(place) = firsts.entry(positions) {
                let all = self.accessor(positions, 3)?;
                place.insert((piece.positions.len() as u32, all.len() as u32 / 3));
                piece.positions.extend(all.as_chunks().0);
            }
            let (first, count) = firsts[&positions];
            let corners = match whole(primitive, "indices").map_err(wrong)? {
                Some(accessor) => self.accessor(accessor, 1)?,
                None => (0..count).map(f64::from).collect(),
            };
            let corners = corners.into_iter().map(|corner: f64| {
                // Indices are whole numbers.
                let is_vertex = (0.0..f64::from(count)).contains(&corner);
                #[expect(clippy::cast_sign_loss, reason = "it is not negative")]
                let moved = is_vertex.then(|| first + corner as u32);
                moved.ok_or_else(|| {
                    Flaw::file(format!(
                        "{name}: names vertex {corner} of {count}, counted from 0"
                    ))
                })
            });
            let corners = corners.collect::<Result<Vec<u32>, Flaw>>()?;
            match mode {
                4 => {
                    let (triangles, rest) = corners.as_chunks::<3>();
                    if !rest.is_empty() {
                        let problem = format!("it has {} corners, not three each", corners.len());
                        return Err(wrong(problem));
                    }
                    for face in triangles {
                        piece.faces.push(face);
                    }
                }
                5 => piece.faces.push_strip(&corners),
                6 => {
                    for pair in corners.get(1..).unwrap_or_default().windows(2) {
                        piece.faces.push(&[corners[0], pair[0], pair[1]]);
                    }
                }
                _ => return Err(Flaw::file(format!("{name}: the mode {mode} is unknown"))),
            }
        }
        Ok(piece)
    }

    /// The numbers of an accessor with `columns` columns, row after row.
    fn accessor(&mut self, number: usize, columns: usize) -> Result<Vec<f64>, Flaw> {
        let within = |flaw: Flaw| flaw.within(&format!("accessor {number}"));
        let wrong = |problem: &str| within(Flaw::file(problem));
        let accessors = list(self.json, "accessors");
        let accessor = accessors
            .get(number)
            .ok_or_else(|| wrong("it does not exist"))?;
        let wanted = if columns == 1 { "SCALAR" } else { "VEC3" };
        if accessor["type"].as_str() != Some(wanted) {
            return Err(wrong(&format!(
                "its type is {}, not {wanted}",
                accessor["type"]
            )));
        }
        let component = |value: &Value| {
            Some(match whole(value, "componentType").ok()?? {
                5120 => (NumberType::I8, 127.0),
                5121 => (NumberType::U8, 255.0),
                5122 => (NumberType::I16, 32767.0),
                5123 => (NumberType::U16, 65535.0),
                5125 => (NumberType::U32, 4_294_967_295.0),
                5126 => (NumberType::F32, 1.0),
                _ => return None,
            })
        };
        let unknown = || wrong("its componentType is unknown");
        let (kind, largest) = component(accessor).ok_or_else(unknown)?;
        let number_of = |from: &Value, name: &str| whole(from, name).map_err(|p| wrong(&p));
        let count = number_of(accessor, "count")?.ok_or_else(|| wrong("it has no count"))?;
        let rows = |from: &Value, kind, columns, count| -> Result<Rows, Flaw> {
            Ok(Rows {
                view: number_of(from, "bufferView")?,
                offset: number_of(from, "byteOffset")?.unwrap_or(0),
                kind,
                columns,
                count,
            })
        };
        let mut numbers = self
            .numbers(&rows(accessor, kind, columns, count)?)
            .map_err(within)?;
        let sparse = &accessor["sparse"];
        if let Some(changes) = number_of(sparse, "count")? {
            let (places, values) = (&sparse["indices"], &sparse["values"]);
            let (index, _) = component(places).ok_or_else(unknown)?;
            let places = self
                .numbers(&rows(places, index, 1, changes)?)
                .map_err(within)?;
            let values = self
                .numbers(&rows(values, kind, columns, changes)?)
                .map_err(within)?;
            for (&place, value) in places.iter().zip(values.chunks_exact(columns)) {
                if !(0.0..count as f64).contains(&place) {
                    return Err(wrong(&format!(
                        "its sparse index {place} is not below {count}"
                    )));
                }
                #[expect(clippy::cast_sign_loss, reason = "it is not negative")]
                let start = columns * place as usize;
                numbers[start..start + columns].copy_from_slice(value);
            }
        }
        if accessor["normalized"].as_bool() == Some(true) {
            for number in &mut numbers {
                *number = (*number / largest).max(-1.0);
            }
        }
        Ok(numbers)
    }

    /// The numbers of rows in a buffer; zeros without a buffer.
    fn numbers(&mut self, rows: &Rows) -> Result<Vec<f64>, Flaw> {
        let Rows {
            view,
            columns,
            count,
            ..
        } = *rows;
        let total = count
            .checked_mul(columns)
            .filter(|&total| total < usize::MAX / 8);
        let total = total.ok_or_else(|| Flaw::file("its count is too large"))?;
        // Any number of primitives may name the same accessor.
        let bytes = 8 * total as u64;
        self.scene.pay(bytes)?;
        match view {
            Some(number) => self.numbers_of_view(rows, number).map_err(Flaw::file),
            None => Ok(vec![0.0; total]),
        }
    }

    /// The numbers of rows in the bufferView `number`.
    fn numbers_of_view(&mut self, rows: &Rows, number: usize) -> Result<Vec<f64>, String> {
        let Rows {
            offset,
            kind,
            columns,
            count,
            ..
        } = *rows;
        let json = self.json;
        let view = list(json, "bufferViews").get(number);
        let view = view.ok_or_else(|| format!("there is no bufferView {number}"))?;
        let buffer = whole(view, "buffer")?.unwrap_or(usize::MAX);
        let is_empty = list(json, "buffers").get(buffer).is_some_and(|buffer| {
            let [_, meshopt] = COMPRESSED.map(|name| &buffer["extensions"][name]["fallback"]);
            *meshopt == true && buffer["uri"].is_null()
        });
        if is_empty {
            return Err(compressed_by(COMPRESSED[1]));
        }
        let data = self.buffer(buffer)?;
        let start = whole(view, "byteOffset")?.unwrap_or(0);
        let length = whole(view, "byteLength")?.unwrap_or(0);
        let row = columns * kind.size();
        let stride = whole(view, "byteStride")?
            .filter(|&stride| stride >= row)
            .unwrap_or(row);
        let data = start
            .checked_add(length)
            .and_then(|end| data.get(start..end));
        let data = data.ok_or_else(|| format!("bufferView {number} ends behind its buffer"))?;
        let end = match count.checked_sub(1) {
            Some(rows) => rows
                .checked_mul(stride)
                .and_then(|end| end.checked_add(offset)?.checked_add(row)),
            None => Some(0),
        };
        if end.is_none_or(|end| end > data.len()) {
            return Err(format!(
                "its {count} elements end behind bufferView {number}"
            ));
        }
        let starts = (0..count).map(|i| offset + i * stride);
        let numbers = starts.flat_map(|start| data[start..start + row].chunks_exact(kind.size()));
        Ok(numbers.map(|bytes| kind.float(bytes, true)).collect())
    }

    /// The bytes of a buffer.
    fn buffer(&mut self, number: usize) -> Result<&[u8], String> {
        let json = self.json;
        let buffer = list(json, "buffers")
            .get(number)
            .ok_or("its buffer does not exist")?;
        let Some(uri) = buffer["uri"].as_str() else {
            let binary = self.binary.filter(|_| number == 0);
            return binary.ok_or_else(|| format!("buffer {number} has no uri"));
        };
        let Some(data) = uri.strip_prefix("data:") else {
            return self.beside(uri);
        };
        match self.embedded.entry(number) {
            Entry::Occupied(known) => Ok(known.into_mut()),
            Entry::Vacant(place) => {
                let coded = data
                    .split_once(";base64,")
                    .map(|(_, coded)| coded.as_bytes());
                let bytes = coded.and_then(from_base64);
                let bytes = bytes.ok_or_else(|| format!("buffer {number} is no valid base64"))?;
                Ok(place.insert(bytes))
            }
        }
    }

    /// The contents of a file in the folder of this one or below.
    fn beside(&mut self, uri: &str) -> Result<&[u8], String> {
        let path = beside::place(self.path, &percent_decoded(uri))
            .ok_or_else(|| format!("the buffer {uri:?} is not in the folder of the file"))?;
        match self.files.entry(path) {
            Entry::Occupied(known) => Ok(known.into_mut()),
            Entry::Vacant(place) => {
                let bytes = beside::part(place.key(), 0, u64::MAX).ok_or_else(|| {
                    format!(
                        "the buffer {uri:?} cannot be read: it must lie beside the file, and beside \
                         standard input there is none; name the file, or save it as .glb"
                    )
                })?;
                self.scene
                    .make_room(usual_decompression_limit(bytes.len() as u64));
                Ok(place.insert(bytes))
            }
        }
    }
}

/// Where numbers are.
struct Rows {
    view: Option<usize>,
    /// In bytes, in the view.
    offset: usize,
    kind: NumberType,
    columns: usize,
    count: usize,
}

/// Whether a skin or a morph changes the shape of a mesh that a node places.
fn is_posed(node: &Value, mesh: &Value) -> bool {
    let weights = match list(node, "weights") {
        [] => list(mesh, "weights"),
        own => own,
    };
    let has_targets = |primitive: &Value| {
        let mut targets = list(primitive, "targets").iter();
        targets.any(|target| !target["POSITION"].is_null())
    };
    let is_morphed = weights.iter().any(|weight| weight.as_f64() != Some(0.0));
    !node["skin"].is_null() || is_morphed && list(mesh, "primitives").iter().any(has_targets)
}

/// The whole numbers of a list.
fn indices(value: &Value, name: &str) -> Vec<usize> {
    let numbers = list(value, name).iter().filter_map(Value::as_u64);
    numbers
        .filter_map(|number| number.try_into().ok())
        .collect()
}

/// The transform of a node: a matrix, or a scale, a rotation and a shift.
fn transform_of(node: &Value, number: usize) -> Result<Affine, Flaw> {
    let name = format!("node {number}");
    if let Some(matrix) = fixed(node, "matrix", &name)? {
        return Affine::from_columns(&matrix)
            .ok_or_else(|| Flaw::file(format!("{name}: {NOT_AFFINE}")));
    }
    let mut transform = Affine::IDENTITY;
    if let Some(shift) = fixed(node, "translation", &name)? {
        transform = transform.after(&Affine::shift(shift));
    }
    if let Some(quaternion) = fixed::<4>(node, "rotation", &name)? {
        // Single precision misses 1 by some 1e-7, which is no scale.
        let square: f64 = quaternion.iter().map(|x| x * x).sum();
        if (square - 1.0).abs() > MOST_ROUNDING {
            return Err(Flaw::file(format!(
                "{name}: rotation is no unit quaternion, and programs differ on what it means then"
            )));
        }
        let unit = quaternion.map(|x| x / square.sqrt());
        transform = transform.after(&Affine::rotation(unit));
    }
    if let Some(scale) = fixed(node, "scale", &name)? {
        transform = transform.after(&Affine::scale(scale));
    }
    Ok(transform)
}

/// A URI with its escapes, such as `%20`, decoded.
fn percent_decoded(uri: &str) -> String {
    let mut parts = uri.split('%');
    let mut bytes = parts.next().unwrap_or_default().as_bytes().to_vec();
    for part in parts {
        let digits = part
            .get(..2)
            .and_then(|digits| u8::from_str_radix(digits, 16).ok());
        let rest = if let Some(byte) = digits {
            bytes.push(byte);
            &part[2..]
        } else {
            bytes.push(b'%');
            part
        };
        bytes.extend_from_slice(rest.as_bytes());
    }
    String::from_utf8_lossy(&bytes).into_owned()
}
