//! Lines, words and numbers of the text formats.
//!
//! All functions work on bytes, because comments and names may have any encoding. The standard
//! library parses numbers and rounds them correctly to `f64`.

use super::error::Flaw;

/// The lines of a file with their numbers, counted from 1. Lines end with LF or CR LF; in a file
/// without LF, with CR.
#[derive(Clone, Debug)]
pub(super) struct Lines<'a> {
    rest: &'a [u8],
    /// Number of the line returned last.
    number: u64,
    /// The byte that ends a line.
    ending: u8,
}

impl<'a> Lines<'a> {
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

    /// The bytes after the line returned last.
    pub(super) fn rest(&self) -> &'a [u8] {
        self.rest
    }

    /// Number of the line returned last; 0 before the first.
    pub(super) fn number(&self) -> u64 {
        self.number
    }
}

impl<'a> Iterator for Lines<'a> {
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

/// The part of `line` before a `#`.
pub(super) fn without_comment(line: &[u8]) -> &[u8] {
    line.split(|&b| b == b'#').next().unwrap_or(line)
}

/// The words of a line, separated by blanks and tabs.
pub(super) fn words(line: &[u8]) -> Words<'_> {
    Words(line)
}

/// See [`words`].
#[derive(Clone, Debug)]
pub(super) struct Words<'a>(&'a [u8]);

impl<'a> Iterator for Words<'a> {
    type Item = &'a [u8];

    fn next(&mut self) -> Option<&'a [u8]> {
        let line = self.0.trim_ascii_start();
        let end = line.iter().position(u8::is_ascii_whitespace);
        let (word, rest) = line.split_at(end.unwrap_or(line.len()));
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

/// The number in `word`. `nan` and `inf` are accepted; validation reports them.
pub(super) fn number(line: u64, word: &[u8]) -> Result<f64, Flaw> {
    std::str::from_utf8(word)
        .ok()
        .and_then(|text| text.parse().ok())
        .ok_or_else(|| Flaw::line(line, format!("{} is not a number", shown(word))))
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
        let lines: Vec<_> = Lines::new(b"\xef\xbb\xbfa\r\n\nb\rc\nd").collect();
        let expected: [(u64, &[u8]); 4] = [(1, b"a"), (2, b""), (3, b"b\rc"), (4, b"d")];
        assert_eq!(lines, expected);
        let lines: Vec<_> = Lines::new(b"a\r\rb").collect();
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
