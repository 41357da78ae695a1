//! OpenEXR images with a channel of depth.

use std::io;

use exr::block::UncompressedBlock;
use exr::block::lines::LineRef;
use exr::block::reader::{ChunksReader, Reader};
use exr::compression::Compression;
use exr::math::Vec2;
use exr::meta::attribute::SampleType;
use exr::meta::header::Header;
use exr::prelude::f16;

use crate::depth_image::{DepthImage, DepthReadOptions, Stored};
use crate::guard::{MAX_PIXELS, corrupt, pixel_count, too_large, unsupported};
use crate::point_map;
use sim3align_geometry::depth_kind::DepthKind;
use sim3align_runtime::error::{Error, Result};

/// Names of depth, the last part of `LAYER.NAME`: `Z` by convention (OpenEXR, Blender), or `depth`.
const DEPTH_NAMES: [&str; 2] = ["z", "depth"];

/// Names of the only channel of an image, as OpenCV (`Y`) and Blender (`V`) write it; `R` where one of three was kept.
const SINGLE_NAMES: [&str; 3] = ["y", "v", "r"];

/// Names of the coordinates of points, or of three equal channels of depth: OpenCV writes them as colours.
const POINT_NAMES: [[&str; 3]; 2] = [["x", "y", "z"], ["r", "g", "b"]];

/// Blender writes 1e10 where a ray hits nothing.
const NOTHING: f64 = 9.9e9;

/// Maximum number of channels: those of a renderer's passes are some dozens.
const MAX_CHANNELS: usize = 256;

/// Maximum number of bytes of a block, all channels together: 128 lines of a full-HD image with 64 channels.
const MAX_BLOCK_BYTES: usize = 1 << 26;

pub(crate) fn read_depth(bytes: &[u8], options: &DepthReadOptions, kind: DepthKind) -> Result<DepthImage> {
    let reader = Reader::read_from_buffered(io::Cursor::new(bytes), false)
        .map_err(|error| new_compression(bytes).unwrap_or_else(|| broken(&error)))?;
    let Found { layer, channels, unread } = find(reader.headers())?;
    let Some(header) = reader.headers().get(layer) else { return Err(no_depth(reader.headers())) };
    let picture = Picture::of(header)?;
    let of_layer = |&channel: &usize| header.channels.list.get(channel);
    let Some(description) = channels.first().and_then(of_layer) else { return Err(no_depth(reader.headers())) };
    let sample = description.sample_type;
    if channels.iter().filter_map(of_layer).any(|other| other.sampling != Vec2(1, 1) || other.sample_type != sample) {
        return Err(unsupported("depth", "an EXR with a subsampled channel", "one value per pixel", "Save it again."));
    }
    // The library's decoder of B44 overflows on damaged files. It is lossy, so that nobody keeps depth in it.
    let lossy = match header.compression {
        Compression::B44 | Compression::B44A => Some("B44"),
        Compression::DWAA(_) => Some("DWAA"),
        Compression::DWAB(_) => Some("DWAB"),
        _ => None,
    };
    if let Some(name) = lossy {
        let remedy = "Save it with ZIP compression.";
        return Err(unsupported("depth", format!("an EXR with {name} compression"), "lossless compression", remedy));
    }
    // In the order of the file: the library panics at offsets beyond 32 bits in the table of a damaged one.
    let chunks = reader.all_chunks(false).map_err(|error| broken(&error))?;
    let meta = chunks.meta_data().clone();
    let Some(list) = meta.headers.get(layer).map(|header| &header.channels) else { return Err(no_depth(&[])) };
    // Allocated when the first block has been read, and NaN where there is none.
    let mut images = vec![Vec::new(); channels.len()];
    for chunk in chunks {
        let chunk = chunk.map_err(|error| broken(&error))?;
        if chunk.layer_index != layer {
            continue;
        }
        let block = UncompressedBlock::decompress_chunk(chunk, &meta, false).map_err(|error| broken(&error))?;
        if block.index.level != Vec2(0, 0) {
            continue;
        }
        for (&channel, values) in channels.iter().zip(&mut images) {
            values.resize(picture.width * picture.height, f32::NAN);
            for line in block.lines(list).filter(|line| line.location.channel == channel) {
                picture.write(&line, sample, values).map_err(|error| broken(&error))?;
            }
        }
    }
    for values in &mut images {
        values.resize(picture.width * picture.height, f32::NAN);
    }
    let bits = if sample == SampleType::F16 { 16 } else { 32 };
    let stored = Stored { width: picture.width, height: picture.height, bits, is_integer: sample == SampleType::U32 };
    let value = |z: f32| if f64::from(z) >= NOTHING { f64::NAN } else { f64::from(z) };
    let image = match images.as_slice() {
        [x, y, z] => point_map::read(&stored, options, kind, &|i| [x, y, z].map(|values| value(values[i]))),
        [values] => stored.read(options, kind, &|i| value(values[i])),
        _ => Err(no_depth(&meta.headers)),
    }?;
    Ok(DepthImage { unread, ..image })
}

/// The display window, which the stored pixels may cover in part, or exceed.
struct Picture {
    width: usize,
    height: usize,
    /// Where the first stored pixel is in the picture.
    offset: [i64; 2],
    data: [usize; 2],
}

impl Picture {
    fn of(header: &Header) -> Result<Self> {
        let window = header.shared_attributes.display_window;
        let Vec2(width, height) = window.size;
        pixel_count("depth", width, height)?;
        let Vec2(data_width, data_height) = header.layer_size;
        pixel_count("depth", data_width, data_height)?;
        let pixel_bytes = header.channels.bytes_per_pixel;
        let block = header.max_block_pixel_size();
        let block_bytes = block.0.saturating_mul(block.1).saturating_mul(pixel_bytes);
        if header.channels.list.len() > MAX_CHANNELS || block_bytes > MAX_BLOCK_BYTES.max(8 * MAX_PIXELS) {
            let found = format!("{} channels in blocks of {block_bytes} bytes", header.channels.list.len());
            return Err(too_large("depth", found, format!("at most {MAX_CHANNELS} channels")));
        }
        let start = header.own_attributes.layer_position;
        let offset = [start.0, start.1].map(i64::from);
        let display = [window.position.0, window.position.1].map(i64::from);
        let offset = [offset[0] - display[0], offset[1] - display[1]];
        Ok(Self { width, height, offset, data: [data_width, data_height] })
    }

    /// Writes the samples of a line.
    fn write(&self, line: &LineRef<'_>, sample: SampleType, values: &mut [f32]) -> exr::error::UnitResult {
        let Vec2(first, row) = line.location.position;
        let mut write = |i: usize, value: f32| {
            if let Some(slot) = self.place(first + i, row).and_then(|place| values.get_mut(place)) {
                *slot = value;
            }
        };
        match sample {
            SampleType::F16 => {
                for (i, value) in line.read_samples::<f16>().enumerate() {
                    write(i, value?.to_f32());
                }
            }
            SampleType::F32 => {
                for (i, value) in line.read_samples::<f32>().enumerate() {
                    write(i, value?);
                }
            }
            SampleType::U32 => {
                for (i, value) in line.read_samples::<u32>().enumerate() {
                    write(i, value? as f32);
                }
            }
        }
        Ok(())
    }

    /// The index of a stored pixel in the picture, if it is inside.
    fn place(&self, column: usize, row: usize) -> Option<usize> {
        if column >= self.data[0] || row >= self.data[1] {
            return None;
        }
        let at = |stored: usize, offset: i64, size: usize| {
            usize::try_from(stored as i64 + offset).ok().filter(|place| *place < size)
        };
        let u = at(column, self.offset[0], self.width)?;
        Some(at(row, self.offset[1], self.height)? * self.width + u)
    }
}

/// The channels that are read.
struct Found {
    layer: usize,
    /// The channel of depth, or the three channels of points, which may be named as colours.
    channels: Vec<usize>,
    /// Other channels of depth.
    unread: Vec<String>,
}

fn find(headers: &[Header]) -> Result<Found> {
    let names_of = |header: &Header| -> Vec<String> {
        header.channels.list.iter().map(|channel| channel.name.to_string().to_ascii_lowercase()).collect()
    };
    let layers: Vec<Vec<String>> = headers.iter().map(names_of).collect();
    let places = |wanted: &[&str]| -> Vec<(usize, usize)> {
        let channels = |(layer, names): (usize, &Vec<String>)| -> Vec<(usize, usize)> {
            let is_wanted =
                |(_, name): &(usize, &String)| wanted.contains(&name.rsplit('.').next().unwrap_or_default());
            names.iter().enumerate().filter(is_wanted).map(|(channel, _)| (layer, channel)).collect()
        };
        layers.iter().enumerate().flat_map(channels).collect()
    };
    // The last part of a name is also that of a vector, as of a normal, and of what grows with the depth.
    let is_depth = |&(layer, channel): &(usize, usize)| {
        let names = &layers[layer];
        let pass = names[channel].rsplit_once('.').map_or("", |(pass, _)| pass);
        let other = if pass.is_empty() { "x".to_owned() } else { format!("{pass}.x") };
        !names.contains(&other) && !pass.ends_with("mist")
    };
    // Blender's for its denoiser is another form of the depth.
    let is_copy = |&(layer, channel): &(usize, usize)| layers[layer][channel].contains("denoising");
    let depths: Vec<(usize, usize)> = places(&DEPTH_NAMES).into_iter().filter(is_depth).collect();
    let chosen = depths.iter().find(|depth| !is_copy(depth)).or(depths.first());
    if let Some(&(layer, channel)) = chosen {
        let others = depths.iter().filter(|other| **other != (layer, channel) && !is_copy(other));
        let names = others.map(|&(layer, channel)| &layers[layer][channel]);
        let unread = names.map(|name| format!("the channel `{name}` of the depth file")).collect();
        return Ok(Found { layer, channels: vec![channel], unread });
    }
    let found = |(layer, channels)| Found { layer, channels, unread: Vec::new() };
    if let ([only], &[(layer, channel)]) = (layers.as_slice(), places(&SINGLE_NAMES).as_slice())
        && only.len() == 1
    {
        return Ok(found((layer, vec![channel])));
    }
    let of_points = POINT_NAMES.iter().find_map(|names| {
        let found: Vec<(usize, usize)> = names.iter().flat_map(|name| places(&[name])).collect();
        let &[(layer, x), (of_y, y), (of_z, z)] = found.as_slice() else { return None };
        // A picture may have alpha, too.
        let is_all = names[0] == "x" || (layers.len() == 1 && layers[layer].len() <= 4);
        (layer == of_y && layer == of_z && is_all).then(|| (layer, vec![x, y, z]))
    });
    of_points.map(found).ok_or_else(|| no_depth(headers))
}

fn no_depth(headers: &[Header]) -> Error {
    let names: Vec<String> =
        headers.iter().flat_map(|header| &header.channels.list).take(8).map(|c| c.name.to_string()).collect();
    unsupported(
        "depth",
        format!("an EXR with the channels {}", names.join(", ")),
        "a channel Z or depth, Y, V or R alone, or the points X, Y and Z or R, G and B of a map",
        "Save the depth alone, or the points x, y, z in the frame of the camera.",
    )
}

/// The names of the compressions from 10 on, which are newer than the library.
const NEW_COMPRESSIONS: [&str; 4] = ["HTJ2K256", "HTJ2K32", "LJ2K", "ZSTD"];

/// The error for a file whose header states a compression that is newer than the library.
fn new_compression(bytes: &[u8]) -> Option<Error> {
    const ATTRIBUTE: &[u8] = b"compression\0compression\0\x01\0\0\0";
    let start = bytes.windows(ATTRIBUTE.len()).take(1 << 16).position(|window| window == ATTRIBUTE)?;
    let number = usize::from(*bytes.get(start + ATTRIBUTE.len())?);
    let name = NEW_COMPRESSIONS.get(number.checked_sub(10)?).copied().unwrap_or("unknown");
    let found = format!("an EXR with {name} compression ({number}), which is newer than this reader");
    Some(unsupported("depth", found, "ZIP, RLE, PIZ, PXR24 or no compression", "Save it with ZIP compression."))
}

fn broken(error: &exr::error::Error) -> Error {
    match error {
        exr::error::Error::NotSupported(_) => unsupported(
            "depth",
            "an EXR with deep pixels or of a newer version",
            "flat images",
            "Save it again as a flat image, with ZIP compression.",
        ),
        error => corrupt("depth", format!("an EXR that can't be decoded: {error}"), "an OpenEXR image"),
    }
}
