//! The `envers` command, run as its users run it.

mod adaptive;
mod backends;
mod bench;
mod completions;
mod empty_scenes;
mod environment;
mod exit_status;
mod formats;
mod frames;
mod framing;
mod help;
mod info;
mod inputs;
mod outputs;
mod render;
mod reports;
mod sandbox_and_limits;
// They do not depend on the backend, and take half a minute.
#[cfg(all(unix, feature = "embree"))]
mod signals;
mod stress;
mod strict;
mod tone;
mod transparent;
mod unneeded_features;
mod variants;
mod warnings;
mod work_counters;

use std::ffi::OsStr;
use std::path::{Path, PathBuf};
use std::time::Duration;

use serde_json::Value;

/// A sphere on the ground, in a small picture.
const SPHERE: &str = r##"
[film]
size = [64, 48]
background = "#203040"

[camera]
name = "front"
position = [0, 1, 5]
look_at = [0, 0.5, 0]

[[material]]
name = "red"
diffuse = "#c03020"
specular = 0.5

[[sphere]]
center = [0, 0.5, 0]
radius = 0.5
material = "red"

[[plane]]
point = [0, 0, 0]
normal = [0, 1, 0]

[[light]]
kind = "point"
position = [3, 5, 4]
"##;

/// The same in a picture that would take days: whatever refuses it in time has not rendered it.
fn endless() -> String {
    SPHERE.replace("size = [64, 48]", "size = [4096, 4096]\nspp = 65536")
}

/// A sphere that goes round, in ten frames of a fifth of a second.
fn moving() -> String {
    let scene = SPHERE.replacen("[[sphere]]", "[[sphere]]\nname = \"ball\"", 1);
    let orbit = "object = \"ball\"\naround = [1, 0.5, 0]\nperiod = 2\n";
    format!("{scene}\n[animation]\nframes = 10\nfps = 5\n[[animation.orbit]]\n{orbit}")
}

/// Spheres, a plane, a mesh that stands twice, one that stands once, and three kinds of light.
const EVERYTHING: &str = r##"
[film]
size = [150, 110]
spp = 2
background = 0.2

[[camera]]
name = "front"
position = [0.3, 1.5, 6]
look_at = [0, 0.5, 0]

[[camera]]
name = "above"
position = [0, 7, 0.5]
look_at = [0, 0, 0]
fov_x = 60

[[material]]
name = "glossy"
diffuse = [0.1, 0.3, 0.6]
specular = 0.8
shininess = 30

[[sphere]]
center = [-1.2, 0.5, 0]
radius = 0.5
material = "glossy"

[[sphere]]
center = [0.1, 0.3, 1.3]
radius = 0.3

[[plane]]
point = [0, 0, 0]
normal = [0, 1, 0]
checker = { colors = [0.2, 0.7], size = 0.5 }

[[model]]
file = "tetrahedron.obj"
translate = [1, 0, 0]

[[model]]
file = "tetrahedron.obj"
translate = [0, 0, -1.5]
rotate = [0, 40, 0]
scale = [2, 1.5, 2]
material = "glossy"

[[model]]
file = "triangle.glb"
translate = [-0.5, 0.1, 2]
scale = 0.5

[[light]]
kind = "point"
position = [4, 5, 4]
intensity = 0.6

[[light]]
kind = "directional"
direction = [1, -2, -1]
intensity = 0.3

[[light]]
kind = "spot"
position = [0, 4, 1]
direction = [0, -1, 0]
inner_angle = 10
outer_angle = 30

[[light]]
kind = "ambient"
intensity = 0.1
"##;

const TETRAHEDRON: &str = "\
v -0.5 0 0.5\nv 0.5 0 0.5\nv 0 0 -0.5\nv 0 1 0\n\
f 1 2 4\nf 2 3 4\nf 3 1 4\nf 1 3 2\n";

/// The outcome of a run of the command.
struct Run {
    status: Option<i32>,
    stdout: String,
    stderr: String,
}

impl Run {
    /// The run, which did its work and said nothing on stderr.
    #[track_caller]
    fn good(self) -> Self {
        assert_eq!((self.status, &*self.stderr), (Some(0), ""));
        self
    }

    /// Returns its standard output, which is JSON and nothing else.
    #[track_caller]
    fn json(&self) -> Value {
        serde_json::from_str(&self.stdout).unwrap_or_else(|e| panic!("{e} in {}", self.stdout))
    }

    /// The one message of a run that was refused, since the command line or an input is wrong.
    #[track_caller]
    fn refused(self) -> String {
        self.ended_with(2)
    }

    /// The one message of a run whose work failed.
    #[track_caller]
    fn failed(self) -> String {
        self.ended_with(1)
    }

    /// The one message of a run that ended with this exit status: with nothing on stdout, and no trace
    /// of a panic.
    #[track_caller]
    fn ended_with(self, expected: i32) -> String {
        let Self { status, stdout, stderr } = self;
        assert_eq!((status, &*stdout), (Some(expected), ""), "{stderr}");
        assert!(stderr.starts_with("error: "), "{stderr}");
        let messages = stderr.lines().filter(|l| l.contains("error:") || l.contains("warning:"));
        assert_eq!(messages.count(), 1, "more than one message: {stderr}");
        for word in ["panicked", "RUST_BACKTRACE", "src/", "unwrap", "Err("] {
            assert!(!stderr.contains(word), "`{word}` in {stderr}");
        }
        stderr
    }
}

/// A folder in which the command is run, gone with the test.
struct Folder(tempfile::TempDir);

impl Folder {
    fn new() -> Self {
        Self(tempfile::tempdir().unwrap())
    }

    /// A folder with a file `scene.toml`.
    fn with(scene: &str) -> Self {
        let folder = Self::new();
        folder.write("scene.toml", scene);
        folder
    }

    /// A folder with the scene that has everything in it.
    fn with_everything() -> Self {
        let folder = Self::with(EVERYTHING);
        folder.write("tetrahedron.obj", TETRAHEDRON);
        folder.write("triangle.glb", envers_testing::Model::triangle().glb());
        folder
    }

    fn path(&self, name: impl AsRef<Path>) -> PathBuf {
        self.0.path().join(name)
    }

    fn write(&self, name: impl AsRef<Path>, bytes: impl AsRef<[u8]>) {
        std::fs::write(self.path(name), bytes).unwrap();
    }

    #[track_caller]
    fn read(&self, name: impl AsRef<Path>) -> Vec<u8> {
        let path = self.path(name);
        std::fs::read(&path).unwrap_or_else(|e| panic!("{}: {e}", path.display()))
    }

    fn has(&self, name: &str) -> bool {
        std::fs::symlink_metadata(self.path(name)).is_ok()
    }

    /// The names of all files in it, sorted.
    fn names(&self) -> Vec<String> {
        let entries = std::fs::read_dir(self.0.path()).unwrap();
        let mut names: Vec<String> =
            entries.map(|e| e.unwrap().file_name().to_string_lossy().into_owned()).collect();
        names.sort();
        names
    }

    /// Runs `envers` with the words of `arguments`.
    #[track_caller]
    fn run(&self, arguments: &str) -> Run {
        self.run_with(arguments.split_whitespace())
    }

    /// Runs `envers` with these arguments.
    #[track_caller]
    fn run_with(&self, arguments: impl IntoIterator<Item = impl AsRef<OsStr>>) -> Run {
        self.run_program(env!("CARGO_BIN_EXE_envers"), arguments)
    }

    /// Runs a script of bash, in which `envers` is the command.
    #[cfg(unix)]
    #[track_caller]
    fn run_script(&self, script: &str) -> Run {
        let script = format!("envers() {{ (exec \"$0\" \"$@\"); }}; {script}");
        self.run_program("bash", ["-c", &script, env!("CARGO_BIN_EXE_envers")])
    }

    #[track_caller]
    fn run_program(
        &self,
        program: &str,
        arguments: impl IntoIterator<Item = impl AsRef<OsStr>>,
    ) -> Run {
        let output = assert_cmd::Command::new(program)
            .args(arguments)
            .current_dir(self.0.path())
            .timeout(Duration::from_secs(60))
            .output()
            .unwrap();
        let text = |bytes| String::from_utf8(bytes).expect("the command prints UTF-8");
        let (stdout, stderr) = (text(output.stdout), text(output.stderr));
        assert!(output.status.code().is_some(), "killed, or took too long: {stdout}{stderr}");
        Run { status: output.status.code(), stdout, stderr }
    }
}

/// The size and the RGB bytes of a PNG.
fn pixels(png: &[u8]) -> ((u32, u32), Vec<u8>) {
    let image = image::load_from_memory_with_format(png, image::ImageFormat::Png).unwrap();
    let image = image.into_rgb8();
    (image.dimensions(), image.into_raw())
}

/// True if the tests run as a user whom no permission stops.
#[cfg(unix)]
fn is_root() -> bool {
    use std::os::unix::fs::MetadataExt;
    tempfile::tempfile().unwrap().metadata().unwrap().uid() == 0
}
