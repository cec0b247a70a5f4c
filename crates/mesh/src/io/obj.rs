//! Wavefront OBJ, read through `tobj`.
//!
//! `tobj` is made for rendering: it numbers vertices in the order of their first use, drops the
//! unused ones, starts a new model at every group, object and material, asks for material files,
//! and does not say in which line an error is. Here the file's own numbers, all vertices at full
//! `f64` precision, and the line are wanted. So `tobj` does not get the file itself but a
//! rewritten one, line by line, from a `BufRead` adapter ([`Rewriter`]):
//!
//! * `v x y z ...` becomes `v NUMBER 0 0`, where NUMBER is the vertex's place in the file. The
//!   positions `tobj` returns are then the file's numbers (exact in an `f64`), whatever it did to
//!   the order. The coordinates are parsed here, by the standard library.
//! * `f a/ta/na b/tb/nb ...` becomes `f a b ...`: texture coordinates and normals cannot split
//!   vertices at seams, nor be missing.
//! * Everything else is left out, so that nothing splits the model and no other file is opened:
//!   groups, objects, materials, points, lines, curves, comments.
//!
//! Because `tobj` asks for one line at a time, the line an error belongs to is the current one.
//!
//! Faces that name a vertex beyond the last are for validation to list, all at once; `tobj` would
//! stop at the first without naming it. Such a corner is pointed at an extra vertex behind all
//! the others, whose NUMBER is the one the face asked for.

use std::borrow::Cow;
use std::io::{self, BufRead, Read};

use tobj::LoadOptions;

use super::error::Flaw;
use super::faces::FaceList;
use super::text::{Lines, coordinates, integer, number, shown, without_comment, words};
use crate::soup::TriangleSoup;

/// Reads a whole OBJ file.
pub(super) fn read(bytes: &[u8]) -> Result<TriangleSoup, Flaw> {
    let positions = vertices(bytes)?;
    let mut rewriter = Rewriter {
        statements: Statements(Lines::new(bytes)),
        line: 0,
        vertex_count: positions.len(),
        vertices_passed: 0,
        missing: Vec::new(),
        missing_passed: 0,
        out: Vec::new(),
        out_read: 0,
        flaw: None,
    };
    // Polygons are cut by our own rule, and faces with one or two corners keep their numbers.
    let options = LoadOptions {
        single_index: false,
        triangulate: false,
        ignore_points: false,
        ignore_lines: false,
    };
    let no_materials = |_: &std::path::Path| Err(tobj::LoadError::OpenFileFailed);
    let (models, _) =
        tobj::load_obj_buf(&mut rewriter, &options, no_materials).map_err(|error| {
            let line = rewriter.line;
            rewriter
                .flaw
                .take()
                .unwrap_or_else(|| Flaw::line(line, format!("{error}; correct the line")))
        })?;

    let mut faces = FaceList::default();
    for model in models {
        let mesh = model.mesh;
        let numbers = mesh.positions.as_chunks::<3>().0;
        #[allow(clippy::cast_sign_loss)] // They were written from unsigned numbers.
        let corners: Vec<u32> = mesh
            .indices
            .iter()
            .map(|&i| numbers[i as usize][0] as u32)
            .collect();
        if mesh.face_arities.is_empty() {
            faces.push_triangles(corners);
        } else {
            let mut rest = &corners[..];
            for &arity in &mesh.face_arities {
                let (face, next) = rest.split_at(arity as usize);
                faces.push(face);
                rest = next;
            }
        }
    }
    faces.into_soup(positions)
}

/// The coordinates of every `v` statement.
///
/// What may follow them is a weight, by which they are divided as `tobj` does, or a colour (two
/// or more further numbers), which is ignored.
fn vertices(bytes: &[u8]) -> Result<Vec<[f64; 3]>, Flaw> {
    let mut positions = Vec::new();
    for (line, statement) in Statements(Lines::new(bytes)) {
        let mut words = words(&statement);
        if words.next() != Some(b"v") {
            continue;
        }
        let mut position = coordinates(line, &mut words)?;
        if let (Some(weight), None) = (words.next(), words.next()) {
            let weight = number(line, weight)?;
            if weight == 0.0 {
                return Err(Flaw::line(
                    line,
                    "the vertex has weight 0 and lies at infinity; remove the fourth number",
                ));
            }
            position = position.map(|x| x / weight);
        }
        positions.push(position);
    }
    Ok(positions)
}

/// The statements of a file without comments, each with the number of its first line. A backslash
/// at the end of a line continues the statement on the next one.
struct Statements<'a>(Lines<'a>);

impl<'a> Iterator for Statements<'a> {
    type Item = (u64, Cow<'a, [u8]>);

    fn next(&mut self) -> Option<Self::Item> {
        let code = |line| without_comment(line).trim_ascii_end();
        let (number, line) = self.0.next()?;
        let mut statement = Cow::Borrowed(code(line));
        while statement.ends_with(b"\\") {
            let joined = statement.to_mut();
            joined.pop();
            joined.push(b' ');
            if let Some((_, line)) = self.0.next() {
                joined.extend_from_slice(code(line));
            }
        }
        Some((number, statement))
    }
}

/// Feeds `tobj` the rewritten file; see the module's documentation.
struct Rewriter<'a> {
    statements: Statements<'a>,
    /// First line of the current statement.
    line: u64,
    /// Number of vertices in the file.
    vertex_count: usize,
    /// Number of `v` statements already passed on, to which negative numbers are relative.
    vertices_passed: usize,
    /// Vertices that faces named but the file lacks.
    missing: Vec<u32>,
    /// How many of `missing` have been passed on, after the end of the file.
    missing_passed: usize,
    /// The current rewritten line.
    out: Vec<u8>,
    /// How much of `out` has been read.
    out_read: usize,
    /// Why the rewriter stopped.
    flaw: Option<Flaw>,
}

impl Rewriter<'_> {
    /// Puts the next line into `out`; leaves it empty at the end.
    fn rewrite_next(&mut self) -> Result<(), Flaw> {
        self.out.clear();
        self.out_read = 0;
        for (line, statement) in self.statements.by_ref() {
            self.line = line;
            let mut words = words(&statement);
            match words.next() {
                Some(b"v") => {
                    vertex_line(&mut self.out, self.vertices_passed);
                    self.vertices_passed += 1;
                    return Ok(());
                }
                Some(b"f") => {
                    self.out.push(b'f');
                    for word in words {
                        let corner = self.corner(word)?;
                        self.out.extend_from_slice(format!(" {corner}").as_bytes());
                    }
                    self.out.push(b'\n');
                    return Ok(());
                }
                _ => {}
            }
        }
        if let Some(&vertex) = self.missing.get(self.missing_passed) {
            self.missing_passed += 1;
            vertex_line(&mut self.out, vertex as usize);
        }
        Ok(())
    }

    /// The vertex that a corner `v`, `v/vt`, `v//vn` or `v/vt/vn` shall name for `tobj`.
    fn corner(&mut self, word: &[u8]) -> Result<i128, Flaw> {
        let problem = |what: &str| Flaw::line(self.line, format!("{} {what}", shown(word)));
        let mut numbers = word.split(|&b| b == b'/');
        let vertex = numbers
            .next()
            .and_then(integer)
            .filter(|_| {
                word.iter()
                    .all(|b| b.is_ascii_digit() || b"+-/".contains(b))
            })
            .ok_or_else(|| {
                problem("is no corner of a face; corners look like 3, 3/1, 3//2 or 3/1/2")
            })?;
        match vertex {
            0 => Err(problem(
                "names vertex 0, but the vertices of an OBJ file count from 1",
            )),
            ..0 if -vertex > self.vertices_passed as i128 => Err(problem(&format!(
                "reaches back before the first vertex; there are {} up to here",
                self.vertices_passed
            ))),
            _ if vertex <= self.vertex_count as i128 => Ok(vertex),
            _ => {
                let missing = u32::try_from(vertex - 1)
                    .map_err(|_| problem("is beyond the 4294967296 vertices a mesh can have"))?;
                self.missing.push(missing);
                Ok((self.vertex_count + self.missing.len()) as i128)
            }
        }
    }
}

/// Appends the `v` line of the vertex with this number.
fn vertex_line(out: &mut Vec<u8>, number: usize) {
    out.extend_from_slice(format!("v {number} 0 0\n").as_bytes());
}

impl BufRead for Rewriter<'_> {
    fn fill_buf(&mut self) -> io::Result<&[u8]> {
        if self.out_read == self.out.len() {
            self.rewrite_next().map_err(|flaw| {
                self.flaw = Some(flaw);
                io::Error::from(io::ErrorKind::InvalidData)
            })?;
        }
        Ok(&self.out[self.out_read..])
    }

    fn consume(&mut self, amount: usize) {
        self.out_read += amount;
    }
}

impl Read for Rewriter<'_> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let count = self.fill_buf()?.read(buffer)?;
        self.consume(count);
        Ok(count)
    }
}
