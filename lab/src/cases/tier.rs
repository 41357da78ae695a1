//! Sets of cases, tiers of difficulty, and classes of cases.

use crate::prelude::*;

named! {
    /// A set of classes that are generated together. The sets share no random numbers.
    #[derive(Default)]
    pub enum CaseSet: "set" {
        /// Errors of segmentation models, depth models and generated meshes.
        #[default]
        General = "general",
        /// Effects of depth sensors and predicted masks.
        Sensors = "sensors",
        /// Coloured objects, their photos and coloured meshes.
        Colors = "colors",
        /// The general set with the errors of outlines that it once had ([`OutlineErrors::Uniform`]), for comparisons.
        Dilated = "dilated",
        /// Exact depth, of which [`Prediction`](crate::monocular::prediction::Prediction) makes what a depth model gives;
        /// masks and meshes as in the general set.
        Monocular = "monocular",
    }
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

named! {
    /// Tier of difficulty of a case.
    pub enum Tier: "tier" {
        /// Good conditions: exact masks, good depth, accurate meshes.
        Easy = "easy",
        /// Typical output of current models.
        Medium = "medium",
        /// Poor output of current models.
        Hard = "hard",
    }
}

named! {
    /// The property that a case tests, in addition to the errors of its tier.
    pub enum Class: "class" {
        /// No special property.
        Plain = "plain",
        /// The object is occluded.
        Occluded = "occluded",
        /// The image border cuts the object.
        BorderCut = "border-cut",
        /// A few hundred pixels of mask.
        Tiny = "tiny",
        /// A thin object: spoon, scissors, wrench.
        Thin = "thin",
        /// A part, or a piece, that the mesh lacks.
        MissingPart = "missing-part",
        /// Something at the mesh that the object does not have.
        ExtraPart = "extra-part",
        /// A mask with holes, islands, lost and foreign regions.
        RaggedMask = "ragged-mask",
        /// A mesh that is stretched, bent and warped more than usual.
        Warped = "warped",
        /// Depth from a sensor, with many readings missing.
        SparseSensor = "sparse-sensor",
        /// An object that looks almost the same after a half turn: phone, toy car, banana.
        Ambiguous = "ambiguous",
        /// Depth from a sensor whose projector stands beside the camera: beside the object, a band of the background that
        /// the camera sees and the projector does not has no reading.
        WideShadow = "wide-shadow",
        /// No readings on dark, reflective and grazing parts of the object.
        Holes = "holes",
        /// The holes of [`Class::Holes`], which the mask does not contain either.
        MaskOfReadings = "mask-of-readings",
        /// A bar in front of the object cuts the mask in two; in half of the cases, one part has no reading.
        SplitMask = "split-mask",
        /// Depth in steps of millimetres that grow with its square, as disparities in steps give it.
        Quantised = "quantised",
        /// A mask with smooth errors of its outline and small islands, as a segmentation network predicts it.
        PredictedMask = "predicted-mask",
        /// Depth of a stereo camera: edges that move in and out by pixels, bumps.
        ActiveStereo = "active-stereo",
        /// Depth from a projected pattern: eroded edges, shadows on one side, steps.
        StructuredLight = "structured-light",
        /// Depth from the time of light: readings between object and background.
        TimeOfFlight = "time-of-flight",
        /// Depth of a model: ramps from object to background.
        PredictedDepth = "predicted-depth",
        /// A mask enlarged from few logits.
        NetworkMask = "network-mask",
        /// A polygon.
        AnnotatedMask = "annotated-mask",
        /// A symmetric shape whose print alone tells how it is turned.
        Printed = "printed",
        /// A symmetric shape of two colours or with blots.
        Blotted = "blotted",
        /// A shape that tells how it is turned, with a print.
        PrintedShape = "printed-shape",
        /// One colour: it tells nothing.
        OneColor = "one-color",
        /// A mesh with the colours of another object.
        WrongColors = "wrong-colors",
        /// [`Class::Printed`] in a grey photo.
        GreyPhoto = "grey-photo",
    }
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

/// Of every tier but the easy one, whose class is [`Class::Plain`].
const MONOCULAR: &[Class] = &[
    Class::Plain,
    Class::Occluded,
    Class::Thin,
    Class::Plain,
    Class::RaggedMask,
    Class::BorderCut,
    Class::Plain,
    Class::MissingPart,
    Class::Tiny,
    Class::Warped,
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
    /// The class of a case of this set.
    pub fn class(self, index: usize) -> Class {
        let classes = match self {
            Self::General | Self::Dilated => Tier::of(index).pick(EASY, MEDIUM, HARD),
            Self::Monocular => Tier::of(index).pick(EASY, MONOCULAR, MONOCULAR),
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
    /// The tier of a case.
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

    /// The share of the object's silhouette that is visible at least.
    pub fn least_visible(self, class: Class) -> f64 {
        let easy = if class == Class::SplitMask { 0.8 } else { 0.95 };
        self.pick(easy, 0.75, 0.55)
    }
}

impl Class {
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
}
