//! The registration benchmark: its protocols, its readers, what it generates, and that `register` solves it.

use std::fs;
use std::sync::LazyLock;

use nalgebra::Matrix4;
use sim3align::register::options::RegisterOptions;
use sim3align::register::register;
use sim3align_lab::case_folder::write::ply_points;
use sim3align_lab::clouds::cloud_file::{bin, flat, read_cloud};
use sim3align_lab::clouds::lidar_set::{Drive, write_lidar};
use sim3align_lab::clouds::object_set::write_objects;
use sim3align_lab::clouds::overlap::overlap;
use sim3align_lab::clouds::overlap::{covered, information, mean_squared_error};
use sim3align_lab::clouds::pair::{Criterion, Pair};
use sim3align_lab::clouds::room_set::{RoomScene, SAME_SURFACE_M, write_rooms};
use sim3align_lab::clouds::trajectory::{Block, read_blocks, text};
use sim3align_lab::clouds::{kitti, three_d_match};

use crate::support::Draw;
use sim3align_lab::prelude::*;

/// A folder of its own below the target folder, empty.
fn folder(name: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("registration").join(name);
    let _ = fs::remove_dir_all(&folder);
    fs::create_dir_all(&folder).unwrap();
    folder
}

const ROOMS_SEED: u64 = 5;

/// Generated rooms, which take long to make.
static ROOMS: LazyLock<PathBuf> = LazyLock::new(|| {
    let root = folder("rooms");
    write_rooms(&root, ROOMS_SEED, 1).unwrap();
    root
});

fn rigid(draw: &mut Draw, angle: f64, shift: f64) -> Similarity {
    let rotation = *draw.rotation_by(angle).matrix();
    Similarity::from_parts(1.0, rotation, draw.direction() * shift).unwrap()
}

#[test]
fn the_error_by_the_information_matrix_is_the_mean_squared_distance_of_the_points() {
    for seed in 0..20 {
        let draw = &mut Draw::new(seed);
        let points = draw.points(500, 2.0);
        let truth = rigid(draw, 2.0, 5.0);
        let (angle, shift) = (draw.between(0.0, 0.06), draw.between(0.0, 0.3));
        let estimate = truth.compose(&rigid(draw, angle, shift));
        let by_points =
            points.iter().map(|&p| (truth.apply(vector3(p)) - estimate.apply(vector3(p))).norm_squared()).sum::<f64>()
                / points.len() as f64;
        let matrix = information(points.iter().copied());
        assert_eq!(matrix[(0, 0)], 500.0);
        let by_matrix = mean_squared_error(&estimate, &truth, &matrix);
        // To first order in the angle.
        assert!(
            (by_matrix - by_points).abs() <= 0.08 * by_points.max(1e-4),
            "seed {seed}: {by_matrix} by the matrix, {by_points} by the points"
        );
    }
}

/// A scene of three fragments, of which (0, 1) are consecutive, with these files beside them.
fn hand_made(root: &Path, log: &str, info: &str) {
    for i in 0..3 {
        let scene = root.join("kitchen");
        fs::create_dir_all(&scene).unwrap();
        fs::write(scene.join(format!("cloud_bin_{i}.ply")), ply_points(&[Vec3::ZERO, Vec3::X])).unwrap();
    }
    fs::write(root.join("kitchen/gt.log"), log).unwrap();
    fs::write(root.join("kitchen/gt.info"), info).unwrap();
}

const POSE: &str = "1 0 0 1\n0 1 0 2\n0 0 1 3\n0 0 0 1\n";

fn diagonal(count: f64) -> String {
    text(&[Block::<6> { target: 0, source: 2, fragments: 3, matrix: nalgebra::Matrix6::identity() * count }])
}

#[test]
fn the_protocol_leaves_consecutive_pairs_out_and_draws_the_line_at_twenty_centimetres() {
    let root = folder("protocol");
    hand_made(&root, &format!("0 1 3\n{POSE}0\t2\t3\n{POSE}"), &diagonal(100.0));
    let pairs = three_d_match::pairs(&root, None).unwrap();
    let [pair] = pairs.as_slice() else { panic!("{} pairs", pairs.len()) };
    assert_eq!((pair.id.as_str(), pair.group.as_str()), ("kitchen-0-2", "kitchen"));
    assert!(pair.source.ends_with("cloud_bin_2.ply") && pair.target.ends_with("cloud_bin_0.ply"));
    assert_eq!(pair.target_from_source.translation, Vector3::new(1.0, 2.0, 3.0));
    let off = |x: f64| {
        let mut estimate = pair.target_from_source;
        estimate.translation.x += x;
        pair.errors(&estimate)
    };
    assert!(off(0.19).success && !off(0.21).success);
    assert!((off(0.15).rmse_m.unwrap() - 0.15).abs() < 1e-12 && (off(0.15).translation_m - 0.15).abs() < 1e-12);

    // The layout that 3DLoMatch is shipped in, which goes before what is beside the fragments.
    let low = root.join("benchmarks/3DLoMatch/kitchen");
    fs::create_dir_all(&low).unwrap();
    fs::write(low.join("gt.log"), format!("0 2 3\n{}", POSE.replace("0 1 0 2", "0 1 0 7"))).unwrap();
    fs::write(low.join("gt.info"), diagonal(50.0)).unwrap();
    let pairs = three_d_match::pairs(&root, Some("3DLoMatch")).unwrap();
    assert_eq!(pairs[0].target_from_source.translation.y, 7.0);
    assert_eq!(three_d_match::pairs(&root, Some("3DMatch")).unwrap()[0].target_from_source.translation.y, 2.0);
}

#[test]
fn kitti_draws_the_line_at_five_degrees_and_two_metres() {
    let pair = Pair {
        id: String::new(),
        group: String::new(),
        source: PathBuf::new(),
        target: PathBuf::new(),
        target_from_source: Similarity::identity(),
        criterion: Criterion::Errors,
        voxel_size_m: 0.3,
        overlap: None,
    };
    let draw = &mut Draw::new(3);
    for (degrees, metres, success) in [(4.9, 1.9, true), (5.1, 0.1, false), (0.1, 2.1, false)] {
        let errors = pair.errors(&rigid(draw, f64::to_radians(degrees), metres));
        assert!((errors.rotation_deg - degrees).abs() < 1e-6 && (errors.translation_m - metres).abs() < 1e-9);
        assert_eq!(errors.success, success);
    }
    let at = |x: f64| Similarity { translation: Vector3::new(x, 0.0, 0.0), ..Similarity::identity() };
    let poses: Vec<Similarity> = (0..10).map(|i| at(4.0 * f64::from(i))).collect();
    assert_eq!(kitti::ten_metres_apart(&poses), [[0, 2], [3, 5], [6, 8]]);
}

#[test]
fn files_that_lie_are_refused_by_name() {
    let root = folder("hostile");
    let code = |log: &str, info: &str| {
        hand_made(&root, log, info);
        three_d_match::pairs(&root, None).unwrap_err().code
    };
    let whole = format!("0 2 3\n{POSE}");
    for log in ["0 2", "0 2 3\n1 0 0", "0 -2 3\n", "0 2.5 3\n", &format!("0 2 3\n{}", POSE.replace('3', "x"))] {
        assert_eq!(code(log, &diagonal(1.0)), ErrorCode::CorruptFile, "{log:?}");
    }
    assert_eq!(code(&whole, &diagonal(0.0)), ErrorCode::CorruptFile);
    assert_eq!(code(&whole, ""), ErrorCode::CorruptFile);
    assert_eq!(code(&whole, &diagonal(1.0).replace('1', "inf")), ErrorCode::CorruptFile);
    assert_eq!(code(&format!("0 2 3\n{}", POSE.replace("0 0 0 1", "0 0 1 1")), &diagonal(1.0)), ErrorCode::CorruptFile);
    assert_eq!(code(&whole.replace("1 0 0 1", "-1 0 0 1"), &diagonal(1.0)), ErrorCode::InvalidTransform);
    assert_eq!(three_d_match::pairs(&root.join("none"), None).unwrap_err().code, ErrorCode::InvalidArgument);
    assert_eq!(kitti::pairs(&root).unwrap_err().code, ErrorCode::InvalidArgument);

    let cloud = |name: &str, bytes: &[u8]| {
        let path = root.join(name);
        fs::write(&path, bytes).unwrap();
        read_cloud(&path).unwrap_err().code
    };
    let good = ply_points(&[Vec3::X, Vec3::Y]);
    assert_eq!(cloud("cut.ply", &good[..good.len() - 1]), ErrorCode::CorruptFile);
    let lies = String::from_utf8_lossy(&good[..90]).replace("vertex 2", "vertex 4000000000");
    assert_eq!(cloud("lies.ply", lies.as_bytes()), ErrorCode::CorruptFile);
    assert_eq!(cloud("nan.ply", &ply_points(&[Vec3::NAN])), ErrorCode::NonFinite);
    assert_eq!(cloud("cut.bin", &bin(&[Vec3::X])[..15]), ErrorCode::CorruptFile);
    assert_eq!(cloud("nan.bin", &bin(&[Vec3::INFINITY])), ErrorCode::NonFinite);
    assert_eq!(cloud("cloud.xyz", b"1 2 3"), ErrorCode::InvalidArgument);
}

#[test]
fn blocks_are_read_as_they_were_written() {
    let path = folder("blocks").join("gt.log");
    let draw = &mut Draw::new(5);
    let blocks: Vec<Block<4>> = (0..5)
        .map(|i| {
            let matrix = Matrix4::from_column_slice(&rigid(draw, 1.0, 3.0).to_column_major());
            Block { target: i, source: i + 7, fragments: 60, matrix }
        })
        .collect();
    fs::write(&path, text(&blocks)).unwrap();
    let read: Vec<Block<4>> = read_blocks(&path).unwrap();
    for (a, b) in read.iter().zip(&blocks) {
        assert_eq!((a.target, a.source, a.fragments), (b.target, b.source, b.fragments));
        assert!((a.matrix - b.matrix).amax() < 1e-11);
    }
    assert_eq!(read.len(), blocks.len());
}

/// The share by comparing every point with every other.
fn overlap_by_brute_force(source: &[Vec3], target: &[Vec3], pose: &Similarity, distance: f32) -> f64 {
    let transform = pose.to_f32();
    let landed: Vec<Vec3> = source.iter().map(|&p| transform.apply(p)).collect();
    let near = |from: &[Vec3], to: &[Vec3]| {
        from.iter().filter(|p| to.iter().any(|q| q.distance_squared(**p) <= distance * distance)).count()
    };
    (near(&landed, target) + near(target, &landed)) as f64 / (source.len() + target.len()) as f64
}

fn every(points: &[Vec3], step: usize) -> Vec<Vec3> {
    points.iter().step_by(step).copied().collect()
}

#[test]
fn rooms_are_read_as_they_were_generated_and_overlap_as_they_say() {
    // The files come from another run of the generator: the same seed gives the same scene.
    let scene = RoomScene::new(ROOMS_SEED.wrapping_mul(0x1_0001)).unwrap();
    let pairs = three_d_match::pairs(&ROOMS, None).unwrap();
    assert_eq!(pairs.len(), scene.poses.len());
    for (i, pair) in pairs.iter().enumerate() {
        let (source, target) = (read_cloud(&pair.source).unwrap(), read_cloud(&pair.target).unwrap());
        assert_eq!(source, scene.fragments[scene.poses[i].source as usize]);
        assert_eq!(target, scene.fragments[scene.poses[i].target as usize]);
        assert!((pair.overlap.unwrap() - scene.overlaps[i]).abs() < 1e-12);
        assert!(pair.errors(&pair.target_from_source).success);
        if i % 8 == 0 {
            let (source, target) = (every(&source, 29), every(&target, 29));
            let pose = &pair.target_from_source;
            let found = overlap(&source, &target, pose, SAME_SURFACE_M);
            assert!((found - overlap_by_brute_force(&source, &target, pose, SAME_SURFACE_M)).abs() < 1e-3);
        }
    }
    for (least, most) in [(0.3, 0.6), (0.1, 0.3)] {
        let count = scene.overlaps.iter().filter(|share| (least..most).contains(*share)).count();
        assert!(count >= 4, "{count} pairs of overlap {least} to {most}");
    }
}

#[test]
fn drives_are_read_as_they_were_generated_and_overlap_less_with_distance() {
    let root = folder("lidar");
    write_lidar(&root, 2, 1).unwrap();
    let drive = Drive::new(2_u64.wrapping_mul(0x1_0001), 17).unwrap();
    let pairs = kitti::pairs(&root).unwrap();
    assert_eq!(pairs.len(), 20);
    for pair in &pairs {
        let frame = |path: &Path| path.file_stem().unwrap().to_str().unwrap().parse::<usize>().unwrap();
        let (source, target) = (frame(&pair.source), frame(&pair.target));
        assert_eq!(read_cloud(&pair.source).unwrap(), drive.sweeps[source]);
        let errors = pair.errors(&drive.pose(source, target));
        assert!(errors.rotation_deg < 1e-6 && errors.translation_m < 1e-6, "{}: {errors:?}", pair.id);
        assert!((pair.overlap.unwrap() - drive.overlap(source, target)).abs() < 1e-12);
    }
    let mean = |ahead: usize| {
        let at: Vec<f64> = (0..4).map(|k| drive.overlap(2 * k, 2 * k + ahead)).collect();
        at.iter().sum::<f64>() / at.len() as f64
    };
    let shares = [1, 4, 8].map(mean);
    assert!(shares[0] > 0.6 && shares[1] < shares[0] - 0.1 && shares[2] < shares[1] - 0.1, "{shares:?}");

    // Without the list, by distance.
    fs::remove_file(root.join("pairs.json")).unwrap();
    let pairs = kitti::pairs(&root).unwrap();
    assert!(!pairs.is_empty() && pairs.iter().all(|pair| pair.distance_m() > 4.0 && pair.distance_m() <= 10.0));
}

fn registered(source: &[Vec3], target: &[Vec3]) -> Similarity {
    let options = RegisterOptions { scale: ScaleOption::Fixed(1.0), ..RegisterOptions::default() };
    let found = register(&flat(source), &flat(target), &options, &mut Silent).unwrap();
    Similarity::from_column_major(&found.target_from_source.matrix).unwrap()
}

/// The pairs of a scene with this much in common.
fn with_overlap(pairs: &[Pair], least: f64, most: f64) -> Vec<&Pair> {
    pairs.iter().filter(|pair| pair.overlap.is_some_and(|share| (least..most).contains(&share))).collect()
}

#[test]
fn rooms_with_a_third_in_common_are_registered() {
    let pairs = three_d_match::pairs(&ROOMS, None).unwrap();
    let chosen: Vec<&Pair> = with_overlap(&pairs, 0.4, 1.0).into_iter().take(5).collect();
    assert_eq!(chosen.len(), 5);
    let is_right = |pair: &&&Pair| {
        let (source, target) = (read_cloud(&pair.source).unwrap(), read_cloud(&pair.target).unwrap());
        pair.errors(&registered(&source, &target)).success
    };
    let right = chosen.iter().filter(is_right).count();
    assert!(right >= 4, "{right} of 5");
}

#[test]
fn rooms_of_another_unit_are_registered() {
    let pairs = three_d_match::pairs(&ROOMS, None).unwrap();
    let chosen: Vec<&Pair> = with_overlap(&pairs, 0.4, 1.0).into_iter().take(4).collect();
    let is_right = |pair: &&&Pair| {
        let (source, target) = (read_cloud(&pair.source).unwrap(), read_cloud(&pair.target).unwrap());
        let scaled: Vec<Vec3> = source.iter().map(|&p| 0.3 * p).collect();
        let found = register(&flat(&scaled), &flat(&target), &RegisterOptions::default(), &mut Silent).unwrap();
        let pose = Similarity::from_column_major(&found.target_from_source.matrix).unwrap();
        let errors = pair.errors(&pose.compose(&Similarity { scale: 0.3, ..Similarity::identity() }));
        println!("{}: {errors:?}", pair.id);
        errors.success
    };
    let right = chosen.iter().filter(is_right).count();
    assert!(right >= 3, "{right} of 4");
}

#[test]
fn a_wrong_scale_is_no_success() {
    let pair = three_d_match::pairs(&ROOMS, None).unwrap().swap_remove(0);
    for (scale, success) in [(1.04, true), (1.06, false), (0.3, false)] {
        let estimate = Similarity { scale, ..pair.target_from_source };
        let errors = pair.errors(&estimate);
        assert_eq!(
            (errors.success, (errors.scale - (scale - 1.0_f64).abs()).abs() < 1e-12),
            (success, true),
            "{scale}"
        );
    }
}

#[test]
fn objects_lie_on_what_their_scenes_show() {
    let root = folder("objects");
    write_objects(&root, 3, 2).unwrap();
    let pairs = three_d_match::pairs(&root, None).unwrap();
    assert!(pairs.len() >= 2, "{} pairs", pairs.len());
    for pair in pairs {
        let (source, target) = (read_cloud(&pair.source).unwrap(), read_cloud(&pair.target).unwrap());
        let near = covered(&source, &KdTree::new(&target), &pair.target_from_source, 0.15).len();
        let share = near as f64 / source.len() as f64;
        println!("{}: {} and {} points, {share:.2}", pair.id, source.len(), target.len());
        // One side of it, about; both of what is thin.
        assert!((0.1..=1.0).contains(&share), "{}: {share}", pair.id);
        assert!(pair.overlap.unwrap() <= share && target.len() > 1000, "{}", pair.id);
        assert!(pair.errors(&pair.target_from_source).success);
    }
}

#[test]
fn sweeps_ten_metres_apart_are_registered() {
    let drive = Drive::new(77, 9).unwrap();
    for source in [0, 3, 6] {
        let found = registered(&drive.sweeps[source], &drive.sweeps[source + 2]);
        let truth = drive.pose(source, source + 2);
        let (angle, off) = (found.rotation_angle_to(&truth), (found.translation - truth.translation).norm());
        assert!(angle < 0.02 && off < 0.2, "frame {source}: {angle} rad, {off} m");
    }
}
