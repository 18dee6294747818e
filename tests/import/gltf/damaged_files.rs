//! Faults of the file as a whole and of its buffers.

use super::*;

/// A file whose buffer has another URI than it should.
fn with_uri(uri: &str) -> (String, String) {
    let json = Model::triangle().to_json(Some(uri));
    json_place(Folder::new().load("model.gltf", json.to_string()))
}

// The file as a whole

#[test]
fn empty_file() {
    assert!(Folder::new().load("a.gltf", "").unwrap_err().to_string().contains("empty"));
}

#[test]
fn broken_json_names_its_line() {
    let error = Folder::new().load("a.gltf", "{\n\"asset\": ,}").unwrap_err().to_string();
    assert!(error.contains("a.gltf:2:"), "{error}");
}

#[test]
fn json_that_is_no_gltf() {
    let error = Folder::new().load("a.gltf", "{}").unwrap_err().to_string();
    assert!(error.contains("asset.version"), "{error}");
}

#[test]
fn gltf_1_is_named_as_such() {
    let old = json!({"asset": {"version": "1.0"}, "meshes": {"a": {}}}).to_string();
    let older = json!({"techniques": {}}).to_string();
    for file in [old, older] {
        let error = Folder::new().load("a.gltf", file).unwrap_err().to_string();
        assert!(error.contains("this is glTF 1.0"), "{error}");
    }
}

#[test]
fn byte_order_mark_is_no_fault() {
    let model = Model::triangle();
    let text = model.to_json(Some(&data_uri(model.bin()))).to_string();
    assert!(Folder::new().load("a.gltf", format!("\u{feff}{text}")).is_ok());
}

#[test]
fn truncated_glb_at_every_length() {
    let folder = Folder::new();
    let glb = Model::triangle().glb();
    for length in 0..glb.len() {
        assert!(folder.load("a.glb", &glb[..length]).is_err(), "{length} bytes");
    }
}

#[test]
fn glb_of_twelve_bytes_whose_length_underflows() {
    for length in [0u32, 4, 11, 12, u32::MAX] {
        let file = [b"glTF", &2u32.to_le_bytes()[..], &length.to_le_bytes()].concat();
        assert!(Folder::new().load("a.glb", file).is_err(), "{length}");
    }
}

#[test]
fn glb_chunk_of_four_gibibytes() {
    for at in [12, 20 + 8] {
        let mut glb = Model::triangle().glb();
        glb[at..at + 4].copy_from_slice(&u32::MAX.to_le_bytes());
        assert!(Folder::new().load("a.glb", glb).is_err());
    }
}

#[test]
fn required_extension_that_is_not_read() {
    let mut model = Model::triangle();
    model.json["extensionsRequired"] = json!(["EXT_texture_avif"]);
    let (place, text) = json_place(model.load());
    assert_eq!(place, "extensionsRequired[0]");
    assert!(text.contains("EXT_texture_avif") && text.contains("gltf-transform"));
}

#[test]
fn deeply_nested_json_does_not_overflow_the_stack() {
    let file = format!("{}{}", "[".repeat(1 << 20), "]".repeat(1 << 20));
    assert!(Folder::new().load("a.gltf", file).is_err());
}

// Buffers

#[test]
fn missing_buffer_names_the_file() {
    let (place, text) = with_uri("gone.bin");
    assert_eq!(place, "buffers[0].uri");
    assert!(text.contains("gone.bin"), "{text}");
}

#[test]
fn base64_that_is_none() {
    assert_eq!(with_uri("data:application/octet-stream;base64,A").0, "buffers[0].uri");
    assert_eq!(with_uri("data:;base64,%%%").0, "buffers[0].uri");
    assert_eq!(with_uri("data:nothing").0, "buffers[0].uri");
}

#[test]
fn uri_that_is_not_utf8_once_decoded() {
    assert_eq!(with_uri("%FF.bin").0, "buffers[0].uri");
}

#[test]
fn uri_with_a_scheme_is_not_fetched() {
    assert!(with_uri("http://localhost/a.bin").1.contains("addresses are not read"));
    assert!(with_uri("file:///a.bin").1.contains("not in the folder"));
}

#[test]
fn uri_of_a_folder_or_with_a_zero_byte() {
    assert_eq!(with_uri(".").0, "buffers[0].uri");
    assert_eq!(with_uri("a%00b").0, "buffers[0].uri");
}

#[test]
#[cfg(unix)]
fn pipe_as_a_buffer_does_not_keep_us_waiting() {
    let folder = Folder::new();
    let made = std::process::Command::new("mkfifo").arg(folder.path("pipe.bin")).status();
    assert!(made.unwrap().success());
    let json = Model::triangle().to_json(Some("pipe.bin"));
    let (place, text) = json_place(folder.load("model.gltf", json.to_string()));
    assert_eq!(place, "buffers[0].uri");
    assert!(text.contains("pipe"), "{text}");
}

#[test]
fn buffer_without_data() {
    let json = Model::triangle().to_json(None);
    let (place, _) = json_place(Folder::new().load("model.gltf", json.to_string()));
    assert_eq!(place, "buffers[0]");
}

#[test]
fn buffer_shorter_than_its_views() {
    let short = data_uri(&Model::triangle().bin()[..35]);
    assert_eq!(with_uri(&short).0, "bufferViews[0]");
}

#[test]
fn view_whose_end_overflows() {
    let mut model = Model::triangle();
    model.last_view()["byteOffset"] = u64::MAX.into();
    assert_eq!(json_place(model.load()).0, "bufferViews[0]");
}

#[test]
fn view_of_a_buffer_that_is_not_there() {
    let mut model = Model::triangle();
    model.last_view()["buffer"] = 7.into();
    assert_eq!(json_place(model.load()).0, "bufferViews[0].buffer");
}
