//! `register` and `estimateSim3`.

use sim3align::register::estimate_sim3;
use sim3align::register::options::{EstimateSim3Options, RegisterOptions};
use sim3align::register::register;
use sim3align::register::report::Registration;

use super::align::check_pose;
use crate::fuzz::call::{Call, Checked, finite};
use crate::fuzz::choices::Choices;
use crate::fuzz::clouds::pair;
use crate::fuzz::options::options;
use crate::prelude::*;

/// `register`.
pub fn call(c: &mut Choices) -> Call {
    let most = if c.once_in(32) { 300_000 } else { 2_000 };
    let changed = c.below(4);
    let options: RegisterOptions = options(c, changed, 50_000);
    let is_bounded = options == RegisterOptions::default();
    let (words, [source, target]) = pair(c, most);
    let description = format!("{words}; {options:?}");
    let registered = move || register(&source, &target, &options, &mut Silent);
    Call::new(description, is_bounded, false, registered, check)
}

/// `estimateSim3`.
pub fn estimate(c: &mut Choices) -> Call {
    let changed = c.below(4);
    let options: EstimateSim3Options = options(c, changed, 50_000);
    let is_bounded = options == EstimateSim3Options::default();
    let (words, [source, target]) = pair(c, 2_000);
    let pairs = c.size(1, 2_000);
    let matching = c.pick(&[1.0, 0.5, 0.0]);
    let mut random = c.noise();
    let [sources, targets] = [source.len() / 3, target.len() / 3];
    let mut correspondences: Vec<u32> = Vec::new();
    for _ in 0..pairs {
        let i = random.below(sources);
        let j = if random.uniform() < matching { i } else { random.below(targets) };
        correspondences.extend([i as u32, j as u32]);
    }
    match c.below(16) {
        14 => drop(correspondences.pop()),
        15 => correspondences.iter_mut().take(1).for_each(|i| *i = u32::MAX),
        _ => {}
    }
    let description = format!("{words}; {pairs} pairs, {matching} of them right; {options:?}");
    let estimated = move || estimate_sim3(&source, &target, &correspondences, &options, &mut Silent);
    Call::new(description, is_bounded, false, estimated, check)
}

fn check(found: &Registration) -> Checked {
    finite("fitness, residual", &[found.fitness, found.residual])?;
    finite("diagnostics", &[found.diagnostics.initial_scale, found.diagnostics.scale_ratio])?;
    check_pose(&found.target_from_source)
}
