//! STL, text and binary, with its corners welded into vertices.
//!
//! STL has no vertex numbers: every triangle carries its own coordinates. Corners whose
//! coordinates are the same bits become one vertex, -0 being the same as 0, and vertices are
//! numbered in the order of their first appearance. Nothing is merged by distance.
//!
//! Binary triangles are read by `stl_io`. It would keep -0 and 0 apart, so the welding is ours; and
//! it rounds text to `f32`, so text is read here, at `f64`. Normals and attributes are ignored.

use std::collections::HashMap;
use std::io::Cursor;

use super::error::{Flaw, Place};
use super::text::{Lines, coordinates, shown, words};
use crate::soup::TriangleSoup;

/// Bytes before the first triangle of a binary file: 80 of free text and the count.
const HEADER: usize = 84;
/// Bytes of a binary triangle.
const TRIANGLE: usize = 50;

/// Reads a whole STL file.
pub(super) fn read(bytes: &[u8]) -> Result<TriangleSoup, Flaw> {
    let soup = if is_binary(bytes) {
        read_binary(bytes)?
    } else {
        read_text(bytes)?
    };
    if soup.triangles.is_empty() {
        return Err(Flaw::file("there is no triangle in it"));
    }
    Ok(soup)
}

/// Many binary files start with `solid`, so the size decides, and then a byte that no text has.
fn is_binary(bytes: &[u8]) -> bool {
    if let Some(count) = declared_count(bytes)
        && HEADER as u64 + TRIANGLE as u64 * u64::from(count) == bytes.len() as u64
    {
        return true;
    }
    let start = Lines::new(bytes).rest().trim_ascii_start();
    let says_text = start
        .get(..5)
        .is_some_and(|s| s.eq_ignore_ascii_case(b"solid"));
    !says_text || bytes.iter().take(2 * HEADER).any(|&b| b == 0)
}

/// The number of triangles of a binary file.
fn declared_count(bytes: &[u8]) -> Option<u32> {
    let count = bytes.get(HEADER - 4..HEADER)?;
    Some(u32::from_le_bytes(count.try_into().ok()?))
}

fn read_binary(bytes: &[u8]) -> Result<TriangleSoup, Flaw> {
    let count = declared_count(bytes).ok_or_else(|| {
        Flaw::file("this is no STL: it neither starts with solid nor holds a binary header")
    })?;
    let there = (bytes.len() - HEADER) / TRIANGLE;
    if (there as u64) < u64::from(count) {
        return Err(Flaw {
            place: Place::Element {
                kind: "triangle",
                number: there as u64,
                byte: (HEADER + there * TRIANGLE) as u64,
            },
            problem: format!(
                "the file ends within it, though the header declares {count} triangles; fetch it again"
            ),
        });
    }
    // Less than a triangle may follow, as padding does; whole ones would be lost without a word.
    let more = there as u64 - u64::from(count);
    if more > 0 {
        return Err(Flaw::file(format!(
            "the header declares {count} triangles, but the file has room for {more} more after \
             them; correct the count in bytes 80 to 83, or cut off what follows"
        )));
    }
    // `stl_io` takes anything that starts with "solid " for text.
    let mut blank = bytes.to_vec();
    blank[..HEADER - 4].fill(0);
    let mut cursor = Cursor::new(blank);
    let unreadable = |error: std::io::Error| Flaw::file(error.to_string());
    let mut weld = Weld::with_capacity(there);
    for triangle in stl_io::create_stl_reader(&mut cursor).map_err(unreadable)? {
        let corners = triangle.map_err(unreadable)?.vertices;
        weld.push(corners.map(|corner| <[f32; 3]>::from(corner).map(f64::from)));
    }
    Ok(weld.soup)
}

fn read_text(bytes: &[u8]) -> Result<TriangleSoup, Flaw> {
    let mut statements = Statements {
        lines: Lines::new(bytes),
        open: false,
    };
    // A triangle takes some 100 bytes of text.
    let mut weld = Weld::with_capacity(bytes.len() / 100);
    while let Some(statement) = statements.next_or_end()? {
        match &statement.keyword[..] {
            b"solid" => statements.open = true,
            b"endsolid" => statements.open = false,
            b"facet" if statements.open => {
                statements.expect(b"outer")?;
                let mut corners = [[0.0; 3]; 3];
                for corner in &mut corners {
                    let vertex = statements.expect(b"vertex")?;
                    *corner = coordinates(vertex.line, &mut words(vertex.rest))?;
                }
                statements.expect(b"endloop")?;
                statements.expect(b"endfacet")?;
                weld.push(corners);
            }
            _ if statements.open => return Err(statement.instead_of("facet or endsolid")),
            _ => return Err(statement.instead_of("solid")),
        }
    }
    Ok(weld.soup)
}

/// A line of a text file that is not blank.
struct Statement<'a> {
    /// Its number, counted from 1.
    line: u64,
    /// Its first word, in lower case.
    keyword: Vec<u8>,
    /// What follows that.
    rest: &'a [u8],
}

impl Statement<'_> {
    /// Another statement should stand here.
    fn instead_of(&self, wanted: &str) -> Flaw {
        let found = shown(&self.keyword);
        Flaw::line(self.line, format!("expected {wanted}, found {found}"))
    }
}

/// The statements of a text file.
struct Statements<'a> {
    lines: Lines<'a>,
    /// Whether a solid has begun and not ended.
    open: bool,
}

impl<'a> Statements<'a> {
    fn next(&mut self) -> Option<Statement<'a>> {
        self.lines.find_map(|(number, line)| {
            let content = line.trim_ascii();
            let keyword = words(content).next()?;
            Some(Statement {
                line: number,
                keyword: keyword.to_ascii_lowercase(),
                rest: &content[keyword.len()..],
            })
        })
    }

    /// The next statement; the file may end only outside a solid.
    fn next_or_end(&mut self) -> Result<Option<Statement<'a>>, Flaw> {
        match self.next() {
            None if self.open => Err(self.cut_off("facet or endsolid")),
            statement => Ok(statement),
        }
    }

    /// The next statement, which must start with `keyword`.
    fn expect(&mut self, keyword: &[u8]) -> Result<Statement<'a>, Flaw> {
        let wanted = String::from_utf8_lossy(keyword);
        match self.next() {
            Some(statement) if statement.keyword == keyword => Ok(statement),
            Some(statement) => Err(statement.instead_of(&wanted)),
            None => Err(self.cut_off(&wanted)),
        }
    }

    fn cut_off(&self, wanted: &str) -> Flaw {
        Flaw::line(
            self.lines.number(),
            format!("the file ends where {wanted} should follow; fetch it again"),
        )
    }
}

/// Gives equal corners the same vertex.
struct Weld {
    soup: TriangleSoup,
    vertices: HashMap<[u64; 3], u32>,
}

impl Weld {
    fn with_capacity(triangles: usize) -> Self {
        Self {
            soup: TriangleSoup::new(
                Vec::with_capacity(triangles / 2),
                Vec::with_capacity(triangles),
            ),
            vertices: HashMap::with_capacity(triangles / 2),
        }
    }

    fn push(&mut self, corners: [[f64; 3]; 3]) {
        let positions = &mut self.soup.positions;
        let triangle = corners.map(|corner| {
            // Adding 0 turns -0 into 0 and changes nothing else.
            let corner = corner.map(|x| x + 0.0);
            *self
                .vertices
                .entry(corner.map(f64::to_bits))
                .or_insert_with(|| {
                    positions.push(corner);
                    positions.len() as u32 - 1
                })
        });
        self.soup.triangles.push(triangle);
    }
}
