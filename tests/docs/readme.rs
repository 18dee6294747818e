//! The README shows what is true.

use std::fs;
use std::path::Path;

fn read(name: &str) -> String {
    fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join(name)).unwrap()
}

#[test]
fn scene_file_of_the_readme_loads() {
    let readme = read("README.md");
    let scene = readme.split("```toml\n").nth(1).unwrap().split("```").next().unwrap();
    let folder = tempfile::tempdir().unwrap();
    let model = "assets/scenes/gallery/models/room.glb";
    fs::create_dir_all(folder.path().join(model).parent().unwrap()).unwrap();
    fs::copy(Path::new(env!("CARGO_MANIFEST_DIR")).join(model), folder.path().join(model)).unwrap();
    let path = folder.path().join("scene.toml");
    fs::write(&path, scene).unwrap();
    let scene = envers::load(&path).unwrap().scene;
    assert_eq!(scene.spheres.len(), 1);
}

#[test]
fn files_that_the_readme_links_are_there() {
    for link in read("README.md").split("](").skip(1) {
        let target = link.split([')', '#']).next().unwrap();
        if !target.starts_with("http") {
            let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(target);
            assert!(path.exists(), "{target}");
        }
    }
}
