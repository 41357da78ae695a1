//! The error type of all crates: a stable code, the argument, the value found, the value expected, and a remedy.

use core::fmt;
use core::ops::Deref;
use std::borrow::Cow;

use serde::Serialize;

/// Stable error code; does not change between releases.
///
/// In JavaScript it is the `code` of a `Sim3AlignError`, spelled as [`ErrorCode::as_str`] spells it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "SCREAMING_SNAKE_CASE")]
#[cfg_attr(feature = "types", derive(ts_rs::TS))]
#[non_exhaustive]
pub enum ErrorCode {
    /// An argument is missing or of the wrong type. Example: `depth` is a plain array. Pass the type that the message
    /// names.
    InvalidArgument,
    /// An option's value is outside its range. Example: `voxelDivisions: 0`. The message gives the range.
    InvalidOption,
    /// An option that does not exist. Example: `voxelDivision`. The message suggests the most similar name.
    UnknownOption,
    /// The length of an array does not match the sizes given with it. Example: 100 depth values for 640 × 480.
    WrongLength,
    /// An image without pixels. Example: `width: 0`.
    EmptyImage,
    /// Depth and mask differ in size. Resize one, or ask for `resizeMask: "nearest"`.
    SizeMismatch,
    /// Invalid intrinsics. Example: `fx: 0` or `NaN`.
    InvalidCamera,
    /// The mask selects no pixel.
    EmptyMask,
    /// A mask that is a line or single pixels: it shows no shape.
    DegenerateMask,
    /// No pixel of the mask has a depth reading.
    NoDepthInMask,
    /// All readings inside the mask are equal: a placeholder, not a measurement.
    FlatDepth,
    /// Fewer points than the computation needs.
    TooFewPoints,
    /// A mesh without triangles.
    EmptyMesh,
    /// A triangle refers to a vertex that does not exist.
    IndexOutOfRange,
    /// A coordinate is NaN or infinite.
    NonFinite,
    /// A degenerate mesh: zero area, a plane, a needle, or a size outside the supported range.
    DegenerateMesh,
    /// Points that do not determine a similarity: coincident or collinear.
    DegeneratePoints,
    /// The search found no transform that the data support. The identity is never returned instead.
    NoConsensus,
    /// A transform that is not a similarity: scale ≤ 0, a reflection, shear, or not finite.
    InvalidTransform,
    /// A file of an unknown or unsupported format. The message lists the supported ones.
    UnsupportedFormat,
    /// A truncated or inconsistent file.
    CorruptFile,
    /// A file that declares more data than it contains, or data that exceed the limits of this package.
    FileTooLarge,
    /// An 8-bit image where depth is expected: 256 levels are a visualisation of depth, not depth.
    EightBitDepth,
    /// Draco- or meshopt-compressed geometry. The message names a tool that decompresses it.
    CompressedMesh,
    /// A call that needs more memory than there is: 4 GB at most. Crop or reduce the images, or simplify the mesh.
    OutOfMemory,
    /// The worker or the memory in which a tracker lived is gone. Open another one at its last pose.
    TrackerLost,
    /// A bug in this package. Please report it.
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
            Self::DegenerateMask => "DEGENERATE_MASK",
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
            Self::OutOfMemory => "OUT_OF_MEMORY",
            Self::TrackerLost => "TRACKER_LOST",
            Self::Internal => "INTERNAL",
        }
    }
}

/// Text of an error, mostly static.
pub type Text = Cow<'static, str>;

/// An error with a remedy for the user. Dereferences to its [`ErrorParts`].
///
/// Boxed: a `Result` is then hardly larger than its value, and propagating an error moves one word instead of fifteen
/// at some two hundred places.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(transparent)]
pub struct Error(Box<ErrorParts>);

/// The fields of an [`Error`].
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ErrorParts {
    /// The stable code.
    pub code: ErrorCode,
    /// The invalid argument or option, spelled as in JavaScript: `depth`, `mesh.indices`, `options.guard`.
    pub argument: Text,
    /// The value found.
    pub found: Text,
    /// The value expected.
    pub expected: Text,
    /// How to resolve the error.
    pub remedy: Text,
}

impl Deref for Error {
    type Target = ErrorParts;

    fn deref(&self) -> &ErrorParts {
        &self.0
    }
}

impl Error {
    /// An error from its parts.
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

    /// The same error for another argument: the `positions` of a geometry check may be the caller's `mesh.positions`.
    pub fn about(mut self, argument: impl Into<Text>) -> Self {
        self.0.argument = argument.into();
        self
    }

    /// The same error in one of several views: `depth` becomes `views[1].depth`.
    pub fn in_view(self, index: usize) -> Self {
        let argument = format!("views[{index}].{}", self.argument);
        self.about(argument)
    }

    /// The same error with another expected value.
    pub fn expecting(mut self, expected: impl Into<Text>) -> Self {
        self.0.expected = expected.into();
        self
    }

    /// The same error with another code.
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
