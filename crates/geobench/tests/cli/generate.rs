//! `geobench gen`.

use crate::support::Sandbox;

#[test]
fn a_model_is_written_in_every_form_and_reads_back_the_same() {
    let sandbox = Sandbox::new();
    let mut descriptions = Vec::new();
    for file in ["m.obj", "m.ply", "m.obj.gz", "m.PLY.gz"] {
        sandbox.succeed(&format!("gen torus,faces=200,bump=0.1,seed=7 -o {file}"));
        let text = sandbox.succeed(&format!("info {file}"));
        descriptions.push(text.lines().skip(1).map(str::to_owned).collect::<Vec<_>>());
    }
    assert!(
        descriptions.iter().all(|d| *d == descriptions[0]),
        "{descriptions:?}"
    );
    assert!(
        descriptions[0]
            .iter()
            .any(|line| line == "  genus                1")
    );
}

#[test]
fn the_prefix_may_stand_or_not() {
    let sandbox = Sandbox::new();
    sandbox.succeed("gen gen:cube,n=2 -o a.obj");
    sandbox.succeed("gen cube,n=2 --quiet -o b.obj");
    assert_eq!(sandbox.read("a.obj"), sandbox.read("b.obj"));
    let message = sandbox.refuse("gen cube,n=2 -o -");
    assert!(message.starts_with("-: --output-format says"), "{message}");
}

#[test]
fn a_file_can_be_modified() {
    let sandbox = Sandbox::with_square();
    sandbox.succeed("gen file,path=square.off,subdivide=2 -o fine.obj");
    assert!(
        sandbox
            .succeed("info fine.obj")
            .contains("faces                32\n")
    );
}
