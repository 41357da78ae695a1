//! Rows of the benchmark from text: `NAME: option=value option=value`.

use super::option_text;
use crate::effects::monocular::DepthModel;
use crate::prelude::*;
use sim3align::options::{Choice, Options};
use sim3align::report::Preset;

named! {
    /// The call that computes the poses of a row.
    #[derive(Default)]
    pub enum Call: "call" {
        /// `align` of each object alone.
        #[default]
        Align = "align",
        /// `alignScene` of all objects.
        Scene = "scene",
        /// `alignViews` of all images.
        Views = "views",
        /// A tracker over all images.
        Track = "track",
        /// No call: the placement of the mesh by its generator.
        Placement = "placement",
    }
}

/// A row of the benchmark: a call and its options. Its text takes the JavaScript names of options, and the names in
/// backquotes below.
#[derive(Debug, Clone)]
pub struct Row {
    /// Its name in tables.
    pub name: String,
    /// `call`.
    pub call: Call,
    /// `preset`.
    pub preset: Preset,
    /// The options of the precise preset.
    pub precise: AlignOptions,
    /// The options of the paper preset.
    pub paper: PaperOptions,
    /// The folder of another program's answers, which are the poses of the row.
    pub import: Option<PathBuf>,
    /// `color`: whether photos and the colours of meshes count.
    pub color: bool,
    /// `initial`: whether calls get the generator's placement.
    pub initial: bool,
    /// `up`: whether calls get an up direction that is 5° off.
    pub up: bool,
    /// `cameras`: whether the poses of the cameras are known.
    pub cameras: bool,
    /// `views`: the number of images; `None` for all.
    pub views: Option<usize>,
    /// `masks`: the number of images that have their mask; `None` for all.
    pub masks: Option<usize>,
    /// `model`: the depth model that replaces the depth.
    pub model: Option<&'static DepthModel>,
    /// All assignments, as written.
    pub text: String,
}

impl Row {
    /// A row whose poses are another program's.
    pub fn imported(name: &str, folder: &Path) -> Result<Self, String> {
        Ok(Self { import: Some(folder.to_owned()), ..Self::parse(&format!("{name}:"))? })
    }

    /// Reads a row.
    ///
    /// # Errors
    /// In words: what is wrong with the text.
    pub fn parse(text: &str) -> Result<Self, String> {
        let (name, text) = text.split_once(':').ok_or_else(|| format!("row {text:?} has no colon after its name"))?;
        let mut row = Self {
            name: name.trim().into(),
            call: Call::default(),
            preset: Preset::default(),
            precise: AlignOptions::default(),
            paper: PaperOptions::default(),
            import: None,
            color: true,
            initial: false,
            up: false,
            cameras: true,
            views: None,
            masks: None,
            model: None,
            text: text.trim().into(),
        };
        text.split_whitespace().try_for_each(|assignment| row.assign(assignment))?;
        Ok(row)
    }

    fn assign(&mut self, assignment: &str) -> Result<(), String> {
        let (name, value) = assignment.split_once('=').ok_or_else(|| format!("{assignment:?} is no NAME=VALUE"))?;
        let wrong = |expected: &str| format!("{name}: found {value:?}, expected {expected}");
        let flag = || value.parse::<bool>().map_err(|_| wrong("true or false"));
        let number = || value.parse::<usize>().map(Some).map_err(|_| wrong("a number"));
        match name {
            "call" => self.call = Call::from_name(value).map_err(|error| error.to_string())?,
            "color" => self.color = flag()?,
            "initial" => self.initial = flag()?,
            "up" => self.up = flag()?,
            "cameras" => self.cameras = flag()?,
            "views" => self.views = number()?,
            "masks" => self.masks = number()?,
            "model" => self.model = Some(DepthModel::named(value).ok_or_else(|| wrong("a depth model"))?),
            "preset" if self.preset.set(value) => {}
            "preset" => return Err(wrong("precise or paper")),
            _ => {
                // An option that both presets have is set for both.
                let set = [
                    option_text::assign(&mut self.precise, name, value),
                    option_text::assign(&mut self.paper, name, value),
                ];
                let known = || [AlignOptions::names(), PaperOptions::names()].concat().join(", ");
                let outcome = set.into_iter().flatten().reduce(Result::and);
                outcome.ok_or_else(|| format!("no option {name}; there are {}", known()))??;
            }
        }
        Ok(())
    }
}
