//! The exact Euclidean distance transform of a binary image.

/// The distance if the image has no set pixel.
pub const NO_PIXEL: u32 = u32::MAX;

/// Squared distance of every pixel to the nearest set pixel, in pixels², row-major; [`NO_PIXEL`] everywhere if
/// none is set. `set` holds `width` × `height` values.
///
/// Two scans in integers, linear in the number of pixels (Meijster, Roerdink and Hesselink 2000): down and up
/// the columns, then along each row the lower envelope of the columns' parabolas.
pub fn squared_distances(set: &[bool], width: usize, height: usize) -> Vec<u32> {
    let mut distances = vec![NO_PIXEL; set.len()];
    if width == 0 || height == 0 || set.len() != width * height || !set.contains(&true) {
        return distances;
    }
    let in_column = column_distances(set, width, height);
    // The parabolas of the envelope, each with the first column where it is the lowest.
    let mut envelope: Vec<(i64, i64)> = Vec::with_capacity(width);
    for (row, out) in in_column.chunks_exact(width).zip(distances.chunks_exact_mut(width)) {
        let squared = |x: i64| i64::from(row[x as usize]) * i64::from(row[x as usize]);
        let value = |x: i64, from: i64| (x - from) * (x - from) + squared(from);
        envelope.clear();
        for x in 0..width as i64 {
            while envelope.last().is_some_and(|&(top, start)| value(start, top) > value(start, x)) {
                envelope.pop();
            }
            let start = envelope.last().map_or(0, |&(top, _)| {
                // The first column where x is lower than top.
                (x * x - top * top + squared(x) - squared(top)).div_euclid(2 * (x - top)) + 1
            });
            if start < width as i64 {
                envelope.push((x, start));
            }
        }
        for x in (0..width as i64).rev() {
            while envelope.len() > 1 && envelope.last().is_some_and(|&(_, start)| start > x) {
                envelope.pop();
            }
            if let Some(&(top, _)) = envelope.last() {
                out[x as usize] = u32::try_from(value(x, top)).unwrap_or(NO_PIXEL - 1);
            }
        }
    }
    distances
}

/// Distance to the nearest set pixel of the same column. A column without one gets a value larger than any distance in
/// the image.
fn column_distances(set: &[bool], width: usize, height: usize) -> Vec<u32> {
    let far = (width + height) as u32;
    let mut distances = vec![far; set.len()];
    let mut scan = |rows: &mut dyn Iterator<Item = usize>| {
        let mut above: Option<usize> = None;
        for v in rows {
            for u in 0..width {
                let i = v * width + u;
                let carried = above.map_or(far, |a| (distances[a * width + u] + 1).min(far));
                distances[i] = if set[i] { 0 } else { distances[i].min(carried) };
            }
            above = Some(v);
        }
    };
    scan(&mut (0..height));
    scan(&mut (0..height).rev());
    distances
}
