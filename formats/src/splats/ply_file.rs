//! PLY files of Gaussians.

use glam::Vec3;

use super::gaussian::{Gaussian, check_count};
use super::packed::{Chunks, RANGES, WORDS};
use crate::guard::unsupported;
use crate::ply::{Body, read_records};
use crate::ply_header::{Element, Header};
use sim3align_runtime::error::Result;

/// The properties of a vertex that is a Gaussian: centre, colour as the constant term of spherical harmonics, opacity as
/// its logit, logarithms of the standard deviations, and rotation (w, x, y, z). Others, such as further harmonics, are
/// ignored.
const PROPERTIES: [&[u8]; 14] = [
    b"x", b"y", b"z", b"f_dc_0", b"f_dc_1", b"f_dc_2", b"opacity", b"scale_0", b"scale_1", b"scale_2", b"rot_0",
    b"rot_1", b"rot_2", b"rot_3",
];

/// The constant spherical harmonic, 1 / (2√π).
const HARMONIC: f64 = 0.282_094_791_773_878_14;

/// Of a flat Gaussian, which has two standard deviations only (2D Gaussian Splatting): the logarithm of the third one.
const FLAT: f64 = -30.0;

/// Reads the Gaussians of a PLY file: those of 3D and of 2D Gaussian Splatting, and SuperSplat's compressed ones.
pub(super) fn read(bytes: &[u8]) -> Result<Vec<Gaussian>> {
    let (header, body) = Header::read(bytes)?;
    let mut body = Body::new("mesh", header.encoding, body);
    let mut gaussians = Vec::new();
    let mut chunks = Chunks::default();
    for element in header.elements.iter().filter(|element| !element.properties.is_empty()) {
        body.check_count(element)?;
        let has = |name: &[u8]| element.properties.iter().any(|property| property.name == name);
        match element.name.as_slice() {
            b"chunk" => {
                // Of colours without ranges.
                let unit: [f64; RANGES.len()] = core::array::from_fn(|i| if i >= 15 { 1.0 } else { 0.0 });
                read_numbers(element, &mut body, &RANGES, unit, &mut |ranges| {
                    chunks.push(*ranges);
                    Ok(())
                })?;
            }
            b"vertex" => {
                check_count(element.count)?;
                if WORDS.iter().all(|name| has(name)) {
                    read_numbers(element, &mut body, &WORDS, [0.0; WORDS.len()], &mut |words| {
                        gaussians.push(chunks.gaussian(gaussians.len(), words.map(|word| word as u32))?);
                        Ok(())
                    })?;
                    continue;
                }
                let missing = |name: &&&[u8]| !has(name) && **name != b"scale_2";
                if let Some(name) = PROPERTIES.iter().find(missing) {
                    let found = format!("Gaussians without {}", name.escape_ascii());
                    let remedy = "Export the splat in the format of 3D Gaussian Splatting.";
                    return Err(unsupported("mesh", found, "the properties of 3D Gaussian Splatting", remedy));
                }
                let default = core::array::from_fn(|i| if PROPERTIES[i] == b"scale_2" { FLAT } else { 0.0 });
                read_numbers(element, &mut body, &PROPERTIES, default, &mut |numbers| {
                    gaussians.push(gaussian(gaussians.len(), numbers)?);
                    Ok(())
                })?;
            }
            _ => read_records(element, &mut body, |_, _| Ok(()))?,
        }
    }
    Ok(gaussians)
}

/// Calls `visit` with the properties of these names, record by record. A property that is missing has its default.
fn read_numbers<const N: usize>(
    element: &Element,
    body: &mut Body<'_>,
    names: &[&[u8]; N],
    default: [f64; N],
    visit: &mut dyn FnMut(&[f64; N]) -> Result<()>,
) -> Result<()> {
    let slots: Vec<Option<usize>> =
        element.properties.iter().map(|property| names.iter().position(|name| property.name == *name)).collect();
    let last = slots.len() - 1;
    let mut numbers = default;
    read_records(element, body, |property, values| {
        if let Some(number) = slots.get(property).copied().flatten().and_then(|slot| numbers.get_mut(slot)) {
            *number = values.first().copied().unwrap_or(f64::NAN);
        }
        if property == last { visit(&numbers) } else { Ok(()) }
    })
}

fn gaussian(index: usize, numbers: &[f64; PROPERTIES.len()]) -> Result<Gaussian> {
    let [x, y, z, red, green, blue, logit, scales @ .., qw, qx, qy, qz] = numbers.map(|number| number as f32);
    let code = |harmonic: f32| ((0.5 + HARMONIC * f64::from(harmonic)) * 255.0).round() as u8;
    let color = [red, green, blue].map(code);
    let opacity = 1.0 / (1.0 + libm::expf(-logit));
    let scales = Vec3::from_array(scales.map(libm::expf));
    Gaussian::new(index, Vec3::new(x, y, z), scales, [qw, qx, qy, qz], opacity, color)
}
