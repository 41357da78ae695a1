//! What the values of a depth map are.

use serde::Serialize;

/// What the values d of a depth map say of the depth z.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum DepthKind {
    /// z = d, in metres.
    #[default]
    Metric,
    /// z = s·d with an unknown scale s.
    ScaleInvariant,
    /// z = s·(d + t) with unknown s and t.
    AffineInvariant,
    /// z = s / (d + t) with unknown s and t: larger values are nearer.
    AffineInvariantDisparity,
}

impl DepthKind {
    /// Whether the shift t is unknown.
    pub fn is_affine(self) -> bool {
        matches!(self, Self::AffineInvariant | Self::AffineInvariantDisparity)
    }
}
