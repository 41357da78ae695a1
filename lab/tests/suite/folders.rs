//! Case folders, scene folders and folders with frames: what is written is read again; and answers of other programs.

use sim3align_lab::bench::imported::imported;
use sim3align_lab::case::Case;
use sim3align_lab::case_folder::read::read;
use sim3align_lab::prelude::*;
use sim3align_lab::sets::Set;

/// An empty folder for a test of this process.
fn fresh(name: &str) -> PathBuf {
    let path = std::env::temp_dir().join(format!("sim3align-{}-{name}", std::process::id()));
    let _ = std::fs::remove_dir_all(&path);
    std::fs::create_dir_all(&path).unwrap();
    path
}

fn assert_near(a: &Similarity, b: &Similarity) {
    let off = [a.scale / b.scale - 1.0, a.rotation_angle_to(b), (a.translation - b.translation).norm()];
    assert!(off.iter().all(|x| x.abs() < 1e-9), "{off:?}");
}

fn assert_read_back(read: &Case, made: &Case) {
    assert_eq!((read.frames.len(), read.objects.len()), (made.frames.len(), made.objects.len()));
    for (read, made) in read.frames.iter().zip(&made.frames) {
        let depths = read.depth.data().iter().zip(made.depth.data());
        // Depth is written in steps of at least a tenth of a millimetre.
        assert!(depths.into_iter().all(|(a, b)| (a - b).abs() < 1e-3 && (*a > 0.0) == (*b > 0.0)));
        assert_eq!((&read.masks[0].is_some(), &read.photo), (&true, &made.photo));
        for (read, made) in read.truths.iter().zip(&made.truths) {
            assert_near(&read.unwrap(), &made.unwrap());
        }
        if let (Some(read), Some(made)) = (read.world_from_camera, made.world_from_camera) {
            assert_near(&read, &made);
        }
    }
    for (read, made) in read.objects.iter().zip(&made.objects) {
        assert_eq!(read.mesh, made.mesh);
        assert_eq!(read.initial.is_some(), made.initial.is_some());
        assert_eq!(matches!(read.symmetry, Symmetry::None), matches!(made.symmetry, Symmetry::None));
    }
}

#[test]
fn every_kind_of_folder_is_read_as_it_was_written() {
    for set in [Set::Colors, Set::Placements, Set::Views] {
        let (case, folder) = (set.case(3, 0, 2).unwrap(), fresh(set.as_str()));
        case.write(&folder).unwrap();
        assert_read_back(&read(&folder).unwrap(), &case);
        std::fs::remove_dir_all(folder).unwrap();
    }
}

#[test]
fn answers_are_poses_in_two_forms_or_errors() {
    let folder = fresh("answers");
    let rows = r#"{"cameraFromMesh": {"scale": 2, "rotation": [[0,-1,0],[1,0,0],[0,0,1]], "translation": [1,2,3]}, "seconds": 0.5}"#;
    let matrix = r#"{"targetFromSource": {"matrix": [0,2,0,0, -2,0,0,0, 0,0,2,0, 1,2,3,1]}}"#;
    for (name, text) in [("a", rows), ("b", matrix), ("c", r#"{"error": "no fit"}"#), ("d", "[]"), ("e", "{}")] {
        std::fs::write(folder.join(format!("{name}.json")), text).unwrap();
    }
    let (pose, seconds) = imported("a", &folder);
    assert_eq!(seconds, Some(0.5));
    assert_near(&pose.unwrap(), &imported("b", &folder).0.unwrap());
    let wrong = [("c", "no fit"), ("d", "CORRUPT_FILE"), ("e", "expected one of"), ("f", "no answer")];
    for (name, words) in wrong {
        let error = imported(name, &folder).0.unwrap_err();
        assert!(error.contains(words), "{error}");
    }
    std::fs::remove_dir_all(folder).unwrap();
}
