//! Legacy VTK files, text or binary: data sets `POLYDATA` and `UNSTRUCTURED_GRID`.
//!
//! Polygons, triangles, quads, pixels and strips are read. Vertices and lines are ignored, and so
//! are all fields. Both layouts of cells are known: the number of corners before each cell (up to
//! version 4.2), and offsets beside the corners of all (from 5.0).

use super::arrays::NumberType;
use super::error::{FilePosition, Flaw};
use super::faces::{FaceList, FileMesh};
use super::text::{self, shown};

/// Reads a legacy VTK file.
pub(super) fn read(bytes: &[u8]) -> Result<FileMesh, Flaw> {
    let mut reader = VtkCursor::new(bytes)?;
    let mut piece = FileMesh::default();
    let mut cells: Option<Cells> = None;
    let mut types: Option<Vec<u32>> = None;
    let mut data_set = None;
    while let Some(word) = reader.word() {
        let is = |keyword: &str| word.eq_ignore_ascii_case(keyword.as_bytes());
        if is("DATASET") {
            let kind = reader.needed("the kind of data set")?;
            let is_known = [&b"POLYDATA"[..], b"UNSTRUCTURED_GRID"]
                .iter()
                .any(|known| kind.eq_ignore_ascii_case(known));
            if !is_known {
                return Err(reader.flaw(format!(
                    "the data set {} has no faces of its own; save its surface as POLYDATA",
                    shown(kind)
                )));
            }
            data_set = Some(kind);
        } else if is("FIELD") {
            reader.skip_field()?;
        } else if data_set.is_none() {
            return Err(reader.flaw(format!("expected DATASET, found {}", shown(word))));
        } else if is("POINTS") && !piece.positions.is_empty()
            || is("CELLS") && cells.is_some()
            || is("CELL_TYPES") && types.is_some()
        {
            let problem = format!(
                "{} comes a second time; make a file of each data set",
                shown(word)
            );
            return Err(reader.flaw(problem));
        } else if is("POINTS") {
            let count = reader.count()?;
            let kind = reader.number_type()?;
            let numbers = reader.floats(3 * count, kind)?;
            piece.positions = numbers.as_chunks().0.to_vec();
        } else if is("POLYGONS") {
            for (_, corners) in reader.cells()?.each() {
                piece.faces.push(corners);
            }
        } else if is("TRIANGLE_STRIPS") {
            for (_, corners) in reader.cells()?.each() {
                piece.faces.push_strip(corners);
            }
        } else if is("VERTICES") || is("LINES") {
            reader.cells()?;
        } else if is("CELLS") {
            cells = Some(reader.cells()?);
        } else if is("CELL_TYPES") {
            let count = reader.count()?;
            types = Some(reader.indices(count, NumberType::I32)?);
        } else if is("METADATA") {
            reader.skip_paragraph();
        } else if is("POINT_DATA") || is("CELL_DATA") {
            // Attributes come last.
            break;
        } else {
            return Err(reader.flaw(format!("the keyword {} is unknown", shown(word))));
        }
    }
    match (cells, types) {
        (Some(cells), Some(types)) => push_cells(&cells, &types, &mut piece.faces)?,
        (None, None) => {}
        _ => return Err(Flaw::file("CELLS and CELL_TYPES need each other")),
    }
    Ok(piece)
}

/// Appends the faces of cells with these types of VTK.
pub(super) fn push_cells(cells: &Cells, types: &[u32], faces: &mut FaceList) -> Result<(), Flaw> {
    let count = cells.ends.len();
    if count != types.len() {
        let types = types.len();
        return Err(Flaw::file(format!(
            "there are {count} cells, but {types} types"
        )));
    }
    for ((cell, corners), kind) in cells.each().zip(types) {
        match (*kind, corners) {
            // Nothing, vertices and lines.
            (0..=4, _) => {}
            (5, [_, _, _]) | (9, [_, _, _, _]) | (7, _) => faces.push(corners),
            (6, _) => faces.push_strip(corners),
            (8, &[a, b, c, d]) => faces.push(&[a, b, d, c]),
            _ => {
                return Err(Flaw::file(format!(
                    "cell {cell}, counted from 0, is of type {kind} with {} corners: no flat \
                     face; save the surface (in ParaView: Extract Surface, Triangulate)",
                    corners.len()
                )));
            }
        }
    }
    Ok(())
}

/// Cells: the corners of all, and where those of each end.
#[derive(Debug, Default)]
pub(super) struct Cells {
    corners: Vec<u32>,
    ends: Vec<u32>,
}

impl Cells {
    /// Cells whose corners end at `ends`.
    pub(super) fn new(corners: Vec<u32>, ends: Vec<u32>) -> Result<Self, Flaw> {
        let mut last = 0;
        for (cell, &end) in ends.iter().enumerate() {
            if end < last || end as usize > corners.len() {
                return Err(Flaw::file(format!(
                    "cell {cell}, counted from 0, ends at {end}, after one that ends at {last}, of \
                     {} corners",
                    corners.len()
                )));
            }
            last = end;
        }
        if last as usize != corners.len() {
            return Err(Flaw::file(format!(
                "the last cell ends at {last} of {} corners",
                corners.len()
            )));
        }
        Ok(Self { corners, ends })
    }

    /// The cells with their numbers and corners.
    pub(super) fn each(&self) -> impl Iterator<Item = (usize, &[u32])> {
        let mut last = 0;
        self.ends.iter().enumerate().map(move |(cell, &end)| {
            let start = std::mem::replace(&mut last, end);
            (cell, &self.corners[start as usize..end as usize])
        })
    }
}

struct VtkCursor<'a> {
    bytes: &'a [u8],
    at: usize,
    is_binary: bool,
    /// The byte that ends a line.
    ending: u8,
}

impl<'a> VtkCursor<'a> {
    /// Reads the first three lines: version, title, encoding.
    fn new(bytes: &'a [u8]) -> Result<Self, Flaw> {
        let mut reader = Self {
            bytes,
            at: if bytes.starts_with(b"\xef\xbb\xbf") {
                3
            } else {
                0
            },
            is_binary: false,
            ending: text::NumberedLines::before_data(bytes).ending(),
        };
        let first = reader.line();
        if !first.to_ascii_lowercase().starts_with(b"# vtk datafile") {
            return Err(Flaw::line(
                1,
                "a legacy VTK file starts with # vtk DataFile; XML files end in .vtp or .vtu",
            ));
        }
        reader.line();
        let encoding = reader.needed("ASCII or BINARY")?;
        reader.is_binary = encoding.eq_ignore_ascii_case(b"BINARY");
        if !reader.is_binary && !encoding.eq_ignore_ascii_case(b"ASCII") {
            let found = shown(encoding);
            return Err(reader.flaw(format!("expected ASCII or BINARY, found {found}")));
        }
        Ok(reader)
    }

    fn rest(&self) -> &'a [u8] {
        &self.bytes[self.at..]
    }

    /// An error at this place.
    fn flaw(&self, problem: impl Into<String>) -> Flaw {
        let lines = self.bytes[..self.at].split(|&b| b == self.ending).count();
        let place = if self.is_binary {
            FilePosition::Byte(self.at as u64)
        } else {
            FilePosition::Line(lines as u64)
        };
        Flaw::at(place, problem)
    }

    /// The rest of the line.
    fn line(&mut self) -> &'a [u8] {
        let rest = self.rest();
        let end = rest.iter().position(|&b| b == self.ending);
        self.at += end.map_or(rest.len(), |end| end + 1);
        rest[..end.unwrap_or(rest.len())].trim_ascii()
    }

    /// The next word, on this line or another.
    fn word(&mut self) -> Option<&'a [u8]> {
        let rest = self.rest();
        let start = rest.iter().position(|b| !b.is_ascii_whitespace())?;
        let length = rest[start..].iter().position(u8::is_ascii_whitespace);
        let end = length.map_or(rest.len(), |length| start + length);
        self.at += end;
        Some(&rest[start..end])
    }

    fn needed(&mut self, what: &str) -> Result<&'a [u8], Flaw> {
        let word = self.word();
        word.ok_or_else(|| self.flaw(format!("the file ends where {what} should follow")))
    }

    /// A number of elements, which cannot be more than the bytes that are left.
    fn count(&mut self) -> Result<usize, Flaw> {
        let word = self.needed("a count")?;
        let count = text::integer(word).and_then(|count| usize::try_from(count).ok());
        let count = count.ok_or_else(|| self.flaw(format!("{} is no count", shown(word))))?;
        if count > self.rest().len() {
            return Err(self.flaw(format!("the file is too short for {count} elements")));
        }
        Ok(count)
    }

    fn number_type(&mut self) -> Result<NumberType, Flaw> {
        let word = self.needed("a type of numbers")?;
        self.type_named(word)
    }

    fn type_named(&self, word: &[u8]) -> Result<NumberType, Flaw> {
        Ok(match &*word.to_ascii_lowercase() {
            b"char" | b"vtktypeint8" => NumberType::I8,
            b"unsigned_char" | b"vtktypeuint8" => NumberType::U8,
            b"short" | b"vtktypeint16" => NumberType::I16,
            b"unsigned_short" | b"vtktypeuint16" => NumberType::U16,
            // Files have indices as `int`.
            b"int" | b"vtktypeint32" | b"vtkidtype" => NumberType::I32,
            b"unsigned_int" | b"vtktypeuint32" => NumberType::U32,
            b"long" | b"vtktypeint64" => NumberType::I64,
            b"unsigned_long" | b"vtktypeuint64" => NumberType::U64,
            b"float" => NumberType::F32,
            b"double" => NumberType::F64,
            _ => {
                let found = shown(word);
                return Err(self.flaw(format!("{found} is no type of numbers that is read")));
            }
        })
    }

    /// The bytes of `count` binary numbers, which follow the line.
    fn binary(&mut self, count: usize, kind: NumberType) -> Result<&'a [u8], Flaw> {
        self.line();
        let length = count.checked_mul(kind.size());
        let data = length.and_then(|length| self.rest().get(..length));
        let data = data.ok_or_else(|| {
            self.flaw(format!(
                "the file ends within {count} numbers; fetch it again"
            ))
        })?;
        self.at += data.len();
        Ok(data)
    }

    fn floats(&mut self, count: usize, kind: NumberType) -> Result<Vec<f64>, Flaw> {
        if self.is_binary {
            let numbers = self.binary(count, kind)?.chunks_exact(kind.size());
            return Ok(numbers.map(|bytes| kind.float(bytes, false)).collect());
        }
        let mut numbers = Vec::with_capacity(count.min(self.rest().len()));
        for _ in 0..count {
            let word = self.needed("a coordinate")?;
            let number = text::number(0, word).map_err(|flaw| self.flaw(flaw.problem))?;
            numbers.push(number);
        }
        Ok(numbers)
    }

    /// `count` whole numbers from 0.
    fn indices(&mut self, count: usize, kind: NumberType) -> Result<Vec<u32>, Flaw> {
        let wrong = |number: i128| format!("{number} is no number from 0 to 4294967295");
        if self.is_binary {
            let numbers = self.binary(count, kind)?.chunks_exact(kind.size());
            let whole = numbers.map(|bytes| {
                let number = kind.integer(bytes, false).unwrap_or(-1);
                u32::try_from(number).map_err(|_| self.flaw(wrong(number)))
            });
            return whole.collect();
        }
        let mut numbers = Vec::with_capacity(count.min(self.rest().len()));
        for _ in 0..count {
            let word = self.needed("a whole number")?;
            let number = text::index(0, word).map_err(|flaw| self.flaw(flaw.problem))?;
            numbers.push(number);
        }
        Ok(numbers)
    }

    /// The cells that follow a keyword.
    fn cells(&mut self) -> Result<Cells, Flaw> {
        let [count, size] = [self.count()?, self.count()?];
        let ahead = self.rest().trim_ascii_start();
        if ahead
            .get(..7)
            .is_some_and(|word| word.eq_ignore_ascii_case(b"OFFSETS"))
        {
            let mut array = |count| {
                self.word();
                let kind = self.number_type()?;
                self.indices(count, kind)
            };
            let mut ends = array(count)?;
            let corners = array(size)?;
            // The first offset is 0, so that there is one more than cells.
            if ends.first().is_some_and(|&first| first != 0) {
                return Err(self.flaw("the first of the offsets is not 0"));
            }
            ends.drain(..ends.len().min(1));
            return Cells::new(corners, ends);
        }
        let numbers = self.indices(size, NumberType::I32)?;
        let mut cells = Cells::default();
        let mut rest = &numbers[..];
        for cell in 0..count {
            let corners = rest
                .split_first()
                .and_then(|(&length, rest)| rest.split_at_checked(length as usize));
            let (corners, after) = corners.ok_or_else(|| {
                self.flaw(format!(
                    "the numbers end within cell {cell} of {count}, counted from 0"
                ))
            })?;
            cells.corners.extend_from_slice(corners);
            cells.ends.push(cells.corners.len() as u32);
            rest = after;
        }
        if !rest.is_empty() {
            return Err(self.flaw(format!(
                "{} numbers follow the last cell; correct the counts",
                rest.len()
            )));
        }
        Ok(cells)
    }

    /// Skips lines up to an empty one.
    fn skip_paragraph(&mut self) {
        self.line();
        while !self.rest().is_empty() && !self.line().is_empty() {}
    }

    /// Skips the arrays of a field.
    fn skip_field(&mut self) -> Result<(), Flaw> {
        self.needed("the name of a field")?;
        for _ in 0..self.count()? {
            let name = self.needed("the name of an array")?;
            if name.eq_ignore_ascii_case(b"METADATA") {
                // It may follow each array.
                self.skip_paragraph();
                self.needed("the name of an array")?;
            }
            let [components, tuples] = [self.count()?, self.count()?];
            let count = components.saturating_mul(tuples);
            let word = self.needed("a type of numbers")?;
            let is = |name: &str| word.eq_ignore_ascii_case(name.as_bytes());
            if is("string") || is("utf8_string") {
                self.skip_strings(count)?;
                continue;
            }
            let (packed, kind) = if is("bit") {
                (count.div_ceil(8), NumberType::U8)
            } else {
                (count, self.type_named(word)?)
            };
            if self.is_binary {
                self.binary(packed, kind)?;
                continue;
            }
            for _ in 0..count {
                self.needed("a number")?;
            }
        }
        Ok(())
    }

    /// Skips strings, which begin on the next line: in text a line each, else their bytes behind
    /// their length, whose first two bits tell how many bytes it has.
    fn skip_strings(&mut self, count: usize) -> Result<(), Flaw> {
        self.line();
        for string in 0..count {
            let rest = self.rest();
            if !self.is_binary && !rest.is_empty() {
                self.line();
                continue;
            }
            let end = rest.first().and_then(|first| {
                let size = [8, 4, 2, 1][usize::from(first >> 6)];
                let start = u64::from(first & 0x3f);
                let more = rest.get(1..size)?.iter();
                let length = more.fold(start, |length, &byte| length << 8 | u64::from(byte));
                usize::try_from(length).ok()?.checked_add(size)
            });
            let end = end.filter(|&end| end <= rest.len()).ok_or_else(|| {
                self.flaw(format!("the file ends within string {string} of {count}"))
            })?;
            self.at += end;
        }
        Ok(())
    }
}
