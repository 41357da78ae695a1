//! Encodes depth maps, masks, images, clouds and meshes as files.

use std::fmt::Write as _;
use std::io;

use image::codecs::png::{CompressionType, FilterType, PngEncoder};
use image::{ExtendedColorType, ImageEncoder};
use jpeg_encoder::{ColorType, Encoder, SamplingFactor};

use crate::prelude::*;
use sim3align_geometry::image::check_size;

/// A depth map as NumPy array, float32 H×W, metres.
pub fn depth_npy(depth: &DepthMap) -> Vec<u8> {
    let mut header =
        format!("{{'descr': '<f4', 'fortran_order': False, 'shape': ({}, {}), }}", depth.height(), depth.width());
    // Magic, version and length take 10 bytes; the data begin at a multiple of 64, and the header ends with a line
    // feed.
    let header_bytes = (10 + header.len() + 1).next_multiple_of(64) - 10;
    header.extend(core::iter::repeat_n(' ', header_bytes - 1 - header.len()));
    header.push('\n');
    let mut bytes = b"\x93NUMPY\x01\x00".to_vec();
    bytes.extend((header_bytes as u16).to_le_bytes());
    bytes.extend(header.as_bytes());
    bytes.extend(depth.data().iter().flat_map(|z| z.to_le_bytes()));
    bytes
}

/// A depth map as 16-bit grey PNG, rounded to `depth_scale` metres per unit.
///
/// # Errors
/// [`ErrorCode::InvalidOption`] for a scale that is not above 0, or too fine for the farthest depth.
pub fn depth_png(depth: &DepthMap, depth_scale: f64) -> Result<Vec<u8>> {
    let farthest = depth.data().iter().copied().fold(0.0, f32::max);
    if !(depth_scale > 0.0 && (f64::from(farthest) / depth_scale).round() <= 65535.0) {
        return Err(Error::new(
            ErrorCode::InvalidOption,
            "options.depthScale",
            format!("{depth_scale} with depths up to {farthest} m"),
            "a scale above 0 with which the farthest depth is at most 65535 units",
            "Pass metres per unit: 0.001 reaches 65 m.",
        ));
    }
    // The encoder takes 16-bit samples in native byte order.
    let units = depth.data().iter().map(|&z| (f64::from(z) / depth_scale).round() as u16);
    let bytes: Vec<u8> = units.flat_map(u16::to_ne_bytes).collect();
    png(&bytes, depth.width(), depth.height(), ExtendedColorType::L16, CompressionType::Best)
}

/// A mask as 8-bit grey PNG: 255 is the object.
///
/// # Errors
/// [`ErrorCode::Internal`] if the encoder fails.
pub fn mask_png(mask: &Mask) -> Result<Vec<u8>> {
    let bytes: Vec<u8> = mask.data().iter().map(|&m| if m == 0 { 0 } else { 255 }).collect();
    png(&bytes, mask.width(), mask.height(), ExtendedColorType::L8, CompressionType::Best)
}

/// An image as 8-bit RGB PNG; pixels are row-major.
///
/// # Errors
/// [`ErrorCode::WrongLength`] and [`ErrorCode::EmptyImage`] for a size that is not the picture's.
pub fn rgb_png(pixels: &[[u8; 3]], width: usize, height: usize) -> Result<Vec<u8>> {
    check_size("image", width, height, pixels.len())?;
    // Noise hardly compresses any better with more effort.
    png(pixels.as_flattened(), width, height, ExtendedColorType::Rgb8, CompressionType::Default)
}

/// Settings of a JPEG.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct JpegSettings {
    /// 1 to 100.
    pub quality: u8,
    /// Whether chroma has half the resolution in both directions (4:2:0).
    pub is_chroma_halved: bool,
    /// Whether the file is progressive.
    pub is_progressive: bool,
}

/// An image as JPEG; pixels are row-major.
///
/// # Errors
/// As [`rgb_png`], and [`ErrorCode::FileTooLarge`] for sides beyond 65 535 pixels.
pub fn rgb_jpeg(pixels: &[[u8; 3]], width: usize, height: usize, settings: JpegSettings) -> Result<Vec<u8>> {
    check_size("image", width, height, pixels.len())?;
    let (Ok(columns), Ok(rows)) = (u16::try_from(width), u16::try_from(height)) else {
        let found = format!("{width} × {height} pixels");
        let remedy = "Write a PNG.";
        return Err(Error::new(ErrorCode::FileTooLarge, "image", found, "at most 65535 × 65535", remedy));
    };
    let mut file = Vec::new();
    let mut encoder = Encoder::new(&mut file, settings.quality);
    encoder.set_sampling_factor(if settings.is_chroma_halved { SamplingFactor::F_2_2 } else { SamplingFactor::F_1_1 });
    encoder.set_progressive(settings.is_progressive);
    let written = encoder.encode(pixels.as_flattened(), columns, rows, ColorType::Rgb);
    written.map_err(|error| not_encoded("a JPEG", &error))?;
    Ok(file)
}

fn png(
    bytes: &[u8],
    width: usize,
    height: usize,
    colour: ExtendedColorType,
    compression: CompressionType,
) -> Result<Vec<u8>> {
    let mut file = io::Cursor::new(Vec::new());
    // The filter halves the size of 16-bit depth relative to the default.
    let encoder = PngEncoder::new_with_quality(&mut file, compression, FilterType::Sub);
    let written = encoder.write_image(bytes, width as u32, height as u32, colour);
    written.map_err(|error| not_encoded("a PNG", &error))?;
    Ok(file.into_inner())
}

fn not_encoded(kind: &'static str, error: &dyn core::error::Error) -> Error {
    Error::new(ErrorCode::Internal, "image", format!("an encoder that says: {error}"), kind, "Please report it.")
}

/// Points as binary PLY: float x, y, z.
pub fn ply_points(points: &[Vec3]) -> Vec<u8> {
    ply(points, "")
}

/// A mesh as binary PLY: float x, y, z, and triangles.
pub fn ply_mesh(mesh: &Mesh) -> Vec<u8> {
    let triangles = mesh.triangles();
    let faces = format!("element face {}\nproperty list uchar int vertex_indices\n", triangles.len());
    let mut bytes = ply(mesh.positions(), &faces);
    for triangle in triangles {
        bytes.push(3);
        bytes.extend(triangle.iter().flat_map(|i| i.to_le_bytes()));
    }
    bytes
}

/// The header of a PLY file, with other elements after the vertices, and the vertices.
fn ply(vertices: &[Vec3], elements: &str) -> Vec<u8> {
    let (count, xyz) = (vertices.len(), "property float x\nproperty float y\nproperty float z\n");
    let header = format!("ply\nformat binary_little_endian 1.0\nelement vertex {count}\n{xyz}{elements}end_header\n");
    let mut bytes = header.into_bytes();
    bytes.extend(vertices.iter().flat_map(|p| p.to_array()).flat_map(f32::to_le_bytes));
    bytes
}

/// A mesh as GLB: one node, one mesh, float positions and 32-bit indices.
pub fn glb(mesh: &Mesh) -> Vec<u8> {
    glb_colored(mesh, &[])
}

/// A mesh as GLB with the linear colours of its vertices; without any, like [`glb`].
pub fn glb_colored(mesh: &Mesh, colors: &[[u8; 3]]) -> Vec<u8> {
    let positions = mesh.positions();
    let low = positions.iter().copied().fold(Vec3::INFINITY, Vec3::min);
    let high = positions.iter().copied().fold(Vec3::NEG_INFINITY, Vec3::max);
    let corners = mesh.triangles().as_flattened();
    let (position_bytes, index_bytes) = (12 * positions.len(), 4 * corners.len());
    let color_bytes = 4 * colors.len();
    let first_color = position_bytes + index_bytes;
    let (attribute, accessor, view) = if colors.is_empty() {
        Default::default()
    } else {
        let count = colors.len();
        (
            r#","COLOR_0":2"#.to_owned(),
            format!(r#",{{"bufferView":2,"componentType":5121,"normalized":true,"count":{count},"type":"VEC4"}}"#),
            format!(r#",{{"buffer":0,"byteOffset":{first_color},"byteLength":{color_bytes},"target":34962}}"#),
        )
    };
    let mut json = format!(
        concat!(
            r#"{{"asset":{{"version":"2.0","generator":"sim3align"}},"scene":0,"scenes":[{{"nodes":[0]}}],"#,
            r#""nodes":[{{"mesh":0}}],"meshes":[{{"primitives":[{{"attributes":{{"POSITION":0{}}},"indices":1}}]}}],"#,
            r#""accessors":[{{"bufferView":0,"componentType":5126,"count":{},"type":"VEC3","min":{:?},"max":{:?}}},"#,
            r#"{{"bufferView":1,"componentType":5125,"count":{},"type":"SCALAR"}}{}],"#,
            r#""bufferViews":[{{"buffer":0,"byteLength":{},"target":34962}},"#,
            r#"{{"buffer":0,"byteOffset":{},"byteLength":{},"target":34963}}{}],"buffers":[{{"byteLength":{}}}]}}"#,
        ),
        attribute,
        positions.len(),
        low.to_array(),
        high.to_array(),
        corners.len(),
        accessor,
        position_bytes,
        position_bytes,
        index_bytes,
        view,
        first_color + color_bytes,
    );
    json.extend(core::iter::repeat_n(' ', json.len().next_multiple_of(4) - json.len()));
    let binary_bytes = first_color + color_bytes;
    let mut bytes = Vec::with_capacity(28 + json.len() + binary_bytes);
    bytes.extend(b"glTF");
    for word in [2, 28 + json.len() + binary_bytes, json.len()] {
        bytes.extend((word as u32).to_le_bytes());
    }
    bytes.extend(b"JSON");
    bytes.extend(json.as_bytes());
    bytes.extend((binary_bytes as u32).to_le_bytes());
    bytes.extend(b"BIN\0");
    bytes.extend(positions.iter().flat_map(|p| p.to_array()).flat_map(f32::to_le_bytes));
    bytes.extend(corners.iter().flat_map(|i| i.to_le_bytes()));
    bytes.extend(colors.iter().flat_map(|[red, green, blue]| [*red, *green, *blue, 255]));
    bytes
}

/// A mesh as OBJ, which keeps shared vertices although each triangle has its own texture coordinates: those of the corners
/// from the upper left corner of the image. `library` is the name of the MTL file, whose material is called `print`.
pub fn textured_obj(mesh: &Mesh, coordinates: &[[[f64; 2]; 3]], library: &str) -> Vec<u8> {
    let mut text = format!("mtllib {library}\n");
    for p in mesh.positions() {
        // The shortest digits that read back as the same f32.
        let _ = writeln!(text, "v {} {} {}", p.x, p.y, p.z);
    }
    for [u, v] in coordinates.as_flattened() {
        let _ = writeln!(text, "vt {u} {}", 1.0 - v);
    }
    text.push_str("usemtl print\n");
    for (i, [a, b, c]) in mesh.triangles().iter().map(|t| t.map(|corner| corner + 1)).enumerate() {
        let first = 3 * i + 1;
        let _ = writeln!(text, "f {a}/{first} {b}/{} {c}/{}", first + 1, first + 2);
    }
    text.into_bytes()
}
