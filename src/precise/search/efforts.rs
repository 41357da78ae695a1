//! Efforts: the searches that a call may need, one after the other, and the progress of each.

use core::ops::Range;

use super::recipe::SearchSettings;
use crate::precise::options::AlignOptions;

/// Share of its time after which a search that assumes that nothing cuts the mask has ended.
const UNCUT_SHARE: f64 = 0.4;

/// The searches for these options, with increasing effort.
pub fn of(options: &AlignOptions) -> Vec<SearchSettings> {
    let is_fixed = options.scale.bounds().is_some_and(|[min, max]| min == max) || options.known_extent_m.is_some();
    let efforts = options.quality.efforts().iter();
    let efforts = efforts.map(|&effort| SearchSettings { lock_scale: is_fixed, ..effort.into() });
    match options.work_budget {
        Some(budget) => within(efforts, budget),
        None => efforts.collect(),
    }
}

/// Progress of an alignment at the start and the end of one of `efforts` searches, 0 to 1. The last one, if it is reached,
/// takes most of the time.
pub fn share(effort: usize, efforts: usize) -> Range<f64> {
    const SEARCH: [f64; 2] = [0.2, 0.85];
    const BEFORE: f64 = 0.15;
    let start = SEARCH[0] + BEFORE * effort as f64;
    start..if effort + 1 < efforts { start + BEFORE } else { SEARCH[1] }
}

/// The two parts of a range of progress: the shorter one of a search that assumes that nothing cuts the mask.
pub fn split(share: Range<f64>) -> [Range<f64>; 2] {
    let middle = share.start + UNCUT_SHARE * (share.end - share.start);
    [share.start..middle, middle..share.end]
}

/// Searches that together stay within a budget: the last one is scaled to what the others leave.
fn within(efforts: impl Iterator<Item = SearchSettings>, budget: f64) -> Vec<SearchSettings> {
    let mut left = budget;
    let mut list: Vec<SearchSettings> = Vec::new();
    for settings in efforts {
        // A remainder that is small relative to the work before it is not worth another search.
        if list.last().is_some_and(|before| left < before.cost()) {
            break;
        }
        list.push(settings);
        left -= settings.cost();
    }
    if let Some(last) = list.last_mut() {
        *last = last.within(left + last.cost());
    }
    list
}
