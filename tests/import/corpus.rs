//! Model files that nobody in this project wrote, where `ENVERS_CORPUS` names a folder of them.
//!
//! The triangle counts were worked out from the files themselves, not with this importer.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

use envers_testing::{corpus, files};

/// The expected outcome: the number of triangles (instances counted), or a part of the error.
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
    ("tinygltf/models/BoundsChecking/integer-out-of-bounds.gltf", Err("bufferViews[0].byteLength")),
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
    match (envers::load(path), expected) {
        (Ok(scene), Ok(triangles)) => {
            assert_eq!(
                scene.scene.triangle_count(),
                triangles,
                "{name}: {:?}",
                scene.report.warnings
            );
        }
        (Err(error), Err(part)) => {
            assert!(error.to_string().contains(part), "{name}: `{part}` in `{error}`");
        }
        (found, expected) => {
            panic!("{name}: {:?} for {expected:?}", found.map(|s| s.scene.triangle_count()));
        }
    }
}

/// Loads every file of a set; panics fail the test, and so do errors that say nothing.
fn load_all(files: &[PathBuf]) -> (usize, usize) {
    let (mut loaded, mut refused) = (0, 0);
    for path in files {
        match envers::load(path) {
            Ok(_) => loaded += 1,
            Err(error) => {
                assert!(!error.message().is_empty(), "{}", path.display());
                assert!(error.path().is_some(), "{}: {error}", path.display());
                refused += 1;
            }
        }
    }
    (loaded, refused)
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
        let Ok(scene) = envers::load(&path) else { continue };
        let report = &scene.report;
        assert!(report.balances(), "{}: {report}", path.display());
        let mut shown: Vec<_> = scene.scene.instances.iter().map(|i| i.mesh).collect();
        shown.sort_unstable();
        shown.dedup();
        let stored: usize =
            shown.iter().map(|m| scene.scene.meshes[m.0 as usize].triangles.len()).sum();
        assert_eq!(report.handed_over, stored as u64, "{}: {report}", path.display());
        faces += report.read;
    }
    println!("{faces} faces read");
    assert!(faces > 500_000, "only {faces}");
}

/// The faults that Khronos' validator calls an error and this importer takes in silence, in files where
/// nothing shows it, and why. docs/formats.md has the same table.
const NOT_LOOKED_FOR: &[(&str, &str)] = &[
    (
        "ACCESSOR_ELEMENT_OUT_OF_MAX_BOUND",
        "bounds are computed from the vertices; those that a file declares are not read",
    ),
    ("ACCESSOR_ELEMENT_OUT_OF_MIN_BOUND", "as above"),
    ("ACCESSOR_MAX_MISMATCH", "as above"),
    ("ACCESSOR_MIN_MISMATCH", "as above"),
    ("ANIMATION_SAMPLER_INPUT_ACCESSOR_WITHOUT_BOUNDS", "as above"),
    ("MESH_PRIMITIVE_POSITION_ACCESSOR_WITHOUT_BOUNDS", "as above"),
    (
        "MESH_PRIMITIVE_NO_TANGENT_SPACE",
        "without tangents and texture coordinates the direction of a brushed material is arbitrary",
    ),
    (
        "ACCESSOR_INDEX_OOB",
        "a fault in the data, which is checked where something shows it, and then counted in the load report",
    ),
    ("ACCESSOR_INDEX_PRIMITIVE_RESTART", "as above"),
    ("ACCESSOR_INVALID_FLOAT", "as above"),
    ("ACCESSOR_INVALID_IBM", "as above"),
    (
        "ACCESSOR_NON_CLAMPED",
        "colours above 1 are used as they are; negative ones are a warning where they are shown",
    ),
    ("ACCESSOR_INVALID_SIGN", "only the sign of a tangent's fourth number is used"),
    ("ACCESSOR_VECTOR3_NON_UNIT", "normals and tangents may have any length but 0"),
    (
        "ANIMATION_SAMPLER_INPUT_ACCESSOR_INVALID_FORMAT",
        "the accessor is checked where an animation uses it; its channel is then left out with a warning",
    ),
    ("BUFFER_DATA_URI_MIME_TYPE_INVALID", "the kind of the data follows from its use"),
    ("BUFFER_MISSING_GLB_DATA", "an error as soon as something that is shown uses the buffer"),
    ("IO_ERROR", "as above; an image then gets a placeholder and a warning"),
    (
        "BUFFER_VIEW_INVALID_BYTE_STRIDE",
        "a rule for graphics processors; envers reads byte by byte",
    ),
    ("BUFFER_VIEW_TARGET_OVERRIDE", "as above"),
    ("IMAGE_BUFFER_VIEW_WITH_BYTESTRIDE", "as above"),
    ("MESH_PRIMITIVE_ACCESSOR_UNALIGNED", "as above"),
    ("MESH_PRIMITIVE_ACCESSOR_WITHOUT_BYTESTRIDE", "as above"),
    ("MESH_PRIMITIVE_INDICES_ACCESSOR_WITH_BYTESTRIDE", "as above"),
    ("SKIN_IBM_ACCESSOR_WITH_BYTESTRIDE", "as above"),
    (
        "GLB_CHUNK_LENGTH_UNALIGNED",
        "all chunks can be found all the same; the first of each kind is used",
    ),
    ("GLB_DUPLICATE_CHUNK", "as above"),
    ("GLB_UNEXPECTED_BIN_CHUNK", "as above"),
    (
        "IMAGE_DATA_INVALID",
        "no material uses the image, so it is not read; if one does, it gets a placeholder and a warning",
    ),
    ("IMAGE_UNEXPECTED_EOS", "as above"),
    ("INVALID_URI", "as above"),
    ("IMAGE_MIME_TYPE_INVALID", "the format of an image is recognised by its bytes"),
    ("IMAGE_NON_ENABLED_MIME_TYPE", "as above: WebP is read without the extension, too"),
    ("TEXTURE_INVALID_IMAGE_MIME_TYPE", "as above"),
    ("INVALID_JSON", "a byte order mark, which is skipped"),
    (
        "MESH_PRIMITIVE_TOO_FEW_TEXCOORDS",
        "a warning as soon as something that is shown lacks its texture coordinates",
    ),
    (
        "SKIN_NO_COMMON_ROOT",
        "joints are posed by their own nodes, whatever the parents of these are",
    ),
    ("SKIN_SKELETON_INVALID", "the property is not read"),
    (
        "SKIN_IBM_INVALID_FORMAT",
        "the accessor is checked where a skin that is shown uses it, and is then an error",
    ),
];

/// Khronos' files with the codes of the errors that their validator finds in each.
fn judged(corpus: &Path) -> Vec<(PathBuf, Vec<String>)> {
    let verdict = |path: PathBuf| {
        let extension = path.extension()?.to_str()?;
        let report = std::fs::read(path.with_extension(format!("{extension}.report.json"))).ok()?;
        let report: serde_json::Value = serde_json::from_slice(&report).unwrap();
        let issues = &report["issues"];
        let messages = issues["messages"].as_array().into_iter().flatten();
        let errors = messages.filter(|m| m["severity"] == 0);
        let mut codes: Vec<_> = errors.map(|m| m["code"].as_str().unwrap().to_owned()).collect();
        assert_eq!(codes.len() as u64, issues["numErrors"], "{}", path.display());
        codes.sort();
        codes.dedup();
        Some((path, codes))
    };
    let found: Vec<_> =
        files(&corpus.join("invalid"), &["gltf", "glb"]).into_iter().filter_map(verdict).collect();
    assert!(found.len() > 300, "only {} files", found.len());
    found
}

#[test]
fn files_that_khronos_validator_finds_valid_load_without_complaint() {
    let Some(corpus) = corpus() else { return };
    for (path, codes) in judged(&corpus) {
        // These two name a buffer without any data, which only an extension could bring.
        let name = path.file_stem().unwrap();
        let bufferless = name == "named_objects" || name == "unused_objects";
        if !codes.is_empty() || bufferless {
            continue;
        }
        match envers::load(&path) {
            Ok(scene) => {
                let complaint = scene.report.warnings.iter().find(|w| w.contains("not valid glTF"));
                assert_eq!(complaint, None, "{}", path.display());
            }
            Err(error) => panic!("valid, but refused: {error}"),
        }
    }
}

#[test]
fn files_in_which_khronos_validator_finds_errors_are_refused_or_warned_of() {
    let Some(corpus) = corpus() else { return };
    let mut excused = BTreeSet::new();
    for (path, codes) in judged(&corpus) {
        let Ok(scene) = envers::load(&path) else { continue };
        // That a file shows nothing says nothing of its faults.
        let mut warnings =
            scene.report.warnings.iter().filter(|w| !w.contains("there is no triangle"));
        if codes.is_empty() || warnings.next().is_some() {
            continue;
        }
        for code in codes {
            let known = NOT_LOOKED_FOR.iter().find(|(known, _)| *known == code);
            let (known, _) = known.unwrap_or_else(|| panic!("{}: {code}", path.display()));
            excused.insert(*known);
        }
    }
    let unused = NOT_LOOKED_FOR.iter().map(|(code, _)| *code).filter(|c| !excused.contains(c));
    assert_eq!(unused.collect::<Vec<_>>(), [""; 0], "found now: take them out of the table");
}

#[test]
fn formats_page_has_the_table_of_disagreements() {
    let page = std::fs::read_to_string("docs/formats.md").unwrap();
    for (code, why) in NOT_LOOKED_FOR {
        assert!(page.contains(&format!("| {code} | {why} |")), "| {code} | {why} |");
    }
}
