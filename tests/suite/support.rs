//! Shared parts of the tests: seeded draws, random similarities, surfaces with known normals, yields and warnings.

use core::cell::RefCell;

use glam::Vec3;
use nalgebra::{Matrix3, Rotation3, UnitQuaternion, Vector3, Vector4};
use sim3align::geometry::cloud::Cloud;
use sim3align::geometry::random::Random;
use sim3align::geometry::similarity::{Similarity, vec3};
use sim3align::report::{Sim3, Warning, WarningCode};
use sim3align::scheduler::Task;

thread_local! {
    /// Of what the clock of [`pausing`] draws whether to pause.
    static CHANCE: RefCell<Option<(Draw, usize)>> = const { RefCell::new(None) };
}

/// A clock by which a step until 0 yields at one yield point of `one_in`, by chance; never if that is 0.
pub fn pausing(seed: u64, one_in: usize) -> fn() -> f64 {
    CHANCE.set((one_in > 0).then(|| (Draw::new(seed), one_in)));
    || {
        let is_due = |(draw, one_in): &mut (Draw, usize)| draw.below(*one_in) == 0;
        let is_due = CHANCE.with_borrow_mut(|chance| chance.as_mut().is_some_and(is_due));
        if is_due { f64::INFINITY } else { f64::NEG_INFINITY }
    }
}

/// Seeded draws of what tests need.
pub struct Draw(Random);

impl Draw {
    /// The draws of a test under `seed`.
    pub fn new(seed: u64) -> Self {
        Self(Random::new(seed, 1000))
    }

    /// A whole number in 0..`bound`.
    pub fn below(&mut self, bound: usize) -> usize {
        self.0.below(bound)
    }

    /// In [low, high).
    pub fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.0.uniform()
    }

    /// Standard normal (Box and Muller).
    pub fn normal(&mut self) -> f64 {
        let (u, v) = (1.0 - self.0.uniform(), self.0.uniform());
        (-2.0 * libm::log(u)).sqrt() * libm::cos(core::f64::consts::TAU * v)
    }

    /// In [−half, half]³.
    pub fn cube(&mut self, half: f64) -> Vector3<f64> {
        Vector3::from_fn(|_, _| self.between(-half, half))
    }

    /// Points in [−half, half]³.
    pub fn points(&mut self, count: usize, half: f64) -> Vec<Vec3> {
        (0..count).map(|_| vec3(&self.cube(half))).collect()
    }

    /// On the unit sphere.
    pub fn direction(&mut self) -> Vector3<f64> {
        Vector3::from_fn(|_, _| self.normal()).normalize()
    }

    /// Uniform over SO(3).
    pub fn rotation(&mut self) -> Rotation3<f64> {
        let q = Vector4::from_fn(|_, _| self.normal());
        UnitQuaternion::from_quaternion(q.into()).to_rotation_matrix()
    }

    /// A scale between the two bounds (uniform in its logarithm), any rotation, a translation in [−offset, offset]³.
    pub fn similarity(&mut self, scales: [f64; 2], offset: f64) -> Similarity {
        let scale = libm::exp(self.between(libm::log(scales[0]), libm::log(scales[1])));
        Similarity { scale, rotation: self.rotation(), translation: self.cube(offset) }
    }

    /// The points moved by a normal deviate of `sigma` along each axis.
    pub fn noisy(&mut self, points: &[Vec3], sigma: f64) -> Vec<Vec3> {
        let mut offset = || vec3(&(Vector3::from_fn(|_, _| self.normal()) * sigma));
        points.iter().map(|&p| p + offset()).collect()
    }

    /// 0..n in random order (Fisher and Yates).
    pub fn permutation(&mut self, n: usize) -> Vec<usize> {
        let mut order: Vec<usize> = (0..n).collect();
        (1..n).rev().for_each(|i| order.swap(i, self.below(i + 1)));
        order
    }
}

/// A lopsided potato without symmetry: the points d·r(d), r a polynomial in the direction d.
pub fn blob(draw: &mut Draw, count: usize) -> Cloud {
    surface(count, || {
        let d = draw.direction();
        let radius = 1.0 + 0.5 * d.x * d.x - 0.3 * d.z * d.z + 0.25 * d.x * d.y + 0.2 * d.z * d.z * d.z + 0.15 * d.x;
        let gradient = Vector3::new(d.x + 0.25 * d.y + 0.15, 0.25 * d.x, 0.6 * d.z * (d.z - 1.0));
        // ∇(|p| − r(p/|p|)) = d − (1 − d dᵀ) ∇r / |p|.
        let tangent = gradient - d * d.dot(&gradient);
        (d * radius, d - tangent / radius)
    })
}

/// A mug: an open cylinder, its bottom, and half a torus as handle.
pub fn mug(draw: &mut Draw, count: usize) -> Cloud {
    surface(count, || match draw.below(10) {
        0..=5 => {
            let n = circle(draw.between(0.0, core::f64::consts::TAU));
            (n * 0.8 + Vector3::z() * draw.between(-1.0, 1.0), n)
        }
        6..=7 => {
            let r = 0.8 * draw.between(0.0, 1.0).sqrt();
            (circle(draw.between(0.0, core::f64::consts::TAU)) * r - Vector3::z(), -Vector3::z())
        }
        _ => {
            // The half torus bends around y, its ends in the cylinder's wall.
            let (p, n) = on_torus(draw, core::f64::consts::PI);
            let stand = |v: Vector3<f64>| Vector3::new(v.y, v.z, v.x) * 0.5;
            (stand(p) + Vector3::x() * 0.8, stand(n))
        }
    })
}

/// A similarity of its scale, the vector of its rotation in radians, and its translation.
pub fn similarity(scale: f64, rotation: [f64; 3], translation: [f64; 3]) -> Similarity {
    Similarity { scale, rotation: Rotation3::new(rotation.into()), translation: translation.into() }
}

/// The transform of a result.
pub fn pose_of(found: &Sim3) -> Similarity {
    Similarity::from_column_major(&found.matrix).unwrap()
}

/// Points as the interleaved numbers that `register` takes.
pub fn flat(points: &[Vector3<f64>]) -> Vec<f64> {
    points.iter().flat_map(|p| [p.x, p.y, p.z]).collect()
}

/// How far a matrix is from a proper rotation.
pub fn rotation_defect(r: &Matrix3<f64>) -> f64 {
    (r.transpose() * r - Matrix3::identity()).amax().max((r.determinant() - 1.0).abs())
}

fn surface(count: usize, mut draw: impl FnMut() -> (Vector3<f64>, Vector3<f64>)) -> Cloud {
    let mut cloud = Cloud::default();
    for (p, n) in (0..count).map(|_| draw()) {
        cloud.points.push(vec3(&p));
        cloud.normals.push(vec3(&n.normalize()));
    }
    cloud
}

fn circle(angle: f64) -> Vector3<f64> {
    Vector3::new(libm::cos(angle), libm::sin(angle), 0.0)
}

fn on_torus(draw: &mut Draw, turn: f64) -> (Vector3<f64>, Vector3<f64>) {
    // From −turn/2 to turn/2, so that half a torus lies at positive x.
    let out = circle(draw.between(-0.5 * turn, 0.5 * turn));
    let angle = draw.between(0.0, core::f64::consts::TAU);
    let n = out * libm::cos(angle) + Vector3::z() * libm::sin(angle);
    (out + n * 0.35, n)
}

/// The result of a task, and the number of its steps until this time.
pub fn stepped<'a, T: 'a>(task: &mut Task<'a, T>, until: f64) -> (T, usize) {
    for steps in 1.. {
        if let Some(found) = task.step(until).unwrap() {
            return (found, steps);
        }
    }
    unreachable!()
}

/// The codes of warnings, in their order.
pub fn codes(warnings: &[Warning]) -> Vec<WarningCode> {
    warnings.iter().map(|warning| warning.code).collect()
}
