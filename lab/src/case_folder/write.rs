//! Writes cases as folders, and encodes images, clouds and meshes.

use jpeg_encoder::{Encoder, SamplingFactor};
use png::{BitDepth, ColorType, Filter};
use serde::Serialize;

use super::files::{
    CAMERA, CAMERA_POSE, CameraFile, CameraPoseFile, INITIAL, META, MetaFile, OBJECTS, PoseFile, TRUTH, TruthFile,
};
use crate::case::{Case, CaseFrame, CaseObject};
use crate::files::write;
use crate::prelude::*;

/// The finest unit of depth, metres: finer than noise, and compact as 16-bit images.
const DEPTH_SCALE: f64 = 0.0001;

impl Case {
    /// Writes a case folder, a scene folder or a folder with frames. Meshes are written without colours.
    ///
    /// # Errors
    /// [`ErrorCode::InvalidArgument`] if a file cannot be written.
    pub fn write(&self, folder: &Path) -> Result<()> {
        let is_scene = self.objects.len() > 1;
        for (k, object) in self.objects.iter().enumerate() {
            let own = if is_scene { folder.join(OBJECTS).join(&object.name) } else { folder.to_owned() };
            write(&own.join("mesh.ply"), &ply(object.mesh.positions(), object.mesh.triangles()))?;
            if let Some(initial) = &object.initial {
                write_json(&own.join(INITIAL), &PoseFile::from(initial))?;
            }
            for frame in &self.frames {
                let own = if self.frames.len() > 1 { folder.join(&frame.name) } else { own.clone() };
                write_of_object(&own, object, frame, k)?;
            }
        }
        for frame in &self.frames {
            let own = if self.frames.len() > 1 { folder.join(&frame.name) } else { folder.to_owned() };
            frame.write(&own, self.frames.len() > 1)?;
        }
        let class = self.objects.first().map(|object| object.class.clone());
        let meta = MetaFile { tier: Some(self.tier.clone()), class, tags: self.tags.clone() };
        write_json(&folder.join(META), &meta)
    }

    /// Each object as a case of its own.
    pub fn split(&self) -> Vec<Self> {
        let alone = |(k, object): (usize, &CaseObject)| {
            let frame = self.frames[0].clone();
            let (masks, truths) = (vec![frame.masks[k].clone()], vec![frame.truths[k]]);
            Self {
                name: self.name_of(k),
                objects: vec![object.clone()],
                frames: vec![CaseFrame { masks, truths, ..frame }],
                ..self.clone()
            }
        };
        self.objects.iter().enumerate().map(alone).collect()
    }
}

/// The mask and the true pose of an object in an image.
fn write_of_object(folder: &Path, object: &CaseObject, frame: &CaseFrame, k: usize) -> Result<()> {
    if let Some(mask) = &frame.masks[k] {
        write(&folder.join("mask.png"), &mask_png(mask)?)?;
    }
    match &frame.truths[k] {
        Some(truth) => write_json(&folder.join(TRUTH), &TruthFile::new(truth, &object.symmetry)),
        None => Ok(()),
    }
}

impl CaseFrame {
    fn write(&self, folder: &Path, has_pose: bool) -> Result<()> {
        let (width, height) = (self.depth.width(), self.depth.height());
        let farthest = self.depth.data().iter().copied().fold(0.0, f32::max);
        let depth_scale = DEPTH_SCALE.max(f64::from(farthest) / 65535.0);
        write(&folder.join("depth.png"), &depth_png(&self.depth, depth_scale)?)?;
        let Pinhole { fx, fy, cx, cy } = self.camera;
        let (width, height) = (Some(width), Some(height));
        let camera = CameraFile { fx, fy, cx, cy, width, height, depth_scale: Some(depth_scale) };
        write_json(&folder.join(CAMERA), &camera)?;
        if let Some(photo) = &self.photo {
            write(&folder.join("rgb.png"), &rgb_png(photo)?)?;
        }
        if let Some(pose) = self.world_from_camera.as_ref().filter(|_| has_pose) {
            let (r, t) = (&pose.rotation, &pose.translation);
            let row = |i: usize| [r[(i, 0)], r[(i, 1)], r[(i, 2)], t[i]];
            let camera_to_world = [row(0), row(1), row(2), [0.0, 0.0, 0.0, 1.0]];
            write_json(&folder.join(CAMERA_POSE), &CameraPoseFile { camera_to_world })?;
        }
        Ok(())
    }
}

fn write_json(path: &Path, value: &impl Serialize) -> Result<()> {
    let text = serde_json::to_string_pretty(value).map_err(|error| not_encoded("JSON", &error))?;
    write(path, format!("{text}\n").as_bytes())
}

/// A depth map as 16-bit grey PNG, rounded to `depth_scale` metres per unit.
fn depth_png(depth: &DepthMap, depth_scale: f64) -> Result<Vec<u8>> {
    let units = depth.data().iter().map(|&z| (f64::from(z) / depth_scale).round() as u16);
    let bytes: Vec<u8> = units.flat_map(u16::to_be_bytes).collect();
    png(&bytes, [depth.width(), depth.height()], ColorType::Grayscale, BitDepth::Sixteen)
}

/// A mask as 8-bit grey PNG: 255 is the object.
fn mask_png(mask: &Mask) -> Result<Vec<u8>> {
    let bytes: Vec<u8> = mask.data().iter().map(|&m| if m == 0 { 0 } else { 255 }).collect();
    png(&bytes, [mask.width(), mask.height()], ColorType::Grayscale, BitDepth::Eight)
}

fn rgb_png(photo: &Photo) -> Result<Vec<u8>> {
    png(photo.data().as_flattened(), [photo.width(), photo.height()], ColorType::Rgb, BitDepth::Eight)
}

fn png(bytes: &[u8], [width, height]: [usize; 2], color: ColorType, depth: BitDepth) -> Result<Vec<u8>> {
    let mut file = Vec::new();
    let mut encoder = png::Encoder::new(&mut file, width as u32, height as u32);
    encoder.set_color(color);
    encoder.set_depth(depth);
    // It halves the size of 16-bit depth relative to the default.
    encoder.set_filter(Filter::Sub);
    let written = encoder.write_header().and_then(|mut writer| writer.write_image_data(bytes));
    written.map_err(|error| not_encoded("a PNG", &error))?;
    Ok(file)
}

/// An image as JPEG of a quality from 1 to 100; `is_halved` for chroma of half the resolution.
pub(crate) fn rgb_jpeg(
    pixels: &[[u8; 3]],
    width: usize,
    height: usize,
    quality: u8,
    is_halved: bool,
) -> Result<Vec<u8>> {
    let mut file = Vec::new();
    let mut encoder = Encoder::new(&mut file, quality);
    encoder.set_sampling_factor(if is_halved { SamplingFactor::F_2_2 } else { SamplingFactor::F_1_1 });
    let written = encoder.encode(pixels.as_flattened(), width as u16, height as u16, jpeg_encoder::ColorType::Rgb);
    written.map_err(|error| not_encoded("a JPEG", &error))?;
    Ok(file)
}

fn not_encoded(kind: &'static str, error: &dyn core::error::Error) -> Error {
    Error::new(ErrorCode::Internal, "file", format!("an encoder error: {error}"), kind, "Please report it.")
}

/// Points, and triangles if there are any, as binary PLY.
pub fn ply(points: &[Vec3], triangles: &[[u32; 3]]) -> Vec<u8> {
    let (vertices, faces) = (points.len(), triangles.len());
    let mut header = format!("ply\nformat binary_little_endian 1.0\nelement vertex {vertices}\n");
    header += "property float x\nproperty float y\nproperty float z\n";
    if faces > 0 {
        header += &format!("element face {faces}\nproperty list uchar int vertex_indices\n");
    }
    header += "end_header\n";
    let mut bytes = header.into_bytes();
    bytes.extend(points.iter().flat_map(|p| p.to_array()).flat_map(f32::to_le_bytes));
    for triangle in triangles {
        bytes.push(3);
        bytes.extend(triangle.iter().flat_map(|i| i.to_le_bytes()));
    }
    bytes
}
