//! Scene files.

use super::{Case, Error, Expect, Loads, Warning};
use envers_testing::{Model, png};

const CAMERA: &str = "[camera]\nposition = [0, 0, 9]\nlook_at = [0, 0, 0]\nfov_y = 40\n";

/// Lines after a camera, and what comes of them.
const LINES: &[(&str, Expect)] = &[
    ("[film]\nsize = [0, 0]", Error("hostile.toml:6")),
    ("[film]\nsize = [1000000, 1000000]", Error("hostile.toml:6")),
    ("[film]\nsize = [4294967296, 1]", Error("hostile.toml:6")),
    ("[film]\nsize = [-1, 5]", Error("hostile.toml:6")),
    ("[film]\nsize = [1]", Error("hostile.toml:6")),
    ("[film]\nspp = 18446744073709551616", Error("hostile.toml:6")),
    ("[film]\nspp = 0", Error("hostile.toml:6")),
    ("[film]\nmax_depth = 99999999", Error("hostile.toml:6")),
    ("[film]\nexposure = nan", Error("hostile.toml:6")),
    ("[film]\nexposure = 1e308", Expect::Any),
    ("[film]\nbackground = \"#\"", Error("hostile.toml:6")),
    ("[film]\nbackground = [inf, 0, 0]", Error("hostile.toml:6")),
    ("[film]\nadaptive = [5, 1]", Error("hostile.toml:6")),
    ("[[sphere]]\ncenter = [nan, 0, 0]\nradius = 1", Error("hostile.toml:6")),
    ("[[sphere]]\ncenter = [1e308, 1e308, 0]\nradius = 1", Error("hostile.toml:")),
    ("[[sphere]]\ncenter = [0, 0, 0]\nradius = -1", Error("hostile.toml:7")),
    ("[[sphere]]\ncenter = [0, 0, 0]\nradius = 0", Error("hostile.toml:7")),
    ("[[sphere]]\ncenter = [0, 0, 0]\nradius = 5e-324", Expect::Any),
    ("[[sphere]]\ncenter = [0, 0, 0]\nradius = inf", Error("hostile.toml:7")),
    ("[[sphere]]\ncenter = []\nradius = 1", Error("hostile.toml:6")),
    ("[[sphere]]\ncenter = [0, 0, 0]\nradius = 1\nmaterial = \"m\"", Error("hostile.toml:8")),
    ("[[plane]]\npoint = [0, 0, 0]\nnormal = [0, 0, 0]", Error("hostile.toml:7")),
    ("[[plane]]\npoint = [0, 0, 0]\nnormal = [1e-320, 0, 0]", Expect::Any),
    ("[[plane]]\npoint = [0, 0, 0]\nnormal = [1e308, 1e308, 1e308]", Expect::Any),
    ("[[plane]]\npoint = [0, 0, 0]\nnormal = [0, 1, 0]\ntexture_size = 0", Error("hostile.toml:8")),
    ("[[light]]\nkind = \"sun\"", Error("hostile.toml:6")),
    ("[[light]]\nkind = \"point\"\nposition = [0, 0, 0]\nintensity = inf", Error("hostile.toml:8")),
    ("[[light]]\nkind = \"directional\"\ndirection = [0, 0, 0]", Error("hostile.toml:7")),
    ("[[material]]\nname = \"m\"\nior = 0", Error("hostile.toml:7")),
    ("[[material]]\nname = \"m\"\nior = nan", Error("hostile.toml:7")),
    ("[[material]]\nname = \"m\"\nreflect = 2", Error("hostile.toml:7")),
    ("[[material]]\nname = \"m\"\ndiffuse_map = \"gone.png\"", Error("hostile.toml:7")),
    ("[[material]]\nname = \"m\"\ndiffuse_map = \"..\"", Error("hostile.toml:7")),
    ("[[material]]\nname = \"m\"\ndiffuse_map = \"\"", Error("hostile.toml:7")),
    ("[[material]]\nname = \"m\"\ndiffuse_map = \"\\u0000\"", Error("hostile.toml:7")),
    ("[[material]]\nname = \"m\"\ndiffuse_map = \"/dev/zero\"", Error("hostile.toml:7")),
    ("[[material]]\nname = \"m\"\n[[material]]\nname = \"m\"", Error("hostile.toml:8")),
    ("[[model]]\nfile = \"gone.obj\"", Error("hostile.toml:6")),
    ("[[model]]\nfile = \"hostile.toml\"", Error("hostile.toml:6")),
    ("[[model]]\nfile = \"../a.obj\"", Error("not in the folder")),
    ("[[model]]\nfile = \"/etc/passwd\"", Error("hostile.toml:6")),
    ("[[model]]\nfile = \"a.obj\"\nscale = 0", Error("hostile.toml:7")),
    ("[[model]]\nfile = \"a.obj\"\nscale = 1e300", Error("hostile.toml:")),
    ("[[model]]\nfile = \"a.obj\"\nscale = 1e-300", Expect::Any),
    ("[[model]]\nfile = \"a.obj\"\nrotate = [1e308, nan, 0]", Error("hostile.toml:7")),
    ("[[model]]\nfile = \"a.obj\"\nrotate = [1e308, -1e308, 1e17]", Expect::Any),
    ("[[model]]\nfile = \"a.obj\"\ntranslate = [1e16, 0, 0]", Error("hostile.toml:")),
    ("[[model]]\nfile = \"a.obj\"\nanimation = \"walk\"", Error("no animations")),
    ("[animation]\nframes = 4000000000", Error("hostile.toml:6")),
    ("[animation]\nframes = 10\nfps = 0", Error("hostile.toml:7")),
    ("camera.position = 5", Error("hostile.toml:")),
    ("[camera]", Error("hostile.toml:")),
    ("a = 1", Error("hostile.toml:")),
    ("[a.b.c.d]\ne = 1", Error("hostile.toml:")),
    ("\"\\uD800\" = 1", Error("hostile.toml:")),
    ("x = \"\"\"", Error("hostile.toml:")),
    ("x = 0x", Error("hostile.toml:")),
    ("x = 1979-99-99", Error("hostile.toml:")),
    ("\u{202e} = 1", Error("hostile.toml:")),
    ("[film]\nexposure = 1\u{1b}[2J", Error("hostile.toml:")),
];

pub fn cases() -> Vec<Case> {
    let line = |&(lines, expect): &(&str, Expect)| {
        Case::new(format!("toml {lines:?}"), "hostile.toml", format!("{CAMERA}{lines}\n"), expect)
            .with("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")
    };
    let mut cases: Vec<Case> = LINES.iter().map(line).collect();
    let mut case = |name: &str, text: Vec<u8>, expect| {
        cases.push(Case::new(format!("toml {name}"), "hostile.toml", text, expect));
    };
    let after = |rest: String| format!("{CAMERA}{rest}").into_bytes();
    case("of no bytes", vec![], Error("neither"));
    case("of zeros", vec![0; 1 << 16], Error("hostile.toml:1"));
    case("of bytes that are no text", vec![0xFF; 1 << 16], Error("UTF-8"));
    case("of a million brackets", vec![b'['; 1 << 20], Error("hostile.toml:"));
    case(
        "array nested 100000 deep",
        after(format!("x = {}", "[".repeat(100_000))),
        Error("hostile.toml:"),
    );
    case(
        "tables nested 100000 deep",
        after(format!("x = {}", "{ a = ".repeat(100_000))),
        Error("hostile.toml:"),
    );
    case(
        "key of 100000 parts",
        after(format!("{}a = 1", "a.".repeat(100_000))),
        Error("hostile.toml:"),
    );
    case(
        "header of 100000 parts",
        after(format!("[{}a]", "a.".repeat(100_000))),
        Error("hostile.toml:"),
    );
    case(
        "key of a megabyte",
        after(format!("{} = 1", "a".repeat(1 << 20))),
        Error("hostile.toml:"),
    );
    case(
        "line of a megabyte",
        after(format!("x = \"{}\"", "a".repeat(1 << 20))),
        Error("hostile.toml:"),
    );
    case(
        "of 30000 unknown keys",
        after((0..30_000).map(|i| format!("k{i} = 1\n")).collect()),
        Error("hostile.toml:"),
    );
    case(
        "of 20000 spheres in 20000 materials",
        {
            let pair = |i: usize| {
                format!(
                    "[[material]]\nname = \"m{i}\"\n[[sphere]]\ncenter = [{i}, 0, 0]\nradius = 1\nmaterial = \"m{i}\"\n"
                )
            };
            after((0..20_000).map(pair).collect())
        },
        Loads,
    );
    case(
        "of 50000 materials that are too bright",
        {
            let one = |i: usize| format!("[[material]]\nname = \"m{i}\"\ndiffuse = [9, 9, 9]\n");
            after((0..50_000).map(one).collect())
        },
        Expect::Any,
    );
    case(
        "of 50000 cameras with one name",
        CAMERA.replace("[camera]", "[[camera]]\nname = \"a\"").repeat(50_000).into_bytes(),
        Expect::Any,
    );
    case(
        "of 50000 lights",
        after("[[light]]\nkind = \"point\"\nposition = [0, 0, 0]\n".repeat(50_000)),
        Expect::Any,
    );
    let mut with = |name: &str, text: String, file: &str, bytes: Vec<u8>, expect| {
        cases.push(
            Case::new(format!("toml {name}"), "hostile.toml", text, expect).with(file, bytes),
        );
    };
    // 3000 times 3000 lights from 200 kB.
    let mut lamps = Model::triangle();
    lamps.json["extensionsUsed"] = serde_json::json!(["KHR_lights_punctual"]);
    lamps.json["extensions"] =
        serde_json::json!({"KHR_lights_punctual": {"lights": [{"type": "point"}]}});
    let lamp = serde_json::json!({"extensions": {"KHR_lights_punctual": {"light": 0}}});
    lamps.json["nodes"] = vec![lamp; 3000].into();
    lamps.json["scenes"][0]["nodes"] = (0..3000).collect();
    with(
        "of 3000 models of 3000 lights",
        "[[model]]\nfile = \"a.glb\"\n".repeat(3000),
        "a.glb",
        lamps.glb(),
        Error("`--limit instances="),
    );
    let mut many = Model::triangle();
    many.json["nodes"] = vec![serde_json::json!({"mesh": 0}); 3000].into();
    many.json["scenes"][0]["nodes"] = (0..3000).collect();
    with(
        "of 3000 models of 3000 meshes",
        "[[model]]\nfile = \"a.glb\"\n".repeat(3000),
        "a.glb",
        many.glb(),
        Error("`--limit instances="),
    );
    let named = |i: usize| format!("[[model]]\nfile = \"{}a.glb\"\n", "./".repeat(i % 60));
    with(
        "of 20000 models by different names",
        (0..20_000).map(named).collect(),
        "a.glb",
        Model::triangle().glb(),
        Warning("stand at the same place"),
    );
    let picture = |i: usize| {
        format!(
            "[[material]]\nname = \"{i}\"\ndiffuse_map = \"{}a.png\"\n[[sphere]]\ncenter = [0, 0, 0]\nradius = 1\nmaterial = \"{i}\"\n",
            "./".repeat(i % 60)
        )
    };
    let text = CAMERA.to_owned() + &(0..5000).map(picture).collect::<String>();
    with(
        "of one picture by 60 names",
        text,
        "a.png",
        super::encode::flat_png(2048, 2048),
        Warning("stand at the same place"),
    );
    with(
        "with a picture that is none",
        format!("{CAMERA}{}", picture(0)),
        "a.png",
        png(&[[0; 4]])[..30].to_vec(),
        Error("cannot be decoded"),
    );
    cases
}
