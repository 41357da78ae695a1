//! The conditions of a case: tiers of difficulty, and classes, each of which changes something of the typical case.

use crate::objects::Pool;
use crate::objects::print::PrintKind;
use crate::prelude::*;

named! {
    /// Tier of difficulty of a case.
    pub enum Tier {
        /// Good conditions: exact masks, good depth, accurate meshes.
        Easy = "easy",
        /// Typical output of current models.
        Medium = "medium",
        /// Poor output of current models.
        Hard = "hard",
    }
}

impl Tier {
    /// The tier of a case: they take turns.
    pub fn of(index: usize) -> Self {
        [Self::Easy, Self::Medium, Self::Hard][index % 3]
    }

    /// One of three values.
    pub fn pick<T>(self, easy: T, medium: T, hard: T) -> T {
        match self {
            Self::Easy => easy,
            Self::Medium => medium,
            Self::Hard => hard,
        }
    }

    /// Draws the tier of one output of a model.
    pub fn draw(random: &mut Random) -> Self {
        match random.uniform() {
            u if u < 0.35 => Self::Easy,
            u if u < 0.8 => Self::Medium,
            _ => Self::Hard,
        }
    }
}

/// Visibility of an object in the image.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Framing {
    /// All of it, or most.
    Free,
    Tiny,
    /// A part: the border of the image cuts it.
    BorderCut,
    /// A part: something in front hides the rest.
    Occluded,
}

named! {
    /// A source of depth: a sensor or a depth model.
    pub enum DepthSource {
        /// Stereo matching of blocks, with a projected texture.
        ActiveStereo = "active-stereo",
        /// A projected pattern, matched to a reference.
        StructuredLight = "structured-light",
        /// The time that light takes.
        TimeOfFlight = "time-of-flight",
        /// A model, from one photo.
        Predicted = "predicted-depth",
    }
}

named! {
    /// A source of masks.
    pub enum MaskSource {
        /// A segmentation network.
        Network = "network-mask",
        /// A person who draws polygons.
        Annotator = "annotated-mask",
    }
}

/// Readings that a sensor loses or coarsens.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum DepthFault {
    None,
    /// Many readings are missing here and there.
    Sparse,
    /// No readings on dark, reflective and grazing parts of the object.
    Holes,
    /// The same holes, which the mask does not contain either.
    HolesOfMask,
    /// Steps of millimetres that grow with the square of the depth, as disparities in steps give it.
    Quantised,
}

/// Faults of a generated mesh beyond those of its tier.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum MeshFault {
    None,
    /// Stretched, bent and warped more than usual.
    Warped,
    /// A part, or a piece, is missing.
    MissingPart,
    /// Something that the object does not have.
    ExtraPart,
}

/// A class of cases: what it changes of the typical case of its tier.
#[derive(Debug)]
pub struct Class {
    pub name: &'static str,
    /// The pool of its objects; `None` for that of the tier.
    pub pool: Option<Pool>,
    pub framing: Framing,
    /// Sources of depth, equally likely.
    pub depth: &'static [DepthSource],
    pub depth_fault: DepthFault,
    /// The source of its masks; `None` for any.
    pub mask: Option<MaskSource>,
    /// Whether the mask has holes, islands, lost and foreign regions.
    pub is_ragged: bool,
    pub mesh_fault: MeshFault,
    /// The print of the object, which then has a photo.
    pub print: Option<PrintKind>,
    /// Whether colour alone determines which turn of a symmetric shape is right.
    pub needs_color: bool,
    /// Whether the mesh has the colours of another object.
    pub has_wrong_colors: bool,
    /// Whether the photo is grey.
    pub is_grey: bool,
    /// Whether up to half of the object is over- or underexposed in the photo, which also has reflections and a larger offset from
    /// the depth map.
    pub is_harsh: bool,
}

const STEREO: DepthSource = DepthSource::ActiveStereo;
const LIGHT: DepthSource = DepthSource::StructuredLight;
const TIME: DepthSource = DepthSource::TimeOfFlight;
const PREDICTED: DepthSource = DepthSource::Predicted;

/// Two thirds of the maps are those of depth models.
const ANY_SOURCE: &[DepthSource] = &[
    PREDICTED, PREDICTED, STEREO, PREDICTED, PREDICTED, LIGHT, PREDICTED, PREDICTED, STEREO, PREDICTED, PREDICTED, TIME,
];
/// Half of the sensors are stereo cameras.
const SENSOR: &[DepthSource] = &[STEREO, LIGHT, STEREO, TIME];

/// The typical case.
pub const PLAIN: Class = Class {
    name: "plain",
    pool: None,
    framing: Framing::Free,
    depth: ANY_SOURCE,
    depth_fault: DepthFault::None,
    mask: None,
    is_ragged: false,
    mesh_fault: MeshFault::None,
    print: None,
    needs_color: false,
    has_wrong_colors: false,
    is_grey: false,
    is_harsh: false,
};
const OCCLUDED: Class = Class { name: "occluded", framing: Framing::Occluded, ..PLAIN };
const BORDER_CUT: Class = Class { name: "border-cut", framing: Framing::BorderCut, ..PLAIN };
const TINY: Class = Class { name: "tiny", framing: Framing::Tiny, ..PLAIN };
const THIN: Class = Class { name: "thin", pool: Some(Pool::Thin), ..PLAIN };
const AMBIGUOUS: Class = Class { name: "ambiguous", pool: Some(Pool::Ambiguous), ..PLAIN };
/// A part, or a piece, is missing in the mesh.
pub const MISSING_PART: Class =
    Class { name: "missing-part", pool: Some(Pool::Losable), mesh_fault: MeshFault::MissingPart, ..PLAIN };
/// The mesh has a lump that the object does not have.
pub const EXTRA_PART: Class = Class { name: "extra-part", mesh_fault: MeshFault::ExtraPart, ..PLAIN };
/// The mesh is stretched, bent and warped more than usual.
pub const WARPED: Class = Class { name: "warped", mesh_fault: MeshFault::Warped, ..PLAIN };
/// The mask has holes, islands, lost and foreign regions.
pub const RAGGED_MASK: Class = Class { name: "ragged-mask", is_ragged: true, ..PLAIN };
/// Also the conditions of videos.
pub const SPARSE_SENSOR: Class =
    Class { name: "sparse-sensor", depth: SENSOR, depth_fault: DepthFault::Sparse, ..PLAIN };
/// Videos of a mesh that is stretched, bent and warped.
pub const WARPED_IN_VIDEO: Class = Class { mesh_fault: MeshFault::Warped, ..SPARSE_SENSOR };
/// A symmetric shape whose print alone determines its turn.
const PRINTED: Class =
    Class { name: "printed", pool: Some(Pool::Symmetric), print: Some(PrintKind::Label), needs_color: true, ..PLAIN };

const fn sensor(name: &'static str, depth: &'static [DepthSource]) -> Class {
    Class { name, depth, ..PLAIN }
}

const fn faulty(name: &'static str, depth_fault: DepthFault) -> Class {
    Class { name, depth: SENSOR, depth_fault, ..PLAIN }
}

/// Classes of the general set by tier.
pub const GENERAL: [&[Class]; 3] = [
    &[PLAIN],
    &[PLAIN, OCCLUDED, THIN, PLAIN, SPARSE_SENSOR, RAGGED_MASK, BORDER_CUT, PLAIN, OCCLUDED, MISSING_PART],
    &[
        PLAIN,
        OCCLUDED,
        RAGGED_MASK,
        MISSING_PART,
        TINY,
        BORDER_CUT,
        WARPED,
        SPARSE_SENSOR,
        THIN,
        AMBIGUOUS,
        OCCLUDED,
        EXTRA_PART,
    ],
];
/// Effects of depth sensors and of the sources of masks, of every tier.
pub const SENSORS: &[Class] = &[
    faulty("holes", DepthFault::Holes),
    faulty("mask-of-readings", DepthFault::HolesOfMask),
    faulty("quantised", DepthFault::Quantised),
    sensor("active-stereo", &[STEREO]),
    sensor("structured-light", &[LIGHT]),
    sensor("time-of-flight", &[TIME]),
    sensor("predicted-depth", &[PREDICTED]),
    Class { name: "network-mask", mask: Some(MaskSource::Network), ..PLAIN },
    Class { name: "annotated-mask", mask: Some(MaskSource::Annotator), ..PLAIN },
];
/// Coloured objects and their photos, of every tier.
pub const COLORS: &[Class] = &[
    PRINTED,
    Class { name: "printed-shape", print: Some(PrintKind::Label), ..PLAIN },
    Class { name: "one-color", print: Some(PrintKind::Uniform), needs_color: false, ..PRINTED },
    Class { name: "grey-photo", is_grey: true, ..PRINTED },
    PRINTED,
    Class { name: "harsh-photo", is_harsh: true, ..PRINTED },
    Class { name: "repeated-print", print: Some(PrintKind::Repeated), ..PRINTED },
    Class { name: "wrong-colors", has_wrong_colors: true, needs_color: false, ..PRINTED },
];
/// A tier and a class.
#[derive(Debug, Clone, Copy)]
pub struct Conditions {
    pub tier: Tier,
    pub class: &'static Class,
}

impl Conditions {
    /// The pool of objects. Ambiguous ones are not easy.
    pub fn pool(&self) -> Pool {
        self.class.pool.unwrap_or(self.tier.pick(Pool::Common, Pool::Detailed, Pool::All))
    }
}
