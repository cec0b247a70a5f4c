//! The payload of a PLY file, after the header.

use super::header::{Element, ElementUse, Property, Role};
use crate::io::arrays::NumberType;
use crate::io::error::{FilePosition, Flaw};
use crate::io::text::{self, NumberedLines, Tokens, integer, shown};

/// Reads the numbers of a payload in order.
pub(super) trait Payload {
    /// Whether every element has a line of its own, so that the rest of an element can be skipped.
    fn is_in_lines(&self) -> bool;

    /// Upper bound of the number of elements of this kind.
    fn most(&self, element: &Element) -> u64;
    /// Called before the elements of one kind.
    fn begin(&self, _element: &Element) -> Result<(), Flaw> {
        Ok(())
    }
    /// Reads all vertices at once, or returns `None` without reading anything.
    fn positions(&mut self, _vertices: &Element) -> Option<Vec<[f64; 3]>> {
        None
    }
    /// Reads all faces at once if they are triangles, or returns `None` without reading anything.
    fn triangles(&mut self, _faces: &Element) -> Option<Vec<[u32; 3]>> {
        None
    }
    /// Called before element `number` of its kind.
    fn next(&mut self, element: &Element, number: u64) -> Result<(), Flaw>;
    /// Reads the length of a list.
    fn length(&mut self, property: &Property) -> Result<u64, Flaw>;
    /// Reads a coordinate.
    fn coordinate(&mut self, property: &Property) -> Result<f64, Flaw>;
    /// Reads a vertex number; `None` for a negative one, if it ends a strip of triangles.
    fn corner(&mut self, property: &Property, in_strip: bool) -> Result<Option<u32>, Flaw>;
    /// Skips `count` numbers.
    fn skip(&mut self, property: &Property, count: u64) -> Result<(), Flaw>;
    /// Checks that the element ends here.
    fn end(&mut self, _element: &Element) -> Result<(), Flaw> {
        Ok(())
    }
    /// Checks that the file ends here: elements beyond the header's counts would be lost silently.
    /// Returns the first line with more numbers than declared, if the layout allows them.
    fn finish(&mut self) -> Result<Option<u64>, Flaw>;
}

/// How the elements of a text payload are laid out.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Layout {
    /// One line for each element. Blank lines are skipped.
    Lines,
    /// As `NumberedLines`, with numbers at the ends of lines that no property has.
    LinesWithMore,
    /// Whatever lines the numbers are in.
    Free,
}

/// A text payload.
pub(super) struct Text<'a> {
    words: Tokens<'a>,
    layout: Layout,
    /// The first line with more numbers than declared.
    more: Option<u64>,
}

impl<'a> Text<'a> {
    pub(super) fn new(lines: NumberedLines<'a>, layout: Layout) -> Self {
        Self {
            words: Tokens::new(lines, false),
            layout,
            more: None,
        }
    }

    fn word(&mut self, property: &Property) -> Result<&'a [u8], Flaw> {
        let word = match self.layout {
            Layout::Free => self.words.next(),
            Layout::Lines | Layout::LinesWithMore => self.words.next_in_line(),
        };
        word.ok_or_else(|| {
            let problem = format!("the line ends before the property {}", property.name);
            Flaw::line(self.words.line(), problem)
        })
    }
}

impl Payload for Text<'_> {
    fn is_in_lines(&self) -> bool {
        self.layout != Layout::Free
    }

    fn most(&self, element: &Element) -> u64 {
        // The shortest lines are "0 0 0" and "3 0 1 2".
        let line = if element.kind == ElementUse::Vertex {
            6
        } else {
            8
        };
        self.words.bytes_left() as u64 / line + 1
    }

    fn next(&mut self, element: &Element, number: u64) -> Result<(), Flaw> {
        let has_more = match self.layout {
            Layout::Free => self.words.peek().is_some(),
            Layout::Lines | Layout::LinesWithMore => self.words.next_line(),
        };
        if has_more {
            return Ok(());
        }
        let problem = format!(
            "the file ends after {number} of the {} elements {} its header declares",
            element.count, element.name
        );
        Err(Flaw::line(self.words.line(), problem))
    }

    fn length(&mut self, property: &Property) -> Result<u64, Flaw> {
        let word = self.word(property)?;
        let length = integer(word).and_then(|length| length.try_into().ok());
        length.ok_or_else(|| {
            Flaw::line(
                self.words.line(),
                format!("{} is no length of a list", shown(word)),
            )
        })
    }

    fn coordinate(&mut self, property: &Property) -> Result<f64, Flaw> {
        let word = self.word(property)?;
        text::number(self.words.line(), word)
    }

    fn corner(&mut self, property: &Property, in_strip: bool) -> Result<Option<u32>, Flaw> {
        let word = self.word(property)?;
        if in_strip && integer(word).is_some_and(|number| number < 0) {
            return Ok(None);
        }
        text::index(self.words.line(), word).map(Some)
    }

    fn skip(&mut self, property: &Property, count: u64) -> Result<(), Flaw> {
        (0..count).try_for_each(|_| self.word(property).map(drop))
    }

    fn end(&mut self, element: &Element) -> Result<(), Flaw> {
        if self.layout == Layout::Free {
            return Ok(());
        }
        let Some(extra) = self.words.next_in_line() else {
            return Ok(());
        };
        if self.layout == Layout::LinesWithMore {
            self.more.get_or_insert(self.words.line());
            return Ok(());
        }
        let problem = format!(
            "{} follows the properties that the header declares for {}",
            shown(extra),
            element.name
        );
        Err(Flaw::line(self.words.line(), problem))
    }

    fn finish(&mut self) -> Result<Option<u64>, Flaw> {
        if self.layout != Layout::Free {
            self.words.skip_line();
        }
        let Some(word) = self.words.next() else {
            return Ok(self.more);
        };
        let problem = format!(
            "{} comes after all the elements that the header declares; correct its counts",
            shown(word)
        );
        Err(Flaw::line(self.words.line(), problem))
    }
}

/// A binary payload.
pub(super) struct Binary<'a, const BIG_ENDIAN: bool> {
    /// The bytes that have not been read yet.
    rest: &'a [u8],
    file_size: usize,
    /// The current element.
    place: FilePosition,
}

impl<'a, const BIG_ENDIAN: bool> Binary<'a, BIG_ENDIAN> {
    /// The payload `rest`, which ends a file of `file_size` bytes.
    pub(super) fn new(rest: &'a [u8], file_size: usize) -> Self {
        Self {
            rest,
            file_size,
            place: FilePosition::File,
        }
    }

    fn flaw(&self, problem: impl Into<String>) -> Flaw {
        Flaw::at(self.place, problem)
    }

    /// The first 32 bits of `bytes` as a number.
    #[inline]
    fn word(bytes: &[u8]) -> u32 {
        let bytes = std::array::from_fn(|i| bytes[i]);
        if BIG_ENDIAN {
            u32::from_be_bytes(bytes)
        } else {
            u32::from_le_bytes(bytes)
        }
    }

    #[cold]
    fn cut_off(&self) -> Flaw {
        self.flaw("the file ends within it; the file is cut off or its header wrong")
    }

    /// The next number, or an error if the file ends within it. An `f64` holds all values of all
    /// types.
    #[allow(clippy::cast_lossless, reason = "not all types have a lossless cast")]
    fn number(&mut self, scalar: NumberType) -> Result<f64, Flaw> {
        macro_rules! read {
            ($type:ty) => {{
                let Some((&bytes, rest)) = self.rest.split_first_chunk() else {
                    return Err(self.cut_off());
                };
                self.rest = rest;
                let number = if BIG_ENDIAN {
                    <$type>::from_be_bytes(bytes)
                } else {
                    <$type>::from_le_bytes(bytes)
                };
                // Exact but for numbers of 64 bits beyond 2^53, which no mesh has.
                number as f64
            }};
        }
        Ok(match scalar {
            NumberType::I8 => read!(i8),
            NumberType::U8 => read!(u8),
            NumberType::I16 => read!(i16),
            NumberType::U16 => read!(u16),
            NumberType::I32 => read!(i32),
            NumberType::U32 => read!(u32),
            NumberType::I64 => read!(i64),
            NumberType::U64 => read!(u64),
            NumberType::F32 => read!(f32),
            NumberType::F64 => read!(f64),
        })
    }

    /// The next number, which must be an unsigned integer of 32 bits.
    fn whole(&mut self, scalar: NumberType, wanted: &str) -> Result<u32, Flaw> {
        let number = self.number(scalar)?;
        // The cast saturates, so a number out of range becomes a different one.
        #[expect(clippy::cast_sign_loss, reason = "a negative number becomes 0")]
        let whole = number as u32;
        if f64::from(whole) == number {
            Ok(whole)
        } else {
            Err(self.flaw(format!("{number} is no {wanted}")))
        }
    }
}

impl<const BIG_ENDIAN: bool> Payload for Binary<'_, BIG_ENDIAN> {
    fn is_in_lines(&self) -> bool {
        false
    }

    fn most(&self, element: &Element) -> u64 {
        // A triangle has three corners of at least one byte each. Polygons enlarge the list later.
        let more = if element.kind == ElementUse::Face {
            3
        } else {
            0
        };
        self.rest.len() as u64 / (element.smallest_size() + more) + 1
    }

    fn begin(&self, element: &Element) -> Result<(), Flaw> {
        let needed = u128::from(element.smallest_size()) * u128::from(element.count);
        if needed <= self.rest.len() as u128 {
            return Ok(());
        }
        Err(Flaw::file(format!(
            "the header declares {} elements {}, which need {needed} bytes or more, but only {} \
             are left; the file is cut off or its header wrong",
            element.count,
            element.name,
            self.rest.len()
        )))
    }

    fn positions(&mut self, vertices: &Element) -> Option<Vec<[f64; 3]>> {
        let size = vertices.smallest_size() as usize;
        let mut places = [None; 3];
        let mut offset = 0;
        for property in &vertices.properties {
            if let Role::Axis(axis) = property.role {
                places[axis] = Some((offset, property.value));
            }
            offset += property.value.size();
            if property.length.is_some() {
                return None;
            }
        }
        let [Some((x, scalar)), Some((y, of_y)), Some((z, of_z))] = places else {
            return None;
        };
        if scalar != of_y || scalar != of_z {
            return None;
        }
        let (own, rest) = self
            .rest
            .split_at_checked(size.checked_mul(vertices.count.try_into().ok()?)?)?;
        let at = |vertex: &[u8]| match scalar {
            NumberType::F32 => {
                [x, y, z].map(|offset| f64::from(f32::from_bits(Self::word(&vertex[offset..]))))
            }
            _ => [x, y, z].map(|offset| {
                let [a, b] = [&vertex[offset..], &vertex[offset + 4..]].map(Self::word);
                let [low, high] = if BIG_ENDIAN { [b, a] } else { [a, b] };
                f64::from_bits(u64::from(high) << 32 | u64::from(low))
            }),
        };
        if !matches!(scalar, NumberType::F32 | NumberType::F64) {
            return None;
        }
        self.rest = rest;
        Some(own.chunks_exact(size).map(at).collect())
    }

    fn triangles(&mut self, faces: &Element) -> Option<Vec<[u32; 3]>> {
        let [
            Property {
                role: Role::Corners,
                length: Some(NumberType::U8 | NumberType::I8),
                value: scalar @ (NumberType::I32 | NumberType::U32),
                ..
            },
        ] = faces.properties[..]
        else {
            return None;
        };
        let size = faces.count.checked_mul(13)?.try_into().ok()?;
        let (own, rest) = self.rest.split_at_checked(size)?;
        let is_signed = scalar == NumberType::I32;
        let mut odd = false;
        let triangle = |face: &[u8]| {
            let corners = [1, 5, 9].map(|offset| Self::word(&face[offset..]));
            odd |= face[0] != 3 || is_signed && corners.iter().any(|&v| v > i32::MAX as u32);
            corners
        };
        let triangles = own.chunks_exact(13).map(triangle).collect();
        if odd {
            return None;
        }
        self.rest = rest;
        Some(triangles)
    }

    fn next(&mut self, element: &Element, number: u64) -> Result<(), Flaw> {
        self.place = FilePosition::Element {
            kind: match element.kind {
                ElementUse::Vertex => "vertex",
                ElementUse::Face => "face",
                ElementUse::Strip => "strip",
                ElementUse::Skipped => "skipped element",
            },
            number,
            byte: (self.file_size - self.rest.len()) as u64,
        };
        Ok(())
    }

    fn length(&mut self, property: &Property) -> Result<u64, Flaw> {
        let scalar = property.length.unwrap_or(property.value);
        self.whole(scalar, "length of a list").map(u64::from)
    }

    fn coordinate(&mut self, property: &Property) -> Result<f64, Flaw> {
        self.number(property.value)
    }

    fn corner(&mut self, property: &Property, in_strip: bool) -> Result<Option<u32>, Flaw> {
        if in_strip {
            let before = self.rest;
            if self.number(property.value)? < 0.0 {
                return Ok(None);
            }
            self.rest = before;
        }
        let wanted = "vertex number: they run from 0 to 4294967295";
        self.whole(property.value, wanted).map(Some)
    }

    fn skip(&mut self, property: &Property, count: u64) -> Result<(), Flaw> {
        let size = usize::try_from(count * property.value.size() as u64);
        let rest = size.ok().and_then(|size| self.rest.get(size..));
        self.rest = rest.ok_or_else(|| self.cut_off())?;
        Ok(())
    }

    /// Blanks and zero bytes may follow the payload.
    fn finish(&mut self) -> Result<Option<u64>, Flaw> {
        let filling = |byte: &u8| *byte == 0 || byte.is_ascii_whitespace();
        if self.rest.iter().all(filling) {
            return Ok(None);
        }
        Err(Flaw::file(format!(
            "{} bytes come after all the elements that the header declares; correct its counts, \
             or cut them off",
            self.rest.len()
        )))
    }
}
