//! The names of the methods.

use crate::prelude::*;

named! {
    /// A method for comparison.
    pub enum Baseline: "method" {
        /// Fast Global Registration (Zhou, Park, Koltun 2016), on FPFH matches.
        Fgr = "fgr",
        /// Generalized ICP, plane to plane (Segal, Haehnel, Thrun 2009), starting at the given poses.
        Gicp = "gicp",
        /// ICP point to plane (Chen, Medioni 1992), from where the clouds are.
        IcpPointToPlane = "icp-point-to-plane",
        /// ICP point to point (Besl, McKay 1992), from where the clouds are.
        IcpPointToPoint = "icp-point-to-point",
        /// RANSAC on FPFH matches (Rusu, Blodow, Beetz 2009).
        Ransac = "ransac",
        /// TEASER++ (Yang, Shi, Carlone 2021), on FPFH matches.
        Teaser = "teaser",
        /// Quatro (Lim et al. 2022): TEASER++ with a rotation about the known vertical only.
        Quatro = "quatro",
    }
}

impl Baseline {
    /// Whether the method is local: it needs an initial pose near the solution.
    pub fn is_local(self) -> bool {
        matches!(self, Self::Gicp | Self::IcpPointToPlane | Self::IcpPointToPoint)
    }
}
