//! Damaged files: any result is allowed, but it must take little time and memory.

use std::path::Path;
use std::time::Duration;

use geobench_mesh::Mesh;
use geobench_mesh::io::{Format, ObjReader, ReadOptions};
use peakmem_alloc::{INSTRUMENTED_SYSTEM, PeakMemAllocTrait};
use proptest::prelude::*;
use proptest::test_runner::{TestCaseError, TestRunner};

use crate::damage::{Damage, damage, damages, fixed, mutations};
use crate::processor_time::ProcessorTime;
use crate::{gzip, samples, tobj};

const FORMATS: [Format; 11] = [
    Format::Obj,
    Format::Ply,
    Format::Off,
    Format::Stl,
    Format::Vtk,
    Format::VtkXml,
    Format::Gltf,
    Format::ThreeMf,
    Format::Collada,
    Format::Gifti,
    Format::FreeSurfer,
];

/// The most processor time for a small file.
const LONGEST: Duration = Duration::from_secs(5);

/// Compressed files may decompress to few bytes here.
const OPTIONS: ReadOptions = ReadOptions {
    max_decompressed: Some(1 << 20),
    obj_reader: ObjReader::Direct,
    weld: None,
};

/// Most memory that reading and checking may take, of all tests that run at the same time.
const MOST_MEMORY: usize = 256 << 20;

/// A sample, what happens to it, and whether it is compressed before or after that.
type Case = (usize, Vec<Damage>, Option<bool>);

fn cases() -> impl Strategy<Value = Case> {
    let packed = prop_oneof![8 => Just(None), 1 => any::<bool>().prop_map(Some)];
    let damages = prop::collection::vec(damages(), 1..6);
    (0..samples::to_damage().len(), damages, packed)
}

fn damaged_file(samples: &[(Format, Vec<u8>)], case: &Case) -> Result<(), TestCaseError> {
    let (sample, list, packed) = case;
    let (format, mut bytes) = samples[*sample].clone();
    if *packed == Some(true) {
        bytes = gzip(&bytes);
    }
    for d in list {
        damage(&mut bytes, d);
    }
    let size = bytes.len();
    if *packed == Some(false) {
        bytes = gzip(&bytes);
    }
    let start = ProcessorTime::now();
    INSTRUMENTED_SYSTEM.reset_peak_memory();
    if let Ok(soup) = OPTIONS.read_bytes(&bytes, format, Path::new("test")) {
        // A soup never grows beyond what the file could have spelt out, or what may be
        // decompressed.
        let decompressed = if FORMATS[..4].contains(&format) {
            0
        } else {
            1 << 17
        };
        let elements = soup.positions.len() + soup.triangles.len();
        prop_assert!(elements <= 2 * size + 1000 + decompressed);
        prop_assert!(soup.file_faces.is_empty() || soup.file_faces.len() == soup.triangles.len());
        if let (Format::Obj, Ok(other)) = (format, tobj(&bytes)) {
            // As text, since NaN is not equal to itself.
            prop_assert_eq!(format!("{soup:?}"), format!("{other:?}"));
        }
        let _ = Mesh::from_soup(soup);
    }
    let memory = INSTRUMENTED_SYSTEM.get_peak_memory();
    prop_assert!(memory < MOST_MEMORY, "{memory} bytes");
    prop_assert!(start.elapsed() < LONGEST);
    Ok(())
}

fn damaged_files(config: ProptestConfig) {
    let samples = samples::to_damage();
    let done = TestRunner::new(config).run(&cases(), |case| damaged_file(&samples, &case));
    done.unwrap_or_else(|error| panic!("{error}"));
}

#[test]
fn damaged_files_do_not_panic() {
    damaged_files(ProptestConfig::with_cases(2_000));
}

#[test]
#[ignore = "takes half a minute"]
fn many_damaged_files_do_not_panic() {
    damaged_files(fixed(mutations()));
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(2_000))]

    #[test]
    fn noise_does_not_panic(bytes in prop::collection::vec(any::<u8>(), 0..300)) {
        for format in FORMATS {
            let _ = OPTIONS.read_bytes(&bytes, format, Path::new("test"));
        }
    }
}
