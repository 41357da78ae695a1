//! Triangles that share edges: every pixel is covered by exactly one of them.

use crate::prelude::*;

const WIDTH: usize = 48;
const HEIGHT: usize = 36;

/// How many of the triangles, each drawn alone, cover each pixel.
fn hits(positions: &[Vec3], triangles: &[[u32; 3]], camera: &Pinhole) -> Vec<u32> {
    let mut rasteriser = Rasteriser::new();
    let mut hits = vec![0; WIDTH * HEIGHT];
    for &triangle in triangles {
        // All vertices stay, so that the near plane does.
        let mesh = Mesh::new(positions.to_vec(), vec![triangle]).unwrap();
        rasteriser.render_depth(&mesh, &Similarity::identity(), camera, WIDTH, HEIGHT);
        for (hits, z) in hits.iter_mut().zip(rasteriser.depth()) {
            *hits += u32::from(*z > 0.0);
        }
    }
    hits
}

/// Quads between neighbouring rows and columns of vertices, each cut along a random diagonal, in random winding.
fn grid_triangles(columns: usize, rows: usize, random: &mut Random) -> Vec<[u32; 3]> {
    let mut triangles = Vec::new();
    for r in 0..rows - 1 {
        for c in 0..columns - 1 {
            let a = (r * columns + c) as u32;
            let (b, d) = (a + 1, a + columns as u32);
            let e = d + 1;
            let halves = if random.below(2) == 0 { [[a, b, e], [a, e, d]] } else { [[a, b, d], [b, e, d]] };
            triangles.extend(halves.map(|[p, q, r]| if random.below(2) == 0 { [p, q, r] } else { [p, r, q] }));
        }
    }
    triangles
}

#[wasm_bindgen_test(unsupported = test)]
fn a_crumpled_sheet_covers_every_pixel_once() {
    let camera = Pinhole::new(40.0, 41.0, 23.5, 17.0).unwrap();
    for seed in 0..25 {
        let mut random = Random::new(seed, 913);
        // Cells of 1.3 to 8 pixels, over the image's rim by two cells on every side.
        let cell = 1.3 + 6.7 * random.uniform();
        let (columns, rows) = ((WIDTH as f64 / cell) as usize + 5, (HEIGHT as f64 / cell) as usize + 5);
        let mut positions = Vec::new();
        for i in 0..columns * rows {
            let mut jitter = || (random.uniform() - 0.5) * 0.6;
            let mut place = |k: usize| ((k as f64 - 1.9) + jitter()) * cell;
            let (mut u, mut v) = (place(i % columns), place(i / columns));
            if seed % 2 == 0 {
                // Onto pixel centres and half way between, where the fill rule decides.
                (u, v) = ((u * 2.0).round() / 2.0, (v * 2.0).round() / 2.0);
            }
            positions.push(camera.back_project(u, v, 1.0 + 3.0 * random.uniform()));
        }
        // Rounded to half pixels, the smallest cells fold over; only the unrounded ones may be that small.
        if seed % 2 == 0 && cell < 4.0 {
            continue;
        }
        let triangles = grid_triangles(columns, rows, &mut random);
        for (i, hits) in hits(&positions, &triangles, &camera).into_iter().enumerate() {
            assert_eq!(hits, 1, "seed {seed}, cells of {cell} pixels: pixel ({}, {})", i % WIDTH, i / WIDTH);
        }
    }
}

#[wasm_bindgen_test(unsupported = test)]
fn fans_cover_every_pixel_around_their_centre_once() {
    let camera = Pinhole::new(30.0, 30.0, 24.0, 18.0).unwrap();
    for seed in 0..60 {
        let mut random = Random::new(seed, 914);
        let count = 3 + random.below(60) as u32;
        // Every third fan has its centre on a pixel's centre.
        let snap = |x: f64| if seed % 3 == 0 { x.round() } else { x };
        let center = [snap(10.0 + 28.0 * random.uniform()), snap(10.0 + 16.0 * random.uniform())];
        let radius = 200.0 * (1.0 + 1e5 * if seed % 4 == 1 { random.uniform() } else { 0.0 });
        let mut positions = vec![camera.back_project(center[0], center[1], 2.0)];
        for i in 0..count {
            let angle = core::f64::consts::TAU * (f64::from(i) + 0.8 * random.uniform()) / f64::from(count);
            let (u, v) = (center[0] + radius * libm::cos(angle), center[1] + radius * libm::sin(angle));
            positions.push(camera.back_project(u, v, 1.0 + 2.0 * random.uniform()));
        }
        // Three spokes may leave a gap beyond the rim of a triangle, but not within reach of the image.
        let triangles: Vec<_> = (0..count).map(|i| [0, 1 + i, 1 + (i + 1) % count]).collect();
        let hits = hits(&positions, &triangles, &camera);
        for (i, hits) in hits.into_iter().enumerate() {
            let (u, v) = (i % WIDTH, i / WIDTH);
            let near = (u as f64 - center[0]).abs().max((v as f64 - center[1]).abs()) < 8.0;
            assert!(hits == 1 || (!near && count < 8 && hits == 0), "seed {seed}: pixel ({u}, {v}) {hits} times");
        }
    }
}

#[wasm_bindgen_test(unsupported = test)]
fn a_floor_through_the_camera_plane_covers_every_pixel_once() {
    // A floor one unit below the camera, from far behind it to far before it: almost every triangle is cut by
    // the near plane, many by the guard band.
    let camera = Pinhole::new(25.0, 25.0, 23.5, 3.25).unwrap();
    for seed in 0..20 {
        let mut random = Random::new(seed, 915);
        let lines = |random: &mut Random, reach: f64| {
            let mut lines: Vec<f64> = (0..7).map(|_| (random.uniform() * 2.0 - 1.0) * reach).collect();
            lines.extend([-1e7, -0.3, 0.4, 1e7]);
            lines.sort_by(f64::total_cmp);
            lines
        };
        let (xs, zs) = (lines(&mut random, 4.0), lines(&mut random, 5.0));
        let zs: Vec<f64> = zs.into_iter().map(|z| z.min(1e3)).collect();
        let at = |i: usize| Vec3::new(xs[i % xs.len()] as f32, 1.0, zs[i / xs.len()] as f32);
        let positions: Vec<Vec3> = (0..xs.len() * zs.len()).map(at).collect();
        let triangles = grid_triangles(xs.len(), zs.len(), &mut random);
        let found = hits(&positions, &triangles, &camera);
        let mut rasteriser = Rasteriser::new();
        let whole = Mesh::new(positions, triangles).unwrap();
        rasteriser.render_depth(&whole, &Similarity::identity(), &camera, WIDTH, HEIGHT);
        for (i, hits) in found.into_iter().enumerate() {
            let v = i / WIDTH;
            // The horizon lies between rows 3 and 4; the near plane, at depth 0.1, far below the image.
            let expected = u32::from(v >= 4);
            assert_eq!(hits, expected, "seed {seed}: pixel ({}, {v})", i % WIDTH);
            let depth = 25.0 / (v as f32 - 3.25);
            let z = rasteriser.depth()[i];
            assert!(expected == 0 || (z / depth - 1.0).abs() < 1e-5, "seed {seed}, row {v}: {z}, expected {depth}");
        }
    }
}
