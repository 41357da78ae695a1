//! NumPy `.npy` files, versions 1 to 3: arrays of numbers.

use crate::cursor::Cursor;
use crate::depth_image::Stored;
use crate::guard::{corrupt, pixel_count, unsupported};
use sim3align_runtime::error::Result;

pub(crate) const MAGIC: &[u8] = b"\x93NUMPY";

/// The type of an element.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Kind {
    Bool,
    Signed,
    Unsigned,
    Float,
}

/// The header of an array: its type and shape.
#[derive(Debug, Clone)]
pub(crate) struct NpyHeader {
    pub kind: Kind,
    /// Bytes per element.
    pub size: usize,
    pub shape: Vec<usize>,
    big_endian: bool,
    fortran_order: bool,
}

impl NpyHeader {
    /// Reads the header; the elements follow at the cursor.
    pub fn read(argument: &'static str, cursor: &mut Cursor<'_>) -> Result<Self> {
        if cursor.take(MAGIC.len())? != MAGIC {
            return Err(corrupt(argument, "no NumPy magic number", "a .npy file"));
        }
        let [major, minor] = cursor.array()?;
        let header_bytes = match major {
            1 => usize::from(u16::from_le_bytes(cursor.array()?)),
            2 | 3 => cursor.u32_le()? as usize,
            _ => {
                let found = format!(".npy version {major}.{minor}");
                return Err(unsupported(argument, found, "versions 1 to 3", "Save the array again with numpy.save."));
            }
        };
        let header = String::from_utf8_lossy(cursor.take(header_bytes)?);
        let field = |name| {
            field(&header, name).ok_or_else(|| {
                corrupt(argument, format!(".npy header without {name}"), "descr, fortran_order and shape")
            })
        };
        let (big_endian, kind, size) = element_type(argument, field("descr")?)?;
        let fortran_order = field("fortran_order")?.starts_with("True");
        let shape = shape(field("shape")?)
            .ok_or_else(|| corrupt(argument, ".npy header with a broken shape", "a tuple of whole numbers"))?;
        Ok(Self { kind, size, shape, big_endian, fortran_order })
    }

    /// The shape without leading axes of length 1, and then without trailing ones, down to `axes`: networks write
    /// batches of one image, and images of one channel.
    pub fn squeezed(&self, axes: usize) -> &[usize] {
        let mut shape = self.shape.as_slice();
        while let [1, rest @ ..] = shape
            && rest.len() >= axes
        {
            shape = rest;
        }
        while let [rest @ .., 1] = shape
            && rest.len() >= axes
        {
            shape = rest;
        }
        shape
    }

    /// The number of elements; saturates.
    pub fn count(&self) -> usize {
        self.shape.iter().fold(1_usize, |count, &side| count.saturating_mul(side))
    }
}

/// An array: its header and its elements.
#[derive(Debug)]
pub(crate) struct NpyArray<'a> {
    pub header: NpyHeader,
    data: &'a [u8],
}

impl<'a> NpyArray<'a> {
    /// Reads an array whose elements are complete. The caller limits their number.
    pub fn read(argument: &'static str, bytes: &'a [u8]) -> Result<Self> {
        let mut cursor = Cursor::new(argument, bytes);
        let header = NpyHeader::read(argument, &mut cursor)?;
        let data = cursor.take(header.count().saturating_mul(header.size))?;
        Ok(Self { header, data })
    }

    /// Writes the elements from an index on, in the row-major order of an array of these sides.
    pub fn fill(&self, start: usize, sides: [usize; 3], to: &mut [f64]) {
        let NpyHeader { kind, size, big_endian, fortran_order, .. } = self.header;
        let elements = self.data.get(start * size..).unwrap_or_default();
        match (kind, size, fortran_order || big_endian) {
            // Most depth maps and masks, several times faster.
            (Kind::Float, 4, false) => decode(elements, to, |bytes| f32::from_le_bytes(bytes).into()),
            (Kind::Unsigned, 2, false) => decode(elements, to, |bytes| u16::from_le_bytes(bytes).into()),
            (Kind::Bool | Kind::Unsigned, 1, false) => decode(elements, to, |[byte]| byte.into()),
            _ => to.iter_mut().enumerate().for_each(|(k, element)| *element = self.at(start + k, sides)),
        }
    }

    /// The element at this place of the file.
    pub fn value(&self, place: usize) -> f64 {
        let NpyHeader { kind, size, big_endian, .. } = self.header;
        let mut bytes = [0; 8];
        let element = self.data.get(place * size..).and_then(|rest| rest.get(..size)).unwrap_or_default();
        for (to, from) in bytes.iter_mut().zip(element) {
            *to = *from;
        }
        if big_endian {
            bytes[..size.min(8)].reverse();
        }
        let [a, b, c, d, ..] = bytes;
        match (kind, size) {
            (Kind::Signed, 1) => f64::from(a as i8),
            (Kind::Signed, 2) => f64::from(i16::from_le_bytes([a, b])),
            (Kind::Signed, 4) => f64::from(i32::from_le_bytes([a, b, c, d])),
            (Kind::Signed, _) => i64::from_le_bytes(bytes) as f64,
            (Kind::Float, 2) => half(u16::from_le_bytes([a, b])),
            (Kind::Float, 4) => f64::from(f32::from_le_bytes([a, b, c, d])),
            (Kind::Float, _) => f64::from_le_bytes(bytes),
            (Kind::Bool | Kind::Unsigned, _) => u64::from_le_bytes(bytes) as f64,
        }
    }

    /// The elements in row-major order of an array of these two or three sides, whatever the order of the file.
    pub fn values(&self, sides @ [rows, columns, channels]: [usize; 3]) -> impl Iterator<Item = f64> {
        (0..rows * columns * channels).map(move |i| self.at(i, sides))
    }

    /// The element with this index in row-major order of an array of these sides.
    pub fn at(&self, i: usize, [rows, columns, channels]: [usize; 3]) -> f64 {
        let (row, column, channel) = (i / (columns * channels), i / channels % columns, i % channels);
        let fortran = row + rows * (column + columns * channel);
        self.value(if self.header.fortran_order { fortran } else { i })
    }
}

/// Decodes elements of this many bytes, as many as there are.
fn decode<const BYTES: usize>(elements: &[u8], to: &mut [f64], number: impl Fn([u8; BYTES]) -> f64) {
    to.iter_mut().zip(elements.as_chunks().0).for_each(|(to, bytes)| *to = number(*bytes));
}

/// An image-shaped array: H×W, also with further axes of length 1 before or after these.
#[derive(Debug)]
pub(crate) struct NpyImage<'a> {
    pub width: usize,
    pub height: usize,
    array: NpyArray<'a>,
}

impl<'a> NpyImage<'a> {
    /// Reads an array; rejects sizes above the limit and shapes other than those of an image.
    pub fn read(argument: &'static str, bytes: &'a [u8]) -> Result<Self> {
        let header = NpyHeader::read(argument, &mut Cursor::new(argument, bytes))?;
        let &[height, width] = header.squeezed(2) else {
            let found = format!("an array of shape {:?}", header.shape);
            let remedy = "Pass one image: array[0] of a batch, one channel of several.";
            return Err(unsupported(argument, found, "H × W, H × W × 1 or 1 × H × W", remedy));
        };
        pixel_count(argument, width, height)?;
        Ok(Self { width, height, array: NpyArray::read(argument, bytes)? })
    }

    /// The type of the elements.
    pub fn header(&self) -> &NpyHeader {
        &self.array.header
    }

    /// Writes the elements from an index on, in row-major order.
    pub fn fill(&self, start: usize, to: &mut [f64]) {
        self.array.fill(start, [self.height, self.width, 1], to);
    }
}

/// A point map: H×W×3 or 3×H×W, also with further axes of length 1.
#[derive(Debug)]
pub(crate) struct NpyPoints<'a> {
    array: NpyArray<'a>,
    sides: [usize; 3],
    /// Whether the coordinates of a point are beside one another.
    is_interleaved: bool,
}

impl<'a> NpyPoints<'a> {
    /// Reads a point map from a `.npy` file; `None` for an image of one channel.
    pub fn read(bytes: &'a [u8]) -> Result<Option<Self>> {
        let header = NpyHeader::read("depth", &mut Cursor::new("depth", bytes))?;
        if let &[_, _] = header.squeezed(2) {
            return Ok(None);
        }
        let Some((sides, is_interleaved)) = point_sides(header.squeezed(3)) else {
            let found = format!("an array of shape {:?}", header.shape);
            let remedy = "Pass one image of a batch, array[0].";
            return Err(unsupported("depth", found, "H × W, or the points of H × W × 3 or 3 × H × W", remedy));
        };
        let [height, width] = image_sides(sides, is_interleaved);
        pixel_count("depth", width, height)?;
        NpyArray::read("depth", bytes).map(Self::of)
    }

    /// The points of an array of one of these shapes; `None` for another.
    pub fn of(array: NpyArray<'a>) -> Option<Self> {
        let (sides, is_interleaved) = point_sides(array.header.squeezed(3))?;
        Some(Self { array, sides, is_interleaved })
    }

    /// Its size and the type of its numbers.
    pub fn stored(&self) -> Stored {
        let [height, width] = image_sides(self.sides, self.is_interleaved);
        let NpyHeader { size, kind, .. } = self.array.header;
        Stored { width, height, bits: 8 * size, is_integer: kind != Kind::Float }
    }

    /// x, y and z of the pixel with this index, row-major.
    pub fn point(&self, index: usize) -> [f64; 3] {
        let [_, rows, columns] = self.sides;
        [0, 1, 2].map(|axis| {
            self.array
                .at(if self.is_interleaved { 3 * index + axis } else { axis * rows * columns + index }, self.sides)
        })
    }
}

/// The sides of a point map, and whether the coordinates of a point are beside one another.
pub(crate) fn point_sides(shape: &[usize]) -> Option<([usize; 3], bool)> {
    match *shape {
        [height, width, 3] => Some(([height, width, 3], true)),
        [3, height, width] => Some(([3, height, width], false)),
        _ => None,
    }
}

/// Height and width of a point map of these sides.
pub(crate) fn image_sides([a, b, c]: [usize; 3], is_interleaved: bool) -> [usize; 2] {
    if is_interleaved { [a, b] } else { [b, c] }
}

/// The text of a value in the header, which is a Python dictionary of literals.
fn field<'a>(header: &'a str, name: &str) -> Option<&'a str> {
    let quoted = |quote: char| header.split_once(&format!("{quote}{name}{quote}"));
    let (_, after) = quoted('\'').or_else(|| quoted('"'))?;
    Some(after.trim_start().strip_prefix(':')?.trim_start())
}

/// Parses byte order, kind and size of a type such as `'<f4'`.
fn element_type(argument: &str, text: &str) -> Result<(bool, Kind, usize)> {
    let quote = text.chars().next().filter(|quote| matches!(quote, '\'' | '"'));
    let descr = quote.and_then(|quote| text.get(1..)?.split(quote).next()).unwrap_or(text);
    let mut letters = descr.chars();
    let order = letters.next();
    let kind = match letters.next() {
        Some('b') => Some(Kind::Bool),
        Some('i') => Some(Kind::Signed),
        Some('u') => Some(Kind::Unsigned),
        Some('f') => Some(Kind::Float),
        _ => None,
    };
    let size: Option<usize> = letters.as_str().parse().ok();
    match (order, kind, size) {
        (Some('<' | '>' | '|' | '='), Some(kind), Some(size)) if size_fits(kind, size) => {
            Ok((order == Some('>'), kind, size))
        }
        _ => {
            let found = format!("elements of type {:?}", descr.chars().take(40).collect::<String>());
            let expected = "numbers: bool, int8 to int64, uint8 to uint64, float16, float32 or float64";
            Err(unsupported(argument, found, expected, "Convert it, for example with array.astype('float32')."))
        }
    }
}

fn size_fits(kind: Kind, size: usize) -> bool {
    match kind {
        Kind::Bool => size == 1,
        Kind::Float => matches!(size, 2 | 4 | 8),
        Kind::Signed | Kind::Unsigned => matches!(size, 1 | 2 | 4 | 8),
    }
}

fn shape(text: &str) -> Option<Vec<usize>> {
    let (inside, _) = text.strip_prefix('(')?.split_once(')')?;
    let sizes = inside.split(',').map(|size| size.trim().trim_end_matches('L')).filter(|size| !size.is_empty());
    // Saturates, so that a product that overflows usize still exceeds the limit.
    let size = |size: &str| size.parse::<u64>().ok().map(|size| usize::try_from(size).unwrap_or(usize::MAX));
    sizes.take(8).map(size).collect()
}

/// Converts IEEE 754 binary16.
fn half(bits: u16) -> f64 {
    let sign = if bits & 0x8000 == 0 { 1.0 } else { -1.0 };
    let (exponent, fraction) = (i32::from(bits >> 10 & 0x1f), f64::from(bits & 0x3ff));
    sign * match exponent {
        0 => libm::ldexp(fraction, -24),
        31 if fraction == 0.0 => f64::INFINITY,
        31 => f64::NAN,
        _ => libm::ldexp(1024.0 + fraction, exponent - 25),
    }
}
