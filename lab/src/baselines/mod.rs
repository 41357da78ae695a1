//! Other methods for the same task, to compare with: each as published, on the crate's own clouds and solvers.
//!
//! All are rigid but TEASER, which can estimate the scale. Where they need descriptors, normals or a voxel grid, they
//! get those of the paper's method, so that a comparison is one of methods and not of preprocessing.

pub mod align;
pub mod clique;
mod clouds;
pub mod fgr;
pub mod gicp;
pub mod gnc;
pub mod icp;
pub mod measurements;
mod pair;
pub mod quatro;
pub mod teaser;
pub mod voting;

pub use clouds::{Clouds, Solved, UnitSettings};
pub use pair::{PairSettings, register_pair};

/// A method to compare with.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Baseline {
    /// Fast Global Registration (Zhou, Park, Koltun 2016), on FPFH matches.
    Fgr,
    /// Generalized ICP, plane to plane (Segal, Haehnel, Thrun 2009), from where the clouds are.
    Gicp,
    /// ICP point to plane (Chen, Medioni 1992), from where the clouds are.
    IcpPointToPlane,
    /// ICP point to point (Besl, McKay 1992), from where the clouds are.
    IcpPointToPoint,
    /// RANSAC on FPFH matches (Rusu, Blodow, Beetz 2009).
    Ransac,
    /// TEASER++ (Yang, Shi, Carlone 2021), on FPFH matches.
    Teaser,
    /// Quatro (Lim et al. 2022): TEASER++ with a rotation about the known vertical only.
    Quatro,
}

impl Baseline {
    /// All of them.
    pub const ALL: [Self; 7] =
        [Self::Fgr, Self::Gicp, Self::IcpPointToPlane, Self::IcpPointToPoint, Self::Ransac, Self::Teaser, Self::Quatro];

    /// The name that a user writes.
    pub fn as_str(self) -> &'static str {
        match self {
            Self::Fgr => "fgr",
            Self::Gicp => "gicp",
            Self::IcpPointToPlane => "icp-point-to-plane",
            Self::IcpPointToPoint => "icp-point-to-point",
            Self::Ransac => "ransac",
            Self::Teaser => "teaser",
            Self::Quatro => "quatro",
        }
    }

    /// The method of that name.
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|baseline| baseline.as_str() == name)
    }

    /// Whether it only finds the pose near the one it starts from.
    pub fn is_local(self) -> bool {
        matches!(self, Self::Gicp | Self::IcpPointToPlane | Self::IcpPointToPoint)
    }
}
