//! Files of every format, damaged.

use crate::entropy::Entropy;

macro_rules! fixtures {
    ($($name:literal)+) => {
        &[$(include_bytes!(concat!("../fixtures/", $name))),+]
    };
}

const FILES: &[&[u8]] = fixtures![
    "mesh.glb" "scene.glb" "mesh-data-uri.gltf" "mesh-external.gltf" "mesh-textured.glb" "mesh-colors.glb"
    "mesh.obj" "mesh-textured.obj" "mesh-textured.mtl" "mesh-ascii.ply" "mesh-little.ply" "mesh-big.ply"
    "mesh-colors.ply" "mesh-ascii.stl" "mesh.stl" "mesh-solid-header.stl" "splat.ply" "mesh.splat"
    "depth-f4.npy" "depth-f8-fortran.npy" "depth-f2.npy" "depth-u2-big-1hw.npy" "depth-c16.npy" "depth-3hw.npy"
    "depth-16.png" "depth-rgb.png" "depth-opencv.exr" "depth-blender.exr" "depth-opencv.pfm" "depth-float32.tiff"
    "depth-uint16.tiff" "depth-moge.npz" "depth-da3.npz"
    "mask-1bit.png" "mask-grey-16.png" "mask-grey-alpha.png" "mask-palette.png" "mask-bool.npy"
    "photo-interlaced.png" "photo-exif.png" "photo-420.jpg" "photo-progressive.jpg" "photo-cmyk.jpg" "photo-exif-6.jpg"
];

/// Words that replace words in text, one of them empty, and integers that replace fields.
const WORDS: &str = "0 -1 255 65536 2147483648 4294967296 18446744073709551616 1e400 nan  5121 5126 VEC3 MAT4 sparse \
    matrix children double uchar list face <f8 >u2 True";
const FIELDS: [u32; 10] = [0, 1, 3, 255, 65_535, 65_536, 0x7fff_ffff, 0x8000_0000, 0xffff_fffe, 0xffff_ffff];

/// A file with up to six damages.
pub fn file(e: &mut Entropy<'_>) -> Vec<u8> {
    let mut bytes = e.pick(FILES).to_vec();
    for _ in 0..e.below(7) {
        if !bytes.is_empty() {
            damage(e, &mut bytes);
        }
    }
    if bytes.starts_with(PNG) && !e.once_in(8) {
        repair_png(&mut bytes);
    }
    bytes
}

/// A place in the file; half of them near its start, where the sizes are.
fn place(e: &mut Entropy<'_>, length: usize) -> usize {
    let most = e.pick(&[length, length.min(160)]);
    e.below(most)
}

fn damage(e: &mut Entropy<'_>, bytes: &mut Vec<u8>) {
    let at = place(e, bytes.len());
    match e.below(8) {
        0 => bytes[at] = e.below(256) as u8,
        1 => bytes[at] = e.pick(b"0123456789-.eE{}[]\", \n\t:"),
        2 => bytes.truncate(at),
        3 => {
            let field = e.pick(&FIELDS);
            let field = if e.once_in(2) { field.to_be_bytes() } else { field.to_le_bytes() };
            bytes.iter_mut().skip(at).zip(field).for_each(|(byte, new)| *byte = new);
        }
        4 => {
            let end = (at + e.size(1, 256)).min(bytes.len());
            let part = bytes[at..end].repeat(e.size(1, 8));
            bytes.splice(at..at, part);
        }
        5 => drop(bytes.drain(at..(at + e.size(1, 256)).min(bytes.len()))),
        6 => replace_word(e, bytes, at),
        _ => {
            let other = e.pick(FILES);
            let from = place(e, other.len());
            let end = (from + e.size(1, 512)).min(other.len());
            bytes.splice(at..at, other[from..end].iter().copied());
        }
    }
}

/// Replaces the next word. The file keeps its length where it can, so that the lengths of its parts stay right.
fn replace_word(e: &mut Entropy<'_>, bytes: &mut Vec<u8>, at: usize) {
    let is_word = |byte: &u8| byte.is_ascii_alphanumeric() || b"-+.<>".contains(byte);
    let Some(start) = bytes[at..].iter().position(is_word).map(|i| at + i) else { return };
    let length = bytes[start..].iter().take_while(|byte| is_word(byte)).count().min(40);
    let words: Vec<&str> = WORDS.split(' ').collect();
    let mut word = e.pick(&words).as_bytes().to_vec();
    word.resize(word.len().max(length), b' ');
    bytes.splice(start..start + length, word);
}

const PNG: &[u8] = b"\x89PNG\r\n\x1a\n";

/// Recomputes the checksums of the chunks of a PNG, so that damage reaches the code behind their check.
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
