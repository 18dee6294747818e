//! Accessors: typed arrays within buffers. The crate's own readers take a valid file for granted;
//! these check every offset and every index.

use std::cell::Cell;
use std::collections::HashMap;
use std::rc::Rc;

use gltf::json;
use gltf::json::accessor::{Accessor, ComponentType, Type, sparse::Sparse};
use gltf::json::validation::Checked;

use super::buffers::{Buffers, get};
use super::number::Number;
use super::packed;
use super::rows::Rows;
use crate::error::{Error, Place, Result};
use crate::load::limits::Limit;
use crate::load::sandbox::Sandbox;

/// Reads accessors.
pub struct Accessors<'a> {
    root: &'a json::Root,
    guard: &'a Sandbox,
    buffers: &'a Buffers<'a>,
    /// How many elements were read so far.
    read: Rc<Cell<u64>>,
    /// What some accessors give instead of what they find in the buffers.
    supplied: HashMap<usize, Supplied>,
}

/// Elements that were unpacked: `count` of them, side by side, each of `width` numbers.
pub struct Supplied {
    /// What the numbers are.
    pub kind: ComponentType,
    /// How many an element has.
    pub width: usize,
    /// How many elements there are.
    pub count: usize,
    /// The elements.
    pub bytes: Vec<u8>,
}

/// So many elements a triangle that is unpacked counts as: unpacking takes memory for each.
const ELEMENTS_PER_FACE: u64 = 4;

impl<'a> Accessors<'a> {
    /// The accessors of a file.
    pub fn new(root: &'a json::Root, guard: &'a Sandbox, buffers: &'a Buffers<'a>) -> Self {
        Self { root, guard, buffers, read: Rc::default(), supplied: HashMap::new() }
    }

    /// The same, but that some accessors give what is `supplied`.
    pub fn with(&self, supplied: HashMap<usize, Supplied>) -> Self {
        let Self { root, guard, buffers, .. } = *self;
        Self { root, guard, buffers, read: self.read.clone(), supplied }
    }

    /// The buffers that they read.
    pub fn buffers(&self) -> &'a Buffers<'a> {
        self.buffers
    }

    /// How many triangles may be unpacked.
    pub fn faces_left(&self) -> u64 {
        let most = self.guard.most(Limit::Elements).saturating_add(self.buffers.loaded_bytes());
        let left = most.saturating_sub(self.read.get()) / ELEMENTS_PER_FACE;
        left.min(self.guard.most(Limit::Triangles))
    }

    /// Counts what was unpacked: triangles, and elements of accessors.
    ///
    /// # Errors
    /// When there are more than the limit allows.
    pub fn count_unpacked(&self, faces: usize, elements: usize) -> Result<()> {
        self.take(ELEMENTS_PER_FACE * faces as u64 + elements as u64)
    }

    fn take(&self, elements: u64) -> Result<()> {
        let total = self.read.get().saturating_add(elements);
        let beyond = total.saturating_sub(self.buffers.loaded_bytes());
        self.guard.check(Limit::Elements, beyond)?;
        self.read.set(total);
        Ok(())
    }

    /// How many elements an accessor has, 0 if there is no such accessor.
    pub fn count(&self, index: usize) -> u64 {
        match self.supplied.get(&index) {
            Some(supplied) => supplied.count as u64,
            None => self.root.accessors.get(index).map_or(0, |a| a.count.0),
        }
    }

    /// Whether an accessor's elements are in a buffer.
    pub fn has_view(&self, index: usize) -> bool {
        self.root.accessors.get(index).is_some_and(|a| a.buffer_view.is_some())
    }

    /// How many numbers an element has, 0 if there is no such accessor.
    pub fn width(&self, index: usize) -> usize {
        if let Some(supplied) = self.supplied.get(&index) {
            return supplied.width;
        }
        match self.root.accessors.get(index).map(|a| a.type_) {
            Some(Checked::Valid(t)) => t.multiplicity(),
            _ => 0,
        }
    }

    /// Elements of `N` floats; integers are normalised where the accessor says so.
    /// `by` is the place of what refers to the accessor.
    pub fn floats<const N: usize>(&self, index: usize, by: &str) -> Result<Vec<[f32; N]>> {
        self.read(index, by, Number::float, |number, bytes| match number.kind {
            ComponentType::F32 => Some(packed::decode(bytes, f32::from_le_bytes)),
            _ => None,
        })
    }

    /// Elements of `N` floats, with integers normalised whatever the accessor says: colours mean
    /// nothing otherwise.
    pub fn colors<const N: usize>(&self, index: usize, by: &str) -> Result<Vec<[f32; N]>> {
        let decode = |number, bytes: &[u8]| Number { normalized: true, ..number }.float(bytes);
        self.read(index, by, decode, |_, _| None)
    }

    /// Vertex indices.
    pub fn indices(&self, index: usize, by: &str) -> Result<Vec<u32>> {
        let accessor = get(&self.root.accessors, index, "accessor", by)?;
        let kind = component(accessor, index)?;
        if !matches!(kind, ComponentType::U8 | ComponentType::U16 | ComponentType::U32) {
            let place = Place::Json(format!("accessors[{index}].componentType"));
            return Err(Error::input(format!("indices cannot be {}", name(kind)))
                .place(place)
                .help("unsigned byte (5121), short (5123) or int (5125)"));
        }
        let all_at_once = |number: Number, bytes: &[u8]| {
            Some(match number.kind {
                ComponentType::U8 => packed::decode(bytes, |[a]: [u8; 1]| u32::from(a)),
                ComponentType::U16 => packed::decode(bytes, |two| u16::from_le_bytes(two).into()),
                _ => packed::decode(bytes, u32::from_le_bytes),
            })
        };
        let read = self.read::<u32, 1>(index, by, Number::integer, all_at_once)?;
        Ok(read.into_iter().map(|[i]| i).collect())
    }

    /// Elements of numbers, each by `decode`, or `all_at_once` where they stand side by side and it
    /// knows how.
    fn read<T: Copy + Default, const N: usize>(
        &self,
        index: usize,
        by: &str,
        decode: impl Fn(Number, &[u8]) -> T,
        all_at_once: impl Fn(Number, &[u8]) -> Option<Vec<[T; N]>>,
    ) -> Result<Vec<[T; N]>> {
        let accessor = get(&self.root.accessors, index, "accessor", by)?;
        let at = format!("accessors[{index}]");
        self.check_type::<N>(accessor, &at, by)?;
        let supplied = self.supplied.get(&index);
        let kind = supplied.map_or_else(|| component(accessor, index), |own| Ok(own.kind))?;
        let number = Number { kind, normalized: accessor.normalized };
        let decode_element = |bytes: &[u8]| {
            let mut element = [T::default(); N];
            for (value, bytes) in element.iter_mut().zip(bytes.chunks_exact(kind.size())) {
                *value = decode(number, bytes);
            }
            element
        };
        if let Some(own) = supplied {
            if own.width != N {
                let found = own.width;
                return Err(Error::input(format!("{found} numbers for each vertex, and not {N}"))
                    .place(Place::Json(by.to_owned())));
            }
            return Ok(own.bytes.chunks_exact(N * kind.size()).map(decode_element).collect());
        }
        let mut elements = Vec::new();
        let bytes = match accessor.buffer_view {
            Some(view) => self.buffers.view(view.value(), &format!("{at}.bufferView"))?,
            None => &[],
        };
        let count = self.check_count(accessor, &at)?;
        match accessor.buffer_view {
            Some(view) => {
                let offset = accessor.byte_offset.map_or(0, |o| o.0);
                let stride = self.stride(view.value());
                let size = N * number.kind.size();
                let rows = Rows::new(bytes, offset, stride.unwrap_or(size), size, count)
                    .ok_or_else(|| past_the_view(&at, count, view.value(), bytes.len()))?;
                match rows.packed().and_then(|bytes| all_at_once(number, bytes)) {
                    Some(all) => elements = all,
                    None => elements.extend(rows.map(decode_element)),
                }
            }
            // Without a view all is zero, save what a sparse part replaces.
            None => elements.resize(count, [T::default(); N]),
        }
        if let Some(sparse) = &accessor.sparse {
            let size = N * number.kind.size();
            for (target, bytes) in self.sparse(sparse, &at, count, size)? {
                if let Some(element) = elements.get_mut(target) {
                    *element = decode_element(bytes);
                }
            }
        }
        Ok(elements)
    }

    fn check_type<const N: usize>(&self, accessor: &Accessor, at: &str, by: &str) -> Result<()> {
        let found = match accessor.type_ {
            Checked::Valid(t) => t,
            Checked::Invalid => {
                return Err(Error::input("this is no known type")
                    .place(Place::Json(format!("{at}.type")))
                    .help("`SCALAR`, `VEC2`, `VEC3` or `VEC4`"));
            }
        };
        let right = match N {
            1 => Type::Scalar,
            2 => Type::Vec2,
            3 => Type::Vec3,
            16 => Type::Mat4,
            _ => Type::Vec4,
        };
        if found == right {
            return Ok(());
        }
        Err(Error::input(format!("the type is {found:?} where {by} needs {right:?}"))
            .place(Place::Json(format!("{at}.type"))))
    }

    fn check_count(&self, accessor: &Accessor, at: &str) -> Result<usize> {
        self.take(accessor.count.0).map_err(|e| e.place(Place::Json(format!("{at}.count"))))?;
        Ok(accessor.count.0 as usize)
    }

    /// The distance between elements, where the view gives one.
    fn stride(&self, view: usize) -> Option<usize> {
        self.root.buffer_views.get(view)?.byte_stride.map(|s| s.0).filter(|&s| s > 0)
    }

    /// The elements that a sparse accessor replaces: which, and by what bytes.
    fn sparse(
        &self,
        sparse: &Sparse,
        at: &str,
        total: usize,
        size: usize,
    ) -> Result<impl Iterator<Item = (usize, &[u8])>> {
        let place = |what: &str| format!("{at}.sparse.{what}");
        let count = usize::try_from(sparse.count.0).unwrap_or(usize::MAX);
        if count > total {
            return Err(Error::input(format!("{count} of {total} elements are replaced"))
                .place(Place::Json(place("count"))));
        }
        let Checked::Valid(kind) = sparse.indices.component_type else {
            return Err(Error::input("this is no type for indices")
                .place(Place::Json(place("indices.componentType")))
                .help("unsigned byte (5121), short (5123) or int (5125)"));
        };
        let index = Number { kind: kind.0, normalized: false };
        let rows = |view: usize, offset: u64, size: usize, what: &str| {
            let bytes = self.buffers.view(view, &place(&format!("{what}.bufferView")))?;
            Rows::new(bytes, offset, size, size, count)
                .ok_or_else(|| past_the_view(&place(what), count, view, bytes.len()))
        };
        let (indices, values) = (&sparse.indices, &sparse.values);
        let targets =
            rows(indices.buffer_view.value(), indices.byte_offset.0, kind.0.size(), "indices")?;
        let values = rows(values.buffer_view.value(), values.byte_offset.0, size, "values")?;
        let targets: Vec<usize> = targets.map(|bytes| index.integer(bytes) as usize).collect();
        if let Some(bad) = targets.iter().find(|&&t| t >= total) {
            return Err(Error::input(format!("element {bad} is replaced, of {total}"))
                .place(Place::Json(place("indices"))));
        }
        Ok(targets.into_iter().zip(values))
    }
}

fn component(accessor: &Accessor, index: usize) -> Result<ComponentType> {
    match accessor.component_type {
        Checked::Valid(kind) => Ok(kind.0),
        Checked::Invalid => Err(Error::input("this is no known component type")
            .place(Place::Json(format!("accessors[{index}].componentType")))
            .help("5120 to 5123, 5125 or 5126")),
    }
}

fn past_the_view(at: &str, count: usize, view: usize, length: usize) -> Error {
    Error::input(format!(
        "its {count} elements do not fit in the {length} bytes of bufferViews[{view}]"
    ))
    .place(Place::Json(at.to_owned()))
    .help("the file is damaged or was written wrong; export it again")
}

fn name(kind: ComponentType) -> &'static str {
    match kind {
        ComponentType::I8 => "signed bytes",
        ComponentType::U8 => "unsigned bytes",
        ComponentType::I16 => "signed shorts",
        ComponentType::U16 => "unsigned shorts",
        ComponentType::U32 => "unsigned ints",
        ComponentType::F32 => "floats",
    }
}
