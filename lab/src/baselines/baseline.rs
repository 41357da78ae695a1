//! The names of the methods.

/// A method for comparison.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Baseline {
    /// Fast Global Registration (Zhou, Park, Koltun 2016), on FPFH matches.
    Fgr,
    /// Generalized ICP, plane to plane (Segal, Haehnel, Thrun 2009), starting at the given poses.
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
    /// All methods.
    pub const ALL: [Self; 7] =
        [Self::Fgr, Self::Gicp, Self::IcpPointToPlane, Self::IcpPointToPoint, Self::Ransac, Self::Teaser, Self::Quatro];

    /// The name on the command line.
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

    /// The method with a name.
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|baseline| baseline.as_str() == name)
    }

    /// Whether the method is local: it needs an initial pose near the solution.
    pub fn is_local(self) -> bool {
        matches!(self, Self::Gicp | Self::IcpPointToPlane | Self::IcpPointToPoint)
    }
}
