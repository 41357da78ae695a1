//! Sets of cases, tiers of difficulty, and classes of cases.

use crate::prelude::*;

/// A set of classes that are generated together. The sets share no random numbers.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Default)]
pub enum CaseSet {
    /// Errors of segmentation models, depth models and generated meshes.
    #[default]
    General,
    /// Effects of depth sensors and predicted masks.
    Sensors,
    /// Coloured objects, their photos and coloured meshes.
    Colors,
    /// The general set with the errors of outlines that it once had ([`OutlineErrors::Uniform`]), for comparisons.
    Dilated,
}

/// How outlines err in masks and depth maps.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum OutlineErrors {
    /// As on real cases: masks of networks and of annotators, and the edges of sensors and depth models.
    Measured,
    /// Masks are too large or too small by the same distance everywhere, up to three pixels, and the edges of depth are
    /// exact.
    Uniform,
}

/// Tier of difficulty of a case.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Tier {
    /// Good conditions: exact masks, good depth, accurate meshes.
    Easy,
    /// Typical output of current models.
    Medium,
    /// Poor output of current models.
    Hard,
}

/// The property that a case tests, in addition to the errors of its tier.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Class {
    /// No special property.
    Plain,
    /// The object is occluded.
    Occluded,
    /// The image border cuts the object.
    BorderCut,
    /// A few hundred pixels of mask.
    Tiny,
    /// A thin object: spoon, scissors, wrench.
    Thin,
    /// A part, or a piece, that the mesh lacks.
    MissingPart,
    /// Something at the mesh that the object does not have.
    ExtraPart,
    /// A mask with holes, islands, lost and foreign regions.
    RaggedMask,
    /// A mesh that is stretched, bent and warped more than usual.
    Warped,
    /// Depth from a sensor, with many readings missing.
    SparseSensor,
    /// An object that looks almost the same after a half turn: phone, toy car, banana.
    Ambiguous,
    /// Depth from a sensor whose projector stands beside the camera: beside the object, a band of the background that
    /// the camera sees and the projector does not has no reading.
    WideShadow,
    /// No readings on dark, reflective and grazing parts of the object.
    Holes,
    /// The holes of [`Class::Holes`], which the mask does not contain either.
    MaskOfReadings,
    /// A bar in front of the object cuts the mask in two; in half of the cases, one part has no reading.
    SplitMask,
    /// Depth in steps of millimetres that grow with its square, as disparities in steps give it.
    Quantised,
    /// A mask with smooth errors of its outline and small islands, as a segmentation network predicts it.
    PredictedMask,
    /// Depth of a stereo camera: edges that move in and out by pixels, bumps.
    ActiveStereo,
    /// Depth from a projected pattern: eroded edges, shadows on one side, steps.
    StructuredLight,
    /// Depth from the time of light: readings between object and background.
    TimeOfFlight,
    /// Depth of a model: ramps from object to background.
    PredictedDepth,
    /// A mask enlarged from few logits.
    NetworkMask,
    /// A polygon.
    AnnotatedMask,
    /// A symmetric shape whose print alone tells how it is turned.
    Printed,
    /// A symmetric shape of two colours or with blots.
    Blotted,
    /// A shape that tells how it is turned, with a print.
    PrintedShape,
    /// One colour: it tells nothing.
    OneColor,
    /// A mesh with the colours of another object.
    WrongColors,
    /// [`Class::Printed`] in a grey photo.
    GreyPhoto,
}

const EASY: &[Class] = &[Class::Plain];
const MEDIUM: &[Class] = &[
    Class::Plain,
    Class::Occluded,
    Class::Thin,
    Class::Plain,
    Class::SparseSensor,
    Class::RaggedMask,
    Class::BorderCut,
    Class::Plain,
    Class::Occluded,
    Class::MissingPart,
];
const HARD: &[Class] = &[
    Class::Plain,
    Class::Occluded,
    Class::RaggedMask,
    Class::MissingPart,
    Class::Tiny,
    Class::BorderCut,
    Class::Warped,
    Class::SparseSensor,
    Class::Thin,
    Class::Ambiguous,
    Class::Occluded,
    Class::ExtraPart,
];
/// Of every tier.
const SENSORS: &[Class] = &[
    Class::WideShadow,
    Class::Holes,
    Class::MaskOfReadings,
    Class::SplitMask,
    Class::Quantised,
    Class::PredictedMask,
    Class::ActiveStereo,
    Class::StructuredLight,
    Class::TimeOfFlight,
    Class::PredictedDepth,
    Class::NetworkMask,
    Class::AnnotatedMask,
];

/// Of every tier.
const COLORS: &[Class] = &[
    Class::Printed,
    Class::PrintedShape,
    Class::Blotted,
    Class::Printed,
    Class::OneColor,
    Class::GreyPhoto,
    Class::Printed,
    Class::WrongColors,
];

impl CaseSet {
    /// All sets.
    pub const ALL: &[Self] = &[Self::General, Self::Sensors, Self::Colors, Self::Dilated];

    /// The set's name.
    pub fn as_str(self) -> &'static str {
        match self {
            Self::General => "general",
            Self::Sensors => "sensors",
            Self::Colors => "colors",
            Self::Dilated => "dilated",
        }
    }

    /// The set of a name.
    ///
    /// # Errors
    /// [`ErrorCode::InvalidOption`] for any other.
    pub fn from_name(name: &str) -> Result<Self> {
        named(Self::ALL, Self::as_str, "set", name)
    }

    /// The class of a case of this set.
    pub fn class(self, index: usize) -> Class {
        let classes = match self {
            Self::General | Self::Dilated => Tier::of(index).pick(EASY, MEDIUM, HARD),
            Self::Sensors => SENSORS,
            Self::Colors => COLORS,
        };
        classes[index / 3 % classes.len()]
    }

    /// The errors of outlines.
    pub(super) fn outlines(self) -> OutlineErrors {
        if self == Self::Dilated { OutlineErrors::Uniform } else { OutlineErrors::Measured }
    }
}

impl Tier {
    /// All tiers.
    pub const ALL: &[Self] = &[Self::Easy, Self::Medium, Self::Hard];

    /// The tier of a case.
    pub fn of(index: usize) -> Self {
        [Self::Easy, Self::Medium, Self::Hard][index % 3]
    }

    /// The tier's name.
    pub fn as_str(self) -> &'static str {
        match self {
            Self::Easy => "easy",
            Self::Medium => "medium",
            Self::Hard => "hard",
        }
    }

    /// The tier of a name.
    ///
    /// # Errors
    /// [`ErrorCode::InvalidOption`] for any other.
    pub fn from_name(name: &str) -> Result<Self> {
        named(Self::ALL, Self::as_str, "tier", name)
    }

    /// One of three values.
    pub fn pick<T>(self, easy: T, medium: T, hard: T) -> T {
        match self {
            Self::Easy => easy,
            Self::Medium => medium,
            Self::Hard => hard,
        }
    }

    /// The share of the object's silhouette that is visible at least.
    pub fn least_visible(self, class: Class) -> f64 {
        let easy = if class == Class::SplitMask { 0.8 } else { 0.95 };
        self.pick(easy, 0.75, 0.55)
    }
}

impl Class {
    /// All classes.
    pub const ALL: &[Self] = &[
        Self::Plain,
        Self::Occluded,
        Self::BorderCut,
        Self::Tiny,
        Self::Thin,
        Self::MissingPart,
        Self::ExtraPart,
        Self::RaggedMask,
        Self::Warped,
        Self::SparseSensor,
        Self::Ambiguous,
        Self::WideShadow,
        Self::Holes,
        Self::MaskOfReadings,
        Self::SplitMask,
        Self::Quantised,
        Self::PredictedMask,
        Self::ActiveStereo,
        Self::StructuredLight,
        Self::TimeOfFlight,
        Self::PredictedDepth,
        Self::NetworkMask,
        Self::AnnotatedMask,
        Self::Printed,
        Self::Blotted,
        Self::PrintedShape,
        Self::OneColor,
        Self::WrongColors,
        Self::GreyPhoto,
    ];

    /// The class's name.
    pub fn as_str(self) -> &'static str {
        match self {
            Self::Plain => "plain",
            Self::Occluded => "occluded",
            Self::BorderCut => "border-cut",
            Self::Tiny => "tiny",
            Self::Thin => "thin",
            Self::MissingPart => "missing-part",
            Self::ExtraPart => "extra-part",
            Self::RaggedMask => "ragged-mask",
            Self::Warped => "warped",
            Self::SparseSensor => "sparse-sensor",
            Self::Ambiguous => "ambiguous",
            Self::WideShadow => "wide-shadow",
            Self::Holes => "holes",
            Self::MaskOfReadings => "mask-of-readings",
            Self::SplitMask => "split-mask",
            Self::Quantised => "quantised",
            Self::PredictedMask => "predicted-mask",
            Self::ActiveStereo => "active-stereo",
            Self::StructuredLight => "structured-light",
            Self::TimeOfFlight => "time-of-flight",
            Self::PredictedDepth => "predicted-depth",
            Self::NetworkMask => "network-mask",
            Self::AnnotatedMask => "annotated-mask",
            Self::Printed => "printed",
            Self::Blotted => "blotted",
            Self::PrintedShape => "printed-shape",
            Self::OneColor => "one-color",
            Self::WrongColors => "wrong-colors",
            Self::GreyPhoto => "grey-photo",
        }
    }

    /// Whether the class needs the depth of a sensor instead of a depth model's.
    pub(super) fn needs_sensor(self) -> bool {
        let of_masks = matches!(self, Self::PredictedMask | Self::NetworkMask | Self::AnnotatedMask);
        SENSORS.contains(&self) && !of_masks && self != Self::PredictedDepth
    }

    /// Whether the edges of its depth are as measured. The others have effects of their own on an exact map.
    pub(super) fn has_measured_edges(self) -> bool {
        !matches!(
            self,
            Self::WideShadow
                | Self::Holes
                | Self::MaskOfReadings
                | Self::SplitMask
                | Self::Quantised
                | Self::PredictedMask
        )
    }

    /// Whether the shape is symmetric, so that at most its print tells how it is turned.
    pub(super) fn is_symmetric(self) -> bool {
        self.is_colored() && self != Self::PrintedShape
    }

    /// Whether its objects are coloured.
    pub(super) fn is_colored(self) -> bool {
        COLORS.contains(&self)
    }

    /// Whether colour alone determines which turn of a symmetric shape is right.
    pub(super) fn is_told_by_color(self) -> bool {
        matches!(self, Self::Printed | Self::Blotted | Self::GreyPhoto)
    }

    /// The class of a name.
    ///
    /// # Errors
    /// [`ErrorCode::InvalidOption`] for any other.
    pub fn from_name(name: &str) -> Result<Self> {
        named(Self::ALL, Self::as_str, "class", name)
    }
}

fn named<T: Copy>(all: &[T], as_str: fn(T) -> &'static str, argument: &'static str, name: &str) -> Result<T> {
    all.iter().copied().find(|&value| as_str(value) == name).ok_or_else(|| {
        let names: Vec<&str> = all.iter().map(|&value| as_str(value)).collect();
        let remedy = "Pass one of these, or several with commas between them.";
        Error::new(ErrorCode::InvalidOption, argument, format!("{name:?}"), names.join(" or "), remedy)
    })
}
