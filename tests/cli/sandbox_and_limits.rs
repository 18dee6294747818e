//! The trust in files: `--allow-outside` and `--limit`.

use super::*;

/// A scene beside which, and not in its folder, there is a picture.
fn scene() -> Folder {
    let folder = Folder::new();
    std::fs::create_dir(folder.path("scene")).unwrap();
    folder.write("dot.png", envers_testing::png(&[[255; 4]]));
    let text = SPHERE.replace("specular = 0.5", "diffuse_map = \"../dot.png\"");
    folder.write("scene/scene.toml", text);
    folder
}

const COMMANDS: [&str; 4] = [
    "info scene/scene.toml",
    "render scene/scene.toml -o out.png --size 8x8",
    "validate scene/scene.toml --size 8x8",
    "bench scene/scene.toml --quick --size 8x8 --runs 1 --out bench",
];

#[test]
fn a_file_outside_is_refused_by_every_command() {
    let folder = scene();
    for command in COMMANDS {
        let message = folder.run(command).refused();
        assert!(message.contains("scene/scene.toml:"), "{command}: {message}");
        assert!(message.contains("it is not in the folder"), "{command}: {message}");
        assert!(message.contains("help: ") && message.contains("`--allow-outside`"), "{message}");
    }
}

#[test]
fn a_file_outside_is_read_by_every_command_where_it_is_allowed() {
    let folder = scene();
    for command in
        COMMANDS.into_iter().filter(|c| cfg!(feature = "embree") || !c.starts_with("val"))
    {
        folder.run(&format!("{command} --allow-outside")).good();
    }
}

#[test]
fn a_limit_is_as_it_is_given_last() {
    let folder = scene();
    let info = "info scene/scene.toml --allow-outside";
    let message = folder.run(&format!("{info} --limit pictures=0")).refused();
    assert!(
        message.contains("the limit of 0") && message.contains("`--limit pictures=1`"),
        "{message}"
    );
    folder.run(&format!("{info} --limit pictures=0 --limit pictures=1")).good();
}

#[test]
fn a_limit_that_is_none_is_named() {
    let folder = scene();
    for (limit, part) in [
        ("pixel=1", "they are bytes, json"),
        ("pixels=many", "no whole number"),
        ("5", "NAME=NUMBER"),
    ] {
        let message = folder.run(&format!("info scene/scene.toml --limit {limit}")).refused();
        assert!(message.contains(part), "{message}");
    }
}
