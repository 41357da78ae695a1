//! PLY files of Gaussians, as the authors of 3D Gaussian Splatting write them.

use glam::Vec3;

use super::gaussian::{Gaussian, check_count};
use crate::guard::corrupt;
use crate::ply::{Body, read_records};
use crate::ply_header::Header;
use sim3align_geometry::error::Result;

/// The properties of a vertex that is a Gaussian: centre, colour as the constant term of spherical harmonics, opacity as
/// its logit, logarithms of the standard deviations, and rotation (w, x, y, z). Others, such as further harmonics, are
/// ignored.
const PROPERTIES: [&[u8]; 14] = [
    b"x", b"y", b"z", b"f_dc_0", b"f_dc_1", b"f_dc_2", b"opacity", b"scale_0", b"scale_1", b"scale_2", b"rot_0",
    b"rot_1", b"rot_2", b"rot_3",
];

/// The constant spherical harmonic, 1 / (2√π).
const HARMONIC: f64 = 0.282_094_791_773_878_14;

/// Reads the Gaussians of a PLY file.
pub(super) fn read(bytes: &[u8]) -> Result<Vec<Gaussian>> {
    let (header, body) = Header::read(bytes)?;
    let mut body = Body::new("mesh", header.encoding, body);
    let mut gaussians = Vec::new();
    for element in header.elements.iter().filter(|element| !element.properties.is_empty()) {
        body.check_count(element)?;
        if element.name != b"vertex" {
            read_records(element, &mut body, |_, _| Ok(()))?;
            continue;
        }
        check_count(element.count)?;
        if let Some(name) = PROPERTIES.iter().find(|name| element.properties.iter().all(|p| p.name != **name)) {
            let found = format!("Gaussians without {}", name.escape_ascii());
            return Err(corrupt("mesh", found, "the properties of 3D Gaussian Splatting"));
        }
        let slots: Vec<Option<usize>> =
            element.properties.iter().map(|p| PROPERTIES.iter().position(|name| p.name == *name)).collect();
        let last = slots.len() - 1;
        let mut numbers = [0.0; PROPERTIES.len()];
        read_records(element, &mut body, |property, values| {
            if let Some(number) = slots.get(property).copied().flatten().and_then(|slot| numbers.get_mut(slot)) {
                *number = values.first().copied().unwrap_or(f64::NAN);
            }
            if property == last {
                gaussians.push(gaussian(gaussians.len(), &numbers)?);
            }
            Ok(())
        })?;
    }
    Ok(gaussians)
}

fn gaussian(index: usize, numbers: &[f64; PROPERTIES.len()]) -> Result<Gaussian> {
    let [x, y, z, red, green, blue, logit, scales @ .., qw, qx, qy, qz] = numbers.map(|number| number as f32);
    let code = |harmonic: f32| ((0.5 + HARMONIC * f64::from(harmonic)) * 255.0).round() as u8;
    let color = [red, green, blue].map(code);
    let opacity = 1.0 / (1.0 + libm::expf(-logit));
    let scales = Vec3::from_array(scales.map(libm::expf));
    Gaussian::new(index, Vec3::new(x, y, z), scales, [qw, qx, qy, qz], opacity, color)
}
