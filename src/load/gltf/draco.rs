//! KHR_draco_mesh_compression: the triangles and attributes of a primitive, packed into one view.
//!
//! The `draco-core` crate unpacks them. How many triangles a few bytes can become is limited before
//! it does.

use std::collections::HashMap;

use draco_core::{DataType, DecodeLimits, DecoderBuffer, ErrorKind, PointAttribute, PointIndex};
use gltf::json::Value;
use gltf::json::accessor::ComponentType;
use gltf::json::mesh::Primitive;
use gltf::json::validation::Checked;

use super::accessor::{Accessors, Supplied};
use crate::error::{Error, Place, Remedy, Result};
use crate::load::limits::Limit;

const NAME: &str = "KHR_draco_mesh_compression";

/// A primitive, unpacked.
pub struct Unpacked {
    /// The corners of its triangles.
    pub corners: Vec<u32>,
    /// What its accessors give instead of what they find in the buffers, by their numbers.
    pub attributes: HashMap<usize, Supplied>,
}

/// What the extension says of a primitive that is packed.
pub fn of(primitive: &Primitive) -> Option<&Value> {
    primitive.extensions.as_ref()?.others.get(NAME)
}

/// Unpacks a primitive, whose `extension` says where.
///
/// # Errors
/// When the extension is not as it should be, its bytes cannot be had or are damaged, or make more
/// triangles than the limits allow.
pub fn unpack(
    primitive: &Primitive,
    extension: &Value,
    accessors: &Accessors,
    at: &str,
) -> Result<Unpacked> {
    let at = format!("{at}.extensions.{NAME}");
    let fail = |message: String| Error::input(message).place(Place::Json(at.clone()));
    let view = extension.get("bufferView").and_then(index);
    let view = view.ok_or_else(|| fail("`bufferView` must be the number of a view".to_owned()))?;
    let bytes = accessors.buffers().view(view, &format!("{at}.bufferView"))?;
    let packed = extension.get("attributes").and_then(Value::as_object);
    let unpack = || {
        let mesh = decode(bytes, accessors.faces_left())?;
        let elements = packed.map_or(0, |packed| packed.len()) * mesh.num_points();
        accessors.count_unpacked(mesh.num_faces(), elements)?;
        Ok(mesh)
    };
    let mesh = unpack().map_err(|e: Error| e.place(Place::Json(at.clone())))?;

    let mut attributes = HashMap::new();
    for (name, id) in packed.into_iter().flatten() {
        let accessor = primitive.attributes.iter().find_map(|(semantic, accessor)| {
            let Checked::Valid(semantic) = semantic else { return None };
            (semantic.to_string() == *name).then_some(accessor.value())
        });
        // What the primitive itself does not name is not part of it.
        let Some(accessor) = accessor else { continue };
        let id = index(id).and_then(|id| u32::try_from(id).ok());
        let attribute = id.and_then(|id| mesh.attribute_by_unique_id(id));
        let attribute = attribute.ok_or_else(|| {
            fail(format!("its data have no attribute with the number that {name} gives"))
        })?;
        let supplied = supplied(attribute, mesh.num_points())
            .map_err(|e| e.place(Place::Json(format!("{at}.attributes.{name}"))))?;
        attributes.insert(accessor, supplied);
    }
    let corners = mesh.faces().iter().flatten().map(|corner| corner.0).collect();
    Ok(Unpacked { corners, attributes })
}

/// A whole number that is the place of something in a list.
fn index(value: &Value) -> Option<usize> {
    usize::try_from(value.as_u64()?).ok()
}

/// The mesh in the bytes, if it has no more than so many faces.
fn decode(bytes: &[u8], faces: u64) -> Result<draco_core::Mesh> {
    let limits = DecodeLimits::default()
        .with_max_faces(faces)
        .with_max_points(3 * faces)
        .with_max_decoded_bytes(BYTES_PER_FACE * faces);
    let mut mesh = draco_core::Mesh::new();
    let mut buffer = DecoderBuffer::new(bytes).with_limits(limits);
    let decoded = draco_core::MeshDecoder::new().decode(&mut buffer, &mut mesh);
    match decoded {
        Ok(()) => Ok(mesh),
        Err(error) if error.kind() == ErrorKind::LimitExceeded => {
            Err(Error::input(format!("its data make a mesh larger than the limits allow: {error}"))
                .help("raise the limit `elements`, four for each triangle, if you trust the file")
                .remedied_by(Remedy::RaiseLimit { name: Limit::Elements.name(), least: None }))
        }
        Err(error) => Err(Error::input(format!("its data cannot be unpacked: {error}"))
            .help("the file is damaged or was written wrong; export it again")),
    }
}

/// So many bytes of attributes are allowed for each triangle that is.
const BYTES_PER_FACE: u64 = 64;

/// The values of an attribute, for each point.
fn supplied(attribute: &PointAttribute, points: usize) -> Result<Supplied> {
    let (width, count) = (attribute.num_components().into(), points);
    let kind = match attribute.data_type() {
        DataType::Int8 => ComponentType::I8,
        DataType::Uint8 => ComponentType::U8,
        DataType::Int16 => ComponentType::I16,
        DataType::Uint16 => ComponentType::U16,
        DataType::Uint32 => ComponentType::U32,
        DataType::Float32 => ComponentType::F32,
        other => return Err(Error::input(format!("{other:?} is no type of numbers in glTF"))),
    };
    let size = width * kind.size();
    let stride = usize::try_from(attribute.byte_stride()).unwrap_or(0);
    let data = attribute.buffer().data();
    let mut bytes = Vec::with_capacity(points * size);
    for point in 0..points {
        let value = attribute.mapped_index(PointIndex(point as u32)).0 as usize;
        let start = value.checked_mul(stride);
        let value = start.and_then(|start| data.get(start..)?.get(..size));
        let missing = || Error::input(format!("the value of point {point} is not there"));
        bytes.extend_from_slice(value.ok_or_else(missing)?);
    }
    Ok(Supplied { kind, width, count, bytes })
}
