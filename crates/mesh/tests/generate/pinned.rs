//! The bits of every family's default model, which must never change: results name models by spec.

use geobench_mesh::TriangleSoup;
use geobench_mesh::generate::FAMILIES;

use crate::model;

/// Spec and FNV-1a checksum of its coordinates' bits and its triangles.
///
/// If one of these changes, the same spec names another model than in every result file so far:
/// give the new shape a new name or key instead.
const PINNED: &[(&str, u64)] = &[
    ("grid", 0x7554_f5e9_1dc6_7dc7),
    ("holes", 0x3edd_78cb_73eb_5409),
    ("strip", 0x2f1e_874f_ad37_a8f1),
    ("corridor", 0x8ee1_5560_9a8d_647e),
    ("terrain", 0xe5fe_b37c_55ce_d3dd),
    ("tetrahedron", 0x79f4_991a_95d2_b539),
    ("cube", 0x5a21_9860_2fb9_59a0),
    ("box", 0x8b01_4ba3_f685_8894),
    ("octahedron", 0x5dd8_71f7_0b37_0985),
    ("icosahedron", 0x48a3_baff_4699_1e71),
    ("sphere", 0x830f_b9f3_d900_1ad9),
    ("uvsphere", 0xf205_4f22_dd6f_8781),
    ("cylinder", 0x8953_1d66_2129_c225),
    ("cone", 0xe0fa_14af_31a8_5edc),
    ("torus", 0x8c55_1f1c_8420_99bd),
    ("knot", 0xe67c_fcd7_68b5_89a0),
    ("anisotropic", 0x8c76_558e_486d_29e8),
    ("grid,jitter=0.2", 0x2832_476d_0a1f_7b8b),
    ("torus,faces=50000,bump=0.1,seed=7", 0xf0ba_eb2e_b596_0698),
    ("terrain,n=100,seed=1", 0x2c76_71e6_ddd9_8205),
    ("corridor,holes=9", 0xf387_a4d5_46a5_692e),
    ("cone,angle=400,ends=capped", 0x80b4_48b2_3685_9afd),
    ("anisotropic,g=1.1", 0xbee6_ccdc_6201_c29e),
    (
        "sphere,subdivide=1,noise=0.1,scale=3,seed=18446744073709551615",
        0x7603_f5ca_5a1d_c62a,
    ),
];

fn checksum(soup: &TriangleSoup) -> u64 {
    let coordinates = soup.positions.as_flattened().iter().map(|x| x.to_bits());
    let corners = soup.triangles.as_flattened().iter().map(|&v| u64::from(v));
    coordinates
        .chain(corners)
        .flat_map(u64::to_le_bytes)
        .fold(0xcbf2_9ce4_8422_2325, |hash, byte| {
            (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3)
        })
}

#[test]
fn models_keep_their_bits() {
    let now: Vec<_> = PINNED
        .iter()
        .map(|&(spec, _)| (spec, checksum(&model(spec))))
        .collect();
    assert_eq!(now, PINNED);
}

#[test]
fn every_family_is_pinned() {
    for family in FAMILIES.iter().filter(|family| family.name != "file") {
        assert!(
            PINNED.iter().any(|(spec, _)| *spec == family.name),
            "{} is not pinned: {:#018x}",
            family.name,
            checksum(&model(family.name))
        );
    }
}
