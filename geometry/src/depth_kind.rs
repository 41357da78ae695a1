//! Kinds of depth values: metric, or relative up to scale and shift.

use serde::{Serialize, Serializer};

/// The relation of the values d of a depth map to the depth z along the optical axis, in the words of the field.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Hash)]
pub enum DepthKind {
    /// z = d, in a known unit: sensors and metric models.
    #[default]
    Metric,
    /// z = s·d with an unknown scale s above 0.
    ScaleInvariant,
    /// z = s·(d + t) with unknown s and shift t.
    AffineInvariant,
    /// z = s / (d + t) with unknown s and t: near is large.
    AffineInvariantDisparity,
}

impl DepthKind {
    /// All kinds, the default first.
    pub const ALL: [Self; 4] =
        [Self::Metric, Self::ScaleInvariant, Self::AffineInvariant, Self::AffineInvariantDisparity];

    /// The kind's name in JavaScript and in JSON.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Metric => "metric",
            Self::ScaleInvariant => "scale-invariant",
            Self::AffineInvariant => "affine-invariant",
            Self::AffineInvariantDisparity => "affine-invariant-disparity",
        }
    }

    /// The kind of this name; `None` for any other text.
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|kind| kind.name() == name)
    }

    /// Whether z is in metres.
    pub fn is_metric(self) -> bool {
        self == Self::Metric
    }

    /// Whether the shift t is unknown.
    pub fn is_affine(self) -> bool {
        matches!(self, Self::AffineInvariant | Self::AffineInvariantDisparity)
    }
}

impl Serialize for DepthKind {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_str(self.name())
    }
}
