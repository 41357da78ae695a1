//! Stanford PLY, ASCII and binary of both byte orders.

use glam::DVec3;

use crate::colored_mesh::{ColoredMesh, Content};
use crate::cursor::Cursor;
use crate::guard::corrupt;
use crate::mesh_builder::MeshBuilder;
use crate::ply_header::{Element, Encoding, Header, Scalar};
use crate::text::{number, quoted};
use sim3align_geometry::surface_colors::Rgb;
use sim3align_runtime::error::{Error, ErrorCode, Result};

/// Reads the elements `vertex` (x, y, z of any type, at any position among the properties), `face` (polygons, as
/// triangles) and `tristrips`; ignores the others. Colours are the properties red, green and blue of the vertices: whole numbers
/// up to the largest of their type, or floats from 0 to 1, sRGB-encoded.
///
/// # Errors
/// [`ErrorCode::CorruptFile`], [`ErrorCode::UnsupportedFormat`], [`ErrorCode::FileTooLarge`],
/// [`ErrorCode::IndexOutOfRange`] and those of [`Mesh::new`](sim3align_geometry::mesh::Mesh::new).
pub(crate) fn read_ply(bytes: &[u8], content: Content) -> Result<ColoredMesh> {
    let (header, body) = Header::read(bytes)?;
    let mut body = Body::new("mesh", header.encoding, body);
    let mut builder = MeshBuilder::default();
    for element in header.elements.iter().filter(|element| !element.properties.is_empty()) {
        body.check_count(element)?;
        match element.name.as_slice() {
            b"vertex" => read_vertices(element, &mut body, |point, color| {
                builder.push_vertex(point)?;
                if let (Some(color), Content::ShapeAndColors) = (color, content) {
                    builder.color_vertex(color);
                }
                Ok(())
            })?,
            b"face" => read_faces(element, &mut body, &mut |corners| builder.push_polygon(corners))?,
            b"tristrips" => read_faces(element, &mut body, &mut |corners| {
                // −1, which arrives as u32::MAX, separates the strips.
                corners.split(|&corner| corner == u32::MAX).try_for_each(|strip| builder.push_strip(strip))
            })?,
            _ => read_records(element, &mut body, |_, _| Ok(()))?,
        }
    }
    Ok(builder.finish()?.colored(Ok(Vec::new())))
}

fn read_vertices(
    element: &Element,
    body: &mut Body<'_>,
    mut push: impl FnMut(DVec3, Option<Rgb>) -> Result<()>,
) -> Result<()> {
    let place_of = |name: &[u8]| element.properties.iter().position(|p| p.name == name && p.list_length.is_none());
    let mut place = [0; 3];
    for (place, name) in place.iter_mut().zip([b"x", b"y", b"z"]) {
        *place = place_of(name).ok_or_else(|| {
            corrupt("mesh", format!("vertices without {}", name.escape_ascii()), "the properties x, y and z")
        })?;
    }
    let colors = match [b"red".as_slice(), b"green", b"blue"].map(place_of) {
        [Some(red), Some(green), Some(blue)] => Some([red, green, blue]),
        _ => None,
    };
    let last = element.properties.len() - 1;
    let (mut xyz, mut rgb) = ([0.0; 3], [0; 3]);
    read_records(element, body, |property, values| {
        for (x, place) in xyz.iter_mut().zip(place) {
            if property == place {
                *x = values.first().copied().unwrap_or(f64::NAN);
            }
        }
        if let Some(places) = colors {
            for (channel, place) in rgb.iter_mut().zip(places) {
                if property == place {
                    let most = element.properties.get(place).map_or(1.0, |property| property.scalar.most());
                    *channel = (values.first().copied().unwrap_or_default() / most * 255.0).round() as u8;
                }
            }
        }
        if property == last {
            push(DVec3::from_array(xyz), colors.map(|_| rgb))?;
        }
        Ok(())
    })
}

fn read_faces(element: &Element, body: &mut Body<'_>, push: &mut dyn FnMut(&[u32]) -> Result<()>) -> Result<()> {
    let is_indices = |name: &[u8]| name == b"vertex_indices" || name == b"vertex_index";
    let Some(place) = element.properties.iter().position(|p| p.list_length.is_some() && is_indices(&p.name)) else {
        return Err(corrupt("mesh", "faces without vertex_indices", "a list property vertex_indices"));
    };
    let is_strip = element.name == b"tristrips";
    let mut corners = Vec::new();
    read_records(element, body, |property, values| {
        if property != place {
            return Ok(());
        }
        corners.clear();
        for &value in values {
            let separates = is_strip && value == -1.0;
            let is_index = value >= 0.0 && value < f64::from(u32::MAX) && value == value.trunc();
            if !separates && !is_index {
                return Err(Error::new(
                    ErrorCode::IndexOutOfRange,
                    "mesh",
                    format!("vertex index {value}"),
                    "whole numbers from 0",
                    "Export the mesh again.",
                ));
            }
            corners.push(if separates { u32::MAX } else { value as u32 });
        }
        push(&corners)
    })
}

/// Calls `visit` with the position of each property and its values (one, or the list), record by record.
pub(crate) fn read_records(
    element: &Element,
    body: &mut Body<'_>,
    mut visit: impl FnMut(usize, &[f64]) -> Result<()>,
) -> Result<()> {
    let mut values = Vec::new();
    for _ in 0..element.count {
        for (place, property) in element.properties.iter().enumerate() {
            values.clear();
            let length = match property.list_length {
                None => 1,
                Some(scalar) => body.list_length(scalar)?,
            };
            for _ in 0..length {
                values.push(body.next(property.scalar)?);
            }
            visit(place, &values)?;
        }
    }
    Ok(())
}

/// The numbers after the header.
pub(crate) struct Body<'a> {
    encoding: Encoding,
    cursor: Cursor<'a>,
}

impl<'a> Body<'a> {
    /// The numbers of a file after its header; `argument` names the file in errors.
    pub fn new(argument: &'static str, encoding: Encoding, bytes: &'a [u8]) -> Self {
        Self { encoding, cursor: Cursor::new(argument, bytes) }
    }

    /// Checks a count against the remaining bytes, before anything is read or allocated.
    pub fn check_count(&self, element: &Element) -> Result<()> {
        // One more byte: the last number of an ASCII file need not be followed by a space.
        let available = self.cursor.remaining().len() + 1;
        match element.count.checked_mul(element.min_bytes(self.encoding)) {
            Some(bytes) if bytes <= available => Ok(()),
            _ => Err(corrupt(
                "mesh",
                format!("{} bytes for {} × {}", available - 1, element.count, quoted(&element.name)),
                "as many records as the PLY header says",
            )),
        }
    }

    fn list_length(&mut self, scalar: Scalar) -> Result<usize> {
        let length = self.next(scalar)?;
        if !(length >= 0.0 && length == length.trunc() && length <= self.cursor.remaining().len() as f64) {
            let found = format!("a list of {length} numbers in {} bytes", self.cursor.remaining().len());
            return Err(corrupt("mesh", found, "a length that the file holds"));
        }
        Ok(length as usize)
    }

    /// The next number; f64 represents all types exactly.
    fn next(&mut self, scalar: Scalar) -> Result<f64> {
        if self.encoding == Encoding::Ascii {
            return self.next_word();
        }
        let mut bytes = [0; 8];
        let bytes = &mut bytes[..scalar.size()];
        bytes.copy_from_slice(self.cursor.take(scalar.size())?);
        if self.encoding == Encoding::BigEndian {
            bytes.reverse();
        }
        Ok(match (scalar, &*bytes) {
            (Scalar::I8, &[a]) => f64::from(a as i8),
            (Scalar::U8, &[a]) => f64::from(a),
            (Scalar::I16, &[a, b]) => f64::from(i16::from_le_bytes([a, b])),
            (Scalar::U16, &[a, b]) => f64::from(u16::from_le_bytes([a, b])),
            (Scalar::I32, &[a, b, c, d]) => f64::from(i32::from_le_bytes([a, b, c, d])),
            (Scalar::U32, &[a, b, c, d]) => f64::from(u32::from_le_bytes([a, b, c, d])),
            (Scalar::F32, &[a, b, c, d]) => f64::from(f32::from_le_bytes([a, b, c, d])),
            (_, &[a, b, c, d, e, f, g, h]) => f64::from_le_bytes([a, b, c, d, e, f, g, h]),
            _ => f64::NAN,
        })
    }

    fn next_word(&mut self) -> Result<f64> {
        let rest = self.cursor.remaining();
        let start = rest.iter().position(|b| !b.is_ascii_whitespace()).unwrap_or(rest.len());
        let length = rest.iter().skip(start).take_while(|b| !b.is_ascii_whitespace()).count();
        let taken = self.cursor.take(start + length)?;
        let word = taken.get(start..).unwrap_or_default();
        number(word).ok_or_else(|| {
            let found = if word.is_empty() { "the end of the file".into() } else { quoted(word) };
            corrupt("mesh", found, "a number")
        })
    }
}
