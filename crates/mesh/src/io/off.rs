//! OFF, the text format of Geomview.
//!
//! The keyword may have the prefixes `ST`, `C` and `N`: then texture coordinates, colours and
//! normals follow the position of a vertex. They are ignored, as are colours after the corners of a
//! face. The counts may be on the keyword's line. Each vertex and each face has a line, or all
//! words are separated by blanks and lines of any kind.

use super::error::Flaw;
use super::faces::{FaceList, FileMesh};
use super::text::{
    NumberedLines, Tokens, coordinates, index, integer, is_blank, number, shown, without_comment,
    words,
};

/// Reads an OFF file.
pub(super) fn read(bytes: &[u8]) -> Result<FileMesh, Flaw> {
    let mut lines = Content(NumberedLines::new(bytes));
    let all = Tokens::new(lines.0.clone(), true);
    // The format is free: numbers may extend over lines or share one. Most files have a line for
    // the counts, each vertex and each face, where numbers that follow are ignored.
    header(&mut lines)
        .and_then(|header| {
            let free = Tokens::new(lines.0.clone(), true);
            read_lines(bytes.len(), &header, lines)
                .or_else(|flaw| read_free(&header, free, false).map_err(|_| flaw))
        })
        .or_else(|flaw| {
            let plain = read_words(all.clone(), false);
            plain.or_else(|_| read_words(all, true)).map_err(|_| flaw)
        })
}

/// Reads a file whose keyword and counts are in any lines, too.
fn read_words(mut words: Tokens<'_>, coloured: bool) -> Result<FileMesh, Flaw> {
    let mut next = || -> Result<(u64, &[u8]), Flaw> {
        let ends = |line| Flaw::line(line, "the file ends before its counts");
        match words.next() {
            Some(word) => Ok((words.line(), word)),
            None => Err(ends(words.line())),
        }
    };
    let (line, first) = next()?;
    let (name, glued) = split_keyword(first);
    let keyword = keyword(line, name)?;
    let mut glued = Some(glued).filter(|digits| !digits.is_empty());
    let mut count = || -> Result<u64, Flaw> {
        let (line, word) = match glued.take() {
            Some(digits) => (line, digits),
            None => next()?,
        };
        let count = integer(word).and_then(|count| count.try_into().ok());
        count.ok_or_else(|| Flaw::line(line, format!("{} is no count", shown(word))))
    };
    if keyword.has_dimension && count()? != 3 {
        return Err(Flaw::line(line, "only points of 3 dimensions are read"));
    }
    let [vertices, faces, _edges] = [count()?, count()?, count()?];
    let header = OffHeader {
        vertices,
        faces,
        more: keyword.more,
        has_colours: keyword.has_colours,
    };
    read_free(&header, words, coloured)
}

/// Reads a line for each vertex and each face of a file of `size` bytes.
fn read_lines(size: usize, header: &OffHeader, mut lines: Content<'_>) -> Result<FileMesh, Flaw> {
    // A header cannot reserve more memory than the shortest lines, "0 0 0" and "3 0 1 2", allow.
    let most = |line_length| size / line_length + 1;
    let mut positions = Vec::with_capacity(most(6).min(header.vertices as usize));
    let is_plain = header.more == 0 && !header.has_colours;
    let mut first_follow = None;
    for read in 0..header.vertices {
        let (line, content) = lines.expect("vertices", read, header.vertices)?;
        let mut words = words(content);
        positions.push(coordinates(line, &mut words)?);
        // In plain OFF all lines of vertices have equally many numbers. Otherwise a blank has
        // split a number, or one is doubled.
        let follow = words.count();
        let usual = *first_follow.get_or_insert(follow);
        if is_plain && follow != usual {
            return Err(Flaw::line(
                line,
                format!(
                    "{} numbers are in the line of the vertex, and {} in that of the first one",
                    3 + follow,
                    3 + usual
                ),
            ));
        }
    }
    let mut faces = FaceList::with_capacity(most(8).min(header.faces as usize));
    let mut corners = Vec::new();
    for read in 0..header.faces {
        let (line, content) = lines.expect("faces", read, header.faces)?;
        face(line, content, &mut corners)?;
        faces.push(&corners);
    }
    if let Some((line, content)) = lines.next() {
        return Err(Flaw::line(
            line,
            format!(
                "{} comes after the {} faces that the header declares; correct the counts",
                shown(content),
                header.faces
            ),
        ));
    }
    Ok(FileMesh { positions, faces })
}

/// Reads the numbers of a file one after the other, whatever lines they are in. There must be as
/// many as the keyword and the counts say. Colours of vertices have four numbers, or three without
/// alpha. Faces have colours if they are `coloured`: the rest of the line after their last corner.
fn read_free(header: &OffHeader, tokens: Tokens<'_>, coloured: bool) -> Result<FileMesh, Flaw> {
    if !header.has_colours {
        return read_numbers(header, header.more, tokens, coloured);
    }
    let [with_alpha, without] =
        [4, 3].map(|size| read_numbers(header, header.more + size, tokens.clone(), coloured));
    match (with_alpha, without) {
        (Ok(_), Ok(_)) => Err(Flaw::file(
            "the colours of its vertices may have three numbers or four; write a line for each vertex",
        )),
        (Ok(mesh), Err(_)) | (Err(_), Ok(mesh)) => Ok(mesh),
        (Err(flaw), Err(_)) => Err(flaw),
    }
}

/// As [`read_free`], with `more` numbers behind the position of each vertex.
fn read_numbers(
    header: &OffHeader,
    more: usize,
    mut tokens: Tokens<'_>,
    coloured: bool,
) -> Result<FileMesh, Flaw> {
    /// Numbers of a colour: red, green, blue, alpha.
    const COLOUR: usize = 4;
    let mut mesh = FileMesh {
        positions: Vec::new(),
        faces: FaceList::default(),
    };
    for _ in 0..header.vertices {
        let position = coordinates(tokens.line(), &mut tokens)?;
        mesh.positions.push(position);
        for _ in 0..more {
            let word = tokens.next().unwrap_or_default();
            number(tokens.line(), word)?;
        }
    }
    let mut corners = Vec::new();
    for _ in 0..header.faces {
        let first = tokens.next().unwrap_or_default();
        let count = index(tokens.line(), first)?;
        if coloured && count < 3 {
            let problem = "colours are not told from faces of fewer than three corners";
            return Err(Flaw::line(tokens.line(), problem));
        }
        corners.clear();
        for _ in 0..count {
            let word = tokens.next().unwrap_or_default();
            corners.push(index(tokens.line(), word)?);
        }
        let mut numbers = 0;
        while coloured && let Some(word) = tokens.next_in_line() {
            number(tokens.line(), word)?;
            numbers += 1;
        }
        if numbers > COLOUR {
            let problem = format!("{numbers} numbers follow the face, too many for a colour");
            return Err(Flaw::line(tokens.line(), problem));
        }
        mesh.faces.push(&corners);
    }
    match tokens.next() {
        None => Ok(mesh),
        Some(word) => Err(Flaw::line(
            tokens.line(),
            format!("{} is one too many", shown(word)),
        )),
    }
}

/// What the lines before the vertices say.
struct OffHeader {
    vertices: u64,
    faces: u64,
    /// How many numbers of normals and texture coordinates follow the position of a vertex.
    more: usize,
    /// Whether a colour follows, too.
    has_colours: bool,
}

/// The number of vertices and of faces.
fn header(lines: &mut Content<'_>) -> Result<OffHeader, Flaw> {
    let (mut line, mut content) = lines
        .next()
        .ok_or_else(|| Flaw::file("there are only blank lines and comments in it"))?;
    let (first, _) = split_keyword(words(content).next().unwrap_or_default());
    let (mut more, mut has_colours) = (0, false);
    // A file without a keyword may start with its counts.
    if integer(first).is_none() {
        let keyword = keyword(line, first)?;
        (more, has_colours) = (keyword.more, keyword.has_colours);
        let rest = content.iter().skip_while(|b| b.is_ascii_whitespace());
        content = &content[content.len() - rest.count() + first.len()..];
        if words(content).next() == Some(b"BINARY") {
            return Err(Flaw::line(
                line,
                "binary OFF is not read; convert the file to text OFF or binary PLY",
            ));
        }
        if words(content).next().is_none() {
            (line, content) = lines
                .next()
                .ok_or_else(|| Flaw::line(line, "the file ends before its counts"))?;
        }
        if keyword.has_dimension {
            let mut words = words(content);
            let dimension = words.next().unwrap_or_default();
            if integer(dimension) != Some(3) {
                let problem = format!(
                    "its points have {} dimensions; only 3 are read",
                    shown(dimension)
                );
                return Err(Flaw::line(line, problem));
            }
            content = words.rest();
            if is_blank(content) {
                (line, content) = lines
                    .next()
                    .ok_or_else(|| Flaw::line(line, "the file ends before its counts"))?;
            }
        }
    }
    let counts: Vec<Option<u64>> = words(content)
        .map(|word| integer(word).and_then(|count| count.try_into().ok()))
        .collect();
    match counts[..] {
        [Some(vertices), Some(faces)] | [Some(vertices), Some(faces), Some(_)] => Ok(OffHeader {
            vertices,
            faces,
            more,
            has_colours,
        }),
        _ => Err(Flaw::line(
            line,
            format!(
                "{} does not say how many vertices, faces and edges there are",
                shown(content)
            ),
        )),
    }
}

/// The keyword of a word, and what follows: many files of `ModelNet` have no blank between keyword
/// and counts, as in `OFF490 518 0`.
fn split_keyword(word: &[u8]) -> (&[u8], &[u8]) {
    let is_glued = |w: &[u8]| w[0].eq_ignore_ascii_case(&b'f') && w[1].is_ascii_digit();
    let last = word.windows(2).position(is_glued);
    word.split_at(last.map_or(word.len(), |last| last + 1))
}

/// What the keyword says.
struct Keyword {
    /// As in [`OffHeader`].
    more: usize,
    has_colours: bool,
    /// Whether the number of dimensions follows.
    has_dimension: bool,
}

/// Reads the first word, which must be a keyword for three-dimensional points.
fn keyword(line: u64, word: &[u8]) -> Result<Keyword, Flaw> {
    let prefixes = word
        .strip_suffix(b"OFF")
        .or_else(|| word.strip_suffix(b"off"));
    let (prefixes, has_dimension) = match prefixes {
        Some([prefixes @ .., b'n']) => (Some(prefixes), true),
        _ => (prefixes, false),
    };
    match prefixes {
        Some(b"" | b"ST" | b"C" | b"N" | b"CN" | b"NC" | b"STC" | b"STN" | b"STCN" | b"STNC") => {
            let has = |letter| prefixes.is_some_and(|prefixes| prefixes.contains(&letter));
            Ok(Keyword {
                more: 2 * usize::from(has(b'T')) + 3 * usize::from(has(b'N')),
                has_colours: has(b'C'),
                has_dimension,
            })
        }
        Some([.., b'4']) => Err(Flaw::line(
            line,
            format!(
                "{} has points in four dimensions, which are not read",
                shown(word)
            ),
        )),
        _ => Err(Flaw::line(
            line,
            format!(
                "{} is not how an OFF file starts; expected OFF",
                shown(word)
            ),
        )),
    }
}

/// Reads the corners of the face in `content`. Colours may follow.
fn face(line: u64, content: &[u8], corners: &mut Vec<u32>) -> Result<(), Flaw> {
    let mut words = words(content);
    let first = words.next().unwrap_or_default();
    let count = integer(first)
        .filter(|&count| count >= 0)
        .ok_or_else(|| Flaw::line(line, format!("{} is no number of corners", shown(first))))?;
    corners.clear();
    for word in words {
        if corners.len() as i128 == count {
            break;
        }
        corners.push(index(line, word)?);
    }
    if (corners.len() as i128) < count {
        return Err(Flaw::line(
            line,
            format!(
                "the face is to have {count} corners, but only {} are there",
                corners.len()
            ),
        ));
    }
    Ok(())
}

/// The lines that are not blank and not comments.
struct Content<'a>(NumberedLines<'a>);

impl<'a> Iterator for Content<'a> {
    type Item = (u64, &'a [u8]);

    fn next(&mut self) -> Option<Self::Item> {
        self.0
            .by_ref()
            .map(|(number, line)| (number, without_comment(line).trim_ascii()))
            .find(|(_, line)| !is_blank(line))
    }
}

impl<'a> Content<'a> {
    /// The next line, which must exist. `read` of `count` things have been read.
    fn expect(&mut self, things: &str, read: u64, count: u64) -> Result<(u64, &'a [u8]), Flaw> {
        self.next().ok_or_else(|| {
            Flaw::line(
                self.0.number(),
                format!("the file ends after {read} of the {count} {things} it declares"),
            )
        })
    }
}
