//! The measurement of outlines: known offsets are found.

use sim3align_geometry::distance_transform::within;
use sim3align_lab::outlines::{ObjectOutlines, OutlineView, table};
use sim3align_lab::prelude::*;

const WIDTH: usize = 640;
const HEIGHT: usize = 480;
const OBJECT_M: f32 = 1.0;
const WALL_M: f32 = 1.5;

/// A box half a metre wide, one metre away, in front of a wall; mask and depth show it moved and grown by pixels.
struct Shown {
    mask_grown: u32,
    depth_grown: u32,
    depth_shift: [usize; 2],
    /// Pixels without a reading around the object.
    gap: u32,
    /// Pixels between object and wall that have a depth between.
    ramp: u32,
}

const EXACT: Shown = Shown { mask_grown: 0, depth_grown: 0, depth_shift: [0, 0], gap: 0, ramp: 0 };

fn cuboid() -> Mesh {
    let corner = |i: u32| {
        let side = |bit: u32, half: f32| if i >> bit & 1 == 1 { half } else { -half };
        Vec3::new(side(0, 0.13), side(1, 0.1), side(2, 0.01))
    };
    let quads = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    let triangles = quads.iter().flat_map(|[a, b, c, d]| [[*a, *b, *c], [*a, *c, *d]]).collect();
    Mesh::new((0..8).map(corner).collect(), triangles).unwrap()
}

fn measured(shown: &Shown) -> ObjectOutlines {
    let mesh = cuboid();
    let camera = Pinhole::new(600.0, 600.0, 319.5, 239.5).unwrap();
    let mut camera_from_mesh = Similarity::identity();
    camera_from_mesh.translation.z = f64::from(OBJECT_M);
    // Turned in the image, so that its edges cross the rows of pixels.
    let turn = Rotation3::from_axis_angle(&Vector3::z_axis(), 0.3);
    camera_from_mesh.rotation = turn;
    let mut rasteriser = Rasteriser::new();
    rasteriser.render_depth(&mesh, &camera_from_mesh, &camera, WIDTH, HEIGHT);
    let object: Vec<bool> = rasteriser.depth().iter().map(|z| *z > 0.0).collect();
    let grown = |by: u32| within(by, &object, WIDTH, HEIGHT);
    let mask = grown(shown.mask_grown).iter().map(|inside| u8::from(*inside)).collect();
    let [near, gap, ramp] = [0, shown.gap, shown.gap + shown.ramp].map(|more| grown(shown.depth_grown + more));
    let [right, down] = shown.depth_shift;
    let depth = (0..WIDTH * HEIGHT).map(|i| {
        let Some(i) = i.checked_sub(down * WIDTH + right) else { return WALL_M };
        match [near[i], gap[i], ramp[i]] {
            [true, ..] => OBJECT_M,
            [_, true, _] => 0.0,
            [.., true] => 0.5 * (OBJECT_M + WALL_M),
            _ => WALL_M,
        }
    });
    let view = OutlineView {
        name: "box".into(),
        group: "box".into(),
        depth: DepthMap::from_metres(WIDTH, HEIGHT, depth.collect()).unwrap(),
        mask: Mask::new("mask", WIDTH, HEIGHT, mask).unwrap(),
        photo: None,
        camera,
        mesh,
        camera_from_mesh,
    };
    ObjectOutlines::of(&view).unwrap()
}

fn close(found: f64, expected: f64) {
    assert!((found - expected).abs() <= 0.4, "found {found}, expected {expected}");
}

#[test]
fn exact_outlines_have_no_offset() {
    let found = measured(&EXACT);
    close(found.mask.unwrap().median, 0.0);
    close(found.depth.unwrap().median, 0.0);
    assert_eq!(found.masked, 1.0);
    assert_eq!(found.mixed, Some(0.0));
    assert!(found.quality.grain_m < 1e-4, "{:?}", found.quality);
}

#[test]
fn a_mask_too_large_and_a_depth_map_that_is_shifted_are_told_apart() {
    let found = measured(&Shown { mask_grown: 2, depth_shift: [3, 1], ..EXACT });
    close(found.mask.unwrap().median, 2.0);
    let [x, y] = found.depth.unwrap().shift.unwrap();
    close(x, 3.0);
    close(y, 1.0);
    let [x, y] = found.mask.unwrap().shift.unwrap();
    close(x, 0.0);
    close(y, 0.0);
}

#[test]
fn fattened_edges_gaps_and_mixed_pixels_are_found() {
    let fattened = measured(&Shown { depth_grown: 4, ..EXACT });
    close(fattened.depth.unwrap().median, 4.0);
    close(fattened.depth_from_mask.unwrap().median, 4.0);
    let gap = measured(&Shown { gap: 3, ..EXACT });
    close(gap.depth.unwrap().median, 0.0);
    close(gap.gap.unwrap()[0], 3.0);
    let ramp = measured(&Shown { ramp: 2, ..EXACT });
    // Two of the six pixels that are looked at, or a little more at the corners.
    assert!((0.2..0.45).contains(&ramp.mixed.unwrap()), "{:?}", ramp.mixed);
    let table = table::report(&[fattened, gap, ramp]);
    assert!(table.contains("| box | 3 |"), "{table}");
}
