//! Meshes of one to a million triangles: ordinary, degenerate, huge and tiny.

use super::choices::Choices;
use crate::prelude::*;

type Shape = fn(&mut Choices, usize) -> (Vec<DVec3>, Vec<[u32; 3]>);

/// The simplest first.
const SHAPES: [(&str, Shape); 9] = [
    ("blob", blob),
    ("box", |_, _| grid_sphere([4, 2], |p| p / p.abs().max_element())),
    ("large random triangles", large_triangles),
    ("small scattered triangles", small_triangles),
    ("needles", needles),
    ("nested spheres", nested),
    ("sheet", sheet),
    ("fan", fan),
    ("single triangle", |_, _| (vec![DVec3::ZERO, DVec3::X, DVec3::Y], vec![[0, 1, 2]])),
];

/// A mesh of at most about `most` triangles, and a description of it.
pub fn mesh(c: &mut Choices, most: usize) -> (String, Result<Mesh>) {
    let (name, shape) = if c.once_in(2) { SHAPES[c.below(SHAPES.len())] } else { SHAPES[0] };
    let count = c.size(8, most);
    let (mut positions, mut triangles) = shape(c, count);
    let mut words = format!("{name} of {} triangles", triangles.len());
    for _ in 0..c.below(6).saturating_sub(3) {
        match c.below(9) {
            0 => {}
            1 => {
                let flat = c.pick(&[1e-2, 1e-4, 1e-6, 0.0]);
                positions.iter_mut().for_each(|p| p.z *= flat);
                words += &format!(", flattened to {flat}");
            }
            2 => {
                let thin = c.pick(&[1e-1, 1e-3, 1e-6, 0.0]);
                positions.iter_mut().for_each(|p| *p *= DVec3::new(1.0, thin, thin));
                words += &format!(", thinned to {thin}");
            }
            3 => {
                let far = c.pick(&[10.0, 1e3, 1e6, 1e12, 1e25]);
                positions.iter_mut().for_each(|p| *p += DVec3::new(far, -far, far));
                words += &format!(", {far} from the origin");
            }
            4 => {
                let stray = c.pick(&[10.0, 1e6, 1e20]);
                let unused = c.size(1, most);
                positions.extend((0..unused).map(|i| DVec3::splat(stray * (i % 7) as f64)));
                words += &format!(", {unused} unused vertices");
            }
            5 => {
                let stray = c.pick(&[10.0, 1e3, 1e6, 1e18]);
                if let Some(last) = positions.last_mut() {
                    *last *= stray;
                }
                words += &format!(", a vertex {stray} away");
            }
            6 => {
                triangles.extend_from_within(..);
                words += ", doubled";
            }
            7 => {
                let step = 1 + c.below(5);
                triangles.iter_mut().step_by(step).for_each(|t| t[1] = t[0]);
                words += ", collapsed triangles";
            }
            _ => match c.below(3) {
                0 => positions.iter_mut().take(1).for_each(|p| p.x = f64::NAN),
                1 => triangles.iter_mut().take(1).for_each(|t| t[2] = u32::MAX),
                _ => positions.iter_mut().for_each(|p| *p = DVec3::ONE),
            },
        }
    }
    let unit = c.power(44);
    if unit != 1.0 {
        words += &format!(" × {unit:e}");
    }
    let positions = positions.into_iter().map(|p| (p * unit).as_vec3()).collect::<Vec<Vec3>>();
    (words, Mesh::new(positions, triangles))
}

/// A sphere of latitudes and longitudes, deformed.
fn grid_sphere([longitudes, latitudes]: [usize; 2], deform: impl Fn(DVec3) -> DVec3) -> (Vec<DVec3>, Vec<[u32; 3]>) {
    let [n, m] = [longitudes.max(3), latitudes.max(2)];
    let mut positions = Vec::with_capacity(n * (m + 1));
    for row in 0..=m {
        let polar = PI * row as f64 / m as f64;
        for column in 0..n {
            let turn = TAU * column as f64 / n as f64;
            let ring = libm::sin(polar);
            let p = DVec3::new(ring * libm::cos(turn), libm::cos(polar), ring * libm::sin(turn));
            positions.push(deform(p));
        }
    }
    let at = |row: usize, column: usize| (row * n + column % n) as u32;
    let quads = (0..m).flat_map(|row| (0..n).map(move |column| (row, column)));
    let triangles = quads.flat_map(|(row, column)| {
        let [a, b] = [at(row, column), at(row, column + 1)];
        let [c, d] = [at(row + 1, column), at(row + 1, column + 1)];
        [[a, c, b], [b, c, d]]
    });
    (positions, triangles.collect())
}

/// Longitudes and latitudes of a sphere of about `count` triangles.
fn fineness(count: usize) -> [usize; 2] {
    let side = ((count as f64 / 4.0).sqrt()).max(2.0);
    [(2.0 * side) as usize, side as usize]
}

fn blob(_: &mut Choices, count: usize) -> (Vec<DVec3>, Vec<[u32; 3]>) {
    grid_sphere(fineness(count), |p| p * DVec3::new(0.5, 0.3, 0.2) * (1.0 + 0.2 * libm::sin(3.0 * p.x + 2.0 * p.y)))
}

fn nested(c: &mut Choices, count: usize) -> (Vec<DVec3>, Vec<[u32; 3]>) {
    let layers = c.size(2, 64);
    let (mut positions, mut triangles) = (Vec::new(), Vec::new());
    for layer in 0..layers {
        let radius = 1.0 - 0.5 * layer as f64 / layers as f64;
        let (p, t) = grid_sphere(fineness(count / layers), |p| p * radius * DVec3::new(1.0, 0.7, 0.5));
        let offset = positions.len() as u32;
        positions.extend(p);
        triangles.extend(t.into_iter().map(|t| t.map(|i| i + offset)));
    }
    (positions, triangles)
}

fn point(random: &mut Random) -> DVec3 {
    DVec3::new(random.uniform(), random.uniform(), random.uniform())
}

/// Three vertices per triangle.
fn soup(count: usize, mut corners: impl FnMut() -> [DVec3; 3]) -> (Vec<DVec3>, Vec<[u32; 3]>) {
    let positions = (0..count).flat_map(|_| corners()).collect();
    (positions, (0..count as u32).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect())
}

fn large_triangles(c: &mut Choices, count: usize) -> (Vec<DVec3>, Vec<[u32; 3]>) {
    let mut random = c.noise();
    soup(count, || [point(&mut random), point(&mut random), point(&mut random)])
}

fn small_triangles(c: &mut Choices, count: usize) -> (Vec<DVec3>, Vec<[u32; 3]>) {
    let mut random = c.noise();
    let size = c.pick(&[0.01, 0.001, 1e-5]);
    soup(count, || {
        let at = point(&mut random);
        [at, at + size * point(&mut random), at + size * point(&mut random)]
    })
}

fn needles(c: &mut Choices, count: usize) -> (Vec<DVec3>, Vec<[u32; 3]>) {
    let mut random = c.noise();
    let width = c.pick(&[1e-2, 1e-4, 1e-7]);
    soup(count, || {
        let [a, b] = [point(&mut random), point(&mut random)];
        [a, b, b + width * point(&mut random)]
    })
}

fn sheet(c: &mut Choices, count: usize) -> (Vec<DVec3>, Vec<[u32; 3]>) {
    let thickness = c.pick(&[1e-1, 1e-3, 1e-4, 0.0]);
    grid_sphere(fineness(count), |p| p * DVec3::new(1.0, thickness, 0.7))
}

/// Triangles that share a vertex.
fn fan(c: &mut Choices, count: usize) -> (Vec<DVec3>, Vec<[u32; 3]>) {
    let mut random = c.noise();
    let mut positions = vec![DVec3::ZERO];
    positions.extend((0..2 * count).map(|_| point(&mut random)));
    (positions, (0..count as u32).map(|t| [0, 2 * t + 1, 2 * t + 2]).collect())
}
