//! Finds Embree for the `embree` feature and sees to it that what is built finds it again.
//!
//! It has no dependencies, so that it is built and can speak before bindgen, which the bindings'
//! own build script runs, gets to fail. It downloads nothing: `scripts/setup` does, and looks at
//! the same places.

use std::env;
use std::path::{Path, PathBuf};
use std::process::{Command, exit};

fn main() {
    println!("cargo::rerun-if-changed=build.rs");
    println!("cargo::rerun-if-env-changed=EMBREE_DIR");
    println!("cargo::rerun-if-env-changed=DOCS_RS");
    // Documentation is neither linked nor run.
    if env::var_os("CARGO_FEATURE_EMBREE").is_none() || env::var_os("DOCS_RS").is_some() {
        return;
    }
    let target = Target::of_this_build();
    let root = PathBuf::from(env::var_os("CARGO_MANIFEST_DIR").expect("cargo sets it"));
    match find_embree(&target, &root) {
        Ok(folder) => link(&target, &folder),
        Err(why) => {
            eprintln!("{}", how_to_get_embree(&why));
            exit(1);
        }
    }
    warn_without_libclang(&root);
}

struct Target {
    os: String,
    arch: String,
}

impl Target {
    fn of_this_build() -> Self {
        let get = |name| env::var(name).expect("cargo sets it");
        Self { os: get("CARGO_CFG_TARGET_OS"), arch: get("CARGO_CFG_TARGET_ARCH") }
    }

    /// The file that a linker looks for under the name `embree4`.
    fn library(&self) -> &'static str {
        match self.os.as_str() {
            "windows" => "embree4.lib",
            "macos" => "libembree4.dylib",
            _ => "libembree4.so",
        }
    }

    /// Folders that both the linker and the loader search by themselves.
    fn searched_anyway(&self) -> Vec<PathBuf> {
        match self.os.as_str() {
            "windows" | "macos" => vec![],
            _ => [&format!("/usr/lib/{}-linux-gnu", self.arch), "/usr/lib64", "/usr/lib"]
                .map(PathBuf::from)
                .into(),
        }
    }

    /// Further folders where packagers and people put it.
    fn usual(&self) -> Vec<PathBuf> {
        let names: &[&str] = match self.os.as_str() {
            "windows" => &[],
            "macos" => &[
                "/opt/homebrew/lib",
                "/opt/homebrew/opt/embree/lib",
                "/usr/local/lib",
                "/usr/local/opt/embree/lib",
                "/opt/local/lib",
            ],
            _ => &["/usr/local/lib64", "/usr/local/lib"],
        };
        names.iter().map(PathBuf::from).collect()
    }
}

/// The folder of the library, or in one sentence why there is none.
fn find_embree(target: &Target, root: &Path) -> Result<PathBuf, String> {
    let library = target.library();
    if let Some(named) = env::var_os("EMBREE_DIR").filter(|value| !value.is_empty()) {
        let named = PathBuf::from(named);
        // An explicit wish is not silently replaced by what happens to stand elsewhere.
        return ["", "lib", "lib64", &format!("lib/{}-linux-gnu", target.arch)]
            .iter()
            .map(|below| named.join(below))
            .find(|folder| folder.join(library).exists())
            .ok_or_else(|| {
                let named = named.display();
                format!("EMBREE_DIR is {named}, and neither it nor its lib or lib64 has {library}")
            });
    }
    let mut folders = vec![root.join(".deps/embree")];
    folders.extend(target.searched_anyway());
    folders.extend(target.usual());
    if let Some(conda) = env::var_os("CONDA_PREFIX") {
        folders.push(Path::new(&conda).join("lib"));
    }
    folders
        .into_iter()
        .find(|folder| folder.join(library).exists())
        .ok_or_else(|| "Embree 4 is not there".to_owned())
}

/// Links with the library in `folder`, such that programs, tests and doctests find it again.
fn link(target: &Target, folder: &Path) {
    println!("cargo::rerun-if-changed={}", folder.join(target.library()).display());
    if target.searched_anyway().iter().any(|searched| searched == folder) {
        println!("cargo::rustc-link-search=native={}", folder.display());
        return;
    }
    // `.deps/embree` may be a link to a folder elsewhere; a relative EMBREE_DIR is relative to here.
    let folder = folder.canonicalize().unwrap_or_else(|_| folder.to_owned());
    let search = in_out_dir(&folder).unwrap_or_else(|| folder.clone());
    println!("cargo::rustc-link-search=native={}", search.display());

    let origin = match target.os.as_str() {
        "windows" => return,
        "macos" => "@loader_path",
        _ => "$ORIGIN",
    };
    // Where `make install` puts it comes first: an installed program must not depend on what
    // became of the checkout.
    println!("cargo::rustc-link-arg=-Wl,-rpath,{origin}/../lib/envers");
    println!("cargo::rustc-link-arg=-Wl,-rpath,{}", folder.display());
}

/// A link to `folder` inside the target directory.
///
/// Link arguments, and so the rpath, do not reach doctests and the programs of other packages that
/// use this one. What cargo runs is told of the folders that were searched for libraries, but only
/// of those inside the target directory. The link is to the folder and not to the library, since
/// Embree looks for its neighbours (TBB) in the folder that it was loaded from.
fn in_out_dir(folder: &Path) -> Option<PathBuf> {
    let link = PathBuf::from(env::var_os("OUT_DIR")?).join("embree");
    let _ = std::fs::remove_file(&link);
    #[cfg(unix)]
    let made = std::os::unix::fs::symlink(folder, &link).is_ok();
    #[cfg(not(unix))]
    let made = folder == link;
    made.then_some(link)
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

fn how_to_get_embree(why: &str) -> String {
    format!(
        "
envers: {why}.

Any one of these gets further:
  in a checkout             make setup   (scripts/setup; fetches what is missing, no root needed)
  Debian 13, Ubuntu 24.04   sudo apt install libembree-dev libclang-dev
  Debian 12, Ubuntu 22.04   have Embree 3 only; `make setup` gets Embree 4 through pip
  Fedora                    sudo dnf install embree-devel clang-devel
  Arch                      sudo pacman -S embree clang
  macOS                     brew install embree llvm
  conda                     conda install -c conda-forge embree libclang
  pip, without a checkout   pip download --no-deps embreex==4.4.0.post1, unpack it, link
                            libembree4.so to its libembree4-….so.4, and set EMBREE_DIR
  an Embree 4 of your own   set EMBREE_DIR to its folder, the one with lib/ or with the library
Or do without Embree and libclang, on the pure-Rust backend:
  cargo build --release --no-default-features --features cli
"
    )
}
