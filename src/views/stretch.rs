//! The proportions of a mesh that several views show together: one stretch for all of them, where their cameras are known.

use super::joint::{Joint, JointScore};
use super::view_set::ViewSet;
use super::world_pose::{OF_SCALE, WorldPose};
use crate::geometry::mesh::Mesh;
use crate::geometry::normal_equations::{NormalEquationsOf, PARAMETERS};
use crate::precise::drawing::pose::Step;
use crate::precise::options::Proportions as Freedom;
use crate::precise::scoring::conditioning::fix_roll;
use crate::precise::scoring::score::Score;
use crate::precise::search::ascent::{Ascent, ascend};
use crate::precise::search::proportions::{InProportion, PROPORTIONS, Proportions, Shapes, Stretched};
use crate::precise::search::recipe::FINEST;
use crate::precise::search::refine::Refiner;
use crate::precise::verdict::stretch::{
    ALL, GRIDS, REACHES, STEPS, climb, deviations_of_lengths, report, shapes, significant,
};
use crate::report::Stretch;

/// The best proportions near a pose in the world; `None` if they are not asked for, or the size of the mesh is given.
pub fn stretch(views: &ViewSet<'_>, mesh: &Mesh, pose: &WorldPose, freedom: Freedom) -> Option<Stretch> {
    let search = views.parts.first()?.search;
    if freedom == Freedom::Keep || views.lock_scale {
        return None;
    }
    let shapes = shapes(&search.equivalence, freedom);
    let mut at = StretchedInWorld { pose: *pose, proportions: Proportions::default() };
    let mut uncertainty = [0.0; 3];
    for (grid, reaches) in GRIDS.into_iter().zip(REACHES) {
        let mut problem = JointInProportion { joint: &mut views.level(grid), shapes };
        let stretched = |at: StretchedInWorld, by| StretchedInWorld { proportions: at.proportions.by(by), ..at };
        at = climb(&mut problem, at, reaches, &shapes, stretched);
        let score = problem.score(&at);
        let mut equations = problem.equations(&at, &score);
        search.equivalence.free_axis(at.pose.rotation).into_iter().for_each(|axis| fix_roll(&mut equations, axis));
        uncertainty = deviations_of_lengths(&equations, &OF_SCALE, &shapes)?;
        if grid == FINEST {
            let growth = at.pose.log_scale - pose.log_scale;
            let (kept, proportions) = significant(&equations, &OF_SCALE, &shapes, (growth, &at.proportions))?;
            let log_scale = at.pose.log_scale + kept - growth;
            let start = StretchedInWorld { pose: WorldPose { log_scale, ..at.pose }, proportions };
            problem.joint.lock_scale = true;
            at = ascend(&mut JointInProportion { shapes: Shapes::FIXED, ..problem }, start, STEPS[0]).pose;
        }
    }
    Some(report(mesh, &search.mesh.frame, &at.proportions, |frame| at.pose.similarity(frame), uncertainty))
}

/// A pose in the world of a mesh with other proportions.
#[derive(Debug, Clone, Copy)]
struct StretchedInWorld {
    pose: WorldPose,
    proportions: Proportions,
}

/// A refinement of a pose and of the proportions in all views.
struct JointInProportion<'j, 'a> {
    joint: &'j mut Joint<'a>,
    shapes: Shapes,
}

impl Ascent<ALL> for JointInProportion<'_, '_> {
    type Pose = StretchedInWorld;
    type Score = JointScore;

    fn allowed(&self, at: StretchedInWorld) -> StretchedInWorld {
        StretchedInWorld { pose: self.joint.allowed(at.pose), ..at }
    }

    fn score(&mut self, at: &StretchedInWorld) -> JointScore {
        let stretch = at.proportions.matrix().as_mat3();
        let mut sum = JointScore { total: -self.shapes.cost(&at.proportions) as f32, views: Vec::new() };
        for (view, canvas) in self.joint.views.iter().zip(&mut self.joint.canvases) {
            let score = view
                .camera
                .see(&at.pose)
                .map_or_else(Score::default, |seen| view.objective.score_stretched(canvas, &seen, &stretch));
            sum.total += score.total.max(view.floor);
            sum.views.push(score);
        }
        sum
    }

    fn equations(&mut self, at: &StretchedInWorld, score: &JointScore) -> NormalEquationsOf<ALL> {
        let mut sum = NormalEquationsOf::new();
        for ((view, canvas), score) in self.joint.views.iter().zip(&mut self.joint.canvases).zip(&score.views) {
            if score.total <= view.floor {
                continue;
            }
            let Some(seen) = view.camera.see(&at.pose) else { continue };
            let refiner = Refiner { objective: view.objective, lock_scale: false };
            let stretched = Stretched { pose: seen, proportions: at.proportions };
            let own = InProportion::new(&refiner, canvas, Shapes::ANY).equations(&stretched, score);
            // The proportions are those of the mesh in every view.
            let mut map = [[0.0; ALL]; ALL];
            for (row, of_pose) in map.iter_mut().zip(view.camera.step_map(&seen)) {
                row[..PARAMETERS].copy_from_slice(&of_pose);
            }
            if self.joint.lock_scale {
                map[3][3] = 0.0;
            }
            for k in 0..PROPORTIONS {
                let mut unit = [0.0; PROPORTIONS];
                unit[k] = 1.0;
                map[PARAMETERS + k][PARAMETERS..].copy_from_slice(&self.shapes.free(unit));
            }
            sum.add_mapped(&own, &map);
        }
        self.shapes.add_to(&at.proportions, &mut sum);
        sum
    }

    fn moved(&self, at: &StretchedInWorld, step: [f64; ALL]) -> Option<StretchedInWorld> {
        let mut first: Step = [0.0; PARAMETERS];
        first.copy_from_slice(&step[..PARAMETERS]);
        let pose = self.joint.moved(&at.pose, first)?;
        Some(StretchedInWorld { pose, proportions: at.proportions.moved(&step) })
    }
}
