//! Warnings about inputs and results that are valid but suspicious.

use crate::evidence::observation::Observation;
use crate::geometry::order::median;
use crate::number::number;
use crate::precise::drawing::removed_parts::RemovedParts;
use crate::report::Preset;
use crate::report::{ScoreTerms, Warning, WarningCode, is_collapsed};

/// Median depth of an object and its size, metres, above which the depth is probably in another unit, such as millimetres: also
/// in one that is stated.
const IMPLAUSIBLE_M: [f64; 2] = [20.0, 3.0];

/// The same below, as of depth that was converted from millimetres twice.
const TOO_SMALL_M: [f64; 2] = [0.05, 0.001];

/// Share of the image beyond which a mask probably selects everything instead of an object.
const WHOLE_IMAGE: f64 = 0.99;

/// Share of the border's pixels beyond which a mask is probably that of the background.
const WHOLE_BORDER: f64 = 0.8;

/// Size of an object, metres, beyond which an assumed unit is doubtful: for depth in whole millimetres, which was probably stored as
/// integers of an unstated unit, and for other depth. Real objects (48) have up to 0.3 and 0.96, generated chairs up to 1.43.
const LARGE_M: [f64; 2] = [0.6, 1.5];
/// The same of its distance.
const NEAR_M: f64 = 0.15;
/// Difference from a whole number of millimetres that rounding explains.
const ROUNDING_MM: f32 = 0.01;

/// The distance of pixels inside the mask from those outside that are compared, relative to the width of the object: edges of
/// depth are a few pixels off or wide.
const ACROSS: f64 = 0.1;
/// The difference of depth that makes a step, and the least share of the pairs that have one.
const STEP: f32 = 0.05;
const STEPS: f64 = 0.04;
/// Share of the steps towards the camera from which on depth looks inverted. Of 46 real objects, it is up to 0.88, where something
/// hides most of the object; in 1/z, it is above 0.9 for 36 of them.
const TOWARDS_CAMERA: f64 = 0.9;

/// The largest values of maps that were normalised to the range from 0: floats, and integers of 16 bits as millimetres.
const FULL_RANGE_M: [f32; 2] = [1.0, 65.535];
/// Largest share of their pixels that is 0. Of sensors, which lack readings, it is 3 to 98 %.
const FEW_ZEROS: f64 = 1e-3;

/// What warnings about an observation depend on.
struct Facts<'a> {
    observation: &'a Observation,
    mask_pixels: usize,
    /// Pixels of the mask on the border of the image.
    border_pixels: usize,
    /// Pixels of the mask with a reading.
    readings: usize,
    /// The median of the readings, metres; `None` without readings.
    median_m: Option<f32>,
    /// Whether all readings are whole millimetres.
    are_whole: bool,
}

/// Warnings about depth and mask.
pub fn about_observation(observation: &Observation) -> Vec<Warning> {
    let facts = Facts::of(observation);
    let mut warnings = Vec::new();
    warnings.extend(facts.about_lengths());
    add(&mut warnings, WarningCode::DepthLooksInverted, facts.about_inverted_depth());
    add(&mut warnings, WarningCode::DepthLooksNormalised, facts.about_normalised_depth());
    add(&mut warnings, WarningCode::MaskLooksInverted, facts.about_inverted_mask());
    add(&mut warnings, WarningCode::MaskCoversImage, facts.about_whole_image());
    add(&mut warnings, WarningCode::MaskTouchesBorder, facts.about_border());
    add(&mut warnings, WarningCode::SparseDepth, facts.about_sparse_depth());
    warnings
}

#[inline(never)]
fn add(warnings: &mut Vec<Warning>, code: WarningCode, message: Option<String>) {
    warnings.extend(message.map(|message| Warning { code, message }));
}

impl<'a> Facts<'a> {
    fn of(observation: &'a Observation) -> Self {
        let (width, height) = (observation.mask().width(), observation.mask().height());
        // Allocated once: it may be a large image.
        let mask_pixels = observation.pixels().count();
        let mut depths = Vec::with_capacity(mask_pixels);
        let mut border_pixels = 0;
        for i in observation.pixels() {
            let (u, v, z) = (i % width, i / width, observation.depth().data()[i]);
            border_pixels += usize::from(u == 0 || v == 0 || u + 1 == width || v + 1 == height);
            if z > 0.0 {
                depths.push(z);
            }
        }

        let (readings, are_whole) = (depths.len(), depths.iter().all(is_whole));
        Self { observation, mask_pixels, border_pixels, readings, are_whole, median_m: median(depths.into_iter()) }
    }

    fn image_pixels(&self) -> usize {
        self.observation.mask().data().len()
    }

    fn covers_image(&self) -> bool {
        self.mask_pixels as f64 >= WHOLE_IMAGE * self.image_pixels() as f64
    }

    fn is_mask_inverted(&self) -> bool {
        let (width, height) = (self.observation.mask().width(), self.observation.mask().height());
        let border = if width.min(height) > 2 { 2 * (width + height) - 4 } else { self.image_pixels() };
        !self.covers_image() && self.border_pixels as f64 > WHOLE_BORDER * border as f64
    }

    /// The median depth of the object, and its size across the image, metres.
    fn lengths(&self) -> Option<[f64; 2]> {
        let distance = f64::from(self.median_m?);
        let pixels = self.observation.bounds().map(|[first, last]| (last - first) as f64);
        let camera = self.observation.camera();
        Some([distance, distance * ((pixels[0] / camera.fx).powi(2) + (pixels[1] / camera.fy).powi(2)).sqrt()])
    }

    fn about_lengths(&self) -> Option<Warning> {
        let [distance, size] = self.lengths()?;
        let (code, remedy) = if distance > IMPLAUSIBLE_M[0] || size > IMPLAUSIBLE_M[1] {
            (WarningCode::DepthLooksLikeMillimetres, "0.001 for millimetres; floats in millimetres have it, too.")
        } else if distance < TOO_SMALL_M[0] || size < TOO_SMALL_M[1] {
            (WarningCode::DepthLooksTooSmall, "1 for metres.")
        } else if size >= LARGE_M[usize::from(!self.are_whole)] || distance <= NEAR_M {
            (WarningCode::SizeDoubtful, "0.01 for centimetres, 0.0002 for TUM RGB-D.")
        } else {
            return None;
        };
        let [size, distance] = [size, distance].map(number);
        let message = format!(
            "By the unit of the depth, the object is {size} m large, {distance} m away. If it is not, pass depthScale, metres per unit: {remedy}"
        );
        Some(Warning { code, message })
    }

    fn about_inverted_depth(&self) -> Option<String> {
        let share = steps_towards_camera(self.observation, self.mask_pixels)?;
        if share < TOWARDS_CAMERA || self.is_mask_inverted() {
            return None;
        }
        let message = format!(
            "{} % of the steps of the depth at the object's outline go towards the camera: the object seems to be behind its surroundings. If near is large in this depth map, pass depthKind \"affine-invariant-disparity\".",
            number((100.0 * share).round())
        );
        Some(message)
    }

    fn about_normalised_depth(&self) -> Option<String> {
        let message = "The depth map spans exactly the range from 0 to 1, or that of 16 bits, as one that was normalised: its values are no lengths. Pass depthKind \"affine-invariant-disparity\" if near is large in it, otherwise \"affine-invariant\".";
        looks_normalised(self.observation.depth().data()).then_some(message.into())
    }

    fn about_inverted_mask(&self) -> Option<String> {
        let message = "The mask covers the border of the image: it seems to be that of the background. Invert it.";
        self.is_mask_inverted().then_some(message.into())
    }

    fn about_whole_image(&self) -> Option<String> {
        let [mask, image] = [self.mask_pixels, self.image_pixels()];
        let message = || {
            format!(
                "The mask covers {mask} of the image's {image} pixels: it selects everything, not an object. It may be inverted, or not a mask."
            )
        };
        self.covers_image().then(message)
    }

    fn about_border(&self) -> Option<String> {
        let message = "The mask touches the image border: part of the object may be outside the image, and the initial scale may be too small.";
        (self.border_pixels > 0).then_some(message.into())
    }

    fn about_sparse_depth(&self) -> Option<String> {
        let [readings, mask] = [self.readings, self.mask_pixels];
        let message = || {
            format!(
                "Only {readings} of the mask's {mask} pixels have a depth reading; the pose depends on these alone."
            )
        };
        (2 * readings < mask).then(message)
    }
}

/// Whether a depth map was normalised to the range from 0: its maximum is the end of the range, and few pixels are 0. If many are 0,
/// as where a sensor has no readings, few pixels are exactly 1, and not all values are whole millimetres.
fn looks_normalised(depth: &[f32]) -> bool {
    let few = |is: &dyn Fn(f32) -> bool| {
        let count = depth.iter().filter(|z| is(**z)).count();
        count > 0 && count as f64 <= FEW_ZEROS * depth.len() as f64
    };
    // Depths are not negative: their bits are in the same order, and compared several at once.
    let most = f32::from_bits(depth.iter().fold(0, |most, z| most.max(z.to_bits())));
    FULL_RANGE_M.contains(&most)
        && (few(&|z| z <= 0.0) || (most == FULL_RANGE_M[0] && few(&|z| z == most) && !depth.iter().all(is_whole)))
}

/// Whether a depth is a whole number of millimetres within the rounding of f32.
fn is_whole(z: &f32) -> bool {
    (1000.0 * z - (1000.0 * z).round()).abs() < ROUNDING_MM
}

/// The share of the steps of the depth out of the mask that go towards the camera; `None` if there are few steps.
fn steps_towards_camera(observation: &Observation, mask_pixels: usize) -> Option<f64> {
    let (mask, depth) = (observation.mask().data(), observation.depth().data());
    let width = observation.mask().width();
    let across = (ACROSS * (mask_pixels as f64).sqrt()) as usize + 1;
    let [mut pairs, mut nearer, mut farther] = [0.0; 3];
    let [columns, rows] = observation.bounds().map(|[low, high]| low.saturating_sub(across)..=high);
    for i in rows.flat_map(|v| columns.clone().map(move |u| v * width + u)) {
        let aside = if i % width + across < width { i + across } else { mask.len() };
        for j in [aside, i + across * width] {
            let Some((other, other_depth)) = mask.get(j).zip(depth.get(j)) else { continue };
            let is_inside = mask[i] != 0;
            if is_inside == (*other != 0) || depth[i] <= 0.0 || *other_depth <= 0.0 {
                continue;
            }
            let ratio = if is_inside { other_depth / depth[i] } else { depth[i] / other_depth };
            pairs += 1.0;
            nearer += f64::from(u8::from(ratio < 1.0 - STEP));
            farther += f64::from(u8::from(ratio > 1.0 + STEP));
        }
    }
    let steps = nearer + farther;
    (steps > STEPS * pairs).then(|| nearer / steps)
}

/// A warning about the scale. The initial scale includes every reading in the mask, also background by mistake: a scale
/// far below it is a collapse for the paper's method, which starts there, but not for `precise`.
pub fn about_scale(scale_ratio: f64, clamped: bool, preset: Preset) -> Option<Warning> {
    let precise = preset == Preset::Precise;
    if is_collapsed(scale_ratio) && !precise {
        let message = format!("The scale collapsed to {} of the initial one. Set options.guard.", number(scale_ratio));
        return Some(Warning { code: WarningCode::ScaleCollapsed, message });
    }
    clamped.then(|| Warning {
        code: WarningCode::ScaleClamped,
        message: if precise {
            "The scale was held at a bound of options.scale; the observation fits a scale beyond it better.".into()
        } else {
            format!(
                "The scale was held at {} of the initial one by options.guard; the matches fit another scale better.",
                number(scale_ratio)
            )
        },
    })
}

/// Product of the agreements of silhouette and depth below which the mesh is doubtful. Of generated cases with the mesh
/// of another object 94 % are below, of right poses .5 %.
const DOUBTFUL: f64 = 0.58;

/// A warning about a mesh that does not fit in any pose.
pub fn about_fit(terms: &ScoreTerms) -> Option<Warning> {
    (terms.overlap * terms.depth < DOUBTFUL).then(|| Warning {
        code: WarningCode::MeshDoubtful,
        message: format!(
            "Even the best pose explains the observation poorly (overlap {}, depth agreement {}; 1 is perfect). Check that the mesh shows the object of the mask, and that mask, depth and camera belong together.",
            number(terms.overlap),
            number(terms.depth)
        ),
    })
}

/// A warning about parts of the mesh that are left out.
pub fn about_mesh(removed_parts: &RemovedParts) -> Option<Warning> {
    let &RemovedParts { floating, inside, ground } = removed_parts;
    let plate = (usize::from(ground > 0.0), ground);
    let mut named = String::new();
    for ((count, share), what) in
        [(floating, "far from all others"), (inside, "inside, seen from nowhere"), (plate, "below, a plate")]
    {
        if count > 0 {
            let percent = number((1000.0 * share).round() / 10.0);
            named += &format!(" {} {what} ({percent} % of the surface);", number(count as f64));
        }
    }
    (!named.is_empty()).then(|| Warning {
        code: WarningCode::MeshPartsLeftOut,
        message: format!(
            "Parts of the mesh seem to be additions of its generator, and do not count:{named} the transform places all of the mesh."
        ),
    })
}

/// A warning about a search that has not converged.
pub fn about_search(converged: bool) -> Option<Warning> {
    (!converged).then(|| Warning {
        code: WarningCode::NotConverged,
        message:
            "The refinement had not converged when it reached its last step: options.quality \"best\" has more steps."
                .into(),
    })
}

/// Removes the warnings of doubt about a pose that is probably right.
pub fn retain_doubts(warnings: &mut Vec<Warning>, confidence: f64) {
    warnings.retain(|warning| confidence < doubted_below(warning.code));
}

/// The confidence of `precise` below which a warning is given. Of generated and real poses that would have one of these
/// warnings, one in thirteen is wrong above these bounds, hardly more than of all poses, and seven in ten below. `bench` of
/// the lab prints the counts.
fn doubted_below(code: WarningCode) -> f64 {
    match code {
        WarningCode::NotConverged => 0.3,
        WarningCode::DepthLooksInverted => 0.9,
        WarningCode::MaskTouchesBorder | WarningCode::SparseDepth | WarningCode::MeshDoubtful => 0.5,
        // The input has another fault than that the pose is hard to find.
        _ => f64::INFINITY,
    }
}

/// A warning about ICP that did not converge.
pub fn about_icp(converged: bool, iterations: usize) -> Option<Warning> {
    (!converged).then(|| Warning {
        code: WarningCode::NotConverged,
        message: format!(
            "The refinement had not converged, or had lost its support, after {iterations} iterations: check the metrics before using the pose."
        ),
    })
}
