//! Accessors: typed views of buffers, with all offsets checked.

use glam::{DMat4, Vec3};

use crate::color::srgb;
use crate::gltf::buffers::Buffers;
use crate::gltf::document::{Accessor, Document, Sparse};
use crate::guard::{MAX_TRIANGLES, MAX_VERTICES, corrupt, missing, too_large};
use crate::mesh_format::ColorSpace;
use crate::resources::ImageDecoder;
use sim3align_geometry::surface_colors::Rgb;
use sim3align_runtime::error::Result;

/// Maximum number of elements of an accessor without a buffer view, which consists of zeros and is not bounded by the
/// size of the file.
const MAX_ZEROS: usize = 1 << 20;

/// Maximum number of elements read in total, which bounds the time for many primitives on one large accessor.
const MAX_ELEMENTS_READ: usize = 1 << 28;

/// Programs that write sRGB codes where floats are linear, by a part of their names in lower case: they do not convert what
/// PLY, OBJ and scans have.
const WRITERS_OF_CODES: [&str; 2] = ["open3d", "open asset import library"];

/// Reads the accessors of a document.
pub(super) struct AccessorReader<'a> {
    pub document: &'a Document,
    pub buffers: Buffers<'a>,
    /// Decodes textures that are neither PNG nor JPEG.
    pub images: Option<ImageDecoder<'a>>,
    /// The colour space of vertex colours, if the caller knows it.
    pub color_space: Option<ColorSpace>,
    pub elements_read: usize,
}

/// The types of numbers.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum ComponentType {
    I8,
    U8,
    I16,
    U16,
    U32,
    F32,
}

impl ComponentType {
    /// The type of this number in the specification.
    fn of(number: u64) -> Option<Self> {
        Some(match number {
            5120 => Self::I8,
            5121 => Self::U8,
            5122 => Self::I16,
            5123 => Self::U16,
            5125 => Self::U32,
            5126 => Self::F32,
            _ => return None,
        })
    }

    /// Bytes per number.
    fn size(self) -> usize {
        match self {
            Self::I8 | Self::U8 => 1,
            Self::I16 | Self::U16 => 2,
            Self::U32 | Self::F32 => 4,
        }
    }
}

/// A number as stored, and its component type.
#[derive(Clone, Copy)]
struct Component {
    kind: ComponentType,
    normalized: bool,
}

impl<'a> AccessorReader<'a> {
    /// A POSITION accessor: floats, or the integers of `KHR_mesh_quantization`.
    pub fn positions(&mut self, index: usize) -> Result<Vec<Vec3>> {
        let accessor = self.accessor(index)?;
        let kind = component_type(accessor, "VEC3", index)?;
        let component = Component { kind, normalized: accessor.normalized };
        let size = kind.size();
        self.read(accessor, MAX_VERTICES, 3 * size, Vec3::ZERO, |bytes| Vec3::from_array(component.vector(bytes)))
    }

    /// A COLOR_n accessor, sRGB-encoded. Whole numbers count as normalised, as the specification demands. Alpha is ignored.
    ///
    /// By the specification, all are linear. Programs that write bytes, as generators and scanners do, mostly write the
    /// sRGB codes that they have, and linear light in 8 bits would be too coarse: bytes count as sRGB. So do floats of
    /// [`WRITERS_OF_CODES`].
    pub fn colors(&mut self, index: usize) -> Result<Vec<Rgb>> {
        let accessor = self.accessor(index)?;
        let (shape, channels) = if accessor.shape == "VEC4" { ("VEC4", 4) } else { ("VEC3", 3) };
        let kind = component_type(accessor, shape, index)?;
        let (component, size) = (Component { kind, normalized: true }, kind.size());
        let generator = self.document.asset.generator.to_ascii_lowercase();
        let by_default = match kind {
            ComponentType::U8 => true,
            ComponentType::F32 => WRITERS_OF_CODES.iter().any(|name| generator.contains(name)),
            _ => false,
        };
        let are_codes = self.color_space.map_or(by_default, |space| space == ColorSpace::Srgb);
        self.read(accessor, MAX_VERTICES, channels * size, [0; 3], |bytes| {
            let color = component.vector(bytes);
            if are_codes { color.map(|x| (x * 255.0).round() as u8) } else { srgb(color) }
        })
    }

    /// An accessor of 4 × 4 matrices.
    pub fn matrices(&mut self, index: usize) -> Result<Vec<DMat4>> {
        let accessor = self.accessor(index)?;
        let kind = component_type(accessor, "MAT4", index)?;
        let component = Component { kind, normalized: false };
        let matrix = |bytes: &[u8]| DMat4::from_cols_array(&component.vector::<16>(bytes).map(f64::from));
        self.read(accessor, MAX_VERTICES, 16 * kind.size(), DMat4::ZERO, matrix)
    }

    /// An accessor of quaternions, x, y, z, w.
    pub fn rotations(&mut self, index: usize) -> Result<Vec<[f32; 4]>> {
        self.vectors_of_4(index, true)
    }

    /// A WEIGHTS_n accessor. Whole numbers count as normalised, as the specification demands.
    pub fn weights(&mut self, index: usize) -> Result<Vec<[f32; 4]>> {
        self.vectors_of_4(index, true)
    }

    /// A JOINTS_n accessor.
    pub fn joints(&mut self, index: usize) -> Result<Vec<[u32; 4]>> {
        let joints = self.vectors_of_4(index, false)?;
        Ok(joints.into_iter().map(|joints| joints.map(|joint| joint as u32)).collect())
    }

    fn vectors_of_4(&mut self, index: usize, normalized: bool) -> Result<Vec<[f32; 4]>> {
        let accessor = self.accessor(index)?;
        let kind = component_type(accessor, "VEC4", index)?;
        let component = Component { kind, normalized };
        self.read(accessor, MAX_VERTICES, 4 * kind.size(), [0.0; 4], |bytes| component.vector(bytes))
    }

    /// A TEXCOORD_n accessor.
    pub fn coordinates(&mut self, index: usize) -> Result<Vec<[f32; 2]>> {
        let accessor = self.accessor(index)?;
        let kind = component_type(accessor, "VEC2", index)?;
        let (component, size) = (Component { kind, normalized: accessor.normalized }, kind.size());
        self.read(accessor, MAX_VERTICES, 2 * size, [0.0; 2], |bytes| component.vector(bytes))
    }

    /// The bytes of a buffer view.
    pub fn bytes_of_view(&mut self, index: usize) -> Result<&[u8]> {
        let length = self.document.buffer_views.get(index).map_or(0, |view| view.byte_length);
        let whole = usize::try_from(length).unwrap_or(usize::MAX);
        self.run(index, 0, 1, whole).map(|mut run| run.next().unwrap_or_default())
    }

    /// An accessor of vertex indices.
    pub fn indices(&mut self, index: usize) -> Result<Vec<u32>> {
        let accessor = self.accessor(index)?;
        let kind = component_type(accessor, "SCALAR", index)?;
        if !matches!(kind, ComponentType::U8 | ComponentType::U16 | ComponentType::U32) {
            let found = format!("indices of type {kind:?} in accessor {index}");
            return Err(corrupt("mesh", found, "unsigned whole numbers"));
        }
        self.read(accessor, 3 * MAX_TRIANGLES, kind.size(), 0, |bytes| unsigned(kind, bytes))
    }

    fn accessor(&self, index: usize) -> Result<&'a Accessor> {
        let document: &'a Document = self.document;
        let accessors = &document.accessors;
        accessors.get(index).ok_or_else(|| missing("accessor", index, accessors.len()))
    }

    fn read<T: Copy>(
        &mut self,
        accessor: &Accessor,
        limit: usize,
        element_bytes: usize,
        zero: T,
        parse: impl Fn(&[u8]) -> T,
    ) -> Result<Vec<T>> {
        let limit = if accessor.buffer_view.is_some() { limit } else { MAX_ZEROS };
        let count = match usize::try_from(accessor.count) {
            Ok(count) if count <= limit => count,
            _ => {
                let found = format!("an accessor of {} elements", accessor.count);
                return Err(too_large("mesh", found, format!("at most {limit}")));
            }
        };
        self.spend(count)?;
        let mut elements = match accessor.buffer_view {
            None => vec![zero; count],
            Some(view) => {
                let run = self.run(view, accessor.byte_offset, count, element_bytes)?;
                run.map(&parse).collect()
            }
        };
        if let Some(sparse) = &accessor.sparse {
            self.apply_sparse(sparse, &mut elements, element_bytes, &parse)?;
        }
        Ok(elements)
    }

    /// Applies the replacements of a sparse accessor.
    fn apply_sparse<T>(
        &mut self,
        sparse: &Sparse,
        elements: &mut [T],
        element_bytes: usize,
        parse: &impl Fn(&[u8]) -> T,
    ) -> Result<()> {
        let count = usize::try_from(sparse.count).unwrap_or(usize::MAX);
        if count > elements.len() {
            let found = format!("{} sparse elements in an accessor of {}", sparse.count, elements.len());
            return Err(corrupt("mesh", found, "at most as many"));
        }
        let Some(kind) = ComponentType::of(sparse.indices.component_type) else {
            return Err(corrupt("mesh", "sparse indices of an unknown type", "5121, 5123 or 5125"));
        };
        self.spend(2 * count)?;
        let (view, offset) = (sparse.indices.buffer_view, sparse.indices.byte_offset);
        let places: Vec<u32> = self.run(view, offset, count, kind.size())?.map(|bytes| unsigned(kind, bytes)).collect();
        let (view, offset) = (sparse.values.buffer_view, sparse.values.byte_offset);
        let values = self.run(view, offset, count, element_bytes)?;
        let length = elements.len();
        for (place, bytes) in places.into_iter().zip(values) {
            match elements.get_mut(place as usize) {
                Some(element) => *element = parse(bytes),
                None => {
                    let found = format!("sparse element {place} in an accessor of {length}");
                    return Err(corrupt("mesh", found, "an element that exists"));
                }
            }
        }
        Ok(())
    }

    /// The bytes of `count` elements that begin at `offset` in a buffer view.
    fn run(
        &mut self,
        view_index: usize,
        offset: u64,
        count: usize,
        element_bytes: usize,
    ) -> Result<impl Iterator<Item = &[u8]>> {
        let document: &'a Document = self.document;
        let Some(view) = document.buffer_views.get(view_index) else {
            return Err(missing("buffer view", view_index, document.buffer_views.len()));
        };
        if !self.buffers.has_source(view.buffer) {
            document.refuse_meshopt()?;
        }
        let stride = view.byte_stride.unwrap_or(element_bytes);
        let bytes = self.buffers.get(view.buffer)?;
        let part = |bytes: &'_ [u8], offset: u64, length: Option<u64>| -> Option<core::ops::Range<usize>> {
            let start = usize::try_from(offset).ok()?;
            let end = match length {
                Some(length) => usize::try_from(offset.checked_add(length)?).ok()?,
                None => bytes.len(),
            };
            (start <= end && end <= bytes.len()).then_some(start..end)
        };
        let in_view = part(bytes, view.byte_offset, Some(view.byte_length))
            .and_then(|range| bytes.get(range))
            .and_then(|bytes| part(bytes, offset, None).and_then(|range| bytes.get(range)))
            .unwrap_or_default();
        let needed = match count {
            0 => Some(0),
            _ => (count - 1).checked_mul(stride).and_then(|bytes| bytes.checked_add(element_bytes)),
        };
        if stride < element_bytes || needed.is_none_or(|needed| needed > in_view.len()) {
            return Err(corrupt(
                "mesh",
                format!("{count} elements of {element_bytes} bytes, {stride} apart, in buffer view {view_index}"),
                format!("as many as fit: {} bytes are left there", in_view.len()),
            ));
        }
        Ok(in_view.chunks(stride.max(1)).take(count).map(move |chunk| chunk.get(..element_bytes).unwrap_or_default()))
    }

    /// Counts elements against [`MAX_ELEMENTS_READ`].
    pub fn spend(&mut self, elements: usize) -> Result<()> {
        self.elements_read = self.elements_read.saturating_add(elements);
        if self.elements_read > MAX_ELEMENTS_READ {
            let found = format!("accessors of more than {MAX_ELEMENTS_READ} elements together");
            return Err(too_large("mesh", found, "fewer"));
        }
        Ok(())
    }
}

fn component_type(accessor: &Accessor, shape: &str, index: usize) -> Result<ComponentType> {
    let Some(kind) = ComponentType::of(accessor.component_type) else {
        let found = format!("accessor {index} of an unknown component type");
        return Err(corrupt("mesh", found, "5120 to 5126"));
    };
    if accessor.shape != shape {
        let found = format!("accessor {index} of type {:?}", accessor.shape);
        return Err(corrupt("mesh", found, shape.to_owned()));
    }
    Ok(kind)
}

fn unsigned(kind: ComponentType, bytes: &[u8]) -> u32 {
    match (kind, bytes) {
        (ComponentType::U8, &[a, ..]) => a.into(),
        (ComponentType::U16, &[a, b, ..]) => u16::from_le_bytes([a, b]).into(),
        (_, &[a, b, c, d, ..]) => u32::from_le_bytes([a, b, c, d]),
        _ => u32::MAX,
    }
}

impl Component {
    /// The first `N` numbers of an element.
    fn vector<const N: usize>(self, bytes: &[u8]) -> [f32; N] {
        let size = self.kind.size();
        core::array::from_fn(|i| self.read(bytes.get(i * size..).unwrap_or_default()))
    }

    /// glTF 2.0, section 3.11 (animations) and KHR_mesh_quantization give the same table for normalised integers.
    fn read(self, bytes: &[u8]) -> f32 {
        let (value, most) = match (self.kind, bytes) {
            (ComponentType::I8, &[a, ..]) => (f32::from(a as i8), 127.0),
            (ComponentType::U8, &[a, ..]) => (f32::from(a), 255.0),
            (ComponentType::I16, &[a, b, ..]) => (f32::from(i16::from_le_bytes([a, b])), 32767.0),
            (ComponentType::U16, &[a, b, ..]) => (f32::from(u16::from_le_bytes([a, b])), 65535.0),
            (ComponentType::U32, &[a, b, c, d, ..]) => (u32::from_le_bytes([a, b, c, d]) as f32, 4_294_967_295.0),
            (ComponentType::F32, &[a, b, c, d, ..]) => return f32::from_le_bytes([a, b, c, d]),
            _ => return f32::NAN,
        };
        if self.normalized { (value / most).max(-1.0) } else { value }
    }
}
