//! Whatever the text, there is a scene or an error that names the file, and no panic.

use proptest::prelude::*;
use proptest::test_runner::RngSeed;

use super::File;

/// A file with every table in it and most keys.
const VALID: &str = r##"
[film]
size = [1000, 500]
spp = 1
transfer = "none"
background = "#323232"
sample_position = "corner"
exposure = -0.5
tone = "reinhard"

[[camera]]
name = "é"
position = [0, 0, 0]
look_at = [0, 0, 1]
up = [0, -1, 0]
focal_px = 500

[[material]]
name = "blue"
diffuse = "#3454d8"
specular = [1, 1, 1]
shininess = 50
emission = 0.0
double_sided = true

[[sphere]]
name = "ball"
center = [0, 0, 10]
radius = 1
material = "blue"
casts_shadow = false

[animation]
frames = 12
fps = 24

[[animation.orbit]]
object = "ball"
around = "é"
period = 2
axis = [0, 1, 0]
turn = true

[[animation.track]]
object = "é"
times = [0, 1]
interpolation = "smooth"
position = [[0, 0, 0], [1, 0, 0]]
focal_px = [500, 600]

[[plane]]
point = [0, 1, 0]
normal = [0, -1, 0]
checker = { colors = ["#fff", 0.25], size = 1.5 }
texture_size = 2

[[light]]
kind = "spot"
position = [-20, -25, -15]
direction = [1, 1, 1]
inner_angle = 10
outer_angle = 20.5
color = [1, 1, 1]
intensity = 1
falloff = "inverse_square"
range = 100
shadow = true

[[light]]
kind = "ambient"
"##;

fn loads_or_says_why(bytes: &[u8]) {
    let file = File::new(bytes);
    if let Err(error) = file.load() {
        assert_eq!(error.path(), Some(&*file.path()), "{error}");
        // Its own checks find what is wrong before the scene's do, which know of no lines.
        assert!(error.location().is_some(), "no place: {error}");
    }
}

/// A piece that can stand in a scene file, to put in the place of another.
fn piece() -> impl Strategy<Value = String> {
    const PIECES: &[&str] = &[
        "0",
        "-1",
        "nan",
        "inf",
        "1e308",
        "1e-308",
        "1e15",
        "99999999999999999999",
        "true",
        "\"\"",
        "\"blue\"",
        "\"#fff\"",
        "[]",
        "[0, 0, 0]",
        "[1, 1]",
        "{}",
        "{ a = 1 }",
        "1979-05-27",
        "=",
        "[[sphere]]",
        "[camera]",
        "[[model]]",
        "file = \"x.glb\"",
        "#",
        "\n",
        "é",
        "\"",
        "'''",
        "position",
        "center",
        "kind",
        "\"point\"",
        "\"directional\"",
        ".",
        ",",
        "\0",
        "\r",
    ];
    prop_oneof![
        4 => proptest::sample::select(PIECES).prop_map(str::to_owned),
        1 => any::<f64>().prop_map(|x| format!("{x:?}")),
        1 => any::<i64>().prop_map(|x| x.to_string()),
        1 => ".{0,8}",
    ]
}

/// The configuration: the same cases each time; `PROPTEST_RNG_SEED` and `PROPTEST_CASES` explore others.
fn config() -> ProptestConfig {
    let mut config = ProptestConfig { failure_persistence: None, ..ProptestConfig::default() };
    if std::env::var_os("PROPTEST_RNG_SEED").is_none() {
        config.rng_seed = RngSeed::Fixed(2);
    }
    if std::env::var_os("PROPTEST_CASES").is_none() {
        config.cases = 1000;
    }
    config
}

proptest! {
    #![proptest_config(config())]

    #[test]
    fn any_bytes(bytes in proptest::collection::vec(any::<u8>(), 0..200)) {
        loads_or_says_why(&bytes);
    }

    #[test]
    fn any_text(text in "(\\PC|\n){0,100}") {
        loads_or_says_why(text.as_bytes());
    }

    #[test]
    fn a_valid_file_with_one_value_changed(line in any::<prop::sample::Index>(), new in piece()) {
        let mut lines: Vec<String> = VALID.lines().map(str::to_owned).collect();
        let line = line.index(lines.len());
        if let Some((key, _)) = lines[line].split_once('=') {
            lines[line] = format!("{key}= {new}");
        } else {
            lines[line] = new;
        }
        loads_or_says_why(lines.join("\n").as_bytes());
    }

    #[test]
    fn a_valid_file_with_a_piece_cut_out(
        from in any::<prop::sample::Index>(), length in 0..60usize, new in piece(),
    ) {
        let from = from.index(VALID.len());
        let to = (from + length).min(VALID.len());
        let bytes = [&VALID.as_bytes()[..from], new.as_bytes(), &VALID.as_bytes()[to..]].concat();
        loads_or_says_why(&bytes);
    }

    #[test]
    fn a_valid_file_with_lines_left_out(keep in proptest::collection::vec(any::<bool>(), 64)) {
        let lines = VALID.lines().zip(&keep).filter(|(_, keep)| **keep).map(|(line, _)| line);
        loads_or_says_why(lines.collect::<Vec<_>>().join("\n").as_bytes());
    }
}

#[test]
fn the_valid_file_is_valid() {
    super::scene(VALID);
}
