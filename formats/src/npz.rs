//! NumPy's `.npz`: a ZIP archive of `.npy` arrays, as the programs around depth models save them.
//!
//! Files of these programs (2026): Depth Pro saves `depth` in metres, and its network returns `focallength_px` beside
//! it. MoGe returns `points` (H×W×3), `depth`, `mask`, and `intrinsics` in image sizes; invalid pixels are infinite.
//! Depth Anything 3 saves `depth` (N×H×W), `conf`, `intrinsics` (N×3×3, pixels) and `extrinsics`. UniDepth returns `depth`
//! (1×1×H×W), `points` (1×3×H×W) and `intrinsics` (pixels). Metric3D returns `pred_depth` (1×1×H×W).

use std::io::{self, Read};

use zip::ZipArchive;
use zip::result::ZipError;

use crate::cursor::Cursor;
use crate::depth_image::{DepthImage, DepthReadOptions, Stored};
use crate::file_camera::FileCamera;
use crate::guard::{corrupt, pixel_count, too_large, unsupported};
use crate::npy::{Kind, NpyArray, NpyHeader};
use sim3align_geometry::depth_kind::DepthKind;
use sim3align_runtime::error::{Error, ErrorCode, Result};

/// Names of depth, in order of preference.
const DEPTH: [&str; 6] = ["depth", "depth_map", "depthmap", "pred_depth", "predicted_depth", "prediction"];

/// Names of inverse depth.
const DISPARITY: [&str; 4] = ["disparity", "inverse_depth", "inv_depth", "disp"];

/// Names of point maps.
const POINTS: [&str; 5] = ["points", "point_map", "pointmap", "pts3d", "points3d"];

/// Names of masks of the pixels that have depth.
const MASKS: [&str; 3] = ["mask", "valid", "valid_mask"];

const INTRINSICS: [&str; 9] = [
    "intrinsics",
    "intrinsic",
    "k",
    "cam_k",
    "camera_k",
    "camera_matrix",
    "intrinsic_matrix",
    "camera_intrinsics",
    "intrinsics_matrix",
];
const FOCAL_LENGTHS: [&str; 4] = ["focallength_px", "focal_length_px", "f_px", "focal"];
const FIELDS_OF_VIEW: [[&str; 1]; 2] = [["fov_x"], ["fov_y"]];

/// Names of maps that are no depth.
const OTHER_MAPS: [&str; 5] = ["conf", "confidence", "uncertainty", "error", "sky"];

/// Maximum number of entries.
const MAX_ENTRIES: usize = 1024;

/// Maximum size of an array: 8192 × 8192 values of 64 bits.
const MAX_ARRAY_BYTES: usize = 1 << 29;

/// The part of an entry that holds its header: NumPy writes 128 bytes for such arrays.
const HEADER_BYTES: u64 = 4096;

pub(crate) fn read_depth(bytes: &[u8], options: &DepthReadOptions, kind: DepthKind) -> Result<DepthImage> {
    let mut archive = Archive::open(bytes)?;
    let source = archive.source(kind)?;
    let ([height, width], entry) = match &source {
        Source::Map(entry, size) => (*size, entry),
        Source::Points(entry, size, _) => (*size, entry),
    };
    pixel_count("depth", width, height)?;
    let stored = Stored { width, height, bits: 8 * entry.header.size, is_integer: entry.header.kind != Kind::Float };
    stored.check_bits(kind, || format!("an array `{}` of 8-bit elements", entry.name))?;
    let mask = archive.mask([height, width])?;
    let camera = archive.camera()?.pinhole(width, height)?;
    let is_valid = |i: usize| mask.as_ref().is_none_or(|mask| mask.get(i).copied().unwrap_or(false));
    let data = archive.read(entry)?;
    let array = NpyArray::read("depth", &data)?;
    let keep = |(i, z)| if is_valid(i) { z } else { f64::NAN };
    let image = match source {
        Source::Map(..) => stored.read(options, kind, array.values([height, width, 1]).enumerate().map(keep)),
        Source::Points(_, _, true) => {
            let z = array.values([height, width, 3]).skip(2).step_by(3);
            stored.read(options, kind, z.enumerate().map(keep))
        }
        Source::Points(_, _, false) => {
            let z = array.values([3, height, width]).skip(2 * height * width);
            stored.read(options, kind, z.enumerate().map(keep))
        }
    };
    image.map(|image| DepthImage { camera, ..image })
}

/// An array of an archive, of which the header has been read.
#[derive(Debug, Clone)]
struct Entry {
    /// In lower case, without `.npy`.
    name: String,
    index: usize,
    header: NpyHeader,
    /// Bytes of the header and of the elements.
    bytes: usize,
}

/// The array of the depth: an image, or the z of points, with its height and width.
enum Source {
    Map(Entry, [usize; 2]),
    /// Whether the coordinates of a point are beside one another.
    Points(Entry, [usize; 2], bool),
}

struct Archive<'a> {
    zip: ZipArchive<io::Cursor<&'a [u8]>>,
    entries: Vec<Entry>,
}

impl<'a> Archive<'a> {
    /// Reads the headers of all arrays. Other arrays than those of numbers are left out.
    fn open(bytes: &'a [u8]) -> Result<Self> {
        let mut zip = ZipArchive::new(io::Cursor::new(bytes)).map_err(|error| broken(&error))?;
        if zip.len() > MAX_ENTRIES {
            return Err(too_large("depth", format!("{} arrays", zip.len()), format!("at most {MAX_ENTRIES}")));
        }
        let mut entries = Vec::new();
        for index in 0..zip.len() {
            let file = zip.by_index(index).map_err(|error| broken(&error))?;
            let name = file.name().map_err(|error| broken(&error))?.to_ascii_lowercase();
            let Some(name) = name.strip_suffix(".npy").map(str::to_owned) else { continue };
            let mut head = Vec::new();
            file.take(HEADER_BYTES).read_to_end(&mut head).map_err(|error| cut(&name, &error))?;
            let mut cursor = Cursor::new("depth", &head);
            let header = match NpyHeader::read("depth", &mut cursor) {
                Ok(header) => header,
                // Text, objects and records are not for us.
                Err(error) if error.code == ErrorCode::UnsupportedFormat => continue,
                // Records of many fields.
                Err(_) if head.len() as u64 == HEADER_BYTES => continue,
                Err(error) => return Err(error),
            };
            let start = head.len() - cursor.remaining().len();
            let bytes = header.count().saturating_mul(header.size).saturating_add(start);
            entries.push(Entry { name, index, header, bytes });
        }
        Ok(Self { zip, entries })
    }

    /// The array with the first of these names that there is.
    fn find(&self, names: &[&str]) -> Option<Entry> {
        names.iter().find_map(|name| self.entries.iter().find(|entry| entry.name == *name)).cloned()
    }

    /// All bytes of an array, decompressed.
    fn read(&mut self, entry: &Entry) -> Result<Vec<u8>> {
        if entry.bytes > MAX_ARRAY_BYTES + HEADER_BYTES as usize {
            let found = format!("an array `{}` of shape {:?}", entry.name, entry.header.shape);
            return Err(too_large("depth", found, format!("at most {MAX_ARRAY_BYTES} bytes")));
        }
        let file = self.zip.by_index(entry.index).map_err(|error| broken(&error))?;
        let mut data = Vec::new();
        // One more: the checksum is compared at the end.
        file.take(entry.bytes as u64 + 1).read_to_end(&mut data).map_err(|error| cut(&entry.name, &error))?;
        if data.len() == entry.bytes {
            return Ok(data);
        }
        let found = format!("an array `{}` of another length than its shape says", entry.name);
        Err(corrupt("depth", found, format!("{} bytes", entry.bytes)))
    }

    fn source(&self, kind: DepthKind) -> Result<Source> {
        let is_disparity = kind == DepthKind::AffineInvariantDisparity;
        let disparity = self.find(&DISPARITY);
        if let Some(entry) = disparity.clone().filter(|_| is_disparity).or_else(|| self.find(&DEPTH)) {
            return image(entry);
        }
        let is_map = |entry: &&Entry| {
            let is_other =
                [&MASKS[..], &OTHER_MAPS, &DISPARITY].iter().any(|names| names.contains(&entry.name.as_str()));
            let size = entry.header.squeezed(2);
            // Matrices of cameras are smaller.
            entry.header.kind == Kind::Float && size.len() == 2 && size.iter().all(|side| *side > 4) && !is_other
        };
        if let Some(entry) = self.find(&POINTS).filter(|_| !is_disparity) {
            return points(entry);
        }
        let mut maps = self.entries.iter().filter(is_map);
        if let (Some(only), None) = (maps.next(), maps.next()) {
            return image(only.clone());
        }
        if let Some(Entry { name, .. }) = disparity {
            return Err(unsupported(
                "depth",
                format!("an array `{name}`, which is inverse depth"),
                "depth",
                "Pass depthKind \"affine-invariant-disparity\", or convert it: depth = focal · baseline / disparity.",
            ));
        }
        let list: Vec<String> =
            self.entries.iter().take(12).map(|entry| format!("{} {:?}", entry.name, entry.header.shape)).collect();
        Err(unsupported(
            "depth",
            if list.is_empty() { "an archive without arrays".into() } else { format!("arrays {}", list.join(", ")) },
            "an array `depth`, one array H × W of floats, or `points` H × W × 3",
            "Save the depth under that name: numpy.savez(path, depth=depth).",
        ))
    }

    /// The pixels with depth, if there is a mask of booleans.
    fn mask(&mut self, size: [usize; 2]) -> Result<Option<Vec<bool>>> {
        let is_mask = |name: &&str| self.find(&[name]).filter(|entry| entry.header.kind == Kind::Bool);
        let Some(entry) = MASKS.iter().find_map(is_mask) else { return Ok(None) };
        if entry.header.squeezed(2) != size {
            return Err(Error::new(
                ErrorCode::SizeMismatch,
                "depth",
                format!("an array `{}` of shape {:?}", entry.name, entry.header.shape),
                format!("{} × {}, that of the depth", size[0], size[1]),
                "Save the mask in the size of the depth, or leave it out.",
            ));
        }
        let data = self.read(&entry)?;
        let array = NpyArray::read("depth", &data)?;
        Ok(Some(array.values([size[0], size[1], 1]).map(|value| value != 0.0).collect()))
    }

    fn camera(&mut self) -> Result<FileCamera> {
        let intrinsics = match self.find(&INTRINSICS) {
            None => None,
            // 3 × 3, also as nine numbers, or as part of a projection of 3 × 4 or 4 × 4.
            Some(entry) if let Some([rows, columns]) = matrix_sides(entry.header.squeezed(1)) => {
                let data = self.read(&entry)?;
                let mut numbers = [0.0; 9];
                let values = NpyArray::read("depth", &data)?;
                let upper_left = values.values([rows, columns, 1]).enumerate().filter(|(i, _)| i % columns < 3);
                for (to, (_, from)) in numbers.iter_mut().zip(upper_left) {
                    *to = from;
                }
                Some(numbers)
            }
            // fx, fy, cx, cy.
            Some(entry) if entry.header.squeezed(1) == [4] => {
                let data = self.read(&entry)?;
                let values = NpyArray::read("depth", &data)?;
                let [fx, fy, cx, cy] = [0, 1, 2, 3].map(|i| values.value(i));
                Some([fx, 0.0, cx, 0.0, fy, cy, 0.0, 0.0, 1.0])
            }
            Some(entry) => return Err(several(&entry, "intrinsics of one image, 3 × 3")),
        };
        let focal_length = self.number(&FOCAL_LENGTHS)?;
        let [fov_x, fov_y] = FIELDS_OF_VIEW;
        let fields_of_view = [self.number(&fov_x)?, self.number(&fov_y)?];
        Ok(FileCamera { intrinsics, focal_length, fields_of_view })
    }

    fn number(&mut self, names: &[&str]) -> Result<Option<f64>> {
        let Some(entry) = self.find(names).filter(|entry| entry.header.count() == 1) else { return Ok(None) };
        let data = self.read(&entry)?;
        Ok(Some(NpyArray::read("depth", &data)?.value(0)))
    }
}

/// Rows and columns of a matrix with intrinsics.
fn matrix_sides(shape: &[usize]) -> Option<[usize; 2]> {
    match *shape {
        [rows @ 3..=4, columns @ 3..=4] => Some([rows, columns]),
        [9] => Some([3, 3]),
        _ => None,
    }
}

fn image(entry: Entry) -> Result<Source> {
    match *entry.header.squeezed(2) {
        [height, width] => Ok(Source::Map(entry, [height, width])),
        _ => Err(several(&entry, "one image, H × W")),
    }
}

fn points(entry: Entry) -> Result<Source> {
    match *entry.header.squeezed(3) {
        [height, width, 3] => Ok(Source::Points(entry, [height, width], true)),
        [3, height, width] => Ok(Source::Points(entry, [height, width], false)),
        _ => Err(several(&entry, "the points of one image, H × W × 3")),
    }
}

fn several(entry: &Entry, expected: &'static str) -> Error {
    let Entry { name, header, .. } = entry;
    unsupported(
        "depth",
        format!("an array `{name}` of shape {:?}", header.shape),
        expected,
        format!("Save one image of the batch: numpy.savez(path, {name}={name}[0]), and its intrinsics likewise."),
    )
}

fn cut(name: &str, error: &io::Error) -> Error {
    corrupt("depth", format!("an array `{name}` that can't be decompressed: {error}"), "a .npz file")
}

fn broken(error: &ZipError) -> Error {
    match error {
        ZipError::UnsupportedArchive(feature) => unsupported(
            "depth",
            format!("a ZIP archive with {feature}"),
            "entries that are stored or deflated, as numpy.savez and savez_compressed write them",
            "Save it again with numpy.savez.",
        ),
        error => corrupt("depth", format!("a ZIP archive that can't be read: {error}"), "a .npz file"),
    }
}
