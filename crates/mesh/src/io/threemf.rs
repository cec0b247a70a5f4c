//! 3MF: a ZIP archive with objects in XML, which items of a build place.
//!
//! Objects of components and models in other files of the archive (production extension) are read.
//! Colours and materials are ignored, and so are beams and slices, unless the file says that it
//! needs them. Units are not converted.

use std::collections::hash_map::Entry;
use std::collections::{BTreeSet, HashMap};
use std::io::Read;

use flate2::read::DeflateDecoder;
use rawzip::{CompressionMethod, ZipArchive};
use roxmltree::Node;

use super::error::Flaw;
use super::faces::FileMesh;
use super::scene::{Affine, Assembly, DEEPEST, too_deep};
use super::xml::{self, child, children, descendants, flaw, needed};

/// Parts of the names of extensions without which the surface is the same.
const HARMLESS: [&str; 3] = ["/material/", "/production/", "/trianglesets/"];

/// The model of most archives.
const USUAL: &str = "3D/3dmodel.model";

/// Reads a 3MF file whose parts decompress to at most `room` bytes.
pub(super) fn read(bytes: &[u8], room: u64) -> Result<FileMesh, Flaw> {
    let mut archive = Archive { bytes, room };
    let main = archive.main()?;
    let mut texts = vec![(main.clone(), archive.text(&main)?)];
    let document = xml::parse(&texts[0].1).map_err(|flaw| flaw.within(&main))?;
    let others = document.descendants().filter_map(path_of);
    let others: BTreeSet<String> = others.map(str::to_owned).collect();
    for name in others.into_iter().filter(|name| *name != main) {
        let text = archive.text(&name)?;
        texts.push((name, text));
    }
    let documents = texts.iter().map(|(name, text)| {
        let document = xml::parse(text).map_err(|flaw| flaw.within(name))?;
        Ok((name.as_str(), document))
    });
    let documents = documents.collect::<Result<Vec<_>, Flaw>>()?;
    let mut model = BuildItems {
        objects: HashMap::new(),
        pieces: HashMap::new(),
        scene: Assembly::new(room),
    };
    for (name, document) in &documents {
        check_extensions(document.root_element()).map_err(|flaw| flaw.within(name))?;
        for object in descendants(document.root_element(), "object") {
            if let Some(id) = object.attribute("id") {
                model.objects.insert((*name, id), object);
            }
        }
    }
    let root = documents[0].1.root_element();
    let build = child(root, "build");
    let items: Vec<Node<'_, '_>> = build
        .into_iter()
        .flat_map(|b| children(b, "item"))
        .collect();
    model
        .place(&main, &items)
        .map_err(|flaw| flaw.within(&main))?;
    model.scene.into_mesh()
}

/// Checks that the surface is the same without the extensions that a model needs.
fn check_extensions(model: Node<'_, '_>) -> Result<(), Flaw> {
    let prefixes = model.attribute("requiredextensions").unwrap_or_default();
    for prefix in prefixes.split_ascii_whitespace() {
        let name = model.lookup_namespace_uri(Some(prefix)).unwrap_or(prefix);
        if !HARMLESS.iter().any(|part| name.contains(part)) {
            let problem = format!("it needs the extension {name}, which is not read");
            return Err(flaw(model, format!("{problem}; save it without")));
        }
    }
    Ok(())
}

/// The file in the archive that an element refers to, without the slash at its start.
fn path_of<'a>(node: Node<'a, '_>) -> Option<&'a str> {
    let name = node.tag_name().name();
    let path = node
        .attribute("path")
        .filter(|_| name == "item" || name == "component")?;
    Some(path.trim_start_matches('/'))
}

struct Archive<'a> {
    bytes: &'a [u8],
    /// How many more bytes may be decompressed.
    room: u64,
}

impl Archive<'_> {
    /// The name of the main model.
    fn main(&mut self) -> Result<String, Flaw> {
        let Some(relations) = self.part("_rels/.rels")? else {
            return Ok(USUAL.to_owned());
        };
        let text = xml::text(&relations);
        let document = xml::parse(&text).map_err(|flaw| flaw.within("_rels/.rels"))?;
        let mut relations = descendants(document.root_element(), "Relationship");
        let model = relations.find(|relation| {
            relation
                .attribute("Type")
                .is_some_and(|kind| kind.ends_with("/3dmodel"))
        });
        let target = model.and_then(|relation| relation.attribute("Target"));
        Ok(target.unwrap_or(USUAL).trim_start_matches('/').to_owned())
    }

    /// The text of the part with this name.
    fn text(&mut self, name: &str) -> Result<String, Flaw> {
        let part = self.part(name)?;
        let part = part.ok_or_else(|| Flaw::file(format!("it has no part {name}")))?;
        Ok(xml::text(&part).into_owned())
    }

    /// The decompressed part with this name; `None` if there is none.
    fn part(&mut self, name: &str) -> Result<Option<Vec<u8>>, Flaw> {
        let damaged = |why: String| {
            Flaw::file(format!(
                "the ZIP archive is damaged or cut off ({why}); fetch it again"
            ))
        };
        let archive = ZipArchive::from_slice(self.bytes).map_err(|e| damaged(e.to_string()))?;
        for entry in archive.entries() {
            let entry = entry.map_err(|e| damaged(e.to_string()))?;
            if !entry
                .file_path()
                .as_ref()
                .eq_ignore_ascii_case(name.as_bytes())
            {
                continue;
            }
            let data = archive
                .get_entry(entry.wayfinder())
                .map_err(|e| damaged(e.to_string()))?;
            let limit = self.room.saturating_add(1);
            let mut part = Vec::new();
            let read = match entry.compression_method() {
                CompressionMethod::STORE => data.data().take(limit).read_to_end(&mut part),
                CompressionMethod::DEFLATE => DeflateDecoder::new(data.data())
                    .take(limit)
                    .read_to_end(&mut part),
                other => {
                    let name = other.as_u16();
                    return Err(Flaw::file(format!(
                        "its parts are compressed by method {name}, which is not read"
                    )));
                }
            };
            read.map_err(|e| damaged(e.to_string()))?;
            self.room = self.room.checked_sub(part.len() as u64).ok_or_else(|| {
                Flaw::file("its parts decompress to more than the limit").over_limit()
            })?;
            return Ok(Some(part));
        }
        Ok(None)
    }
}

struct BuildItems<'a, 'd> {
    /// The objects by the name of their part and their id.
    objects: HashMap<(&'a str, &'a str), Node<'a, 'd>>,
    /// The meshes of objects that have been placed.
    pieces: HashMap<(&'a str, &'a str), FileMesh>,
    scene: Assembly,
}

impl<'a, 'd> BuildItems<'a, 'd> {
    /// Places the objects of these items of the part `main`, and what they consist of.
    fn place(&mut self, main: &'a str, items: &[Node<'a, 'd>]) -> Result<(), Flaw> {
        let start = items.iter().rev();
        let mut open: Vec<_> = start
            .map(|&item| (item, main, Affine::IDENTITY, 0))
            .collect();
        while let Some((node, part, outer, depth)) = open.pop() {
            if depth > DEEPEST {
                return Err(too_deep("an object"));
            }
            self.scene.visit()?;
            let id = node.attribute("objectid").unwrap_or_default();
            let part = path_of(node).unwrap_or(part);
            let found = self.objects.get_key_value(&(part, id));
            let found = found.map(|(key, object)| (*key, *object));
            let ((part, id), object) =
                found.ok_or_else(|| flaw(node, format!("there is no object {id} in {part}")))?;
            let transform = outer.after(&transform_of(node)?);
            let mesh = child(object, "mesh");
            if mesh.is_none() && child(object, "components").is_none() {
                return Err(flaw(object, "has neither a mesh nor components"));
            }
            if let Some(mesh) = mesh {
                if let Entry::Vacant(place) = self.pieces.entry((part, id)) {
                    place.insert(piece(mesh)?);
                }
                let name = format!("object {id}");
                self.scene
                    .place(&self.pieces[&(part, id)], &transform, &name)?;
            }
            let parts: Vec<_> = children(object, "components")
                .flat_map(|components| children(components, "component"))
                .collect();
            let parts = parts.into_iter().rev();
            open.extend(parts.map(|component| (component, part, transform, depth + 1)));
        }
        Ok(())
    }
}

/// The transform of an item or a component: four rows of three numbers, by which row vectors are
/// multiplied.
fn transform_of(node: Node<'_, '_>) -> Result<Affine, Flaw> {
    let Some(text) = node.attribute("transform") else {
        return Ok(Affine::IDENTITY);
    };
    let numbers = text.split_ascii_whitespace().map(str::parse::<f64>);
    let numbers: Vec<f64> = numbers.collect::<Result<_, _>>().unwrap_or_default();
    let [a, b, c, d, e, f, g, h, i, x, y, z] = numbers[..] else {
        return Err(flaw(node, "its transform has not twelve numbers"));
    };
    Ok(Affine([[a, d, g, x], [b, e, h, y], [c, f, i, z]]))
}

/// The mesh of an object.
fn piece(mesh: Node<'_, '_>) -> Result<FileMesh, Flaw> {
    let mut piece = FileMesh::default();
    let all = |list, item| children(mesh, list).flat_map(move |list| children(list, item));
    for vertex in all("vertices", "vertex") {
        let mut position = [0.0; 3];
        for (coordinate, name) in position.iter_mut().zip(["x", "y", "z"]) {
            *coordinate = needed(vertex, name)?;
        }
        piece.positions.push(position);
    }
    for triangle in all("triangles", "triangle") {
        let mut corners = [0; 3];
        for (corner, name) in corners.iter_mut().zip(["v1", "v2", "v3"]) {
            *corner = needed(triangle, name)?;
        }
        piece.faces.push(&corners);
    }
    Ok(piece)
}
