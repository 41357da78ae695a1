//! NumPy `.npy` files, versions 1 to 3: two-dimensional arrays of numbers.

use crate::cursor::Cursor;
use crate::guard::{corrupt, pixel_count, unsupported};
use sim3align_geometry::error::Result;

pub(crate) const MAGIC: &[u8] = b"\x93NUMPY";

/// The type of an element.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Kind {
    Bool,
    Signed,
    Unsigned,
    Float,
}

/// An image-shaped array: H×W, H×W×1 or 1×H×W.
#[derive(Debug)]
pub(crate) struct NpyImage<'a> {
    pub width: usize,
    pub height: usize,
    pub kind: Kind,
    /// Bytes per element.
    pub size: usize,
    big_endian: bool,
    fortran_order: bool,
    data: &'a [u8],
}

impl<'a> NpyImage<'a> {
    /// Reads the header and checks that the data are complete. Rejects sizes above the limit and shapes other than
    /// those of an image.
    pub fn read(argument: &'static str, bytes: &'a [u8]) -> Result<Self> {
        let mut cursor = Cursor::new(argument, bytes);
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
        let image = match shape.as_slice() {
            [1, image @ ..] if image.len() == 2 => image,
            [image @ .., 1] if image.len() == 2 => image,
            image => image,
        };
        let &[height, width] = image else {
            let found = format!("an array of shape {shape:?}");
            let remedy = "Pass one image: array[0] of a batch, array[..., 0] of channels.";
            return Err(unsupported(argument, found, "H × W, H × W × 1 or 1 × H × W", remedy));
        };
        let count = pixel_count(argument, width, height)?;
        let data = cursor.take(count * size)?;
        Ok(Self { width, height, kind, size, big_endian, fortran_order, data })
    }

    /// The elements, row-major, for both storage orders of the file.
    pub fn values(&self) -> impl Iterator<Item = f64> {
        (0..self.height).flat_map(move |v| {
            (0..self.width).map(move |u| {
                let place = if self.fortran_order { v + u * self.height } else { v * self.width + u };
                self.value(place)
            })
        })
    }

    fn value(&self, place: usize) -> f64 {
        let mut bytes = [0; 8];
        let element = self.data.get(place * self.size..).and_then(|rest| rest.get(..self.size)).unwrap_or_default();
        for (to, from) in bytes.iter_mut().zip(element) {
            *to = *from;
        }
        if self.big_endian {
            bytes[..self.size.min(8)].reverse();
        }
        let [a, b, c, d, ..] = bytes;
        match (self.kind, self.size) {
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
