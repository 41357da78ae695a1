//! Rows of the benchmark from text: `NAME: option=value option=value`.

use crate::bench::variants::Surplus;
use crate::effects::monocular::DepthModel;
use crate::prelude::*;
use sim3align::options::{Choice, Field, Options};
use sim3align::register::options::RegisterOptions;
use sim3align::report::Preset;

named! {
    /// The call that computes the poses of a row.
    #[derive(Default)]
    pub enum Call {
        /// `align` of each object alone.
        #[default]
        Align = "align",
        /// `alignScene` of all objects.
        Scene = "scene",
        /// `alignViews` of all images.
        Views = "views",
        /// A tracker over all images.
        Track = "track",
    }
}

/// A row of the benchmark: a call and its options. Its text takes the JavaScript names of options, and the names in
/// backquotes below.
#[derive(Debug, Clone, Default)]
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
    /// The options of `register`; the scale is 1 by default.
    pub register: RegisterOptions,
    /// The folder of another program's answers, which are the poses of the row.
    pub import: Option<PathBuf>,
    /// `color`: whether photos and the colours of meshes count.
    pub color: bool,
    /// `cameras`: whether the poses of the cameras are known.
    pub cameras: bool,
    /// `views`: the number of images, evenly spread; `None` for all.
    pub views: Option<usize>,
    /// `masks`: the number of images that have their mask; `None` for all.
    pub masks: Option<usize>,
    /// `initial`: whether calls get a generator's placement, that of the folder or a simulated one.
    pub initial: bool,
    /// `model`: the depth model that replaces the depth.
    pub model: Option<DepthModel>,
    /// `surplus`: parts that are added to the meshes.
    pub surplus: Option<Surplus>,
    /// `misfit`: whether meshes are those of other objects, so that no pose is right.
    pub misfit: bool,
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
            register: RegisterOptions { scale: ScaleOption::Fixed(1.0), ..RegisterOptions::default() },
            color: true,
            cameras: true,
            text: text.trim().into(),
            ..Self::default()
        };
        for assignment in text.split_whitespace() {
            let (name, value) = assignment.split_once('=').ok_or_else(|| format!("{assignment:?} is no NAME=VALUE"))?;
            row.assign(name, value).map_err(|error| format!("{name}: {error}"))?;
        }
        Ok(row)
    }

    fn assign(&mut self, name: &str, value: &str) -> Result<(), String> {
        let flag = || value.parse::<bool>().map_err(|_| format!("found {value:?}, expected true or false"));
        let number = || value.parse().map(Some).map_err(|_| format!("found {value:?}, expected a number"));
        match name {
            "call" => self.call = value.parse()?,
            "color" => self.color = flag()?,
            "cameras" => self.cameras = flag()?,
            "views" => self.views = number()?,
            "masks" => self.masks = number()?,
            "initial" => self.initial = flag()?,
            "model" => self.model = Some(value.parse()?),
            "surplus" => self.surplus = Some(value.parse()?),
            "misfit" => self.misfit = flag()?,
            "preset" if self.preset.set(value) => {}
            "preset" => return Err(format!("found {value:?}, expected precise or paper")),
            _ => {
                // An option that several calls have is set for all.
                let set = [
                    set_option(&mut self.precise, name, value),
                    set_option(&mut self.paper, name, value),
                    set_option(&mut self.register, name, value),
                ];
                set.into_iter().flatten().reduce(Result::and).ok_or("no option has this name")??;
            }
        }
        Ok(())
    }
}

/// Sets an option by its JavaScript name; `None` where there is no such option. Directions, symmetries and poses differ from
/// case to case and have no text.
fn set_option<T: Options>(options: &mut T, name: &str, text: &str) -> Option<Result<(), String>> {
    let (_, mut field) = options.named_fields().into_iter().find(|(own, _)| own == name)?;
    if set(&mut field, text).is_none() {
        return Some(Err(format!("found {text:?}, expected {}", field.expected())));
    }
    Some(field.check(name).map_err(|error| error.to_string()))
}

fn set(field: &mut Field<'_>, text: &str) -> Option<()> {
    match field {
        Field::Count(value, _) => **value = text.parse().ok()?,
        Field::Number(value, _) => **value = text.parse().ok()?,
        Field::OptionalNumber(value, _) | Field::Positive(value) => **value = or_null(text, |text| text.parse().ok())?,
        Field::Flag(flag) => **flag = text.parse().ok()?,
        Field::Scale(scale) => {
            **scale = match numbers(text).as_deref() {
                _ if text == "free" => ScaleOption::Free,
                Some(&[fixed]) => ScaleOption::Fixed(fixed),
                Some(&[min, max]) => ScaleOption::Between([min, max]),
                _ => return None,
            }
        }
        Field::Guard(guard) => **guard = or_null(text, |text| numbers(text)?.try_into().ok())?,
        Field::Choice(choice) => return choice.set(text).then_some(()),
        Field::Direction(_) | Field::Symmetry(_) | Field::Transform(_) => return None,
    }
    Some(())
}

fn or_null<T>(text: &str, parse: impl FnOnce(&str) -> Option<T>) -> Option<Option<T>> {
    if text == "null" { Some(None) } else { parse(text).map(Some) }
}

/// Numbers with commas between them.
fn numbers(text: &str) -> Option<Vec<f64>> {
    text.split(',').map(|part| part.trim().parse().ok()).collect()
}
