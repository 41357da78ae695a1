//! Sampling (paper §3.1): how many points represent the observation and the surface of the generated mesh.

/// Number of points from which metrics measure by default. On real objects, a mean over them is within half a per cent of that over
/// twenty thousand.
pub const MEASURED: usize = 2048;

/// Sampling of both clouds.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Sampling {
    /// Maximum number of observed points; more are subsampled evenly at random.
    pub max_points: usize,
    /// Number of points on the surface of the mesh.
    pub surface_samples: usize,
    /// Number of points of each cloud, evenly spread, from which metrics measure; all, if there are no more.
    pub measured: usize,
    /// Seed of both draws.
    pub seed: u64,
}

impl Default for Sampling {
    fn default() -> Self {
        Self { max_points: 20_000, surface_samples: 20_000, measured: MEASURED, seed: 0 }
    }
}
