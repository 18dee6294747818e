//! The counts in a file's load report.

use super::*;
use envers::{DropReason, LoadReport};

fn report(model: &Model) -> LoadReport {
    let report = model.load().unwrap().report;
    assert!(report.balances(), "{report}");
    report
}

/// A model of triangles between the points (i, i², 0).
fn indexed(count: usize, indices: &[u16]) -> Model {
    let mut model = Model::parabola(count);
    let indices = model.shorts(indices);
    model.primitive()["indices"] = indices.into();
    model
}

#[test]
fn a_sound_file_loses_nothing() {
    let report = report(&Model::triangle());
    assert!(report.is_clean(), "{report:?}");
    assert_eq!((report.read, report.handed_over), (1, 1));
}

#[test]
fn faces_are_dropped_each_for_one_reason() {
    use DropReason::{Degenerate, Incomplete, IndexOutOfRange};
    let report = report(&indexed(4, &[0, 1, 2, 1, 2, 9, 9, 9, 9, 3, 3, 0, 1, 2]));
    assert_eq!(report.read, 5);
    assert_eq!(report.dropped, [(Degenerate, 1), (Incomplete, 1), (IndexOutOfRange, 2)].into());
}

#[test]
fn a_corner_that_is_no_number_drops_its_faces() {
    let mut model = Model::new();
    let positions = model.floats("VEC3", &[0., 0., f32::NAN, 1., 0., 0., 0., 1., 0.]);
    model.primitive()["attributes"]["POSITION"] = positions.into();
    assert_eq!(report(&model).dropped, [(DropReason::NotFinite, 1)].into());
}

#[test]
fn points_and_lines_are_dropped_one_by_one() {
    for (mode, lost) in [(0, 6), (1, 3), (2, 6), (3, 5)] {
        let mut model = Model::parabola(6);
        model.primitive()["mode"] = mode.into();
        assert_eq!(report(&model).dropped, [(DropReason::UnsupportedMode, lost)].into());
    }
}

#[test]
fn primitives_without_positions_are_dropped() {
    let mut model = indexed(3, &[0, 1, 2, 0, 2, 1]);
    let normals = model.primitive()["attributes"]["POSITION"].clone();
    model.primitive()["attributes"] = json!({"NORMAL": normals});
    assert_eq!(report(&model).dropped, [(DropReason::NoPositions, 2)].into());
}

#[test]
fn a_mesh_that_stands_only_flat_is_dropped() {
    let mut model = Model::triangle();
    model.json["nodes"][0]["scale"] = json!([1, 0, 1]);
    assert_eq!(report(&model).dropped, [(DropReason::Flat, 1)].into());
}

#[test]
fn a_mesh_that_stands_twice_is_counted_once() {
    let mut model = Model::triangle();
    model.json["nodes"] = json!([{"mesh": 0}, {"mesh": 0, "translation": [1, 0, 0]}]);
    model.json["scenes"][0]["nodes"] = json!([0, 1]);
    assert_eq!(report(&model).read, 1);
}

#[test]
fn extensions_that_are_not_read_are_unsupported_features() {
    let mut model = Model::triangle();
    model.json["extensionsUsed"] = json!(["KHR_knitting"]);
    let report = report(&model);
    let [feature] = &report.unsupported[..] else { panic!("{report:?}") };
    assert!(feature.contains("KHR_knitting"), "{feature}");
}

#[test]
fn pictures_that_are_missing_have_placeholders() {
    let mut model = Model::triangle();
    model.json["images"] = json!([{"uri": "nowhere.png"}]);
    model.json["textures"] = json!([{"source": 0}]);
    model.material(json!({"pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}}));
    let report = report(&model);
    let [picture] = &report.placeholders[..] else { panic!("{report:?}") };
    assert!(picture.contains("nowhere.png"), "{picture}");
}
