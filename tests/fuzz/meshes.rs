//! Meshes of one to a million triangles, ordinary, degenerate, huge and tiny; and point clouds.

use std::f64::consts::{PI, TAU};

use glam::{DVec3, Vec3};
use nalgebra::Vector3;
use sim3align::error::Result;
use sim3align::geometry::mesh::Mesh;
use sim3align::geometry::random::Random;
use sim3align::geometry::surface_colors::SurfaceColors;

use crate::entropy::Entropy;
use crate::options::transform;

type Parts = (Vec<DVec3>, Vec<[u32; 3]>);

/// A mesh of at most about `most` triangles.
pub fn mesh(e: &mut Entropy<'_>, most: usize) -> Result<Mesh> {
    let count = e.size(8, most);
    let thin = e.pick(&[1e-2, 1e-4, 1e-7, 0.0]);
    let mut random = e.noise();
    let kind = if e.once_in(2) { e.below(8) } else { 0 };
    let (mut positions, mut triangles): Parts = match kind {
        0 => sphere(count, |p| p * DVec3::new(0.5, 0.3, 0.2) * (1.0 + 0.2 * (3.0 * p.x + 2.0 * p.y).sin())),
        1 => sphere(16, |p| p / p.abs().max_element()),
        2 => sphere(count, |p| p * DVec3::new(1.0, thin, 0.7)),
        3 => soup(count, || [0, 1, 2].map(|_| point(&mut random))),
        4 => soup(count, || {
            let at = point(&mut random);
            [at, at + thin * point(&mut random), at + thin * point(&mut random)]
        }),
        5 => soup(count, || {
            let [a, b] = [point(&mut random), point(&mut random)];
            [a, b, b + thin * point(&mut random)]
        }),
        6 => soup(count, || [DVec3::ZERO, point(&mut random), point(&mut random)]),
        _ => soup(1, || [DVec3::ZERO, DVec3::X, DVec3::Y]),
    };
    for _ in 0..e.below(6).saturating_sub(3) {
        spoil(e, most, &mut positions, &mut triangles);
    }
    let unit = e.power(44);
    Mesh::new(positions.into_iter().map(|p| (p * unit).as_vec3()).collect::<Vec<Vec3>>(), triangles)
}

fn spoil(e: &mut Entropy<'_>, most: usize, positions: &mut Vec<DVec3>, triangles: &mut Vec<[u32; 3]>) {
    let far = e.pick(&[10.0, 1e3, 1e6, 1e12, 1e25]);
    match e.below(9) {
        0 => positions.iter_mut().for_each(|p| *p *= DVec3::new(1.0, 1.0 / far, 1.0 / far)),
        1 => positions.iter_mut().for_each(|p| *p += DVec3::new(far, -far, far)),
        2 => positions.extend((0..e.size(1, most)).map(|i| DVec3::splat(far * (i % 7) as f64))),
        3 => positions.iter_mut().take(1).for_each(|p| *p *= far),
        4 => triangles.extend_from_within(..),
        5 => triangles.iter_mut().step_by(1 + e.below(5)).for_each(|t| t[1] = t[0]),
        6 => positions.iter_mut().take(1).for_each(|p| p.x = f64::NAN),
        7 => triangles.iter_mut().take(1).for_each(|t| t[2] = u32::MAX),
        _ => positions.iter_mut().for_each(|p| *p = DVec3::ONE),
    }
}

/// A deformed sphere of latitudes and longitudes.
fn sphere(count: usize, deform: impl Fn(DVec3) -> DVec3) -> Parts {
    let rows = ((count as f64 / 4.0).sqrt() as usize).max(2);
    let columns = 2 * rows;
    let at = |row: usize, column: usize| (row * columns + column % columns) as u32;
    let vertices = (0..=rows).flat_map(|row| (0..columns).map(move |column| (row, column)));
    let positions = vertices.map(|(row, column)| {
        let (polar, turn) = (PI * row as f64 / rows as f64, TAU * column as f64 / columns as f64);
        deform(DVec3::new(polar.sin() * turn.cos(), polar.cos(), polar.sin() * turn.sin()))
    });
    let quads = (0..rows).flat_map(|row| (0..columns).map(move |column| (row, column)));
    let triangles = quads.flat_map(|(row, column)| {
        let [a, b] = [at(row, column), at(row, column + 1)];
        let [c, d] = [at(row + 1, column), at(row + 1, column + 1)];
        [[a, c, b], [b, c, d]]
    });
    (positions.collect(), triangles.collect())
}

/// Three vertices per triangle.
fn soup(count: usize, mut corners: impl FnMut() -> [DVec3; 3]) -> Parts {
    let positions = (0..count).flat_map(|_| corners()).collect();
    (positions, (0..count as u32).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect())
}

fn point(random: &mut Random) -> DVec3 {
    DVec3::new(random.uniform(), random.uniform(), random.uniform())
}

/// A mesh, half of the time with a colour for each vertex.
pub fn colored_mesh(e: &mut Entropy<'_>, most: usize) -> Result<(Mesh, Option<SurfaceColors>)> {
    let mesh = mesh(e, most)?;
    if e.once_in(2) {
        return Ok((mesh, None));
    }
    let mut random = e.noise();
    let mut channel = || (256.0 * random.uniform()) as u8;
    let colors: Vec<_> = mesh.positions().iter().map(|_| [channel(), channel(), channel()]).collect();
    let colors = SurfaceColors::of_vertices(&mesh, &colors)?;
    Ok((mesh, Some(colors)))
}

/// Two clouds of interleaved coordinates; mostly the second is the first, moved.
pub fn clouds(e: &mut Entropy<'_>, most: usize) -> [Vec<f64>; 2] {
    let source = cloud(e, most);
    if e.once_in(3) {
        return [source, cloud(e, most)];
    }
    let pose = transform(e);
    let moved = source.chunks_exact(3).flat_map(|p| {
        let q = pose.apply(Vector3::new(p[0], p[1], p[2]));
        [q.x, q.y, q.z]
    });
    let moved = moved.collect();
    [source, moved]
}

fn cloud(e: &mut Entropy<'_>, most: usize) -> Vec<f64> {
    let count = if e.once_in(16) { e.below(40) } else { e.size(32, most) };
    let kind = e.below(7);
    let mut random = e.noise();
    let mut at = |i: usize| {
        let [x, y, z] = point(&mut random).to_array();
        match kind {
            0 => [x, y, 0.2 * (5.0 * x).sin() * (7.0 * y).cos() + 0.3 * x * y],
            1 => [x, y, z],
            2 => [x, y, 0.0],
            3 => [x, 2.0 * x, -x],
            4 => [0.5; 3],
            5 => [(i % 10) as f64, (i / 10 % 10) as f64, (i / 100) as f64],
            _ => [(i % 2) as f64; 3],
        }
    };
    let mut points: Vec<f64> = (0..count).flat_map(&mut at).collect();
    let (unit, far) = (e.power(30), e.pick(&[0.0, 0.0, 0.0, 0.0, 10.0, 1e6, 1e12]));
    points.iter_mut().for_each(|x| *x = (*x + far) * unit);
    match e.below(16) {
        14 => points.iter_mut().take(1).for_each(|x| *x = f64::NAN),
        15 => drop(points.pop()),
        _ => {}
    }
    points
}
