//! Completion scripts and manual pages.

use super::*;

/// True if a program is installed.
fn is_installed(program: &str) -> bool {
    std::process::Command::new(program).arg("--version").output().is_ok()
}

/// Runs a program in the folder and returns its standard output, if it succeeds and warns of nothing.
#[track_caller]
fn output_of(folder: &Folder, program: &str, arguments: &[&str]) -> String {
    let output = assert_cmd::Command::new(program)
        .args(arguments)
        .current_dir(folder.path("."))
        .env("MANROFFSEQ", "")
        .output()
        .unwrap();
    let stderr = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success() && stderr.is_empty(), "{program} {arguments:?}: {stderr}");
    String::from_utf8(output.stdout).unwrap()
}

#[test]
#[cfg(unix)]
fn bash_completes_subcommands_and_flags() {
    let folder = Folder::new();
    folder.write("envers.bash", folder.run("completions bash").good().stdout);
    let complete = |line: &str| {
        let script = format!(
            "source ./envers.bash; COMP_WORDS=({line} ''); COMP_CWORD=$(({} - 1)); \
             COMP_WORDS[COMP_CWORD]=$1; _envers envers \"$1\"; printf '%s\\n' \"${{COMPREPLY[@]}}\"",
            line.split(' ').count() + 1
        );
        move |word: &str| script.replace("$1", word)
    };
    let subcommands = output_of(&folder, "bash", &["-c", &complete("envers")("re")]);
    assert_eq!(subcommands.trim(), "render");
    let flags = output_of(&folder, "bash", &["-c", &complete("envers render")("--prec")]);
    assert_eq!(flags.trim(), "--precision");
}

#[test]
#[cfg(unix)]
fn scripts_are_loaded_by_the_shells_that_are_installed() {
    let folder = Folder::new();
    for (shell, load) in [
        ("bash", "source ./script && complete -p envers"),
        ("zsh", "autoload -U compinit && compinit -u -D && source ./script"),
        ("fish", "source ./script && complete -C 'envers ren'"),
    ] {
        folder.write("script", folder.run(&format!("completions {shell}")).good().stdout);
        if is_installed(shell) {
            output_of(&folder, shell, &["-c", load]);
        }
    }
}

#[test]
fn every_command_has_a_manual_page_that_names_its_flags() {
    let folder = Folder::new();
    folder.run("man pages/man1").good();
    let page = |name: &str| String::from_utf8(folder.read(format!("pages/man1/{name}.1"))).unwrap();
    for command in ["render", "validate", "stress", "bench", "info", "diff", "completions", "man"] {
        assert!(page("envers").contains(command));
        assert!(page(&format!("envers-{command}")).contains(&format!("envers\\-{command}")));
    }
    assert!(page("envers-render").contains("\\-\\-precision"));
    assert!(page("envers").contains("Exit status"));
}

#[test]
#[cfg(unix)]
fn manual_pages_have_no_warnings() {
    let folder = Folder::new();
    folder.run("man pages").good();
    if !is_installed("man") || !is_installed("groff") {
        return;
    }
    for entry in std::fs::read_dir(folder.path("pages")).unwrap() {
        let path = entry.unwrap().path();
        let path = path.to_str().unwrap();
        output_of(&folder, "man", &["--warnings", "-E", "UTF-8", "-l", "-Tutf8", "-Z", path]);
    }
}
