//! The estimate of the unknowns of a view: the calibration with which its objects can be explained best.
//!
//! A depth map whose shift is wrong is too deep or too flat, and so it is with a focal length that is wrong: the relief of
//! each object beside its width no longer fits its mesh. Objects are searched with several calibrations, because a
//! search stands about 15 per cent of wrong relief; from the best one, the score rises to a peak that is found by
//! refining the poses alone.

use super::calibration::{Calibration, CalibrationUncertainty};
use super::prior::Prior;
use super::profile::{CalibrationObject, RefinedPose};
use super::raw_view::{Focal, RawView};
use super::unknowns::{Reference, Unknowns};
use crate::error::Result;
use crate::geometry::depth_kind::DepthKind;
use crate::precise::no_candidate;
use crate::progress::Stopwatch;
use crate::scheduler::Scheduler;

/// Relief of an object beside its width: that of a plate seen from the front, the ratio between neighbours on the grid, and
/// their number.
const RELIEFS: (f64, f64, usize) = (0.08, 1.5, 8);
/// The same for the focal length: steps in standard deviations, to either side, and their largest length.
const FOCALS: (f64, i32, f64) = (0.7, 3, 0.2);
/// Steps of a curve: their length, and their number to either side of the best point of the grid, and of the peak of that
/// curve.
const STEP: f64 = 0.1;
const STEPS: [i32; 2] = [4, 2];
/// Times that a curve is continued beyond its end.
const EXTENSIONS: usize = 3;
/// Poses that are refined, of the best point of the grid and of either neighbour.
const POSES: [usize; 2] = [3, 1];
/// Power of the relief with which the tolerance for depth grows. With 0, all residuals are taken to be errors of the mesh, and
/// noise of the depth, which is less in flatter depth, makes flat what is noisy; with 1, to be errors of the depth, and
/// errors of the mesh make it deep. On real sensors, the biases cancel at about a third.
const TOLERANCE: f64 = 1.0 / 3.0;
/// Number of objects on which the estimate rests, those with the most pixels: more would hardly change it.
const SUBJECTS: usize = 6;
/// Standard deviation of the slope of the score of an object at the true relief or focal length. On real and generated objects
/// alike, it is the same for flat curves and for sharp ones: errors of mesh, outline and depth tilt the curve.
const SLOPE: f64 = 0.25;

/// A calibration, and how well it is determined.
#[derive(Debug, Clone)]
pub struct Estimate {
    /// The calibration.
    pub calibration: Calibration,
    /// The unknowns that it follows from.
    pub unknowns: Unknowns,
    reference: Reference,
    /// Standard deviation of the logarithm of the relief; 0 where the shift is known.
    relief_deviation: f64,
    /// Standard deviation of the logarithm of the focal length.
    pub focal_deviation: f64,
    /// The best pose of each object; `None` for one that takes no part or has none.
    pub poses: Vec<Option<RefinedPose>>,
}

impl Estimate {
    /// The standard deviations of the calibration. The distance that a shift leaves follows from relief and focal length.
    pub fn uncertainty(&self) -> CalibrationUncertainty {
        let Self { relief_deviation: relief, focal_deviation: focal, .. } = *self;
        CalibrationUncertainty { shift: if relief > 0.0 { libm::hypot(relief, focal) } else { 0.0 }, focal }
    }

    /// Sets the focal length, which other views have determined better: the logarithm of its factor, and its deviation.
    pub fn set_focal(&mut self, kind: DepthKind, focal: f64, deviation: f64) {
        self.unknowns.focal = focal;
        self.focal_deviation = deviation;
        self.calibration = self.reference.calibration(kind, self.unknowns);
    }
}

/// The number of [`Unknowns`] that is varied.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Axis {
    Relief,
    Focal,
}

/// The running estimate.
struct Estimator<'a, 's> {
    view: &'a RawView,
    subjects: &'a [CalibrationObject<'a>],
    /// Indices of those on which it rests.
    used: Vec<usize>,
    reference: Reference,
    prior: Prior<'a>,
    scheduler: &'a Scheduler,
    stages: &'a mut Stopwatch<'s>,
}

/// A point of the curve: the score of all objects, and the best pose of each.
#[derive(Clone)]
struct Sample {
    at: Unknowns,
    /// By the image alone, and with the prior.
    score: f64,
    total: f64,
    poses: Vec<Option<RefinedPose>>,
}

/// The start of an estimate: poses of its objects from an earlier one, by object.
pub struct Start {
    /// The unknowns.
    pub at: Unknowns,
    /// The poses.
    pub poses: Vec<Vec<RefinedPose>>,
}

/// Estimates the unknowns of a view, without a start from searches with several calibrations.
///
/// # Errors
/// [`NoConsensus`](crate::error::ErrorCode::NoConsensus) if no object can be found with any calibration, and those of
/// observations.
pub async fn estimate(
    view: &RawView,
    subjects: &[CalibrationObject<'_>],
    start: Option<Start>,
    scheduler: &Scheduler,
    stages: &mut Stopwatch<'_>,
) -> Result<Estimate> {
    let pixels = |s: &CalibrationObject<'_>| s.mask.data().iter().filter(|m| **m != 0).count();
    let mut used: Vec<usize> = (0..subjects.len()).collect();
    // Those first that determine the unit.
    used.sort_by_key(|k| subjects.get(*k).map(|s| core::cmp::Reverse((s.has_length, pixels(s)))));
    used.truncate(SUBJECTS);
    let reference = Reference::of(view, used.iter().filter_map(|k| subjects.get(*k)));
    let Some(reference) = reference else {
        let first = used.first().and_then(|k| subjects.get(*k));
        return Err(first.and_then(|subject| subject.unusable(view)).unwrap_or_else(no_candidate));
    };
    let prior = Prior::of(view, reference);
    Estimator { view, subjects, used, reference, prior, scheduler, stages }.run(start).await
}

impl Estimator<'_, '_> {
    /// The best point of the grid, and the poses from which the score is followed from there, by object.
    async fn start(&mut self, grid: &[Unknowns]) -> Result<Start> {
        let mut found = Vec::new();
        for at in grid {
            found.push(self.searched(*at).await?);
        }
        let score = |k: usize| {
            let best = |poses: &Vec<(f64, RefinedPose)>| poses.first().map_or(0.0, |(score, _)| *score);
            found[k].iter().map(best).sum::<f64>() - self.prior.cost(grid[k])
        };
        let best = (0..grid.len()).fold(0, |best, k| if score(k) > score(best) { k } else { best });
        if found[best].iter().all(Vec::is_empty) {
            // The reason why there is none.
            let calibration = self.reference.calibration(self.view.kind, grid[best]);
            for subject in self.used.iter().filter_map(|k| self.subjects.get(*k)) {
                subject.search(self.view, &calibration, self.scheduler, self.stages).await?;
            }
            return Err(no_candidate());
        }
        let mut poses: Vec<Vec<RefinedPose>> = vec![Vec::new(); self.used.len()];
        let [own, others] = POSES;
        for (k, count) in [(best, own), (best.wrapping_sub(1), others), (best + 1, others)] {
            let near = found.get(k).into_iter().flatten();
            for (all, more) in poses.iter_mut().zip(near) {
                all.extend(more.iter().take(count).map(|(_, pose)| *pose));
            }
        }
        Ok(Start { at: grid[best], poses })
    }

    /// The peak, from a start or, without one, from the grid.
    async fn run(mut self, start: Option<Start>) -> Result<Estimate> {
        let (grid, axis) = self.grid();
        let Start { at, poses } = match start {
            Some(start) => start,
            None => self.start(&grid).await?,
        };
        let mut deviations = [0.0; 2];
        let mut sample = self.sample(at, at, &poses).await?;
        let mut axes: Vec<Axis> = axis.into_iter().collect();
        if self.view.kind.is_affine() && self.view.focal != Focal::Known {
            axes.extend([Axis::Focal, Axis::Relief]);
        }
        for axis in axes {
            for steps in STEPS {
                let (peak, deviation) = self.peak(axis, sample, &poses, steps).await?;
                sample = peak;
                deviations[axis as usize] = deviation;
            }
        }
        let calibration = self.reference.calibration(self.view.kind, sample.at);
        let [relief_deviation, focal_deviation] = deviations;
        let mut best = vec![None; self.subjects.len()];
        for (k, pose) in self.used.iter().zip(sample.poses) {
            best[*k] = pose;
        }
        Ok(Estimate {
            calibration,
            unknowns: sample.at,
            reference: self.reference,
            relief_deviation,
            focal_deviation,
            poses: best,
        })
    }

    /// The calibrations with which the objects are searched, and the axis along which they lie.
    fn grid(&self) -> (Vec<Unknowns>, Option<Axis>) {
        let at = |relief: f64, focal: f64| Unknowns { relief, focal };
        match (self.view.kind.is_affine(), self.view.focal) {
            (true, _) => {
                let (least, ratio, count) = RELIEFS;
                let relief = |k: usize| libm::log(least) + k as f64 * libm::log(ratio);
                ((0..count).map(|k| at(relief(k), 0.0)).collect(), Some(Axis::Relief))
            }
            (false, Focal::Guessed(deviation)) => {
                let (step, count, longest) = FOCALS;
                let step = (step * deviation).min(longest);
                ((-count..=count).map(|k| at(0.0, f64::from(k) * step)).collect(), Some(Axis::Focal))
            }
            (false, Focal::Known) => (vec![at(0.0, 0.0)], None),
        }
    }

    /// The poses that searches find, by object. Objects without one, such as those with depth that a calibration puts behind
    /// the camera, have none.
    async fn searched(&mut self, at: Unknowns) -> Result<Vec<Vec<(f64, RefinedPose)>>> {
        let calibration = self.reference.calibration(self.view.kind, at);
        let mut found = Vec::new();
        for k in &self.used {
            let Some(subject) = self.subjects.get(*k) else { continue };
            let poses = subject.search(self.view, &calibration, self.scheduler, self.stages).await;
            found.push(poses.unwrap_or_default());
        }
        Ok(found)
    }

    /// The score of all objects, refined from these poses.
    async fn sample(&mut self, at: Unknowns, anchor: Unknowns, poses: &[Vec<RefinedPose>]) -> Result<Sample> {
        let calibration = self.reference.calibration(self.view.kind, at);
        let deeper = if self.view.kind.is_affine() { at.relief - anchor.relief } else { at.focal - anchor.focal };
        let tolerance = libm::exp(TOLERANCE * deeper);
        let mut sample = Sample { at, score: 0.0, total: -self.prior.cost(at), poses: Vec::new() };
        for (k, poses) in self.used.iter().zip(poses) {
            let Some(subject) = self.subjects.get(*k) else { continue };
            let refined = subject.refined(self.view, &calibration, poses, tolerance, self.stages).ok().flatten();
            sample.score += refined.as_ref().map_or(0.0, |(score, _)| *score);
            sample.poses.push(refined.map(|(_, pose)| pose));
            self.scheduler.yield_point().await;
        }
        sample.total += sample.score;
        Ok(sample)
    }

    /// The peak of the score along an axis, and its standard deviation. The tolerance for depth is that of the first point.
    async fn peak(
        &mut self,
        axis: Axis,
        from: Sample,
        poses: &[Vec<RefinedPose>],
        count: i32,
    ) -> Result<(Sample, f64)> {
        let center = from.at;
        let at = |k: i32| center.moved(axis == Axis::Relief, f64::from(k) * STEP);
        let mut curve: Vec<(i32, Sample)> = Vec::new();
        for k in -count..=count {
            let sample = if k == 0 { from.clone() } else { self.sample(at(k), center, poses).await? };
            curve.push((k, sample));
        }
        let top = |curve: &[(i32, Sample)]| {
            (0..curve.len()).fold(0, |best, k| if curve[k].1.total > curve[best].1.total { k } else { best })
        };
        for _ in 0..EXTENSIONS {
            let best = top(&curve);
            if best > 1 && best + 2 < curve.len() {
                break;
            }
            if best <= 1 {
                let k = curve[0].0 - 1;
                curve.insert(0, (k, self.sample(at(k), center, poses).await?));
            } else {
                let k = curve[curve.len() - 1].0 + 1;
                curve.push((k, self.sample(at(k), center, poses).await?));
            }
        }
        let best = top(&curve);
        let window = &curve[best.saturating_sub(2)..(best + 3).min(curve.len())];
        let points = |of: fn(&Sample) -> f64| -> Vec<(f64, f64)> {
            window.iter().map(|(k, sample)| (f64::from(*k - curve[best].0) * STEP, of(sample))).collect()
        };
        let offset = parabola(&points(|sample| sample.total)).map(|(offset, _)| offset);
        // The end of a curve is no evidence of a peak.
        let is_inside = best > 0 && best + 1 < curve.len();
        let evidence = parabola(&points(|sample| sample.score)).filter(|_| is_inside);
        // A slope that is off by SLOPE moves the peak by SLOPE / 2a.
        let slopes = SLOPE * SLOPE * self.used.len() as f64;
        let precision = evidence.map_or(0.0, |(_, curvature)| 4.0 * curvature * curvature / slopes);
        let place = at(curve[best].0);
        let deviation = 1.0 / (precision + self.prior.precision(place, axis == Axis::Relief)).sqrt();
        let peak = match offset {
            Some(offset) => {
                let place = place.moved(axis == Axis::Relief, offset.clamp(-STEP, STEP));
                self.sample(place, center, poses).await?
            }
            None => curve.swap_remove(best).1,
        };
        Ok((peak, deviation))
    }
}

/// The peak of the parabola nearest to these points, and its curvature a: y = c − a·(x − peak)²; `None` if it has none.
fn parabola(points: &[(f64, f64)]) -> Option<(f64, f64)> {
    let power = |n: i32| points.iter().map(|(x, _)| x.powi(n)).sum::<f64>();
    let with = |n: i32| points.iter().map(|(x, y)| y * x.powi(n)).sum::<f64>();
    let matrix = nalgebra::Matrix3::new(
        power(0),
        power(1),
        power(2),
        power(1),
        power(2),
        power(3),
        power(2),
        power(3),
        power(4),
    );
    let solved = matrix.lu().solve(&nalgebra::Vector3::new(with(0), with(1), with(2)))?;
    let (slope, curve) = (solved[1], solved[2]);
    (curve < 0.0).then(|| (-0.5 * slope / curve, -curve))
}
