//! The help, the version, and the command line that is refused.

use super::*;

#[test]
fn version_names_the_version_of_embree() {
    let stdout = Folder::new().run("--version").good().stdout;
    assert!(stdout.starts_with(concat!("envers ", env!("CARGO_PKG_VERSION"), " (")), "{stdout}");
    if cfg!(feature = "embree") {
        assert!(stdout.contains("(Embree 4."), "{stdout}");
    } else {
        assert!(stdout.contains("(without Embree)"), "{stdout}");
    }
}

#[test]
fn help_shows_examples() {
    let stdout = Folder::new().run("--help").good().stdout;
    assert!(stdout.contains("\nExamples:\n  envers render model.glb -o out.png\n"), "{stdout}");
}

#[test]
fn help_tells_the_exit_statuses() {
    let stdout = Folder::new().run("--help").good().stdout;
    let (_, statuses) = stdout.split_once("\nExit status:\n").expect("a table");
    for status in ["  0 ", "  1 ", "  2 "] {
        assert!(statuses.lines().any(|line| line.starts_with(status)), "{status} in {stdout}");
    }
}

#[test]
fn help_names_every_subcommand() {
    let stdout = Folder::new().run("--help").good().stdout;
    for command in ["render", "validate", "stress", "bench", "info", "diff"] {
        assert!(stdout.contains(&format!("\n  {command} ")), "{command} in {stdout}");
    }
}

#[test]
fn every_subcommand_has_help() {
    for command in ["render", "validate", "stress", "bench", "info", "diff"] {
        let stdout = Folder::new().run(&format!("{command} --help")).good().stdout;
        assert!(stdout.contains(&format!("Usage: envers {command} ")), "{stdout}");
    }
}

#[test]
fn no_arguments_show_the_help_and_are_a_mistake() {
    let run = Folder::new().run("");
    assert_eq!((run.status, &*run.stdout), (Some(2), ""));
    assert!(run.stderr.contains("Usage: envers "), "{}", run.stderr);
}

#[test]
fn an_unknown_flag_is_refused_with_the_one_that_was_meant() {
    let message = Folder::with(&endless()).run("render scene.toml --sample 4").refused();
    assert!(message.contains("'--sample'"), "{message}");
    let message = Folder::with(&endless()).run("render scene.toml --thread 4").refused();
    assert!(message.contains("'--threads'"), "{message}");
}

#[test]
fn an_unknown_subcommand_is_refused_with_the_one_that_was_meant() {
    let message = Folder::new().run("rendr scene.toml").refused();
    assert!(message.contains("'render'"), "{message}");
}

/// A reader that goes away, as `head` does, is no error.
#[test]
#[cfg(unix)]
fn a_closed_pipe_is_success_without_a_word() {
    let folder = Folder::with(SPHERE);
    for command in ["info scene.toml", "info scene.toml --json -", "render scene.toml", "--help"] {
        let script = format!("sleep 0.1; envers {command} | true; exit ${{PIPESTATUS[0]}}");
        let run = folder.run_script(&script).good();
        assert_eq!(run.stdout, "", "{command}");
    }
}

#[test]
fn flags_of_other_programs_lead_to_ours_and_no_tip_misleads() {
    let folder = Folder::with(&endless());
    for (flag, ours) in [("--width", "--size"), ("--samples", "--spp"), ("--resolution", "--size")]
    {
        let message = folder.run(&format!("render scene.toml {flag} 64")).refused();
        assert!(message.contains(&format!("'{ours}'")) && !message.contains("'-- "), "{message}");
    }
    // No flag is named that the subcommand does not have.
    let message = folder.run("diff a.png b.png --width 64").refused();
    assert!(!message.contains("tip:"), "{message}");
    let message = folder.run("render scene.toml --nonsense-flag").refused();
    assert!(!message.contains("tip:"), "{message}");
}
