//! Stanford PLY, ASCII and binary of both byte orders.

use std::borrow::Cow;

use glam::DVec3;

use crate::colored_mesh::{ColoredMesh, Content};
use crate::cursor::Cursor;
use crate::guard::{corrupt, unsupported};
use crate::mesh_builder::MeshBuilder;
use crate::mesh_format::MeshReadOptions;
use crate::painted_mesh::Material;
use crate::ply_header::{Element, Encoding, Header, Scalar};
use crate::ply_names::{self, COLORS, COORDINATES, CORNER_COORDINATES, CORNERS, TEXTURE_NUMBER};
use crate::resources::external;
use crate::text::{number, quoted};
use crate::texture::TextureLoader;
use sim3align_runtime::error::{Error, ErrorCode, Result};

/// Reads the elements `vertex` (x, y, z of any type, at any position among the properties), `face` (polygons, as
/// triangles) and `tristrips`. Colours are those of the textures, of the vertices or of the faces: see
/// [`ply_names`](crate::ply_names).
///
/// # Errors
/// [`ErrorCode::CorruptFile`], [`ErrorCode::UnsupportedFormat`], [`ErrorCode::FileTooLarge`],
/// [`ErrorCode::IndexOutOfRange`] and those of [`Mesh::new`](sim3align_geometry::mesh::Mesh::new).
pub(crate) fn read_ply(bytes: &[u8], options: &MeshReadOptions<'_>, content: Content) -> Result<ColoredMesh> {
    let (header, body) = Header::read(bytes)?;
    let mut body = Body::new("mesh", header.encoding, body);
    let mut mesh = PlyMesh { has_colors: content == Content::ShapeAndColors, ..PlyMesh::default() };
    for element in header.elements.iter().filter(|element| !element.properties.is_empty()) {
        body.check_count(element)?;
        match element.name.as_slice() {
            b"vertex" => mesh.read_vertices(element, &mut body)?,
            b"face" => mesh.read_faces(element, &mut body, &header.textures)?,
            b"tristrips" => mesh.read_strips(element, &mut body)?,
            _ => read_records(element, &mut body, |_, _| Ok(()))?,
        }
    }
    let unknown = ply_names::unknown(&header);
    let has_colors = mesh.has_colors;
    let mut read = mesh.finish(&header.textures, options)?;
    if has_colors && read.colors.is_none() && unknown.any(ply_names::concerns_colors) {
        let expected = "red, green and blue, or \"comment TextureFile NAME\" in the header with texture_u and texture_v, or texcoord and texnumber";
        let problem = || uncolored("colours in properties that are not known", expected);
        read.problem = read.problem.or_else(|| Some(problem()));
    }
    Ok(ColoredMesh { unread: unknown.named("the PLY properties"), ..read })
}

/// The error for colours that cannot be read.
fn uncolored(found: &'static str, expected: &'static str) -> Error {
    unsupported("mesh", found, expected, "Export the mesh as GLB, which holds its textures.")
}

/// A mesh as its elements are read.
#[derive(Default)]
struct PlyMesh {
    builder: MeshBuilder,
    has_colors: bool,
    /// Texture coordinates of the vertices.
    coordinates: Vec<[f32; 2]>,
    /// Whether the faces have texture coordinates, and numbers of textures.
    has_corner_coordinates: bool,
    has_numbers: bool,
}

impl PlyMesh {
    fn read_vertices(&mut self, element: &Element, body: &mut Body<'_>) -> Result<()> {
        let mut place = [0; 3];
        for (place, name) in place.iter_mut().zip([b"x", b"y", b"z"]) {
            *place = element.scalar(name).ok_or_else(|| {
                corrupt("mesh", format!("vertices without {}", name.escape_ascii()), "the properties x, y and z")
            })?;
        }
        let colors = COLORS.iter().find_map(|names| element.scalars(names)).filter(|_| self.has_colors);
        let coordinates = COORDINATES.iter().find_map(|names| element.scalars(names)).filter(|_| self.has_colors);
        let last = element.properties.len() - 1;
        let mut record = vec![0.0; last + 1];
        read_records(element, body, |property, values| {
            record[property] = values.first().copied().unwrap_or(f64::NAN);
            if property < last {
                return Ok(());
            }
            self.builder.push_vertex(DVec3::from_array(place.map(|place| record[place])))?;
            if let Some(places) = colors {
                self.builder.color_vertex(places.map(|place| element.fraction(place, &record)));
            }
            if let Some([u, v]) = coordinates {
                // Rows of images count from the top.
                self.coordinates.push([record[u] as f32, 1.0 - record[v] as f32]);
            }
            Ok(())
        })
    }

    fn read_faces(&mut self, element: &Element, body: &mut Body<'_>, textures: &[String]) -> Result<()> {
        let place = corners_of(element)?;
        let colors = COLORS.iter().find_map(|names| element.scalars(names)).filter(|_| textures.is_empty());
        let mapped = element.list(CORNER_COORDINATES);
        let number = element.scalar(TEXTURE_NUMBER);
        (self.has_corner_coordinates, self.has_numbers) = (mapped.is_some(), number.is_some());
        let last = element.properties.len() - 1;
        let mut record = vec![0.0; last + 1];
        let (mut corners, mut coordinates) = (Vec::new(), Vec::new());
        read_records(element, body, |property, values| {
            record[property] = values.first().copied().unwrap_or_default();
            if property == place {
                read_corners(values, false, &mut corners)?;
            } else if mapped == Some(property) {
                let pairs = values.as_chunks().0.iter();
                coordinates = pairs.map(|&[u, v]: &[f64; 2]| [u as f32, 1.0 - v as f32]).collect();
            }
            if property < last {
                return Ok(());
            }
            if self.has_colors {
                if !textures.is_empty() {
                    // −1 stands for no texture.
                    self.builder
                        .use_material(number.map_or(Some(0), |place| usize::try_from(record[place] as i64).ok()));
                } else if let Some(places) = colors {
                    self.builder.color_faces(places.map(|place| element.fraction(place, &record)));
                }
            }
            let first = self.builder.triangle_count();
            self.builder.push_polygon(&corners)?;
            if self.has_colors && !coordinates.is_empty() && coordinates.len() >= corners.len() {
                self.builder.map_polygon(first, &coordinates);
            }
            Ok(())
        })
    }

    fn read_strips(&mut self, element: &Element, body: &mut Body<'_>) -> Result<()> {
        let place = corners_of(element)?;
        let mut corners = Vec::new();
        read_records(element, body, |property, values| {
            if property != place {
                return Ok(());
            }
            read_corners(values, true, &mut corners)?;
            corners.split(|&corner| corner == SEPARATOR).try_for_each(|strip| self.builder.push_strip(strip))
        })
    }

    fn finish(mut self, textures: &[String], options: &MeshReadOptions<'_>) -> Result<ColoredMesh> {
        let has_coordinates = self.has_corner_coordinates || !self.coordinates.is_empty();
        if !self.has_corner_coordinates && !textures.is_empty() {
            self.builder.map_vertices(&self.coordinates);
        }
        let painted = self.builder.finish()?;
        if !self.has_colors {
            return Ok(painted.plain(None));
        }
        let problem = match (textures.len(), has_coordinates) {
            (0, true) => "texture coordinates without a texture",
            (1.., false) => "a texture without texture coordinates",
            (2.., true) if !self.has_numbers => "several textures, and faces without texnumber",
            (0, false) => return Ok(painted.colored_by_faces()),
            _ => {
                let materials = textures_of(textures, &painted.paint.used_materials(), options);
                return Ok(painted.colored_by_finest(materials));
            }
        };
        if painted.paint.vertex_colors.is_empty() && painted.paint.face_colors.is_empty() {
            let expected =
                "\"comment TextureFile NAME\" in the header, and texture_u and texture_v, or texcoord and texnumber";
            return Ok(painted.plain(Some(uncolored(problem, expected))));
        }
        Ok(painted.colored_by_faces())
    }
}

/// The materials of textures; those of no part are left at the default.
fn textures_of(files: &[String], used: &[usize], options: &MeshReadOptions<'_>) -> Result<Vec<Material>> {
    let mut loader = TextureLoader::new(options.images);
    let mut material = |(index, file): (usize, &String)| {
        if !used.contains(&index) {
            return Ok(Material::default());
        }
        let texture = loader.load(file, || external(file, options.resources).map(Cow::Owned))?;
        Ok(Material { texture: Some(texture), ..Material::default() })
    };
    files.iter().enumerate().map(&mut material).collect()
}

/// The place of the list of the vertices of faces or strips.
fn corners_of(element: &Element) -> Result<usize> {
    CORNERS
        .iter()
        .find_map(|name| element.list(name))
        .ok_or_else(|| corrupt("mesh", "faces without vertex_indices", "a list property vertex_indices"))
}

/// What −1 between strips arrives as.
const SEPARATOR: u32 = u32::MAX;

/// The numbers of vertices.
fn read_corners(values: &[f64], is_strip: bool, corners: &mut Vec<u32>) -> Result<()> {
    corners.clear();
    for &value in values {
        let separates = is_strip && value == -1.0;
        let is_index = value >= 0.0 && value < f64::from(SEPARATOR) && value == value.trunc();
        if !separates && !is_index {
            return Err(Error::new(
                ErrorCode::IndexOutOfRange,
                "mesh",
                format!("vertex index {value}"),
                "whole numbers from 0",
                "Export the mesh again.",
            ));
        }
        corners.push(if separates { SEPARATOR } else { value as u32 });
    }
    Ok(())
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
