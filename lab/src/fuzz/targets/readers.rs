//! The readers of mesh, photo, depth and mask files, on damaged files.

use sim3align_formats::depth::{DepthReadOptions, read_depth};
use sim3align_formats::mask::read_mask;
use sim3align_formats::mesh::{MeshFormat, MeshReadOptions, external_resources, read_colored_mesh};
use sim3align_formats::photo::{MAX_PHOTO_PIXELS, read_photo};
use sim3align_formats::splats::read_splats;
use sim3align_geometry::surface_colors::COLOR_SAMPLES;

use crate::fuzz::call::{Answer, Call, typed};
use crate::fuzz::choices::Choices;

macro_rules! files {
    ($($name:literal),+ $(,)?) => {
        [$(($name, include_bytes!(concat!("../../../../tests/fixtures/", $name)).as_slice())),+]
    };
}

/// Files of every format and variant.
const FILES: [(&str, &[u8]); 47] = files![
    "mesh.glb",
    "scene.glb",
    "mesh-data-uri.gltf",
    "mesh-external.gltf",
    "mesh.obj",
    "mesh-ascii.ply",
    "mesh-little.ply",
    "mesh-big.ply",
    "mesh-ascii.stl",
    "mesh.stl",
    "mesh-solid-header.stl",
    "depth-f4.npy",
    "depth-f8-fortran.npy",
    "depth-f4-big.npy",
    "depth-f2.npy",
    "depth-u2-hw1.npy",
    "depth-u2-big-1hw.npy",
    "depth-i4.npy",
    "depth-c16.npy",
    "depth-3hw.npy",
    "depth-16.png",
    "depth-16-pillow.png",
    "depth-rgb.png",
    "mask-1bit.png",
    "mask-grey.png",
    "mask-grey-16.png",
    "mask-cut-out.png",
    "mask-grey-alpha.png",
    "mask-palette.png",
    "mask-bool.npy",
    "mask-f4.npy",
    "mesh-textured.glb",
    "mesh-textured.obj",
    "mesh-textured.mtl",
    "mesh-colors.glb",
    "mesh-colors.ply",
    "photo-16.png",
    "photo-interlaced.png",
    "photo-palette.png",
    "photo-exif.png",
    "photo-420.jpg",
    "photo-progressive.jpg",
    "photo-grey.jpg",
    "photo-cmyk.jpg",
    "photo-exif-6.jpg",
    "splat.ply",
    "mesh.splat",
];

/// Numbers that replace numbers in text.
const NUMBERS: [&str; 24] = [
    "0",
    "1",
    "-1",
    "2",
    "3",
    "4",
    "255",
    "256",
    "65535",
    "65536",
    "2147483647",
    "2147483648",
    "4294967295",
    "4294967296",
    "9007199254740993",
    "18446744073709551616",
    "1e400",
    "-1e400",
    "1e-400",
    "nan",
    "inf",
    "0.5",
    "99999999999999999999999999999999999999",
    "",
];

/// Words that replace words in text.
const WORDS: [&str; 24] = [
    "5120",
    "5121",
    "5123",
    "5125",
    "5126",
    "SCALAR",
    "VEC2",
    "VEC3",
    "MAT4",
    "sparse",
    "matrix",
    "translation",
    "children",
    "float",
    "double",
    "uchar",
    "list",
    "face",
    "vertex",
    "<f8",
    ">u2",
    "|b1",
    "True",
    "f 1 2 3 4 5 -1",
];

/// An integer that a binary field may contain.
const WORDS_32: [u32; 12] = [0, 1, 2, 3, 4, 255, 65_535, 65_536, 0x7fff_ffff, 0x8000_0000, 0xffff_fffe, 0xffff_ffff];

/// Any damage to any file, read as anything.
pub fn call(c: &mut Choices) -> Call {
    let (name, bytes) = FILES[c.below(FILES.len())];
    let mut bytes = bytes.to_vec();
    for _ in 0..c.below(7) {
        damage(c, &mut bytes);
        if bytes.is_empty() {
            break;
        }
    }
    if bytes.starts_with(PNG) && !c.once_in(8) {
        repair_png(&mut bytes);
    }
    let format =
        c.pick(&[None, None, None, None, None, None, None, None, Some("glb"), Some("obj"), Some("ply"), Some("stl")]);
    let scale = c.pick(&[None, None, Some(0.001), Some(0.0), Some(f64::NAN), Some(1e300), Some(1e-300)]);
    Call {
        description: format!("{name}, damaged: {} bytes", bytes.len()),
        // Ceilings apply: memory must stay in proportion to the file.
        is_bounded: true,
        run: Box::new(move || read(&bytes, format, scale)),
    }
}

fn read(bytes: &[u8], format: Option<&str>, scale: Option<f64>) -> Result<Answer, String> {
    let format = format.and_then(|name| MeshFormat::from_name(name).ok());
    let resource = |_: &str| Some(bytes.to_vec());
    let options = MeshReadOptions { format, resources: Some(&resource) };
    let mesh = match read_colored_mesh(bytes, &options) {
        Ok(read) => {
            let count = read.mesh.positions().len();
            if !read.mesh.triangles().as_flattened().iter().all(|&i| (i as usize) < count) {
                return Err("result: an index out of range".into());
            }
            if read.colors.is_some_and(|colors| colors.colors().len() != COLOR_SAMPLES) {
                return Err("result: too few colours".into());
            }
            if let Some(problem) = read.problem {
                typed(&problem, false)?;
            }
            Answer::Result
        }
        Err(error) => typed(&error, false)?,
    };
    match read_splats(bytes, true) {
        Ok(read) if !read.mesh.positions().iter().all(|p| p.is_finite()) => {
            return Err("result: a surface of Gaussians that is not finite".into());
        }
        Ok(_) => {}
        Err(error) => drop(typed(&error, false)?),
    }
    if let Err(error) = external_resources(bytes) {
        typed(&error, false)?;
    }
    match read_depth(bytes, &DepthReadOptions { depth_scale: scale, integer_depth_scale: None }) {
        Ok(depth) if !depth.data().iter().all(|z| z.is_finite() && *z >= 0.0) => {
            return Err("result: a depth that is no reading".into());
        }
        Ok(_) => {}
        Err(error) => drop(typed(&error, false)?),
    }
    match read_photo(bytes) {
        Ok(photo) if photo.data().len() > MAX_PHOTO_PIXELS => return Err("result: a photo that is too large".into()),
        Ok(_) => {}
        Err(error) => drop(typed(&error, false)?),
    }
    match read_mask(bytes) {
        Ok(mask) if mask.width() * mask.height() != mask.data().len() => {
            return Err("result: a mask of other size".into());
        }
        Ok(_) => {}
        Err(error) => drop(typed(&error, false)?),
    }
    Ok(mesh)
}

/// A place in the file; half of them near its start, where the sizes are.
fn place(c: &mut Choices, length: usize) -> usize {
    if c.once_in(2) { c.below(length) } else { c.below(length.min(160)) }
}

fn damage(c: &mut Choices, bytes: &mut Vec<u8>) {
    let at = place(c, bytes.len());
    match c.below(10) {
        0 => bytes[at] = c.below(256) as u8,
        1 => bytes[at] ^= 1 << c.below(8),
        2 => bytes[at] = c.pick(b"0123456789-.eE{}[]\", \n\t:"),
        3 => bytes.truncate(at),
        4 => {
            let value = c.pick(&WORDS_32);
            let value = if c.once_in(2) { value.to_be_bytes() } else { value.to_le_bytes() };
            bytes.iter_mut().skip(at).zip(value).for_each(|(byte, new)| *byte = new);
        }
        5 => {
            let end = (at + c.size(1, 256)).min(bytes.len());
            let copies = c.size(1, 8);
            let part = bytes[at..end].repeat(copies);
            drop(bytes.splice(at..at, part));
        }
        6 => drop(bytes.drain(at..(at + c.size(1, 256)).min(bytes.len()))),
        7 => {
            let number = c.pick(&NUMBERS);
            replace(bytes, at, |byte| byte.is_ascii_digit() || b"-+.e".contains(&byte), number);
        }
        8 => {
            let word = c.pick(&WORDS);
            replace(bytes, at, |byte| byte.is_ascii_alphanumeric(), word);
        }
        _ => {
            let (_, other) = FILES[c.below(FILES.len())];
            let from = place(c, other.len());
            let end = (from + c.size(1, 512)).min(other.len());
            drop(bytes.splice(at..at, other[from..end].iter().copied()));
        }
    }
}

/// Replaces the run of bytes at or after `at` that `belongs` accepts. The file keeps its length where it can, so that
/// the lengths of its parts stay right.
fn replace(bytes: &mut Vec<u8>, at: usize, belongs: impl Fn(u8) -> bool, new: &str) {
    let Some(start) = bytes.iter().skip(at).position(|&byte| belongs(byte)).map(|i| at + i) else { return };
    let length = bytes[start..].iter().take_while(|&&byte| belongs(byte)).count().min(40);
    let mut new = new.as_bytes().to_vec();
    if new.len() < length {
        new.resize(length, b' ');
    }
    // Also overwrites the spaces that follow.
    let spaces = bytes[start + length..].iter().take_while(|byte| **byte == b' ').count();
    let end = (start + new.len().max(length)).min(start + length + spaces);
    drop(bytes.splice(start..end, new));
}

const PNG: &[u8] = b"\x89PNG\r\n\x1a\n";

/// Recomputes the checksums of the chunks of a PNG, so that damage reaches the code after their check.
fn repair_png(bytes: &mut [u8]) {
    let mut at = PNG.len();
    while let Some(head) = bytes.get(at..at + 4) {
        let length = head.iter().fold(0, |n, &byte| n << 8 | usize::from(byte));
        let Some(end) = at.checked_add(8 + length).filter(|end| end + 4 <= bytes.len()) else { return };
        let sum = crc32fast::hash(&bytes[at + 4..end]).to_be_bytes();
        bytes[end..end + 4].copy_from_slice(&sum);
        at = end + 4;
    }
}
