use crate::support::Sandbox;

#[test]
fn shells_learn_the_commands() {
    let sandbox = Sandbox::new();
    for shell in ["bash", "zsh", "fish", "elvish", "powershell"] {
        let script = sandbox.succeed(&format!("completions {shell}"));
        for word in ["geobench", "report", "ratio-to", "tolerance"] {
            assert!(script.contains(word), "{shell}: {word}");
        }
    }
    assert!(
        sandbox
            .refuse("completions cmd")
            .contains("possible values: bash")
    );
}

#[cfg(unix)]
#[test]
fn bash_completes_with_the_script() {
    let sandbox = Sandbox::new();
    let script = sandbox.succeed("completions bash");
    sandbox.write("geobench.bash", &script);
    let ask = "source ./geobench.bash; COMP_WORDS=(geobench rep); COMP_CWORD=1; \
               _geobench geobench rep geobench; echo \"${COMPREPLY[@]}\"";
    let Ok(output) = std::process::Command::new("bash")
        .args(["-c", ask])
        .current_dir(sandbox.path("."))
        .output()
    else {
        eprintln!("skipped: there is no bash");
        return;
    };
    assert_eq!(
        String::from_utf8_lossy(&output.stdout),
        "report\n",
        "{output:?}"
    );
}

#[test]
fn manual_pages_have_the_text_of_help() {
    let sandbox = Sandbox::new();
    let page = sandbox.succeed("man");
    assert!(
        page.contains(".TH geobench 1") && page.contains("geobench\\-report(1)"),
        "{page}"
    );
    let page = sandbox.succeed("man run");
    assert!(page.contains(".TH geobench-run 1"), "{page}");
    assert!(
        page.contains("\\-\\-repeat") && page.contains("Suite file with models"),
        "{page}"
    );
    assert_eq!(
        sandbox.refuse("man fly"),
        "there is no command `fly`; see geobench --help"
    );
}
