//! STL, text and binary. Corners are welded into vertices.
//!
//! STL has no vertex numbers: every triangle has its own coordinates. Corners with bitwise equal
//! coordinates become one vertex, where -0 equals 0. Vertices are numbered in the order of their
//! first appearance. No vertices are merged by distance.
//!
//! Text coordinates are read as `f64`. Normals and attributes are ignored.

use super::error::{FilePosition, Flaw};
use super::faces::{FaceList, FileMesh};
use super::text::{NumberedLines, Tokens, coordinates, number, shown, words};
use crate::defect::FileForm;
use crate::weld::PlaceTable;

/// Bytes before the first triangle of a binary file: 80 bytes of free text and the count.
const HEADER: usize = 84;
/// Bytes of a binary triangle.
const TRIANGLE: usize = 50;

/// Reads an STL file.
pub(super) fn read(bytes: &[u8]) -> Result<FileMesh, Flaw> {
    let mesh = if is_binary(bytes) {
        read_binary(bytes)?
    } else {
        read_text(bytes)?
    };
    if mesh.faces.is_empty() {
        return Err(Flaw::file("there is no triangle in it"));
    }
    Ok(mesh)
}

/// Whether the file is binary. Many binary files start with `solid`, so the size decides, and then
/// a byte that text does not contain.
fn is_binary(bytes: &[u8]) -> bool {
    if declared_count(bytes).is_some_and(|count| has_triangles(bytes, count)) {
        return true;
    }
    let lines = NumberedLines::new(bytes).map(|(_, line)| line.trim_ascii_start());
    let mut content = lines.filter(|line| !line.is_empty() && !line.starts_with(b"#"));
    let says_text = content.next().is_some_and(|line| {
        let first = words(line).next();
        starts(line, "solid") || first.is_some_and(|word| is(word, "facet"))
    });
    !says_text || text_of(bytes).iter().take(2 * HEADER).any(|&b| b == 0)
}

/// A text without what follows its end: zeros of a buffer, or the end mark of DOS.
fn text_of(mut bytes: &[u8]) -> &[u8] {
    while let [text @ .., 0 | 0x1a] = bytes {
        bytes = text;
    }
    bytes
}

/// Whether a binary file ends behind `count` triangles.
fn has_triangles(bytes: &[u8], count: u32) -> bool {
    HEADER as u64 + TRIANGLE as u64 * u64::from(count) == bytes.len() as u64
}

/// Whether a binary file ends behind `count` triangles, each with as many bytes of attributes as
/// its last two bytes say.
fn has_attributes(bytes: &[u8], count: u32) -> bool {
    let mut rest = &bytes[HEADER..];
    for _ in 0..count {
        let Some((triangle, after)) = rest.split_first_chunk::<TRIANGLE>() else {
            return false;
        };
        let length = u16::from_le_bytes([triangle[48], triangle[49]]);
        match after.get(usize::from(length)..) {
            Some(after) => rest = after,
            None => return false,
        }
    }
    rest.is_empty()
}

/// The number of triangles of a binary file.
fn declared_count(bytes: &[u8]) -> Option<u32> {
    let count = bytes.get(HEADER - 4..HEADER)?;
    Some(u32::from_le_bytes(count.try_into().ok()?))
}

fn read_binary(bytes: &[u8]) -> Result<FileMesh, Flaw> {
    let count = declared_count(bytes).ok_or_else(|| {
        Flaw::file("this is no STL: it neither starts with solid nor holds a binary header")
    })?;
    let there = (bytes.len() - HEADER) / TRIANGLE;
    if (there as u64) < u64::from(count) {
        // A count without a byte below that of a tab is one of 150 million triangles or more.
        if bytes.iter().take(HEADER).all(|&byte| byte >= b'\t') {
            let first = words(bytes).next().unwrap_or_default();
            return Err(Flaw::line(
                1,
                format!("expected solid, found {}", shown(first)),
            ));
        }
        if has_triangles(bytes, count.swap_bytes()) {
            return Err(Flaw::file(
                "its numbers have the high byte first, and those of STL the low byte; save it again",
            ));
        }
        let place = FilePosition::Element {
            kind: "triangle",
            number: there as u64,
            byte: (HEADER + there * TRIANGLE) as u64,
        };
        let problem = format!(
            "the file ends within it, though the header declares {count} triangles; fetch it again"
        );
        return Err(Flaw::at(place, problem));
    }
    if !has_triangles(bytes, count) && count > 0 && has_attributes(bytes, count) {
        return Err(Flaw::file(
            "attributes follow each of its triangles, which are not read; save it without",
        ));
    }
    // Padding may follow. Whole triangles would be lost silently.
    let more = there as u64 - u64::from(count);
    let padding = &bytes[HEADER + count as usize * TRIANGLE..];
    // A program that writes to a stream does not know the count when it writes the header.
    let is_stream = count == 0 && padding.len() == there * TRIANGLE;
    let is_padded = padding.iter().all(|&byte| byte == 0);
    if more > 0 && !is_stream && !is_padded {
        return Err(Flaw::file(format!(
            "the header declares {count} triangles, but the file has room for {more} more after \
             them; correct the count in bytes 80 to 83, or cut off what follows"
        )));
    }
    let count = if is_stream && !is_padded {
        there
    } else {
        count as usize
    };
    let mut weld = CornerWeld::with_capacity(count);
    if is_stream && !is_padded {
        weld.mesh.faces.note_form(0, FileForm::NoCount);
    }
    for triangle in bytes[HEADER..].as_chunks::<TRIANGLE>().0.iter().take(count) {
        // A normal of 12 bytes comes first. Two bytes of attributes come last.
        let (numbers, _) = triangle[12..48].as_chunks();
        let (corners, _) = numbers.as_chunks::<3>();
        let corner = |i: usize| corners[i].map(|bytes| f64::from(f32::from_le_bytes(bytes)));
        weld.push([0, 1, 2].map(corner));
    }
    Ok(weld.mesh)
}

/// Reads a text file, word by word: programs differ in their lines. The keywords `outer loop`,
/// `endloop` and `endfacet` may be one word or two, the name of a solid may follow `endsolid`
/// without a blank, and `endfacet` or all lines `solid` may be missing. Between facets and solids
/// there may be comments.
fn read_text(bytes: &[u8]) -> Result<FileMesh, Flaw> {
    let mut words = Tokens::new(NumberedLines::new(text_of(bytes)), false);
    // A triangle takes some 100 bytes of text.
    let mut weld = CornerWeld::with_capacity(bytes.len() / 100);
    let (mut open, mut has_solid) = (false, false);
    while let Some(word) = words.next() {
        if starts(word, "endsolid")
            || is(word, "end") && words.peek().is_some_and(|w| starts(w, "solid"))
        {
            words.skip_line();
            open = false;
        } else if is(word, "solid") {
            skip_name(&mut words);
            (open, has_solid) = (true, true);
        } else if open && is(word, "color") || word.starts_with(b"#") {
            words.skip_line();
        } else if is(word, "facet") && (open || !has_solid) {
            if !open {
                weld.mesh.faces.note_form(words.line(), FileForm::NoSolid);
                open = true;
            }
            weld.push(facet(&mut words)?);
        } else {
            let wanted = if open { "facet or endsolid" } else { "solid" };
            return Err(instead_of(&words, word, wanted));
        }
    }
    if open {
        weld.mesh.faces.note_form(words.line(), FileForm::NoEnd);
    }
    Ok(weld.mesh)
}

/// Reads past the name of a solid, which ends with the line, or where a facet begins.
fn skip_name(words: &mut Tokens<'_>) {
    let mut ahead = words.clone();
    while let Some(word) = ahead.next_in_line() {
        if is(word, "facet")
            && ahead
                .clone()
                .next_in_line()
                .is_some_and(|w| is(w, "normal"))
        {
            return;
        }
        *words = ahead.clone();
    }
    words.skip_line();
}

/// The corners of a facet, whose keyword has been read.
fn facet(words: &mut Tokens<'_>) -> Result<[[f64; 3]; 3], Flaw> {
    // A normal may come first.
    let is_normal = |word: &[u8]| is(word, "normal") || number(0, word).is_ok();
    while words.peek().is_some_and(is_normal) {
        words.next();
    }
    if !take(words, "outer", "loop") {
        expect(words, "outer loop")?;
    }
    let mut corners = [[0.0; 3]; 3];
    for corner in &mut corners {
        expect(words, "vertex")?;
        *corner = coordinates(words.line(), words)?;
    }
    if !take(words, "end", "loop") {
        expect(words, "endloop")?;
    }
    take(words, "end", "facet");
    Ok(corners)
}

fn is(word: &[u8], keyword: &str) -> bool {
    word.eq_ignore_ascii_case(keyword.as_bytes())
}

fn starts(word: &[u8], keyword: &str) -> bool {
    word.get(..keyword.len())
        .is_some_and(|start| is(start, keyword))
}

/// Takes the keyword that consists of these parts, in one word or two. Returns whether it is there.
fn take(words: &mut Tokens<'_>, first: &str, second: &str) -> bool {
    let mut ahead = words.clone();
    let is_there = ahead.next().is_some_and(|word| {
        starts(word, first)
            && match &word[first.len()..] {
                b"" => ahead.next().is_some_and(|word| is(word, second)),
                rest => is(rest, second),
            }
    });
    if is_there {
        *words = ahead;
    }
    is_there
}

/// Takes the next word, which must be `keyword`.
fn expect(words: &mut Tokens<'_>, keyword: &str) -> Result<(), Flaw> {
    match words.next() {
        Some(word) if is(word, keyword) => Ok(()),
        Some(word) => Err(instead_of(words, word, keyword)),
        None => {
            let problem = format!("the file ends where {keyword} should follow; fetch it again");
            Err(Flaw::line(words.line(), problem))
        }
    }
}

/// The error that `word`, the last one of `words`, is here instead of `wanted`.
fn instead_of(words: &Tokens<'_>, word: &[u8], wanted: &str) -> Flaw {
    Flaw::line(
        words.line(),
        format!("expected {wanted}, found {}", shown(word)),
    )
}

/// Gives corners with equal coordinates the same vertex.
struct CornerWeld {
    mesh: FileMesh,
    vertices: PlaceTable,
}

impl CornerWeld {
    fn with_capacity(triangles: usize) -> Self {
        let vertices = triangles / 2;
        Self {
            mesh: FileMesh {
                positions: Vec::with_capacity(vertices),
                faces: FaceList::with_capacity(triangles),
            },
            vertices: PlaceTable::with_capacity(vertices),
        }
    }

    fn push(&mut self, corners: [[f64; 3]; 3]) {
        // Adding 0 turns -0 into 0 and changes nothing else.
        let triangle = corners.map(|corner| self.vertex(corner.map(|x| x + 0.0)));
        self.mesh.faces.push(&triangle);
    }

    fn vertex(&mut self, corner: [f64; 3]) -> u32 {
        let positions = &mut self.mesh.positions;
        let next = positions.len() as u32;
        let vertex = self.vertices.find_or_insert(corner, next, positions);
        if vertex == next {
            positions.push(corner);
        }
        vertex
    }
}
