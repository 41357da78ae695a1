//! Options of the default method.

use crate::error::{Error, ErrorCode, Result, Text};
use crate::geometry::similarity::Similarity;
use crate::number::number;
use crate::options::choices;
use crate::report::Effort;

/// Relative tolerance of the bounds for an initial scale, because 32-bit floats are rounded.
const ROUNDING: f64 = 1e-6;

choices! {
    /// How much work the search does.
    pub enum Quality {
        /// The default: a `fast` search, and the `best` one if the result of the first is not certain.
        #[default]
        Auto = "auto",
        /// Fewer rotations and candidates: about a third of the time of `balanced`.
        Fast = "fast",
        /// The same work for every input.
        Balanced = "balanced",
        /// More rotations and candidates: about four times the time of `balanced`.
        Best = "best",
    }
}

impl Quality {
    /// The searches of this quality. Each follows the one before if the result of that is not certain.
    pub fn efforts(self) -> &'static [Effort] {
        match self {
            Self::Auto => &[Effort::Fast, Effort::Best],
            Self::Fast => &[Effort::Fast],
            Self::Balanced => &[Effort::Balanced],
            Self::Best => &[Effort::Best],
        }
    }
}

choices! {
    /// Where the search looks for poses.
    pub enum SearchScope {
        /// All rotations; an initial pose is one more candidate.
        #[default]
        Global = "global",
        /// The neighbourhood of the initial pose.
        Local = "local",
    }
}

choices! {
    /// A side of the mesh's bounding box.
    pub enum ExtentAxis {
        /// The longest side.
        #[default]
        Longest = "longest",
        /// The side along the mesh's x axis.
        X = "x",
        /// The side along the mesh's y axis.
        Y = "y",
        /// The side along the mesh's z axis.
        Z = "z",
    }
}

choices! {
    /// What of a mesh's proportions is fitted to the image.
    pub enum Proportions {
        /// Nothing: they are taken to be right.
        #[default]
        Keep = "keep",
        /// Its lengths along the axes of the mesh.
        Axes = "axes",
        /// Lengths and right angles.
        Full = "full",
    }
}

/// Declares options of a call that searches for an object: those of every such call, around those of its struct. `fn` names
/// a function of the struct.
macro_rules! search_options {
    (
        $(#[doc = $type_doc:literal])*
        pub struct $type:ident { $($options:tt)* }
        check $check:path;
        $(fn $search:ident;)?
    ) => {
        $crate::options::options! {
            $(#[doc = $type_doc])*
            pub struct $type {
                /// How much work a search does.
                quality: $crate::precise::options::Quality = Default::default(), Choice;
                /// The scale in metres per mesh unit: `"free"`, a known number (1 for a mesh in metres), or bounds `[min, max]`.
                /// Not together with `knownExtentM`.
                scale: $crate::options::scale::ScaleOption = Default::default(), Scale;
                /// The object's known length along `knownExtentAxis`, in metres. It fixes the scale: for a mug that is 9.5 cm
                /// tall and whose mesh has y up, pass `{ knownExtentM: 0.095, knownExtentAxis: "y" }`.
                known_extent_m: Option<f64> = None, Positive;
                /// The side of the mesh's bounding box that `knownExtentM` measures.
                known_extent_axis: $crate::precise::options::ExtentAxis = Default::default(), Choice;
                /// The object's symmetry: poses that it makes equal are one for `confidence`, `alternatives` and
                /// `uncertainty`. `"auto"` finds it on the surface of the mesh; `[{ axis: [0, 1, 0], fold: 4 }]` declares
                /// quarter turns about the mesh's y axis, without `fold` any turn about it.
                symmetry: $crate::metrics::symmetry::Symmetry = $crate::metrics::symmetry::Symmetry::Auto, Symmetry;
                $($options)*
                /// Seed of all random draws. The same input and seed give the same bits.
                seed: u32 = 0, Count(0..=u32::MAX);
            }
            check $check;
        }

        $(impl $type {
            /// The options of a search in one image.
            pub fn $search(&self) -> $crate::precise::options::AlignOptions {
                let Self { quality, scale, known_extent_m, known_extent_axis, ref symmetry, seed, .. } = *self;
                let symmetry = symmetry.clone();
                $crate::precise::options::AlignOptions {
                    quality, scale, known_extent_m, known_extent_axis, symmetry, seed, ..Default::default()
                }
            }
        })?
    };
}
pub(crate) use search_options;

search_options! {
    /// Options of `align` with the default preset, `"precise"`. All have defaults.
    pub struct AlignOptions {
        /// The up direction in the camera's frame, of any length: `[0, -1, 0]` for a level camera. Together with
        /// `meshUp`, it favours poses in which the object stands upright.
        camera_up: Option<[f64; 3]> = None, Direction;
        /// The up direction in the mesh's frame, of any length: `[0, 1, 0]` for glTF. It requires `cameraUp`.
        mesh_up: Option<[f64; 3]> = None, Direction;
        /// A pose to start from, camera from mesh, in metres: for example an annotator's, or a generator's. Its scale has
        /// to be within `scale`. It is one candidate among those of the search; between turns that the image hardly
        /// tells apart, the one near its rotation is favoured.
        initial: Option<Similarity> = None, Transform;
        /// Where to search: everywhere, or around `initial` only.
        search: SearchScope = SearchScope::Global, Choice;
        /// An upper bound on the work of the search, in units of about a millisecond on a 2020 laptop. The work is
        /// counted, not timed, so that the result does not depend on the machine. `null` sets no bound.
        work_budget: Option<f64> = None, Positive;
        /// Whether to fit the proportions of the mesh, which generators get wrong by some per cent: see `proportions` of the
        /// result. The similarity and its metrics stay those of the mesh as it is. Not of a mesh whose scale is given.
        proportions: Proportions = Proportions::Keep, Choice;
        /// Whether to compute `metrics`. Without them the call takes less time.
        metrics: bool = true, Flag;
        /// Upper bound on the depth readings used for metrics and initial scale. Above it, an even random subset is drawn.
        max_observed_points: u32 = 20_000, Count(32..=1_000_000);
        /// Number of points sampled on the mesh surface for metrics and initial scale.
        surface_samples: u32 = 10_000, Count(100..=1_000_000);
    }
    check check_combination;
}

/// Rejects options that contradict or require each other.
fn check_combination(options: &AlignOptions) -> Result<()> {
    let AlignOptions { scale, known_extent_m, camera_up, mesh_up, initial, search, .. } = options;
    if *search == SearchScope::Local && initial.is_none() {
        let remedy = "Pass the initial pose as `initial`, or omit `search` to search all rotations.";
        return Err(invalid("options.search", "\"local\" without an initial pose", "\"local\" with `initial`", remedy));
    }
    if camera_up.is_some() != mesh_up.is_some() {
        let (argument, found, expected) = if camera_up.is_some() {
            ("options.meshUp", "`cameraUp` alone", "`meshUp` as well")
        } else {
            ("options.cameraUp", "`meshUp` alone", "`cameraUp` as well")
        };
        let remedy = "Pass the up direction in both frames, or in neither.";
        return Err(invalid(argument, found, expected, remedy));
    }
    let Some([min, max]) = scale.bounds() else { return Ok(()) };
    if let Some(extent_m) = *known_extent_m {
        let found = format!("a known extent of {} m and a scale of {}", number(extent_m), scale.describe());
        let remedy = "A known extent fixes the scale: omit one of the two.";
        return Err(invalid("options.knownExtentM", found, "`knownExtentM` or `scale`", remedy));
    }
    match initial {
        Some(pose) if pose.scale < min * (1.0 - ROUNDING) || pose.scale > max * (1.0 + ROUNDING) => {
            let found = format!("a scale of {}", number(pose.scale));
            let expected = format!("a scale within `scale`: {}", scale.describe());
            Err(invalid("options.initial", found, expected, "Widen `scale`, or pass a pose with a scale inside it."))
        }
        _ => Ok(()),
    }
}

fn invalid(argument: &'static str, found: impl Into<Text>, expected: impl Into<Text>, remedy: &'static str) -> Error {
    Error::new(ErrorCode::InvalidOption, argument, found, expected, remedy)
}
