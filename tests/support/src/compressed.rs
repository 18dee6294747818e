//! Meshes and pictures as other programs pack them.

use draco_core::{
    DataType, EncoderBuffer, EncoderOptions, FaceIndex, GeometryAttributeType, Mesh, MeshEncoder,
    PointAttribute, PointIndex,
};

use serde_json::json;

use super::Model;

/// The extension of meshes that Draco has packed.
pub const DRACO: &str = "KHR_draco_mesh_compression";

/// An attribute of a mesh: what it is, of which numbers, how many for a vertex, and their bytes.
pub type Attribute<'a> = (GeometryAttributeType, DataType, u8, &'a [u8]);

/// A mesh, packed by Draco without a loss; its attributes are numbered from 0.
pub fn draco(attributes: &[Attribute], faces: &[[u32; 3]]) -> Vec<u8> {
    let mut mesh = Mesh::new();
    for &(kind, number, width, bytes) in attributes {
        let count = bytes.len() / (usize::from(width) * number.byte_length());
        let mut attribute = PointAttribute::new();
        attribute.init(kind, width, number, false, count);
        attribute.buffer_mut().write(0, bytes);
        mesh.add_attribute(attribute);
    }
    mesh.set_num_faces(faces.len());
    for (i, corners) in faces.iter().enumerate() {
        mesh.set_face(FaceIndex(i as u32), corners.map(PointIndex));
    }
    let mut encoder = MeshEncoder::new();
    encoder.set_mesh(mesh);
    let mut bytes = EncoderBuffer::new();
    encoder.encode(&EncoderOptions::new(), &mut bytes).unwrap();
    bytes.data().to_vec()
}

/// The bytes of floats.
pub fn bytes(values: &[f32]) -> Vec<u8> {
    values.iter().flat_map(|x| x.to_le_bytes()).collect()
}

/// A model whose only primitive is packed: these attributes, by their names.
pub fn compressed_model(
    attributes: &[(&str, GeometryAttributeType, u8, &[f32])],
    faces: &[[u32; 3]],
) -> Model {
    let mut model = Model::new();
    let raw: Vec<Vec<u8>> = attributes.iter().map(|a| bytes(a.3)).collect();
    let all: Vec<_> = attributes
        .iter()
        .zip(&raw)
        .map(|(a, raw)| (a.1, DataType::Float32, a.2, &raw[..]))
        .collect();
    let view = model.view(&draco(&all, faces));
    let mut ids = serde_json::Map::new();
    for (id, (name, _, width, values)) in attributes.iter().enumerate() {
        let (kind, count) = (format!("VEC{width}"), values.len() / usize::from(*width));
        let accessor = json!({"componentType": 5126, "type": kind, "count": count});
        model.primitive()["attributes"][*name] = model.accessor(accessor).into();
        ids.insert((*name).to_owned(), id.into());
    }
    let count = 3 * faces.len();
    let indices = model.accessor(json!({"componentType": 5123, "type": "SCALAR", "count": count}));
    model.primitive()["indices"] = indices.into();
    let extension = json!({"bufferView": view, "attributes": ids});
    model.primitive()["extensions"] = json!({ DRACO: extension });
    model.json["extensionsRequired"] = json!([DRACO]);
    model
}

/// A picture of one colour in a KTX 2 file, packed by Basis Universal as UASTC.
pub fn ktx(size: [u32; 2], color: [u8; 4]) -> Vec<u8> {
    // A block of one colour: mode 8 (five bits, 0x17), then red, green, blue and alpha; sRGB.
    let block = u128::from(u32::from_le_bytes(color)) << 5 | 0x17;
    ktx_of(size, 0, [166, 2], block)
}

/// Returns the same with floats, given as the bits of halves, packed as UASTC HDR.
pub fn ktx_of_floats(size: [u32; 2], [r, g, b, a]: [u16; 4]) -> Vec<u8> {
    // ASTC's block of one colour of floats, without bounds, in its lower half (Khronos Data Format
    // Specification, section 23.23); linear.
    let color = [r, g, b, a].iter().rev().fold(0u128, |all, half| all << 16 | u128::from(*half));
    ktx_of(size, 1_000_066_000, [167, 1], color << 64 | 0xFFFF_FFFF_FFFF_FFFC)
}

/// A KTX 2 file of blocks that are the same: of a format, a model of colour and a transfer.
fn ktx_of(
    [width, height]: [u32; 2],
    format: u32,
    [model, transfer]: [u32; 2],
    block: u128,
) -> Vec<u8> {
    let blocks = (width.div_ceil(4) * height.div_ceil(4)) as usize;
    let data = block.to_le_bytes().repeat(blocks);
    // The descriptor: its length, its block's, the model, blocks of 4×4, RGBA.
    let descriptor = [44, 0, 2 | 40 << 16, model | 1 << 8 | transfer << 16, 3 | 3 << 8, 16, 0];
    let sample = [127 << 16 | 3 << 24, 0, 0, u32::MAX];
    // Format, type size, size, depth, layers, faces, levels, packing, then where things are.
    let header = [format, 1, width, height, 0, 0, 1, 1, 0, 104, 44, 0, 0, 0, 0, 0, 0];
    let words = |words: &[u32]| words.iter().flat_map(|w| w.to_le_bytes()).collect::<Vec<u8>>();
    let level = [148, data.len() as u64, data.len() as u64].map(u64::to_le_bytes);
    [
        b"\xABKTX 20\xBB\r\n\x1A\n",
        &words(&header)[..],
        level.as_flattened(),
        &words(&descriptor),
        &words(&sample),
        &data,
    ]
    .concat()
}
