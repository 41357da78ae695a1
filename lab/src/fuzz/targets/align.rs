//! `align`, with both presets.

use sim3align::align::align_by_method;
use sim3align::align::method::Method;
use sim3align::options::Choice;
use sim3align::report::{AnyAlignment, Sim3};

use crate::fuzz::call::{Call, Checked, finite};
use crate::fuzz::choices::Choices;
use crate::fuzz::meshes::mesh;
use crate::fuzz::options::options;
use crate::fuzz::views::{Size, view};
use crate::prelude::*;

/// Small images and meshes, mostly with little work.
pub fn small(c: &mut Choices) -> Call {
    call(c, Size::Small, 300)
}

/// Images and meshes of every size, with the default options or less work.
pub fn large(c: &mut Choices) -> Call {
    let most = c.pick(&[20_000, 200_000, 1_000_000]);
    call(c, Size::Large, most)
}

fn call(c: &mut Choices, size: Size, most: usize) -> Call {
    let (method, is_bounded) = method(c, size);
    let (view_words, observation) = view(c, size);
    let (mesh_words, mesh) = mesh(c, most);
    let takes_transform = matches!(&method, Method::Precise(AlignOptions { initial: Some(_), .. }));
    let words = match &method {
        Method::Precise(options) if *options == AlignOptions::default() => "default options".into(),
        Method::Precise(options) => format!("{options:?}"),
        Method::Paper(options) => format!("{options:?}"),
    };
    let aligned = move || align_by_method(&observation?, &mesh?, &method, &mut Silent);
    Call::new(format!("{view_words}; {mesh_words}; {words}"), is_bounded, takes_transform, aligned, check)
}

/// Options, and whether they ask for no more work than the defaults.
fn method(c: &mut Choices, size: Size) -> (Method, bool) {
    let changed = if c.once_in(2) { 1 + c.below(4) } else { 0 };
    if c.once_in(8) {
        return (options::<PaperOptions>(c, changed, 20_000).into(), false);
    }
    let mut options: AlignOptions = options(c, changed, 50_000);
    let is_default_effort = options.quality != Quality::Best && options.work_budget.is_none_or(|work| work < 200.0);
    let is_bounded = is_default_effort && options.max_observed_points <= 20_000 && options.surface_samples <= 20_000;
    let is_hurried = if size == Size::Small { !c.once_in(16) } else { c.once_in(2) };
    if is_hurried {
        options.quality.set("fast");
        options.work_budget = Some(2.0 * c.size(1, 16) as f64);
    }
    (options.into(), is_bounded)
}

fn check(found: &AnyAlignment) -> Checked {
    check_pose(found.camera_from_mesh())?;
    let AnyAlignment::Precise(alignment) = found else { return Ok(()) };
    finite("score", &[alignment.diagnostics.score])?;
    check_probability(alignment.confidence)?;
    alignment.alternatives.iter().try_for_each(|other| check_pose(&other.camera_from_mesh))?;
    if let Some(u) = &alignment.uncertainty {
        finite("uncertainty", &[u.scale, u.rotation_deg, u.lateral_m, u.distance_m])?;
        finite("rotationAxis", &u.rotation_axis)?;
    }
    let common = &alignment.diagnostics.common;
    finite("diagnostics", &[common.initial_scale, common.scale_ratio, common.residual_m])
}

/// A confidence from 0 to 1.
pub fn check_probability(confidence: f64) -> Checked {
    if (0.0..=1.0).contains(&confidence) {
        return Ok(());
    }
    Err(format!("result: confidence {confidence}"))
}

/// A similarity with a scale above 0.
pub fn check_pose(pose: &Sim3) -> Checked {
    finite("matrix", &pose.matrix)?;
    finite("rotation", &pose.rotation)?;
    let length: f64 = pose.rotation.iter().map(|x| x * x).sum();
    if pose.scale > 0.0 && pose.scale.is_finite() && (length - 1.0).abs() < 1e-6 {
        return Ok(());
    }
    Err(format!("result: scale {}, quaternion of length² {length}", pose.scale))
}
