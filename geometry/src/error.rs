//! The one error type: a stable code, the argument, what was found, what was expected, the remedy.

use core::fmt;
use core::ops::Deref;
use std::borrow::Cow;

use serde::Serialize;

/// What went wrong, as a name that stays the same from release to release.
///
/// In JavaScript it is the `code` of a `Sim3AlignError`, spelled as [`ErrorCode::as_str`] spells it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "SCREAMING_SNAKE_CASE")]
#[cfg_attr(feature = "types", derive(ts_rs::TS))]
#[non_exhaustive]
pub enum ErrorCode {
    /// An argument is missing or of the wrong type. Example: `depth` is a plain array. Pass what the message names.
    InvalidArgument,
    /// An option's value is outside its range. Example: `voxelDivisions: 0`. The message gives the range.
    InvalidOption,
    /// An option that does not exist. Example: `voxelDivision`. The message names the nearest one.
    UnknownOption,
    /// An array's length does not fit the sizes given with it. Example: 100 depth values for 640 × 480.
    WrongLength,
    /// An image without pixels. Example: `width: 0`.
    EmptyImage,
    /// Depth and mask differ in size. Resize one, or ask for `resizeMask: "nearest"`.
    SizeMismatch,
    /// Intrinsics that no camera has. Example: `fx: 0` or `NaN`.
    InvalidCamera,
    /// The mask selects no pixel.
    EmptyMask,
    /// No pixel of the mask has a depth reading.
    NoDepthInMask,
    /// Every reading in the mask is the same number: a placeholder, not a measurement.
    FlatDepth,
    /// Fewer points than the computation needs.
    TooFewPoints,
    /// A mesh without triangles.
    EmptyMesh,
    /// A triangle names a vertex that does not exist.
    IndexOutOfRange,
    /// A coordinate is NaN or infinite.
    NonFinite,
    /// A mesh without area or without volume around it: zero area, a plane, a needle.
    DegenerateMesh,
    /// Points from which a similarity does not follow: coincident or collinear.
    DegeneratePoints,
    /// The search ended without a transform that the data support. No identity is returned in its place.
    NoConsensus,
    /// A transform that is not a similarity: scale ≤ 0, a reflection, shear, or not finite.
    InvalidTransform,
    /// A file whose format is not known or not supported. The message lists those that are.
    UnsupportedFormat,
    /// A file that ends early or contradicts itself.
    CorruptFile,
    /// A file that claims more than it can hold, or more than this package opens.
    FileTooLarge,
    /// An 8-bit image where depth is expected: 256 steps are a picture of depth, not depth.
    EightBitDepth,
    /// Draco- or meshopt-compressed geometry. The message names the tool that unpacks it.
    CompressedMesh,
    /// A fault of this package, not of its input. Please report it.
    Internal,
}

impl ErrorCode {
    /// The code's spelling in JavaScript and in JSON.
    pub fn as_str(self) -> &'static str {
        match self {
            Self::InvalidArgument => "INVALID_ARGUMENT",
            Self::InvalidOption => "INVALID_OPTION",
            Self::UnknownOption => "UNKNOWN_OPTION",
            Self::WrongLength => "WRONG_LENGTH",
            Self::EmptyImage => "EMPTY_IMAGE",
            Self::SizeMismatch => "SIZE_MISMATCH",
            Self::InvalidCamera => "INVALID_CAMERA",
            Self::EmptyMask => "EMPTY_MASK",
            Self::NoDepthInMask => "NO_DEPTH_IN_MASK",
            Self::FlatDepth => "FLAT_DEPTH",
            Self::TooFewPoints => "TOO_FEW_POINTS",
            Self::EmptyMesh => "EMPTY_MESH",
            Self::IndexOutOfRange => "INDEX_OUT_OF_RANGE",
            Self::NonFinite => "NON_FINITE",
            Self::DegenerateMesh => "DEGENERATE_MESH",
            Self::DegeneratePoints => "DEGENERATE_POINTS",
            Self::NoConsensus => "NO_CONSENSUS",
            Self::InvalidTransform => "INVALID_TRANSFORM",
            Self::UnsupportedFormat => "UNSUPPORTED_FORMAT",
            Self::CorruptFile => "CORRUPT_FILE",
            Self::FileTooLarge => "FILE_TOO_LARGE",
            Self::EightBitDepth => "EIGHT_BIT_DEPTH",
            Self::CompressedMesh => "COMPRESSED_MESH",
            Self::Internal => "INTERNAL",
        }
    }
}

/// Text that is most often known beforehand.
pub type Text = Cow<'static, str>;

/// An error that tells its reader what to do. Its [`ErrorParts`] are its fields.
///
/// A pointer: a result is then hardly larger than its value, and handing an error on costs one move instead of
/// fifteen, at some two hundred places.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(transparent)]
pub struct Error(Box<ErrorParts>);

/// What an [`Error`] says.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ErrorParts {
    /// The stable code.
    pub code: ErrorCode,
    /// The argument or option at fault, spelled as in JavaScript: `depth`, `mesh.indices`, `options.guard`.
    pub argument: Text,
    /// What was found.
    pub found: Text,
    /// What was expected.
    pub expected: Text,
    /// What to do about it.
    pub remedy: Text,
}

impl Deref for Error {
    type Target = ErrorParts;

    fn deref(&self) -> &ErrorParts {
        &self.0
    }
}

impl Error {
    /// An error with all its parts.
    #[cold]
    #[inline(never)]
    pub fn new(
        code: ErrorCode,
        argument: impl Into<Text>,
        found: impl Into<Text>,
        expected: impl Into<Text>,
        remedy: impl Into<Text>,
    ) -> Self {
        let (argument, found, expected, remedy) = (argument.into(), found.into(), expected.into(), remedy.into());
        Self(Box::new(ErrorParts { code, argument, found, expected, remedy }))
    }

    /// The same error about another argument: what a geometry check calls `positions`, the caller may know
    /// as `mesh.positions`.
    pub fn about(mut self, argument: impl Into<Text>) -> Self {
        self.0.argument = argument.into();
        self
    }

    /// The same error with other words for what was expected.
    pub fn expecting(mut self, expected: impl Into<Text>) -> Self {
        self.0.expected = expected.into();
        self
    }

    /// The same error under another code.
    pub fn coded(mut self, code: ErrorCode) -> Self {
        self.0.code = code;
        self
    }
}

impl fmt::Display for Error {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: found {}, expected {}. {}", self.argument, self.found, self.expected, self.remedy)
    }
}

impl core::error::Error for Error {}

/// A result of this crate.
pub type Result<T> = core::result::Result<T, Error>;
