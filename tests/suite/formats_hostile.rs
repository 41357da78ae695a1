//! Files cut at every length and files with random bytes changed: an answer or a typed error, never a panic.

use sim3align_formats::depth::{DepthReadOptions, read_depth};
use sim3align_formats::mask::read_mask;
use sim3align_formats::mesh::{MeshFormat, MeshReadOptions, read_mesh};
use sim3align_formats::splats::read_splats;

use crate::formats_fixtures::{MESHES, fixture};
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
    checked(read_mesh(bytes, &MeshReadOptions::default()))
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

/// Every kind of file but the text formats OBJ, PLY and STL: whatever is cut off is missed.
const MUST_BE_WHOLE: [(&str, &[u8], Reader); 25] = [
    ("GLB", fixture!("mesh.glb"), mesh),
    ("GLB scene", fixture!("scene.glb"), mesh),
    ("glTF", fixture!("mesh-data-uri.gltf"), mesh),
    ("PLY little-endian", fixture!("mesh-little.ply"), mesh),
    ("PLY big-endian", fixture!("mesh-big.ply"), mesh),
    ("STL", fixture!("mesh.stl"), mesh),
    ("STL, solid", fixture!("mesh-solid-header.stl"), mesh),
    ("splat", fixture!("splat.ply"), splat),
    ("depth f4", fixture!("depth-f4.npy"), depth),
    ("depth f8", fixture!("depth-f8-fortran.npy"), depth),
    ("depth >f4", fixture!("depth-f4-big.npy"), depth),
    ("depth f2", fixture!("depth-f2.npy"), depth),
    ("depth u2", fixture!("depth-u2-hw1.npy"), depth),
    ("depth >u2", fixture!("depth-u2-big-1hw.npy"), depth),
    ("depth PNG", fixture!("depth-16.png"), depth),
    ("mask 1 bit", fixture!("mask-1bit.png"), mask),
    ("mask grey", fixture!("mask-grey.png"), mask),
    ("mask grey 16", fixture!("mask-grey-16.png"), mask),
    ("mask RGB", fixture!("mask-blue.png"), mask),
    ("mask RGBA", fixture!("mask-cut-out.png"), mask),
    ("mask grey and alpha", fixture!("mask-grey-alpha.png"), mask),
    ("mask palette", fixture!("mask-palette.png"), mask),
    ("mask bool", fixture!("mask-bool.npy"), mask),
    ("mask i8", fixture!("mask-i8-fortran.npy"), mask),
    ("mask f4", fixture!("mask-f4.npy"), mask),
];

#[wasm_bindgen_test(unsupported = test)]
fn a_file_cut_short_at_any_length_is_refused() {
    for (name, bytes, read) in MUST_BE_WHOLE {
        assert_eq!(read(bytes), Ok(()), "{name}");
        for length in 0..bytes.len() {
            let result = read(&bytes[..length]);
            let expected = [ErrorCode::CorruptFile, ErrorCode::UnsupportedFormat];
            assert!(result.is_err_and(|code| expected.contains(&code)), "{name} cut to {length}: {result:?}");
        }
    }
}

#[wasm_bindgen_test(unsupported = test)]
fn a_text_mesh_cut_short_is_refused_where_the_cut_can_be_seen() {
    for (i, (format, bytes)) in MESHES.into_iter().enumerate() {
        let options = MeshReadOptions { format: Some(MeshFormat::from_name(format).unwrap()), resources: None };
        for length in 0..bytes.len() {
            let result = read_mesh(&bytes[..length], &options);
            // An OBJ has no end, and a number cut in its last digits is a number. Only the last one of an ASCII PLY
            // ("… 41") can be cut unseen; an ASCII STL ends after "endsolid".
            let unseen = match format {
                "obj" => true,
                "ply" | "stl" => length + 3 >= bytes.len(),
                _ => false,
            };
            assert!(unseen || result.is_err(), "fixture {i}, {format}, cut to {length}");
        }
    }
}

#[wasm_bindgen_test(unsupported = test)]
fn splat_records_with_random_damage_never_panic() {
    let refused = refusals(200, fixture!("mesh.splat"), splat);
    assert!(refused > 0 && refused < 300, "{refused}");
}

#[wasm_bindgen_test(unsupported = test)]
fn a_png_with_a_second_smaller_header_is_refused() {
    // Signature, then the header chunk: length, name, 13 bytes, checksum.
    let (start, header) = (8, 25);
    let file = fixture!("mask-grey.png");
    let (before, end) = file.split_at(file.len() - 12);
    // The decoder would only read the first header, the check of the size the last one.
    let doubled = [before, &file[start..start + header], end].concat();
    assert_eq!(mask(&doubled), Err(ErrorCode::CorruptFile));
    assert_eq!(depth(&doubled), Err(ErrorCode::CorruptFile));
    assert_eq!(mask(file), Ok(()));
}

#[wasm_bindgen_test(unsupported = test)]
fn a_palette_with_part_of_a_colour_is_refused() {
    let file = fixture!("mask-palette.png");
    let at = file.windows(4).position(|name| name == b"PLTE").unwrap() - 4;
    let length = u32::from_be_bytes([file[at], file[at + 1], file[at + 2], file[at + 3]]);
    assert!(length >= 6, "{length}");
    for missing in [1, 2] {
        let kept = length - missing;
        let chunk = [b"PLTE", &file[at + 8..at + 8 + kept as usize]].concat();
        let checksum = crc_32(&chunk).to_be_bytes();
        let rest = &file[at + 12 + length as usize..];
        let damaged = [&file[..at], &kept.to_be_bytes(), &chunk, &checksum, rest].concat();
        assert_eq!(mask(&damaged), Err(ErrorCode::CorruptFile), "{missing} bytes missing");
        assert_eq!(depth(&damaged), Err(ErrorCode::CorruptFile), "{missing} bytes missing");
    }
}

/// The checksum of PNG (ISO 3309).
fn crc_32(bytes: &[u8]) -> u32 {
    !bytes.iter().fold(u32::MAX, |sum, &byte| {
        (0..8).fold(sum ^ u32::from(byte), |sum, _| if sum & 1 == 1 { sum >> 1 ^ 0xedb8_8320 } else { sum >> 1 })
    })
}

/// Prints which run it was when the code under test panics.
struct NamedInPanics {
    fixture: usize,
    seed: u64,
}

impl Drop for NamedInPanics {
    fn drop(&mut self) {
        if std::thread::panicking() {
            eprintln!("panicked at fixture {}, seed {}", self.fixture, self.seed);
        }
    }
}

/// How many of 300 files with random damage a reader refuses.
fn refusals(fixture: usize, bytes: &[u8], read: impl Fn(&[u8]) -> Result<(), ErrorCode>) -> usize {
    let is_refused = |seed: &u64| {
        let _named = NamedInPanics { fixture, seed: *seed };
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
    (0..300).filter(is_refused).count()
}

#[wasm_bindgen_test(unsupported = test)]
fn random_damage_never_panics() {
    for (k, (name, bytes, read)) in MUST_BE_WHOLE.into_iter().enumerate() {
        assert!(refusals(k, bytes, read) > 0, "{name}: no damage was noticed");
    }
}

#[wasm_bindgen_test(unsupported = test)]
fn random_damage_to_a_known_format_never_panics() {
    for (k, (format, bytes)) in MESHES.into_iter().enumerate() {
        let options = MeshReadOptions { format: Some(MeshFormat::from_name(format).unwrap()), resources: None };
        let refused = refusals(100 + k, bytes, |damaged| checked(read_mesh(damaged, &options)));
        assert!(refused > 0 && refused < 300, "fixture {k}, {format}: {refused}");
    }
}
