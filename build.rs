//! Lets the feature `embree` be built without Embree, which is opened when the program runs.
//!
//! This script has no dependencies, so that it is built and can speak before bindgen, which the bindings' own
//! build script runs, gets to fail.

use std::env;
use std::path::{Path, PathBuf};
use std::process::Command;

fn main() {
    println!("cargo::rerun-if-changed=build.rs");
    println!("cargo::rerun-if-env-changed=DOCS_RS");
    if env::var_os("CARGO_FEATURE_EMBREE").is_none() || env::var_os("DOCS_RS").is_some() {
        return;
    }
    write_empty_library();
    warn_without_libclang(&PathBuf::from(
        env::var_os("CARGO_MANIFEST_DIR").expect("cargo sets it"),
    ));
}

/// Writes an empty static library `embree4`, for which embree4-sys asks the linker. Its functions are in
/// `src/intersect/embree/ffi/library.rs`.
fn write_empty_library() {
    let folder = PathBuf::from(env::var_os("OUT_DIR").expect("cargo sets it"));
    let is_msvc = env::var("CARGO_CFG_TARGET_ENV").is_ok_and(|value| value == "msvc");
    let name = if is_msvc { "embree4.lib" } else { "libembree4.a" };
    std::fs::write(folder.join(name), b"!<arch>\n").expect("OUT_DIR is writable");
    println!("cargo::rustc-link-search=native={}", folder.display());
}

/// Bindgen needs libclang, and panics without it at some length. This cannot know all the places
/// where bindgen looks, so it only warns.
fn warn_without_libclang(root: &Path) {
    println!("cargo::rerun-if-env-changed=LIBCLANG_PATH");
    if cfg!(windows) || env::var_os("LIBCLANG_PATH").is_some() {
        return;
    }
    let mut folders = vec![];
    let config = env::var_os("LLVM_CONFIG_PATH").unwrap_or_else(|| "llvm-config".into());
    if let Ok(output) = Command::new(config).arg("--prefix").output() {
        let prefix = PathBuf::from(String::from_utf8_lossy(&output.stdout).trim());
        folders.extend(["lib", "lib64"].map(|below| prefix.join(below)));
    }
    for name in ["LD_LIBRARY_PATH", "LIBRARY_PATH"] {
        folders.extend(env::split_paths(&env::var_os(name).unwrap_or_default()));
    }
    if cfg!(target_os = "macos") {
        let apple = "Library/Developer/CommandLineTools/usr/lib";
        let xcode = "Applications/Xcode.app/Contents/Developer/Toolchains";
        folders.push(Path::new("/").join(apple));
        folders.push(Path::new("/").join(xcode).join("XcodeDefault.xctoolchain/usr/lib"));
        folders.extend(below(Path::new("/usr/local/opt")).into_iter().map(|f| f.join("lib")));
    }
    for top in ["/usr/lib", "/usr/lib32", "/usr/lib64", "/usr/local/lib", "/usr/local/lib64"] {
        for folder in below(Path::new(top)) {
            // /usr/lib/llvm-19/lib
            folders.push(folder.join("lib"));
            folders.push(folder.join("lib64"));
            folders.push(folder);
        }
        folders.push(top.into());
    }
    if folders.iter().any(|folder| has_libclang(folder)) {
        return;
    }
    // The file that set-up will write: not being there, it has this looked at again each time.
    println!("cargo::rerun-if-changed={}", root.join(".cargo/config.toml").display());
    println!(
        "cargo::warning=libclang seems to be missing, and bindgen will panic without it: run \
         `make setup`, or `sudo apt install libclang-dev` (Fedora: clang-devel, Arch: clang, \
         brew: llvm, conda: libclang), or set LIBCLANG_PATH to its folder"
    );
}

fn has_libclang(folder: &Path) -> bool {
    let is = |name: &str| {
        let shared = name.contains(".so") || name.ends_with(".dylib");
        // libclang-cpp is another library.
        let named = name.starts_with("libclang.") || name.starts_with("libclang-");
        shared && named && !name.starts_with("libclang-cpp")
    };
    below(folder).iter().any(|path| path.file_name().and_then(|n| n.to_str()).is_some_and(is))
}

fn below(folder: &Path) -> Vec<PathBuf> {
    let entries = std::fs::read_dir(folder).into_iter().flatten();
    entries.filter_map(|entry| Some(entry.ok()?.path())).collect()
}
