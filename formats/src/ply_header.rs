//! The header of a PLY file: elements, properties and encoding.

use crate::guard::{corrupt, unsupported};
use crate::text::{parsed, quoted, words};
use sim3align_runtime::error::Result;

/// The encoding of the body.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Encoding {
    Ascii,
    LittleEndian,
    BigEndian,
}

/// The type of a number.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Scalar {
    I8,
    U8,
    I16,
    U16,
    I32,
    U32,
    F32,
    F64,
}

impl Scalar {
    fn from_name(name: &[u8]) -> Option<Self> {
        Some(match name {
            b"char" | b"int8" => Self::I8,
            b"uchar" | b"uint8" => Self::U8,
            b"short" | b"int16" => Self::I16,
            b"ushort" | b"uint16" => Self::U16,
            b"int" | b"int32" => Self::I32,
            b"uint" | b"uint32" => Self::U32,
            b"float" | b"float32" => Self::F32,
            b"double" | b"float64" => Self::F64,
            _ => return None,
        })
    }

    /// The number that stands for the full intensity of a colour.
    pub fn most(self) -> f64 {
        match self {
            Self::I8 => 127.0,
            Self::U8 => 255.0,
            Self::I16 => 32_767.0,
            Self::U16 => 65_535.0,
            Self::I32 => 2_147_483_647.0,
            Self::U32 => 4_294_967_295.0,
            Self::F32 | Self::F64 => 1.0,
        }
    }

    /// Bytes per number in a binary body.
    pub fn size(self) -> usize {
        match self {
            Self::I8 | Self::U8 => 1,
            Self::I16 | Self::U16 => 2,
            Self::I32 | Self::U32 | Self::F32 => 4,
            Self::F64 => 8,
        }
    }
}

/// A property of an element.
#[derive(Debug, Clone)]
pub(crate) struct Property {
    /// In lower case.
    pub name: Vec<u8>,
    /// The type of the length of a list property; `None` for a scalar.
    pub list_length: Option<Scalar>,
    pub scalar: Scalar,
}

/// An element: a sequence of records.
#[derive(Debug, Clone)]
pub(crate) struct Element {
    pub name: Vec<u8>,
    pub count: usize,
    pub properties: Vec<Property>,
}

impl Element {
    /// The place of a property that is a single number.
    pub fn scalar(&self, name: &[u8]) -> Option<usize> {
        self.properties.iter().position(|property| property.name == name && property.list_length.is_none())
    }

    /// The same for several properties, if all are there.
    pub fn scalars<const N: usize>(&self, names: &[&[u8]; N]) -> Option<[usize; N]> {
        let mut places = [0; N];
        for (place, name) in places.iter_mut().zip(names) {
            *place = self.scalar(name)?;
        }
        Some(places)
    }

    /// The place of a property that is a list.
    pub fn list(&self, name: &[u8]) -> Option<usize> {
        self.properties.iter().position(|property| property.name == name && property.list_length.is_some())
    }

    /// The number of a record at a place, relative to the full intensity of its type.
    pub fn fraction(&self, place: usize, record: &[f64]) -> f64 {
        let number = record.get(place).copied().unwrap_or_default();
        self.properties.get(place).map_or(0.0, |property| number / property.scalar.most())
    }

    /// Minimum size of a record in bytes, used to check a count before allocation.
    pub fn min_bytes(&self, encoding: Encoding) -> usize {
        match encoding {
            Encoding::Ascii => 2 * self.properties.len(),
            _ => self.properties.iter().map(|p| p.list_length.unwrap_or(p.scalar).size()).sum(),
        }
    }
}

/// The header.
#[derive(Debug, Clone)]
pub(crate) struct Header {
    pub encoding: Encoding,
    pub elements: Vec<Element>,
    /// The images of the textures, as `comment TextureFile` names them.
    pub textures: Vec<String>,
}

impl Header {
    /// Reads the header; returns it and the body.
    pub fn read(bytes: &[u8]) -> Result<(Self, &[u8])> {
        // Some files end lines with a bare \r, and a binary body may begin with \n: the first line decides.
        let end = if bytes.starts_with(b"ply\r") && !bytes.starts_with(b"ply\r\n") { b'\r' } else { b'\n' };
        let mut rest = bytes;
        let mut encoding = None;
        let mut elements: Vec<Element> = Vec::new();
        let mut textures = Vec::new();
        loop {
            let Some(length) = rest.iter().position(|&b| b == end) else {
                return Err(corrupt("mesh", "no \"end_header\" line", "a PLY header that ends with \"end_header\""));
            };
            let (line, after) = rest.split_at(length);
            rest = after.get(1..).unwrap_or_default();
            let words: Vec<&[u8]> = words(line).collect();
            match words.as_slice() {
                [b"end_header"] => break,
                [b"format", name, ..] => encoding = Some(read_encoding(name)?),
                [b"element", name, count] => elements.push(Element {
                    name: name.to_vec(),
                    count: parsed(count)
                        .ok_or_else(|| corrupt("mesh", quoted(count), "the number of elements in the PLY header"))?,
                    properties: Vec::new(),
                }),
                [b"property", description @ ..] => {
                    let property = read_property(description).ok_or_else(|| {
                        let expected = "property TYPE NAME or property list TYPE TYPE NAME in the PLY header";
                        corrupt("mesh", quoted(line), expected)
                    })?;
                    let Some(element) = elements.last_mut() else {
                        return Err(corrupt("mesh", "a property before any element", "element lines first"));
                    };
                    element.properties.push(property);
                }
                [b"comment", name, file @ ..] if !file.is_empty() && is_texture(name) => {
                    textures.push(String::from_utf8_lossy(&file.join(&b' ')).replace('\\', "/"));
                }
                [] | [b"ply" | b"comment" | b"obj_info", ..] => {}
                _ => return Err(corrupt("mesh", quoted(line), "a PLY header line")),
            }
        }
        match encoding {
            Some(encoding) => Ok((Self { encoding, elements, textures }, rest)),
            None => Err(corrupt("mesh", "no \"format\" line", "a \"format\" line in the PLY header")),
        }
    }
}

/// Whether a comment of this name names a texture: `TextureFile`, in any spelling.
fn is_texture(name: &[u8]) -> bool {
    let letters: Vec<u8> = name.iter().filter(|byte| byte.is_ascii_alphabetic()).copied().collect();
    letters.eq_ignore_ascii_case(b"TextureFile")
}

fn read_encoding(name: &[u8]) -> Result<Encoding> {
    match name {
        b"ascii" => Ok(Encoding::Ascii),
        b"binary_little_endian" => Ok(Encoding::LittleEndian),
        b"binary_big_endian" => Ok(Encoding::BigEndian),
        _ => Err(unsupported(
            "mesh",
            format!("PLY format {}", quoted(name)),
            "ascii, binary_little_endian or binary_big_endian",
            "Export the mesh again.",
        )),
    }
}

fn read_property(words: &[&[u8]]) -> Option<Property> {
    match words {
        [b"list", length, scalar, name] => Some(Property {
            name: name.to_ascii_lowercase(),
            list_length: Some(Scalar::from_name(length)?),
            scalar: Scalar::from_name(scalar)?,
        }),
        [scalar, name] => {
            Some(Property { name: name.to_ascii_lowercase(), list_length: None, scalar: Scalar::from_name(scalar)? })
        }
        _ => None,
    }
}
