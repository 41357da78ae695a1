//! The files of a generated case folder.

use serde_json::{Value, json};

use super::write;
use crate::files::NamedFile;
use crate::prelude::*;

/// The files of a case: those of its mesh and, if it has one, of its photo, and those of the view, the mask and the
/// truth. See [`view_files`] and [`truth_file`].
pub(crate) fn case_files(
    observation: &Observation,
    mut files: Vec<NamedFile>,
    camera_from_mesh: &Similarity,
    truth: Value,
    depth_scale: Option<f64>,
) -> Result<Vec<NamedFile>> {
    files.extend(view_files(observation.depth(), observation.camera(), depth_scale)?);
    files.extend([mask_file(observation.mask())?, truth_file(camera_from_mesh, truth)]);
    Ok(files)
}

/// Depth and `camera.json`. Depth is written as floats (NPY, metres) or, given `depth_scale` (metres per unit), as
/// integers (16-bit PNG).
pub(crate) fn view_files(depth: &DepthMap, camera: Pinhole, depth_scale: Option<f64>) -> Result<[NamedFile; 2]> {
    let mut camera_json = json!({
        "fx": camera.fx, "fy": camera.fy, "cx": camera.cx, "cy": camera.cy,
        "width": depth.width(), "height": depth.height(),
    });
    let depth_file = match depth_scale {
        None => ("depth.npy", write::depth_npy(depth)),
        Some(scale) => {
            camera_json["depthScale"] = json!(scale);
            ("depth.png", write::depth_png(depth, scale)?)
        }
    };
    Ok([depth_file, ("camera.json", format!("{camera_json:#}\n").into_bytes())])
}

/// `mask.png`.
pub(crate) fn mask_file(mask: &Mask) -> Result<NamedFile> {
    Ok(("mask.png", write::mask_png(mask)?))
}

/// `mesh.glb`, without colours.
pub(crate) fn glb_file(mesh: &Mesh) -> NamedFile {
    ("mesh.glb", write::glb(mesh))
}

/// `gt.json`. `truth` holds its fields other than the pose.
pub(crate) fn truth_file(camera_from_mesh: &Similarity, mut truth: Value) -> NamedFile {
    let Similarity { scale, rotation, translation } = camera_from_mesh;
    let row = |i: usize| [rotation[(i, 0)], rotation[(i, 1)], rotation[(i, 2)]];
    truth["available"] = json!(true);
    truth["scale"] = json!(scale);
    truth["rotation"] = json!([row(0), row(1), row(2)]);
    truth["translation"] = json!([translation.x, translation.y, translation.z]);
    ("gt.json", format!("{truth:#}\n").into_bytes())
}

/// The symmetry in `gt.json`: as a word that all readers understand, and exactly as `symmetryAxes`.
pub(crate) fn symmetry_json(symmetry: &Symmetry, name: &str) -> Value {
    let axes = match symmetry {
        Symmetry::Declared(axes) => axes.as_slice(),
        _ => &[],
    };
    let words = match axes.iter().find(|axis| axis.fold.is_none()) {
        Some(_) => "continuous",
        None if axes.is_empty() => "none",
        None => "discrete",
    };
    let axes: Vec<Value> =
        axes.iter().map(|a| json!({ "axis": [a.axis.x, a.axis.y, a.axis.z], "fold": a.fold })).collect();
    json!({ "symmetry": words, "symmetryAxes": axes, "note": format!("generated: {name}") })
}

/// The `parameters` of `meta.json`: numbers by name.
pub(crate) fn parameters_json<'a>(parameters: impl IntoIterator<Item = &'a (&'static str, f64)>) -> Value {
    parameters.into_iter().map(|(name, value)| ((*name).to_owned(), json!(value))).collect()
}
