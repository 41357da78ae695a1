//! A helper of an alignment: it runs tasks of the searches of another thread, from the same input.

use std::rc::Rc;

use super::search::Request;
use crate::evidence::observation::Observation;
use crate::helpers::Part;
use crate::precise::drawing::prepared_mesh::PreparedMesh;
use crate::precise::observation::clean::CleanObservation;
use crate::precise::scoring::prior::Prior;
use crate::precise::search::problem::Search;
use crate::precise::search::tasks::RoundTasks;
use crate::report::Effort;

/// A helper of an alignment.
pub struct Helper {
    /// One per view; `None` for a view without a mask.
    observations: Vec<Option<Observation>>,
    mesh: Rc<PreparedMesh<'static>>,
    request: Request,
    set_scene_term: Box<dyn Fn(&mut Search)>,
    /// Those that it has had tasks of.
    searches: Vec<Search>,
    /// The tasks to be run.
    part: Option<Part>,
    tasks: Option<RoundTasks<'static>>,
}

impl Helper {
    /// A helper that is ready for the search with the greatest effort in the first view. `request` are the options of one
    /// view; `set_scene_term` sets the scene around the object.
    pub fn new(
        observations: Vec<Option<Observation>>,
        mesh: Rc<PreparedMesh<'static>>,
        request: Request,
        set_scene_term: impl Fn(&mut Search) + 'static,
    ) -> Self {
        let (set_scene_term, searches) = (Box::new(set_scene_term), Vec::new());
        let mut helper = Self { observations, mesh, request, set_scene_term, searches, part: None, tasks: None };
        if let Some(effort) = helper.request.efforts().last().map(|settings| settings.effort) {
            helper.search(0, effort, false);
            helper.searches.iter().for_each(Search::make_grids);
        }
        helper
    }

    /// Reads a message of the alignment.
    pub fn receive(&mut self, message: &[f64]) {
        let Some((part, tasks)) = Part::read(message, self.part.as_ref()) else { return };
        self.part = Some(part);
        self.tasks = RoundTasks::read(tasks).or(self.tasks.take());
    }

    /// Runs tasks until it is time; the message about them, or `None` if there is nothing to do.
    pub fn step(&mut self, is_time: impl FnMut() -> bool) -> Option<Vec<f64>> {
        let RoundTasks { view, effort, has_scene_term, .. } = *self.tasks.as_ref()?;
        let place = self.search(view, effort, has_scene_term)?;
        self.part.as_mut()?.run(&mut self.tasks.as_ref()?.on(&self.searches[place]), is_time)
    }

    /// The place of a search in the list.
    fn search(&mut self, view: usize, effort: Effort, has_scene_term: bool) -> Option<usize> {
        let of_view = |search: &&Search| search.view == view;
        let is_it = |search: &Search| search.effort() == effort && search.has_scene_term() == has_scene_term;
        if let Some(known) = self.searches.iter().position(|search| of_view(&search) && is_it(search)) {
            return Some(known);
        }
        let clean = match self.searches.iter().find(of_view) {
            Some(other) => Rc::clone(&other.observation),
            None => Rc::new(CleanObservation::new(self.observations.get(view)?.as_ref()?)),
        };
        let settings = self.request.efforts().iter().find(|settings| settings.effort == effort)?;
        let pyramid = self.mesh.pyramid(&settings.grids)?;
        let mut search = Search::new(clean, pyramid, *settings);
        search.view = view;
        let options = self.request.options();
        search.assume(Prior::of(options, self.mesh.mesh(), &search.mesh.frame));
        if search.prior.initial.is_some() {
            search.equivalence = search.mesh.equivalence(&options.symmetry).ok()?;
        }
        if has_scene_term {
            (self.set_scene_term)(&mut search);
        }
        self.searches.push(search);
        Some(self.searches.len() - 1)
    }
}
