//! Sampling (paper §3.1): how many points represent the observation and the surface of the generated mesh.

/// Sampling of both clouds.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Sampling {
    /// Maximum number of observed points; more are subsampled evenly at random.
    pub max_points: usize,
    /// Number of points on the surface of the mesh.
    pub surface_samples: usize,
    /// Seed of both draws.
    pub seed: u64,
}

impl Default for Sampling {
    fn default() -> Self {
        Self { max_points: 20_000, surface_samples: 20_000, seed: 0 }
    }
}
