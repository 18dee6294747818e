//! Model files that nobody in this project wrote, where `ENVERS_CORPUS` names a folder of them.
//!
//! The triangle counts were worked out from the files themselves, not with this importer.

#[path = "import_common/mod.rs"]
mod common;

use std::collections::BTreeMap;
use std::path::Path;

use common::{corpus, files, load_all};

/// What a file should be: so many triangles (instances counted), or an error that says this.
type Expected<'a> = Result<u64, &'a str>;

const GLTF_1: Expected = Err("this is glTF 1.0");

/// glTF files with their triangles, or why they cannot be read. What is not listed is glTF 1.0.
const GLTF: &[(&str, Expected)] = &[
    // No node, thus nothing to draw; a warning says so.
    (
        "jgltf/jgltf-impl-v2-ext-structural-metadata/data/EmptyAssetWithStructuralMetadata.gltf",
        Ok(0),
    ),
    (
        "jgltf/jgltf-model/src/test/resources/testModels/InterpolationTest/glTF/InterpolationTest.gltf",
        Ok(110),
    ),
    (
        "jgltf/jgltf-model/src/test/resources/testModels/SimpleMorph/glTF-Embedded/SimpleMorph.gltf",
        Ok(1),
    ),
    ("jgltf/jgltf-model/src/test/resources/testModels/v2/testShortAccessorByteStride.gltf", Ok(0)),
    // An index of 1e300.
    ("tinygltf/models/BoundsChecking/integer-out-of-bounds.gltf", Err("expected u64")),
    // Broken references, but no node leads to them.
    ("tinygltf/models/BoundsChecking/invalid-buffer-index.gltf", Ok(0)),
    ("tinygltf/models/BoundsChecking/invalid-buffer-view-index.gltf", Ok(0)),
    ("tinygltf/models/BoundsChecking/invalid-primitive-indices.gltf", Ok(0)),
    ("tinygltf/models/Cube-texture-ext/Cube-textransform.gltf", Ok(12)),
    ("tinygltf/models/Cube/Cube.gltf", Ok(12)),
    ("tinygltf/models/CubeImageUriSpaces/CubeImageUriMultipleSpaces.gltf", Ok(12)),
    ("tinygltf/models/CubeImageUriSpaces/CubeImageUriSpaces.gltf", Ok(12)),
    ("tinygltf/models/Extensions-issue97/test.gltf", Ok(1)),
    ("tinygltf/models/Extensions-overwrite-issue261/issue-261.gltf", Ok(12)),
    ("tinygltf/models/SparseMorphTargets-issue280/singleBlendshapeCube_sparse.glb", Ok(12)),
    ("tinygltf/models/box01.glb", Ok(12)),
    ("tinygltf/models/regression/unassigned-skeleton.gltf", Ok(8)),
    ("tinygltf/models/regression/zero-sized-bin-chunk-issue-440.glb", Ok(1)),
    // Its version is an empty string.
    ("tinygltf/tests/issue-416.gltf", Err("glTF version ``")),
    ("tinygltf/tests/issue-492.glb", Ok(0)),
];

/// OBJ files with their triangles.
const OBJ: &[(&str, Expected)] = &[
    ("tobj/obj/cornell_box.obj", Ok(36)),
    ("tobj/obj/empty_name_triangle.obj", Ok(1)),
    // The second of its faces names a vertex that isn't there; it is left out with a warning.
    ("tobj/obj/invalid_index.obj", Ok(1)),
    // Lines alone.
    ("tobj/obj/lines.obj", Ok(0)),
    ("tobj/obj/quad.obj", Ok(5)),
    ("tobj/obj/quad_colored_merge.obj", Ok(2)),
    ("tobj/obj/triangle.obj", Ok(1)),
    ("tobj/obj/triangle_colored.obj", Ok(1)),
];

fn check(path: &Path, expected: Expected) {
    let name = path.display();
    match (envers::load::load(path), expected) {
        (Ok(scene), Ok(triangles)) => {
            assert_eq!(scene.triangle_count(), triangles, "{name}: {:?}", scene.warnings);
        }
        (Err(error), Err(part)) => {
            assert!(error.to_string().contains(part), "{name}: `{part}` in `{error}`");
        }
        (found, expected) => {
            panic!("{name}: {:?} for {expected:?}", found.map(|s| s.triangle_count()));
        }
    }
}

#[test]
fn gltf_sets_load_right_or_say_what_they_lack() {
    let Some(corpus) = corpus().map(|c| c.join("gltf")) else { return };
    let listed: BTreeMap<_, _> = GLTF.iter().copied().collect();
    let mut met = 0;
    for set in ["gltf-tutorial-models", "jgltf", "tinygltf"] {
        let found = files(&corpus.join(set), &["gltf", "glb"]);
        assert!(!found.is_empty(), "no files in {set}");
        for path in found {
            let name = path.strip_prefix(&corpus).unwrap().to_str().unwrap().replace('\\', "/");
            let boxes = name.contains("/v2/testBox/") || name.contains("/v2/unitCubeTextured/");
            let expected = match listed.get(&*name) {
                Some(expected) => {
                    met += 1;
                    *expected
                }
                None if boxes => Ok(12),
                None => GLTF_1,
            };
            check(&path, expected);
        }
    }
    assert_eq!(met, GLTF.len(), "a listed file is not there");
}

#[test]
fn obj_set_loads_right() {
    let Some(corpus) = corpus() else { return };
    for &(name, expected) in OBJ {
        check(&corpus.join("obj").join(name), expected);
    }
}

#[test]
fn every_other_file_loads_or_gives_an_error_that_says_why() {
    let Some(corpus) = corpus() else { return };
    for folder in ["gltf", "invalid", "obj", "meshes"] {
        let found = files(&corpus.join(folder), &["gltf", "glb", "obj"]);
        let (loaded, refused) = load_all(&found);
        println!("{folder}: {loaded} loaded, {refused} refused");
    }
}

#[test]
fn every_face_of_every_file_is_handed_over_or_dropped_for_a_reason() {
    let Some(corpus) = corpus() else { return };
    let mut faces = 0;
    for path in files(&corpus, &["gltf", "glb", "obj"]) {
        let Ok(scene) = envers::load::load(&path) else { continue };
        let report = &scene.report;
        assert!(report.balances(), "{}: {report}", path.display());
        let mut shown: Vec<_> = scene.instances.iter().map(|i| i.mesh).collect();
        shown.sort_unstable();
        shown.dedup();
        let stored: usize = shown.iter().map(|m| scene.meshes[m.0 as usize].triangles.len()).sum();
        assert_eq!(report.handed_over, stored as u64, "{}: {report}", path.display());
        faces += report.read;
    }
    println!("{faces} faces read");
    assert!(faces > 500_000, "only {faces}");
}

#[test]
fn files_that_the_khronos_validator_finds_valid_load() {
    let Some(corpus) = corpus() else { return };
    let mut count = 0;
    for path in files(&corpus.join("invalid"), &["gltf", "glb"]) {
        let report =
            path.with_extension(format!("{}.report.json", path.extension().unwrap().display()));
        let Ok(report) = std::fs::read(report) else { continue };
        let report: serde_json::Value = serde_json::from_slice(&report).unwrap();
        // These two name a buffer without any data, which only an extension could bring.
        let name = path.file_stem().unwrap();
        let bufferless = name == "named_objects" || name == "unused_objects";
        if report["issues"]["numErrors"] != 0 || bufferless {
            continue;
        }
        count += 1;
        if let Err(error) = envers::load::load(&path) {
            panic!("valid, but refused: {error}");
        }
    }
    assert!(count > 100, "only {count} valid files");
}
