//! Lines, words and numbers of the text formats.
//!
//! All functions work on bytes, because comments and names may have any encoding. The standard
//! library parses numbers and rounds them correctly to `f64`.

use super::error::Flaw;

/// The lines of a file with their numbers, counted from 1. Lines end with LF or CR LF; in a file
/// without LF, with CR.
#[derive(Clone, Debug)]
pub(super) struct NumberedLines<'a> {
    rest: &'a [u8],
    /// Number of the line returned last.
    number: u64,
    /// The byte that ends a line.
    ending: u8,
}

impl<'a> NumberedLines<'a> {
    /// The lines of `bytes`, without a UTF-8 byte order mark at the start.
    pub(super) fn new(bytes: &'a [u8]) -> Self {
        Self {
            rest: bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes),
            number: 0,
            ending: if bytes.contains(&b'\n') { b'\n' } else { b'\r' },
        }
    }

    /// As [`new`](Self::new), for a file that may have binary data behind its lines: they end as
    /// the first one does.
    pub(super) fn before_data(bytes: &'a [u8]) -> Self {
        let mut lines = Self::new(bytes);
        let mut ends = bytes.iter().enumerate();
        let first = ends.find(|(_, b)| matches!(b, b'\n' | b'\r'));
        if let Some((at, b'\r')) = first
            && bytes.get(at + 1) != Some(&b'\n')
        {
            lines.ending = b'\r';
        }
        lines
    }

    /// The byte that ends a line.
    pub(super) fn ending(&self) -> u8 {
        self.ending
    }

    /// The bytes after the line returned last.
    pub(super) fn rest(&self) -> &'a [u8] {
        self.rest
    }

    /// Number of the line returned last; 0 before the first.
    pub(super) fn number(&self) -> u64 {
        self.number
    }
}

impl<'a> Iterator for NumberedLines<'a> {
    type Item = (u64, &'a [u8]);

    fn next(&mut self) -> Option<Self::Item> {
        if self.rest.is_empty() {
            return None;
        }
        let ending = self.ending;
        let (line, rest) = match self.rest.iter().position(|&b| b == ending) {
            Some(end) => (&self.rest[..end], &self.rest[end + 1..]),
            None => (self.rest, &[][..]),
        };
        self.rest = rest;
        self.number += 1;
        Some((self.number, line.strip_suffix(b"\r").unwrap_or(line)))
    }
}

/// The part of `line` before a `#`, except in numbers such as `1.#QNAN`.
pub(super) fn without_comment(line: &[u8]) -> &[u8] {
    let is_comment = |i: &usize| {
        let is_number =
            *i > 0 && line[i - 1] == b'.' && matches!(line.get(i + 1), Some(b'I' | b'Q' | b'S'));
        line[*i] == b'#' && !is_number
    };
    &line[..(0..line.len()).find(is_comment).unwrap_or(line.len())]
}

/// The words of a line, separated by blanks of any kind.
pub(super) fn words(line: &[u8]) -> Words<'_> {
    Words(line)
}

/// Whether a line has no words.
pub(super) fn is_blank(line: &[u8]) -> bool {
    words(line).next().is_none()
}

/// The length in bytes of the blank at the start of `text`; 0 if there is none. Blanks are those of
/// Unicode, the no-break space of Latin-1, and the byte order mark, all of which programs write.
#[inline]
fn blank(text: &[u8]) -> usize {
    match text {
        [b' ' | b'\t'..=b'\r' | 0xa0, ..] => 1,
        [0xc2, 0x85 | 0xa0, ..] => 2,
        [0xe1, 0x9a, 0x80, ..]
        | [0xe2, 0x80, 0x80..=0x8a | 0xa8 | 0xa9 | 0xaf, ..]
        | [0xe2, 0x81, 0x9f, ..]
        | [0xe3, 0x80, 0x80, ..]
        | [0xef, 0xbb, 0xbf, ..] => 3,
        _ => 0,
    }
}

/// The words of several lines, for formats whose elements may extend over lines or share one.
#[derive(Clone, Debug)]
pub(super) struct Tokens<'a> {
    lines: NumberedLines<'a>,
    words: Words<'a>,
    /// Whether `#` begins a comment.
    comments: bool,
}

impl<'a> Tokens<'a> {
    pub(super) fn new(lines: NumberedLines<'a>, comments: bool) -> Self {
        Self {
            lines,
            words: words(&[]),
            comments,
        }
    }

    /// The number of the line of the last word.
    pub(super) fn line(&self) -> u64 {
        self.lines.number()
    }

    /// The next word of the current line.
    pub(super) fn next_in_line(&mut self) -> Option<&'a [u8]> {
        self.words.next()
    }

    /// Goes on to the next line with words, whether or not the current one has more.
    pub(super) fn next_line(&mut self) -> bool {
        let comments = self.comments;
        let content = |line| {
            if comments {
                without_comment(line)
            } else {
                line
            }
        };
        let next = self.lines.find(|(_, line)| !is_blank(content(line)));
        self.words = words(next.map_or(&[], |(_, line)| content(line)));
        next.is_some()
    }

    /// Number of bytes in the lines after the current one.
    pub(super) fn bytes_left(&self) -> usize {
        self.lines.rest().len()
    }

    /// The next word, which is not taken.
    pub(super) fn peek(&self) -> Option<&'a [u8]> {
        self.clone().next()
    }

    /// Drops the rest of the current line.
    pub(super) fn skip_line(&mut self) {
        self.words = words(&[]);
    }
}

impl<'a> Iterator for Tokens<'a> {
    type Item = &'a [u8];

    fn next(&mut self) -> Option<&'a [u8]> {
        loop {
            if let Some(word) = self.words.next() {
                return Some(word);
            }
            let (_, line) = self.lines.next()?;
            let line = if self.comments {
                without_comment(line)
            } else {
                line
            };
            self.words = words(line);
        }
    }
}

/// See [`words`].
#[derive(Clone, Debug)]
pub(super) struct Words<'a>(&'a [u8]);

impl<'a> Words<'a> {
    /// The text after the word returned last.
    pub(super) fn rest(&self) -> &'a [u8] {
        self.0
    }
}

impl<'a> Iterator for Words<'a> {
    type Item = &'a [u8];

    fn next(&mut self) -> Option<&'a [u8]> {
        let mut line = self.0;
        loop {
            match blank(line) {
                0 => break,
                length => line = &line[length..],
            }
        }
        // A byte of 0xa0 behind one that is not ASCII belongs to a character of UTF-8.
        let ends = |i: &usize| match blank(&line[*i..]) {
            0 => false,
            1 => line[*i] != 0xa0 || line[i - 1] < 0x80,
            _ => true,
        };
        let may_end = |i: &usize| line[*i] <= b' ' || line[*i] >= 0x80;
        let mut ends_at = (1..line.len()).filter(may_end).filter(ends);
        let end = ends_at.next().unwrap_or(line.len());
        let (word, rest) = line.split_at(end);
        self.0 = rest;
        (!word.is_empty()).then_some(word)
    }
}

/// A word or line for use in a message: quoted, shortened, printable.
pub(super) fn shown(word: &[u8]) -> String {
    const LONGEST: usize = 40;
    let text = String::from_utf8_lossy(word);
    let mut short: String = text.chars().take(LONGEST).collect();
    if short.len() < text.len() {
        short.push('…');
    }
    format!("{short:?}")
}

/// The number in `word`. `nan` and `inf` are accepted, and how the C library of Windows writes
/// them; validation reports them.
pub(super) fn number(line: u64, word: &[u8]) -> Result<f64, Flaw> {
    let text = std::str::from_utf8(word).ok();
    let number = text.and_then(|text| text.parse().ok()).or_else(|| {
        let text = text?.to_ascii_lowercase();
        let (sign, text) = match text.strip_prefix('-') {
            Some(text) => (-1.0, text),
            None => (1.0, text.strip_prefix('+').unwrap_or(&text)),
        };
        if text.starts_with("1.#inf") {
            Some(sign * f64::INFINITY)
        } else {
            let is_nan = ["1.#qnan", "1.#snan", "1.#ind", "nan("];
            is_nan
                .iter()
                .any(|nan| text.starts_with(nan))
                .then_some(f64::NAN)
        }
    });
    number.ok_or_else(|| Flaw::line(line, format!("{} is not a number", shown(word))))
}

/// The vertex number in `word`, counted from 0.
pub(super) fn index(line: u64, word: &[u8]) -> Result<u32, Flaw> {
    let problem = |what: &str| Flaw::line(line, format!("{} {what}", shown(word)));
    match integer(word) {
        Some(value) => u32::try_from(value)
            .map_err(|_| problem("is no vertex number: they run from 0 to 4294967295")),
        None => Err(problem("is not a whole number, as a vertex number must be")),
    }
}

/// The three coordinates at the start of `line`. `words` then continues after them.
pub(super) fn coordinates<'a>(
    line: u64,
    words: &mut impl Iterator<Item = &'a [u8]>,
) -> Result<[f64; 3], Flaw> {
    let mut position = [0.0; 3];
    for (found, coordinate) in position.iter_mut().enumerate() {
        let word = words.next().ok_or_else(|| {
            Flaw::line(
                line,
                format!("a vertex has three coordinates, here are {found}"),
            )
        })?;
        *coordinate = number(line, word)?;
    }
    Ok(position)
}

/// The integer in `word`, if it is one of at most 128 bits.
pub(super) fn integer(word: &[u8]) -> Option<i128> {
    // Most numbers have few digits and no sign. This takes a third of the time of the general
    // parser.
    if (1..=18).contains(&word.len()) && word.iter().all(u8::is_ascii_digit) {
        let digits = word.iter().map(|&digit| u64::from(digit - b'0'));
        return Some(digits.fold(0, |number, digit| 10 * number + digit).into());
    }
    std::str::from_utf8(word).ok()?.parse().ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_are_counted_whatever_ends_them() {
        let lines: Vec<_> = NumberedLines::new(b"\xef\xbb\xbfa\r\n\nb\rc\nd").collect();
        let expected: [(u64, &[u8]); 4] = [(1, b"a"), (2, b""), (3, b"b\rc"), (4, b"d")];
        assert_eq!(lines, expected);
        let lines: Vec<_> = NumberedLines::new(b"a\r\rb").collect();
        assert_eq!(lines, [(1, &b"a"[..]), (2, b""), (3, b"b")]);
    }

    #[test]
    fn numbers_keep_every_bit() {
        assert_eq!(number(1, b"0.1").unwrap().to_bits(), 0.1f64.to_bits());
        assert_eq!(number(1, b"-0").unwrap().to_bits(), (-0.0f64).to_bits());
        assert_eq!(number(1, b"+.5e1").unwrap(), 5.0);
        assert!(number(1, b"nan").unwrap().is_nan());
        assert!(number(1, b"1,5").is_err());
        assert!(number(1, b"\xff").is_err());
    }

    #[test]
    fn indices_that_do_not_fit_are_told_apart() {
        assert_eq!(index(1, b"4294967295").unwrap(), u32::MAX);
        for word in ["4294967296", "-1", "1.0", "x", ""] {
            assert!(index(1, word.as_bytes()).is_err(), "{word}");
        }
    }

    #[test]
    fn shown_words_are_short_and_printable() {
        assert_eq!(shown(b"a\x07\xff"), "\"a\\u{7}\u{fffd}\"");
        assert!(shown(&[b'x'; 1000]).len() < 60);
    }
}
