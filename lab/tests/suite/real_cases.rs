//! Real RGB-D cases: `SIM3ALIGN_CASES=<folder of case folders> cargo test -p sim3align-lab -- --ignored real_cases`.

use sim3align::align::evaluate::{EvaluateOptions, evaluate};
use sim3align::precise::drawing::removed_parts::RemovedParts;
use sim3align_lab::case_folder::read::{case_folders, read};
use sim3align_lab::prelude::*;

#[test]
#[ignore = "needs SIM3ALIGN_CASES"]
fn real_cases_have_whole_meshes_and_true_poses_that_explain_their_images() {
    let folder = std::env::var_os("SIM3ALIGN_CASES").expect("SIM3ALIGN_CASES names no folder of cases");
    let mut tried = 0;
    for folder in case_folders(Path::new(&folder)).unwrap() {
        let case = read(&folder).unwrap();
        let (frame, mesh) = (&case.frames[0], &case.objects[0].mesh);
        assert_eq!(PreparedMesh::borrowed(mesh).removed_parts(), RemovedParts::default(), "{}", case.name);
        let Some(truth) = frame.truths[0] else { continue };
        tried += 1;
        let observation = frame.observation(0, false).unwrap();
        let metrics = evaluate(&observation, mesh, &truth, &EvaluateOptions::default()).unwrap().metrics;
        assert!(metrics.iou.unwrap() >= 0.92, "{}: {metrics:?}", case.name);
        assert!(metrics.normal_consistency.unwrap() >= 0.8, "{}: {metrics:?}", case.name);
        assert!(metrics.fitness.unwrap() > 0.93, "{}: {metrics:?}", case.name);
    }
    assert!(tried > 0, "no case has a truth");
}
