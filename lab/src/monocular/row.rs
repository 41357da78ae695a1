//! The rows of the monocular set: what a model gets wrong, and what is said of its map.

use super::faults::{Bend, Faults, FocalFault, Output};
use crate::prelude::*;
use sim3align_geometry::depth_kind::DepthKind;

named! {
    /// A row of the tables: one kind of map.
    pub enum Row: "row" {
        /// As it was measured, without holes.
        Filled = "filled",
        /// 15 % too near or far, said to be metric.
        Scaled = "scaled",
        /// The same, said to be known up to scale.
        ScaleInvariant = "scale-invariant",
        /// Shifted by 12 % of the distance and scaled, said to be affine-invariant.
        Shifted = "shifted",
        /// The same shift without the factor, said to be metric.
        ShiftedMetric = "shifted-metric",
        /// Inverse depth from 0 to 1 over the image, of 16 bits.
        Disparity = "disparity",
        /// The same of 8 bits.
        Disparity8 = "disparity-8",
        /// The map of [`Row::Disparity`], turned into depth by a guess of near and far, and said to be metric.
        DisparityGuessed = "disparity-guessed",
        /// Bent by 2 %.
        Bent = "bent",
        /// Blurred across edges.
        Blurred = "blurred",
        /// The same by a model whose output is inverse depth.
        BlurredDisparity = "blurred-disparity",
        /// A little of each.
        Mild = "mild",
        /// Right depth, with a focal length that is 15 to 18 % wrong, and doubted.
        FocalWrong = "focal-wrong",
        /// Right depth, without a focal length.
        FocalUnknown = "focal-unknown",
        /// [`Row::Disparity`] without a focal length.
        DisparityFocalUnknown = "disparity-focal-unknown",
    }
}

/// Near and far, metres, that a user guesses for a relative map of a table.
pub const GUESSED_RANGE_M: [f64; 2] = [0.3, 5.0];

impl Row {
    /// What is said of the map.
    pub fn kind(self) -> DepthKind {
        match self {
            Self::ScaleInvariant => DepthKind::ScaleInvariant,
            Self::Shifted => DepthKind::AffineInvariant,
            Self::Disparity | Self::Disparity8 | Self::DisparityFocalUnknown => DepthKind::AffineInvariantDisparity,
            _ => DepthKind::Metric,
        }
    }

    /// The row whose draws it has: rows that differ in what is said of a map alone get the same map.
    fn drawn_as(self) -> Self {
        match self {
            Self::ScaleInvariant => Self::Scaled,
            Self::ShiftedMetric => Self::Shifted,
            Self::Disparity8 | Self::DisparityGuessed | Self::DisparityFocalUnknown => Self::Disparity,
            Self::BlurredDisparity => Self::Blurred,
            other => other,
        }
    }

    /// The errors of the map of an image; the same for the same seed.
    pub(super) fn faults(self, seed: u64) -> Faults {
        let random = &mut Random::new(seed, self.drawn_as() as u64);
        let none = Faults::none();
        let ramp = between(random, 2.0, 4.0);
        match self {
            Self::Filled => none,
            Self::Scaled | Self::ScaleInvariant => Faults { factor: 1.0 + 0.15 * sign(random), ..none },
            Self::Shifted | Self::ShiftedMetric => {
                let shift = 0.12 * sign(random);
                let factor = libm::exp(between(random, libm::log(0.3), libm::log(3.0)));
                Faults { shift, factor: if self == Self::Shifted { factor } else { 1.0 }, ..none }
            }
            Self::Disparity | Self::DisparityFocalUnknown | Self::Disparity8 => {
                let bits = if self == Self::Disparity8 { 8 } else { 16 };
                let focal = if self == Self::DisparityFocalUnknown { FocalFault::Unknown } else { FocalFault::None };
                Faults { output: Output::Disparity { bits }, ramp, focal, ..none }
            }
            Self::DisparityGuessed => Faults { output: Output::GuessedDepth { bits: 16 }, ramp, ..none },
            Self::Bent => Faults { bend: Some(Bend::draw(0.02, random)), ..none },
            Self::Blurred => Faults { blur: 1.0 / 40.0, ramp, ..none },
            Self::BlurredDisparity => Faults { blur: 1.0 / 40.0, ramp, is_inverse: true, ..none },
            Self::Mild => Faults {
                factor: 1.0 + 0.06 * sign(random),
                shift: 0.04 * sign(random),
                bend: Some(Bend::draw(0.007, random)),
                blur: 1.0 / 100.0,
                ramp: 2.0,
                focal: FocalFault::Wrong(1.0 + 0.05 * sign(random)),
                ..none
            },
            Self::FocalWrong => {
                let much = between(random, 1.15, 1.18);
                Faults { focal: FocalFault::Wrong(if chance(random, 0.5) { much } else { 2.0 - much }), ..none }
            }
            Self::FocalUnknown => Faults { focal: FocalFault::Unknown, ..none },
        }
    }
}
