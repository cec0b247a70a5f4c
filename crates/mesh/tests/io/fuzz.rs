//! Damaged files: any answer will do, but there must be one.

use std::path::Path;

use geobench_mesh::io::{Format, read_bytes};
use proptest::prelude::*;

use crate::{gzip, samples};

const FORMATS: [Format; 4] = [Format::Obj, Format::Ply, Format::Off, Format::Stl];

/// One way to damage a file.
#[derive(Clone, Debug)]
enum Damage {
    /// Overwrite a byte.
    Set(usize, u8),
    /// Cut something out.
    Remove(usize, usize),
    /// Put something in that readers are likely to stumble over.
    Insert(usize, &'static [u8]),
    /// Say a part twice.
    Repeat(usize, usize),
    /// Drop the end.
    Cut(usize),
}

fn damages() -> impl Strategy<Value = Damage> {
    const STONES: [&[u8]; 16] = [
        b"\n",
        b" ",
        b"-",
        b"/",
        b"\\\n",
        b"#",
        b"\0",
        b"\xff",
        b"0",
        b"4294967296",
        b"1e999",
        b" -9223372036854775808 ",
        b" 170141183460469231731687303715884105728 ",
        b"\nf 1 2 3 4 5 6\n",
        b"\nend_header\n",
        b"\nsolid\n",
    ];
    prop_oneof![
        (any::<usize>(), any::<u8>()).prop_map(|(i, b)| Damage::Set(i, b)),
        (any::<usize>(), 1..30usize).prop_map(|(i, n)| Damage::Remove(i, n)),
        (any::<usize>(), prop::sample::select(&STONES[..])).prop_map(|(i, s)| Damage::Insert(i, s)),
        (any::<usize>(), 1..60usize).prop_map(|(i, n)| Damage::Repeat(i, n)),
        any::<usize>().prop_map(Damage::Cut),
    ]
}

fn damage(bytes: &mut Vec<u8>, damage: &Damage) {
    let len = bytes.len();
    if len == 0 {
        return;
    }
    match *damage {
        Damage::Set(i, b) => bytes[i % len] = b,
        Damage::Remove(i, n) => {
            let i = i % len;
            bytes.drain(i..len.min(i + n));
        }
        Damage::Insert(i, stone) => {
            let i = i % len;
            bytes.splice(i..i, stone.iter().copied());
        }
        Damage::Repeat(i, n) => {
            let i = i % len;
            let part = bytes[i..len.min(i + n)].to_vec();
            bytes.splice(i..i, part);
        }
        Damage::Cut(i) => bytes.truncate(i % len),
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(2_000))]

    #[test]
    fn damaged_files_do_not_panic(
        sample in 0..7usize,
        list in prop::collection::vec(damages(), 1..6),
        packed in prop::bool::weighted(0.1),
    ) {
        let (_, format, mut bytes) = samples::all().swap_remove(sample);
        if packed {
            bytes = gzip(&bytes);
        }
        for d in &list {
            damage(&mut bytes, d);
        }
        if let Ok(soup) = read_bytes(&bytes, format, Path::new("test")) {
            // A soup never grows beyond what the file could have spelt out.
            prop_assert!(soup.positions.len() + soup.triangles.len() <= 2 * bytes.len() + 1000);
            prop_assert!(soup.file_faces.is_empty() || soup.file_faces.len() == soup.triangles.len());
        }
    }

    #[test]
    fn noise_does_not_panic(bytes in prop::collection::vec(any::<u8>(), 0..300)) {
        for format in FORMATS {
            let _ = read_bytes(&bytes, format, Path::new("test"));
        }
    }
}
