//! Wavefront OBJ.
//!
//! Only `v` and `f` statements are read, and `fo`, the former name of `f`. Everything else is
//! skipped: groups, objects, materials, texture coordinates, normals, points, lines, curves. No
//! other file is opened; a `call` of one, whose vertices would be missing, is an error.

use std::borrow::Cow;

use super::error::Flaw;
use super::faces::{FaceList, FileMesh};
use super::quick_obj;
use super::text::{
    NumberedLines, Words, coordinates, integer, number, shown, without_comment, words,
};
use crate::defect::FileForm;

/// Reads an OBJ file.
pub(super) fn read(bytes: &[u8]) -> Result<FileMesh, Flaw> {
    if let Some((positions, triangles)) = quick_obj::read(bytes) {
        let faces = FaceList::of(triangles);
        return Ok(FileMesh { positions, faces });
    }
    read_statements(bytes)
}

/// Reads every statement, without the fast path.
fn read_statements(bytes: &[u8]) -> Result<FileMesh, Flaw> {
    let (mut positions, mut faces) = (Vec::new(), FaceList::default());
    let mut corners = Vec::new();
    let mut statements = Statements::new(bytes);
    while let Some((line, statement)) = statements.next() {
        let mut words = words(&statement);
        match words.next() {
            Some(b"v") => positions.push(position(line, words, &mut faces)?),
            Some(b"f" | b"fo") => {
                corners.clear();
                for word in words {
                    let corner = corner(word, positions.len());
                    corners.push(corner.map_err(|problem| {
                        Flaw::line(line, format!("{} {problem}", shown(word)))
                    })?);
                }
                faces.push(&corners);
            }
            // Skipped as an unknown statement, a vertex would shift the numbers of all later ones.
            Some(word) if is_misspelt(word) => {
                return Err(Flaw::line(
                    line,
                    format!(
                        "{} is no statement of OBJ; a vertex begins with v and a blank, a face with \
                         f and a blank",
                        shown(&statement)
                    ),
                ));
            }
            Some(word) => statements.check_skipped(line, word)?,
            None => {}
        }
    }
    Ok(FileMesh { positions, faces })
}

/// The coordinates of a vertex.
///
/// One further number must be 1: a weight, by which some programs divide (Assimp, tobj) and which
/// others ignore (`MeshLab`, tinyobjloader), so that any other one has two meanings. Two or more
/// further numbers are a colour, which is ignored; other words may be a vertex that would be lost.
/// If there are two numbers only, the third is 0.
fn position(line: u64, mut words: Words<'_>, faces: &mut FaceList) -> Result<[f64; 3], Flaw> {
    if words.clone().count() == 2 {
        let mut numbers = words.by_ref().map(|word| number(line, word));
        if let (Some(x), Some(y)) = (numbers.next(), numbers.next()) {
            faces.note_form(line, FileForm::TwoCoordinates);
            return Ok([x?, y?, 0.0]);
        }
    }
    let position = coordinates(line, &mut words)?;
    let mut only = None;
    for (place, word) in words.enumerate() {
        let number = number(line, word)?;
        only = (place == 0).then_some((word, number));
    }
    let Some((weight, _)) = only.filter(|&(_, number)| number != 1.0) else {
        return Ok(position);
    };
    Err(Flaw::line(
        line,
        format!(
            "the fourth number of the vertex, {}, is a weight to some programs, which divide by it, \
             and nothing to others; remove it, or divide by it",
            shown(weight)
        ),
    ))
}

/// Whether a keyword is `v` or `f` without a blank behind it, as a capital letter, or beside
/// characters that are not seen.
fn is_misspelt(word: &[u8]) -> bool {
    let is_glued = matches!(word, [b'v' | b'f', second, ..] if !second.is_ascii_alphabetic());
    let mut seen = word.iter().filter(|byte| byte.is_ascii_graphic());
    let is_letter = matches!(seen.next(), Some(b'v' | b'V' | b'f' | b'F'));
    is_glued || is_letter && seen.next().is_none()
}

/// The vertex of a corner `v`, `v/vt`, `v//vn` or `v/vt/vn`, or what is wrong with it. Negative
/// numbers count back from the last of the `so_far` vertices read. Numbers beyond the last vertex
/// are left for validation to report.
fn corner(word: &[u8], so_far: usize) -> Result<u32, String> {
    let vertex = word.split(|&b| b == b'/').next().and_then(integer);
    let is_corner = |word: &[u8]| {
        let is_part = |b: &u8| b.is_ascii_digit() || b"+-/".contains(b);
        word.iter().all(is_part)
    };
    match vertex.filter(|_| is_corner(word)) {
        None => Err("is no corner of a face; corners look like 3, 3/1, 3//2 or 3/1/2".to_owned()),
        Some(0) => Err("names vertex 0, but the vertices of an OBJ file count from 1".to_owned()),
        Some(back @ ..0) => u32::try_from(so_far as i128 + back).map_err(|_| {
            format!("reaches back before the first vertex; there are {so_far} up to here")
        }),
        Some(number) => u32::try_from(number - 1)
            .map_err(|_| "is beyond the 4294967296 vertices a mesh can have".to_owned()),
    }
}

/// The statements of a file without comments, each with the number of its first line. A backslash
/// at the end of a line continues the statement on the next line. A carriage return alone ends a
/// statement, too, as in files that were joined from others.
pub(super) struct Statements<'a> {
    lines: NumberedLines<'a>,
    /// Number of the current line.
    number: u64,
    /// What is left of it.
    rest: &'a [u8],
    /// The first line that continues the last statement and looks like a vertex or a face.
    hidden: Option<u64>,
}

impl<'a> Statements<'a> {
    pub(super) fn new(bytes: &'a [u8]) -> Self {
        Self {
            lines: NumberedLines::new(bytes),
            number: 0,
            rest: &[],
            hidden: None,
        }
    }

    /// Checks that no vertex and no face is lost with the last statement, which is at `line`,
    /// starts with `keyword` and is skipped. A backslash at the end of a name, as in `usemtl
    /// C:\maps\`, is not meant to continue it.
    pub(super) fn check_skipped(&self, line: u64, keyword: &[u8]) -> Result<(), Flaw> {
        if keyword == b"call" {
            let problem = "call reads another file, which is not read; put its statements here";
            return Err(Flaw::line(line, problem));
        }
        let Some(hidden) = self.hidden else {
            return Ok(());
        };
        Err(Flaw::line(
            hidden,
            format!(
                "the backslash at the end of the line before makes this line a part of the statement \
                 {}, which is skipped; remove the backslash or this line",
                shown(keyword)
            ),
        ))
    }

    /// The next line without comments.
    fn code(&mut self) -> Option<&'a [u8]> {
        if self.rest.is_empty() {
            (self.number, self.rest) = self.lines.next()?;
        }
        let rest = self.rest;
        let end = rest.iter().position(|&b| b == b'\r');
        let end = end.unwrap_or(rest.len());
        self.rest = rest.get(end + 1..).unwrap_or_default();
        Some(without_comment(&rest[..end]).trim_ascii_end())
    }
}

impl<'a> Iterator for Statements<'a> {
    type Item = (u64, Cow<'a, [u8]>);

    fn next(&mut self) -> Option<Self::Item> {
        let mut statement = Cow::Borrowed(self.code()?);
        let number = self.number;
        self.hidden = None;
        while statement.ends_with(b"\\") {
            let joined = statement.to_mut();
            joined.pop();
            joined.push(b' ');
            if let Some(line) = self.code() {
                joined.extend_from_slice(line);
                if matches!(words(line).next(), Some(b"v" | b"f")) {
                    self.hidden = self.hidden.or(Some(self.number));
                }
            }
        }
        Some((number, statement))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::SplitMix64;

    #[test]
    fn the_quick_way_leads_where_the_statements_lead() {
        let start: &[u8] =
            b"# x\nv 0 0.5 -1\nv 1e3 2 3 \r\nvn 0 0 1\nv 4 5 6\nf 1 2 3\nf 3/1/1 2//2 1/3\n";
        let bytes = b"v f0123456789.-+eE/\\#\n\r\t ";
        let mut random = SplitMix64::new(9);
        let (mut quick, mut tried) = (0, 0);
        while tried < 100_000 {
            tried += 1;
            let mut text = start.to_vec();
            for _ in 0..=random.below(3) {
                let (place, byte) = (random.below(text.len()), bytes[random.below(bytes.len())]);
                match random.below(3) {
                    0 => text[place] = byte,
                    1 => text.insert(place, byte),
                    _ => drop(text.remove(place)),
                }
            }
            if let Some((positions, triangles)) = quick_obj::read(&text) {
                let shown = String::from_utf8_lossy(&text);
                let faces = FaceList::of(triangles);
                let found = FileMesh { positions, faces }.into_soup(None);
                let statements = || read_statements(&text)?.into_soup(None);
                let (Ok(found), Ok(expected)) = (&found, &statements()) else {
                    let failed = [found, statements()].map(|soup| soup.is_err());
                    assert_eq!(failed, [true; 2], "{shown:?}");
                    continue;
                };
                assert_eq!(found, expected, "{shown:?}");
                quick += 1;
            }
        }
        assert!(quick > 20_000, "{quick}");
    }
}
