//! Files cut at every length and files with random bytes changed: an answer or a typed error, never a panic.

use sim3align_formats::depth::{DepthReadOptions, read_depth};
use sim3align_formats::mask::read_mask;
use sim3align_formats::photo::read_photo;
use sim3align_formats::splats::read_splats;
use wasm_bindgen_test::console_log;

use crate::fixtures::{MESHES, fixture, read};
use crate::image_files::DEPTH_FILES;
use crate::prelude::*;

/// Reads bytes as something; the error's code where that fails.
type Reader = fn(&[u8]) -> Result<(), ErrorCode>;

/// A mesh that was read is sound, and an error has words.
fn checked(read: sim3align::error::Result<Mesh>) -> Result<(), ErrorCode> {
    let mesh = read.map_err(|error| {
        assert!(!error.found.is_empty() && !error.remedy.is_empty(), "{error}");
        error.code
    })?;
    let corners = mesh.triangles().as_flattened();
    assert!(!corners.is_empty() && corners.iter().all(|i| (*i as usize) < mesh.positions().len()));
    assert!(mesh.positions().iter().all(|p| p.is_finite()));
    Ok(())
}

fn mesh(bytes: &[u8]) -> Result<(), ErrorCode> {
    checked(read(bytes))
}

fn splat(bytes: &[u8]) -> Result<(), ErrorCode> {
    checked(read_splats(bytes, true).map(|read| read.mesh))
}

fn depth(bytes: &[u8]) -> Result<(), ErrorCode> {
    read_depth(bytes, &DepthReadOptions::default()).map(drop).map_err(|error| error.code)
}

fn mask(bytes: &[u8]) -> Result<(), ErrorCode> {
    read_mask(bytes).map(drop).map_err(|error| error.code)
}

fn photo(bytes: &[u8]) -> Result<(), ErrorCode> {
    read_photo(bytes).map(drop).map_err(|error| error.code)
}

/// Every kind of file but the text formats OBJ, PLY and STL: whatever is cut off is missed.
const MUST_BE_WHOLE: [(&str, &[u8], Reader); 13] = [
    ("GLB scene", fixture!("scene.glb"), mesh),
    ("glTF", fixture!("mesh-data-uri.gltf"), mesh),
    ("PLY little-endian", fixture!("mesh-little.ply"), mesh),
    ("PLY big-endian", fixture!("mesh-big.ply"), mesh),
    ("STL", fixture!("mesh.stl"), mesh),
    ("splat", fixture!("splat.ply"), splat),
    ("depth f4", fixture!("depth-f4.npy"), depth),
    ("depth >u2", fixture!("depth-u2-big-1hw.npy"), depth),
    ("depth PNG", fixture!("depth-16.png"), depth),
    ("mask 1 bit", fixture!("mask-1bit.png"), mask),
    ("JPEG", fixture!("photo.jpg"), photo),
    ("progressive JPEG", fixture!("photo-progressive.jpg"), photo),
    ("interlaced PNG", fixture!("photo-interlaced.png"), photo),
];

#[wasm_bindgen_test]
fn a_file_cut_short_at_any_length_is_refused() {
    let depth_files = DEPTH_FILES.map(|(name, bytes)| (name, bytes, depth as Reader));
    for (name, bytes, read) in MUST_BE_WHOLE.into_iter().chain(depth_files) {
        assert_eq!(read(bytes), Ok(()), "{name}");
        for length in 0..bytes.len() {
            let result = read(&bytes[..length]);
            let expected = [ErrorCode::CorruptFile, ErrorCode::UnsupportedFormat, ErrorCode::FileTooLarge];
            assert!(result.is_err_and(|code| expected.contains(&code)), "{name} cut to {length}: {result:?}");
        }
    }
}

#[wasm_bindgen_test]
fn sizes_in_headers_are_checked_before_memory_is_taken() {
    let jpeg = fixture!("photo.jpg");
    let frame = jpeg.windows(2).position(|pair| pair == [0xff, 0xc0]).unwrap();
    for (size, code) in [([0xff, 0xff], ErrorCode::FileTooLarge), ([0x1f, 0xff], ErrorCode::CorruptFile)] {
        let mut claims = jpeg.to_vec();
        claims[frame + 5..frame + 9].copy_from_slice(&size.repeat(2));
        assert_eq!(photo(&claims), Err(code));
    }
    // Signature, then the header chunk: length, name, 13 bytes, checksum. A second header has another size.
    let (before, end) = fixture!("mask-grey.png").split_at(fixture!("mask-grey.png").len() - 12);
    assert_eq!(mask(&[before, &before[8..33], end].concat()), Err(ErrorCode::CorruptFile));
}

/// How many of 80 files with random damage a reader refuses.
fn refusals(fixture: usize, bytes: &[u8], read: impl Fn(&[u8]) -> Result<(), ErrorCode>) -> usize {
    let is_refused = |seed: &u64| {
        // Shown where the code under test panics.
        console_log!("fixture {fixture}, seed {seed}");
        let mut random = Random::new(1000 * fixture as u64 + seed, 941);
        let mut damaged = bytes.to_vec();
        // Half of the damage goes to the head, where the sizes are.
        let reach = if seed.is_multiple_of(2) { damaged.len() } else { damaged.len().min(160) };
        for _ in 0..1 + random.below(6) {
            let place = random.below(reach);
            damaged[place] = match random.below(4) {
                0 => 0,
                1 => 0xff,
                2 => b"0123456789-.eE{}[]\", \n"[random.below(22)],
                _ => random.below(256) as u8,
            };
        }
        match random.below(8) {
            0 => damaged.truncate(random.below(damaged.len())),
            1 => damaged.extend_from_within(..random.below(bytes.len())),
            _ => {}
        }
        read(&damaged).is_err()
    };
    (0..80).filter(is_refused).count()
}

#[wasm_bindgen_test]
fn random_damage_never_panics() {
    let meshes = MESHES.map(|(name, bytes)| (name, bytes, mesh as Reader));
    let depth_files = DEPTH_FILES.map(|(name, bytes)| (name, bytes, depth as Reader));
    let records = [(".splat", fixture!("mesh.splat"), splat as Reader)];
    let files = MUST_BE_WHOLE.into_iter().chain(meshes).chain(depth_files).chain(records);
    for (k, (name, bytes, read)) in files.enumerate() {
        assert!(refusals(k, bytes, read) > 0, "{name}: no damage was noticed");
    }
}
