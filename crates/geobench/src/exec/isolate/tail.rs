//! The last lines of a text that may be endless.

use std::collections::VecDeque;
use std::fmt;

/// Most bytes that are kept.
const BYTES: usize = 2000;

/// Most lines that are shown.
const LINES: usize = 3;

/// Most characters that are shown.
const CHARACTERS: usize = 400;

/// Keeps the end of what is pushed. It shows its last lines as one.
#[derive(Debug, Default)]
pub(super) struct Tail(VecDeque<u8>);

impl Tail {
    pub(super) fn push(&mut self, bytes: &[u8]) {
        self.0.extend(bytes);
        let surplus = self.0.len().saturating_sub(BYTES);
        self.0.drain(..surplus);
    }
}

impl fmt::Display for Tail {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let bytes: Vec<u8> = self.0.iter().copied().collect();
        let text = String::from_utf8_lossy(&bytes);
        let lines: Vec<&str> = text
            .lines()
            .map(str::trim)
            .filter(|line| !line.is_empty())
            .collect();
        let last = lines[lines.len().saturating_sub(LINES)..].join(" / ");
        let surplus = last.chars().count().saturating_sub(CHARACTERS);
        let shown: String = last.chars().skip(surplus).collect();
        f.write_str(&shown)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_last_lines_are_shown_as_one() {
        let mut tail = Tail::default();
        assert_eq!(tail.to_string(), "");
        tail.push(b"one\ntwo\n\nthr");
        tail.push(b"ee\n  four\n");
        assert_eq!(tail.to_string(), "two / three / four");
    }

    #[test]
    fn endless_text_takes_no_memory() {
        let mut tail = Tail::default();
        for _ in 0..1000 {
            tail.push("é".repeat(100).as_bytes());
        }
        tail.push(b"end");
        assert_eq!(tail.0.len(), BYTES);
        let shown = tail.to_string();
        assert_eq!(shown.chars().count(), CHARACTERS);
        assert!(shown.ends_with("éend"), "{shown}");
    }
}
