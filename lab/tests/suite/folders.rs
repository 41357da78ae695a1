//! Case folders, scene folders and folders with frames, which the package reads as well: what is written is read again.

use sim3align_lab::case::Case;
use sim3align_lab::case_folder::read::read;
use sim3align_lab::prelude::*;
use sim3align_lab::sets::Set;

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
        assert_eq!((&read.masks, &read.photo), (&made.masks, &made.photo));
        for (read, made) in read.truths.iter().zip(&made.truths) {
            assert_near(&read.unwrap(), &made.unwrap());
        }
        if let (Some(read), Some(made)) = (read.world_from_camera, made.world_from_camera) {
            assert_near(&read, &made);
        }
    }
    for (read, made) in read.objects.iter().zip(&made.objects) {
        assert_eq!(read.mesh, made.mesh);
        assert_eq!(matches!(read.symmetry, Symmetry::None), matches!(made.symmetry, Symmetry::None));
    }
}

#[test]
fn every_kind_of_folder_is_read_as_it_was_written() {
    for set in [Set::Colors, Set::Scenes, Set::Videos] {
        let case = set.case(3, 0, 2).unwrap();
        let folder = std::env::temp_dir().join(format!("sim3align-{}-{}", std::process::id(), set.as_str()));
        case.write(&folder).unwrap();
        assert_read_back(&read(&folder).unwrap(), &case);
        std::fs::remove_dir_all(folder).unwrap();
    }
}
