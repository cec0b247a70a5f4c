//! Counting instructions, which needs Valgrind.

use crate::support::Sandbox;

#[test]
fn instructions_are_those_of_the_solve_and_always_the_same() {
    let sandbox = Sandbox::with_square();
    let count = |model: &str, file: &str| {
        sandbox.succeed(&format!(
            "run {model} --algo vtp --repeat 1 --warmup 0 --instructions -o {file} --quiet"
        ));
        sandbox.json(file)["cells"][0]["instructions"]
            .as_u64()
            .unwrap()
    };
    let square = count("square.off", "a.json");
    // Starting the program and reading the file take some hundred thousand instructions.
    assert!((100..50_000).contains(&square), "{square}");
    assert_eq!(count("square.off", "b.json"), square);
    let cube = count("gen:cube,n=2", "c.json");
    assert!(cube > 2 * square, "{cube} {square}");
}

#[cfg(unix)]
#[test]
fn without_valgrind_nothing_is_run() {
    let sandbox = Sandbox::with_square();
    let output = sandbox
        .command("run square.off --instructions -o a.json")
        .env("PATH", sandbox.path(""))
        .output()
        .unwrap();
    assert_eq!(output.status.code(), Some(2));
    let message = String::from_utf8(output.stderr).unwrap();
    assert!(
        message.contains("counting instructions needs valgrind on the path"),
        "{message}"
    );
    assert!(!sandbox.path("a.json").exists());
}
