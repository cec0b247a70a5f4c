//! The language of specs: canonical text, errors that help, nothing that breaks it.

use std::collections::HashSet;

use geobench_mesh::generate::{
    FAMILIES, GenerateError, Kind, MAX_FACES, MODIFIER_KEYS, Seeding, Spec, generate, help,
};
use proptest::prelude::*;

fn canonical(text: &str) -> String {
    text.parse::<Spec>().expect(text).to_string()
}

#[track_caller]
fn message(text: &str) -> String {
    text.parse::<Spec>().expect_err(text).to_string()
}

#[test]
fn canonical_text_holds_every_default() {
    for (text, expected) in [
        ("gen:sphere,subdiv=5", "gen:sphere,subdiv=5"),
        (
            "gen:cone",
            "gen:cone,angle=180,slices=48,stacks=32,ends=open",
        ),
        (
            "gen:torus,faces=50000,bump=0.1,seed=7",
            "gen:torus,faces=50000,r=0.4,bump=0.1,seed=7",
        ),
        ("gen:torus,seed=7", "gen:torus,faces=5000,r=0.4,bump=0"),
        (
            "gen:terrain,n=300,seed=1",
            "gen:terrain,n=300,roughness=0.6,height=0.3,seed=1",
        ),
        ("gen:anisotropic,g=4", "gen:anisotropic,g=4,faces=5000"),
        ("gen:grid,n=7", "gen:grid,nx=7,ny=7,diagonal=one,jitter=0"),
        (
            " PLANE , Diagonal = ALTERNATING , nX=3,noise=-0,scale=1e-6,",
            "gen:grid,nx=3,ny=40,diagonal=alternating,jitter=0,scale=1e-6",
        ),
        (
            "gen:cube,noise=0.10,subdivide=02",
            "gen:cube,n=20,side=1,subdivide=2,noise=0.1,seed=1",
        ),
        ("gen:file,path= a=b.off ", "gen:file,path=a=b.off"),
        (
            r#"gen:file,path="a, ""b"".off",subdivide=1"#,
            r#"gen:file,path="a, ""b"".off",subdivide=1"#,
        ),
    ] {
        assert_eq!(canonical(text), expected);
        assert_eq!(canonical(expected), expected);
    }
}

#[test]
fn paths_come_back_as_they_were_written() {
    let path = |text: &str| text.parse::<Spec>().expect(text).path().map(str::to_owned);
    assert_eq!(
        path("gen:file,path=x y.obj,noise=1"),
        Some("x y.obj".into())
    );
    assert_eq!(path(r#"gen:file,path="a,""b""""#), Some(r#"a,"b""#.into()));
    assert_eq!(path("gen:sphere"), None);
    let spec: Spec = "gen:file,path=cow.off".parse().expect("right");
    let error = generate(&spec).expect_err("not loaded");
    assert!(error.to_string().contains("cow.off"), "{error}");
}

#[test]
fn errors_say_what_to_write_instead() {
    for (text, parts) in [
        ("gen:shpere", &["`shpere`", "mean `sphere`", "torus"][..]),
        ("gen:", &["unknown model family", "sphere"]),
        (
            "gen:sphere,subdivs=3",
            &["`subdivs`", "mean `subdiv`", "noise"],
        ),
        ("gen:sphere,subdiv", &["`subdiv`", "key=value"]),
        ("gen:sphere,,subdiv=3", &["key=value"]),
        (
            "gen:sphere,subdiv=",
            &["subdiv is a whole number from 0 to 12"],
        ),
        ("gen:sphere,subdiv=13", &["`subdiv=13`", "from 0 to 12"]),
        ("gen:sphere,subdiv=2.5", &["whole number"]),
        ("gen:sphere,subdiv=-1", &["whole number"]),
        ("gen:sphere,subdiv=99999999999999999999", &["from 0 to 12"]),
        ("gen:torus,r=nan", &["a number from 0.01 to 0.65"]),
        ("gen:torus,r=inf", &["a number from 0.01 to 0.65"]),
        ("gen:torus,r=1e999", &["a number from 0.01 to 0.65"]),
        ("gen:sphere,scale=0", &["from 1e-100 to 1e100"]),
        ("gen:grid,diagonal=two", &["diagonal is one or alternating"]),
        ("gen:grid,n=3,nx=4", &["`nx` of `grid` is set twice"]),
        ("gen:grid,seed=3,seed=3", &["`seed` of `grid` is set twice"]),
        ("gen:file", &["needs `path=...`"]),
        ("gen:file,path=", &["path of a model file"]),
        ("gen:file,path=\"a", &["quotation mark"]),
        ("gen:file,path=\"a\"b", &["quotation mark"]),
        (
            "gen:grid,n=25000000",
            &["1250000000000000 faces", "50000000"],
        ),
        ("gen:sphere,subdiv=12", &["335544320 faces"]),
        ("gen:cube,subdivide=12", &["80530636800 faces"]),
    ] {
        let message = message(text);
        for part in parts {
            assert!(message.contains(part), "{text}: `{message}` lacks `{part}`");
        }
    }
}

#[test]
fn the_table_is_sound() {
    let mut names = HashSet::new();
    for family in FAMILIES {
        for name in std::iter::once(&family.name).chain(family.aliases) {
            assert!(names.insert(*name), "{name} twice");
        }
        let mut keys = HashSet::new();
        for key in family.keys.iter().chain(MODIFIER_KEYS) {
            assert!(keys.insert(key.name), "{}: {} twice", family.name, key.name);
            assert_eq!(key.name, key.name.to_ascii_lowercase());
            match key.kind {
                Kind::Whole { default, min, max } => assert!((min..=max).contains(&default)),
                Kind::Real { default, min, max } => assert!((min..=max).contains(&default)),
                Kind::Choice(words) => assert!(words.len() > 1),
                Kind::Path => {}
                Kind::All(names) => {
                    for name in names {
                        assert!(family.keys.iter().any(|key| key.name == *name), "{name}");
                    }
                }
            }
        }
        if let Seeding::With(name) = family.seeding {
            let key = family.keys.iter().find(|key| key.name == name);
            assert!(matches!(key.map(|key| &key.kind), Some(Kind::Real { .. })));
        }
    }
}

#[test]
fn help_names_every_family_and_key() {
    let help = help();
    for family in FAMILIES {
        assert!(help.contains(family.name) && help.contains(family.summary));
        for key in family.keys.iter().chain(MODIFIER_KEYS) {
            assert!(help.contains(key.name) && help.contains(key.summary));
        }
    }
}

#[test]
fn only_the_prefix_makes_a_spec() {
    assert!(Spec::is_spec("gen:sphere"));
    assert!(!Spec::is_spec("sphere"));
    assert!(!Spec::is_spec("models/gen:sphere"));
}

/// Text that is nearly a spec: real names and keys with arbitrary values.
fn likely_spec() -> impl Strategy<Value = String> {
    let families: Vec<_> = FAMILIES.iter().map(|family| family.name).collect();
    let keys: Vec<_> = FAMILIES
        .iter()
        .flat_map(|family| family.keys)
        .chain(MODIFIER_KEYS)
        .map(|key| key.name)
        .collect();
    let value = prop_oneof![
        any::<u64>().prop_map(|x| x.to_string()),
        (0u64..60).prop_map(|x| x.to_string()),
        any::<f64>().prop_map(|x| x.to_string()),
        (0.0..2.0).prop_map(|x: f64| x.to_string()),
        Just("capped".to_owned()),
        "\\PC{0,6}",
    ];
    let setting = (prop::sample::select(keys), value).prop_map(|(k, v)| format!(",{k}={v}"));
    (
        prop::sample::select(families),
        prop::collection::vec(setting, 0..5),
    )
        .prop_map(|(family, settings)| format!("gen:{family}{}", settings.concat()))
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(2_000))]

    #[test]
    fn any_text_is_read_or_refused(text in "\\PC{0,60}") {
        let _ = text.parse::<Spec>();
        let _ = format!("gen:file,path={text}").parse::<Spec>();
    }

    #[test]
    fn nearly_right_specs_round_trip_and_are_made(text in likely_spec()) {
        let Ok(spec) = text.parse::<Spec>() else {
            return Ok(());
        };
        let again: Spec = spec.to_string().parse().expect("canonical text is right");
        prop_assert_eq!(spec.to_string(), again.to_string());
        let Some(faces) = spec.face_count() else {
            return Ok(());
        };
        prop_assert!(faces <= MAX_FACES);
        if faces < 100_000 {
            let soup = generate(&spec).expect("was checked when read");
            prop_assert_eq!(soup.triangles.len() as u64, faces);
            prop_assert!(soup.positions.as_flattened().iter().all(|x| x.is_finite()));
        }
    }

    #[test]
    fn any_path_round_trips(path in "[^ ](\\PC{0,20}[^ ])?") {
        let quoted = format!("gen:file,path=\"{}\"", path.replace('"', "\"\""));
        let spec: Spec = quoted.parse().expect("quoted");
        prop_assert_eq!(spec.path(), Some(path.as_str()));
        let again: Spec = spec.to_string().parse().expect("canonical");
        prop_assert_eq!(again.path(), Some(path.as_str()));
    }
}

#[test]
fn too_many_faces_is_its_own_error() {
    let error = "gen:grid,n=6000".parse::<Spec>().expect_err("too many");
    assert_eq!(error, GenerateError::TooManyFaces { faces: 72_000_000 });
}
