//! Triangle surfaces of `FreeSurfer` (`lh.white`, `rh.pial`, ...): big-endian, one or two lines of
//! text before the counts. What follows the faces is ignored, as is the shift to scanner
//! coordinates.

use super::error::{FilePosition, Flaw};
use super::faces::{FaceList, FileMesh};

/// The bytes at the start of triangle surfaces, and of those with quadrangles.
pub(super) const TRIANGLES: [u8; 3] = [0xff, 0xff, 0xfe];
const QUADRANGLES: [[u8; 3]; 2] = [[0xff, 0xff, 0xff], [0xff, 0xff, 0xfd]];

/// Reads a triangle surface.
pub(super) fn read(bytes: &[u8]) -> Result<FileMesh, Flaw> {
    if QUADRANGLES.iter().any(|magic| bytes.starts_with(magic)) {
        return Err(Flaw::file(
            "this is the old form with quadrangles; save it as triangles (mris_convert)",
        ));
    }
    let rest = bytes.strip_prefix(&TRIANGLES).ok_or_else(|| {
        Flaw::file("this is no triangle surface of FreeSurfer, which starts with ff ff fe")
    })?;
    let words = |bytes: &[u8]| -> Vec<[u8; 4]> { bytes.as_chunks().0.to_vec() };
    let counts_of = |bytes: &[u8]| [0, 1].map(|i| u32::from_be_bytes(words(bytes)[i]) as usize);
    let after_line = |line: usize| {
        let mut ends = rest.iter().enumerate().filter(|(_, byte)| **byte == b'\n');
        let (end, _) = ends.nth(line)?;
        rest[end + 1..].split_at_checked(8)
    };
    // The second line is usually empty, and FreeSurfer reads files without it, too. As the first
    // byte of a count its line end would stand for more than 100 million.
    let is_whole = |(counts, data): &(&[u8], &[u8])| {
        let [vertices, faces] = counts_of(counts);
        vertices > 0 && 12 * (vertices + faces) <= data.len()
    };
    let header = after_line(0).filter(is_whole).or_else(|| after_line(1));
    let (counts, data) =
        header.ok_or_else(|| Flaw::file("the file ends within its header; fetch it again"))?;
    let [vertices, faces] = counts_of(counts);
    let part = |kind, from: usize, count: usize| {
        // Twelve bytes each.
        data.get(12 * from..12 * (from + count)).ok_or_else(|| {
            let place = FilePosition::Element {
                kind,
                number: (data.len() / 12).saturating_sub(from) as u64,
                byte: bytes.len() as u64,
            };
            let problem = format!("the file ends before it, of {count}; fetch it again");
            Flaw::at(place, problem)
        })
    };
    let positions = words(part("vertex", 0, vertices)?);
    let corners = words(part("face", vertices, faces)?);
    let positions: Vec<f64> = positions
        .into_iter()
        .map(|b| f32::from_be_bytes(b).into())
        .collect();
    let corners: Vec<u32> = corners.into_iter().map(u32::from_be_bytes).collect();
    Ok(FileMesh {
        positions: positions.as_chunks().0.to_vec(),
        faces: FaceList::of(corners.as_chunks().0.to_vec()),
    })
}
