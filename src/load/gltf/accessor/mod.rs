//! Accessors: typed arrays within buffers. The readers of the `gltf` crate expect a valid file;
//! these check every offset and every index.

mod components;

use std::cell::Cell;
use std::collections::HashMap;
use std::rc::Rc;

use gltf::json::accessor::{Accessor, ComponentType, Type, sparse::Sparse};
use gltf::json::validation::Checked;

use self::components::{Encoding, decode_contiguous, element_range};
use super::buffers::Buffers;
use super::json::{at_path, error_at, lookup};
use crate::error::{Error, Result};
use crate::load::limits::Limit;

/// The accessors of a file.
pub struct Accessors<'a> {
    /// The buffers that the accessors read.
    pub buffers: &'a Buffers<'a>,
    /// The number of elements read so far.
    elements_read: Rc<Cell<u64>>,
    /// The attributes that replace accessors, by the index of the accessor.
    decompressed: HashMap<usize, DecompressedAttribute>,
}

/// The decompressed values of a vertex attribute, tightly packed.
pub struct DecompressedAttribute {
    /// The type of the components.
    pub component_type: ComponentType,
    /// The number of components of a value.
    pub width: usize,
    /// The number of values.
    pub count: usize,
    /// The values.
    pub bytes: Vec<u8>,
}

/// The number of elements that a decompressed triangle counts as: it takes memory before its
/// attributes are read.
const ELEMENTS_PER_FACE: u64 = 4;

/// The advice on which component types indices may have.
const INDEX_TYPES: &str = "unsigned byte (5121), short (5123) or int (5125)";

impl<'a> Accessors<'a> {
    /// The accessors of a file.
    pub fn new(buffers: &'a Buffers<'a>) -> Self {
        Self { buffers, elements_read: Rc::default(), decompressed: HashMap::new() }
    }

    /// Returns the same accessors, some of which are replaced by decompressed attributes.
    pub fn with_decompressed(&self, decompressed: HashMap<usize, DecompressedAttribute>) -> Self {
        Self { elements_read: self.elements_read.clone(), decompressed, ..*self }
    }

    /// The number of triangles that may still be decompressed.
    pub fn remaining_faces(&self) -> u64 {
        let Buffers { sandbox, .. } = self.buffers;
        let most = sandbox.limit(Limit::Elements).saturating_add(self.buffers.loaded_bytes());
        let remaining = most.saturating_sub(self.elements_read.get()) / ELEMENTS_PER_FACE;
        remaining.min(sandbox.limit(Limit::Triangles))
    }

    /// Counts triangles and attribute values that were decompressed.
    ///
    /// # Errors
    /// When there are more than the limit allows.
    pub fn count_decompressed(&self, faces: usize, values: usize) -> Result<()> {
        self.count_elements(ELEMENTS_PER_FACE * faces as u64 + values as u64)
    }

    /// Counts the influences of joints on vertices, beside the accessors that they are read from.
    ///
    /// # Errors
    /// When there are more than the limit allows.
    pub fn count_influences(&self, sets: usize, vertices: usize) -> Result<()> {
        self.count_elements((sets as u64).saturating_mul(vertices as u64))
    }

    /// Counts elements that are read; the bytes that were loaded allow as many without a limit.
    fn count_elements(&self, elements: u64) -> Result<()> {
        let total = self.elements_read.get().saturating_add(elements);
        let beyond = total.saturating_sub(self.buffers.loaded_bytes());
        self.buffers.sandbox.check(Limit::Elements, beyond)?;
        self.elements_read.set(total);
        Ok(())
    }

    /// The number of elements of an accessor, 0 if there is no such accessor.
    pub fn count(&self, index: usize) -> u64 {
        match self.decompressed.get(&index) {
            Some(attribute) => attribute.count as u64,
            None => self.buffers.root.accessors.get(index).map_or(0, |a| a.count.0),
        }
    }

    /// True if the elements of an accessor are in a buffer.
    pub fn has_view(&self, index: usize) -> bool {
        self.buffers.root.accessors.get(index).is_some_and(|a| a.buffer_view.is_some())
    }

    /// The number of components of an element, 0 if there is no such accessor.
    pub fn width(&self, index: usize) -> usize {
        if let Some(attribute) = self.decompressed.get(&index) {
            return attribute.width;
        }
        match self.buffers.root.accessors.get(index).map(|a| a.type_) {
            Some(Checked::Valid(t)) => t.multiplicity(),
            _ => 0,
        }
    }

    /// Returns elements of `N` floats; integers are normalised where the accessor says so. `by` is
    /// the JSON path of what refers to the accessor.
    pub fn floats<const N: usize>(&self, index: usize, by: &str) -> Result<Vec<[f32; N]>> {
        self.read(index, by, Encoding::float, |encoding, bytes| match encoding.component_type {
            ComponentType::F32 => Some(decode_contiguous(bytes, f32::from_le_bytes)),
            _ => None,
        })
    }

    /// Returns elements of `N` floats, with integers normalised even if the accessor does not say
    /// so: colours and weights mean nothing otherwise.
    pub fn normalized_floats<const N: usize>(
        &self,
        index: usize,
        by: &str,
    ) -> Result<Vec<[f32; N]>> {
        let decode =
            |encoding, bytes: &[u8]| Encoding { normalized: true, ..encoding }.float(bytes);
        self.read(index, by, decode, |_, _| None)
    }

    /// Returns vertex indices.
    pub fn indices(&self, index: usize, by: &str) -> Result<Vec<u32>> {
        let accessor = lookup(&self.buffers.root.accessors, index, "accessor", by)?;
        let unsuitable = match component_type(accessor, index)? {
            ComponentType::U8 | ComponentType::U16 | ComponentType::U32 => None,
            ComponentType::I8 => Some("signed bytes"),
            ComponentType::I16 => Some("signed shorts"),
            ComponentType::F32 => Some("floats"),
        };
        if let Some(name) = unsuitable {
            let path = format_args!("accessors[{index}].componentType");
            return Err(error_at(path, format!("indices cannot be {name}")).help(INDEX_TYPES));
        }
        // Contiguous indices are decoded without a look at the type of each.
        let decode_all = |encoding: Encoding, bytes: &[u8]| {
            Some(match encoding.component_type {
                ComponentType::U8 => decode_contiguous(bytes, |[a]: [u8; 1]| u32::from(a)),
                ComponentType::U16 => decode_contiguous(bytes, |b| u16::from_le_bytes(b).into()),
                _ => decode_contiguous(bytes, u32::from_le_bytes),
            })
        };
        let read = self.read::<u32, 1>(index, by, Encoding::integer, decode_all)?;
        Ok(read.into_iter().map(|[i]| i).collect())
    }

    /// Returns the elements of an accessor, each component by `decode`, or all by `decode_all` if
    /// they are contiguous and it can.
    fn read<T: Copy + Default, const N: usize>(
        &self,
        index: usize,
        by: &str,
        decode: impl Fn(Encoding, &[u8]) -> T,
        decode_all: impl Fn(Encoding, &[u8]) -> Option<Vec<[T; N]>>,
    ) -> Result<Vec<[T; N]>> {
        // Check the type.
        let accessor = lookup(&self.buffers.root.accessors, index, "accessor", by)?;
        let path = format!("accessors[{index}]");
        check_type::<N>(accessor, &path, by)?;
        // The type of the components is that of the decompressed values, where there are some.
        let decompressed = self.decompressed.get(&index);
        let component_type = match decompressed {
            Some(attribute) => attribute.component_type,
            None => component_type(accessor, index)?,
        };
        let encoding = Encoding { component_type, normalized: accessor.normalized };
        let size = N * component_type.size();
        let width = component_type.size();
        let decode_element = |bytes: &[u8]| -> [T; N] {
            std::array::from_fn(|i| decode(encoding, &bytes[i * width..][..width]))
        };

        // Values that were decompressed replace those of the buffers.
        if let Some(DecompressedAttribute { width, bytes, .. }) = decompressed {
            if *width != N {
                return Err(error_at(by, format!("{width} numbers for each vertex, and not {N}")));
            }
            return Ok(bytes.chunks_exact(size).map(decode_element).collect());
        }

        // The view is loaded first, since its bytes allow as many elements.
        let view = accessor.buffer_view.map(|view| view.value());
        let load = |view| Ok((view, self.buffers.view(view, &format!("{path}.bufferView"))?));
        let view = view.map(load).transpose()?;
        let count = accessor.count.0;
        self.count_elements(count).map_err(at_path(format_args!("{path}.count")))?;
        let count = count as usize;

        // Without a view all values are zero, apart from what a sparse part replaces.
        let mut elements = match view {
            Some((view, bytes)) => {
                let offset = accessor.byte_offset.map_or(0, |o| o.0);
                let stride = self.buffers.root.buffer_views[view].byte_stride.map(|s| s.0);
                let stride = stride.filter(|&s| s > 0).unwrap_or(size);
                let bytes = element_range(bytes, offset, stride, size, count)
                    .ok_or_else(|| beyond_view(&path, count, view, bytes.len()))?;
                let all = if stride == size { decode_all(encoding, bytes) } else { None };
                let element = |i: usize| decode_element(&bytes[i * stride..][..size]);
                all.unwrap_or_else(|| (0..count).map(element).collect())
            }
            None => vec![[T::default(); N]; count],
        };

        // The elements that a sparse part replaces.
        if let Some(sparse) = &accessor.sparse {
            for (target, bytes) in self.sparse(sparse, &path, count, size)? {
                if let Some(element) = elements.get_mut(target) {
                    *element = decode_element(bytes);
                }
            }
        }
        Ok(elements)
    }

    /// Returns the indices of the elements that a sparse accessor replaces, of `total` elements of
    /// `size` bytes, and their bytes.
    fn sparse(
        &self,
        sparse: &Sparse,
        path: &str,
        total: usize,
        size: usize,
    ) -> Result<impl Iterator<Item = (usize, &[u8])>> {
        // As many elements as there are, at most, by indices of a type that is known.
        let path = format!("{path}.sparse");
        let count = usize::try_from(sparse.count.0).unwrap_or(usize::MAX);
        if count > total {
            let message = format!("{count} of {total} elements are replaced");
            return Err(error_at(format_args!("{path}.count"), message));
        }
        let Checked::Valid(component_type) = sparse.indices.component_type else {
            let path = format_args!("{path}.indices.componentType");
            return Err(error_at(path, "this is no type for indices").help(INDEX_TYPES));
        };
        let encoding = Encoding { component_type: component_type.0, normalized: false };

        // The indices and the values, each tightly packed in a view.
        let elements = |part: &str, view: usize, offset: u64, size: usize| {
            let path = format!("{path}.{part}");
            let bytes = self.buffers.view(view, &format!("{path}.bufferView"))?;
            let range = element_range(bytes, offset, size, size, count);
            let range = range.ok_or_else(|| beyond_view(&path, count, view, bytes.len()))?;
            Ok(range.chunks_exact(size))
        };
        let (view, offset) = (sparse.indices.buffer_view.value(), sparse.indices.byte_offset.0);
        let targets = elements("indices", view, offset, component_type.0.size())?;
        let (view, offset) = (sparse.values.buffer_view.value(), sparse.values.byte_offset.0);
        let values = elements("values", view, offset, size)?;
        let targets: Vec<usize> = targets.map(|bytes| encoding.integer(bytes) as usize).collect();
        if let Some(bad) = targets.iter().find(|&&t| t >= total) {
            let message = format!("element {bad} is replaced, of {total}");
            return Err(error_at(format_args!("{path}.indices"), message));
        }
        Ok(targets.into_iter().zip(values))
    }
}

/// Checks that the elements of an accessor have `N` components.
fn check_type<const N: usize>(accessor: &Accessor, path: &str, by: &str) -> Result<()> {
    let path = format!("{path}.type");
    let Checked::Valid(found) = accessor.type_ else {
        return Err(
            error_at(path, "this is no known type").help("`SCALAR`, `VEC2`, `VEC3` or `VEC4`")
        );
    };
    let needed = match N {
        1 => Type::Scalar,
        2 => Type::Vec2,
        3 => Type::Vec3,
        16 => Type::Mat4,
        _ => Type::Vec4,
    };
    if found == needed {
        return Ok(());
    }
    Err(error_at(path, format!("the type is {found:?} where {by} needs {needed:?}")))
}

fn component_type(accessor: &Accessor, index: usize) -> Result<ComponentType> {
    let Checked::Valid(component_type) = accessor.component_type else {
        let path = format_args!("accessors[{index}].componentType");
        let error = error_at(path, "this is no known component type");
        return Err(error.help("5120 to 5123, 5125 or 5126"));
    };
    Ok(component_type.0)
}

/// The error that elements reach beyond the end of their view.
fn beyond_view(path: &str, count: usize, view: usize, length: usize) -> Error {
    let message =
        format!("its {count} elements do not fit in the {length} bytes of bufferViews[{view}]");
    error_at(path, message).help("the file is damaged or was written wrong; export it again")
}
