//! TypeScript's declarations of options, results and codes are those of the Rust structs.
//!
//! `UPDATE=1 cargo test --features types typescript` writes the file after a change.

use std::path::Path;

use sim3align::align::evaluate::{EvaluateOptions, Evaluation};
use sim3align::align::options::{
    AlignOptions, EstimateOptions, ExtentAxis, GuardMode, Icp, Preset, Quality, RegisterOptions, SearchScope,
};
use sim3align::align::report::{
    Alignment, Alternative, Counts, Registration, ScoreTerms, Sim3, Uncertainty, Warning, WarningCode,
};
use sim3align::metrics::Metrics;
use sim3align::metrics::pose_error::PoseErrors;
use sim3align::progress::Stage;
use sim3align_geometry::error::ErrorCode;
use ts_rs::{Config, TS};

fn declaration<T: TS>(config: &Config) -> String {
    format!("{}export {}\n", T::docs().unwrap_or_default(), T::decl(config))
}

#[test]
fn declarations_are_those_of_the_rust_structs() {
    let config = Config::default();
    let declarations = [
        declaration::<Preset>(&config),
        declaration::<Quality>(&config),
        declaration::<SearchScope>(&config),
        declaration::<ExtentAxis>(&config),
        declaration::<GuardMode>(&config),
        declaration::<Icp>(&config),
        declaration::<AlignOptions>(&config),
        declaration::<RegisterOptions>(&config),
        declaration::<EstimateOptions>(&config),
        declaration::<EvaluateOptions>(&config),
        declaration::<Stage>(&config),
        declaration::<ErrorCode>(&config),
        declaration::<WarningCode>(&config),
        declaration::<Warning>(&config),
        declaration::<Sim3>(&config),
        declaration::<Metrics>(&config),
        declaration::<PoseErrors>(&config),
        declaration::<Counts>(&config),
        declaration::<ScoreTerms>(&config),
        declaration::<Alternative>(&config),
        declaration::<Uncertainty>(&config),
        declaration::<Alignment>(&config),
        declaration::<Evaluation>(&config),
        declaration::<Registration>(&config),
    ];
    let header = "// Generated from the Rust structs by tests/suite/typescript.rs; do not edit.\n\n\
        import type { Direction, ScaleBounds, SymmetryOption } from \"../options.js\";\n\
        import type { Sim3Like } from \"../sim3.js\";\n\n";
    let generated = header.to_owned() + &declarations.join("\n");
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../pkg-config/src/generated/types.ts");
    if std::env::var_os("UPDATE").is_some() {
        std::fs::create_dir_all(path.parent().unwrap()).unwrap();
        std::fs::write(&path, &generated).unwrap();
    }
    let committed = std::fs::read_to_string(&path).unwrap_or_default();
    assert!(committed == generated, "{} is out of date: run this test with UPDATE=1", path.display());
}
