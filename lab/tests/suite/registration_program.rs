//! `sim3align-registration`: what it keeps of a run, and answers of other programs.

use std::fs;
use std::process::Command;

use serde_json::{Value, json};
use sim3align_lab::case_folder::write::ply_points;
use sim3align_lab::clouds::overlap::information;
use sim3align_lab::clouds::trajectory::{Block, text};

use crate::support::{Draw, mug};
use sim3align_lab::prelude::*;

/// A 3DMatch scene of three fragments, whose pair (0, 2) is the same mug twice.
struct Scene {
    root: PathBuf,
    source: Vec<Vec3>,
    target: Vec<Vec3>,
    target_from_source: Similarity,
}

impl Scene {
    fn new(name: &str) -> Self {
        let root = Path::new(env!("CARGO_TARGET_TMPDIR")).join("registration-program").join(name);
        let _ = fs::remove_dir_all(&root);
        fs::create_dir_all(root.join("kitchen")).unwrap();
        let draw = &mut Draw::new(5);
        let target: Vec<Vec3> = mug(draw, 3000).points.iter().map(|&p| p * 2.0).collect();
        let target_from_source = Similarity::from_parts(1.0, *draw.rotation().matrix(), draw.direction()).unwrap();
        let back = target_from_source.inverse();
        let source: Vec<Vec3> = target.iter().map(|&p| vec3(&back.apply(vector3(p)))).collect();
        for (i, points) in [&target, &target, &source].into_iter().enumerate() {
            fs::write(root.join(format!("kitchen/cloud_bin_{i}.ply")), ply_points(points)).unwrap();
        }
        let matrix = nalgebra::Matrix4::from_column_slice(&target_from_source.to_column_major());
        let block = Block { target: 0, source: 2, fragments: 3, matrix };
        fs::write(root.join("kitchen/gt.log"), text(&[block])).unwrap();
        let matrix = information(source.iter().copied());
        fs::write(root.join("kitchen/gt.info"), text(&[Block { target: 0, source: 2, fragments: 3, matrix }])).unwrap();
        Self { root, source, target, target_from_source }
    }

    /// The pair's entry in the report, for every method.
    fn run(&self, arguments: &[&str]) -> Vec<Value> {
        let report = self.root.join("report.json");
        let mut command = Command::new(env!("CARGO_BIN_EXE_sim3align-lab"));
        command.args(["registration", "run", "--data"]).arg(&self.root).arg("--json").arg(&report).args(arguments);
        let output = command.output().unwrap();
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        serde_json::from_slice(&fs::read(report).unwrap()).unwrap()
    }

    /// A folder with another program's answer to the pair.
    fn answer(&self, name: &str, answer: &Value) -> String {
        let folder = self.root.join(name);
        fs::create_dir_all(&folder).unwrap();
        fs::write(folder.join("kitchen-0-2.json"), answer.to_string()).unwrap();
        format!("{name}=import:{}", folder.display())
    }
}

#[test]
fn a_run_goes_on_where_it_was_stopped_and_keeps_what_other_options_found() {
    let scene = Scene::new("records");
    let path = scene.root.join("records.jsonl");
    let records = ["--records", path.to_str().unwrap(), "--measure-overlap"];
    let first = scene.run(&records);
    let file = fs::read(&path).unwrap();
    assert_eq!(first.len(), 1);
    assert_eq!((&first[0]["id"], &first[0]["success"]), (&json!("kitchen-0-2"), &json!(true)));
    assert!(first[0]["overlap"].as_f64().unwrap() > 0.99);

    // What is there is not run again, not even its clouds are read.
    let cloud = scene.root.join("kitchen/cloud_bin_2.ply");
    let aside = scene.root.join("aside.ply");
    fs::rename(&cloud, &aside).unwrap();
    assert_eq!(scene.run(&records), first);
    assert_eq!(fs::read(&path).unwrap(), file);
    fs::rename(&aside, &cloud).unwrap();

    // A line that was cut off is: the same, but for the time.
    fs::write(&path, &file[..file.len() / 2]).unwrap();
    let again = scene.run(&records);
    assert_eq!((&again[0]["matrix"], again.len()), (&first[0]["matrix"], 1));

    for (more, lines) in [("--option", "seed=7"), ("--moved", "3"), ("--method", "ransac")].into_iter().zip(2..) {
        scene.run(&[&records[..], &[more.0, more.1]].concat());
        assert_eq!(fs::read_to_string(&path).unwrap().lines().count(), lines, "{more:?}");
    }
}

#[test]
fn a_scaled_source_is_registered_with_a_free_scale_only() {
    let scene = Scene::new("scaled");
    let free = scene.run(&["--scaled", "1", "--option", "scale=free"]);
    assert_eq!(free[0]["success"], true, "{free:?}");
    assert!(free[0]["scale"].as_f64().unwrap() < 1e-3);
    let fixed = scene.run(&["--scaled", "1"]);
    assert_eq!(fixed[0]["success"], false);
}

#[test]
fn every_third_pair_is_what_it_says() {
    let scene = Scene::new("every");
    let identity = nalgebra::Matrix4::identity();
    let pairs: Vec<Block<4>> =
        (2..9).map(|source| Block { target: 0, source, fragments: 9, matrix: identity }).collect();
    let information: Vec<Block<6>> = pairs
        .iter()
        .map(|pair| Block { target: 0, source: pair.source, fragments: 9, matrix: nalgebra::Matrix6::identity() })
        .collect();
    fs::write(scene.root.join("kitchen/gt.log"), text(&pairs)).unwrap();
    fs::write(scene.root.join("kitchen/gt.info"), text(&information)).unwrap();
    let list = scene.root.join("list.json");
    let output = Command::new(env!("CARGO_BIN_EXE_sim3align-lab"))
        .args(["registration", "run", "--every", "3", "--data"])
        .arg(&scene.root)
        .arg("--pairs-json")
        .arg(&list)
        .output()
        .unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let listed: Vec<Value> = serde_json::from_slice(&fs::read(list).unwrap()).unwrap();
    let ids: Vec<&str> = listed.iter().map(|pair| pair["id"].as_str().unwrap()).collect();
    assert_eq!(ids, ["kitchen-0-2", "kitchen-0-5", "kitchen-0-8"]);
}

#[test]
fn answers_of_other_programs_are_poses_or_pairs_of_points() {
    let scene = Scene::new("import");
    let rows = |points: &[Vec3]| points.iter().step_by(10).map(|p| p.to_array()).collect::<Vec<_>>();
    let (source, mut target) = (rows(&scene.source), rows(&scene.target));
    // Every third pair is wrong.
    for wrong in target.iter_mut().step_by(3) {
        wrong.rotate_left(1);
    }
    let matrix = scene.target_from_source.to_column_major();
    let answers = [
        ("pose", json!({ "targetFromSource": { "matrix": matrix }, "seconds": 0.25 })),
        ("pairs", json!({ "correspondences": { "source": source, "target": target } })),
        ("failed", json!({ "error": "out of memory" })),
        ("case", json!({ "cameraFromMesh": { "matrix": matrix } })),
    ]
    .map(|(name, answer)| scene.answer(name, &answer));
    let methods: Vec<&str> = answers.iter().flat_map(|answer| ["--method", answer.as_str()]).collect();
    let report = scene.run(&methods);
    let [pose, pairs, failed, case] = report.as_slice() else { panic!("{} entries", report.len()) };
    for (found, most) in [(pose, 1e-9), (pairs, 1e-3)] {
        assert_eq!(found["success"], true);
        assert!(found["rmseM"].as_f64().unwrap() < most, "{found}");
    }
    assert_eq!((&pose["seconds"], &pairs["seconds"]), (&json!(0.25), &Value::Null));
    for (unanswered, reason) in [(failed, "out of memory"), (case, "one of targetFromSource")] {
        assert_eq!(unanswered["success"], false);
        assert!(unanswered["error"].as_str().unwrap().contains(reason), "{unanswered}");
    }
}
