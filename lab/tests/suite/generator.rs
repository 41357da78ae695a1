//! The generated sets: the same bits from set, seed and index alone, and true poses by the package's own conventions.

use sim3align::align::evaluate::{EvaluateOptions, evaluate};
use sim3align_lab::case::Case;
use sim3align_lab::prelude::*;
use sim3align_lab::sets::Set;

/// FNV-1a over the depth, the masks, the meshes and the true poses of a case.
fn fingerprint(case: &Case) -> u64 {
    let mut bytes: Vec<u8> = Vec::new();
    for frame in &case.frames {
        bytes.extend(frame.depth.data().iter().flat_map(|z| z.to_le_bytes()));
        frame.masks.iter().flatten().for_each(|mask| bytes.extend(mask.data()));
        frame.photo.iter().for_each(|photo| bytes.extend(photo.data().as_flattened()));
        let poses = frame.truths.iter().flatten().flat_map(|pose| pose.to_column_major());
        bytes.extend(poses.flat_map(f64::to_le_bytes));
    }
    for object in &case.objects {
        bytes.extend(object.mesh.positions().iter().flat_map(|p| p.to_array()).flat_map(f32::to_le_bytes));
    }
    bytes.iter().fold(0xcbf2_9ce4_8422_2325, |hash, byte| (hash ^ u64::from(*byte)).wrapping_mul(0x0100_0000_01b3))
}

#[test]
fn a_case_follows_from_set_seed_and_index_alone() {
    for set in Set::ALL {
        let made = |seed, index| fingerprint(&set.case(seed, index, 2).unwrap());
        assert_eq!(made(1, 1), made(1, 1), "{set:?}");
        assert_ne!(made(1, 1), made(2, 1), "{set:?}");
        assert_ne!(made(1, 1), made(1, 3), "{set:?}");
    }
}

/// Easy cases hardly have errors: the true pose draws the object where mask and depth show it. A mistake in the convention
/// of a camera, a mask or a pose would show.
#[test]
fn the_true_pose_of_easy_cases_explains_their_images() {
    for (set, indices) in [(Set::General, [0, 3, 6]), (Set::Monocular, [0, 3, 6]), (Set::Videos, [0, 1, 2])] {
        for index in indices {
            let case = set.case(5, index, 2).unwrap();
            for frame in &case.frames {
                let truth = frame.truths[0].unwrap();
                let observation = frame.observation(0, false).unwrap();
                let mesh = &case.objects[0].mesh;
                let metrics = evaluate(&observation, mesh, &truth, &EvaluateOptions::default()).unwrap().metrics;
                let (iou, fitness) = (metrics.iou.unwrap(), metrics.fitness.unwrap());
                assert!(iou > 0.85 && fitness > 0.9, "{set:?} {}: IoU {iou}, fitness {fitness}", case.name);
            }
        }
    }
}
