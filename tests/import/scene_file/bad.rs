//! The mistakes in scene files, and the place at which the message points: the mark `¦`.

use envers::{Error, ErrorKind};

use super::{CAMERA, File, refused, refused_seen};

/// A sphere in three lines, of which one is the test's.
const CENTER: &str = "[[sphere]]\ncenter = [0, 0, 0]\n";

fn advice(error: &Error) -> &str {
    error.advice().unwrap_or_default()
}

/// The message is this, and so is the advice.
fn assert_says(error: &Error, message: &str, help: &str) {
    assert_eq!((error.message(), advice(error)), (message, help));
}

#[test]
fn an_unknown_key_is_at_the_key() {
    let error = refused_seen("[[sphere]]\n¦wavelength = 3\ncenter = [0, 0, 0]\nradius = 1\n");
    assert_says(
        &error,
        "[[sphere]] has no key `wavelength`",
        "its keys are `name`, `center`, `radius`, `material` and `casts_shadow`",
    );
    assert_eq!(error.kind(), ErrorKind::Input);
}

#[test]
fn an_unknown_key_of_an_inline_table_is_at_the_key() {
    let plane = "[[plane]]\npoint = [0, 0, 0]\nnormal = [0, 1, 0]\n";
    let error = refused_seen(&format!("{plane}checker = {{ ¦colours = [0, 1] }}\n"));
    assert_says(&error, "`plane.checker` has no key `colours`", "did you mean `colors`?");
}

#[test]
fn the_usual_misspellings_find_their_keys() {
    for (text, meant) in [
        ("[[sphere]]\n¦centre = [0, 0, 0]\n", "center"),
        ("[[sphere]]\n¦Center = [0, 0, 0]\n", "center"),
        ("[[sphere]]\n¦pos = [0, 0, 0]\n", "center"),
        ("[[sphere]]\n¦r = 1\n", "radius"),
        ("[[light]]\nkind = \"ambient\"\n¦colour = 1\n", "color"),
        ("[[light]]\n¦type = \"ambient\"\n", "kind"),
        ("[[material]]\n¦colour = 1\n", "diffuse"),
        ("[[material]]\n¦ks = 1\n", "specular"),
        ("[[model]]\n¦rotation = [0, 0, 0]\n", "rotate"),
        ("[[material]]\n¦refraction_index = 1.5\n", "ior"),
        ("[[material]]\n¦glass = true\n", "transmit"),
        ("[[material]]\n¦opacity = 0.5\n", "transmit"),
        ("[[material]]\n¦attenuation = 1\n", "absorption"),
        ("[film]\n¦samples = 4\n", "spp"),
        ("[film]\n¦max_bounces = 4\n", "max_depth"),
        ("[film]\n¦resolution = [4, 4]\n", "size"),
        ("[[¦spheres]]\n", "sphere"),
    ] {
        assert_eq!(advice(&refused_seen(text)), format!("did you mean `{meant}`?"), "{text}");
    }
    for (key, meant) in [
        ("lookat", "look_at"),
        ("lookAt", "look_at"),
        ("target", "look_at"),
        ("pos", "position"),
        ("fov", "fov_y"),
        ("focal", "focal_px"),
    ] {
        let error = refused(&format!("[camera]\n¦{key} = [0, 0, 0]\n"));
        assert_eq!(advice(&error), format!("did you mean `{meant}`?"), "{key}");
    }
}

#[test]
fn a_key_in_the_wrong_table_is_sent_home() {
    let error = refused(&format!("¦size = [10, 10]\n{CAMERA}"));
    assert_says(&error, "a scene file has no key `size`", "it belongs in [film] or [[light]]");
    let error = refused(&format!("[camera]\n¦radius = 1\n{}", &CAMERA.replace("camera.", "")));
    assert_eq!(advice(&error), "it belongs in [[light]] or [[sphere]]");
}

#[test]
fn an_alpha_mode_without_a_picture_is_refused() {
    let error = refused_seen("[[material]]\nname = \"m\"\nalpha_mode = ¦\"blend\"\n");
    let message = "`alpha_mode` is about the alpha of an image, and there is none";
    assert_says(&error, message, "add a `diffuse_map`");
}

#[test]
fn an_alpha_cutoff_without_a_mask_is_refused() {
    let error = refused_seen("[[material]]\nname = \"m\"\nalpha_cutoff = ¦0.3\n");
    let message = "`alpha_cutoff` is about a mask, and there is none";
    assert_says(&error, message, "add `alpha_mode = \"mask\"`");
}

#[test]
fn a_blended_alpha_beside_transmit_is_refused() {
    let material = "[[material]]\nname = \"m\"\ntransmit = 1\nalpha_mode = ¦\"blend\"\n";
    let message = "`transmit` and a blended alpha both say what is seen through it";
    assert_says(&refused_seen(material), message, "leave one of them out");
}

#[test]
fn an_index_of_refraction_must_be_above_nothing() {
    for bad in ["0", "-1.5", "nan", "1e3"] {
        let error = refused_seen(&format!("[[material]]\nname = \"m\"\nior = ¦{bad}\n"));
        assert!(error.message().contains("an index of refraction from 0.01 to 100"), "{error}");
    }
}

#[test]
fn reflect_and_transmit_are_shares_of_one_whole() {
    let error =
        refused_seen("[[material]]\nname = \"m\"\nreflect = 0.5\ntransmit = ¦[0.5, 0.6, 0.5]\n");
    assert!(error.message().contains("more than 1 together"), "{error}");
    refused_seen("[[material]]\nname = \"m\"\nreflect = ¦1.5\n");
}

#[test]
fn a_depth_is_a_whole_number_up_to_65536() {
    for bad in ["-1", "65537", "1.5"] {
        let error = refused(&format!("[film]\nmax_depth = ¦{bad}\n{CAMERA}"));
        let expected = "`max_depth`: expected a whole number from 0 to 65536, found";
        assert_eq!(error.message(), format!("{expected} `{bad}`"));
    }
}

#[test]
fn a_priority_is_a_whole_number() {
    for bad in ["1.5", "5000000000"] {
        let error = refused_seen(&format!("[[material]]\nname = \"m\"\npriority = ¦{bad}\n"));
        let expected = "`priority`: expected a whole number from -2147483648 to 2147483647, found";
        assert_eq!(error.message(), format!("{expected} `{bad}`"));
    }
}

#[test]
fn a_shadow_is_there_or_not_tinted_or_opaque() {
    let light = "[[light]]\nkind = \"point\"\nposition = [0, 0, 0]\n";
    let error = refused_seen(&format!("{light}shadow = ¦\"soft\"\n"));
    assert!(error.message().contains("true, false, \"tinted\" or \"opaque\""), "{error}");
}

#[test]
fn a_missing_key_is_at_its_tables_header() {
    let error = refused_seen("\n  ¦[[sphere]]\ncenter = [0, 0, 0]\n");
    assert_eq!(error.message(), "[[sphere]] needs the key `radius`");
    let error = refused("¦[camera]\nlook_at = [0, 0, 0]\n");
    assert_eq!(error.message(), "[camera] needs the key `position`");
    let error = refused_seen("¦[animation]\nfps = 10\n");
    assert_eq!(error.message(), "[animation] needs the key `frames`");
}

#[test]
fn a_missing_key_of_a_later_table_is_at_that_one() {
    let error = refused_seen("[[material]]\nname = \"m\"\n¦[[material]]\ndiffuse = 1\n");
    assert_eq!(error.message(), "[[material]] needs the key `name`");
}

#[test]
fn nan_and_infinity_are_at_the_number() {
    for bad in ["nan", "-nan", "inf", "+inf", "-inf", "1e999"] {
        refused_seen(&format!("[[sphere]]\ncenter = [0, ¦{bad}, 0]\nradius = 1\n"));
        refused_seen(&format!("{CENTER}radius = ¦{bad}\n"));
        refused_seen(&format!("film.background = [0, 0, ¦{bad}]\n"));
        refused_seen(&format!("[[light]]\nkind = \"ambient\"\nintensity = ¦{bad}\n"));
        refused_seen(&format!("[[material]]\nname = \"m\"\nshininess = ¦{bad}\n"));
        refused(&format!("[[model]]\nfile = \"m.obj\"\nrotate = [¦{bad}, 0, 0]\n"));
    }
}

#[test]
fn a_radius_is_above_0() {
    for bad in ["0", "-1", "-0.0", "1e16"] {
        let error = refused_seen(&format!("{CENTER}radius = ¦{bad}\n"));
        let expected =
            format!("`radius`: expected a number above 0 (and at most 1e15), found `{bad}`");
        assert_eq!(error.message(), expected);
    }
}

#[test]
fn a_sphere_lies_within_reach() {
    refused_seen("[[sphere]]\ncenter = [¦2e15, 0, 0]\nradius = 1\n");
    refused_seen("[[sphere]]\ncenter = [1e15, 0, 0]\nradius = ¦1e15\n");
}

#[test]
fn a_wrong_type_says_what_was_found() {
    for (value, found) in [
        ("\"middle\"", "the string \"middle\""),
        ("3", "`3`"),
        ("true", "`true`"),
        ("1979-05-27", "`1979-05-27`"),
        ("{ x = 1 }", "a table"),
        ("[1, 2]", "a list of 2"),
        ("[1, 2, 3, 4, 5]", "a list of 5"),
    ] {
        let error = refused_seen(&format!("[[sphere]]\ncenter = ¦{value}\nradius = 1\n"));
        let expected = format!("`center`: expected three numbers, found {found}");
        assert_eq!(error.message(), expected);
    }
}

#[test]
fn a_wrong_type_within_a_list_is_at_the_element() {
    let error = refused_seen("[[sphere]]\ncenter = [0, ¦\"a\", 0]\nradius = 1\n");
    assert!(error.message().ends_with("found the string \"a\""), "{error}");
}

#[test]
fn a_switch_is_true_or_false() {
    let error = refused_seen(&format!("{CENTER}radius = 1\ncasts_shadow = ¦1\n"));
    assert_eq!(error.message(), "`casts_shadow`: expected true or false, found `1`");
}

#[test]
fn a_picture_of_no_size_is_refused() {
    for size in ["[0, 5]", "[5, 0]"] {
        let error = refused_seen(&format!("film.size = ¦{size}\n"));
        assert!(error.message().ends_with("pixels cannot be made"), "{error}");
    }
    refused_seen("film.size = [¦-5, 5]\n");
    refused_seen("film.size = [5, ¦1.5]\n");
    refused_seen("film.size = [¦5000000000, 5]\n");
}

#[test]
fn a_picture_of_a_million_by_a_million_is_refused() {
    let error = refused_seen("film.size = ¦[1000000, 1000000]\n");
    assert_says(
        &error,
        "a picture of 1000000x1000000 pixels cannot be made",
        "each side at least 1, and at most 268435456 pixels in all",
    );
}

#[test]
fn samples_are_from_1_to_65536() {
    for spp in ["0", "65537", "1.5"] {
        let error = refused_seen(&format!("film.spp = ¦{spp}\n"));
        let expected = "`spp`: expected a whole number from 1 to 65536, found";
        assert_eq!(error.message(), format!("{expected} `{spp}`"));
    }
}

#[test]
fn adaptive_samples_are_a_range_and_alone() {
    refused_seen("film.adaptive = ¦5\n");
    refused_seen("film.adaptive = [¦0, 5]\n");
    refused_seen("film.adaptive = [1, ¦65537]\n");
    let error = refused_seen("film.adaptive = ¦[9, 4]\n");
    assert!(error.message().contains("fewer than the fewest"), "{error}");
    let error = refused_seen("[film]\nspp = 4\nadaptive = ¦[1, 4]\n");
    assert_says(
        &error,
        "`spp` and `adaptive` both say how many samples a pixel has",
        "leave one of them out",
    );
    let error = refused_seen("film.threshold = ¦0.5\n");
    assert!(advice(&error).contains("adaptive = [1, 25]"), "{error}");
}

#[test]
fn a_word_that_is_no_choice_is_at_the_word() {
    for (line, help) in [
        ("film.transfer = ¦\"sRGB\"", "did you mean `srgb`?"),
        ("film.transfer = ¦\"linear\"", "did you mean `none`?"),
        ("film.transfer = ¦\"rec2020\"", "it is one of `srgb` and `none`"),
        ("film.tone = ¦\"filmic\"", "did you mean `aces`?"),
        (
            "film.tone = ¦\"log\"",
            "it is one of `none`, `reinhard`, `aces`, `khronos-pbr-neutral` and `agx`",
        ),
        ("film.sample_position = ¦\"centre\"", "did you mean `center`?"),
        ("[[light]]\nkind = ¦\"sun\"", "did you mean `directional`?"),
        ("[[light]]\nkind = \"point\"\nfalloff = ¦\"square\"", "it is one of"),
    ] {
        assert!(advice(&refused_seen(line)).starts_with(help), "{line}");
    }
    let error = refused_seen("film.transfer = ¦3\n");
    assert_eq!(error.message(), "`transfer`: expected a string, found `3`");
}

#[test]
fn a_colour_is_hex_or_numbers() {
    for bad in ["\"blue\"", "\"#12345\"", "\"323232\"", "[1, 2]", "true"] {
        let error = refused_seen(&format!("film.background = ¦{bad}\n"));
        assert!(error.message().starts_with("`background`: expected a colour"), "{error}");
    }
    refused_seen("film.background = [0, ¦-1, 0]\n");
    refused_seen("film.background = ¦-1\n");
}

#[test]
fn a_material_that_is_not_there_lists_those_that_are() {
    let materials = "[[material]]\nname = \"blue\"\n[[material]]\nname = \"glossy red\"\n";
    let sphere = format!("{materials}{CENTER}radius = 1\n");
    let error = refused_seen(&format!("{sphere}material = ¦\"bleu\"\n"));
    assert_says(
        &error,
        "there is no material `bleu`",
        "did you mean `blue`? The materials are `blue` and `glossy red`",
    );
    let error = refused_seen(&format!("{sphere}material = ¦\"wood\"\n"));
    assert_eq!(advice(&error), "the materials are `blue` and `glossy red`");
}

#[test]
fn a_material_where_there_are_none_says_how_to_add_it() {
    let error = refused_seen(&format!("{CENTER}radius = 1\nmaterial = ¦\"blue\"\n"));
    assert_eq!(advice(&error), "the file has none: add a [[material]] with this name");
}

#[test]
fn the_plain_grey_cannot_be_named() {
    let plain = format!("{CENTER}radius = 1\n");
    refused_seen(&format!("{plain}{plain}material = ¦\"default\"\n"));
}

#[test]
fn a_material_name_is_unique() {
    let error = refused_seen("[[material]]\nname = \"a\"\n[[material]]\nname = ¦\"a\"\n");
    assert_says(
        &error,
        "there is a material `a` already",
        "the first is in line 4; give each a name of its own",
    );
}

#[test]
fn a_camera_name_is_unique() {
    let camera = "position = [0, 0, 5]\nlook_at = [0, 0, 0]\n";
    refused(&format!("[[camera]]\n{camera}name = \"a\"\n[[camera]]\n{camera}name = ¦\"a\"\n"));
}

#[test]
fn a_camera_does_not_look_at_itself() {
    let error = refused("[camera]\nposition = [1, 2, 3]\nlook_at = ¦[1.0, 2.0, 3.0]\n");
    assert_eq!(error.message(), "the camera looks at the point where it stands");
}

#[test]
fn up_is_across_the_view() {
    let above = "[camera]\nposition = [0, 5, 0]\n";
    refused(&format!("{above}look_at = [0, 0, 0]\nup = ¦[0, -2, 0]\n"));
    // Where `up` is the default, the view is at fault.
    let error = refused(&format!("{above}look_at = ¦[0, 0, 0]\n"));
    assert!(advice(&error).contains("choose an `up` across the view"), "{error}");
    refused(&format!("{above}direction = ¦[0, 1, 0]\n"));
}

#[test]
fn a_direction_is_not_zero() {
    refused_seen("camera.up = ¦[0, 0, 0]\n");
    refused_seen("[[plane]]\npoint = [0, 0, 0]\nnormal = ¦[0, 0, 0]\n");
    refused_seen("[[light]]\nkind = \"directional\"\ndirection = ¦[0, 0.0, -0.0]\n");
}

#[test]
fn a_camera_looks_somewhere() {
    let error = refused("¦[camera]\nposition = [0, 0, 5]\n");
    assert_eq!(error.message(), "[camera] needs the key `look_at`, or `direction`");
    let second = "¦[[camera]]\nposition = [0, 0, 5]\n";
    refused(&format!("[[camera]]\nposition = [0, 0, 5]\nlook_at = [0, 0, 0]\n{second}"));
}

#[test]
fn a_camera_looks_one_way_only() {
    refused_seen("camera.¦direction = [0, 0, 1]\n");
}

#[test]
fn a_camera_has_one_lens() {
    let error = refused_seen("camera.fov_y = 30\ncamera.¦focal_px = 500\n");
    assert_says(
        &error,
        "a camera cannot have both `fov_y` and `focal_px`",
        "keep one of `fov_y`, `fov_x`, `focal_px` and `ortho_height`",
    );
}

#[test]
fn a_field_of_view_is_between_0_and_180() {
    for angle in ["0", "180", "-45", "720"] {
        refused_seen(&format!("camera.fov_y = ¦{angle}\n"));
        refused_seen(&format!("camera.fov_x = ¦{angle}\n"));
    }
    refused_seen("camera.focal_px = ¦0\n");
    refused_seen("camera.ortho_height = ¦-1\n");
}

#[test]
fn a_key_of_another_kind_of_light_names_the_kind() {
    let error = refused_seen(
        "[[light]]\nkind = \"directional\"\n¦position = [0, 0, 0]\ndirection = [0, 0, 1]\n",
    );
    assert_says(
        &error,
        "a directional light has no `position`",
        "its keys are `direction`, `angle`, `color`, `intensity`, `shadow` and `samples`",
    );
    let error = refused_seen("[[light]]\nkind = \"ambient\"\n¦shadow = true\n");
    assert_eq!(error.message(), "an ambient light has no `shadow`");
    let light = "[[light]]\nkind = \"point\"\nposition = [0, 0, 0]\n";
    refused_seen(&format!("{light}  ¦inner_angle  =  3\n"));
}

#[test]
fn a_light_of_no_size_is_refused_at_its_size() {
    for (keys, expected) in [
        ("kind = \"rectangle\"\ndirection = [0, -1, 0]\nsize = [1, ¦0]", "above 0"),
        ("kind = \"rectangle\"\ndirection = [0, -1, 0]\nsize = [¦-1, 2]", "above 0"),
        ("kind = \"rectangle\"\ndirection = [0, -1, 0]\nsize = ¦3", "two lengths"),
        ("kind = \"disk\"\ndirection = [0, -1, 0]\nradius = ¦0", "above 0"),
        ("kind = \"sphere\"\nradius = ¦-1", "above 0"),
        ("kind = \"sphere\"\nradius = ¦nan", "above 0"),
        ("kind = \"sphere\"\nradius = 1\nsamples = ¦0", "from 1 to 1024"),
        ("kind = \"sphere\"\nradius = 1\nsamples = ¦1025", "from 1 to 1024"),
        ("kind = ¦\"rectangle\"\ndirection = [0, -1, 0]", "needs the key `size`"),
        ("kind = ¦\"rectangle\"\nsize = [1, 1]", "needs the key `direction`"),
        ("kind = ¦\"disk\"\ndirection = [0, -1, 0]", "needs the key `radius`"),
    ] {
        let error = refused_seen(&format!("[[light]]\nposition = [0, 5, 0]\n{keys}\n"));
        assert!(error.message().contains(expected), "{keys}: {error}");
    }
    for angle in ["¦-1", "¦180.1", "¦1e-9"] {
        let sun = "[[light]]\nkind = \"directional\"\ndirection = [0, -1, 0]\n";
        let error = refused_seen(&format!("{sun}angle = {angle}\n"));
        assert!(error.message().contains("an angle in degrees"), "{error}");
    }
}

#[test]
fn keys_of_lights_with_an_extent_are_refused_where_they_mean_nothing() {
    let light = |kind: &str, keys: &str| {
        let kind = format!("[[light]]\nkind = \"{kind}\"\ndirection = [0, 0, 1]\n");
        refused_seen(&format!("{kind}position = [0, 0, 0]\n{keys}\n")).message().to_owned()
    };
    assert_eq!(light("spot", "¦radius = 1"), "a spot light has no `radius`");
    assert_eq!(light("spot", "¦samples = 4"), "a spot light has no `samples`");
    assert_eq!(light("disk", "radius = 1\n¦falloff = \"none\""), "a disk light has no `falloff`");
    assert_eq!(light("disk", "radius = 1\n¦up = [0, 1, 0]"), "a disk light has no `up`");
    let message = light("rectangle", "size = [1, 1]\nup = ¦[0, 0, -2]");
    assert_eq!(message, "the light's `up` points along its `direction`");
    let sun = "[[light]]\nkind = \"directional\"\ndirection = [0, -1, 0]\n";
    let error = refused_seen(&format!("{sun}¦samples = 4\n"));
    assert_eq!(error.message(), "a directional light has `samples` only with an `angle`");
}

#[test]
fn a_visible_light_cannot_change_its_brightness() {
    let lamp = "[[light]]\nname = \"lamp\"\nkind = \"sphere\"\nposition = [0, 0, 0]\nradius = 1\n";
    let track = "[animation]\nframes = 2\n[[animation.track]]\nobject = \"lamp\"\ntimes = [0, 1]\n";
    let error = refused_seen(&format!("{lamp}{track}¦intensity = [0, 1]\n"));
    assert_says(
        &error,
        "the shape of a visible light cannot change its brightness",
        "give the light `visible = false`, or leave out this track",
    );
}

#[test]
fn what_cannot_illuminate_is_refused() {
    let error = refused_seen("[[material]]\nname = \"lamp\"\n¦illuminates = true\n");
    let message = "a material that illuminates needs the key `emission`, and not 0";
    assert_eq!(error.message(), message);
    let error = refused_seen(
        "[[material]]\nname = \"lamp\"\nemission = 1\nilluminates = true\n\
         [[plane]]\npoint = [0, 0, 0]\nnormal = [0, 1, 0]\nmaterial = ¦\"lamp\"\n",
    );
    assert_eq!(error.message(), "an infinite plane cannot illuminate");
}

#[test]
fn a_light_without_its_place_is_at_its_kind() {
    let error = refused_seen("[[light]]\nkind = ¦\"point\"\n");
    assert_eq!(error.message(), "a point light needs the key `position`");
    refused_seen("[[light]]\nkind = ¦\"directional\"\n");
    refused_seen("[[light]]\nkind = ¦\"spot\"\nposition = [0, 0, 0]\n");
}

#[test]
fn a_spots_inner_cone_is_within_the_outer() {
    let spot = "[[light]]\nkind = \"spot\"\nposition = [0, 0, 0]\ndirection = [0, 0, 1]\n";
    let error = refused_seen(&format!("{spot}inner_angle = ¦45\n"));
    assert_eq!(error.message(), "`inner_angle` (45) must be less than `outer_angle` (45)");
    refused_seen(&format!("{spot}outer_angle = ¦0\n"));
    refused_seen(&format!("{spot}outer_angle = ¦91\n"));
    refused_seen(&format!("{spot}inner_angle = ¦-1\n"));
}

#[test]
fn a_light_too_bright_for_its_number_is_refused() {
    refused_seen("[[light]]\nkind = \"ambient\"\ncolor = 1e20\nintensity = ¦1e20\n");
}

#[test]
fn a_scale_is_not_zero() {
    let model = "[[model]]\nfile = \"m.obj\"\n";
    refused(&format!("{model}scale = ¦0\n"));
    refused(&format!("{model}scale = [1, ¦0.0, 1]\n"));
    let error = refused(&format!("{model}scale = ¦[1, 2]\n"));
    assert_eq!(error.message(), "`scale`: expected one number or three, found a list of 2");
}

#[test]
fn a_model_that_is_not_there_is_named() {
    let error = refused("[[model]]\nfile = ¦\"missing/room.glb\"\n");
    let path = std::path::Path::new("missing").join("room.glb");
    assert!(error.message().contains(path.to_str().unwrap()), "{error}");
    assert!(error.message().contains("cannot read it"), "{error}");
}

#[test]
fn a_model_that_is_no_model_is_refused() {
    let error = refused("[[model]]\nfile = ¦\"room.fbx\"\n");
    assert_eq!(advice(&error), "a model ends in .gltf, .glb or .obj");
    refused("[[model]]\nfile = ¦\"scene.toml\"\n");
    refused("[[model]]\nfile = ¦\"\"\n");
}

#[test]
fn a_folder_in_place_of_a_model_is_refused() {
    let file = File::new("[[model]]\nfile = \"room.glb\"\n");
    std::fs::create_dir(file.beside("room.glb")).unwrap();
    assert!(file.load().unwrap_err().message().ends_with("this is a folder, not a file"));
}

#[test]
fn a_picture_that_is_not_there_is_named() {
    let error = refused_seen("[[material]]\nname = \"m\"\ndiffuse_map = ¦\"wood.png\"\n");
    assert!(error.message().contains("wood.png"), "{error}");
}

#[test]
fn a_picture_that_is_none_is_refused() {
    let sphere = "[[sphere]]\ncenter = [0, 0, 0]\nradius = 1\nmaterial = \"m\"\n";
    let material = "[[material]]\nname = \"m\"\nemission_map = ¦\"scene.toml\"\n";
    refused_seen(&format!("{sphere}{material}"));
}

#[test]
fn a_table_without_double_brackets_is_told_of_them() {
    let error = refused_seen("¦[sphere]\ncenter = [0, 0, 0]\n");
    assert_says(
        &error,
        "there can be more than one `sphere`",
        "write its header in double brackets: [[sphere]]",
    );
    let error = refused_seen("[sphere]\nradius = 1\n[¦sphere]\nradius = 1\n");
    assert_eq!(advice(&error), "write each header in double brackets: [[sphere]]");
}

#[test]
fn a_single_table_in_double_brackets_is_told_so() {
    let error = refused_seen("¦[[film]]\nspp = 1\n");
    assert_eq!(advice(&error), "write its header in single brackets: [film]");
}

#[test]
fn a_table_is_no_list_of_values() {
    refused_seen("sphere = [¦[[0, 0, 0], 1]]\n");
    refused("camera = [¦[[0, 0, 0]]]\n");
    refused_seen("sphere = ¦3\n");
    refused("camera = ¦3\n");
    refused_seen("film = ¦3\n");
}

#[test]
fn a_key_twice_is_at_the_second() {
    let error = refused_seen("[[sphere]]\nradius = 1\n¦radius = 2\n");
    assert_says(&error, "`radius` is there already", "write it once");
}

#[test]
fn what_is_no_toml_is_at_its_place() {
    refused_seen("[[sphere]¦\n");
    refused_seen("[[sphere]]\nmaterial = ¦blue\n");
    refused_seen("[[sphere]]\nradius¦\n");
    refused_seen("[[sphere]]\nradius = ¦= 3\n");
}

#[test]
fn columns_are_counted_in_characters() {
    refused_seen(
        "[[material]]\nname = \"é\"\n[[material]]\n\"name\" = \"ü\" # à\n\"à\" = ¦naïve\n",
    );
    refused_seen("sphere = [{ material = \"çé\", ¦centre = 3 }]\n");
}

#[test]
fn an_empty_file_says_what_it_needs() {
    let error = refused("¦");
    assert_eq!(error.message(), "there is neither a [camera] nor a [[model]]");
}

#[test]
fn a_scene_without_camera_and_model_says_so() {
    refused("[[sphere]]\ncenter = [0, 0, 0]\nradius = 1¦\n\n");
}

#[test]
fn a_file_that_is_not_utf8_is_refused_at_the_byte() {
    let file = File::new(b"[camera]\n# caf\xe9\n");
    let error = file.load().unwrap_err();
    assert!(error.to_string().contains("scene.toml:2:6: the file is not UTF-8 text"), "{error}");
}

#[test]
fn a_file_that_is_not_there_is_named() {
    let file = File::new("");
    let path = file.beside("none.toml");
    let error = envers::load(&path).unwrap_err();
    assert_eq!((error.path(), error.kind()), (Some(&*path), ErrorKind::Input));
}

#[test]
fn nesting_without_end_is_refused() {
    for open in ["[", "{a="] {
        let deep = format!("{CAMERA}sphere = {}", open.repeat(100_000));
        assert!(File::new(deep).load().is_err());
    }
}

#[test]
fn an_environment_has_one_source_of_its_light() {
    let error = refused_seen("¦[environment]\nintensity = 2\n");
    assert_says(
        &error,
        "the environment has no light",
        "give one of `file`, `color` and `built_in`",
    );
    let error = refused_seen("¦[environment]\ncolor = 1\nbuilt_in = \"sky\"\n");
    assert_eq!(error.message(), "the environment has its light from several sources");
}

#[test]
fn keys_of_the_sky_are_refused_beside_another_environment() {
    let error = refused_seen("[environment]\ncolor = 1\n¦turbidity = 3\n");
    assert_eq!(error.message(), "`turbidity` is about the built-in sky");
    let error = refused_seen("[environment]\nbuilt_in = \"sky\"\nturbidity = ¦1\n");
    assert!(error.message().contains("a turbidity from 1.7 to 10"), "{error}");
}

#[test]
fn an_environment_map_that_is_not_there_is_refused_at_its_name() {
    let error = refused_seen("[environment]\nfile = ¦\"a.hdr\"\n");
    assert!(error.message().contains("a.hdr"), "{error}");
}

#[test]
fn a_roughness_is_from_0_to_1() {
    for value in ["-0.1", "1.5", "nan"] {
        let text = format!("[[material]]\nname = \"a\"\nroughness = ¦{value}\n");
        assert!(refused_seen(&text).message().contains("a number from 0 to 1"), "{value}");
    }
}

#[test]
fn a_material_has_the_keys_of_its_shading_model() {
    let material = "[[material]]\nname = \"a\"\n";
    let error = refused_seen(&format!("{material}metallic = 1\n¦specular = 1\n"));
    let message = "`specular` is a key of Phong's model, and the material has the other";
    assert_eq!(error.message(), message);
    let error = refused_seen(&format!("{material}¦clearcoat = 1\n"));
    let message =
        "`clearcoat` is a key of the physically based model, and the material has the other";
    assert_says(&error, message, "add `roughness`, which makes it physically based");
}
