//! One side of the triangles: of a closed mesh it makes the image of both; a mesh that is open, or inside out in part, keeps both.

use sim3align::precise::drawing::facing::draw_one_side;

use crate::prelude::*;
use crate::score::{WIDTH, pose};

/// The models of a mesh, and one that draws both sides.
fn models(mesh: &Mesh) -> ([Model; 5], Model) {
    let normal = MeshFrame::of(mesh).normalized(mesh).unwrap();
    let mut models = [0; 5].map(|_| Model::new(&normal));
    draw_one_side(&normal, &mut models);
    (models, Model::new(&normal))
}

/// The share of cells that differ between images of one and of both sides, and the work of the former relative to the latter.
fn compared(mesh: &Mesh) -> (f64, f64) {
    let ([one, ..], both) = models(mesh);
    let grid = CropGrid::blank(WIDTH, 60.0);
    let [mut of_one, mut of_both] = [Canvas::default(), Canvas::default()];
    let (mut differ, mut cells) = (0, 0);
    for seed in 0..40 {
        let draw = &mut Draw::new(seed);
        let pose = pose(draw, 10.0);
        let stretch = glam::Mat3::from_diagonal(Vec3::new(1.1, draw.between(0.9, 1.1) as f32, 0.95));
        of_one.draw_stretched(&one, &pose, &stretch, &grid);
        of_both.draw_stretched(&both, &pose, &stretch, &grid);
        for (a, b) in of_one.inverse_depth.iter().zip(&of_both.inverse_depth) {
            differ += usize::from((a - b).abs() > 1e-3 * b);
            cells += usize::from(*b > 0.0);
        }
    }
    (differ as f64 / cells as f64, of_one.work as f64 / of_both.work as f64)
}

#[wasm_bindgen_test]
fn closed_meshes_have_the_image_of_both_sides() {
    let body = mapped(&ellipsoid(Vec3::new(0.5, 0.36, 0.28), 24), |p| p * (1.0 + 0.4 * libm::sinf(5.0 * p.x + 1.0)));
    let inside_out =
        Mesh::new(body.positions().to_vec(), body.triangles().iter().map(|&[a, b, c]| [a, c, b]).collect());
    for (name, mesh) in [("outward", body), ("inside out", inside_out.unwrap())] {
        let (differ, work) = compared(&mesh);
        assert!(differ < 2e-3 && work < 0.8, "{name}: {differ} of the cells differ, {work} of the work");
    }
}

#[wasm_bindgen_test]
fn meshes_that_show_both_sides_draw_both() {
    let ball = sphere(0.5, 16);
    let bowl = Mesh::new(ball.positions().to_vec(), ball.triangles()[..ball.triangles().len() / 2].to_vec()).unwrap();
    let turned = mapped(&sphere(0.4, 16), |p| Vec3::new(1.0 - p.x, p.y, p.z));
    for (name, mesh) in [("bowl", bowl), ("a ball and one inside out", joined(&ball, &turned))] {
        let (differ, work) = compared(&mesh);
        assert!(differ == 0.0 && work == 1.0, "{name}: {differ} of the cells differ, {work} of the work");
    }
}
