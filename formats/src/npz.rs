//! NumPy's `.npz`: a ZIP archive of `.npy` arrays, as the programs around depth models save them.
//!
//! Files of these programs (2026): Depth Pro saves `depth` in metres, and its network returns `focallength_px` beside
//! it. MoGe returns `points` (H×W×3), `depth`, `mask`, and `intrinsics` in image sizes; invalid pixels are infinite.
//! Depth Anything 3 saves `depth` (N×H×W), `conf`, `intrinsics` (N×3×3, pixels) and `extrinsics`. UniDepth returns `depth`
//! (1×1×H×W), `points` (1×3×H×W) and `intrinsics` (pixels). Metric3D returns `pred_depth` (1×1×H×W). DUSt3R and MASt3R have
//! `pts3d` (H×W×3), `conf`, `focals` and `principal_points` (pixels); VGGT `depth`, `depth_conf`, `world_points`, `extrinsic`
//! and `intrinsic`. The names below are all that are known: `unread` has the others.

use std::io::{self, Read};

use zip::ZipArchive;
use zip::result::ZipError;

use crate::cursor::Cursor;
use crate::depth_image::{DepthImage, DepthReadOptions, Stored};
use crate::file_camera::FileCamera;
use crate::guard::{corrupt, pixel_count, too_large, unsupported};
use crate::npy::{Kind, NpyArray, NpyHeader, NpyPoints, image_sides, point_sides};
use crate::point_map;
use sim3align_geometry::depth_kind::DepthKind;
use sim3align_geometry::pinhole::Pinhole;
use sim3align_runtime::error::{Error, ErrorCode, Result};

/// Names of depth, in order of preference; here and below, with spaces between them.
const DEPTH: &str = "depth depth_map depthmap pred_depth predicted_depth prediction";

/// Names of inverse depth.
const DISPARITY: &str = "disparity inverse_depth inv_depth disp";

/// Names of point maps in the frame of the camera.
const POINTS: &str = "points point_map pointmap pts3d points3d pts xyz xyz_map points_cam pts3d_cam";

/// Names of masks of the pixels that have depth.
const MASKS: &str = "mask valid valid_mask";

const INTRINSICS: &str = "intrinsics intrinsic k cam_k camera_k camera_matrix intrinsic_matrix camera_intrinsics \
    intrinsics_matrix";
/// In pixels: one number, or two for columns and rows.
const FOCALS: &str = "focallength_px focal_length_px f_px focal focals focal_length focal_lengths focallength focal_px";
/// In pixels, beside focal lengths.
const CENTERS: &str = "principal_point principal_points pp pps";
const FOV_X: &str = "fov_x";
const FOV_Y: &str = "fov_y";

/// Names of maps that are no depth, and do not matter here.
const OTHER_MAPS: &str = "conf confidence uncertainty error sky depth_conf pts3d_conf world_points_conf";

/// Names of what else does not matter here: pictures, normals, poses of the camera, and times.
const OTHERS: &str = "normal normals rgb image images img color colors colour world_points extrinsic extrinsics pose \
    poses camera_pose camera_poses cam2world c2w w2c timestamp timestamps frame_id height width image_size gravity";

/// Whether `name` is among `names`, which have spaces between them.
fn is_among(names: &str, name: &str) -> bool {
    names.split(' ').any(|one| one == name)
}

/// Maximum number of entries.
const MAX_ENTRIES: usize = 1024;

/// Maximum size of an array: 8192 × 8192 values of 64 bits.
const MAX_ARRAY_BYTES: usize = 1 << 29;

/// The part of an entry that holds its header: NumPy writes 128 bytes for such arrays.
const HEADER_BYTES: u64 = 4096;

pub(crate) fn read_depth(bytes: &[u8], options: &DepthReadOptions, kind: DepthKind) -> Result<DepthImage> {
    let mut archive = Archive::open(bytes)?;
    let source = archive.source(kind)?;
    let (Source::Map(entry, [height, width]) | Source::Points(entry, [height, width])) = &source;
    let (height, width) = (*height, *width);
    pixel_count("depth", width, height)?;
    let stored = Stored { width, height, bits: 8 * entry.header.size, is_integer: entry.header.kind != Kind::Float };
    stored.check_bits(kind, || format!("an array `{}` of 8-bit elements", entry.name))?;
    let mask = archive.mask([height, width])?;
    let camera = archive.camera()?.pinhole(width, height)?;
    let data = archive.read(entry)?;
    let array = NpyArray::read("depth", &data)?;
    let is_valid = |i: usize| mask.as_ref().is_none_or(|mask| mask.get(i).copied().unwrap_or(false));
    let image = match &source {
        Source::Map(..) => stored.read_rows(options, kind, &|start, row| {
            array.fill(start, [height, width, 1], row);
            row.iter_mut().enumerate().filter(|(u, _)| !is_valid(start + u)).for_each(|(_, z)| *z = f64::NAN);
        })?,
        Source::Points(..) => {
            let map = NpyPoints::of(array).ok_or_else(|| no_points(entry))?;
            let point = |i: usize| if is_valid(i) { map.point(i) } else { [f64::NAN; 3] };
            point_map::read(&stored, options, kind, &point)?
        }
    };
    // Of points beside the depth, at least the camera.
    let beside =
        if camera.is_none() && image.camera.is_none() { archive.beside(entry, [height, width])? } else { None };
    let camera = camera.or(image.camera).or(beside);
    let unread = archive.unread(&entry.name);
    Ok(DepthImage { camera, unread, ..image })
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
    Points(Entry, [usize; 2]),
}

struct Archive<'a> {
    zip: ZipArchive<io::Cursor<&'a [u8]>>,
    entries: Vec<Entry>,
    /// The names of what is no array of numbers.
    others: Vec<String>,
}

impl<'a> Archive<'a> {
    /// Reads the headers of all arrays of numbers.
    fn open(bytes: &'a [u8]) -> Result<Self> {
        let mut zip = ZipArchive::new(io::Cursor::new(bytes)).map_err(|error| broken(&error))?;
        if zip.len() > MAX_ENTRIES {
            return Err(too_large("depth", format!("{} arrays", zip.len()), format!("at most {MAX_ENTRIES}")));
        }
        let (mut entries, mut others) = (Vec::new(), Vec::new());
        for index in 0..zip.len() {
            let file = zip.by_index(index).map_err(|error| broken(&error))?;
            let name = file.name().map_err(|error| broken(&error))?.to_ascii_lowercase();
            let Some(name) = name.strip_suffix(".npy").map(str::to_owned) else {
                others.push(name);
                continue;
            };
            let mut head = Vec::new();
            file.take(HEADER_BYTES).read_to_end(&mut head).map_err(|error| cut(&name, &error))?;
            let mut cursor = Cursor::new("depth", &head);
            let header = match NpyHeader::read("depth", &mut cursor) {
                Ok(header) => header,
                // Text, objects and records, some of many fields, are not for us.
                Err(error) if error.code == ErrorCode::UnsupportedFormat || head.len() as u64 == HEADER_BYTES => {
                    others.push(name);
                    continue;
                }
                Err(error) => return Err(error),
            };
            let start = head.len() - cursor.remaining().len();
            let bytes = header.count().saturating_mul(header.size).saturating_add(start);
            entries.push(Entry { name, index, header, bytes });
        }
        Ok(Self { zip, entries, others })
    }

    /// The arrays that are not known, but for the one that is read.
    fn unread(&self, used: &str) -> Vec<String> {
        let known = [DEPTH, DISPARITY, POINTS, MASKS, INTRINSICS, FOCALS, CENTERS, FOV_X, FOV_Y, OTHER_MAPS, OTHERS];
        let names = self.entries.iter().map(|entry| &entry.name).chain(&self.others);
        let is_known = |name: &&String| *name == used || known.iter().any(|names| is_among(names, name));
        names.filter(|name| !is_known(name)).map(|name| format!("the array `{name}` of the depth file")).collect()
    }

    /// The camera of the points beside the depth of this size.
    fn beside(&mut self, depth: &Entry, size: [usize; 2]) -> Result<Option<Pinhole>> {
        let is_of_size = |entry: &Entry| {
            entry.name != depth.name && matches!(points(entry.clone()), Ok(Source::Points(_, own)) if own == size)
        };
        let Some(entry) = self.find(POINTS).filter(is_of_size) else { return Ok(None) };
        let data = self.read(&entry)?;
        let Some(map) = NpyPoints::of(NpyArray::read("depth", &data)?) else { return Ok(None) };
        let image = point_map::read(&map.stored(), &DepthReadOptions::default(), DepthKind::Metric, &|i| map.point(i));
        Ok(image.ok().and_then(|image| image.camera))
    }

    /// The array with the first of these names that there is.
    fn find(&self, names: &str) -> Option<Entry> {
        names.split(' ').find_map(|name| self.entries.iter().find(|entry| entry.name == name)).cloned()
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
        let disparity = self.find(DISPARITY);
        if let Some(entry) = disparity.clone().filter(|_| is_disparity).or_else(|| self.find(DEPTH)) {
            return image(entry);
        }
        let is_map = |entry: &&Entry| {
            let is_other = [MASKS, OTHER_MAPS, DISPARITY].iter().any(|names| is_among(names, &entry.name));
            let size = entry.header.squeezed(2);
            // Matrices of cameras are smaller.
            entry.header.kind == Kind::Float && size.len() == 2 && size.iter().all(|side| *side > 4) && !is_other
        };
        if let Some(entry) = self.find(POINTS).filter(|_| !is_disparity) {
            return points(entry);
        }
        let mut maps = self.entries.iter().filter(is_map);
        if let (Some(only), None) = (maps.next(), maps.next()) {
            return image(only.clone());
        }
        let is_points = |entry: &&Entry| {
            entry.header.kind == Kind::Float && !is_among(OTHERS, &entry.name) && points((*entry).clone()).is_ok()
        };
        let mut all_points = self.entries.iter().filter(is_points);
        if let (Some(only), None, false) = (all_points.next(), all_points.next(), is_disparity) {
            return points(only.clone());
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
        let is_mask = |name| self.find(name).filter(|entry| entry.header.kind == Kind::Bool);
        let Some(entry) = MASKS.split(' ').find_map(is_mask) else { return Ok(None) };
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
        let intrinsics = match self.find(INTRINSICS) {
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
        let focal_lengths = self.pair(FOCALS)?;
        let principal_point = self.pair(CENTERS)?;
        let fields_of_view = [self.pair(FOV_X)?.map(|[x, _]| x), self.pair(FOV_Y)?.map(|[y, _]| y)];
        Ok(FileCamera { intrinsics, focal_lengths, principal_point, fields_of_view })
    }

    /// Two numbers, or one twice.
    fn pair(&mut self, names: &str) -> Result<Option<[f64; 2]>> {
        let Some(entry) = self.find(names) else { return Ok(None) };
        let last = match entry.header.count() {
            1 => 0,
            2 => 1,
            _ => return Err(several(&entry, "one or two numbers of one image")),
        };
        let data = self.read(&entry)?;
        let values = NpyArray::read("depth", &data)?;
        Ok(Some([values.value(0), values.value(last)]))
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
    match point_sides(entry.header.squeezed(3)) {
        Some((sides, is_interleaved)) => Ok(Source::Points(entry, image_sides(sides, is_interleaved))),
        None => Err(no_points(&entry)),
    }
}

fn no_points(entry: &Entry) -> Error {
    several(entry, "the points of one image, H × W × 3")
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
