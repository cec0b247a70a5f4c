//! Compressed files and archives that are not read. Messages name them and say how to unpack them.

use std::path::Path;

use super::Format;

/// A form of compression or archive.
struct Packing {
    name: &'static str,
    ending: &'static str,
    /// The first bytes of such files.
    start: &'static [u8],
    /// The program that unpacks it.
    command: &'static str,
}

const fn packing(
    name: &'static str,
    ending: &'static str,
    start: &'static [u8],
    command: &'static str,
) -> Packing {
    Packing {
        name,
        ending,
        start,
        command,
    }
}

const PACKINGS: [Packing; 6] = [
    packing("xz", "xz", b"\xfd7zXZ\0", "xz -d"),
    packing("bzip2", "bz2", b"BZh", "bzip2 -d"),
    packing("Zstandard", "zst", b"\x28\xb5\x2f\xfd", "zstd -d"),
    packing("LZ4", "lz4", b"\x04\x22\x4d\x18", "lz4 -d"),
    packing("ZIP", "zip", b"PK\x03\x04", "unzip"),
    packing("7-Zip", "7z", b"7z\xbc\xaf\x27\x1c", "7z x"),
];

impl Packing {
    fn problem(&self) -> String {
        let Self { name, command, .. } = self;
        format!(
            "it is compressed by {name}, which is not read; unpack it first ({command}), or compress \
             it with gzip"
        )
    }
}

/// The problem of a file name in words: the ending of a form of compression that is not read
/// follows that of a mesh. `None` for other names.
pub(super) fn problem_of_name(path: &Path) -> Option<String> {
    let ending = path.extension()?.to_str()?;
    Format::from_path(path.file_stem()?.as_ref())?;
    let mut all = PACKINGS.iter();
    let found = all.find(|packing| packing.ending.eq_ignore_ascii_case(ending));
    found.map(Packing::problem)
}

/// The problem of the `bytes` of a file in a `format` in words; `None` if they are not compressed
/// in one of these forms.
pub(super) fn problem_of_content(bytes: &[u8], format: Format) -> Option<String> {
    let mut all = PACKINGS.iter();
    let found = all.find(|packing| bytes.starts_with(packing.start));
    // 3MF files are ZIP archives, also those with another ending.
    let is_3mf = || {
        let name = b"3dmodel";
        format == Format::ThreeMf || bytes.windows(name.len()).any(|part| part == name)
    };
    let found = found.filter(|packing| packing.name != "ZIP" || !is_3mf());
    found.map(Packing::problem)
}
