//! Objects composed of overlapping closed parts, like those of mesh generators.

use std::collections::BTreeMap;

use crate::prelude::*;

/// Vertices and triangles by part; the triangles of every part face outward.
#[derive(Debug, Clone, Default)]
pub struct Solid {
    positions: Vec<DVec3>,
    triangles: Vec<[u32; 3]>,
    /// The part of each triangle.
    parts: Vec<usize>,
    part: usize,
    frame: DAffine3,
}

impl Solid {
    /// Everything until the next call belongs to a new part, whose number is returned.
    pub fn part(&mut self) -> usize {
        self.part += 1;
        self.part
    }

    /// Sets the frame of the following shapes.
    pub fn at(&mut self, frame: DAffine3) -> &mut Self {
        self.frame = frame;
        self
    }

    /// Whether there is nothing yet.
    pub fn is_empty(&self) -> bool {
        self.triangles.is_empty()
    }

    /// The mesh, and the part of each of its triangles.
    pub fn finish(self) -> Result<(Mesh, Vec<usize>)> {
        Ok((Mesh::new(self.positions.iter().map(|p| p.as_vec3()).collect(), self.triangles)?, self.parts))
    }

    /// Turns a profile of (radius, z) about the z axis; both ends lie on the axis.
    pub fn lathe(&mut self, profile: &[[f64; 2]], segments: u32) {
        self.lathe_scaled(profile, [1.0, 1.0], segments);
    }

    /// A lathe whose circles are ellipses.
    pub fn lathe_scaled(&mut self, profile: &[[f64; 2]], scale: [f64; 2], segments: u32) {
        let [first, middle @ .., last] = profile else { return };
        let ring = |&[radius, z]: &[f64; 2]| {
            circle(segments).map(|[x, y]| DVec3::new(radius * scale[0] * x, radius * scale[1] * y, z)).collect()
        };
        let rings: Vec<Vec<DVec3>> = middle.iter().map(ring).collect();
        self.skin(&rings, [DVec3::new(0.0, 0.0, first[1]), DVec3::new(0.0, 0.0, last[1])]);
    }

    /// An ellipsoid about the frame's origin.
    pub fn ellipsoid(&mut self, radii: DVec3) {
        let profile: Vec<[f64; 2]> = (0..=20)
            .map(|i| {
                let (sine, cosine) = libm::sincos(PI * f64::from(i) / 20.0);
                [sine, -radii.z * cosine]
            })
            .collect();
        self.lathe_scaled(&profile, [radii.x, radii.y], 32);
    }

    /// A cylinder with slightly rounded edges, from z = 0 to `height`, of these radii below and above.
    pub fn cylinder(&mut self, radii: [f64; 2], height: f64) {
        let edge = 0.12 * radii[0].min(radii[1]).min(height);
        let radius = |z: f64| radii[0] + (radii[1] - radii[0]) * z / height;
        let mut profile: Vec<[f64; 2]> = (0..4).map(|i| [(radii[0] - edge) * f64::from(i) / 4.0, 0.0]).collect();
        profile.push([radii[0] - edge, 0.0]);
        let steps = ((height / radii[0].max(radii[1]) * 5.0) as u32).clamp(4, 40);
        profile.extend((0..=steps).map(|i| {
            let z = edge + (height - 2.0 * edge) * f64::from(i) / f64::from(steps);
            [radius(z), z]
        }));
        profile.extend((0..=4).rev().map(|i| [(radii[1] - edge) * f64::from(i) / 4.0, height]));
        self.lathe(&profile, 32);
    }

    /// An ellipse moved along a path, with round ends. `radius` gives, for the share of the path from 0 to 1, the
    /// radii along `across` and at right angles to it and to the path.
    pub fn tube(&mut self, path: &[DVec3], across: DVec3, radius: impl Fn(f64) -> [f64; 2], segments: u32) {
        let (Some(&first), Some(&last)) = (path.first(), path.last()) else { return };
        let lengths = running_lengths(path);
        let total = lengths.last().copied().unwrap_or_default();
        // Sampled again, denser at the ends, where it closes like a ball.
        let steps = path.len().max(24);
        let end = (0.5 * (radius(0.0)[1] + radius(1.0)[1]) / total.max(1e-9)).min(0.45);
        let mut shares: Vec<f64> = (1..5).map(|i| end * (1.0 - libm::cos(0.5 * PI * f64::from(i) / 5.0))).collect();
        let middle = |i: usize| end + (1.0 - 2.0 * end) * i as f64 / steps as f64;
        shares.extend((0..=steps).map(middle));
        shares.extend((1..5).rev().map(|i| 1.0 - end * (1.0 - libm::cos(0.5 * PI * f64::from(i) / 5.0))));
        let rings: Vec<Vec<DVec3>> = shares
            .iter()
            .map(|&share| {
                let (point, tangent) = along(path, &lengths, share * total);
                let off = 1.0 - (share.min(1.0 - share) / end).min(1.0);
                let cap = (1.0 - off * off).max(0.0).sqrt();
                ring(point, tangent, across, radius(share).map(|r| r * cap), segments)
            })
            .collect();
        self.skin(&rings, [first, last]);
    }

    /// A box about the frame's origin with edges and corners rounded by `rounding`.
    pub fn cuboid(&mut self, half: DVec3, rounding: f64) {
        let rounding = rounding.min(half.min_element());
        let steps = half.to_array().map(|h| ((14.0 * h / half.max_element()) as u32).clamp(4, 14));
        let mut vertices: BTreeMap<[u32; 3], u32> = BTreeMap::new();
        let start = self.triangles.len();
        for axis in 0..3 {
            let (b, c) = ((axis + 1) % 3, (axis + 2) % 3);
            for side in [0, steps[axis]] {
                for (i, j) in (0..steps[b]).flat_map(|i| (0..steps[c]).map(move |j| (i, j))) {
                    let corners = [[i, j], [i + 1, j], [i + 1, j + 1], [i, j + 1]].map(|[i, j]| {
                        let mut key = [0; 3];
                        (key[axis], key[b], key[c]) = (side, i, j);
                        *vertices
                            .entry(key)
                            .or_insert_with(|| self.vertex(rounded(cosine_spaced(key, steps) * half, half, rounding)))
                    });
                    let [p, q, r, s] = if side == 0 { [0, 3, 2, 1] } else { [0, 1, 2, 3] }.map(|k: usize| corners[k]);
                    self.triangles.extend([[p, q, r], [p, r, s]]);
                }
            }
        }
        self.outward(start);
    }

    /// A random cylinder, box or ellipsoid of this half width and height, which stands on `spot`, tilted by `lean` radians.
    pub fn block(&mut self, spot: DVec3, lean: f64, half_width: f64, height: f64, random: &mut Random) {
        let heading = DAffine3::from_rotation_z(TAU * random.uniform());
        let frame = DAffine3::from_translation(spot) * heading * DAffine3::from_rotation_x(lean);
        let middle = frame * DAffine3::from_translation(DVec3::Z * 0.5 * height);
        match random.below(3) {
            0 => self.at(frame).cylinder([half_width, half_width * between(random, 0.6, 1.0)], height),
            1 => {
                let half = DVec3::new(half_width, half_width * between(random, 0.4, 1.0), 0.5 * height);
                self.at(middle).cuboid(half, 0.05 * half_width);
            }
            _ => {
                let radii = DVec3::new(half_width, half_width * between(random, 0.7, 1.0), 0.5 * height);
                self.at(middle).ellipsoid(radii);
            }
        }
    }

    /// Joins rings of equally many points to each other, and the outermost to a point each.
    fn skin(&mut self, rings: &[Vec<DVec3>], ends: [DVec3; 2]) {
        let Some(n) = rings.first().map(|ring| ring.len() as u32) else { return };
        let start = self.triangles.len();
        let low = self.positions.len() as u32;
        rings.iter().flatten().for_each(|&p| {
            self.vertex(p);
        });
        let high = self.positions.len() as u32 - n;
        let [first, last] = ends.map(|p| self.vertex(p));
        for k in 0..n {
            let next = (k + 1) % n;
            self.triangles.extend([[first, low + next, low + k], [last, high + k, high + next]]);
            for from in (low..high).step_by(n as usize) {
                let to = from + n;
                self.triangles.extend([[from + k, from + next, to + k], [from + next, to + next, to + k]]);
            }
        }
        self.outward(start);
    }

    fn vertex(&mut self, position: DVec3) -> u32 {
        self.positions.push(self.frame.transform_point3(position));
        self.positions.len() as u32 - 1
    }

    /// Turns the triangles from `start` on outward, should they face inward, and gives them the present part.
    fn outward(&mut self, start: usize) {
        let added = &mut self.triangles[start..];
        let origin = added.first().map_or(DVec3::ZERO, |t| self.positions[t[0] as usize]);
        let volume: f64 = added
            .iter()
            .map(|t| {
                let [a, b, c] = t.map(|i| self.positions[i as usize] - origin);
                a.dot(b.cross(c))
            })
            .sum();
        if volume < 0.0 {
            added.iter_mut().for_each(|t| t.swap(1, 2));
        }
        self.parts.resize(self.triangles.len(), self.part);
    }
}

/// Points of the lattice on a cube of side 2, closer to each other near its edges.
fn cosine_spaced(key: [u32; 3], steps: [u32; 3]) -> DVec3 {
    DVec3::from_array([0, 1, 2].map(|axis| {
        let share = f64::from(key[axis]) / f64::from(steps[axis]);
        let even = 2.0 * share - 1.0;
        0.5 * (even - libm::cos(PI * share))
    }))
}

fn rounded(p: DVec3, half: DVec3, rounding: f64) -> DVec3 {
    let inner = half - DVec3::splat(rounding);
    let core = p.max(-inner).min(inner);
    core + (p - core).normalize_or_zero() * rounding
}

/// Points of the unit circle.
fn circle(segments: u32) -> impl Iterator<Item = [f64; 2]> {
    (0..segments).map(move |k| {
        let (sine, cosine) = libm::sincos(TAU * f64::from(k) / f64::from(segments));
        [cosine, sine]
    })
}

fn ring(point: DVec3, tangent: DVec3, across: DVec3, radii: [f64; 2], segments: u32) -> Vec<DVec3> {
    let upwards = tangent.cross(across).normalize_or_zero();
    let across = upwards.cross(tangent).normalize_or_zero();
    circle(segments).map(|[x, y]| point + across * (radii[0] * x) + upwards * (radii[1] * y)).collect()
}

fn running_lengths(path: &[DVec3]) -> Vec<f64> {
    let mut sum = 0.0;
    let steps = path.windows(2).map(|w| {
        sum += w[0].distance(w[1]);
        sum
    });
    core::iter::once(0.0).chain(steps).collect()
}

/// The point at a length along a path, and the direction there, which turns evenly from vertex to vertex.
fn along(path: &[DVec3], lengths: &[f64], length: f64) -> (DVec3, DVec3) {
    let last = path.len().saturating_sub(2);
    let i = lengths.partition_point(|&l| l <= length).saturating_sub(1).min(last);
    let direction = |i: usize| (path[(i + 1).min(path.len() - 1)] - path[i.saturating_sub(1)]).normalize_or_zero();
    let span = (lengths[i + 1] - lengths[i]).max(1e-12);
    let share = ((length - lengths[i]) / span).clamp(0.0, 1.0);
    (path[i].lerp(path[i + 1], share), direction(i).lerp(direction(i + 1), share).normalize_or_zero())
}

/// A path of straight pieces with their corners cut round: Chaikin's scheme, three times.
pub fn smooth(corners: &[DVec3]) -> Vec<DVec3> {
    let mut path = corners.to_vec();
    for _ in 0..3 {
        let (Some(&first), Some(&last)) = (path.first(), path.last()) else { return path };
        let cut = path.windows(2).flat_map(|w| [w[0].lerp(w[1], 0.25), w[0].lerp(w[1], 0.75)]);
        path = core::iter::once(first).chain(cut).chain([last]).collect();
    }
    path
}
