//! One's share of an alignment, as JavaScript holds it: see `pkg-config/src/split.ts`.

use glam::{DQuat, DVec2};
use wasm_bindgen::prelude::*;

use super::aligner::answer;
use super::error::to_js;
use super::host::{JsHost, Listener};
use super::{input, options};
use crate::align::split;
use crate::stages::search::Found;
use crate::stages::search::coarse::Candidate;
use crate::stages::search::pose::CropPose;
use crate::stages::search::score::Score;

/// Numbers in which a candidate goes from one module to another.
const NUMBERS: usize = 21;

/// A share of an alignment.
#[wasm_bindgen(skip_typescript)]
pub struct Share(split::Share);

#[wasm_bindgen]
impl Share {
    /// Prepares the search.
    #[wasm_bindgen(constructor)]
    pub fn new(input: &JsValue, options: &JsValue) -> Result<Self, JsValue> {
        let run = || {
            let options = options::options(options, &[])?;
            let (observation, mesh) = (input::observation(input)?, input::mesh(input)?);
            split::Share::new(observation, mesh, options)
        };
        run().map(Self).map_err(|e| to_js(&e))
    }

    /// How many tasks this round has; 0 when there is nothing left to do.
    pub fn tasks(&self) -> usize {
        self.0.tasks()
    }

    /// Does the tasks `begin..end`.
    pub fn run(&self, begin: usize, end: usize) -> Vec<f64> {
        self.0.run(begin..end).iter().flat_map(to_numbers).collect()
    }

    /// Takes what came of all tasks, in their order.
    pub fn advance(&mut self, found: Vec<f64>) {
        self.0.advance(found.chunks_exact(NUMBERS).map(of_numbers).collect());
    }

    /// The pose that descriptors ask for, as a candidate, where the options want it.
    pub fn hypothesis(&self) -> Vec<f64> {
        let found = self.0.hypothesis().map(|pose| Found::from(Candidate { pose, score: Score::default() }));
        found.iter().flat_map(to_numbers).collect()
    }

    /// Makes that a candidate.
    pub fn join(&mut self, hypothesis: Vec<f64>) {
        hypothesis.chunks_exact(NUMBERS).for_each(|numbers| self.0.join(of_numbers(numbers).pose));
    }

    /// The alignment.
    pub fn finish(self, on_progress: Option<Listener>) -> Result<JsValue, JsValue> {
        answer(self.0.finish(&mut JsHost::new(on_progress)))
    }
}

fn to_numbers(found: &Found) -> [f64; NUMBERS] {
    let Found { pose, score: s, converged, renders } = found;
    let [x, y, z, w] = pose.rotation.to_array();
    let terms = [s.total, s.overlap, s.coverage, s.depth, s.normals, s.outline, s.hidden, s.union].map(f64::from);
    let counts = s.counts.map(f64::from);
    let mut numbers = [0.0; NUMBERS];
    numbers[..8].copy_from_slice(&[x, y, z, w, pose.size, pose.place.x, pose.place.y, pose.distance]);
    numbers[8..16].copy_from_slice(&terms);
    numbers[16..19].copy_from_slice(&counts);
    numbers[19..].copy_from_slice(&[f64::from(u8::from(*converged)), *renders as f64]);
    numbers
}

fn of_numbers(n: &[f64]) -> Found {
    let single = |i: usize| n[i] as f32;
    Found {
        pose: CropPose {
            rotation: DQuat::from_xyzw(n[0], n[1], n[2], n[3]),
            size: n[4],
            place: DVec2::new(n[5], n[6]),
            distance: n[7],
        },
        score: Score {
            total: single(8),
            overlap: single(9),
            coverage: single(10),
            depth: single(11),
            normals: single(12),
            outline: single(13),
            hidden: single(14),
            union: single(15),
            counts: [16, 17, 18].map(|i| n[i] as u32),
        },
        converged: n[19] != 0.0,
        renders: n[20] as usize,
    }
}
