//! Simulates a generative model that reconstructs an object from one photo.

use super::cluster::cluster;
use super::draft::{Axis, Object};
use super::scene::Scene;
use super::solid::Solid;
use super::tier::{Class, Tier};
use crate::cases::distortion::{box_of, corners_of, neighbors, normals, paths};
use crate::prelude::*;
use sim3align::register::umeyama::{Pair, ScaleMode, umeyama};

/// A generated mesh in the world frame, and its simulated errors.
#[derive(Debug)]
pub struct Generated {
    /// The mesh.
    pub mesh: Mesh,
    /// The symmetry of what can be told by it.
    pub symmetry: Vec<Axis>,
    /// Names of the simulated errors.
    pub tags: Vec<&'static str>,
    /// Magnitudes of the simulated errors.
    pub parameters: Vec<(&'static str, f64)>,
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
    /// How far vertices slide along the surface, as a share of the edges.
    slide: f64,
    /// Cells of the decimation, share of the box diagonal; 0 is none.
    cell: f64,
}

impl Strength {
    fn draw(random: &mut Random, tier: Tier, class: Class, is_symmetric: bool, thin: bool) -> Self {
        let of = |random: &mut Random| between(random, 0.3, 1.0);
        let warped = class == Class::Warped;
        let much = if warped { between(random, 0.85, 1.0) } else { of(random) };
        let stretch = much * tier.pick(0.01, 0.03, if warped { 0.058 } else { 0.045 });
        let warp = of(random) * tier.pick(0.002, 0.006, if warped { 0.018 } else { 0.01 });
        let bend = of(random) * tier.pick(0.0, 0.008, if warped { 0.035 } else { 0.014 });
        // A generator completes what is symmetric better than what is not.
        let guess = if is_symmetric { 0.3 } else { 1.0 };
        let bulge = guess * of(random) * tier.pick(0.004, 0.012, 0.022);
        let depth = guess * of(random) * sign(random) * tier.pick(0.06, 0.18, 0.32);
        let smoothing_passes = tier.pick(0, random.below(3), 1 + random.below(4));
        let slide = of(random) * tier.pick(0.0, 0.2, 0.33);
        let decimated = chance(random, tier.pick(0.0, 0.3, 0.5)) && !thin;
        let cell = between(random, 0.007, tier.pick(0.007, 0.009, 0.013)) * f64::from(u8::from(decimated));
        Self { stretch, warp, bend, bulge, depth, smoothing_passes, slide, cell }
    }
}

/// The mesh that a generator makes of `object`, which lies in the scene as `placed` with these axes of symmetry.
pub fn generate(
    object: &Object,
    placed: &Mesh,
    symmetry: &[Axis],
    scene: &Scene,
    (tier, class): (Tier, Class),
    random: &mut Random,
) -> Result<Generated> {
    let thin = class == Class::Thin;
    let strength = Strength::draw(random, tier, class, !symmetry.is_empty(), thin);
    let diagonal = object.diagonal();
    let around = neighbors(placed);
    let original: Vec<DVec3> = placed.positions().iter().map(|p| p.as_dvec3()).collect();
    let mut positions = deform(&original, &strength, diagonal, random);
    for _ in 0..strength.smoothing_passes {
        positions = smoothed(&positions, &around);
    }
    let mut positions = fitted(&positions, &original, placed)?;
    invent(&mut positions, placed, &around, scene, &strength, diagonal, random);
    slide(&mut positions, &around, strength.slide, random);

    let mut made = Generated {
        mesh: placed.clone(),
        symmetry: symmetry.to_vec(),
        tags: Vec::new(),
        parameters: vec![
            ("stretch", strength.stretch),
            ("warp", strength.warp),
            ("bend", strength.bend),
            ("bulge", strength.bulge),
            ("inventedDepth", strength.depth),
            ("cell", strength.cell),
        ],
    };
    let mut triangles = placed.triangles().to_vec();
    let lossy = class == Class::MissingPart;
    if lossy && !object.losable.is_empty() && chance(random, 0.7) {
        let (part, left) = &object.losable[random.below(object.losable.len())];
        triangles =
            (0..).zip(&triangles).filter(|(t, _)| object.parts[*t as usize] != *part).map(|(_, t)| *t).collect();
        made.tags.push("lost-part");
        if !left.is_empty() {
            made.symmetry.clone_from(left);
        }
    } else if (lossy || chance(random, tier.pick(0.0, 0.0, 0.12))) && symmetry.is_empty() {
        triangles = cut(&positions, &triangles, diagonal * between(random, 0.1, 0.17), random);
        made.tags.push("lost-piece");
    }
    let mut positions: Vec<_> = positions.iter().map(|p| p.as_vec3()).collect();
    if class == Class::ExtraPart || (symmetry.is_empty() && chance(random, tier.pick(0.0, 0.0, 0.1))) {
        let (blob, _) = blob(&positions, diagonal, random).finish()?;
        let first = positions.len() as u32;
        positions.extend(blob.positions());
        triangles.extend(blob.triangles().iter().map(|t| t.map(|i| i + first)));
        made.tags.push("extra-part");
    }
    made.mesh = compact(&positions, &triangles)?;
    if strength.cell > 0.0 {
        let offset = DVec3::new(random.uniform(), random.uniform(), random.uniform()) * strength.cell * diagonal;
        made.mesh = cluster(&made.mesh, strength.cell * diagonal, offset)?;
        made.tags.push("decimated");
    }
    Ok(made)
}

/// Stretched along the axes at the same volume, bent along the longest, and warped by long waves.
fn deform(original: &[DVec3], strength: &Strength, diagonal: f64, random: &mut Random) -> Vec<DVec3> {
    let (low, high) = box_of(original.iter().copied());
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
    for &t in mesh.triangles() {
        let [a, b, c] = t.map(|i| original[i as usize]);
        let area = (b - a).cross(c - a).length();
        t.iter().for_each(|&i| weights[i as usize] += area);
    }
    let vector = |p: &DVec3| Vector3::from(p.to_array());
    let pairs = positions.iter().zip(original).zip(&weights);
    let pairs = pairs.map(|((p, q), &weight)| Pair { source: vector(p), target: vector(q), weight });
    let back = umeyama(pairs, ScaleMode::Free)?;
    Ok(positions.iter().map(|p| DVec3::from_array(back.apply(vector(p)).into())).collect())
}

/// What was not seen becomes deeper or flatter along the line of sight, and bulges.
fn invent(
    positions: &mut [DVec3],
    mesh: &Mesh,
    around: &[Vec<u32>],
    scene: &Scene,
    strength: &Strength,
    diagonal: f64,
    random: &mut Random,
) {
    let shown = scene.object_triangles.iter().zip(&scene.visible);
    let shown = shown.filter(|(triangle, visible)| **visible && **triangle != NO_TRIANGLE);
    let paths = paths(mesh, around, &corners_of(mesh, shown.map(|(triangle, _)| *triangle)));
    let normals = normals(mesh);
    let eye = DVec3::from_array(scene.camera_from_world.inverse().translation.into());
    let wave = DVec3::new(random.uniform(), random.uniform(), random.uniform()) * (TAU / diagonal);
    let phase = TAU * random.uniform();
    for (i, p) in positions.iter_mut().enumerate() {
        let share = ((paths[i] / diagonal - 0.02) / 0.23).clamp(0.0, 1.0);
        let share = share * share * (3.0 - 2.0 * share);
        if share == 0.0 {
            continue;
        }
        let in_camera = scene.camera_from_world.apply(vector3(mesh.positions()[i]));
        let [u, v] = scene.camera.project(vec3(&in_camera)).map(|x| x + 0.5);
        let inside = u >= 0.0 && v >= 0.0 && u < scene.width as f64 && v < scene.height as f64;
        let front = if inside { scene.object_depth[v as usize * scene.width + u as usize] } else { 0.0 };
        let behind = if front > 0.0 { (in_camera.z - f64::from(front)).max(0.0) } else { 0.0 };
        let wavy = 0.8 + 0.2 * libm::cos(wave.dot(*p) + phase);
        let away = (*p - eye).normalize_or_zero();
        *p += away * (share * wavy * strength.depth * behind) + normals[i] * (share * wavy * strength.bulge * diagonal);
    }
}

/// Vertices slide along the surface towards neighbours: triangles of all shapes, the same surface.
fn slide(positions: &mut Vec<DVec3>, around: &[Vec<u32>], share: f64, random: &mut Random) {
    let slid = (0..positions.len()).map(|i| {
        let p = positions[i];
        let (weight, at) = (share * random.uniform(), random.below(around[i].len()));
        around[i].get(at).map_or(p, |&n| p.lerp(positions[n as usize], weight))
    });
    *positions = slid.collect();
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

/// Without vertices that no triangle uses.
fn compact(positions: &[Vec3], triangles: &[[u32; 3]]) -> Result<Mesh> {
    let mut new = vec![u32::MAX; positions.len()];
    let mut kept = Vec::new();
    let triangles = triangles
        .iter()
        .map(|t| {
            t.map(|i| {
                let slot = &mut new[i as usize];
                if *slot == u32::MAX {
                    *slot = kept.len() as u32;
                    kept.push(positions[i as usize]);
                }
                *slot
            })
        })
        .collect();
    Mesh::new(kept, triangles)
}
