//! Makes a list of choices smaller while it still shows its fault.

/// The smallest list found of which `fails` is true, in at most `trials` trials.
pub fn minimise(list: &[u32], trials: usize, mut fails: impl FnMut(&[u32]) -> bool) -> Vec<u32> {
    let mut best = list.to_vec();
    let mut left = trials;
    let mut attempt = |candidate: Vec<u32>, best: &mut Vec<u32>| {
        if left == 0 || candidate == *best {
            return false;
        }
        left -= 1;
        let still = fails(&candidate);
        if still {
            *best = candidate;
        }
        still
    };
    loop {
        let before = best.clone();
        // Cuts the end off: missing choices are 0.
        let mut length = best.len() / 2;
        while length > 0 {
            let shorter = best[..best.len().saturating_sub(length)].to_vec();
            if !attempt(shorter, &mut best) {
                length /= 2;
            }
        }
        // Removes parts, for lists of things.
        for width in [8, 4, 2, 1] {
            let mut at = 0;
            while at + width <= best.len() {
                let without = [&best[..at], &best[at + width..]].concat();
                if !attempt(without, &mut best) {
                    at += 1;
                }
            }
        }
        // Makes numbers smaller.
        for at in 0..before.len() {
            let Some(&value) = best.get(at) else { break };
            let mut smaller = |new: u32, best: &mut Vec<u32>| {
                let mut candidate = best.clone();
                candidate[at] = new;
                attempt(candidate, best)
            };
            if value == 0 || smaller(0, &mut best) {
                continue;
            }
            while best[at] > 1 && smaller(best[at] / 2, &mut best) {}
            while best[at] > 1 && smaller(best[at] - 1, &mut best) {}
        }
        if best == before {
            return best;
        }
    }
}
