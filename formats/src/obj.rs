//! Wavefront OBJ: vertices and faces; other statements are ignored.

use glam::DVec3;

use crate::guard::corrupt;
use crate::mesh_builder::MeshBuilder;
use crate::text::{lines, number, quoted, words};
use sim3align_geometry::error::{Error, ErrorCode, Result};
use sim3align_geometry::mesh::Mesh;

/// Reads `v` and `f` lines: polygons become fans, negative indices count back from the latest vertex, and a
/// backslash at the end of a line continues it. Vertex colours, weights, normals and free-form surfaces are not read.
///
/// # Errors
/// [`ErrorCode::CorruptFile`] with the line number, [`ErrorCode::IndexOutOfRange`], [`ErrorCode::FileTooLarge`],
/// and those of [`Mesh::new`].
pub fn read_obj(bytes: &[u8]) -> Result<Mesh> {
    let mut builder = MeshBuilder::default();
    let mut statement: Vec<&[u8]> = Vec::new();
    let mut corners = Vec::new();
    for (i, line) in lines(bytes).enumerate() {
        let code = line.split(|&b| b == b'#').next().unwrap_or_default().trim_ascii_end();
        if let Some(continued) = code.strip_suffix(b"\\") {
            statement.extend(words(continued));
            continue;
        }
        statement.extend(words(code));
        match statement.split_first() {
            Some((&b"v", rest)) => {
                builder.push_vertex(vertex(rest, i + 1)?)?;
            }
            Some((&b"f", rest)) => {
                corners.clear();
                for word in rest {
                    corners.push(corner(word, builder.vertex_count(), i + 1)?);
                }
                if corners.len() < 3 {
                    let found = format!("a face of {} corners in line {}", corners.len(), i + 1);
                    return Err(corrupt("mesh", found, "at least 3"));
                }
                builder.push_fan(&corners)?;
            }
            _ => {}
        }
        statement.clear();
    }
    builder.finish()
}

fn vertex(words: &[&[u8]], line: usize) -> Result<glam::Vec3> {
    let mut xyz = [0.0; 3];
    for (axis, x) in xyz.iter_mut().enumerate() {
        let word = words.get(axis).copied().unwrap_or_default();
        *x = number(word)
            .ok_or_else(|| corrupt("mesh", format!("{} in line {line}", quoted(word)), "v x y z: three numbers"))?;
    }
    Ok(DVec3::from_array(xyz).as_vec3())
}

/// The vertex index of `v`, `v/vt`, `v//vn` or `v/vt/vn`, counted from 0.
fn corner(word: &[u8], vertex_count: usize, line: usize) -> Result<u32> {
    let digits = word.split(|&b| b == b'/').next().unwrap_or_default();
    let index: Option<i64> = core::str::from_utf8(digits).ok().and_then(|digits| digits.parse().ok());
    let Some(index) = index else {
        return Err(corrupt("mesh", format!("{} in line {line}", quoted(word)), "f v/vt/vn …: vertex numbers"));
    };
    // OBJ allows forward references, so that positive indices can only be checked against the complete mesh.
    let from_zero = if index < 0 { vertex_count as i64 + index } else { index - 1 };
    u32::try_from(from_zero).map_err(|_| {
        Error::new(
            ErrorCode::IndexOutOfRange,
            "mesh",
            format!("vertex {index} in line {line}, after {vertex_count} vertices"),
            "numbers from 1, or from -1 backwards, of existing vertices",
            "Export the mesh again: OBJ counts from 1.",
        )
    })
}
