//! KHR_texture_basisu.

use envers::scene::Texels;

use super::*;
use envers_testing::compressed::{ktx, ktx_of_floats};

const COLOR: [u8; 4] = [200, 100, 50, 128];
const NAME: &str = "KHR_texture_basisu";

/// A triangle that shows a picture by the extension.
fn showing(picture: &[u8]) -> Model {
    let mut model = Model::triangle();
    let uvs = model.floats("VEC2", &[0., 0., 1., 0., 0., 1.]);
    model.primitive()["attributes"]["TEXCOORD_0"] = uvs.into();
    let view = model.view(picture);
    model.json["images"] = json!([{"bufferView": view, "mimeType": "image/ktx2"}]);
    model.json["textures"] = json!([{"extensions": { NAME: {"source": 0} }}]);
    model.json["extensionsRequired"] = json!([NAME]);
    model.material(json!({"pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}}));
    model
}

fn texels(scene: &Scene) -> ([u32; 2], &Texels) {
    let map = material(scene).metallic.as_ref().unwrap().base_color.unwrap();
    let image = &scene.textures[map.0 as usize].image;
    ([image.width, image.height], &image.texels)
}

/// A scene whose picture could not be had, and why.
#[track_caller]
fn assert_placeholder(picture: &[u8], why: &str) {
    let loaded = showing(picture).load().unwrap();
    assert_eq!(loaded.report.placeholders.len(), 1);
    assert_warns(&loaded, why);
}

#[test]
fn picture_is_unpacked() {
    let scene = showing(&ktx([8, 4], COLOR)).load().unwrap().scene;
    assert_eq!(texels(&scene), ([8, 4], &Texels::Bytes(vec![COLOR; 32])));
}

#[test]
fn picture_of_floats_stays_one() {
    // 0.5, 1, 4 and 1.
    let scene =
        showing(&ktx_of_floats([4, 4], [0x3800, 0x3C00, 0x4400, 0x3C00])).load().unwrap().scene;
    assert_eq!(texels(&scene), ([4, 4], &Texels::Floats(vec![[0.5, 1.0, 4.0, 1.0]; 16])));
}

#[test]
fn picture_may_be_packed_once_more_by_zstandard() {
    let plain = ktx([8, 4], COLOR);
    let (header, data) = plain.split_at(148);
    let length = data.len() as u8;
    let [low, high] = (u16::from(length) << 3 | 1).to_le_bytes();
    // A frame of one segment of so many bytes, and in it a last block that is stored as it is
    // (RFC 8878, section 3.1.1).
    let frame = [&[0x28, 0xB5, 0x2F, 0xFD, 0x20, length, low, high, 0], data].concat();
    let mut packed = [header, &frame].concat();
    packed[44] = 2;
    packed[88] = frame.len() as u8;
    let scene = showing(&packed).load().unwrap().scene;
    assert_eq!(texels(&scene), ([8, 4], &Texels::Bytes(vec![COLOR; 32])));
}

#[test]
fn picture_may_end_within_a_block() {
    let scene = showing(&ktx([5, 3], COLOR)).load().unwrap().scene;
    assert_eq!(texels(&scene), ([5, 3], &Texels::Bytes(vec![COLOR; 15])));
}

#[test]
fn picture_of_the_extension_comes_before_the_plain_one() {
    let mut model = showing(&ktx([4, 4], COLOR));
    let view = model.view(&png(&[[1, 2, 3, 255]]));
    let plain = json!({"bufferView": view, "mimeType": "image/png"});
    model.json["images"].as_array_mut().unwrap().push(plain);
    model.json["textures"][0]["source"] = 1.into();
    assert_eq!(texels(&model.load().unwrap().scene).0, [4, 4]);
}

#[test]
fn picture_that_is_cut_short_is_a_placeholder() {
    let whole = ktx([8, 4], COLOR);
    assert_placeholder(&whole[..whole.len() - 1], "the KTX file is cut short");
}

#[test]
fn picture_of_many_layers_is_a_placeholder() {
    let mut layers = ktx([8, 4], COLOR);
    layers[32] = 7;
    assert_placeholder(&layers, "more or less than one flat image");
}

#[test]
fn picture_that_unpacks_to_more_than_its_size_is_a_placeholder() {
    let mut bomb = ktx([8, 4], COLOR);
    bomb[96..104].copy_from_slice(&u64::MAX.to_le_bytes());
    assert_placeholder(&bomb, "more data than its size in pixels asks for");
}

#[test]
fn picture_that_is_not_packed_by_basis_is_a_placeholder() {
    let mut plain = ktx([8, 4], COLOR);
    // Eight bits of red, green, blue and alpha.
    plain[12] = 37;
    assert_placeholder(&plain, "no image that Basis Universal has compressed");
}
