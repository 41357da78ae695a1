//! What several tests of generated cases share.

use sim3align_lab::bench::benchmark::BenchCase;
use sim3align_lab::cases::case::EvaluationCase;
use sim3align_lab::prelude::*;

/// A path of its own for a test of this process; nothing is there.
pub fn fresh(name: &str) -> PathBuf {
    let path = std::env::temp_dir().join(format!("sim3align-{}-{name}", std::process::id()));
    let _ = std::fs::remove_dir_all(&path);
    path
}

/// The magnitude of a simulated error.
pub fn parameter(parameters: &[(&'static str, f64)], name: &str) -> f64 {
    parameters.iter().find(|(n, _)| *n == name).unwrap().1
}

/// Number of pixels in the mask.
pub fn mask_px(observation: &Observation) -> usize {
    observation.mask().data().iter().filter(|m| **m != 0).count()
}

/// z-depth of the object of a case without its faults and alone; 0 beside it.
pub fn object_depth(case: &EvaluationCase) -> Vec<f32> {
    depth_of(&case.object, &case.camera_from_object, &case.observation)
}

/// z-depth of a mesh alone, as the camera of an observation sees it; 0 beside it.
pub fn depth_of(mesh: &Mesh, pose: &Similarity, observation: &Observation) -> Vec<f32> {
    let depth = observation.depth();
    let mut rasteriser = Rasteriser::new();
    rasteriser.render_depth(mesh, pose, &observation.camera(), depth.width(), depth.height());
    rasteriser.depth().to_vec()
}

/// The mesh is closed, consistently oriented (every edge is walked once in each direction), and faces outward.
pub fn assert_closed(mesh: &Mesh, name: &str) {
    let edges = mesh.triangles().iter().flat_map(|&[a, b, c]| [(a, b), (b, c), (c, a)]);
    let mut walked: Vec<(u32, u32)> = edges.collect();
    walked.sort_unstable();
    assert!(walked.windows(2).all(|pair| pair[0] != pair[1]), "{name}");
    assert!(walked.iter().all(|&(a, b)| walked.binary_search(&(b, a)).is_ok()), "{name}");
    assert!(mesh.signed_volume6() > 0.0, "{name}: inside out");
}

/// The mesh has a shape, and is as generators deliver it: centred, in a box whose longest side is 1.
pub fn assert_canonical(mesh: &Mesh, name: &str) {
    sim3align::geometry::surface::check_shape(mesh).unwrap();
    let farthest = mesh.positions().iter().fold(0.0f32, |far, p| far.max(p.length()));
    assert!((0.5..=0.87).contains(&farthest), "{name}: {farthest}");
}

/// Two poses are the same but for the last digits.
pub fn assert_near(a: &Similarity, b: &Similarity, tolerance: f64) {
    let off = [a.scale / b.scale - 1.0, a.rotation_angle_to(b), (a.translation - b.translation).norm()];
    assert!(off.iter().all(|x| x.abs() <= tolerance), "{off:?}");
}

/// A case read from its folder is the case that was written there.
pub fn assert_read_back(read: &BenchCase, made: &BenchCase) {
    assert_eq!(read.observation.depth(), made.observation.depth());
    assert_eq!(read.observation.photo(), made.observation.photo());
    let masks = read.observation.mask().data().iter().zip(made.observation.mask().data());
    assert!(masks.into_iter().all(|(a, b)| (*a != 0) == (*b != 0)));
    assert_eq!((&read.mesh, &read.colors), (&made.mesh, &made.colors));
    assert_eq!((&read.tier, &read.class, &read.family), (&made.tier, &made.class, &made.family));
    assert_eq!(read.tags, made.tags);
    for (name, value) in made.parameters.as_object().unwrap() {
        let Some(value) = value.as_f64() else {
            assert_eq!(&read.parameters[name], value);
            continue;
        };
        // Decimals are read to all but the last bit.
        let off = read.parameters[name].as_f64().unwrap() - value;
        assert!(off.abs() <= 1e-12 * value.abs(), "{name}");
    }
    let [read, made] = [read, made].map(|case| case.truth.as_ref().unwrap());
    assert_near(&read.camera_from_mesh, &made.camera_from_mesh, 1e-12);
    match (&read.symmetry, &made.symmetry) {
        (Symmetry::Declared(read), Symmetry::Declared(made)) => {
            assert_eq!(read.len(), made.len());
            for (read, made) in read.iter().zip(made) {
                assert!((read.axis - made.axis).norm() < 1e-12 && read.fold == made.fold, "{read:?}, {made:?}");
            }
        }
        (read, made) => assert_eq!(read, made),
    }
}
