//! `evaluate`.

use sim3align::align::evaluate::{EvaluateOptions, Evaluation, evaluate};

use crate::fuzz::call::{Call, Checked, finite};
use crate::fuzz::choices::Choices;
use crate::fuzz::meshes::mesh;
use crate::fuzz::options::{options, transform};
use crate::fuzz::views::{Size, view};

/// Any view, mesh and pose.
pub fn call(c: &mut Choices) -> Call {
    let (size, most) = if c.once_in(16) { (Size::Large, 1_000_000) } else { (Size::Small, 2_000) };
    let changed = c.below(4);
    let options: EvaluateOptions = options(c, changed, 20_000);
    let pose = transform(c);
    let (view_words, observation) = view(c, size);
    let (mesh_words, mesh) = mesh(c, most);
    let description = format!("{view_words}; {mesh_words}; {pose:?}; {options:?}");
    Call::new(description, true, true, move || evaluate(&observation?, &mesh?, &pose, &options), check)
}

fn check(evaluation: &Evaluation) -> Checked {
    let m = &evaluation.metrics;
    let shares = [m.boundary_f, m.iou, m.fitness, m.normal_consistency];
    let lengths = [m.center_drift_px, m.chamfer_mm, m.uni_chamfer_mm, m.depth_mae_mm];
    for (name, value) in shares.iter().chain(&lengths).flatten().enumerate() {
        finite(&format!("metric {name}"), &[*value])?;
    }
    if let Some(share) = shares.iter().flatten().find(|share| !(0.0..=1.0).contains(*share)) {
        return Err(format!("result: a share of {share}"));
    }
    if let Some(length) = lengths.iter().flatten().find(|length| **length < 0.0) {
        return Err(format!("result: a length of {length}"));
    }
    let d = &evaluation.diagnostics;
    finite("diagnostics", &[d.initial_scale, d.scale_ratio])
}
