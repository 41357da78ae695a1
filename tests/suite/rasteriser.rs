//! The rasteriser on cases computed by hand.

use sim3align::geometry::image::Window;

use crate::prelude::*;

/// With this camera, (u, v, 1) falls on pixel (u, v).
fn plain() -> Pinhole {
    Pinhole::new(1.0, 1.0, 0.0, 0.0).unwrap()
}

fn triangles(corners: &[[f32; 3]]) -> Mesh {
    Mesh::from_flat(corners.as_flattened(), None).unwrap()
}

/// The pixels drawn, as rows of `#` and `.`.
fn picture(mesh: &Mesh, width: usize, height: usize) -> String {
    let mut rasteriser = Rasteriser::new();
    rasteriser.render_depth(mesh, &Similarity::identity(), &plain(), width, height);
    let row = |row: &[f32]| row.iter().map(|z| if *z > 0.0 { '#' } else { '.' }).collect::<String>();
    rasteriser.depth().chunks(width).map(row).collect::<Vec<_>>().join(" ")
}

#[wasm_bindgen_test(unsupported = test)]
fn edges_follow_the_top_left_rule() {
    let (a, b, c, d) = ([1.0, 1.0, 1.0], [3.0, 1.0, 1.0], [3.0, 3.0, 1.0], [1.0, 3.0, 1.0]);
    // A square on pixel centres: its left and top edges are in, its right and bottom ones out.
    for square in [[a, b, c, a, c, d], [a, c, b, a, d, c], [b, c, d, b, d, a], [d, a, b, c, b, d]] {
        assert_eq!(picture(&triangles(&square), 5, 5), "..... .##.. .##.. ..... .....");
    }
    // Its halves share the diagonal, and each pixel on it is in exactly one of them.
    assert_eq!(picture(&triangles(&[a, b, c]), 4, 4), ".... .##. ..#. ....");
    assert_eq!(picture(&triangles(&[a, c, d]), 4, 4), ".... .... .#.. ....");
    assert_eq!(picture(&triangles(&[a, b, d]), 4, 4), ".... .##. .#.. ....");
    assert_eq!(picture(&triangles(&[b, c, d]), 4, 4), ".... .... ..#. ....");
    // Shifted by a quarter pixel, the centres lie within.
    let shifted = [a, b, c, a, c, d].map(|[u, v, z]| [u - 0.25, v + 0.25, z]);
    assert_eq!(picture(&triangles(&shifted), 5, 5), "..... ..... .##.. .##.. .....");
}

#[wasm_bindgen_test(unsupported = test)]
fn small_and_flat_triangles_draw_nothing_between_centres() {
    let between = [[1.2, 1.2, 1.0], [1.8, 1.2, 1.0], [1.5, 1.8, 1.0]];
    let line = [[0.0, 0.0, 1.0], [2.0, 2.0, 1.0], [4.0, 4.0, 1.0]];
    let point = [[1.0, 1.0, 1.0]; 3];
    for nothing in [between, line, point] {
        assert_eq!(picture(&triangles(&nothing), 3, 3), "... ... ...", "{nothing:?}");
    }
    let around = [[0.9, 0.9, 1.0], [1.2, 0.9, 1.0], [0.9, 1.2, 1.0]];
    assert_eq!(picture(&triangles(&around), 3, 3), "... .#. ...");
}

#[wasm_bindgen_test(unsupported = test)]
fn the_nearest_is_drawn_and_of_equals_the_first() {
    let at = |z: f32| [[-9.0 * z, -9.0 * z, z], [99.0 * z, -9.0 * z, z], [-9.0 * z, 99.0 * z, z]];
    let cases: [(&[f32], u32, f32); 4] =
        [(&[2.0, 1.0, 3.0], 1, 1.0), (&[1.0, 1.0, 2.0], 0, 1.0), (&[3.0, 2.0, 2.0], 1, 2.0), (&[-1.0, 2.0], 1, 2.0)];
    for (depths, triangle, depth) in cases {
        let mesh = triangles(&depths.iter().flat_map(|&z| at(z)).collect::<Vec<_>>());
        let mut rasteriser = Rasteriser::new();
        rasteriser.render(&mesh, &Similarity::identity(), &plain(), 4, 3);
        assert_eq!(rasteriser.triangles(), [triangle; 12], "{depths:?}");
        assert_eq!(rasteriser.depth(), [depth; 12], "{depths:?}");
    }
}

#[wasm_bindgen_test(unsupported = test)]
fn what_is_nearer_than_the_near_plane_is_cut() {
    // The floor four units below, out to depth 1000: the near plane is at 0.1, where v = 4/0.1 = 40.
    let floor = [[-1e4, 4.0, -50.0], [1e4, 4.0, -50.0], [1e4, 4.0, 1e3], [-1e4, 4.0, 1e3]];
    let mesh = triangles(&[floor[0], floor[1], floor[2], floor[0], floor[2], floor[3]]);
    let rows: Vec<_> = (0..43).map(|v| if (1..40).contains(&v) { "##" } else { ".." }).collect();
    assert_eq!(picture(&mesh, 2, 43), rows.join(" "));
}

#[wasm_bindgen_test(unsupported = test)]
fn edges_from_beyond_the_guard_band_stay_straight() {
    // Half planes: a triangle with one edge through the image and corners 2²² pixels away, twice as far as the
    // guard band reaches. All coordinates are exact in f32.
    let (through, reach) = ([10.5f32, 7.5], (1 << 22) as f32);
    let steps = [-1.0f32, -0.5, 0.0, 0.5, 1.0];
    let directions = steps.iter().flat_map(|&a| steps.map(|b| [a, b])).filter(|d| d[0].abs().max(d[1].abs()) == 1.0);
    let mut rasteriser = Rasteriser::new();
    for [a, b] in directions {
        let at = |du: f32, dv: f32| [through[0] + reach * du, through[1] + reach * dv, 1.0];
        let mesh = triangles(&[at(-a, -b), at(a, b), at(-b, a)]);
        rasteriser.render_depth(&mesh, &Similarity::identity(), &plain(), 20, 16);
        for (i, z) in rasteriser.depth().iter().enumerate() {
            let side = a * ((i / 20) as f32 - through[1]) - b * ((i % 20) as f32 - through[0]);
            let drawn = *z > 0.0;
            assert!(
                side.abs() < 0.01 || drawn == (side > 0.0),
                "edge along ({a}, {b}), pixel {i}: side {side}, {drawn}"
            );
        }
    }
}

#[wasm_bindgen_test(unsupported = test)]
fn buffers_are_reused_without_a_trace() {
    let (ball, pose) =
        (sphere(1.0, 12), Similarity { translation: Vector3::new(0.1, 0.2, 4.0), ..Similarity::identity() });
    let camera = Pinhole::new(30.0, 31.0, 14.0, 12.0).unwrap();
    let mut fresh = Rasteriser::new();
    fresh.render(&ball, &pose, &camera, 30, 20);
    assert!(fresh.depth().contains(&0.0) && fresh.depth().iter().any(|z| *z > 0.0));
    let mut used = Rasteriser::new();
    used.render(&cuboid(Vec3::splat(9.0)), &pose, &camera, 50, 60);
    used.render(&ball, &pose, &camera, 30, 20);
    assert_eq!((used.depth(), used.triangles()), (fresh.depth(), fresh.triangles()));
    used.render_depth(&ball, &pose, &camera, 30, 20);
    assert_eq!(used.depth(), fresh.depth());
    assert!(used.triangles().is_empty());
    assert_eq!((used.width(), used.height()), (30, 20));
}

#[wasm_bindgen_test(unsupported = test)]
fn a_window_has_the_pixels_of_the_whole_image() {
    let (width, height) = (70, 50);
    let camera = Pinhole::new(60.0, 61.0, 34.3, 24.7).unwrap();
    let (mut whole, mut part) = (Rasteriser::new(), Rasteriser::new());
    let mut smaller = 0;
    // In the middle, across each border, outside, around the camera, and behind it.
    for place in
        [[0.0, 0.0, 4.0], [2.0, 0.3, 4.0], [-2.2, -1.5, 4.0], [0.1, 9.0, 4.0], [0.0, 0.0, 0.5], [0.3, 0.1, -4.0]]
    {
        let pose = Similarity { translation: Vector3::from(place), ..Similarity::identity() };
        let must = Window { first: [5, 40], size: [3, 2] };
        whole.render_depth(&sphere(1.0, 12), &pose, &camera, width, height);
        let window = part.render_depth_around(&sphere(1.0, 12), &pose, &camera, [width, height], must);
        assert_eq!([part.width(), part.height()], window.size, "{place:?}");
        let mut expected = vec![0.0; width * height];
        for (i, z) in part.depth().iter().enumerate() {
            let at = [i % window.size[0] + window.first[0], i / window.size[0] + window.first[1]];
            expected[at[1] * width + at[0]] = *z;
        }
        assert_eq!(expected, whole.depth(), "{place:?}: {window:?}");
        assert_eq!(window.union(must), window, "{place:?}");
        smaller += usize::from(window.size[0] * window.size[1] < width * height);
    }
    assert_eq!(smaller, 4);
}

#[wasm_bindgen_test(unsupported = test)]
fn extreme_numbers_draw_nothing_wrong() {
    let mut rasteriser = Rasteriser::new();
    let mesh = cuboid(Vec3::ONE);
    let wild = [1e-300, 1e-40, 1e40, 1e300];
    for scale in wild {
        for t in wild {
            for c in [-1e300, 0.0, 1e300] {
                let camera = Pinhole { fx: 50.0, fy: 1e300, cx: c, cy: 3.0 };
                let pose = Similarity { scale, translation: Vector3::new(0.0, t, t), ..Similarity::identity() };
                rasteriser.render(&mesh, &pose, &camera, 8, 8);
                let fine = |z: &f32| *z >= 0.0 && !z.is_nan();
                assert!(rasteriser.depth().iter().all(fine), "scale {scale}, translation {t}, cx {c}");
            }
        }
    }
}
