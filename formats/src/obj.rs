//! Wavefront OBJ: vertices, faces and colours.

use glam::DVec3;

use crate::colored_mesh::{ColoredMesh, Content};
use crate::guard::{MAX_VERTICES, Unknown, corrupt, too_large, unsupported};
use crate::mesh_builder::MeshBuilder;
use crate::mesh_format::MeshReadOptions;
use crate::mtl::{MaterialLibrary, uncommented};
use crate::resources::{Resources, distinct, external};
use crate::text::{is_listed, lines, number, parsed, quoted, words};
use sim3align_runtime::error::{Error, ErrorCode, Result};

/// Statements of no matter for shape and colour: normals, names, groups, smoothing, points and lines, and what belongs to rendering.
const HARMLESS: &str = "vn vt mtllib usemtl o g s mg p l lod bevel c_interp d_interp shadow_obj trace_obj ctech stech";

/// Reads `v` and `f` lines: polygons become triangles, negative indices count back from the latest vertex, and a
/// backslash at the end of a line continues it. Normals are not read.
///
/// Colours are the textures of the materials (`map_Kd` with the `vt` of the faces), else those of the vertices (`v x y z r g b`,
/// sRGB-encoded, 0 to 1 or 0 to 255), else `Kd`.
///
/// # Errors
/// [`ErrorCode::CorruptFile`] with the line number, [`ErrorCode::IndexOutOfRange`], [`ErrorCode::FileTooLarge`],
/// and those of [`Mesh::new`](sim3align_geometry::mesh::Mesh::new).
pub(crate) fn read_obj(bytes: &[u8], options: &MeshReadOptions<'_>, content: Content) -> Result<ColoredMesh> {
    let resources = options.resources;
    let mut builder = MeshBuilder::default();
    let mut colors = (content == Content::ShapeAndColors).then(|| ObjColors::new(resources));
    let mut corners = Vec::new();
    let mut unknown = Unknown::default();
    for_each_statement(bytes, &mut |line, statement| {
        match statement.split_first() {
            Some((&b"v", rest)) => {
                builder.push_vertex(vertex(rest, line)?)?;
                if let (Some(color), true) = (vertex_color(rest), colors.is_some()) {
                    builder.color_vertex(color);
                }
            }
            Some((&(b"f" | b"fo"), rest)) => {
                corners.clear();
                for word in rest {
                    corners.push(corner(word, builder.vertex_count(), line)?);
                }
                if corners.len() < 3 {
                    let found = format!("a face of {} corners in line {line}", corners.len());
                    return Err(corrupt("mesh", found, "at least 3"));
                }
                let first = builder.triangle_count();
                builder.push_polygon(&corners)?;
                if let Some(colors) = &colors {
                    colors.map_face(&mut builder, first, rest);
                }
            }
            Some((&word, rest)) => {
                if !is_listed(word, HARMLESS) {
                    unknown.insert(word);
                }
                if let Some(colors) = &mut colors {
                    colors.read(word, rest, &mut builder)?;
                }
            }
            None => {}
        }
        Ok(())
    })?;
    let painted = builder.finish()?;
    let mut unread = unknown.named("the OBJ statements");
    let Some(colors) = colors else { return Ok(ColoredMesh { unread, ..painted.plain(None) }) };
    unread.extend(colors.library.unknown.named("in its materials the statements"));
    let materials = match colors.missing {
        Some(missing) => Err(missing),
        None if lines(bytes).any(|line| line.starts_with(b"#MRGB")) => {
            let found = "colours of ZBrush in comments (#MRGB)";
            Err(unsupported(
                "mesh",
                found,
                "colours after the coordinates, or a texture",
                "Export the mesh with a texture, or as PLY.",
            ))
        }
        None => colors.library.load(&painted.paint.used_materials(), options),
    };
    Ok(ColoredMesh { unread, ..painted.colored_by_finest(materials) })
}

/// The files that an OBJ or MTL names: its libraries or textures, as written.
pub(crate) fn external_resources(bytes: &[u8]) -> Result<Vec<String>> {
    let mut files = Vec::new();
    for_each_statement(bytes, &mut |_, statement| {
        if let Some((&b"mtllib", rest)) = statement.split_first() {
            files.push(file_name(rest));
        }
        Ok(())
    })?;
    let mut library = MaterialLibrary::default();
    library.add(bytes);
    Ok(distinct(files.iter().map(String::as_str).chain(library.files())))
}

/// Materials and texture coordinates that the faces of an OBJ refer to.
struct ObjColors<'a> {
    resources: Option<Resources<'a>>,
    library: MaterialLibrary,
    /// The files that it was read from.
    libraries: Vec<String>,
    /// Texture coordinates, from the lower left corner of the image.
    coordinates: Vec<[f32; 2]>,
    material: Option<usize>,
    /// The error for a library that `resources` lacks.
    missing: Option<Error>,
}

impl<'a> ObjColors<'a> {
    fn new(resources: Option<Resources<'a>>) -> Self {
        Self {
            resources,
            library: MaterialLibrary::default(),
            libraries: Vec::new(),
            coordinates: Vec::new(),
            material: None,
            missing: None,
        }
    }

    /// Reads the statements that concern colours.
    fn read(&mut self, word: &[u8], rest: &[&[u8]], builder: &mut MeshBuilder) -> Result<()> {
        match word {
            b"vt" => {
                if self.coordinates.len() >= MAX_VERTICES {
                    let found = format!("more than {MAX_VERTICES} texture coordinates");
                    return Err(too_large("mesh", found, "fewer"));
                }
                let mut numbers = rest.iter().map(|word| number(word).unwrap_or_default() as f32);
                self.coordinates.push([numbers.next().unwrap_or_default(), numbers.next().unwrap_or_default()]);
            }
            b"mtllib" => {
                let name = file_name(rest);
                if !self.libraries.contains(&name) && self.missing.is_none() {
                    match external(&name, self.resources) {
                        Ok(bytes) => self.library.add(&bytes),
                        Err(error) => self.missing = Some(error),
                    }
                    self.libraries.push(name);
                }
            }
            b"usemtl" => {
                self.material = self.library.index_of(&rest.join(&b' '));
                builder.use_material(self.material);
            }
            _ => {}
        }
        Ok(())
    }

    /// Sets the texture coordinates of the triangles of a face, if its material has a texture.
    fn map_face(&self, builder: &mut MeshBuilder, first: usize, corners: &[&[u8]]) {
        let Some([offset, scale]) = self.library.mapping(self.material) else { return };
        let of = |word: &&[u8]| {
            let digits = word.split(|&b| b == b'/').nth(1).unwrap_or_default();
            let index: i64 = parsed(digits).unwrap_or_default();
            let from_zero = if index < 0 { self.coordinates.len() as i64 + index } else { index - 1 };
            let place = usize::try_from(from_zero).unwrap_or(usize::MAX);
            let [u, v] = self.coordinates.get(place).copied().unwrap_or_default();
            // Rows of images count from the top.
            [u * scale[0] + offset[0], 1.0 - (v * scale[1] + offset[1])]
        };
        let mapped: Vec<[f32; 2]> = corners.iter().map(of).collect();
        builder.map_polygon(first, &mapped);
    }
}

/// Receives the line number and the words of a statement.
type Visit<'v> = dyn FnMut(usize, &[&[u8]]) -> Result<()> + 'v;

/// Calls `visit` with each statement.
fn for_each_statement(bytes: &[u8], visit: &mut Visit<'_>) -> Result<()> {
    let mut statement: Vec<&[u8]> = Vec::new();
    for (i, line) in lines(bytes).enumerate() {
        let code = uncommented(line).trim_ascii_end();
        if let Some(continued) = code.strip_suffix(b"\\") {
            statement.extend(words(continued));
            continue;
        }
        statement.extend(words(code));
        visit(i + 1, &statement)?;
        statement.clear();
    }
    Ok(())
}

/// A name with spaces.
fn file_name(words: &[&[u8]]) -> String {
    String::from_utf8_lossy(&words.join(&b' ')).replace('\\', "/")
}

fn vertex(words: &[&[u8]], line: usize) -> Result<DVec3> {
    let mut xyz = [0.0; 3];
    for (axis, x) in xyz.iter_mut().enumerate() {
        let word = words.get(axis).copied().unwrap_or_default();
        *x = number(word)
            .ok_or_else(|| corrupt("mesh", format!("{} in line {line}", quoted(word)), "v x y z: three numbers"))?;
    }
    Ok(DVec3::from_array(xyz))
}

/// The colour after the coordinates of a vertex. A single number there is a weight.
fn vertex_color(words: &[&[u8]]) -> Option<[f64; 3]> {
    let mut color = [0.0; 3];
    for (channel, word) in color.iter_mut().zip(words.get(3..6)?) {
        *channel = number(word)?;
    }
    Some(color)
}

/// The vertex index of `v`, `v/vt`, `v//vn` or `v/vt/vn`, counted from 0.
fn corner(word: &[u8], vertex_count: usize, line: usize) -> Result<u32> {
    let digits = word.split(|&b| b == b'/').next().unwrap_or_default();
    let Some(index) = parsed::<i64>(digits) else {
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
