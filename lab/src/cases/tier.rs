//! Tiers of difficulty, and classes of cases.

use sim3align_geometry::error::{Error, ErrorCode, Result};

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
    pub(super) fn pick<T>(self, easy: T, medium: T, hard: T) -> T {
        match self {
            Self::Easy => easy,
            Self::Medium => medium,
            Self::Hard => hard,
        }
    }

    /// The share of the object's silhouette that is visible at least.
    pub fn least_visible(self) -> f64 {
        self.pick(0.95, 0.75, 0.55)
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
    ];

    /// The class of a case.
    pub fn of(index: usize) -> Self {
        let classes = Tier::of(index).pick(EASY, MEDIUM, HARD);
        classes[index / 3 % classes.len()]
    }

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
        }
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
