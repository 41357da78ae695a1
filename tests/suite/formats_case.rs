//! Case folders, and meshes of other programs. Native: they need a file system.
#![cfg(not(target_arch = "wasm32"))]

use std::fs;
use std::path::{Path, PathBuf};

use sim3align::error::Result;
use sim3align::precise::drawn::surplus::LeftOut;
use sim3align_formats::mesh::{MeshReadOptions, external_resources, read_mesh};
use sim3align_lab::case_folder::case::read_case;
use sim3align_lab::case_folder::write;

use crate::formats_fixtures::{area, assert_near, bounds, fixture};
use crate::prelude::*;

/// A folder of its own for a test, removed at its end.
struct Folder(PathBuf);

impl Folder {
    fn new(name: &str) -> Self {
        let path = std::env::temp_dir().join(format!("sim3align-{}-{name}", std::process::id()));
        fs::create_dir_all(&path).unwrap();
        Self(path)
    }

    fn write(&self, name: &str, bytes: impl AsRef<[u8]>) {
        fs::write(self.0.join(name), bytes).unwrap();
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let _ = fs::remove_dir_all(&self.0);
    }
}

fn slope() -> DepthMap {
    DepthMap::from_metres(16, 12, (0..192).map(|i| 1.0 + 0.001 * (i % 16) as f32).collect()).unwrap()
}

const CAMERA: &str = r#"{"fx":20,"fy":20,"cx":8,"cy":6,"width":16,"height":12,"depth_scale":0.5}"#;

#[test]
fn a_case_is_read_from_its_folder() {
    let folder = Folder::new("case");
    let mask = Image::new("mask", 16, 12, vec![1; 192]).unwrap();
    folder.write("depth.png", write::depth_png(&slope(), 0.0005).unwrap());
    folder.write("mask.png", write::mask_png(&mask).unwrap());
    folder.write("mesh.gltf", fixture!("mesh-external.gltf"));
    folder.write("gltf_buffer_0.bin", fixture!("mesh-external-gltf_buffer_0.bin"));
    folder.write("gltf_buffer_1.bin", fixture!("mesh-external-gltf_buffer_1.bin"));
    folder.write("camera.json", CAMERA);
    let case = read_case(&folder.0).unwrap();
    assert!(case.name.ends_with("-case") && case.truth.is_none());
    assert_eq!(case.mesh.triangles().len(), 80);
    // The camera file's depth scale, 0.5 mm, is that of the PNG.
    let expected = slope();
    let off = case.observation.depth().data().iter().zip(expected.data()).map(|(a, b)| (a - b).abs());
    assert!(off.fold(0.0, f32::max) < 2.6e-4);
    // Floats are metres whatever it says, and are preferred.
    folder.write("depth.npy", write::depth_npy(&slope()));
    folder
        .write("gt.json", r#"{"available":true,"scale":2,"rotation":[[1,0,0],[0,1,0],[0,0,1]],"translation":[0,0,1]}"#);
    folder.write("mesh.glb", write::glb(&case.mesh));
    let again = read_case(&folder.0).unwrap();
    assert_eq!(again.observation.depth(), &slope());
    assert_eq!((again.mesh, again.truth.unwrap().0.scale), (case.mesh, 2.0));
}

#[test]
fn a_case_names_the_file_at_fault() {
    let folder = Folder::new("broken");
    let failure = || read_case(&folder.0).unwrap_err();
    assert_eq!((failure().code, &*failure().expected), (ErrorCode::InvalidArgument, "depth.npy or depth.png"));
    folder.write("depth.npy", write::depth_npy(&slope()));
    folder.write("camera.json", CAMERA);
    let empty = Image::new("mask", 16, 12, vec![0; 192]).unwrap();
    folder.write("mask.png", write::mask_png(&empty).unwrap());
    assert!(failure().expected.starts_with("mesh.glb or mesh.gltf"));
    // A .gltf may name files beside it, not elsewhere.
    let escape = String::from_utf8_lossy(fixture!("mesh-external.gltf")).replace("gltf_buffer_0.bin", "../secret.bin");
    folder.write("mesh.gltf", escape);
    folder.write("../secret.bin", fixture!("mesh-external-gltf_buffer_0.bin"));
    folder.write("gltf_buffer_1.bin", fixture!("mesh-external-gltf_buffer_1.bin"));
    let error = failure();
    let _ = fs::remove_file(folder.0.join("../secret.bin"));
    assert!(error.argument.ends_with("mesh.gltf") && error.found.contains("../secret.bin"), "{error}");
    folder.write("mesh.glb", fixture!("mesh.glb"));
    let error = failure();
    assert_eq!(error.code, ErrorCode::EmptyMask);
    assert!(error.argument.ends_with("broken: mask"), "{error}");
    folder.write("mask.png", "{}");
    assert!(failure().argument.ends_with("mask.png"), "{}", failure());
    folder.write("camera.json", r#"{"fx":20,"fy":20,"cx":8,"cy":6,"width":640,"height":480}"#);
    assert_eq!(failure().code, ErrorCode::SizeMismatch);
}

/// The folder that an environment variable names.
fn real_data(variable: &str) -> PathBuf {
    PathBuf::from(std::env::var_os(variable).unwrap_or_else(|| panic!("{variable} names no folder")))
}

#[test]
#[ignore = "needs SIM3ALIGN_CASES"]
fn real_cases_are_read_whole() {
    let folder = real_data("SIM3ALIGN_CASES");
    let mut count = 0;
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            let case = read_case(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
            assert_eq!((case.observation.depth().width(), case.observation.depth().height()), (640, 480));
            assert!(case.mesh.triangles().len() > 1000, "{}", case.name);
            count += 1;
        }
    }
    assert!(count > 0);
}

fn read_with_files_beside(path: &Path) -> Result<Mesh> {
    let bytes = fs::read(path).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
    let beside = |uri: &str| fs::read(path.parent()?.join(uri)).ok();
    for uri in external_resources(&bytes)?.shape {
        assert!(beside(&uri).is_some(), "{uri}");
    }
    read_mesh(&bytes, &MeshReadOptions { format: None, resources: Some(&beside) })
}

/// Name, vertices (0 for those that trimesh counts otherwise), triangles, area, and lowest and highest corner: figures of
/// trimesh 5.2.0 with process=False. trimesh does not apply sparse values: those bounds are the accessor's own min and max.
/// It keeps the vertices that the strips leave out of their common buffer.
const REAL_MESHES: &str = "
chair.glb 596 1008 0.8027796273821127 -0.334719 -0.65725 -0.210492 0.186631 0.243233 0.222368
cv3dobj-horse.glb 48485 96966 0.03589099519029837 -0.042003 -0.09167 -0.076418 0.042003 0.091671 0.076418
donut.glb 4598 8736 0.17260887947010076 -0.11 -0.036145 -0.108265 0.117163 0.04158 0.11
sam3d-human-object-generated.glb 113498 227278 0.388258756633758 -0.475851 -0.409879 -2.739644 0.077276 -0.216615 -2.49616
ycb-bleach-cleanser.glb 8409 16384 0.0643801835915298 -0.055749 -0.033719 -0.105137 0.046684 0.03398 0.145443
ycb-mug.glb 10690 16384 0.05555693644708611 -0.049596 -0.046393 -0.036544 0.067388 0.046738 0.044759
ycb-pitcher-base.glb 8766 16384 0.1322822619973781 -0.073601 -0.072223 -0.13654 0.075533 0.072606 0.105847
ycb-scissors.glb 8610 16384 0.016589593117907586 -0.05459 -0.071389 -0.007759 0.04149 0.130135 0.007912
tricky/box-interleaved.glb 24 12 6.0 -0.5 -0.5 -0.5 0.5 0.5 0.5
tricky/nested-transforms.glb 72 36 8.67720421164829 -1.167013 -2.336595 -0.269381 0.269381 1.0 0.269381
tricky/mesh-and-pointcloud/sphere_two_materials_mesh_and_point_cloud.gltf 231 224 12.166687676015504 -1 -1 -1 1 1 1
tricky/sparse-accessor/SimpleSparseAccessor.gltf 14 12 NaN 0 0 0 6 4 0
tricky/triangle-strip-mode5.gltf 0 2786 20059.50849163092 -18.506493 1.777765 15.685872 38.643507 66.313521 91.803636";

#[test]
#[ignore = "needs SIM3ALIGN_MESHES"]
fn real_meshes_are_what_trimesh_reads() {
    let folder = real_data("SIM3ALIGN_MESHES");
    for row in REAL_MESHES.trim().lines() {
        let (name, figures) = row.split_once(' ').unwrap();
        let figures: Vec<f64> = figures.split(' ').map(|figure| figure.parse().unwrap()).collect();
        let [vertices, triangles, expected_area, expected_bounds @ ..] = &*figures else { panic!("{row}") };
        let mesh = read_with_files_beside(&folder.join(name)).unwrap_or_else(|error| panic!("{name}: {error}"));
        println!("{name}: {} vertices, area {}", mesh.positions().len(), area(&mesh));
        assert_eq!(mesh.triangles().len() as f64, *triangles, "{name}");
        assert!(*vertices == 0.0 || mesh.positions().len() as f64 == *vertices, "{name}: {}", mesh.positions().len());
        if expected_area.is_finite() {
            assert_near(area(&mesh), *expected_area, 1e-5);
        }
        assert_eq!(expected_bounds.len(), 6, "{name}");
        for (found, expected) in bounds(&mesh).as_flattened().iter().zip(expected_bounds) {
            assert_near(f64::from(*found), *expected, 2e-6);
        }
    }
}

/// The GLB files in a folder and in those below it.
fn glb_files(folder: &Path) -> Vec<PathBuf> {
    let entries = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
    let below = |path: PathBuf| match path.is_dir() {
        true => glb_files(&path),
        false => vec![path],
    };
    entries.flat_map(below).filter(|path| path.extension().is_some_and(|extension| extension == "glb")).collect()
}

#[test]
#[ignore = "needs SIM3ALIGN_MESHES"]
fn nothing_of_a_real_mesh_is_left_out() {
    let meshes = glb_files(&real_data("SIM3ALIGN_MESHES"));
    assert!(!meshes.is_empty());
    for path in meshes {
        let Ok(mesh) = read_with_files_beside(&path) else { continue };
        let prepared = PreparedMesh::borrowed(&mesh);
        assert_eq!(prepared.left_out(), LeftOut::default(), "{}", path.display());
        assert!(prepared.without_plate().is_none(), "{}", path.display());
    }
}

#[test]
#[ignore = "needs SIM3ALIGN_MESHES"]
fn real_tricky_meshes_are_read_or_refused_as_they_deserve() {
    let folder = real_data("SIM3ALIGN_MESHES");
    let read = |name: &str| read_with_files_beside(&folder.join("tricky").join(name));
    let draco = read("box-draco/BoxDraco.gltf").unwrap_err();
    assert_eq!(draco.code, ErrorCode::CompressedMesh);
    assert!(draco.found.contains("KHR_draco_mesh_compression") && draco.remedy.contains("gltf-transform"), "{draco}");
    let meshopt = read("meshopt-box.glb").unwrap_err();
    assert_eq!(meshopt.code, ErrorCode::CompressedMesh);
    assert!(meshopt.found.contains("EXT_meshopt_compression"), "{meshopt}");
    let cloud = read("mesh-and-pointcloud/sphere_two_materials_point_cloud.gltf").unwrap_err();
    assert_eq!(cloud.code, ErrorCode::EmptyMesh);
    let zero_length = read("zero-length-bufferview/ZeroLengthBufferView.gltf").unwrap();
    assert_eq!((zero_length.positions().len(), zero_length.triangles().len()), (4, 2));
}
