//! An SVG writer that escapes texts and attributes.

use std::fmt::Write;

use crate::escape::xml as escape;

/// An SVG document, or a fragment of one, under construction.
#[derive(Debug, Default)]
pub struct Svg {
    text: String,
    open: Vec<&'static str>,
}

/// Names and values of attributes.
pub type Attributes<'a> = &'a [(&'static str, String)];

impl Svg {
    /// Starts an element, which [`Self::close`] ends.
    pub fn open(&mut self, name: &'static str, attributes: Attributes<'_>) {
        self.start(name, attributes);
        self.text.push('>');
        self.open.push(name);
    }

    /// Ends the innermost element.
    pub fn close(&mut self) {
        if let Some(name) = self.open.pop() {
            let _ = writeln!(self.text, "</{name}>"); // Writing to a string cannot fail.
        }
    }

    /// An element without contents.
    pub fn leaf(&mut self, name: &'static str, attributes: Attributes<'_>) {
        self.start(name, attributes);
        self.text.push_str("/>\n");
    }

    /// An element whose only content is `text`.
    pub fn holding(&mut self, name: &'static str, attributes: Attributes<'_>, text: &str) {
        self.open(name, attributes);
        self.text.push_str(&escape(text));
        self.close();
    }

    /// Text at a point.
    pub fn text(&mut self, at: [f64; 2], class: &str, text: &str) {
        let attributes = [
            ("class", class.to_owned()),
            ("x", px(at[0])),
            ("y", px(at[1])),
        ];
        self.holding("text", &attributes, text);
    }

    /// A line with a CSS class.
    pub fn line(&mut self, class: &str, from: [f64; 2], to: [f64; 2]) {
        let attributes = [
            ("class", class.to_owned()),
            ("x1", px(from[0])),
            ("y1", px(from[1])),
            ("x2", px(to[0])),
            ("y2", px(to[1])),
        ];
        self.leaf("line", &attributes);
    }

    /// Adds SVG or CSS, unescaped.
    pub fn raw(&mut self, text: &str) {
        self.text.push_str(text);
    }

    /// The document, with every element closed.
    pub fn finish(mut self) -> String {
        while !self.open.is_empty() {
            self.close();
        }
        self.text
    }

    fn start(&mut self, name: &str, attributes: Attributes<'_>) {
        let _ = write!(self.text, "<{name}"); // Writing to a string cannot fail.
        for (name, value) in attributes {
            let _ = write!(self.text, " {name}=\"{}\"", escape(value));
        }
    }
}

/// The style sheet of drawings.
pub const STYLE: &str = include_str!("chart.css");

/// The elements `inside` as an `svg` element with a title and a description for screen readers,
/// whose ids start with `id`. If `alone`, it is a file of its own: it has a size and includes the
/// style sheet.
pub fn drawing(
    id: &str,
    title: &str,
    description: &str,
    [width, height]: [f64; 2],
    inside: &str,
    alone: bool,
) -> String {
    let mut svg = Svg::default();
    let id = |part: &str| format!("{id}-{part}");
    let mut attributes = vec![
        ("xmlns", "http://www.w3.org/2000/svg".to_owned()),
        ("class", "chart".to_owned()),
        ("role", "img".to_owned()),
        ("viewBox", format!("0 0 {width:.0} {height:.0}")),
        ("aria-labelledby", format!("{} {}", id("title"), id("desc"))),
    ];
    if alone {
        attributes.push(("width", format!("{width:.0}")));
        attributes.push(("height", format!("{height:.0}")));
    }
    svg.open("svg", &attributes);
    svg.holding("title", &[("id", id("title"))], title);
    svg.holding("desc", &[("id", id("desc"))], description);
    if alone {
        svg.open("style", &[]);
        svg.raw(STYLE);
        svg.close();
    }
    svg.raw(inside);
    svg.finish()
}

/// A length in units of the drawing, rounded to a tenth.
pub fn px(length: f64) -> String {
    let text = format!("{length:.1}");
    match text.strip_suffix(".0") {
        Some("-0") => "0".to_owned(),
        Some(whole) => whole.to_owned(),
        None => text,
    }
}

/// Estimated width of `text` in units of the drawing. A wide font is assumed, because the reader's
/// fonts are unknown.
pub fn width_of(text: &str) -> f64 {
    text.chars().map(letter).sum()
}

/// Estimated width of a letter.
fn letter(c: char) -> f64 {
    match c {
        'i' | 'j' | 'l' | ' ' | '.' | ',' | ':' | ';' | '|' | '\'' => 4.0,
        'f' | 'r' | 't' | '-' | '/' | '(' | ')' | '[' | ']' => 5.0,
        'm' | 'w' | 'M' | 'W' | '%' | '=' | '+' | '<' | '>' | '\u{2026}' => 12.0,
        'A'..='Z' => 8.7,
        _ => 7.7,
    }
}

/// `text`, cut to a width with an ellipsis if it is wider.
pub fn fitted(text: &str, width: f64) -> String {
    if width_of(text) <= width {
        return text.to_owned();
    }
    let mut room = width - letter('\u{2026}');
    let fits = text.chars().take_while(|&c| {
        room -= letter(c);
        room >= 0.0
    });
    fits.collect::<String>() + "\u{2026}"
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn attributes_and_texts_are_escaped() {
        let mut svg = Svg::default();
        svg.open("g", &[("class", "a\"b".into())]);
        svg.text([1.0, 2.25], "t", "<&>");
        assert_eq!(
            svg.finish(),
            "<g class=\"a&quot;b\"><text class=\"t\" x=\"1\" y=\"2.2\">&lt;&amp;&gt;</text>\n</g>\n"
        );
    }

    #[test]
    fn lengths_are_short() {
        assert_eq!(
            [px(1.0), px(-0.04), px(0.25), px(12.34)],
            ["1", "0", "0.2", "12.3"]
        );
    }

    #[test]
    fn text_is_cut_where_it_does_not_fit() {
        assert_eq!(fitted("vtp", 100.0), "vtp");
        let name = "fwp-mmp{bucket=2,kmax=5000}";
        let cut = fitted(name, 100.0);
        assert!(cut.ends_with('\u{2026}') && name.starts_with(cut.trim_end_matches('\u{2026}')));
        assert!(width_of(&cut) <= 100.0 && width_of(&cut) > 85.0, "{cut}");
        assert_eq!(fitted(name, 0.0), "\u{2026}");
    }
}
