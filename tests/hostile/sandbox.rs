//! Files from strangers name files elsewhere: none of those is opened.
//!
//! The kernel tells of each opening: inotify reports every opening of a file in the folders
//! outside, whoever does it and however. One test shows that it would be seen.

use std::mem::MaybeUninit;
use std::os::unix::fs::symlink;
use std::os::unix::net::UnixListener;
use std::path::Path;

use envers::LoadOptions;
use envers_testing::{Folder, Model, data_uri, png};
use rustix::fs::inotify;
use serde_json::json;

/// A folder `scene` for strangers' files, and beside it what they want.
struct Folders {
    folder: Folder,
    watch: rustix::fd::OwnedFd,
    _socket: UnixListener,
}

impl Folders {
    fn new() -> Self {
        let folder = Folder::new();
        for file in ["secret", "scene-2/secret", "far/away/secret"] {
            write_secrets(&folder, file);
        }
        write_secrets(&folder, "scene/inside/own");
        let scene = folder.path("scene");
        let outside = folder.path("far");
        for ending in ENDINGS {
            let link = |to: &Path, name: &str| symlink(to, scene.join(name)).unwrap();
            let secret = folder.path(&format!("secret.{ending}"));
            link(&secret, &format!("link.{ending}"));
            link(Path::new(&format!("../secret.{ending}")), &format!("relative.{ending}"));
            link(Path::new(&format!("link.{ending}")), &format!("chain.{ending}"));
            link(Path::new("/dev/zero"), &format!("zero.{ending}"));
            link(Path::new("/proc/self/environ"), &format!("environ.{ending}"));
            let fifo = scene.join(format!("fifo.{ending}"));
            rustix::fs::mknodat(
                rustix::fs::CWD,
                &fifo,
                rustix::fs::FileType::Fifo,
                rustix::fs::Mode::RUSR | rustix::fs::Mode::WUSR,
                0,
            )
            .unwrap();
            std::fs::create_dir(scene.join(format!("folder.{ending}"))).unwrap();
        }
        symlink(&outside, scene.join("door")).unwrap();
        let socket = UnixListener::bind(scene.join("socket.bin")).unwrap();
        let flags = inotify::CreateFlags::NONBLOCK | inotify::CreateFlags::CLOEXEC;
        let watch = inotify::init(flags).unwrap();
        let events = inotify::WatchFlags::OPEN | inotify::WatchFlags::ACCESS;
        for name in ["", "scene-2", "far", "far/away"] {
            inotify::add_watch(&watch, folder.path(name), events).unwrap();
        }
        Self { folder, watch, _socket: socket }
    }

    /// The files outside that were opened since this was last asked.
    fn opened(&self) -> Vec<String> {
        let mut buffer = [MaybeUninit::uninit(); 4096];
        let mut reader = inotify::Reader::new(&self.watch, &mut buffer);
        let mut names = Vec::new();
        while let Ok(event) = reader.next() {
            // To pass through a folder is not to open it for reading; a file has a name.
            if let Some(name) =
                event.file_name().filter(|_| !event.events().contains(inotify::ReadFlags::ISDIR))
            {
                names.push(name.to_string_lossy().into_owned());
            }
        }
        names
    }
}

const ENDINGS: [&str; 5] = ["bin", "png", "mtl", "obj", "gltf"];

/// Files of each kind with one name, which load if they are read.
fn write_secrets(folder: &Folder, name: &str) {
    folder.write(&format!("{name}.bin"), Model::triangle().bin());
    folder.write(&format!("{name}.png"), png(&[[1, 2, 3, 255]]));
    folder.write(&format!("{name}.mtl"), "newmtl secret\nKd 0.125 0.25 0.5\n");
    folder.write(&format!("{name}.obj"), "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    let gltf = Model::triangle().to_json(Some("secret.bin")).to_string();
    folder.write(&format!("{name}.gltf"), gltf);
}

/// The names that a stranger writes to have a file elsewhere read, which ends in `EXT`. `TOP` is the path
/// of the folder above his.
const ATTACKS: &[&str] = &[
    "../secret.EXT",
    "./../secret.EXT",
    ".//..//secret.EXT",
    "inside/../../secret.EXT",
    "inside/../../scene/../secret.EXT",
    "missing/../../secret.EXT",
    "../scene-2/secret.EXT",
    "../far/away/secret.EXT",
    "..\\secret.EXT",
    "inside\\..\\..\\secret.EXT",
    "%2e%2e/secret.EXT",
    "%2E%2E%2Fsecret.EXT",
    "..%2fsecret.EXT",
    "..%5csecret.EXT",
    "inside/%2e%2e/%2e%2e/secret.EXT",
    "../%73ecret.EXT",
    "TOP/secret.EXT",
    "/TOP/secret.EXT",
    "TOP/./far/../secret.EXT",
    "%2FTOP/secret.EXT",
    "file://TOP/secret.EXT",
    "file:TOP/secret.EXT",
    "FILE://localhostTOP/secret.EXT",
    "file:../secret.EXT",
    "file:%2e%2e/secret.EXT",
    "link.EXT",
    "relative.EXT",
    "chain.EXT",
    "inside/../link.EXT",
    "door/away/secret.EXT",
    "door/../secret.EXT",
    "door/away/../../secret.EXT",
    "/proc/self/root/TOP/secret.EXT",
    "/proc/self/cwd/../../../../../../../../TOP/secret.EXT",
    "/proc/thread-self/root/TOP/secret.EXT",
    "~/../../../../TOP/secret.EXT",
    "../secret.EXT%00.png",
    "../secret.EXT?query",
    "../secret.EXT#part",
    "http://127.0.0.1:9/secret.EXT",
    "https://127.0.0.1:9/secret.EXT",
    "ftp://127.0.0.1/secret.EXT",
    "//127.0.0.1/share/secret.EXT",
    "\\\\127.0.0.1\\share\\secret.EXT",
    // These are within, and no files.
    "fifo.EXT",
    "folder.EXT",
    "zero.EXT",
    "environ.EXT",
    ".",
    "/",
    "/dev/zero",
    "/dev/stdin",
    "/etc/passwd",
    "/proc/self/environ",
];

/// The kinds of references: what the files named have for an ending, and a file that refers to one.
type Reference = (&'static str, &'static str, fn(&str) -> String);

const REFERENCES: [Reference; 6] = [
    ("bin", "stranger.gltf", |name| {
        let mut model = Model::triangle().to_json(Some(name));
        model["buffers"][0]["uri"] = name.into();
        model.to_string()
    }),
    ("png", "stranger.gltf", |name| {
        let mut model = Model::triangle();
        model.material(json!({"pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}}));
        let uvs = model.floats("VEC2", &[0.0; 6]);
        model.primitive()["attributes"]["TEXCOORD_0"] = uvs.into();
        model.json["textures"] = json!([{"source": 0}]);
        model.json["images"] = json!([{"uri": name}]);
        model.to_json(Some(&data_uri(model.bin()))).to_string()
    }),
    ("mtl", "stranger.obj", |name| {
        format!("mtllib {name}\nusemtl secret\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")
    }),
    ("png", "stranger.mtl", |name| format!("newmtl red\nKd 1 0 0\nmap_Kd {name}\n")),
    ("obj", "stranger.toml", |name| format!("[[model]]\nfile = {name:?}\n")),
    ("png", "stranger.toml", |name| {
        format!(
            "camera = {{ position = [0, 0, 9], look_at = [0, 0, 0], fov_y = 40 }}\n\
             [[material]]\nname = \"m\"\ndiffuse_map = {name:?}\n\
             [[sphere]]\ncenter = [0, 0, 0]\nradius = 1\nmaterial = \"m\"\n"
        )
    }),
];

/// Writes a file that refers to a name, and loads it; the texts of its error or warnings.
fn load(place: &Folders, (_, file, text): &Reference, name: &str, allow_outside: bool) -> String {
    let path = place.folder.write(&format!("scene/{file}"), text(name));
    let path = match *file {
        "stranger.mtl" => place.folder.write(
            "scene/stranger.obj",
            "mtllib stranger.mtl\nusemtl red\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nf 1/1 2/1 3/1\n",
        ),
        _ => path,
    };
    let options = LoadOptions::default().allow_outside(allow_outside);
    match options.load(&path) {
        Ok(loaded) => loaded.report.warnings.join("\n"),
        Err(error) => error.to_string(),
    }
}

fn attacks(place: &Folders, ending: &str) -> Vec<String> {
    let top = place.folder.path("").canonicalize().unwrap();
    let name = |attack: &&str| attack.replace("TOP", top.to_str().unwrap()).replace("EXT", ending);
    ATTACKS.iter().map(name).collect()
}

#[test]
fn no_file_outside_is_opened() {
    let place = Folders::new();
    assert_eq!(place.opened(), [""; 0]);
    for reference in &REFERENCES {
        let (ending, file, _) = reference;
        for attack in attacks(&place, ending) {
            let said = load(&place, reference, &attack, false);
            assert_eq!(place.opened(), [""; 0], "{file}: {attack}");
            assert!(!said.is_empty(), "{file}: nothing is said of {attack}");
        }
    }
}

/// The watch sees what is opened, so that the test above can fail.
#[test]
fn files_outside_are_seen_to_be_opened_where_they_are_allowed() {
    let place = Folders::new();
    for reference in &REFERENCES {
        let (ending, file, _) = reference;
        for name in [format!("../secret.{ending}"), format!("link.{ending}")] {
            let said = load(&place, reference, &name, true);
            assert!(said.is_empty(), "{file}: {said}");
            let opened = place.opened();
            assert!(opened.contains(&format!("secret.{ending}")), "{file}: {opened:?}");
        }
    }
}

#[test]
fn an_absolute_uri_is_read_where_files_outside_are_allowed() {
    let place = Folders::new();
    let uri = format!("file://{}", place.folder.path("secret.bin").display());
    assert_eq!(load(&place, &REFERENCES[0], &uri, true), "");
    assert!(place.opened().contains(&"secret.bin".to_owned()));
}

#[test]
fn pipes_and_devices_are_not_opened_even_where_files_outside_are_allowed() {
    let place = Folders::new();
    for reference in &REFERENCES {
        let (ending, file, _) = reference;
        for name in [format!("fifo.{ending}"), format!("zero.{ending}"), format!("folder.{ending}")]
        {
            let said = load(&place, reference, &name, true);
            let what = if name.starts_with("folder") { "a folder" } else { "a pipe or a device" };
            assert!(said.contains(what), "{file}: {name}: {said}");
        }
    }
}

#[test]
fn a_socket_is_no_file() {
    let place = Folders::new();
    let said = load(&place, &REFERENCES[0], "socket.bin", false);
    assert!(said.contains("a pipe or a device"), "{said}");
}

#[test]
fn the_error_names_the_folder_and_the_way_out() {
    let place = Folders::new();
    for reference in &REFERENCES {
        let said = load(&place, reference, &format!("../secret.{}", reference.0), false);
        let scene = place.folder.path("scene").canonicalize().unwrap();
        assert!(said.contains(&format!("it is not in the folder {}", scene.display())), "{said}");
        assert!(said.contains("allow others if you trust the file"), "{said}");
    }
}

/// A folder that becomes a link while its files are opened.
#[test]
fn no_file_outside_is_opened_in_a_race() {
    let place = Folders::new();
    let (inside, away) = (place.folder.path("scene/inside"), place.folder.path("scene/moved"));
    let over = std::sync::atomic::AtomicBool::new(false);
    std::thread::scope(|scope| {
        scope.spawn(|| {
            while !over.load(std::sync::atomic::Ordering::Relaxed) {
                std::fs::rename(&inside, &away).unwrap();
                symlink("../far/away", &inside).unwrap();
                std::fs::remove_file(&inside).unwrap();
                std::fs::rename(&away, &inside).unwrap();
            }
        });
        for _ in 0..5000 {
            load(&place, &REFERENCES[0], "inside/secret.bin", false);
        }
        over.store(true, std::sync::atomic::Ordering::Relaxed);
    });
    assert_eq!(place.opened(), [""; 0]);
}

#[test]
fn files_below_the_folder_are_read_by_any_name_that_leads_there() {
    let place = Folders::new();
    for reference in &REFERENCES {
        let ending = reference.0;
        symlink("inside", place.folder.path("scene/door-within")).ok();
        let within = place.folder.path(&format!("scene/inside/own.{ending}"));
        let names = [
            format!("inside/own.{ending}"),
            format!("./inside/../inside/own.{ending}"),
            format!("../scene/inside/own.{ending}"),
            format!("door-within/own.{ending}"),
            within.display().to_string(),
        ];
        for name in names {
            let said = load(&place, reference, &name, false);
            // The materials of the file within have another name.
            assert!(
                !said.contains("cannot") && !said.contains("not in the folder"),
                "{name}: {said}"
            );
        }
    }
}

#[test]
fn a_model_in_a_scene_may_name_what_is_in_the_folder_of_the_scene() {
    let place = Folders::new();
    place.folder.write("scene/models/a.mtl", "newmtl m\nmap_Kd ../inside/own.png\n");
    place.folder.write(
        "scene/models/a.obj",
        "mtllib a.mtl\nusemtl m\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nf 1/1 2/1 3/1\n",
    );
    let scene = place.folder.write("scene/a.toml", "[[model]]\nfile = \"models/a.obj\"\n");
    assert_eq!(envers::load(&scene).unwrap().report.warnings, [""; 0]);
    // By itself the model has a folder of its own.
    let alone = envers::load(place.folder.path("scene/models/a.obj")).unwrap();
    assert!(alone.report.warnings[0].contains("not in the folder"), "{:?}", alone.report.warnings);
}

#[test]
fn a_file_may_be_named_through_a_link_and_has_the_folder_of_the_link() {
    let place = Folders::new();
    let target = place.folder.path("far/away/secret.gltf");
    let link = place.folder.path("scene/entry.gltf");
    symlink(target, &link).unwrap();
    // Its buffer is beside what the link leads to, not beside the link.
    let error = envers::load(&link).unwrap_err().to_string();
    assert!(error.contains("secret.bin"), "{error}");
}
