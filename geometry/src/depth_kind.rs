//! What the values of a depth map are.

/// What the values of a depth map are, in the words of the field.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Hash)]
pub enum DepthKind {
    /// Distances along the optical axis in a known unit: sensors and metric models.
    #[default]
    Metric,
    /// Distances along the optical axis times an unknown positive factor.
    ScaleInvariant,
    /// Distances along the optical axis times an unknown positive factor, plus an unknown shift.
    AffineInvariant,
    /// Inverse distances times an unknown positive factor, plus an unknown shift: near is large.
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
}
