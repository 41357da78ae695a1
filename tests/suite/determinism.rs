//! The same bits on every platform: the stages' results on a seeded scene against fingerprints that hold natively
//! and in WebAssembly alike.
//!
//! A stage that is changed on purpose changes its fingerprint and those after it. Take the new ones over from the
//! failure message once native and WebAssembly print the same.

use sim3align::geometry::voxel_grid::voxel_downsample;
use sim3align::register::at_once::{fpfh, nearest, ransac, refine};
use sim3align::register::icp::{IcpMetric, IcpSettings};
use sim3align::register::ransac::RansacSettings;
use sim3align::register::support::SupportSettings;

use crate::prelude::*;

#[wasm_bindgen_test(unsupported = test)]
fn stages_give_the_same_bits_everywhere() {
    let mut draw = Draw::new(2024);
    let source = unit_box(&mug(&mut draw, 3000));
    let truth = draw.similarity([0.8, 1.2], 0.1);
    let mut target = transformed(&source, &truth);
    target.points = draw.noisy(&target.points, 0.001);
    let (source, target) = (voxel_downsample(&source, 0.04), voxel_downsample(&target, 0.04));
    let voxels = fingerprint(target.points.iter().flat_map(|p| p.to_array()).map(|x| u64::from(x.to_bits())));

    let (source_tree, target_tree) = (KdTree::new(&source.points), KdTree::new(&target.points));
    let (source_features, target_features) = (fpfh(&source, &source_tree, 0.2), fpfh(&target, &target_tree, 0.2));
    let features = fingerprint(target_features.iter().flatten().map(|x| u64::from(x.to_bits())));

    let matches = nearest(&source_features, &target_features).mutual();
    let matched = fingerprint(matches.iter().flat_map(|m| [u64::from(m.source), u64::from(m.target)]));

    let settings = RansacSettings {
        inlier_distance: 0.06,
        edge_similarity: 0.9,
        max_iterations: 5_000,
        confidence: 0.999,
        scale_mode: ScaleMode::Free,
        guard: None,
        seed: 7,
    };
    let consensus = ransac(&source.points, &target.points, &matches, &settings).unwrap();
    let pose = consensus.target_from_source;
    assert!(pose_error(&pose, &truth) < 0.1, "{pose:?} for {truth:?}");

    let refined = [(IcpMetric::PointToPlane, true), (IcpMetric::PointToPlane, false), (IcpMetric::PointToPoint, false)]
        .map(|(metric, lock_scale)| {
            let settings = IcpSettings {
                metric,
                robust: true,
                lock_scale,
                scale_bounds: None,
                max_iterations: 30,
                support: SupportSettings { max_distance: 0.12, min_cosine: 0.5 },
                final_distance: 0.04,
                tolerance: 1e-7,
            };
            of_pose(&refine(&source, &target, &target_tree, &pose, &settings).target_from_source)
        });
    let found = [voxels, features, matched, of_pose(&pose), refined[0], refined[1], refined[2]];
    assert_eq!(found, EXPECTED, "now {found:#018x?}");
}

/// Voxels, descriptors, matches, RANSAC, ICP (planes and locked scale; planes; points).
const EXPECTED: [u64; 7] = [
    0x95395282e03782fb,
    0xcb0d839712407b2d,
    0x2dc1b9769cb198f3,
    0x59034c8495362a6f,
    0x293299c7c7494201,
    0xbdfc8e1a6d4b2d6e,
    0x136fcc760fe3c106,
];
