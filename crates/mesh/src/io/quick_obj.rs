//! A fast path for OBJ files of triangles.
//!
//! It reads `v` statements of three numbers and `f` statements of three corners counted from the
//! start of the file, and skips lines of other statements. At anything else it returns `None`.
//! [`obj`](super::obj) then reads the whole file and names the line that is wrong. In a thread
//! pool, pieces of the file are read in parallel.

use std::ops::Range;

use crate::threads;

type Statements = (Vec<[f64; 3]>, Vec<[u32; 3]>);

/// Positions and triangles; `None` if a line needs the full reader.
pub(super) fn read(bytes: &[u8]) -> Option<Statements> {
    let pieces = threads::each(whole_lines(bytes), |range| piece(&bytes[range]));
    let mut pieces = pieces.into_iter();
    let (mut positions, mut triangles) = pieces.next()??;
    for piece in pieces {
        let (more_positions, more_triangles) = piece?;
        positions.extend(more_positions);
        triangles.extend(more_triangles);
    }
    Some((positions, triangles))
}

/// Parts of `bytes` for threads, each of whole lines.
fn whole_lines(bytes: &[u8]) -> Vec<Range<usize>> {
    let mut start = 0;
    let mut parts = Vec::new();
    for range in threads::ranges(bytes.len(), 1) {
        let rest = &bytes[range.end.max(start)..];
        let line = rest
            .iter()
            .position(|&b| b == b'\n')
            .map_or(rest.len(), |end| end + 1);
        let end = if range.end == bytes.len() {
            range.end
        } else {
            range.end.max(start) + line
        };
        parts.push(start..end);
        start = end;
    }
    parts
}

fn piece(bytes: &[u8]) -> Option<Statements> {
    let (mut positions, mut triangles) = (Vec::new(), Vec::new());
    let mut rest = bytes;
    while let Some(&first) = rest.first() {
        match (first, rest.get(1)) {
            (b'v', Some(b' ' | b'\t')) => {
                rest = &rest[1..];
                positions.push([number(&mut rest)?, number(&mut rest)?, number(&mut rest)?]);
                end_line(&mut rest)?;
            }
            (b'f', Some(b' ' | b'\t')) => {
                rest = &rest[1..];
                triangles.push([corner(&mut rest)?, corner(&mut rest)?, corner(&mut rest)?]);
                end_line(&mut rest)?;
            }
            // `v` or `f` followed by something unusual, and what may be `fo` or `call`: left to the
            // full reader.
            (b'v' | b'f', second) if !second.is_some_and(u8::is_ascii_lowercase) => return None,
            (b'f', Some(b'o')) | (b'c', Some(b'a')) => return None,
            (b'a'..=b'z' | b'#' | b'\n' | b'\r', _) => {
                let end = rest.iter().position(|&b| b == b'\n').unwrap_or(rest.len());
                let (line, next) = rest.split_at(end);
                // A line with a continuation, or one that ends with CR alone.
                let line = line.strip_suffix(b"\r").unwrap_or(line);
                let continues = line.trim_ascii_end().ends_with(b"\\");
                if continues || line.contains(&b'\r') {
                    return None;
                }
                rest = next.get(1..).unwrap_or_default();
            }
            _ => return None,
        }
    }
    Some((positions, triangles))
}

fn skip_blanks(rest: &mut &[u8]) {
    while let [b' ' | b'\t', next @ ..] = *rest {
        *rest = next;
    }
}

/// Consumes the end of a line or of the file.
fn end_line(rest: &mut &[u8]) -> Option<()> {
    skip_blanks(rest);
    *rest = match *rest {
        [b'\n', next @ ..] | [b'\r', b'\n', next @ ..] => next,
        [] => &[],
        _ => return None,
    };
    Some(())
}

/// The vertex of the next corner, counted from 0.
fn corner(rest: &mut &[u8]) -> Option<u32> {
    skip_blanks(rest);
    let mut vertex = 0u32;
    let mut digits = 0;
    while let [digit @ b'0'..=b'9', next @ ..] = *rest {
        vertex = vertex
            .wrapping_mul(10)
            .wrapping_add(u32::from(digit - b'0'));
        digits += 1;
        *rest = next;
    }
    if let [b'/', ..] = *rest {
        while let [b'0'..=b'9' | b'/', next @ ..] = *rest {
            *rest = next;
        }
    }
    let ends = matches!(*rest, [] | [b' ' | b'\t' | b'\n' | b'\r', ..]);
    // Nine digits fit into 32 bits.
    (ends && digits <= 9).then(|| vertex.checked_sub(1))?
}

/// Powers of ten that `f64` represents exactly.
const POWERS: [f64; 23] = [
    1e0, 1e1, 1e2, 1e3, 1e4, 1e5, 1e6, 1e7, 1e8, 1e9, 1e10, 1e11, 1e12, 1e13, 1e14, 1e15, 1e16,
    1e17, 1e18, 1e19, 1e20, 1e21, 1e22,
];

/// The next number, correctly rounded. If `f64` represents both the digits and the power of ten
/// exactly, their quotient is correctly rounded. The standard library parses all others.
fn number(rest: &mut &[u8]) -> Option<f64> {
    skip_blanks(rest);
    let start = *rest;
    let negative = start.first() == Some(&b'-');
    *rest = &start[usize::from(negative)..];
    let mut digits = 0;
    let mut mantissa = take_digits(rest, 0, &mut digits);
    let mut scale = 0;
    if let [b'.', next @ ..] = *rest {
        *rest = next;
        let whole = digits;
        mantissa = take_digits(rest, mantissa, &mut digits);
        scale = digits - whole;
    }
    let is_end = |rest: &[u8]| matches!(rest, [] | [b' ' | b'\t' | b'\n' | b'\r', ..]);
    // Up to 18 digits fit into 64 bits.
    if is_end(rest) && (1..=18).contains(&digits) && mantissa < 1 << 53 {
        let value = mantissa as f64 / POWERS[scale];
        return Some(if negative { -value } else { value });
    }
    while !is_end(rest) {
        *rest = &rest[1..];
    }
    let word = &start[..start.len() - rest.len()];
    std::str::from_utf8(word).ok()?.parse().ok()
}

/// Consumes the digits at the start of `rest`. `mantissa` is the value of the `digits` so far.
fn take_digits(rest: &mut &[u8], mut mantissa: u64, digits: &mut usize) -> u64 {
    while let Some(eight) = rest.first_chunk().and_then(|&chunk| eight_digits(chunk)) {
        mantissa = mantissa.wrapping_mul(100_000_000).wrapping_add(eight);
        *digits += 8;
        *rest = &rest[8..];
    }
    while let [digit @ b'0'..=b'9', next @ ..] = *rest {
        mantissa = mantissa
            .wrapping_mul(10)
            .wrapping_add(u64::from(digit - b'0'));
        *digits += 1;
        *rest = next;
    }
    mantissa
}

/// The value of eight digits, computed at once: three steps join neighbouring groups.
fn eight_digits(chunk: [u8; 8]) -> Option<u64> {
    let word = u64::from_le_bytes(chunk);
    let digits = word ^ 0x3030_3030_3030_3030;
    let too_high = digits.wrapping_add(0x7676_7676_7676_7676) | digits;
    if too_high & 0x8080_8080_8080_8080 != 0 {
        return None;
    }
    let pairs = digits.wrapping_mul(10).wrapping_add(digits >> 8) & 0x00ff_00ff_00ff_00ff;
    let fours = pairs.wrapping_mul(100).wrapping_add(pairs >> 16) & 0x0000_ffff_0000_ffff;
    Some(fours.wrapping_mul(10_000).wrapping_add(fours >> 32) & 0xffff_ffff)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::SplitMix64;

    #[test]
    fn numbers_are_those_of_the_standard_library() {
        let mut random = SplitMix64::new(5);
        let mut words: Vec<String> = [
            "0",
            "-0",
            "1.",
            ".5",
            "-.25",
            "1e5",
            "+3",
            "00012.5000",
            "inf",
            "1E-400",
        ]
        .map(str::to_owned)
        .into();
        for _ in 0..20_000 {
            let x = f64::from_bits(random.next() >> 1);
            let unit = random.unit() - 0.5;
            words.extend([
                format!("{x:e}"),
                unit.to_string(),
                format!("{unit:.9}"),
                format!("{unit:.25}"),
            ]);
            words.push(format!(
                "{}.{:08}",
                random.below(100_000),
                random.below(100_000_000)
            ));
        }
        for word in words {
            for after in ["", " 1", "\n", "\r\n"] {
                let line = format!("  {word}{after}");
                let mut rest = line.as_bytes();
                let found = number(&mut rest).map(f64::to_bits);
                assert_eq!(found, word.parse().ok().map(f64::to_bits), "{word}");
                assert_eq!(rest, after.as_bytes());
            }
        }
        for word in ["", ".", "-", "1,5", "1.5.2", "0x10", "--1", "1e", "\u{661}"] {
            assert_eq!(number(&mut word.as_bytes()), None, "{word}");
        }
    }

    #[test]
    fn other_statements_are_passed_over_and_odd_ones_refused() {
        let start = "# a\nmtllib x\nv 0 0 0\r\nvn 1 0 0\nv\t1  0 0 \nv 0 1 0\n\n";
        let found = read(format!("{start}f 1/1/1 2//2 3 \ng x").as_bytes()).unwrap();
        assert_eq!((found.0.len(), found.1), (3, vec![[0, 1, 2]]));
        let odd = [
            "f 1 2 -1",
            "f 1 2 3 1",
            "f 1 2",
            "f 0 1 2",
            "f 1 2 1234567890",
            "f 1 2 3#",
            "v 1 2",
            "v 1 2 3 1",
            "v 1 2 x",
            "g a\\\nb",
            "g a\rv 1 2 3",
            " v 1 2 3",
            "f 1 2 3\\\n",
            "F 1 2 3",
            "f 1/x 2 3",
            "f /1 2 3",
            "f",
            "v",
            "f#",
            "v#1 2 3",
            "fo 1 2 3",
            "call a.obj",
        ];
        for line in odd {
            assert!(
                read(format!("{start}{line}\n").as_bytes()).is_none(),
                "{line}"
            );
        }
    }

    #[test]
    fn pieces_are_whole_lines() {
        let line = |i| format!("v {i} 0.5 -1\nf 1 2 3\n");
        let text = (0..30_000).map(line).collect::<Vec<_>>().concat();
        let alone = read(text.as_bytes()).unwrap();
        for threads in [2, 3, 7] {
            let pool = rayon::ThreadPoolBuilder::new()
                .num_threads(threads)
                .build()
                .unwrap();
            assert_eq!(pool.install(|| read(text.as_bytes())).unwrap(), alone);
        }
    }
}
