//! A folder for the file of each run, beside what it may name.

use std::path::{Path, PathBuf};
use std::sync::LazyLock;

use envers::{Limit, Limits, LoadOptions};

/// The folder, in memory where the system has one for that.
static FOLDER: LazyLock<PathBuf> = LazyLock::new(|| {
    let base = Some(PathBuf::from("/dev/shm")).filter(|path| path.is_dir());
    let base = base.unwrap_or_else(std::env::temp_dir);
    let folder = base.join(format!("envers-fuzz-{}", std::process::id()));
    std::fs::create_dir_all(&folder).expect("a folder can be made");
    let files: [(&str, &[u8]); 4] = [
        ("data.bin", &[0; 4096]),
        ("a.obj", b"mtllib a.mtl\nusemtl a\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nf 1/1 2/1 3/1\n"),
        ("a.mtl", b"newmtl a\nKd 1 0 0\nmap_Kd picture.png\n"),
        ("picture.png", include_bytes!("../../assets/scenes/gallery/models/sky.png")),
    ];
    for (name, bytes) in files {
        std::fs::write(folder.join(name), bytes).expect("a file can be written");
    }
    folder
});

/// Writes `bytes` to a file, and loads one that may be another. An error must say what is wrong;
/// whatever loads has to be valid.
pub fn load(file: &str, bytes: &[u8], entry: &str) {
    write(file, bytes);
    // Small, so that what goes beyond them is tried often.
    let limits = Limits::default()
        .with_limit(Limit::Elements, 1 << 16)
        .with_limit(Limit::Pixels, 1 << 18)
        .with_limit(Limit::Keys, 1 << 12);
    match LoadOptions::default().limits(limits).load(path(entry)) {
        Ok(loaded) => loaded.scene.check().expect("what loads is valid"),
        Err(error) => {
            assert!(!error.message().is_empty());
            assert!(error.path().is_some_and(Path::exists), "{error}");
        }
    }
}

/// Writes a file.
pub fn write(name: &str, bytes: &[u8]) {
    std::fs::write(path(name), bytes).expect("a file can be written");
}

fn path(name: &str) -> PathBuf {
    FOLDER.join(name)
}
