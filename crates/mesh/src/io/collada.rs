//! COLLADA (`.dae`): geometries that the nodes of a visual scene place.
//!
//! Triangles, polygons, lists of polygons, strips and fans are read; lines and splines are not.
//! Skins and morphs are not applied: their geometry is placed as it is, by the bind shape and the
//! node. Of the transforms a skew is not read: programs differ on its axes. Polygons with holes are
//! not read, either. Units and the axis that is up are not converted. Without a scene, all
//! geometries are placed as they are.

use std::collections::HashMap;
use std::collections::hash_map::Entry;

use roxmltree::Node;

use super::error::Flaw;
use super::faces::FileMesh;
use super::scene::{Affine, Assembly, DEEPEST, NOT_AFFINE, too_deep};
use super::xml::{self, attribute, child, children, descendants, flaw, needed};
use crate::defect::FileForm;

/// Reads a COLLADA file whose placed geometries take at most `room` bytes.
pub(super) fn read(bytes: &[u8], room: u64) -> Result<FileMesh, Flaw> {
    let text = xml::text(bytes);
    let document = xml::parse(&text)?;
    let root = document.root_element();
    if root.tag_name().name() != "COLLADA" {
        return Err(flaw(root, "a COLLADA file has the element COLLADA here"));
    }
    let mut by_id = HashMap::new();
    for node in root.descendants().filter(Node::is_element) {
        if let Some(id) = node.attribute("id") {
            by_id.entry(id).or_insert(node);
        }
    }
    let mut reader = ColladaFile {
        by_id,
        pieces: HashMap::new(),
        scene: Assembly::new(room),
    };
    let shown = child(root, "scene").and_then(|scene| child(scene, "instance_visual_scene"));
    let scene = match shown {
        Some(instance) => Some(reader.target(instance, "url")?),
        None => descendants(root, "visual_scene").next(),
    };
    if let Some(scene) = scene {
        reader.place(scene)?;
    } else {
        let all = children(root, "library_geometries");
        for geometry in all.flat_map(|library| children(library, "geometry")) {
            reader.geometry(geometry, &Affine::IDENTITY)?;
        }
    }
    reader.scene.into_mesh()
}

struct ColladaFile<'a, 'd> {
    by_id: HashMap<&'a str, Node<'a, 'd>>,
    /// The geometries that have been placed, by the place of their element.
    pieces: HashMap<usize, FileMesh>,
    scene: Assembly,
}

impl<'a, 'd> ColladaFile<'a, 'd> {
    /// The element that an attribute refers to.
    fn target(&self, node: Node<'a, 'd>, name: &str) -> Result<Node<'a, 'd>, Flaw> {
        let reference = node.attribute(name).unwrap_or_default();
        let target = reference
            .strip_prefix('#')
            .and_then(|id| self.by_id.get(id))
            .copied();
        target.ok_or_else(|| {
            flaw(
                node,
                format!("{name}={reference:?} names no element of the file"),
            )
        })
    }

    /// Places the geometries of a visual scene.
    fn place(&mut self, scene: Node<'a, 'd>) -> Result<(), Flaw> {
        // Beside the transform of each node, a step of it that is not read.
        let mut open = vec![(scene, Affine::IDENTITY, None, 0)];
        while let Some((node, outer, unread, depth)) = open.pop() {
            if depth > DEEPEST {
                return Err(too_deep("a node"));
            }
            self.scene.visit()?;
            let (mut transform, mut unread): (_, Option<Node<'_, '_>>) = (outer, unread);
            let first = open.len();
            // Transforms come before what they apply to.
            for element in node.children().filter(Node::is_element) {
                if let Some(step) = step(element)? {
                    transform = transform.after(&step);
                    continue;
                }
                let name = element.tag_name().name();
                if let ("instance_geometry" | "instance_controller", Some(step)) = (name, unread) {
                    let problem = "what it transforms is not read; write it as a matrix";
                    return Err(flaw(step, problem));
                }
                match name {
                    "skew" => unread = unread.or(Some(element)),
                    "instance_geometry" => {
                        self.geometry(self.target(element, "url")?, &transform)?;
                    }
                    "instance_controller" => {
                        let controller = self.target(element, "url")?;
                        self.scene.note_unposed();
                        self.controller(controller, &transform)?;
                    }
                    "instance_node" => {
                        open.push((self.target(element, "url")?, transform, unread, depth + 1));
                    }
                    "node" => open.push((element, transform, unread, depth + 1)),
                    _ => {}
                }
            }
            open[first..].reverse();
        }
        Ok(())
    }

    /// Places the geometry of a skin or morph, which may be that of another controller.
    fn controller(&mut self, start: Node<'a, 'd>, transform: &Affine) -> Result<(), Flaw> {
        let (mut node, mut transform) = (start, *transform);
        for _ in 0..DEEPEST {
            self.scene.visit()?;
            if node.tag_name().name() == "geometry" {
                return self.geometry(node, &transform);
            }
            if let Some(skin) = child(node, "skin") {
                if let Some(shape) = child(skin, "bind_shape_matrix") {
                    transform = transform.after(&matrix(shape)?);
                }
                node = self.target(skin, "source")?;
            } else if let Some(morph) = child(node, "morph") {
                node = self.target(morph, "source")?;
            } else {
                return Err(flaw(node, "has neither a skin nor a morph"));
            }
        }
        Err(too_deep("a controller"))
    }

    /// Places a geometry.
    fn geometry(&mut self, node: Node<'a, 'd>, transform: &Affine) -> Result<(), Flaw> {
        let key = node.range().start;
        if !self.pieces.contains_key(&key) {
            let piece = match child(node, "mesh").or_else(|| child(node, "convex_mesh")) {
                Some(mesh) => self.mesh(mesh)?,
                // A spline.
                None => FileMesh::default(),
            };
            self.pieces.insert(key, piece);
        }
        let name = node.attribute("id").unwrap_or("a geometry");
        self.scene.place(&self.pieces[&key], transform, name)
    }

    /// The faces of a mesh, with the positions of all their sources.
    fn mesh(&mut self, mesh: Node<'a, 'd>) -> Result<FileMesh, Flaw> {
        let mut piece = FileMesh::default();
        // The number of the first vertex of each source of positions.
        let mut firsts: HashMap<usize, (u32, u32)> = HashMap::new();
        for list in mesh.children().filter(Node::is_element) {
            let kind = list.tag_name().name();
            let kinds = ["triangles", "polylist", "polygons", "tristrips", "trifans"];
            if !kinds.contains(&kind) {
                continue;
            }
            let mut stride = 1;
            let mut vertex = None;
            for input in children(list, "input") {
                let offset: usize = needed(input, "offset")?;
                stride = stride.max(offset.saturating_add(1));
                if input.attribute("semantic") == Some("VERTEX") {
                    vertex = Some((input, offset));
                }
            }
            let Some((input, offset)) = vertex else {
                if child(list, "p").is_some() {
                    return Err(flaw(
                        list,
                        "has no input VERTEX, so that its corners are unknown",
                    ));
                }
                continue;
            };
            if let Some(hole) = children(list, "ph").find_map(|ph| child(ph, "h")) {
                let problem = "a polygon with a hole is not read; save it cut into triangles";
                return Err(flaw(hole, problem));
            }
            let source = self.positions_of(self.target(input, "source")?)?;
            if let Entry::Vacant(place) = firsts.entry(source.range().start) {
                let positions = self.positions(source)?;
                place.insert((piece.positions.len() as u32, positions.len() as u32));
                piece.positions.extend(positions);
            }
            let (first, count) = firsts[&source.range().start];
            let lengths: Vec<usize> = match child(list, "vcount") {
                Some(counts) if kind == "polylist" => xml::numbers(counts)?,
                _ => Vec::new(),
            };
            let before = piece.faces.len();
            let holes = children(list, "ph").filter_map(|ph| child(ph, "p"));
            let lists: Vec<Node<'_, '_>> = children(list, "p").chain(holes).collect();
            for &indices in &lists {
                let numbers: Vec<u32> = xml::numbers(indices)?;
                if !numbers.len().is_multiple_of(stride) {
                    let problem =
                        format!("has {} numbers, not in groups of {stride}", numbers.len());
                    return Err(flaw(indices, problem));
                }
                let corners = numbers.iter().skip(offset).step_by(stride).map(|&corner| {
                    let moved = first.checked_add(corner).filter(|_| corner < count);
                    moved.ok_or_else(|| {
                        flaw(
                            indices,
                            format!("names vertex {corner} of {count}, counted from 0"),
                        )
                    })
                });
                let corners = corners.collect::<Result<Vec<u32>, Flaw>>()?;
                match kind {
                    "triangles" => {
                        let (triangles, rest) = corners.as_chunks::<3>();
                        if !rest.is_empty() {
                            return Err(flaw(indices, "ends within a triangle"));
                        }
                        for corners in triangles {
                            piece.faces.push(corners);
                        }
                    }
                    "polylist" => {
                        let mut rest = &corners[..];
                        for &length in &lengths {
                            let (face, after) = rest
                                .split_at_checked(length)
                                .ok_or_else(|| flaw(indices, "ends within a polygon"))?;
                            piece.faces.push(face);
                            rest = after;
                        }
                        if !rest.is_empty() {
                            return Err(flaw(indices, "has more corners than vcount counts"));
                        }
                    }
                    "polygons" => piece.faces.push(&corners),
                    "tristrips" => piece.faces.push_strip(&corners),
                    _ => {
                        for pair in corners.get(1..).unwrap_or_default().windows(2) {
                            piece.faces.push(&[corners[0], pair[0], pair[1]]);
                        }
                    }
                }
            }
            // Strips and fans are counted, not their triangles.
            let there = match kind {
                "triangles" | "polylist" => piece.faces.len() - before,
                _ => lists.len(),
            };
            self.compare_count(list, there);
        }
        Ok(piece)
    }

    /// Notes a count that is not that of the elements `there`. Most programs ignore it.
    fn compare_count(&mut self, node: Node<'a, 'd>, there: usize) {
        let count = node
            .attribute("count")
            .map(|text| text.trim().parse::<usize>());
        if count.is_some_and(|count| count != Ok(there)) {
            let line = || u64::from(node.document().text_pos_at(node.range().start).row);
            self.scene.note_form(FileForm::OtherCount, line);
        }
    }

    /// The source of positions of `vertices`, an element that names it.
    fn positions_of(&self, vertices: Node<'a, 'd>) -> Result<Node<'a, 'd>, Flaw> {
        let mut inputs = children(vertices, "input");
        let input = inputs.find(|input| input.attribute("semantic") == Some("POSITION"));
        let input = input.ok_or_else(|| flaw(vertices, "has no input POSITION"))?;
        self.target(input, "source")
    }

    /// The positions of a source.
    fn positions(&mut self, source: Node<'a, 'd>) -> Result<Vec<[f64; 3]>, Flaw> {
        let accessor = child(source, "technique_common").and_then(|node| child(node, "accessor"));
        let accessor = accessor.ok_or_else(|| flaw(source, "has no accessor"))?;
        let array = self.target(accessor, "source")?;
        let numbers: Vec<f64> = xml::numbers(array)?;
        self.compare_count(array, numbers.len());
        // Any number of geometries may name the same array.
        self.scene.pay(8 * numbers.len() as u64)?;
        let stride = attribute(accessor, "stride")?.unwrap_or(1);
        let start: usize = attribute(accessor, "offset")?.unwrap_or(0);
        let count: usize = needed(accessor, "count")?;
        // Parameters without a name are skipped.
        let named = children(accessor, "param").enumerate();
        let mut axes = [None; 3];
        for (place, param) in named {
            match param.attribute("name") {
                Some("X") => axes[0] = Some(place),
                Some("Y") => axes[1] = Some(place),
                Some("Z") => axes[2] = Some(place),
                _ => {}
            }
        }
        let axes = match axes {
            [Some(x), Some(y), Some(z)] => [x, y, z],
            _ if stride >= 3 => [0, 1, 2],
            _ => return Err(flaw(accessor, "a position needs the parameters X, Y and Z")),
        };
        let last = axes.into_iter().max().unwrap_or(2);
        let end = count.checked_sub(1).map(|rows| {
            let end = rows
                .checked_mul(stride)?
                .checked_add(start)?
                .checked_add(last)?;
            (end < numbers.len()).then_some(())
        });
        if end == Some(None) {
            let there = numbers.len();
            return Err(flaw(
                accessor,
                format!("wants more than the {there} numbers of its array"),
            ));
        }
        let row = |row: usize| axes.map(|axis| numbers[start + row * stride + axis]);
        Ok((0..count).map(row).collect())
    }
}

/// The transform of an element, if it is one.
fn step(element: Node<'_, '_>) -> Result<Option<Affine>, Flaw> {
    Ok(Some(match element.tag_name().name() {
        "matrix" => matrix(element)?,
        "translate" => Affine::shift(fixed(element)?),
        "scale" => Affine::scale(fixed(element)?),
        "rotate" => {
            let [x, y, z, degrees] = fixed(element)?;
            Affine::turn([x, y, z], degrees)
        }
        "lookat" => {
            let [a, b, c, d, e, f, g, h, i] = fixed(element)?;
            Affine::look_at([a, b, c], [d, e, f], [g, h, i])
        }
        _ => return Ok(None),
    }))
}

/// The transform of the matrix in an element.
fn matrix(element: Node<'_, '_>) -> Result<Affine, Flaw> {
    Affine::from_rows(&fixed(element)?).ok_or_else(|| flaw(element, NOT_AFFINE))
}

/// The N numbers of an element.
fn fixed<const N: usize>(node: Node<'_, '_>) -> Result<[f64; N], Flaw> {
    let numbers: Vec<f64> = xml::numbers(node)?;
    let count = numbers.len();
    numbers
        .try_into()
        .map_err(|_| flaw(node, format!("has {count} numbers, not {N}")))
}
