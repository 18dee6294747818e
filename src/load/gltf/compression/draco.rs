//! KHR_draco_mesh_compression: the triangles and attributes of a primitive, compressed in one view.
//!
//! The `draco-core` crate decodes them. The number of triangles that a few bytes can become is
//! limited before it does.

use std::collections::HashMap;

use draco_core::{DataType, DecodeLimits, DecoderBuffer, ErrorKind, PointAttribute, PointIndex};
use gltf::json::{Value, accessor::ComponentType, mesh::Primitive, validation::Checked};

use crate::error::{Error, Remedy, Result};
use crate::load::gltf::accessor::{Accessors, DecompressedAttribute};
use crate::load::gltf::json::{as_index, at_path, error_at};
use crate::load::limits::Limit;

const NAME: &str = "KHR_draco_mesh_compression";
/// The bytes of attributes that are allowed for each triangle that is.
const BYTES_PER_FACE: u64 = 64;

/// The corners of a primitive's triangles, and the attributes that replace its accessors, by the
/// index of the accessor.
type DecompressedPrimitive = (Vec<u32>, HashMap<usize, DecompressedAttribute>);

/// Decompresses a primitive; `None` if it is not compressed.
///
/// # Errors
/// When the extension's object or its bytes are damaged, or hold more triangles than the limits
/// allow.
pub fn decompress(
    primitive: &Primitive,
    accessors: &Accessors,
    path: &str,
) -> Result<Option<DecompressedPrimitive>> {
    let extension = primitive.extensions.as_ref().and_then(|e| e.others.get(NAME));
    let Some(extension) = extension else { return Ok(None) };
    let path = format!("{path}.extensions.{NAME}");
    let view = extension.get("bufferView").and_then(as_index);
    let view = view.ok_or_else(|| error_at(&path, "`bufferView` must be the number of a view"))?;
    let bytes = accessors.buffers.view(view, &format!("{path}.bufferView"))?;

    // Decode all of the mesh, within the limits.
    let ids = extension.get("attributes").and_then(Value::as_object);
    let mesh = decode(bytes, accessors.remaining_faces()).map_err(at_path(&path))?;
    let values = ids.map_or(0, |ids| ids.len()) * mesh.num_points();
    accessors.count_decompressed(mesh.num_faces(), values).map_err(at_path(&path))?;

    // Assign the attributes to the accessors that describe them.
    let mut attributes = HashMap::new();
    for (name, id) in ids.into_iter().flatten() {
        let accessor = primitive.attributes.iter().find_map(|(semantic, accessor)| {
            let Checked::Valid(semantic) = semantic else { return None };
            (semantic.to_string() == *name).then_some(accessor.value())
        });
        // An attribute that the primitive itself does not name is not part of it.
        let Some(accessor) = accessor else { continue };
        // The extension gives each attribute a number in the compressed mesh.
        let id = as_index(id).and_then(|id| u32::try_from(id).ok());
        let attribute = id.and_then(|id| mesh.attribute_by_unique_id(id)).ok_or_else(|| {
            error_at(&path, format!("its data have no attribute with the number that {name} gives"))
        })?;
        let values = values_of_points(attribute, mesh.num_points())
            .map_err(at_path(format_args!("{path}.attributes.{name}")))?;
        attributes.insert(accessor, values);
    }
    let corners = mesh.faces().iter().flatten().map(|corner| corner.0).collect();
    Ok(Some((corners, attributes)))
}

/// Decodes a mesh, if it has at most `max_faces` faces.
fn decode(bytes: &[u8], max_faces: u64) -> Result<draco_core::Mesh> {
    // A few bytes can describe any number of triangles, so that all is limited beforehand.
    let limits = DecodeLimits::default()
        .with_max_faces(max_faces)
        .with_max_points(3 * max_faces)
        .with_max_decoded_bytes(BYTES_PER_FACE * max_faces);
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
        Err(error) => Err(Error::input(format!("its data cannot be decompressed: {error}"))
            .help("the file is damaged or was written wrong; export it again")),
    }
}

/// Returns the value of an attribute for each of the mesh's points.
fn values_of_points(attribute: &PointAttribute, points: usize) -> Result<DecompressedAttribute> {
    let (width, count) = (attribute.num_components().into(), points);
    let component_type = match attribute.data_type() {
        DataType::Int8 => ComponentType::I8,
        DataType::Uint8 => ComponentType::U8,
        DataType::Int16 => ComponentType::I16,
        DataType::Uint16 => ComponentType::U16,
        DataType::Uint32 => ComponentType::U32,
        DataType::Float32 => ComponentType::F32,
        other => return Err(Error::input(format!("{other:?} is no type of numbers in glTF"))),
    };

    // Points share values: each point names its own by an index.
    let size = width * component_type.size();
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
    Ok(DecompressedAttribute { component_type, width, count, bytes })
}
