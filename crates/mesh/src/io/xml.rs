//! XML documents: their elements, numbers in them, and places for messages.

use std::borrow::Cow;
use std::collections::HashSet;
use std::str::FromStr;

use roxmltree::{Document, Node, ParsingOptions};

use super::error::Flaw;
use super::is_utf16;
use super::text::shown;

/// `bytes` as text, which is UTF-8 or UTF-16. Bytes that are neither, which only names have, are
/// replaced.
pub(super) fn text(bytes: &[u8]) -> Cow<'_, str> {
    if is_utf16(bytes) {
        let is_big = matches!(bytes, [0 | 0xfe, ..]);
        let of = if is_big {
            u16::from_be_bytes
        } else {
            u16::from_le_bytes
        };
        let units: Vec<u16> = bytes.as_chunks().0.iter().map(|&pair| of(pair)).collect();
        let text = String::from_utf16_lossy(&units);
        return match text.strip_prefix('\u{feff}') {
            Some(rest) => rest.to_owned().into(),
            None => text.into(),
        };
    }
    String::from_utf8_lossy(bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes))
}

/// The most attributes of an element. The parser compares each name with all others.
const MOST_ATTRIBUTES: usize = 1000;

/// The most prefixes of names in a document. For each element that declares one, the parser
/// compares all that are declared around it.
const MOST_PREFIXES: usize = 100;

/// The elements of a document. Definitions of entities, by which a small file can become a large
/// text, are refused: no format of meshes needs them.
pub(super) fn parse(text: &str) -> Result<Document<'_>, Flaw> {
    if text.contains("<!ENTITY") {
        return Err(Flaw::file(
            "it defines entities, which are not read; write them out",
        ));
    }
    let is_value = |rest: &&str| rest.trim_start().starts_with(['"', '\'']);
    let count = |part: &str| part.split('=').skip(1).filter(is_value).count();
    if text.split('<').any(|part| count(part) > MOST_ATTRIBUTES) {
        return Err(Flaw::file(format!(
            "an element has more than {MOST_ATTRIBUTES} attributes, which no format of meshes needs"
        )));
    }
    let mut prefixes = HashSet::new();
    for rest in text.split("xmlns:").skip(1) {
        prefixes.insert(rest.split('=').next().unwrap_or_default().trim_end());
        if prefixes.len() > MOST_PREFIXES {
            return Err(Flaw::file(format!(
                "its names have more than {MOST_PREFIXES} prefixes, which no format of meshes needs"
            )));
        }
    }
    let options = ParsingOptions {
        allow_dtd: true,
        ..ParsingOptions::default()
    };
    Document::parse_with_options(text, options).map_err(|error| {
        let place = error.pos();
        Flaw::line(place.row.into(), format!("this is no valid XML: {error}"))
    })
}

/// An error in an element.
pub(super) fn flaw(node: Node<'_, '_>, problem: impl std::fmt::Display) -> Flaw {
    let place = node.document().text_pos_at(node.range().start);
    let name = node.tag_name().name();
    let mut keys = ["id", "Name", "name"].into_iter();
    let id = keys.find_map(|key| node.attribute(key));
    let id = id.map_or_else(String::new, |id| format!(" {}", shown(id.as_bytes())));
    Flaw::line(place.row.into(), format!("<{name}>{id}: {problem}"))
}

/// The children of an element with this name, whatever their namespace.
pub(super) fn children<'a, 'd: 'a>(
    node: Node<'a, 'd>,
    name: &'static str,
) -> impl Iterator<Item = Node<'a, 'd>> {
    node.children()
        .filter(move |child| child.is_element() && child.tag_name().name() == name)
}

/// The first child with this name.
pub(super) fn child<'a, 'd: 'a>(node: Node<'a, 'd>, name: &'static str) -> Option<Node<'a, 'd>> {
    children(node, name).next()
}

/// All elements below one with this name.
pub(super) fn descendants<'a, 'd: 'a>(
    node: Node<'a, 'd>,
    name: &'static str,
) -> impl Iterator<Item = Node<'a, 'd>> {
    node.descendants()
        .filter(move |child| child.is_element() && child.tag_name().name() == name)
}

/// The text of an element, without that of elements within it.
pub(super) fn content<'a>(node: Node<'a, '_>) -> Cow<'a, str> {
    let mut texts = node.children().filter(Node::is_text);
    let first = texts
        .next()
        .and_then(|text| text.text())
        .unwrap_or_default();
    let mut all = Cow::Borrowed(first);
    for more in texts {
        all.to_mut().push_str(more.text().unwrap_or_default());
    }
    all
}

/// The numbers that the text of an element consists of.
pub(super) fn numbers<T: FromStr>(node: Node<'_, '_>) -> Result<Vec<T>, Flaw> {
    let text = content(node);
    let words = text
        .split_ascii_whitespace()
        .map(|word| (word, word.parse()));
    words
        .map(|(word, number)| {
            number.map_err(|_| {
                let is_number = word.parse::<f64>().is_ok();
                let kind = if is_number {
                    "whole number from 0"
                } else {
                    "number"
                };
                flaw(node, format!("{} is not a {kind}", shown(word.as_bytes())))
            })
        })
        .collect()
}

/// The value of an attribute; `None` if it is missing.
pub(super) fn attribute<T: FromStr>(node: Node<'_, '_>, name: &str) -> Result<Option<T>, Flaw> {
    let Some(text) = node.attribute(name) else {
        return Ok(None);
    };
    text.trim().parse().map(Some).map_err(|_| {
        let text = shown(text.as_bytes());
        flaw(node, format!("{name}={text} is not a number of its kind"))
    })
}

/// The value of an attribute that must be there.
pub(super) fn needed<T: FromStr>(node: Node<'_, '_>, name: &str) -> Result<T, Flaw> {
    attribute(node, name)?.ok_or_else(|| flaw(node, format!("the attribute {name} is missing")))
}
