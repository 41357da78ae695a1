//! Surface points are told from points scattered through the volume.

use sim3align::register::at_once::dense_points;

use crate::prelude::*;

#[wasm_bindgen_test(unsupported = test)]
fn keeps_the_surface_and_drops_the_clutter() {
    for seed in 0..4 {
        let draw = &mut Draw::new(seed);
        let mut points = blob(draw, 3000).points;
        points.extend((0..3000).map(|_| vec3(&draw.cube(2.0))));
        let dense = dense_points(&points);
        let on_surface = dense.iter().filter(|&&i| i < 3000).count();
        let clutter = dense.len() - on_surface;
        assert!(on_surface > 2500, "seed {seed}: {on_surface} of 3000 surface points");
        assert!(clutter < 300, "seed {seed}: {clutter} of 3000 points of clutter");
        assert!(dense.is_sorted(), "seed {seed}");
    }
}

#[wasm_bindgen_test(unsupported = test)]
fn a_surface_alone_stays_whole_but_for_its_sparsest_spots() {
    for seed in 0..4 {
        let points = sphere_surface(&mut Draw::new(seed), 3000).points;
        let kept = dense_points(&points).len();
        assert!(kept > 2700, "seed {seed}: {kept} of 3000");
    }
    assert_eq!(dense_points(&[]), Vec::<usize>::new());
    assert_eq!(dense_points(&[Vec3::ONE; 20]).len(), 20);
}
