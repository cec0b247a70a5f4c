//! Files of sources, targets and pairs.

use std::fmt::Display;
use std::path::Path;
use std::str::FromStr;

use anyhow::{anyhow, bail};

use crate::exec::point::PointSpec;
use crate::exec::source::SourceSpec;
use crate::usage::first_field;

/// The lines of a file without comments and empty lines, each with its place in the file; and
/// whether they follow the header of a table, whose first field is one of `heads`. Text from `#` to
/// the end of a line is a comment.
fn lines<'t>(path: &Path, text: &'t str, heads: &[&str]) -> (bool, Vec<(&'t str, String)>) {
    let shown = path.display();
    let lines = (1..).zip(text.lines()).filter_map(|(number, line)| {
        let line = line.split('#').next().unwrap_or_default().trim();
        (!line.is_empty()).then(|| (line, format!("{shown}, line {number}")))
    });
    let mut lines: Vec<_> = lines.collect();
    let is_table = lines.first().is_some_and(|(line, _)| {
        let (field, _) = first_field(line);
        heads.iter().any(|head| field.eq_ignore_ascii_case(head))
    });
    if is_table {
        lines.remove(0);
    }
    (is_table, lines)
}

/// Parses the points in `text`, the content of the file `path`; returns each with its line. A line
/// has one point, in quotes or not. Behind the header of a table, `noun` or `vertex`, it is the
/// first field of each line. `noun` is what the points are: `source` or `target`.
///
/// # Errors
///
/// Names the first line that is not a point, or the file if it has no point.
pub(crate) fn points_in<T: FromStr<Err: Display>>(
    path: &Path,
    text: &str,
    noun: &str,
) -> anyhow::Result<Vec<(T, String)>> {
    let (is_table, lines) = lines(path, text, &[noun, "vertex"]);
    if lines.is_empty() {
        bail!(
            "{}: there is no {noun} in it; write one in each line",
            path.display()
        );
    }
    let point = |(line, place): (&str, String)| {
        let (field, rest) = first_field(line);
        let point = if is_table || rest.is_none() {
            &*field
        } else {
            line
        };
        match point.parse() {
            Ok(point) => Ok((point, place)),
            Err(error) => Err(anyhow!("{place}: {error}")),
        }
    };
    lines.into_iter().map(point).collect()
}

/// Two points of a line of a file, and the place of the line.
pub type Pair = ([PointSpec; 2], String);

/// Parses the pairs in `text`, the content of the file `path`. A line has two points, separated by
/// a comma or spaces; a point with commas may be in quotes. Behind the header of a table that
/// begins with `source`, the points are the first two fields of each line.
///
/// # Errors
///
/// Names the first line that is not a pair, or the file if it has none.
pub fn pairs_in(path: &Path, text: &str) -> anyhow::Result<Vec<Pair>> {
    let (is_table, lines) = lines(path, text, &["source"]);
    if lines.is_empty() {
        bail!(
            "{}: there is no pair in it; write two points in each line",
            path.display()
        );
    }
    let pair = |(line, place): (&str, String)| {
        let points = if is_table || line.contains('"') {
            let (first, rest) = first_field(line);
            let (second, _) = first_field(rest.unwrap_or_default());
            format!("{first},{second}")
        } else {
            let words = line.split(|c: char| c == ',' || c.is_whitespace());
            let words: Vec<&str> = words.filter(|word| !word.is_empty()).collect();
            words.join(",")
        };
        let points: SourceSpec = points
            .parse()
            .map_err(|error| anyhow!("{place}: {error}"))?;
        match points.single_points().as_deref() {
            Some(&[from, to]) => Ok(([from, to], place)),
            _ => Err(anyhow!(
                "{place}: a pair is two points, such as `0,17` or `0,\"face:3,0.2,0.3,0.5\"`"
            )),
        }
    };
    lines.into_iter().map(pair).collect()
}

/// Parses the points of a curve in `text`, the content of the file `path`: one in each line, in
/// order, each with its place in the file.
///
/// # Errors
///
/// Names the first line that is not one point, or the file if it has none.
pub fn curve_in(path: &Path, text: &str) -> anyhow::Result<Vec<(PointSpec, String)>> {
    let all = points_in::<SourceSpec>(path, text, "point")?.into_iter();
    all.map(|(points, place)| match points.single_points().as_deref() {
        Some(&[point]) => Ok((point, place)),
        _ => Err(anyhow!(
            "{place}: a line of a curve has one point, such as `17` or `face:3,0.2,0.3,0.5`"
        )),
    })
    .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::exec::source::TargetSpec;

    #[test]
    fn a_line_that_is_no_target_is_named() {
        let read = |text: &str| points_in::<TargetSpec>(Path::new("t.txt"), text, "target");
        let all = read("# a comment\n\n 17 # another\nface:0,1,0,0\n").unwrap();
        assert_eq!(all[1].1, "t.txt, line 4");
        let all = read("target,distance\n\"face:0,0.5,0.5,0\",2.5\n1,inf\n").unwrap();
        let all: Vec<String> = all.iter().map(|(target, _)| target.to_string()).collect();
        assert_eq!(all, ["face:0,0.5,0.5,0", "1"]);
        let all = read("\"17\"\n0,3\n").unwrap();
        let all: Vec<String> = all.iter().map(|(target, _)| target.to_string()).collect();
        assert_eq!(all, ["17", "0,3"]);
        let error = read(&"9".repeat(1 << 20)).unwrap_err().to_string();
        assert!(error.len() < 500, "{} bytes", error.len());
        let error = read("1\nx\n").unwrap_err().to_string();
        assert!(error.starts_with("t.txt, line 2: `x` is not a target"));
        for nothing in ["# nothing\n", "target,distance\n"] {
            let error = read(nothing).unwrap_err().to_string();
            assert!(error.starts_with("t.txt: there is no target in it"));
        }
        // Its first field is the source of a pair.
        assert!(read("source,target\n1,2\n").is_err());
    }

    #[test]
    fn a_curve_has_one_point_in_each_line() {
        let read = |text: &str| curve_in(Path::new("c.txt"), text);
        let all = read("# a loop\n0\nedge:0-1,0.5\n\n0\n").unwrap();
        let points = [0, 1, 0].map(|i| match i {
            0 => PointSpec::Vertex(0),
            _ => PointSpec::Edge([0, 1], 0.5),
        });
        assert_eq!(
            all.iter().map(|(point, _)| *point).collect::<Vec<_>>(),
            points
        );
        assert_eq!(all[2].1, "c.txt, line 5");
        for line in ["0,1", "random:1", "all"] {
            let error = read(line).unwrap_err().to_string();
            assert!(
                error.starts_with("c.txt, line 1: a line of a curve"),
                "{error}"
            );
        }
        assert!(
            read("")
                .unwrap_err()
                .to_string()
                .starts_with("c.txt: there is no point")
        );
    }

    #[test]
    fn a_pair_is_two_points() {
        let read = |text: &str| pairs_in(Path::new("p.csv"), text);
        let lines = "0,17\n0 17\n0,\t17\nsource , ignored\n";
        let error = read(lines).unwrap_err().to_string();
        assert!(error.starts_with("p.csv, line 4: "), "{error}");
        let text = "source,target,distance\n\"at:1,2,3\",0,2.5\nat:1,2,3\n";
        let error = read(text).unwrap_err().to_string();
        assert!(error.starts_with("p.csv, line 3: "), "{error}");
        let at = PointSpec::At([1.0, 2.0, 3.0]);
        let seven = PointSpec::Vertex(7);
        for line in [
            "at:1,2,3 7",
            "at:1,2,3,7",
            "\"at:1,2,3\",7",
            "\"at:1,2,3\", \"7\"",
            "at:1, 2, 3  7 # a comment",
            "source,target\n\"at:1,2,3\",7,0.5",
        ] {
            assert_eq!(read(line).unwrap()[0].0, [at, seven], "{line}");
        }
        assert_eq!(read("7,7").unwrap()[0].0, [seven, seven]);
        for line in ["7", "7,7,7", "all", "0,random:2", "\"7\""] {
            assert!(read(line).is_err(), "{line}");
        }
        let error = read("source,target\n").unwrap_err().to_string();
        assert!(error.starts_with("p.csv: there is no pair in it"));
    }
}
