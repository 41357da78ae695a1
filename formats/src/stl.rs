//! STL, ASCII and binary: a triangle soup, welded to a mesh.

use std::collections::HashMap;

use glam::DVec3;

use crate::colored_mesh::{ColoredMesh, Content};
use crate::cursor::Cursor;
use crate::guard::corrupt;
use crate::mesh_builder::MeshBuilder;
use crate::painted_mesh::PaintedMesh;
use crate::text::{lines, number, quoted, unmarked, words};
use sim3align_runtime::error::Result;

const HEADER_BYTES: usize = 80;
const TRIANGLE_BYTES: usize = 50;

/// Whether the length is exactly that of a binary STL. The header does not distinguish it from text, because it may
/// begin with "solid".
pub(crate) fn has_binary_length(bytes: &[u8]) -> bool {
    let mut cursor = Cursor::new("mesh", bytes);
    let count = cursor.take(HEADER_BYTES).and_then(|_| cursor.u32_le());
    count.is_ok_and(|count| (count as usize).checked_mul(TRIANGLE_BYTES) == Some(cursor.remaining().len()))
}

/// Whether a file begins with the keyword of the text form.
pub(crate) fn begins_as_text(bytes: &[u8]) -> bool {
    let text = unmarked(bytes).trim_ascii_start();
    text.get(..5).is_some_and(|word| word.eq_ignore_ascii_case(b"solid"))
}

/// Reads an STL. Vertices with equal coordinates are merged, without rounding.
///
/// # Errors
/// [`CorruptFile`](sim3align_runtime::error::ErrorCode::CorruptFile),
/// [`FileTooLarge`](sim3align_runtime::error::ErrorCode::FileTooLarge) and those of [`Mesh::new`](sim3align_geometry::mesh::Mesh::new).
pub fn read_stl(bytes: &[u8], content: Content) -> Result<ColoredMesh> {
    let is_text = !has_binary_length(bytes) && begins_as_text(bytes) && !bytes.iter().take(1024).any(|&b| b == 0);
    if is_text { read_text(bytes) } else { read_binary(bytes, content) }
}

fn read_binary(bytes: &[u8], content: Content) -> Result<ColoredMesh> {
    let mut cursor = Cursor::new("mesh", bytes);
    let header = cursor.take(HEADER_BYTES)?;
    let count = cursor.u32_le()?;
    let (stored, rest) = (cursor.remaining().len() / TRIANGLE_BYTES, cursor.remaining().len() % TRIANGLE_BYTES);
    if rest == 0 && stored != count as usize {
        let found = format!("an STL header that states {count} triangles, before the data of {stored}");
        return Err(corrupt("mesh", found, "as many triangles as the header states"));
    }
    let attributes = cursor
        .remaining()
        .chunks_exact(TRIANGLE_BYTES)
        .map(|triangle| u16::from_le_bytes([triangle[48], triangle[49]]));
    // Nearly all write zeros.
    let has_attributes = attributes.clone().any(|attribute| attribute != 0);
    let palette = Palette::of(header, attributes);
    let mut welder = Welder::default();
    for _ in 0..count {
        let triangle: [u8; TRIANGLE_BYTES] = cursor.array()?;
        let mut corners = [DVec3::ZERO; 3];
        for (corner, xyz) in corners.iter_mut().zip(triangle[12..48].as_chunks::<12>().0) {
            let [x, y, z] = [0, 4, 8].map(|i| f32::from_le_bytes([xyz[i], xyz[i + 1], xyz[i + 2], xyz[i + 3]]));
            *corner = DVec3::new(x.into(), y.into(), z.into());
        }
        if (has_attributes || palette.object.is_some()) && content == Content::ShapeAndColors {
            welder.builder.color_faces(palette.color(u16::from_le_bytes([triangle[48], triangle[49]])));
        }
        welder.push(corners)?;
    }
    welder.builder.finish().map(PaintedMesh::colored_by_faces)
}

/// How the two bytes after each triangle mean its colour: five bits a channel.
struct Palette {
    /// The colour of the object in the header, as Materialise Magics writes it; a set bit 15 stands for it, and red has the lowest bits.
    /// Without it, as of VisCAM and SolidView, a set bit 15 marks a colour, and blue has the lowest bits.
    object: Option<[f64; 3]>,
    /// Whether bit 15 is set everywhere though the colours differ: MeshLab writes the header of Magics, and marks colours.
    is_always_marked: bool,
}

impl Palette {
    fn of(header: &[u8], attributes: impl Iterator<Item = u16> + Clone) -> Self {
        let after =
            |window: &[u8]| window.strip_prefix(b"COLOR=").map(|rgb| [0, 1, 2].map(|i| f64::from(rgb[i]) / 255.0));
        let first = attributes.clone().next();
        let is_always_marked = attributes.clone().all(|attribute| attribute >> 15 == 1)
            && attributes.clone().any(|each| Some(each) != first);
        Self { object: header.windows(9).find_map(after), is_always_marked }
    }

    fn color(&self, attribute: u16) -> [f64; 3] {
        let channels = [0, 5, 10].map(|shift| f64::from(attribute >> shift & 31) / 31.0);
        let is_marked = attribute >> 15 == 1;
        match self.object {
            Some(object) if is_marked && !self.is_always_marked => object,
            Some(_) => channels,
            None if is_marked => [channels[2], channels[1], channels[0]],
            None => [1.0; 3],
        }
    }
}

fn read_text(bytes: &[u8]) -> Result<ColoredMesh> {
    let mut welder = Welder::default();
    let mut corners = Vec::with_capacity(3);
    let mut ended = false;
    for (i, line) in lines(bytes).enumerate() {
        let mut words = words(line);
        let keyword = words.next().unwrap_or_default();
        match keyword.to_ascii_lowercase().as_slice() {
            b"vertex" => {
                let mut xyz = [0.0; 3];
                for x in &mut xyz {
                    let word = words.next().unwrap_or_default();
                    let found = || format!("{} in line {}", quoted(word), i + 1);
                    *x = number(word).ok_or_else(|| corrupt("mesh", found(), "vertex x y z: three numbers"))?;
                }
                corners.push(DVec3::from_array(xyz));
            }
            b"endloop" => {
                let &[a, b, c] = corners.as_slice() else {
                    let found = format!("a facet of {} vertices before line {}", corners.len(), i + 1);
                    return Err(corrupt("mesh", found, "3"));
                };
                welder.push([a, b, c])?;
                corners.clear();
            }
            b"endsolid" => ended = true,
            _ => {}
        }
    }
    if !ended {
        return Err(corrupt("mesh", "no \"endsolid\" line", "\"endsolid\" at the end of an ASCII STL"));
    }
    welder.builder.finish().map(|painted| painted.plain(None))
}

/// Assigns one index to equal coordinates.
#[derive(Default)]
struct Welder {
    builder: MeshBuilder,
    indices: HashMap<[u64; 3], u32>,
}

impl Welder {
    fn push(&mut self, corners: [DVec3; 3]) -> Result<()> {
        let mut triangle = [0; 3];
        for (index, corner) in triangle.iter_mut().zip(corners) {
            // −0 + 0 is +0, so that both zeros are equal.
            let corner = corner + DVec3::ZERO;
            let key = corner.to_array().map(f64::to_bits);
            *index = match self.indices.get(&key) {
                Some(&known) => known,
                None => {
                    let new = self.builder.push_vertex(corner)?;
                    self.indices.insert(key, new);
                    new
                }
            };
        }
        self.builder.push_triangle(triangle)
    }
}
