//! Embree is opened when it is first needed: the program works without it, and says so where it matters.

use super::*;

/// Runs `program` in a folder, with `EMBREE_DIR` set to `embree_dir` or not set.
fn run_program(folder: &Folder, program: &Path, arguments: &str, embree_dir: Option<&Path>) -> Run {
    let mut command = assert_cmd::Command::new(program);
    command.args(arguments.split_whitespace()).current_dir(folder.path("."));
    match embree_dir {
        Some(embree_dir) => command.env("EMBREE_DIR", embree_dir),
        None => command.env_remove("EMBREE_DIR"),
    };
    let output = command.timeout(Duration::from_secs(60)).output().unwrap();
    let text = |bytes| String::from_utf8(bytes).unwrap();
    Run { status: output.status.code(), stdout: text(output.stdout), stderr: text(output.stderr) }
}

/// Runs `envers` where `EMBREE_DIR` names the folder `embree` of the run's own folder.
fn run_with_library(folder: &Folder, arguments: &str) -> Run {
    let program = Path::new(env!("CARGO_BIN_EXE_envers"));
    run_program(folder, program, arguments, Some(&folder.path("embree")))
}

/// A folder with a scene, and with an empty folder `embree`.
fn without_library() -> Folder {
    let folder = Folder::with(SPHERE);
    std::fs::create_dir(folder.path("embree")).unwrap();
    folder
}

#[test]
fn embree_is_the_default_where_it_is_built_in() {
    let stats = Folder::with(SPHERE).run("render scene.toml --stats -").good().json();
    let expected = if cfg!(feature = "embree") { "embree" } else { "rust" };
    assert_eq!(stats["backend"]["name"], expected);
    assert_eq!(stats["backend"]["library"].is_string(), cfg!(feature = "embree"));
}

#[test]
fn program_starts_and_traces_in_rust_without_the_library() {
    let folder = without_library();
    for arguments in ["--version", "--help", "info scene.toml", "render scene.toml --backend rust"]
    {
        run_with_library(&folder, arguments).good();
    }
    assert!(folder.has("scene.png"));
}

#[test]
#[cfg(feature = "embree")]
fn version_tells_that_the_library_is_missing() {
    let stdout = run_with_library(&without_library(), "--version").good().stdout;
    assert!(stdout.starts_with("envers ") && stdout.contains("EMBREE_DIR"), "{stdout}");
}

#[test]
#[cfg(feature = "embree")]
fn embree_without_its_library_is_a_failure_that_names_the_other_backend() {
    let folder = without_library();
    let before = folder.names();
    let run = run_with_library(&folder, "render scene.toml --backend embree");
    assert_eq!((run.status, &*run.stdout), (Some(1), ""), "{}", run.stderr);
    assert!(run.stderr.starts_with("error: EMBREE_DIR is "), "{}", run.stderr);
    assert!(run.stderr.contains("`--backend rust` works without Embree"), "{}", run.stderr);
    assert_eq!(folder.names(), before);
}

#[test]
#[cfg(feature = "embree")]
fn auto_traces_in_rust_without_the_library_and_says_so() {
    let folder = without_library();
    for backend in ["", "--backend auto"] {
        let run = run_with_library(&folder, &format!("render scene.toml --stats - {backend}"));
        assert_eq!(run.status, Some(0), "{}", run.stderr);
        let stats = run.json();
        assert_eq!(stats["backend"]["name"], "rust");
        assert!(stats["warnings"][0].as_str().unwrap().contains("backend `rust` instead"));
        assert!(run.stderr.starts_with("warning: EMBREE_DIR is "), "{}", run.stderr);
    }
}

#[test]
#[cfg(feature = "embree")]
fn validation_without_the_library_is_a_failure() {
    let run = run_with_library(&without_library(), "validate scene.toml");
    assert_eq!((run.status, &*run.stdout), (Some(1), ""), "{}", run.stderr);
    assert!(
        run.stderr.contains("EMBREE_DIR") && !run.stderr.contains("--backend"),
        "{}",
        run.stderr
    );
}

#[test]
#[cfg(all(feature = "embree", target_os = "linux"))]
fn file_that_is_no_library_is_named() {
    let folder = without_library();
    folder.write("embree/libembree4.so", "no library");
    let run = run_with_library(&folder, "render scene.toml --backend embree");
    assert_eq!(run.status, Some(1), "{}", run.stderr);
    let expected = "embree/libembree4.so: ";
    assert!(run.stderr.starts_with("error: Embree 4 cannot be opened: "), "{}", run.stderr);
    assert!(run.stderr.contains(expected), "{}", run.stderr);
    assert!(run.stderr.contains("`--backend rust`"), "{}", run.stderr);
}

/// Compiles a shared library into the folder `embree`.
#[cfg(all(feature = "embree", target_os = "linux"))]
fn compile_library(folder: &Folder, source: &str) {
    folder.write("library.c", source);
    let output = folder.path("embree/libembree4.so.4");
    let arguments = ["-shared", "-fPIC", "-o"].map(std::ffi::OsString::from);
    let paths = [output.into_os_string(), folder.path("library.c").into_os_string()];
    let status = std::process::Command::new("cc").args(arguments).args(paths).status().unwrap();
    assert!(status.success());
}

#[test]
#[cfg(all(feature = "embree", target_os = "linux"))]
fn library_that_lacks_a_function_is_refused() {
    let folder = without_library();
    compile_library(&folder, "void rtcNewDevice(void) {}");
    let run = run_with_library(&folder, "render scene.toml --backend embree");
    assert_eq!(run.status, Some(1), "{}", run.stderr);
    assert!(run.stderr.contains("undefined symbol: rtc"), "{}", run.stderr);
    assert!(run.stderr.contains("`--backend rust`"), "{}", run.stderr);
}

#[test]
#[cfg(all(feature = "embree", target_os = "linux"))]
fn library_of_another_version_is_refused() {
    let folder = without_library();
    // Every function that is looked up is there, and the version is 5.
    let functions = include_str!("../../src/intersect/embree/ffi/library.rs")
        .lines()
        .filter_map(|line| line.trim().strip_prefix("fn rtc")?.split_once('('))
        .map(|(name, _)| format!("long rtc{name}(void) {{ return 5; }}\n"));
    compile_library(&folder, &functions.collect::<String>());
    let run = run_with_library(&folder, "render scene.toml --backend embree");
    assert_eq!(run.status, Some(1), "{}", run.stderr);
    assert!(run.stderr.contains("this is Embree 5; envers needs Embree 4"), "{}", run.stderr);
    assert!(run.stderr.contains("`--backend rust`"), "{}", run.stderr);
}

#[test]
#[cfg(all(feature = "embree", target_os = "linux"))]
fn library_beside_the_program_comes_first() {
    let folder = Folder::with(SPHERE);
    let stats = folder.run("render scene.toml --stats -").good().json();
    let library = Path::new(stats["backend"]["library"].as_str().unwrap()).to_owned();
    // The system's library is known by its bare name; it then stands in one of these folders.
    let folders = ["", "/usr/lib/x86_64-linux-gnu", "/usr/lib/aarch64-linux-gnu", "/usr/lib64"];
    let mut paths = folders.iter().map(|folder| Path::new(folder).join(&library));
    let library = paths.find(|path| path.exists()).expect("the library is somewhere");
    // The program, the library and its neighbours, which are found by their own names.
    std::fs::create_dir(folder.path("bin")).unwrap();
    let program = folder.path("bin/envers");
    std::fs::copy(env!("CARGO_BIN_EXE_envers"), &program).unwrap();
    let library = library.canonicalize().unwrap();
    for entry in std::fs::read_dir(library.parent().unwrap()).unwrap() {
        let path = entry.unwrap().path();
        let name = path.file_name().unwrap().to_str().unwrap().to_owned();
        if name.starts_with("libembree4") && path == library || name.starts_with("libtbb") {
            std::os::unix::fs::symlink(&path, folder.path("bin").join(&name)).unwrap();
        }
    }
    let run = run_program(&folder, &program, "render scene.toml --stats -", None);
    let stats = run.good().json();
    assert_eq!(stats["backend"]["name"], "embree");
    let used = PathBuf::from(stats["backend"]["library"].as_str().unwrap());
    assert_eq!(used.parent(), Some(folder.path("bin").canonicalize().unwrap().as_path()));
}

/// The most processor time that a run may take: that of its threads, and what starting them costs.
#[cfg(all(feature = "embree", target_os = "linux"))]
fn max_cpu(threads: f64, wall: f64) -> f64 {
    1.05 * threads * wall + 0.02
}

/// Renders a reference scene and holds the processors' time against the clock. On a busy machine the
/// clock runs on and the processors' time does not: only a thread that works for nothing fails it.
#[cfg(all(feature = "embree", target_os = "linux"))]
#[track_caller]
fn no_thread_spins(scene: &str, size: &str, more: &str) {
    let folder = Folder::new();
    let mesh = xtask::reference::knot::mesh(xtask::reference::knot::resolution(1_000_000));
    folder.write("s.toml", xtask::reference::spheres::toml());
    folder.write("m.toml", xtask::reference::knot::TOML);
    if scene == "m.toml" {
        folder.write("m.glb", xtask::reference::knot::glb(&mesh));
    }
    for threads in [1, 2] {
        let run = format!("render {scene} --size {size} --threads {threads} --stats - {more}");
        let stats = folder.run(&run).good().json();
        for stage in ["render", "total"] {
            let [wall, cpu] =
                ["seconds", "cpu_seconds"].map(|kind| stats[kind][stage].as_f64().unwrap());
            let most = max_cpu(f64::from(threads), wall);
            assert!(cpu <= most, "{stage}, {threads} threads: {cpu} s of CPU in {wall} s");
        }
    }
}

#[test]
#[cfg(all(feature = "embree", target_os = "linux"))]
fn no_thread_spins_while_spheres_are_traced() {
    no_thread_spins("s.toml", "1920x1080", "--spp 4");
}

#[test]
#[cfg(all(feature = "embree", target_os = "linux"))]
fn no_thread_spins_while_a_mesh_is_traced() {
    no_thread_spins("m.toml", "960x540", "");
}

#[test]
#[cfg(all(feature = "embree", target_os = "linux"))]
fn no_thread_spins_in_certified_precision() {
    no_thread_spins("s.toml", "960x540", "--spp 4 --precision certified");
}
