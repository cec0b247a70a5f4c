//! Ways to damage a file, for every reader of the workspace.

use proptest::prelude::*;

/// One way to damage a file.
#[derive(Clone, Debug)]
pub(crate) enum Damage {
    /// Overwrite a byte.
    Set(usize, u8),
    /// Overwrite several bytes, as many as a binary number has.
    Number(usize, Vec<u8>),
    /// Replace the digits of a number in a text.
    Digits(usize, &'static [u8]),
    /// Cut something out.
    Remove(usize, usize),
    /// Put something in that readers are likely to stumble over.
    Insert(usize, &'static [u8]),
    /// Say a part twice.
    Repeat(usize, usize),
    /// Put a part in another place.
    Copy(usize, usize, usize),
    /// Drop the end.
    Cut(usize),
}

const STONES: [&[u8]; 28] = [
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
    b"\"",
    b"null",
    b"{",
    b"]",
    b",",
    b"[[group]]\n",
    b"\xe2\x80\xae",
    b"\\u0000",
    b"=",
    b"'",
    b"gen:cube,n=4294967295",
    b"\x1f\x8b\x08",
];

const DIGITS: [&[u8]; 16] = [
    b"0",
    b"1",
    b"-1",
    b"3",
    b"255",
    b"256",
    b"65536",
    b"2147483648",
    b"4294967295",
    b"9007199254740993",
    b"18446744073709551615",
    b"1e308",
    b"-1e308",
    b"1e-320",
    b"null",
    b"nan",
];

/// All ways, those that keep most of the file in order more often.
pub(crate) fn damages() -> impl Strategy<Value = Damage> {
    let place = || any::<usize>();
    let binary = prop_oneof![
        prop::sample::select(vec![0u32, 1, 255, 0x7fff_ffff, 0x8000_0000, u32::MAX])
            .prop_map(|n| n.to_le_bytes().to_vec()),
        prop::sample::select(vec![f32::NAN, f32::INFINITY, f32::MAX, f32::MIN_POSITIVE])
            .prop_map(|x| x.to_le_bytes().to_vec()),
        prop::sample::select(vec![f64::NAN, f64::INFINITY, -f64::MAX, 5e-324])
            .prop_map(|x| x.to_le_bytes().to_vec()),
        Just(vec![0xff; 2]),
    ];
    prop_oneof![
        3 => (place(), any::<u8>()).prop_map(|(i, b)| Damage::Set(i, b)),
        2 => (place(), binary).prop_map(|(i, b)| Damage::Number(i, b)),
        6 => (place(), prop::sample::select(&DIGITS[..])).prop_map(|(i, d)| Damage::Digits(i, d)),
        2 => (place(), 1..30usize).prop_map(|(i, n)| Damage::Remove(i, n)),
        3 => (place(), prop::sample::select(&STONES[..])).prop_map(|(i, s)| Damage::Insert(i, s)),
        2 => (place(), 1..60usize).prop_map(|(i, n)| Damage::Repeat(i, n)),
        2 => (place(), place(), 1..40usize).prop_map(|(i, j, n)| Damage::Copy(i, j, n)),
        1 => place().prop_map(Damage::Cut),
    ]
}

/// Damages `bytes`.
pub(crate) fn damage(bytes: &mut Vec<u8>, damage: &Damage) {
    let len = bytes.len();
    if len == 0 {
        return;
    }
    match damage {
        Damage::Set(i, b) => bytes[i % len] = *b,
        Damage::Number(i, number) => {
            let i = i % len;
            for (byte, new) in bytes[i..].iter_mut().zip(number) {
                *byte = *new;
            }
        }
        Damage::Digits(i, digits) => {
            let i = i % len;
            let is_digit = |&b: &u8| b.is_ascii_digit() || b == b'.';
            let start = bytes[i..].iter().position(is_digit).map(|at| i + at);
            if let Some(start) = start {
                let end = bytes[start..].iter().position(|b| !is_digit(b));
                let end = end.map_or(len, |at| start + at);
                bytes.splice(start..end, digits.iter().copied());
            }
        }
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
        Damage::Copy(i, j, n) => {
            let (i, j) = (i % len, j % len);
            let part = bytes[i..len.min(i + n)].to_vec();
            bytes.splice(j..j, part);
        }
        Damage::Cut(i) => bytes.truncate(i % len),
    }
}

/// How many files the long tests damage: `GEOBENCH_MUTATIONS`, or 200,000.
pub(crate) fn mutations() -> u32 {
    let asked = std::env::var("GEOBENCH_MUTATIONS").ok();
    asked
        .and_then(|count| count.parse().ok())
        .unwrap_or(200_000)
}

/// The settings of a test of so many cases, the same ones each time.
pub(crate) fn fixed(cases: u32) -> ProptestConfig {
    ProptestConfig {
        cases,
        failure_persistence: None,
        rng_seed: prop::test_runner::RngSeed::Fixed(1),
        ..ProptestConfig::default()
    }
}
