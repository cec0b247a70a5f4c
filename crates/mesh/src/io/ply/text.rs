//! The payload of a text PLY file.

use ply_rs_bw::ply::{ElementDef, PropertyType};

use super::Contents;
use super::header::{Header, is_corner_list};
use crate::io::error::Flaw;
use crate::io::text::{Lines, index, integer, number, shown, words};

/// Reads the payload, one line for each element; blank lines are passed over.
pub(super) fn read(header: &Header, lines: Lines<'_>) -> Result<Contents, Flaw> {
    let size = lines.rest().len();
    // The shortest lines are "0 0 0" and "3 0 1 2".
    let mut contents = Contents::with_capacity(header, size, 6, 8);
    let mut lines = lines.filter(|(_, line)| !line.trim_ascii().is_empty());
    let mut last = 0;
    let mut row = Row::default();
    for element in &header.elements {
        if element.properties.is_empty() {
            continue;
        }
        for seen in 0..element.count {
            let Some((line, content)) = lines.next() else {
                return Err(Flaw::line(
                    last,
                    format!(
                        "the file ends after {seen} of the {} elements {} its header declares",
                        element.count, element.name
                    ),
                ));
            };
            last = line;
            match element.name.as_str() {
                "vertex" => {
                    row.read(line, content, element)?;
                    contents.positions.push(row.position);
                }
                "face" => {
                    row.read(line, content, element)?;
                    contents.faces.push(&row.corners);
                }
                _ => {}
            }
        }
    }
    if let Some((line, content)) = lines.next() {
        return Err(Flaw::line(
            line,
            format!(
                "{} comes after all the elements that the header declares; correct its counts",
                shown(content)
            ),
        ));
    }
    Ok(contents)
}

/// The useful properties of one element.
#[derive(Default)]
struct Row {
    position: [f64; 3],
    corners: Vec<u32>,
}

impl Row {
    /// Reads the properties of `element` from `content`.
    fn read(&mut self, line: u64, content: &[u8], element: &ElementDef) -> Result<(), Flaw> {
        let mut words = words(content);
        for property in element.properties.values() {
            let name = property.name.as_str();
            let mut next = || {
                words.next().ok_or_else(|| {
                    Flaw::line(line, format!("the line ends before the property {name}"))
                })
            };
            let word = next()?;
            match property.data_type {
                PropertyType::Scalar(_) => match name {
                    "x" => self.position[0] = number(line, word)?,
                    "y" => self.position[1] = number(line, word)?,
                    "z" => self.position[2] = number(line, word)?,
                    _ => {}
                },
                PropertyType::List(..) => {
                    let count = integer(word).filter(|&n| n >= 0).ok_or_else(|| {
                        Flaw::line(line, format!("{} is no length of a list", shown(word)))
                    })?;
                    let wanted = is_corner_list(name);
                    if wanted {
                        self.corners.clear();
                    }
                    // Ends with the line, however large the number is.
                    for _ in 0..count {
                        let word = next()?;
                        if wanted {
                            self.corners.push(index(line, word)?);
                        }
                    }
                }
            }
        }
        match words.next() {
            None => Ok(()),
            Some(extra) => Err(Flaw::line(
                line,
                format!(
                    "{} follows the properties that the header declares for {}",
                    shown(extra),
                    element.name
                ),
            )),
        }
    }
}
