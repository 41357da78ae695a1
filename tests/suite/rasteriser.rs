//! The exact rasteriser against casting a ray per pixel at every triangle, in f64, and triangles that share edges.

use sim3align::geometry::rasteriser::{NEAR, NO_TRIANGLE};

use crate::prelude::*;
use crate::shapes::soup;

/// Snapping moves a vertex by at most √2/512 pixel; nearer than this to an outline nothing is claimed.
const EDGE_PX: f64 = 0.004;

const WIDTH: usize = 48;
const HEIGHT: usize = 36;

/// The intersections of one ray.
struct Ray {
    /// Depth and triangle of each hit.
    hits: Vec<(f64, u32)>,
    /// Whether it passes an outline too near to tell.
    unclear: bool,
}

fn cast(triangles: &[[DVec3; 3]], camera: &Pinhole, near: f64, u: usize, v: usize) -> Ray {
    let direction = DVec3::new((u as f64 - camera.cx) / camera.fx, (v as f64 - camera.cy) / camera.fy, 1.0);
    // Distance, in pixels, to the line on which a function m·direction of the pixel is zero.
    let pixels = |m: DVec3| m.dot(direction).abs() / (m.x / camera.fx).hypot(m.y / camera.fy);
    let mut ray = Ray { hits: Vec::new(), unclear: false };
    for (id, &[a, b, c]) in (0..).zip(triangles) {
        let sides = [a.cross(b), b.cross(c), c.cross(a)];
        let volume = a.dot(b.cross(c));
        if volume == 0.0 {
            continue;
        }
        // Inside the triangle's cone, forward or mirrored, or so near to one of its sides that it could be.
        let weights = sides.map(|m| m.dot(direction) / volume);
        let clear = sides.map(|m| pixels(m) > EDGE_PX);
        if (0..3).any(|i| clear[i] && weights[i] < 0.0) {
            continue;
        }
        // direction = Σ wᵢ·vᵢ up to order; the ray meets the plane at 1 / Σ wᵢ.
        let inverse_depth: f64 = weights.iter().sum();
        let plane = (sides[0] + sides[1] + sides[2]) / volume;
        let cut_px = pixels(plane - DVec3::Z / near);
        // Seen edge-on, even before or behind is a matter of the outline.
        ray.unclear |= clear.contains(&false);
        if cut_px > EDGE_PX && inverse_depth > 1.0 / near || inverse_depth <= 0.0 {
            continue;
        }
        ray.unclear |= cut_px <= EDGE_PX;
        ray.hits.push((1.0 / inverse_depth, id));
    }
    ray.hits.sort_by(|a, b| a.partial_cmp(b).unwrap());
    ray
}

/// Triangles of all sizes, before, beside and behind the camera and across its plane.
fn scene(random: &mut Random, deep: bool) -> Mesh {
    let count = 5 + random.below(40);
    let mut number = |low: f64, high: f64| low + (high - low) * random.uniform();
    // Giants decide where the near plane is: those of a deep scene cut all else away.
    let giant = if deep { 5e6 } else { 100.0 };
    let mut positions = Vec::new();
    for i in 0..count {
        let (size, z) = match i % 5 {
            0 | 1 => ([0.05, 0.7][i % 5], number(0.5, 4.0)),
            2 => (3.0, number(-2.0, 3.0)),
            3 if i < 10 => (giant, number(-1.0, 6.0)),
            3 => (1.0, number(-1.0, 6.0)),
            _ => (0.3, number(-1.0, 1.0)),
        };
        let center = [number(-1.0, 1.0), number(-1.0, 1.0), z];
        for corner in 0..3 {
            // Every seventh is a needle: its last corner almost on the middle of the other two.
            if i % 7 == 6 && corner == 2 {
                let n = positions.len();
                let middle: Vec3 = (positions[n - 1] + positions[n - 2]) * 0.5;
                positions.push(middle + Vec3::splat(number(-0.01, 0.01) as f32));
            } else {
                positions.push(Vec3::from_array(center.map(|x| (x + number(-size, size)) as f32)));
            }
        }
    }
    soup(positions)
}

#[wasm_bindgen_test]
fn equals_ray_casting() {
    let (mut compared, mut covered) = (0, 0);
    let mut rasteriser = Rasteriser::new();
    for seed in 0..60 {
        let mut random = Random::new(seed, 912);
        let mesh = scene(&mut random, seed % 5 == 0);
        let mut number = |low: f64, high: f64| low + (high - low) * random.uniform();
        let camera =
            Pinhole::new(number(5.0, 60.0), number(5.0, 60.0), number(-10.0, 50.0), number(0.0, 30.0)).unwrap();
        let axis = Vector3::new(number(-3.0, 3.0), number(-3.0, 3.0), number(-3.0, 3.0));
        let pose = Similarity {
            scale: number(0.5, 2.0),
            rotation: Rotation3::new(axis),
            translation: Vector3::new(number(-0.5, 0.5), number(-0.5, 0.5), number(-1.0, 4.0)),
        };
        rasteriser.render(&mesh, &pose, &camera, WIDTH, HEIGHT);
        let (window, spans) = Rasteriser::new().render_spans(&mesh, &pose, &camera, [WIDTH, HEIGHT]);

        let posed = |p: &Vec3| {
            let p = pose.apply(Vector3::new(p.x.into(), p.y.into(), p.z.into()));
            DVec3::new(p.x, p.y, p.z)
        };
        let points: Vec<DVec3> = mesh.positions().iter().map(posed).collect();
        let near = NEAR * points.iter().map(|p| p.z).fold(1e-20, f64::max);
        let triangles: Vec<_> = mesh.triangles().iter().map(|t| t.map(|i| points[i as usize])).collect();
        for i in 0..WIDTH * HEIGHT {
            let (u, v) = (i % WIDTH, i / WIDTH);
            let (z, id) = (f64::from(rasteriser.depth()[i]), rasteriser.triangles()[i]);
            assert_eq!(z > 0.0, id != NO_TRIANGLE);
            let ray = cast(&triangles, &camera, near, u, v);
            if ray.unclear {
                continue;
            }
            compared += 1;
            let context = format!("seed {seed}, pixel ({u}, {v}): depth {z}, triangle {id}, hits {:?}", ray.hits);
            let [column, row] = [u.wrapping_sub(window.first[0]), v.wrapping_sub(window.first[1])];
            let is_inside = column < window.size[0] && row < window.size[1];
            let span = if is_inside { spans[row * window.size[0] + column].map(f64::from) } else { [0.0; 2] };
            let (Some(&(expected, first)), Some((farthest, _))) = (ray.hits.first(), ray.hits.last()) else {
                assert!(id == NO_TRIANGLE && span == [0.0; 2], "{context}, span {span:?}");
                continue;
            };
            assert!(span[0] == z && (span[1] / farthest - 1.0).abs() < 1e-5, "{context}, span {span:?}");
            covered += 1;
            assert!((z / expected - 1.0).abs() < 1e-5, "{context}");
            let as_near = ray.hits.iter().take_while(|(z, _)| *z < expected * (1.0 + 1e-6));
            assert!(id == first || as_near.clone().any(|&(_, t)| t == id), "{context}");
        }
    }
    // Most pixels are clear, and both kinds occur.
    let all = 60 * WIDTH * HEIGHT;
    assert!(compared > all * 99 / 100 && covered > all / 5 && covered < compared / 2, "{compared} {covered} of {all}");
}

/// A sheet of quads with corners on and between pixel centres, each cut along a random diagonal: no pixel is left out, and
/// none is covered by two triangles.
#[wasm_bindgen_test]
fn triangles_that_share_edges_cover_every_pixel_once() {
    let camera = Pinhole::new(40.0, 41.0, 23.5, 17.0).unwrap();
    for seed in 0..12 {
        let mut random = Random::new(seed, 913);
        let cell = 4.0 + 4.0 * random.uniform();
        let (columns, rows) = ((WIDTH as f64 / cell) as usize + 5, (HEIGHT as f64 / cell) as usize + 5);
        let corner = |i: usize, random: &mut Random| {
            let mut place = |k: usize| ((k as f64 - 1.9) + 0.6 * (random.uniform() - 0.5)) * cell;
            let at = [place(i % columns), place(i / columns)];
            let [u, v] = if seed % 2 == 0 { at.map(|x| (2.0 * x).round() / 2.0) } else { at };
            camera.back_project(u, v, 1.0 + 3.0 * random.uniform())
        };
        let positions: Vec<Vec3> = (0..columns * rows).map(|i| corner(i, &mut random)).collect();
        let mut rasteriser = Rasteriser::new();
        let mut hits = vec![0; WIDTH * HEIGHT];
        for (row, column) in (0..rows - 1).flat_map(|row| (0..columns - 1).map(move |column| (row, column))) {
            let [a, b, d, e] = [0, 1, columns, columns + 1].map(|step| (row * columns + column + step) as u32);
            let halves = if random.below(2) == 0 { [[a, b, e], [a, d, e]] } else { [[a, b, d], [b, d, e]] };
            for half in halves {
                // All vertices stay, so that the near plane does.
                let mesh = Mesh::new(positions.clone(), vec![half]).unwrap();
                rasteriser.render(&mesh, &Similarity::identity(), &camera, WIDTH, HEIGHT);
                hits.iter_mut().zip(rasteriser.depth()).for_each(|(hits, z)| *hits += i32::from(*z > 0.0));
            }
        }
        let wrong: Vec<usize> = (0..hits.len()).filter(|i| hits[*i] != 1).collect();
        assert!(wrong.is_empty(), "seed {seed}, cells of {cell} pixels: {} pixels, first {}", wrong.len(), wrong[0]);
    }
}
