//! `geobench info`.

use crate::support::{Sandbox, UNUSABLE};

#[test]
fn counts_and_measures() {
    let sandbox = Sandbox::with_square();
    insta::assert_snapshot!(sandbox.succeed("info square.off gen:tetrahedron"), @r#"
    square  (square.off)
      vertices             4
      faces                2
      edges                5
      boundary edges       4
      junctions            0
      boundary loops       1
      components           1
      genus                0
      saddle vertices      0
      isolated vertices    0
      pinched vertices     0
      faces without area   0
      Euler characteristic 1
      anisotropy g         1.3938
      edge lengths         1.000000e0 to 1.414214e0, mean 1.082843e0
      area                 1.000000e0
      bounding box         (0, 0, 0) to (1, 1, 0)
      defects              none

    tetrahedron  (gen:tetrahedron,subdiv=5)
      vertices             2,050
      faces                4,096
      edges                6,144
      boundary edges       0
      junctions            0
      boundary loops       0
      components           1
      genus                0
      saddle vertices      0
      isolated vertices    0
      pinched vertices     0
      faces without area   0
      Euler characteristic 2
      anisotropy g         1.0000
      edge lengths         3.125000e-2 to 3.125000e-2, mean 3.125000e-2
      area                 1.732051e0
      bounding box         (-0.3535533905932738, -0.3535533905932738, -0.3535533905932738) to (0.3535533905932738, 0.3535533905932738, 0.3535533905932738)
      defects              none
    "#);
}

#[test]
fn a_broken_model_shows_its_defects_and_the_others_are_still_shown() {
    let sandbox = Sandbox::with_square();
    sandbox.write("fan.off", UNUSABLE);
    let outcome = sandbox.call("info fan.off square.off");
    assert_eq!(outcome.code, 2);
    assert!(outcome.stderr.starts_with("geobench: error: fan.off: "));
    assert!(
        outcome
            .stdout
            .contains("defect (fatal): 2 edges have lengths that cannot be computed with")
    );
    assert!(outcome.stdout.contains("square  (square.off)\n"));
}

#[test]
fn as_json_every_model_is_an_object() {
    let sandbox = Sandbox::with_square();
    sandbox.write("bad.off", UNUSABLE);
    let outcome = sandbox.call("info square.off bad.off --format json");
    assert_eq!(outcome.code, 2);
    let list: serde_json::Value = serde_json::from_str(&outcome.stdout).unwrap();
    let square = &list[0];
    assert_eq!(square["vertices"], 4);
    assert_eq!(square["usable"], true);
    assert_eq!(square["sha256"].as_str().unwrap().len(), 64);
    assert_eq!(
        square["bounding_box"],
        serde_json::json!([[0.0, 0.0, 0.0], [1.0, 1.0, 0.0]])
    );
    let bad = &list[1];
    assert_eq!(
        (&bad["usable"], &bad["name"]),
        (&false.into(), &"bad".into())
    );
    assert_eq!(bad["defects"][0]["severity"], "fatal");
    assert!(
        bad["error"].as_str().unwrap().starts_with("bad.off: "),
        "{bad}"
    );
}
