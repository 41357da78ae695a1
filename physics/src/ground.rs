//! The height of the ground: a plane that was found in a depth map is no more exact than the bodies that stand on it.

/// Largest distance between a body and the ground that it stands on, metres. A body that disagrees more with the others has
/// a wrong pose, or stands on something else.
pub const AGREE_M: f64 = 3e-3;
/// Largest distance between the ground and the plane that was found, metres.
const REACH_M: f64 = 0.02;

/// The height of the ground on which more than half of the bodies stand within [`AGREE_M`], of the heights of their lowest
/// points: the middle of the largest group, of the narrowest one among equally large ones. `None` if there is no such height
/// near 0.
pub fn agreed_height(lowest: &[f64]) -> Option<f64> {
    let mut best: Option<(usize, f64, f64)> = None;
    for &from in lowest {
        let (mut count, mut to) = (0, from);
        for &z in lowest {
            if z >= from && z <= from + 2.0 * AGREE_M {
                (count, to) = (count + 1, to.max(z));
            }
        }
        let (height, width) = ((from + to) / 2.0, to - from);
        let is_better = best.is_none_or(|(most, narrowest, _)| count > most || (count == most && width < narrowest));
        if 2 * count > lowest.len() && height.abs() <= REACH_M && is_better {
            best = Some((count, width, height));
        }
    }
    best.map(|(_, _, height)| height)
}
