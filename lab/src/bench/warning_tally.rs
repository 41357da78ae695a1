//! How often a warning comes with a wrong pose.

use sim3align::report::{AnyAlignment, WarningCode};

use super::benchmark::{Record, STRICT};

/// Poses whose truth is known, and how many of them are wrong.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Tally {
    /// All of them.
    pub poses: usize,
    /// Those beyond [`STRICT`].
    pub wrong: usize,
}

impl Tally {
    fn add(&mut self, is_right: bool) {
        self.poses += 1;
        self.wrong += usize::from(!is_right);
    }

    /// In percent; `None` without poses.
    pub fn wrong_percent(&self) -> Option<f64> {
        (self.poses > 0).then(|| 100.0 * self.wrong as f64 / self.poses as f64)
    }
}

/// The poses with and without a warning: a warning is worth its place if poses with it are wrong far more often.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct WarningTally {
    /// The warning.
    pub code: WarningCode,
    /// The poses with it.
    pub with: Tally,
    /// All others.
    pub without: Tally,
}

impl WarningTally {
    /// The warnings of records, in the order of first occurrence. Records without pose or truth do not count.
    pub fn of(records: &[&Record]) -> Vec<Self> {
        let known = || {
            records.iter().filter_map(|record| {
                let warnings = record.alignment.as_ref().map(AnyAlignment::warnings)?;
                Some((warnings, record.success(&STRICT)?))
            })
        };
        let mut tallies: Vec<Self> = Vec::new();
        for code in known().flat_map(|(warnings, _)| warnings).map(|warning| warning.code) {
            if tallies.iter().all(|tally| tally.code != code) {
                tallies.push(Self { code, with: Tally::default(), without: Tally::default() });
            }
        }
        for tally in &mut tallies {
            for (warnings, is_right) in known() {
                let is_given = warnings.iter().any(|warning| warning.code == tally.code);
                let side = if is_given { &mut tally.with } else { &mut tally.without };
                side.add(is_right);
            }
        }
        tallies
    }
}
