//! Simulates generative models that reconstruct an object from one photo: detailed and right where seen up to
//! a slight warp, the rest invented, some small part lost or added. The truth is the similarity of the object's own frame: what
//! the faults do to size and pose of the whole is taken out before the mesh gets a frame of its own.

use crate::conditions::{Conditions, EXTRA_PART, MISSING_PART, MeshFault, PLAIN, Tier, WARPED};
use crate::objects::mesh::{bounds, clustered, corners_of, face, joined, neighbors, normals, paths};
use crate::objects::solid::Solid;
use crate::prelude::*;
use crate::world::Placed;
use crate::world::view::Rendering;
use sim3align::register::umeyama::{Pair, ScaleMode, umeyama};

/// Random streams of a mesh, and of the quality of the meshes of scenes.
pub const MESH_STREAM: u64 = 3;
const QUALITY_STREAM: u64 = 19;

/// A generated mesh in the world frame, and its simulated errors.
#[derive(Debug)]
pub struct Generated {
    pub mesh: Mesh,
    /// Names of the simulated errors.
    pub tags: Vec<&'static str>,
}

/// The mesh of an object of a scene, whose quality is drawn.
pub fn generate_any(placed: &Placed, rendering: &Rendering, seed: u64) -> Result<Generated> {
    let random = &mut Random::new(seed, QUALITY_STREAM);
    let tier = match random.uniform() {
        u if u < 0.3 => Tier::Easy,
        u if u < 0.85 => Tier::Medium,
        _ => Tier::Hard,
    };
    let class = match random.uniform() {
        u if u < 0.1 => &MISSING_PART,
        u if u < 0.18 => &EXTRA_PART,
        u if u < 0.28 => &WARPED,
        _ => &PLAIN,
    };
    generate(placed, rendering, Conditions { tier, class }, &mut Random::new(seed, MESH_STREAM))
}

/// Magnitude of each error.
struct Strength {
    /// Largest logarithm of an axis' stretch.
    stretch: f64,
    /// Amplitude of waves, of the bend's sag, and of the invented side's bulge; shares of the box diagonal.
    warp: f64,
    bend: f64,
    bulge: f64,
    /// By what share of its own thickness the unseen part is too deep or too flat.
    depth: f64,
    smoothing_passes: usize,
    /// Cells of the decimation, share of the box diagonal; 0 is none.
    cell: f64,
}

impl Strength {
    fn draw(random: &mut Random, tier: Tier, warped: bool, is_symmetric: bool, thin: bool) -> Self {
        let of = |random: &mut Random| between(random, 0.3, 1.0);
        let much = if warped { between(random, 0.85, 1.0) } else { of(random) };
        let stretch = much * tier.pick(0.01, 0.03, if warped { 0.058 } else { 0.045 });
        let warp = of(random) * tier.pick(0.002, 0.006, if warped { 0.018 } else { 0.01 });
        let bend = of(random) * tier.pick(0.0, 0.008, if warped { 0.035 } else { 0.014 });
        // A generator completes what is symmetric better than what is not.
        let guess = if is_symmetric { 0.3 } else { 1.0 };
        let bulge = guess * of(random) * tier.pick(0.004, 0.012, 0.022);
        let depth = guess * of(random) * sign(random) * tier.pick(0.06, 0.18, 0.32);
        let smoothing_passes = tier.pick(0, random.below(3), 1 + random.below(4));
        let decimated = chance(random, tier.pick(0.0, 0.3, 0.5)) && !thin;
        let cell = between(random, 0.007, tier.pick(0.007, 0.009, 0.013)) * f64::from(u8::from(decimated));
        Self { stretch, warp, bend, bulge, depth, smoothing_passes, cell }
    }
}

/// The mesh that a generator makes of an object, with the errors of its conditions.
pub fn generate(
    placed: &Placed,
    rendering: &Rendering,
    conditions: Conditions,
    random: &mut Random,
) -> Result<Generated> {
    let (Conditions { tier, class }, object, original) = (conditions, &placed.object, &placed.mesh);
    let is_symmetric = !placed.symmetry.is_empty();
    // Decimation would tear a thin object.
    let is_thin = object.family == "spoon";
    let warped = class.mesh_fault == MeshFault::Warped;
    let strength = Strength::draw(random, tier, warped, is_symmetric, is_thin);
    let diagonal = object.diagonal();
    let around = neighbors(original);
    let vertices: Vec<DVec3> = original.positions().iter().map(|p| p.as_dvec3()).collect();
    let mut positions = deform(&vertices, &strength, diagonal, random);
    for _ in 0..strength.smoothing_passes {
        positions = smoothed(&positions, &around);
    }
    let mut positions = fitted(&positions, &vertices, original)?;
    invent(&mut positions, original, &around, rendering, &strength, diagonal, random);

    let mut tags = Vec::new();
    let mut triangles = original.triangles().to_vec();
    let is_lossy = class.mesh_fault == MeshFault::MissingPart;
    if is_lossy && !object.losable.is_empty() && chance(random, 0.7) {
        let part = object.losable[random.below(object.losable.len())];
        triangles = triangles.into_iter().zip(&object.parts).filter(|(_, own)| **own != part).map(|(t, _)| t).collect();
        tags.push("lost-part");
    } else if (is_lossy || chance(random, tier.pick(0.0, 0.0, 0.12))) && !is_symmetric {
        triangles = cut(&positions, &triangles, diagonal * between(random, 0.1, 0.17), random);
        tags.push("lost-piece");
    }
    let positions: Vec<Vec3> = positions.iter().map(|p| p.as_vec3()).collect();
    let mut mesh = Mesh::new(positions.clone(), original.triangles().to_vec())?.of_triangles(&triangles);
    if class.mesh_fault == MeshFault::ExtraPart || (!is_symmetric && chance(random, tier.pick(0.0, 0.0, 0.1))) {
        let (lump, _) = blob(&positions, diagonal, random).finish()?;
        mesh = joined(&[&mesh, &lump])?;
        tags.push("extra-part");
    }
    if strength.cell > 0.0 {
        let offset = DVec3::new(random.uniform(), random.uniform(), random.uniform()) * strength.cell * diagonal;
        mesh = clustered(&mesh, strength.cell * diagonal, offset)?;
        tags.push("decimated");
    }
    Ok(Generated { mesh, tags })
}

/// Stretched along the axes at the same volume, bent along the longest, and warped by long waves.
fn deform(original: &[DVec3], strength: &Strength, diagonal: f64, random: &mut Random) -> Vec<DVec3> {
    let (low, high) = bounds(original.iter().copied());
    let (centre, extent) = ((low + high) * 0.5, high - low);
    let drawn = DVec3::new(random.uniform(), random.uniform(), random.uniform());
    let even = drawn - DVec3::splat(drawn.element_sum() / 3.0);
    let stretch = (even * (strength.stretch / even.abs().max_element().max(1e-9))).to_array().map(libm::exp);
    let long = (0..3).max_by(|&a, &b| extent[a].total_cmp(&extent[b])).unwrap_or_default();
    let mut sag = DVec3::ZERO;
    let (sine, cosine) = libm::sincos(TAU * random.uniform());
    (sag[(long + 1) % 3], sag[(long + 2) % 3]) = (cosine, sine);
    sag *= strength.bend * diagonal;
    let mut direction = || {
        let d = DVec3::new(normal(random), normal(random), normal(random)).normalize_or(DVec3::X);
        (d, between(random, 0.6, 1.6) * TAU / diagonal, TAU * random.uniform())
    };
    let waves: Vec<_> = (0..4).map(|_| (direction(), direction().0)).collect();
    let amplitude = strength.warp * diagonal / 2.0;
    let moved = |p: &DVec3| {
        let q = *p - centre;
        let t = 2.0 * q[long] / extent[long].max(1e-9);
        let warp: DVec3 = waves.iter().map(|&((along, k, phase), way)| way * libm::cos(k * along.dot(q) + phase)).sum();
        centre + q * DVec3::from_array(stretch) + sag * (t * t - 1.0 / 3.0) + warp * amplitude
    };
    original.iter().map(moved).collect()
}

fn smoothed(positions: &[DVec3], around: &[Vec<u32>]) -> Vec<DVec3> {
    let mean = |i: usize| match around[i].len() {
        0 => positions[i],
        n => around[i].iter().map(|&k| positions[k as usize]).sum::<DVec3>() / n as f64,
    };
    (0..positions.len()).map(|i| positions[i].lerp(mean(i), 0.4)).collect()
}

/// The deformed vertices under the similarity that best brings them back to where they were, by area: what a
/// deformation does to the size and pose of the whole is no fault but a matter of the mesh's frame.
fn fitted(positions: &[DVec3], original: &[DVec3], mesh: &Mesh) -> Result<Vec<DVec3>> {
    let mut weights = vec![0.0; original.len()];
    for (k, t) in mesh.triangles().iter().enumerate() {
        let area = face(mesh, k).length();
        t.iter().for_each(|&i| weights[i as usize] += area);
    }
    let vector = |p: &DVec3| Vector3::from(p.to_array());
    let pairs = positions.iter().zip(original).zip(&weights);
    let pairs = pairs.map(|((p, q), &weight)| Pair { source: vector(p), target: vector(q), weight });
    let back = umeyama(pairs, ScaleMode::Free)?;
    Ok(positions.iter().map(|p| DVec3::from_array(back.apply(vector(p)).into())).collect())
}

/// Stretches and bulges the hidden side along the line of sight.
fn invent(
    positions: &mut [DVec3],
    mesh: &Mesh,
    around: &[Vec<u32>],
    rendering: &Rendering,
    strength: &Strength,
    diagonal: f64,
    random: &mut Random,
) {
    let paths = paths(mesh, around, &corners_of(mesh, rendering.object_pixels().map(|(_, triangle)| triangle as u32)));
    let normals = normals(mesh);
    let eye = rendering.view.eye();
    let wave = DVec3::new(random.uniform(), random.uniform(), random.uniform()) * (TAU / diagonal);
    let phase = TAU * random.uniform();
    for (i, p) in positions.iter_mut().enumerate() {
        let share = ((paths[i] / diagonal - 0.02) / 0.23).clamp(0.0, 1.0);
        let share = share * share * (3.0 - 2.0 * share);
        if share == 0.0 {
            continue;
        }
        let in_camera = rendering.view.camera_from_world.apply(vector3(mesh.positions()[i]));
        let [u, v] = rendering.view.camera.project(vec3(&in_camera)).map(|x| x + 0.5);
        let inside = u >= 0.0 && v >= 0.0 && u < rendering.view.width as f64 && v < rendering.view.height as f64;
        let front = if inside { rendering.object_depth[v as usize * rendering.view.width + u as usize] } else { 0.0 };
        let behind = if front > 0.0 { (in_camera.z - f64::from(front)).max(0.0) } else { 0.0 };
        let wavy = 0.8 + 0.2 * libm::cos(wave.dot(*p) + phase);
        let away = (*p - eye).normalize_or_zero();
        *p += away * (share * wavy * strength.depth * behind) + normals[i] * (share * wavy * strength.bulge * diagonal);
    }
}

/// The triangles without those around a vertex far from the middle.
fn cut(positions: &[DVec3], triangles: &[[u32; 3]], radius: f64, random: &mut Random) -> Vec<[u32; 3]> {
    let centre = positions.iter().sum::<DVec3>() / positions.len() as f64;
    let candidates = (0..12).map(|_| positions[random.below(positions.len())]);
    let spot = candidates.max_by(|a, b| a.distance(centre).total_cmp(&b.distance(centre))).unwrap_or(centre);
    let far = |t: &&[u32; 3]| t.iter().any(|&i| positions[i as usize].distance(spot) > radius);
    triangles.iter().filter(far).copied().collect()
}

/// A lump at the surface.
fn blob(positions: &[Vec3], diagonal: f64, random: &mut Random) -> Solid {
    let spot = positions[random.below(positions.len())].as_dvec3();
    let mut radius = || diagonal * between(random, 0.045, 0.1);
    let radii = DVec3::new(radius(), radius(), radius());
    let mut solid = Solid::default();
    solid.at(DAffine3::from_translation(spot)).ellipsoid(radii);
    solid
}
