//! A cluttered scene and its pairs.

use serde_json::json;

use super::difficulty::{Sight, difficulty, tier};
use super::heap::Below;
use super::layout::{Layout, Placed, Stance};
use super::prior::Prior;
use super::view::{DeskView, Seen};
use crate::bench::benchmark::BenchCase;
use crate::case_folder::contents::{glb_file, parameters_json};
use crate::cases::case::{declared, is_telling};
use crate::cases::distortion::canonicalise;
use crate::cases::mask::Segmented;
use crate::cases::readings::Readings;
use crate::cases::scene::Scene;
use crate::cases::streams::{
    LAYOUT_STREAM, MASK_STREAM, OBJECT_STREAM, QUALITY_STREAM, READINGS_STREAM, SCENE_STREAM, STANCE_STREAM,
};
use crate::cases::tier::{Class, OutlineErrors, Tier};
use crate::files::NamedFile;
use crate::prelude::*;
use sim3align::align::evaluate::Truth;
use sim3align_geometry::order::median;

/// Metres per unit of the depth maps: finer than the noise, and compact as 16-bit images.
pub const DEPTH_SCALE: f64 = 0.0001;

/// What all cases are called.
const CLASS: &str = "scene";

/// Minimum number of pixels in a mask.
pub const MIN_MASK_PX: usize = 350;

/// Minimum visible fraction of the silhouette of an object.
pub const LEAST_VISIBLE: f64 = 0.35;

/// Layouts that are tried, and cameras before each.
const LAYOUTS: u64 = 400;
const VIEWS: u64 = 12;
/// The largest share of an object that the image's border cuts off, where it may.
const MOST_CUT: f64 = 0.2;
/// The largest share of a mask without a reading.
const MOST_MISSING: f64 = 0.45;
/// The share of the evaluation set's grain that monocular depth has: models' maps are smooth, and files of them small.
const GRAIN: f64 = 0.1;

/// A cluttered scene.
#[derive(Debug, Clone)]
pub struct ClutteredScene {
    /// Index in the set.
    pub index: usize,
    /// One pair per masked object.
    pub pairs: Vec<ScenePair>,
    /// What else stands there, in the frame of the objects.
    pub clutter: Mesh,
}

/// A masked object of a scene, to be paired with what a prior makes of it.
#[derive(Debug, Clone)]
pub struct ScenePair {
    /// The scene's place in the set, and the object's in the scene.
    pub scene: usize,
    /// See `scene`.
    pub index: usize,
    /// What the object is.
    pub family: String,
    /// The object as it is: metres, z up, resting on z = 0.
    pub object: Mesh,
    /// Where it is seen, in the depth map's own metric.
    pub camera_from_object: Similarity,
    /// Depth, which all pairs of the scene share, mask and camera.
    pub observation: Observation,
    /// How hard it is, see [`difficulty`].
    pub difficulty: f64,
    seed: u64,
    placed: Placed,
    /// The object before and behind all else.
    view: Scene,
    tags: Vec<&'static str>,
    parameters: Vec<(&'static str, f64)>,
}

impl ClutteredScene {
    /// The scene at a place in a set, with this many objects.
    pub(super) fn draw(set_seed: u64, index: usize, objects: usize, is_arranged: bool) -> Result<Self> {
        first_fit(&format!("scene {index}"), LAYOUTS, |attempt| {
            let seed = mixed([set_seed, index as u64, attempt]);
            let things = &mut Random::new(seed, OBJECT_STREAM);
            let stances = &mut Random::new(seed, STANCE_STREAM);
            let random = &mut Random::new(seed, LAYOUT_STREAM);
            let layout = if is_arranged {
                Layout::arranged(objects, random, things, stances)?
            } else {
                Layout::draw(objects, random, things)?
            };
            let view_random = &mut Random::new(seed, SCENE_STREAM);
            // Every tenth scene or so may show an object that the border cuts; of the arranged ones, every fourth.
            let too_near = chance(view_random, if is_arranged { 0.25 } else { 0.1 });
            let cut = if too_near { MOST_CUT } else { 0.0 };
            for view in 0..VIEWS {
                let seen = DeskView::draw(&layout, too_near, view_random)?.see(&layout);
                let shown = seen.shown_enough(&layout, cut, is_arranged, view_random);
                let count = shown.iter().filter(|shown| **shown).count();
                // What an arranged scene hardly shows is one of the things without a mask.
                let is_enough = if is_arranged { count >= 2 && 3 * count >= 2 * objects } else { count == objects };
                if is_enough && let Some(scene) = Self::read(&layout, &seen, &shown, index, mixed([seed, view]))? {
                    return Ok(Some(scene));
                }
            }
            Ok(None)
        })
    }

    /// Depth and masks of what a camera sees; `None` where they leave too little of an object.
    fn read(layout: &Layout, seen: &Seen, masked: &[bool], index: usize, seed: u64) -> Result<Option<Self>> {
        let quality = &mut Random::new(seed, QUALITY_STREAM);
        let shown: Vec<&[bool]> = seen.objects.iter().map(|object| object.visible.as_slice()).collect();
        let diagonals = layout.objects.iter().map(|placed| placed.object.diagonal() as f32);
        let diagonal = f64::from(median(diagonals).unwrap_or_default());
        let cell = (drawn_tier(quality), Class::Plain);
        let random = &mut Random::new(seed, READINGS_STREAM);
        let readings = Readings::of_several(&seen.together, &shown, (diagonal, GRAIN), cell, random, None)?;
        let depth = in_units(&readings.depth)?;
        let mut pairs = Vec::new();
        let things = layout.objects.iter().zip(&seen.objects).enumerate();
        for (k, (placed, view)) in things.filter(|(k, _)| masked[*k]) {
            let tier_of_mask = drawn_tier(quality);
            let class =
                if tier_of_mask != Tier::Easy && chance(quality, 0.12) { Class::RaggedMask } else { Class::Plain };
            let random = &mut Random::new(mixed([seed, k as u64]), MASK_STREAM);
            let segmented = Segmented::draw(view, (tier_of_mask, class), OutlineErrors::Uniform, random)?;
            let readings_in_mask = || segmented.mask.data().iter().zip(depth.data()).filter(|(m, _)| **m != 0);
            let mask_px = readings_in_mask().count();
            let missing = readings_in_mask().filter(|(_, z)| **z == 0.0).count() as f64 / mask_px.max(1) as f64;
            if mask_px < MIN_MASK_PX || missing > MOST_MISSING {
                return Ok(None);
            }
            let Some(distance_m) = median(view.object_depth.iter().copied().filter(|z| *z > 0.0)) else {
                return Ok(None);
            };
            let sight = Sight {
                visible: view.visible_px() as f64 / view.silhouette_px.max(1) as f64,
                mask_px,
                mask_offset_px: segmented.offset_px,
                distance_m: f64::from(distance_m),
            };
            // A map with a metric of its own, whose warp moves each object by a share of it: along the rays, so that
            // its picture stays the same.
            let bias = readings.bias * (1.0 + readings.drifts[k]);
            let metric = Similarity { scale: bias, ..Similarity::identity() };
            let difficulty = difficulty(&sight);
            let mut tags = vec![readings.kind];
            tags.extend((view.hidden > 0.02).then_some("partly-hidden"));
            tags.extend((view.cut > 0.0).then_some("cut"));
            tags.extend((!shows_key(placed, view)).then_some("key-part-hidden"));
            tags.extend(segmented.tags);
            pairs.push(ScenePair {
                scene: index,
                index: k,
                family: placed.object.family.clone(),
                object: placed.mesh.clone(),
                camera_from_object: metric.compose(&view.camera_from_world),
                observation: Observation::new(depth.clone(), segmented.mask, view.camera)?,
                difficulty,
                seed: mixed([seed, k as u64]),
                placed: placed.clone(),
                view: view.clone(),
                tags,
                parameters: vec![
                    ("difficulty", difficulty),
                    ("visible", sight.visible),
                    ("maskPx", mask_px as f64),
                    ("hidden", view.hidden),
                    ("cut", view.cut),
                    ("maskOffsetPx", segmented.offset_px),
                    ("depthBias", bias),
                    ("missingDepth", missing),
                    ("distanceM", sight.distance_m),
                    ("diagonalM", placed.object.diagonal()),
                    ("objects", layout.objects.len() as f64),
                    ("scene", index as f64),
                    ("object", k as f64),
                ],
            });
        }
        Ok(Some(Self { index, pairs, clutter: layout.clutter.clone() }))
    }
}

impl ScenePair {
    /// Whether the object looks the same after some turn.
    pub fn is_symmetric(&self) -> bool {
        !self.placed.symmetry.is_empty()
    }

    /// The pair with what a prior makes of the object.
    ///
    /// # Errors
    /// Only in case of a bug in the generator.
    pub fn case(&self, prior: Prior) -> Result<BenchCase> {
        let seed = mixed([self.seed, prior as u64]);
        let generated = prior.generate(&self.placed, &self.view, seed)?;
        let (mesh, object_from_mesh) = canonicalise(&generated.mesh, seed)?;
        let tags = self.tags.iter().chain(&generated.tags);
        let mut parameters = parameters_json(self.parameters.iter().chain(&generated.parameters));
        parameters["prior"] = json!(prior.as_str());
        let camera_from_mesh = self.camera_from_object.compose(&object_from_mesh);
        Ok(BenchCase {
            name: self.name(),
            tier: tier(self.difficulty).as_str().into(),
            class: CLASS.into(),
            family: self.family.clone(),
            tags: tags.map(|tag| (*tag).to_owned()).collect(),
            parameters,
            observation: self.observation.clone(),
            mesh,
            given: None,
            colors: None,
            truth: Some(Truth { camera_from_mesh, symmetry: declared(&generated.symmetry, &object_from_mesh) }),
        })
    }

    /// The files of the case folder with what a prior makes of the object: name and content. `meta.json` has the prior
    /// among the parameters.
    ///
    /// # Errors
    /// Those of [`ScenePair::case`] and [`BenchCase::files`].
    pub fn files(&self, prior: Prior) -> Result<Vec<NamedFile>> {
        let case = self.case(prior)?;
        let note = format!("{}, {}", case.name, prior.as_str());
        case.files(&note, vec![glb_file(&case.mesh)], None, Some(DEPTH_SCALE))
    }

    /// The pair's name, and that of its folder.
    pub fn name(&self) -> String {
        format!("{:03}-{}-{}", self.scene, self.index, self.family)
    }

    /// The axes of symmetry of the object, in its frame.
    pub fn symmetry(&self) -> Vec<SymmetryAxis> {
        match declared(&self.placed.symmetry, &Similarity::identity()) {
            Symmetry::Declared(axes) => axes,
            _ => Vec::new(),
        }
    }

    /// How the object is held.
    pub fn stance(&self) -> Stance {
        self.placed.stance
    }

    /// What it touches below.
    pub fn below(&self) -> Below {
        self.placed.below
    }

    /// Visible share of the object's silhouette.
    pub fn visible(&self) -> f64 {
        self.view.visible_px() as f64 / self.view.silhouette_px.max(1) as f64
    }
}

impl Seen {
    /// Whether it shows enough of each object to tell how it lies; unless all are wanted, those after the first one that
    /// it does not show enough of count as not shown.
    fn shown_enough(&self, layout: &Layout, most_cut: f64, wants_all: bool, random: &mut Random) -> Vec<bool> {
        let mut is_shown = |view: &Scene, placed: &Placed| {
            let pixels = view.visible_px();
            pixels >= MIN_MASK_PX
                && pixels as f64 >= LEAST_VISIBLE * view.silhouette_px as f64
                && view.cut <= most_cut + 1e-9
                && is_telling(view, &placed.mesh, Tier::Hard)
                // A mug whose handle is out of sight: no case to count on, though one that occurs.
                && (shows_key(placed, view) || chance(random, 0.15))
        };
        let mut shown = vec![false; self.objects.len()];
        for (shown, (view, placed)) in shown.iter_mut().zip(self.objects.iter().zip(&layout.objects)) {
            *shown = is_shown(view, placed);
            if !*shown && !wants_all {
                break;
            }
        }
        shown
    }
}

/// Whether a part shows that tells how the object is turned.
fn shows_key(placed: &Placed, view: &Scene) -> bool {
    let object = &placed.object;
    object.keys.is_empty() || view.part_px(&object.keys, &object.parts) >= (view.visible_px() / 50).max(25)
}

/// How good a model's answer is on this picture.
fn drawn_tier(random: &mut Random) -> Tier {
    match random.uniform() {
        u if u < 0.35 => Tier::Easy,
        u if u < 0.8 => Tier::Medium,
        _ => Tier::Hard,
    }
}

/// Depth in whole units, as a file holds it; nothing where that is too far for 16 bits.
fn in_units(depth: &DepthMap) -> Result<DepthMap> {
    let units = depth.data().iter().map(|&z| (f64::from(z) / DEPTH_SCALE).round());
    let metres = units.map(|units| if units <= 65535.0 { (units * DEPTH_SCALE) as f32 } else { 0.0 }).collect();
    DepthMap::from_metres(depth.width(), depth.height(), metres)
}
