//! Escapes untrusted text, such as names of models and messages of programs, for each output
//! format. JSON output needs no escaping beyond its own.

use std::borrow::Cow;
use std::fmt::Write;

/// `text` in one line that cannot control a terminal. Line breaks and tabs become spaces. Other
/// control characters, and those that change the direction of text, become their codes.
pub fn printable(text: &str) -> Cow<'_, str> {
    if !text.contains(steers) {
        return Cow::Borrowed(text);
    }
    let mut shown = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '\n' | '\r' | '\t' => shown.push(' '),
            c if steers(c) => code(&mut shown, c),
            c => shown.push(c),
        }
    }
    Cow::Owned(shown)
}

/// `text` with control characters as codes, except line breaks, tabs and, if `styled`, colour
/// sequences.
pub fn for_terminal(text: &str, styled: bool) -> Cow<'_, str> {
    if !text.contains(|c| steers(c) && !matches!(c, '\n' | '\t')) {
        return Cow::Borrowed(text);
    }
    let mut shown = String::with_capacity(text.len());
    let mut rest = text;
    while let Some(c) = rest.chars().next() {
        let colour = if styled { colour(rest) } else { 0 };
        let length = colour.max(c.len_utf8());
        match c {
            c if colour == 0 && steers(c) && !matches!(c, '\n' | '\t') => code(&mut shown, c),
            _ => shown.push_str(&rest[..length]),
        }
        rest = &rest[length..];
    }
    Cow::Owned(shown)
}

/// Length in bytes of the colour sequence at the start of `text`; 0 if there is none.
fn colour(text: &str) -> usize {
    let Some(parameters) = text.strip_prefix("\x1b[") else {
        return 0;
    };
    let end = parameters.find(|c: char| !c.is_ascii_digit() && c != ';');
    match end {
        Some(end) if parameters[end..].starts_with('m') => "\x1b[".len() + end + 1,
        _ => 0,
    }
}

/// Whether the character controls a terminal or an editor.
fn steers(c: char) -> bool {
    c.is_control()
        || matches!(
            c,
            '\u{61c}' | '\u{200e}'..='\u{200f}' | '\u{2028}'..='\u{202e}' | '\u{2066}'..='\u{2069}'
        )
}

fn code(shown: &mut String, c: char) {
    // Writing to a string cannot fail.
    let _ = if c.is_ascii() {
        write!(shown, "\\x{:02x}", c as u32)
    } else {
        write!(shown, "\\u{{{:x}}}", c as u32)
    };
}

/// `text` as a line of Markdown or the beginning of one, as [`markdown`], and no heading, list or
/// quotation.
pub fn markdown_line(text: &str) -> String {
    let text = printable(text);
    let text = text.trim_start();
    let marker = text.trim_start_matches(|c: char| c.is_ascii_digit());
    let number = &text[..text.len() - marker.len()];
    if !number.is_empty() && marker.starts_with(['.', ')']) {
        return format!("{number}\\{}", markdown(marker));
    }
    let is_block = text.starts_with(['#', '-', '+', '>', '=']);
    let start = if is_block { "\\" } else { "" };
    format!("{start}{}", markdown(text))
}

/// `text` within a line of Markdown, without markup: no HTML, no link, no end of a table cell, and
/// on GitHub no mention of a user, no reference to an issue and no address that becomes a link.
pub fn markdown(text: &str) -> String {
    /// Invisible. Letters behind it are no name of a user, and digits no number of an issue.
    const BREAK: &str = "&#8203;";
    let text = printable(text);
    let mut escaped = String::with_capacity(text.len());
    let mut last = ' ';
    let mut letters = text.chars().peekable();
    while let Some(c) = letters.next() {
        let next = letters.peek().copied().unwrap_or(' ');
        match c {
            '<' => escaped.push_str("&lt;"),
            '&' => escaped.push_str("&amp;"),
            '\\' | '|' | '`' | '*' | '~' => escaped.extend(['\\', c]),
            ':' if letters.clone().take(2).eq("//".chars()) => escaped.extend([":", BREAK]),
            '.' if ends_with_www(&escaped) => escaped.extend([BREAK, "."]),
            '@' if next.is_alphanumeric() => escaped.extend(["@", BREAK]),
            '#' if next.is_ascii_digit() => escaped.extend(["#", BREAK]),
            // Within a word an underscore is no markup.
            '_' if !(last.is_alphanumeric() && next.is_alphanumeric()) => escaped.push_str("\\_"),
            // Here a bracket ends the text of a link.
            ']' if matches!(next, '(' | '[' | ':') => escaped.push_str("\\]"),
            c => escaped.push(c),
        }
        last = c;
    }
    escaped
}

/// Whether what follows a dot would make a link of `text`.
fn ends_with_www(text: &str) -> bool {
    let end = text.as_bytes().last_chunk::<3>();
    end.is_some_and(|end| end.eq_ignore_ascii_case(b"www"))
}

/// `text` with the special characters of XML and HTML escaped, for attributes and content.
/// Characters that XML cannot hold are left out, and those that change the direction of text become
/// their codes.
pub fn xml(text: &str) -> String {
    let mut escaped = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '&' => escaped.push_str("&amp;"),
            '<' => escaped.push_str("&lt;"),
            '>' => escaped.push_str("&gt;"),
            '"' => escaped.push_str("&quot;"),
            '\'' => escaped.push_str("&#39;"),
            '\n' | '\t' => escaped.push(' '),
            c if c.is_control() || matches!(c, '\u{fffe}' | '\u{ffff}') => {}
            c if steers(c) => code(&mut escaped, c),
            c => escaped.push(c),
        }
    }
    escaped
}

/// A word quoted for the shell where it needs quotes.
pub fn shell(word: &str) -> String {
    let plain = |b: u8| b.is_ascii_alphanumeric() || b"-_./:=,@%+".contains(&b);
    if !word.is_empty() && word.bytes().all(plain) {
        word.to_owned()
    } else {
        format!("'{}'", word.replace('\'', r"'\''"))
    }
}

/// A text cell of a CSV file. Text that a spreadsheet would take for a formula gets an apostrophe
/// in front. Numbers and a lone dash stay unchanged. Text that starts with an apostrophe gets
/// another one, so that readers can remove the first.
pub fn csv_text(text: &str) -> Cow<'_, str> {
    if is_formula(text.trim_start_matches('\'')) {
        Cow::Owned(format!("'{text}"))
    } else {
        Cow::Borrowed(text)
    }
}

fn is_formula(text: &str) -> bool {
    const STARTS: [char; 11] = [
        '=', '+', '-', '@', '\t', '\r', '\n', '\u{ff1d}', '\u{ff0b}', '\u{ff0d}', '\u{ff20}',
    ];
    text.starts_with(STARTS) && text != "-" && text.parse::<f64>().is_err()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nothing_steers_a_terminal() {
        assert_eq!(printable("horse 牛 \u{b1}"), "horse 牛 \u{b1}");
        assert_eq!(
            printable("a\x1b[2Jb\nc\td\x7f\u{9b}\u{202e}"),
            "a\\x1b[2Jb c d\\x7f\\u{9b}\\u{202e}"
        );
        let styled = "\x1b[1;32m2*\x1b[0m\n\x1b[2J\x1b[1\x1b]0;x\x07";
        assert_eq!(
            for_terminal(styled, true),
            "\x1b[1;32m2*\x1b[0m\n\\x1b[2J\\x1b[1\\x1b]0;x\\x07"
        );
        assert_eq!(
            for_terminal(styled, false),
            "\\x1b[1;32m2*\\x1b[0m\n\\x1b[2J\\x1b[1\\x1b]0;x\\x07"
        );
    }

    #[test]
    fn nothing_is_markup() {
        assert_eq!(
            markdown("asian_dragon [95 %] -> 2"),
            "asian_dragon [95 %] -> 2"
        );
        assert_eq!(
            markdown("<img src=x>|&amp;`*a*`\n_b_ \\| [c](d) ![e][f] ~g~"),
            "&lt;img src=x>\\|&amp;amp;\\`\\*a\\*\\` \\_b\\_ \\\\\\| [c\\](d) ![e\\][f] \\~g\\~"
        );
    }

    #[test]
    fn headings_lists_and_mentions_are_escaped() {
        for (text, escaped) in [
            ("# head", "\\# head"),
            ("  - item", "\\- item"),
            ("===", "\\==="),
            ("> q", "\\> q"),
            ("12. x", "12\\. x"),
            ("12.5 x", "12\\.5 x"),
            ("12 x", "12 x"),
            ("hi @everyone a@ b", "hi @&#8203;everyone a@ b"),
            ("horse #2 # x", "horse #&#8203;2 # x"),
            ("see https://a.b", "see https:&#8203;//a.b"),
            ("WWW.a.b c:/d", "WWW&#8203;.a.b c:/d"),
        ] {
            assert_eq!(markdown_line(text), escaped);
        }
        assert_eq!(markdown("-3.0 %"), "-3.0 %");
    }

    #[test]
    fn nothing_is_an_element() {
        assert_eq!(xml("a\u{202e}b"), "a\\u{202e}b");
        assert_eq!(
            xml("<a href=\"x\">'&\u{1}</a>"),
            "&lt;a href=&quot;x&quot;&gt;&#39;&amp;&lt;/a&gt;"
        );
    }

    #[test]
    fn no_cell_is_a_formula() {
        for bare in ["horse", "a=b", "-", "-1.5", "+3e4", "-inf", "", "'x", "1"] {
            assert_eq!(csv_text(bare), bare);
        }
        for text in ["=1+1", "+a", "-a", "@a", "\ta", "\ra", "'=a", "''=a"] {
            let cell = csv_text(text);
            assert_eq!(cell.strip_prefix('\''), Some(text));
        }
    }
}
