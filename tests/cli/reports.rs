//! The reports of the command, in JSON and in words.

use super::*;

/// True if a JSON value is of some kind.
type Kind = fn(&Value) -> bool;

/// Asserts that a JSON object has these fields, of these kinds, and says which differ.
#[track_caller]
fn assert_fields(object: &Value, fields: &[(&str, Kind)]) {
    for (name, is) in fields {
        assert!(is(&object[*name]), "{name} is {} in {object}", object[*name]);
    }
}

fn seconds(value: &Value) -> bool {
    value.as_f64().is_some_and(|x| x.is_finite() && x >= 0.0)
}

fn texts(value: &Value) -> bool {
    value.as_array().is_some_and(|list| list.iter().all(Value::is_string))
}

#[test]
fn statistics_have_every_field() {
    let folder = Folder::with_everything();
    folder.run("render scene.toml -o a.png --stats stats.json").good();
    let stats: Value = serde_json::from_slice(&folder.read("stats.json")).unwrap();
    assert_fields(
        &stats,
        &[
            ("backend", Value::is_object),
            ("precision", Value::is_string),
            ("threads", Value::is_u64),
            ("size", Value::is_array),
            ("spp", Value::is_u64),
            ("geometry", Value::is_object),
            ("build", Value::is_object),
            ("rays", Value::is_object),
            ("work", Value::is_object),
            ("skipped", Value::is_object),
            ("not_finite", Value::is_object),
            ("seconds", Value::is_object),
            ("cpu_seconds", |v| v.is_object() || (!cfg!(unix) && v.is_null())),
            ("mrays_per_second", seconds),
            ("peak_memory_bytes", |v| v.is_u64() || (!cfg!(target_os = "linux") && v.is_null())),
            ("embree_peak_memory_bytes", |v| {
                v.is_u64() || (!cfg!(feature = "embree") && v.is_null())
            }),
            ("warnings", texts),
        ],
    );
    let library: Kind = |v| v.is_string() || v.is_null();
    assert_fields(
        &stats["backend"],
        &[("name", Value::is_string), ("version", Value::is_string), ("library", library)],
    );
    let times: [(&str, Kind); 5] =
        ["load", "build", "render", "write", "total"].map(|name| (name, seconds as _));
    assert_fields(&stats["seconds"], &times);
    if cfg!(unix) {
        assert_fields(&stats["cpu_seconds"], &times);
    }
    let counts: [(&str, Kind); 4] =
        ["primary", "shadow", "reflection", "refraction"].map(|name| (name, Value::is_u64 as _));
    assert_fields(&stats["rays"], &counts);
}

#[test]
fn statistics_count_what_stands_in_the_scene() {
    let stats = Folder::with_everything().run("render scene.toml --stats -").good().json();
    let expected = serde_json::json!({"spheres": 2, "triangles": 9, "planes": 1, "instances": 3});
    assert_eq!(stats["geometry"], expected);
}

#[test]
fn statistics_tell_what_was_asked_for() {
    let run = "render scene.toml --stats - --threads 2 --size 20x10 --spp 3 --backend rust";
    let stats = Folder::with(SPHERE).run(run).good().json();
    assert_eq!(stats["threads"], 2);
    assert_eq!(stats["size"], serde_json::json!([20, 10]));
    assert_eq!(stats["spp"], 3);
    assert_eq!(stats["precision"], "fast");
    assert_eq!(stats["backend"]["name"], "rust");
    assert_eq!(stats["rays"]["primary"], 20 * 10 * 3);
}

#[test]
fn statistics_of_a_view_count_its_one_sample() {
    let run = "render scene.toml --stats - --view depth";
    let stats = Folder::with_everything().run(run).good().json();
    assert_eq!((&stats["spp"], &stats["rays"]["primary"]), (&1.into(), &(150 * 110).into()));
    assert_eq!(stats["rays"]["shadow"], 0);
}

#[test]
#[cfg(feature = "embree")]
fn statistics_name_the_version_of_embree() {
    let stats = Folder::with(SPHERE).run("render scene.toml --stats -").good().json();
    assert_eq!(stats["backend"]["name"], "embree");
    assert!(stats["backend"]["version"].as_str().unwrap().starts_with("4."));
}

#[test]
fn statistics_on_stdout_are_alone_there() {
    let folder = Folder::with(SPHERE);
    folder.run("render scene.toml -o a.png --stats -").good().json();
    assert!(folder.has("a.png"));
}

#[test]
fn quiet_statistics_on_stdout_are_still_there() {
    Folder::with(SPHERE).run("render scene.toml --quiet --stats -").good().json();
}

// Validate

#[test]
#[cfg(feature = "embree")]
fn validate_passes_a_good_scene() {
    let stdout = Folder::with_everything().run("validate scene.toml").good().stdout;
    assert!(stdout.starts_with("passed: "), "{stdout}");
}

/// Two floors in one plane: at every ray the two intersectors choose between equal distances, which
/// is explained each time and far too often.
#[test]
#[cfg(feature = "embree")]
fn validate_fails_where_too_many_hits_differ() {
    let folder = Folder::with_everything();
    folder.write("floor.obj", "v -9 0 9\nv 9 0 9\nv 9 0 -9\nv -9 0 -9\nf 1 2 3 4\n");
    let scene = "[camera]\nposition = [0, 3, 5]\nlook_at = [0, 0, 0]\n\
                 [[model]]\nfile = \"floor.obj\"\n\
                 [[model]]\nfile = \"floor.obj\"\nrotate = [0, 33, 0]\n";
    folder.write("floors.toml", scene);
    let run = folder.run("validate floors.toml --size 200x100");
    assert_eq!(run.status, Some(1), "{}{}", run.stdout, run.stderr);
    assert!(run.stdout.starts_with("FAILED: "), "{}", run.stdout);
}

#[test]
#[cfg(feature = "embree")]
fn validate_json_has_every_field() {
    let result = Folder::with_everything().run("validate scene.toml --json -").good().json();
    assert_fields(
        &result,
        &[
            ("rays_compared", Value::is_u64),
            ("primitive_mismatches", Value::is_u64),
            ("unexplained_mismatches", Value::is_u64),
            ("max_t_error_ulp", Value::is_u64),
            ("pixels_differing", Value::is_u64),
            ("max_channel_difference", Value::is_u64),
            ("values_differing", Value::is_u64),
            ("precision", Value::is_string),
            ("causes", Value::is_object),
            ("warnings", texts),
            ("passed", Value::is_boolean),
        ],
    );
    let causes: [(&str, Kind); 4] =
        ["edge", "tangency", "tie", "other"].map(|name| (name, Value::is_u64 as _));
    assert_fields(&result["causes"], &causes);
    assert_eq!((&result["unexplained_mismatches"], &result["passed"]), (&0.into(), &true.into()));
    assert!(result["rays_compared"].as_u64() > Some(150 * 110 * 2));
}

#[test]
#[cfg(feature = "embree")]
fn validate_finds_no_difference_in_certified() {
    let run = "validate scene.toml --precision certified --json -";
    let result = Folder::with_everything().run(run).good().json();
    assert_eq!((&result["precision"], &result["passed"]), (&"certified".into(), &true.into()));
    for none in ["primitive_mismatches", "max_t_error_ulp", "values_differing"] {
        assert_eq!(result[none], 0, "{none}");
    }
    assert!(result["worst"].is_null() && result["replay"].is_null());
}

#[test]
#[cfg(feature = "embree")]
fn validate_names_its_worst_ray_by_the_command_that_traces_it_again() {
    let folder = Folder::with_everything();
    let result = folder.run("validate scene.toml --json -").good().json();
    let (worst, replay) = (&result["worst"], result["replay"].as_str().unwrap());
    let error = worst["t_error_ulp"].as_u64().unwrap();
    assert!(error > 0 && result["max_t_error_ulp"] == error, "{worst}");
    let arguments = replay.strip_prefix("envers ").unwrap();
    let again = folder.run(&format!("{arguments} --json -")).good().json();
    assert_eq!(again["ray"], worst["ray"]);
    let answers = again["answers"].as_array().unwrap();
    let of = |name: &str| answers.iter().find(|a| a["name"] == name).unwrap();
    assert_eq!(of("oracle")["t_error_ulp"], 0);
    assert_eq!(of("embree certified")["hit"], of("oracle")["hit"]);
    assert_eq!(of("embree fast")["t_error_ulp"], error);
}

#[test]
fn validate_says_what_everyone_makes_of_a_ray() {
    let run = "validate scene.toml --ray -0.0,5e-1,5,0,0,-1e0";
    let stdout = Folder::with(SPHERE).run(run).good().stdout;
    let names: Vec<&str> = stdout.lines().map(|l| l.split("  ").next().unwrap()).collect();
    let mut expected =
        vec!["oracle", "brute certified", "brute fast", "rust certified", "rust fast"];
    if cfg!(feature = "embree") {
        expected.extend(["embree certified", "embree fast"]);
    }
    let intersectors = expected.len();
    expected.extend(["decimals", "provenance"]);
    assert_eq!(names, expected);
    for line in stdout.lines().take(intersectors) {
        assert!(line.contains("  sphere 0  t 4.5  0 ulp"), "{stdout}");
    }
    let decimals = "t 4.5 by the decimals of the file; the oracle's t is +0.00e0 off";
    assert!(stdout.contains(decimals), "{stdout}");
}

#[test]
fn validate_says_how_far_a_hit_lies_from_that_of_the_decimals() {
    let folder = Folder::with(SPHERE);
    let answer = |file: &str, text: &str, ray: &str| {
        folder.write(file, text);
        let run = format!("validate {file} --ray {ray} --json -");
        folder.run(&run).good().json()["decimals"].clone()
    };
    let error =
        |answer: &Value| answer["hit"]["error"].as_f64().unwrap_or_else(|| panic!("{answer}"));

    // A roof whose decimals no float holds: 12.1 − 100 = −87.9.
    let corner = |x: &str, y: &str| format!("v {x} {y} 12.1\n");
    let roof =
        [("388096.123", "5412335.1"), ("388100.123", "5412335.1"), ("388098.1", "5412345.7")];
    let roof: String = roof.iter().map(|(x, y)| corner(x, y)).collect();
    let roof = roof + "f 1 2 3\n";
    let found = answer("roof.obj", &roof, "388098,5412340,100,0,0,-1");
    assert_eq!(found["hit"]["t"], 87.9);
    assert!(error(&found).abs() < 1e-14, "{found}");

    // The same within transforms that are rounded at every step.
    let scene = r#"
        [[model]]
        file = "roof.obj"
        translate = [0.1, -0.3, 0.7]
        rotate = [10, 20, 30]
        scale = [1.1, 0.9, 1.3]
    "#;
    folder.write("roof.obj", "v -1.1 -1.3 0.1\nv 1.7 -1.2 0.1\nv 0.3 1.9 0.1\nf 1 2 3\n");
    let found = answer("turned.toml", scene, "0.5,-0.3,9,0,0,-1");
    let error_of_turned = error(&found).abs();
    assert!(error_of_turned > 0.0 && error_of_turned < 1e-14, "{found}");

    // Nodes within nodes, one with a rotation and one with a matrix.
    let mut model = envers_testing::Model::triangle();
    model.json["nodes"] = serde_json::json!([
        {"children": [1], "translation": [0.1, 0.2, 0.3], "rotation": [0.1, 0.2, 0.3, 0.9],
            "scale": [1.1, 1.2, 1.3]},
        {"mesh": 0, "matrix": [1, 0, 0, 0, 0, 1, 0, 0, 0.1, 0, 1, 0, 0.7, 0.1, -0.1, 1]},
    ]);
    std::fs::write(folder.path("nodes.glb"), model.glb()).unwrap();
    let found = folder.run("validate nodes.glb --ray 0.59,1.26,9,0,0,-1 --json -").good().json();
    assert!(error(&found["decimals"]).abs() < 1e-14, "{found}");
}

#[test]
fn validate_says_which_element_of_the_files_a_ray_hits() {
    let folder = Folder::with(
        "[[model]]\nfile = \"quad.obj\"\n[[model]]\nfile = \"quad.obj\"\nname = \"right\"\n\
         translate = [5, 0, 0]\n[[model]]\nfile = \"triangle.glb\"\ntranslate = [9, 0, 0]\n",
    );
    let quad = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2\no sheet\ng a b\nusemtl tin\nf 1 2 3 4\n";
    folder.write("quad.obj", quad);
    folder.write("triangle.glb", envers_testing::Model::triangle().glb());

    let text = folder.run("validate scene.toml --ray 5.2,0.8,9,0,0,-1").good().stdout;
    let expected = "provenance        triangle 1 of mesh 0 in instance 1: [[model]] 1 `right`, quad.obj, \
                    object `sheet`, group `a`, group `b`, material `tin`, face 1 in line 9\n";
    assert!(text.ends_with(expected), "{text}");

    let ray = |x| format!("validate scene.toml --ray {x},0.2,9,0,0,-1 --json -");
    let provenance = |x| {
        let found = folder.run(&ray(x)).good().json();
        let answers = found["answers"].as_array().unwrap().clone();
        assert!(answers.iter().all(|a| a["hit"]["provenance"] == answers[0]["hit"]["provenance"]));
        answers[0]["hit"]["provenance"].clone()
    };
    let face = serde_json::json!({"object": "sheet", "groups": ["a", "b"], "material": "tin",
        "face": 1, "line": 9});
    let table = serde_json::json!({"kind": "model", "index": 0, "name": null});
    let model = serde_json::json!({"file": "quad.obj", "obj": face});
    assert_eq!(provenance(0.5), serde_json::json!({"table": table, "model": model}));
    let element = provenance(9.2)["model"]["gltf"].clone();
    let triangle = serde_json::json!({"mesh": 0, "mesh_name": null, "primitive": 0, "triangle": 0});
    assert_eq!((&element["node"], &element["triangle"]), (&0.into(), &triangle));
}

#[test]
fn names_of_a_file_begin_no_line_of_their_own_beside_a_ray() {
    let mut model = envers_testing::Model::triangle();
    model.json["nodes"][0]["name"] = "a\nb\u{202e}".into();
    let folder = Folder::new();
    folder.write("t.glb", model.glb());
    let text = folder.run("validate t.glb --ray 0.2,0.2,9,0,0,-1").good().stdout;
    assert!(text.ends_with("node 0 `a\\nb\\u{202e}`, mesh 0, primitive 0, triangle 0\n"), "{text}");
}

#[test]
fn validate_refuses_what_is_no_ray() {
    for bad in ["1,2,3", "0,0,0,0,0,0", "1,2,3,4,5,inf", "a,b,c,d,e,f"] {
        let message =
            Folder::with(SPHERE).run(&format!("validate scene.toml --ray {bad}")).refused();
        assert!(message.contains("--ray"), "{message}");
    }
}

#[test]
#[cfg(feature = "embree")]
fn validate_heat_map_is_a_picture_of_the_scenes_size() {
    let folder = Folder::with(SPHERE);
    folder.run("validate scene.toml --heatmap heat.png --json v.json").good();
    assert_eq!(pixels(&folder.read("heat.png")).0, (64, 48));
    serde_json::from_slice::<Value>(&folder.read("v.json")).unwrap();
}

#[test]
#[cfg(feature = "embree")]
fn validate_leaves_no_other_file() {
    let folder = Folder::with(SPHERE);
    folder.run("validate scene.toml").good();
    assert_eq!(folder.names(), ["scene.toml"]);
}

#[test]
#[cfg(not(feature = "embree"))]
fn validate_in_a_build_without_embree_says_so() {
    let message = Folder::with(SPHERE).run("validate scene.toml").refused();
    assert!(message.contains("built without Embree"), "{message}");
}

// Diff

/// A folder with `a.png` and `b.png`, which differ by 10 of 255 in one channel of one pixel.
fn two_pictures() -> Folder {
    let folder = Folder::new();
    folder.write("a.png", envers_testing::png(&[[0, 0, 0, 255], [9, 9, 9, 255]]));
    folder.write("b.png", envers_testing::png(&[[10, 0, 0, 255], [9, 9, 9, 255]]));
    folder
}

#[test]
fn diff_of_equal_pictures_exits_with_0() {
    two_pictures().run("diff a.png a.png").good();
}

#[test]
fn diff_of_different_pictures_exits_with_1() {
    let run = two_pictures().run("diff a.png b.png");
    assert_eq!((run.status, &*run.stderr), (Some(1), ""));
    assert!(run.stdout.contains("1 pixels differ") || run.stdout.contains("1 pixel differs"));
}

#[test]
fn diff_within_the_tolerance_exits_with_0() {
    two_pictures().run("diff a.png b.png --tolerance 0.04").good();
}

#[test]
fn diff_beyond_the_tolerance_exits_with_1() {
    assert_eq!(two_pictures().run("diff a.png b.png --tolerance 0.039").status, Some(1));
}

#[test]
fn diff_json_has_every_field() {
    let run = two_pictures().run("diff a.png b.png --json -");
    let result = run.json();
    assert_fields(
        &result,
        &[
            ("rmse", Value::is_f64),
            ("psnr", Value::is_f64),
            ("max", Value::is_f64),
            ("pixels_differing", Value::is_u64),
            ("flip", Value::is_f64),
        ],
    );
    assert_eq!(run.status, Some(1));
    let (max, rmse) = (result["max"].as_f64().unwrap(), result["rmse"].as_f64().unwrap());
    assert!((max - 10.0 / 255.0).abs() < 1e-6, "{max}");
    assert!((rmse - max / 6f64.sqrt()).abs() < 1e-6, "{rmse}");
    assert_eq!(result["pixels_differing"], 1);
}

#[test]
fn diff_psnr_of_equal_pictures_is_null() {
    assert!(two_pictures().run("diff a.png a.png --json -").good().json()["psnr"].is_null());
}

#[test]
fn diff_of_black_and_white_is_as_far_as_flip_puts_them() {
    let folder = Folder::new();
    for (name, byte) in [("black.png", 0), ("white.png", 255)] {
        folder.write(name, envers_testing::png(&[[byte, byte, byte, 255]; 8]));
    }
    let run = folder.run("diff black.png white.png");
    assert!(run.stdout.contains(", FLIP 0.9673"), "{}", run.stdout);
}

#[test]
fn diff_of_exrs_has_the_flip_of_their_pngs_but_for_rounding() {
    let folder = Folder::with(SPHERE);
    folder.run("render scene.toml -o a.png -o a.exr").good();
    folder.run("render scene.toml -o b.png -o b.exr --spp 16").good();
    let flip = |arguments: &str| folder.run(arguments).json()["flip"].as_f64().unwrap();
    let (png, exr) = (flip("diff a.png b.png --json -"), flip("diff a.exr b.exr --json -"));
    assert!(png > 0.001 && (png - exr).abs() < 0.001, "{png} {exr}");
}

#[test]
fn diff_of_views_has_no_flip() {
    let folder = Folder::with(SPHERE);
    folder.run("render scene.toml -o a.exr --view normal").good();
    assert!(folder.run("diff a.exr a.exr --json -").good().json()["flip"].is_null());
    assert!(!folder.run("diff a.exr a.exr").good().stdout.contains("FLIP"));
}

#[test]
fn diff_heat_map_is_white_where_the_difference_is_largest() {
    let folder = two_pictures();
    assert_eq!(folder.run("diff a.png b.png --heatmap h.png").status, Some(1));
    assert_eq!(pixels(&folder.read("h.png")), ((2, 1), vec![255, 255, 255, 0, 0, 0]));
}

#[test]
fn diff_refuses_sizes_that_differ() {
    let folder = two_pictures();
    folder.write("c.png", envers_testing::png(&[[0; 4]; 3]));
    let message = folder.run("diff a.png c.png").refused();
    assert!(message.contains("2x1") && message.contains("3x1"), "{message}");
}

#[test]
fn diff_refuses_a_png_with_an_exr() {
    let folder = Folder::with(SPHERE);
    folder.run("render scene.toml -o a.png -o a.exr").good();
    let message = folder.run("diff a.png a.exr").refused();
    assert!(message.contains("PNG") && message.contains("EXR"), "{message}");
}

#[test]
fn diff_refuses_views_that_differ() {
    let folder = Folder::with(SPHERE);
    folder.run("render scene.toml -o a.exr").good();
    folder.run("render scene.toml -o z.exr --view depth").good();
    let message = folder.run("diff a.exr z.exr").refused();
    assert!(message.contains("channels"), "{message}");
}

#[test]
fn diff_refuses_a_damaged_picture() {
    let folder = two_pictures();
    let png = folder.read("a.png");
    folder.write("short.png", &png[..png.len() / 2]);
    folder.write("short.exr", b"\x76\x2f\x31\x01");
    assert!(folder.run("diff a.png short.png").refused().contains("short.png"));
    assert!(folder.run("diff short.exr short.exr").refused().contains("short.exr"));
}

#[test]
fn diff_refuses_a_tolerance_below_0_or_no_number() {
    for bad in ["-1", "nan", "x"] {
        two_pictures().run(&format!("diff a.png b.png --tolerance={bad}")).refused();
    }
}

#[test]
fn diff_refuses_a_picture_that_is_not_there() {
    assert!(two_pictures().run("diff a.png none.png").refused().contains("none.png"));
}

#[test]
fn tolerance_that_any_two_pictures_meet_is_refused() {
    let folder = Folder::with(SPHERE);
    folder.run("render scene.toml -q -o a.png -o a.exr").good();
    for tolerance in ["1", "1.5", "255", "3/2"] {
        let message = folder.run(&format!("diff a.png a.png --tolerance {tolerance}")).refused();
        assert!(
            message.contains("any two images would pass") && message.contains("1/255"),
            "{message}"
        );
    }
    for tolerance in ["inf", "nan", "-1", "1/0", "0/0", "1/", "1e99", "1/1e-99"] {
        folder.run(&format!("diff a.png a.png --tolerance {tolerance}")).refused();
        folder.run(&format!("diff a.exr a.exr --tolerance {tolerance}")).refused();
    }
    folder.run("diff a.exr a.exr --tolerance 1").good();
    let stdout = folder.run("diff a.png a.png --tolerance 1/255").good().stdout;
    assert!(stdout.contains("more than 0.003921"), "{stdout}");
}
