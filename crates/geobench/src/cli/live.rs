//! Lines that are drawn anew in place, below what has been printed.

use std::io::Write;

use unicode_width::UnicodeWidthChar;

/// What stands below everything that was printed, on a terminal that `out` writes to.
///
/// Nobody is told when the terminal takes no more: what stands here is said elsewhere, too.
#[derive(Debug)]
pub(super) struct LiveLines<W> {
    out: W,
    /// Lines that stand there. The cursor is behind the last one.
    drawn: usize,
}

impl<W: Write> LiveLines<W> {
    pub(super) const fn new(out: W) -> Self {
        Self { out, drawn: 0 }
    }

    /// Puts `lines` in the place of those that stand there. A line that fills the width of the terminal may
    /// break, and its first half would stay: see [`cut`].
    pub(super) fn draw(&mut self, lines: &[String]) {
        let text = format!("{}{}", self.way_back(), lines.join("\r\n"));
        self.drawn = lines.len();
        self.write(&text);
    }

    /// Takes them away. What is printed next begins where they began.
    pub(super) fn clear(&mut self) {
        if self.drawn > 0 {
            self.draw(&[]);
        }
    }

    /// Takes the cursor to where the first line began, and clears the screen from there.
    fn way_back(&self) -> String {
        match self.drawn {
            0 => String::new(),
            1 => "\r\x1b[J".to_owned(),
            drawn => format!("\r\x1b[{}A\x1b[J", drawn - 1),
        }
    }

    /// Writes `text` at once, so that no half of it is seen.
    fn write(&mut self, text: &str) {
        let _ = self.out.write_all(text.as_bytes());
        let _ = self.out.flush();
    }
}

/// As much of `text` as fits on `columns` of a terminal. Characters that would steer it are replaced.
pub(super) fn cut(text: &str, columns: usize) -> String {
    let mut used = 0;
    text.chars()
        .map(|letter| {
            if letter.is_control() {
                '\u{fffd}'
            } else {
                letter
            }
        })
        .take_while(|letter| {
            used += letter.width().unwrap_or(0);
            used <= columns
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use std::num::NonZero;

    use super::*;

    /// What a terminal of 20 columns and 5 lines shows after `acts`.
    fn shown(acts: impl FnOnce(&mut LiveLines<&mut Vec<u8>>)) -> String {
        let mut bytes = Vec::new();
        acts(&mut LiveLines::new(&mut bytes));
        let size = |count| NonZero::new(count).unwrap();
        let mut terminal = vt100::Parser::new(size(5), size(20), 0);
        terminal.process(&bytes);
        terminal.screen().contents()
    }

    fn lines(text: &str) -> Vec<String> {
        text.lines().map(str::to_owned).collect()
    }

    #[test]
    fn lines_are_drawn_over_those_that_stand_there() {
        let text = shown(|live| {
            live.draw(&lines("first line\nsecond"));
            live.draw(&lines("one\ntwo\nthree"));
        });
        assert_eq!(text, "one\ntwo\nthree");
    }

    #[test]
    fn fewer_lines_leave_nothing_of_the_others() {
        let text = shown(|live| {
            live.draw(&lines("one\ntwo\nthree"));
            live.draw(&lines("1"));
        });
        assert_eq!(text, "1");
    }

    #[test]
    fn what_is_printed_meanwhile_stays_above() {
        let text = shown(|live| {
            for i in 0..2 {
                live.draw(&lines("table\nbar"));
                live.clear();
                live.write(&format!("printed {i}\r\n"));
            }
            live.draw(&lines("table\nbar"));
        });
        assert_eq!(text, "printed 0\nprinted 1\ntable\nbar");
    }

    #[test]
    fn lines_at_the_bottom_of_a_terminal_scroll_it_once() {
        let text = shown(|live| {
            live.write("a\r\nb\r\nc\r\nd\r\n");
            for _ in 0..5 {
                live.draw(&lines("table\nbar"));
            }
        });
        assert_eq!(text, "b\nc\nd\ntable\nbar");
    }

    #[test]
    fn nothing_is_cleared_where_nothing_stands() {
        let text = shown(|live| {
            live.write("printed");
            live.clear();
        });
        assert_eq!(text, "printed");
    }

    #[test]
    fn a_line_is_cut_by_columns_and_cannot_steer_the_terminal() {
        assert_eq!(cut("abc", 2), "ab");
        assert_eq!(cut("牛牛牛", 5), "牛牛");
        assert_eq!(cut("a\x1b[2Jb\n", 9), "a\u{fffd}[2Jb\u{fffd}");
    }
}
