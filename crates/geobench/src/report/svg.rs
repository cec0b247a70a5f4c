//! Writing SVG, escaped.

use std::fmt::Write;

/// An SVG document, or a part of one, that is being written.
#[derive(Debug, Default)]
pub(crate) struct Svg {
    text: String,
    open: Vec<&'static str>,
}

/// Names and values of attributes.
pub(crate) type Attributes<'a> = &'a [(&'static str, String)];

impl Svg {
    /// Starts an element; what follows stands in it until [`Self::close`].
    pub(crate) fn open(&mut self, name: &'static str, attributes: Attributes<'_>) {
        self.start(name, attributes);
        self.text.push('>');
        self.open.push(name);
    }

    /// Ends the element that was started last.
    pub(crate) fn close(&mut self) {
        if let Some(name) = self.open.pop() {
            let _ = writeln!(self.text, "</{name}>"); // Writing to a string cannot fail.
        }
    }

    /// An element without contents.
    pub(crate) fn leaf(&mut self, name: &'static str, attributes: Attributes<'_>) {
        self.start(name, attributes);
        self.text.push_str("/>\n");
    }

    /// An element that holds `text` alone.
    pub(crate) fn holding(&mut self, name: &'static str, attributes: Attributes<'_>, text: &str) {
        self.open(name, attributes);
        self.text.push_str(&escape(text));
        self.close();
    }

    /// Text at a point.
    pub(crate) fn text(&mut self, at: [f64; 2], class: &str, text: &str) {
        let attributes = [
            ("class", class.to_owned()),
            ("x", px(at[0])),
            ("y", px(at[1])),
        ];
        self.holding("text", &attributes, text);
    }

    /// A line of a class.
    pub(crate) fn line(&mut self, class: &str, from: [f64; 2], to: [f64; 2]) {
        let attributes = [
            ("class", class.to_owned()),
            ("x1", px(from[0])),
            ("y1", px(from[1])),
            ("x2", px(to[0])),
            ("y2", px(to[1])),
        ];
        self.leaf("line", &attributes);
    }

    /// Text that is SVG or CSS already.
    pub(crate) fn raw(&mut self, text: &str) {
        self.text.push_str(text);
    }

    /// What was written, with every element ended.
    pub(crate) fn finish(mut self) -> String {
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

/// A length in the units of the drawing, to a tenth.
pub(crate) fn px(length: f64) -> String {
    let text = format!("{length:.1}");
    match text.strip_suffix(".0") {
        Some("-0") => "0".to_owned(),
        Some(whole) => whole.to_owned(),
        None => text,
    }
}

/// `text` with the characters that mean something in XML and HTML made harmless, in and outside
/// of attributes; what XML cannot hold is left out.
pub(crate) fn escape(text: &str) -> String {
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
            c => escaped.push(c),
        }
    }
    escaped
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_means_something_is_harmless() {
        assert_eq!(
            escape("<a href=\"x\">'&\u{1}</a>"),
            "&lt;a href=&quot;x&quot;&gt;&#39;&amp;&lt;/a&gt;"
        );
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
}
