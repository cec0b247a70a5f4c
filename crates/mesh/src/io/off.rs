//! OFF, the text format of Geomview.
//!
//! The keyword may have the prefixes `ST`, `C` and `N`: then texture coordinates, colours and
//! normals follow the position of a vertex. They are ignored, as are colours after the corners of a
//! face. The counts may be on the keyword's line. Each vertex and each face has a line.

use super::error::Flaw;
use super::faces::FaceList;
use super::text::{Lines, coordinates, index, integer, shown, without_comment, words};
use crate::soup::TriangleSoup;

/// Reads an OFF file.
pub(super) fn read(bytes: &[u8]) -> Result<TriangleSoup, Flaw> {
    let mut lines = Content(Lines::new(bytes));
    let (vertex_count, face_count) = header(&mut lines)?;

    // A header cannot reserve more memory than the shortest lines, "0 0 0" and "3 0 1 2", allow.
    let most = |line_length| bytes.len() / line_length + 1;
    let mut positions = Vec::with_capacity(most(6).min(vertex_count as usize));
    for read in 0..vertex_count {
        let (line, content) = lines.expect("vertices", read, vertex_count)?;
        positions.push(coordinates(line, &mut words(content))?);
    }
    let mut faces = FaceList::with_capacity(most(8).min(face_count as usize));
    let mut corners = Vec::new();
    for read in 0..face_count {
        let (line, content) = lines.expect("faces", read, face_count)?;
        face(line, content, &mut corners)?;
        faces.push(&corners);
    }
    if let Some((line, content)) = lines.next() {
        return Err(Flaw::line(
            line,
            format!(
                "{} comes after the {face_count} faces that the header declares; correct the counts",
                shown(content)
            ),
        ));
    }
    faces.into_soup(positions)
}

/// The number of vertices and of faces.
fn header(lines: &mut Content<'_>) -> Result<(u64, u64), Flaw> {
    let (mut line, mut content) = lines
        .next()
        .ok_or_else(|| Flaw::file("there are only blank lines and comments in it"))?;
    let mut first = words(content).next().unwrap_or_default();
    // Many files of ModelNet have no blank between keyword and counts: `OFF490 518 0`.
    if let [b'O' | b'o', b'F' | b'f', b'F' | b'f', b'0'..=b'9', ..] = first {
        first = &first[..3];
    }
    // A file without a keyword may start with its counts.
    if integer(first).is_none() {
        check_keyword(line, first)?;
        let rest = content.iter().skip_while(|b| b.is_ascii_whitespace());
        content = &content[content.len() - rest.count() + first.len()..];
        if words(content).next() == Some(b"BINARY") {
            return Err(Flaw::line(
                line,
                "binary OFF is not read; convert the file to text OFF or binary PLY",
            ));
        }
        if words(content).next().is_none() {
            (line, content) = lines
                .next()
                .ok_or_else(|| Flaw::line(line, "the file ends before its counts"))?;
        }
    }
    let counts: Vec<Option<u64>> = words(content)
        .map(|word| integer(word).and_then(|count| count.try_into().ok()))
        .collect();
    match counts[..] {
        [Some(vertices), Some(faces)] | [Some(vertices), Some(faces), Some(_)] => {
            Ok((vertices, faces))
        }
        _ => Err(Flaw::line(
            line,
            format!(
                "{} does not say how many vertices, faces and edges there are",
                shown(content)
            ),
        )),
    }
}

/// Checks that the first word is a keyword for three-dimensional points.
fn check_keyword(line: u64, word: &[u8]) -> Result<(), Flaw> {
    let prefixes = word
        .strip_suffix(b"OFF")
        .or_else(|| word.strip_suffix(b"off"));
    match prefixes {
        Some(b"" | b"ST" | b"C" | b"N" | b"CN" | b"NC" | b"STC" | b"STN" | b"STCN" | b"STNC") => {
            Ok(())
        }
        Some([.., b'4' | b'n']) => Err(Flaw::line(
            line,
            format!(
                "{} has points in other than three dimensions, which are not read",
                shown(word)
            ),
        )),
        _ => Err(Flaw::line(
            line,
            format!(
                "{} is not how an OFF file starts; expected OFF",
                shown(word)
            ),
        )),
    }
}

/// Reads the corners of the face in `content`. Colours may follow.
fn face(line: u64, content: &[u8], corners: &mut Vec<u32>) -> Result<(), Flaw> {
    let mut words = words(content);
    let first = words.next().unwrap_or_default();
    let count = integer(first)
        .filter(|&count| count >= 0)
        .ok_or_else(|| Flaw::line(line, format!("{} is no number of corners", shown(first))))?;
    corners.clear();
    for word in words {
        if corners.len() as i128 == count {
            break;
        }
        corners.push(index(line, word)?);
    }
    if (corners.len() as i128) < count {
        return Err(Flaw::line(
            line,
            format!(
                "the face is to have {count} corners, but only {} are there",
                corners.len()
            ),
        ));
    }
    Ok(())
}

/// The lines that are not blank and not comments.
struct Content<'a>(Lines<'a>);

impl<'a> Iterator for Content<'a> {
    type Item = (u64, &'a [u8]);

    fn next(&mut self) -> Option<Self::Item> {
        self.0
            .by_ref()
            .map(|(number, line)| (number, without_comment(line).trim_ascii()))
            .find(|(_, line)| !line.is_empty())
    }
}

impl<'a> Content<'a> {
    /// The next line, which must exist. `read` of `count` things have been read.
    fn expect(&mut self, things: &str, read: u64, count: u64) -> Result<(u64, &'a [u8]), Flaw> {
        self.next().ok_or_else(|| {
            Flaw::line(
                self.0.number(),
                format!("the file ends after {read} of the {count} {things} it declares"),
            )
        })
    }
}
