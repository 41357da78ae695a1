//! The exact Euclidean distance transform of a binary image.

/// The distance if the image has no set pixel.
pub const NO_PIXEL: u32 = u32::MAX;

/// Squared distance of every pixel to the nearest set pixel, in pixels², row-major; [`NO_PIXEL`] everywhere if
/// none is set. `set` holds `width` × `height` values.
///
/// Two scans, linear in the number of pixels (Meijster, Roerdink and Hesselink 2000): down and up the columns, then along
/// each row the lower envelope of the columns' parabolas.
pub fn squared_distances(set: &[bool], width: usize, height: usize) -> Vec<u32> {
    if width == 0 || height == 0 || set.len() != width * height || !set.contains(&true) {
        return vec![NO_PIXEL; set.len()];
    }
    let mut distances = column_distances(set, width, height);
    // The squared distances in the columns, which are the heights of the parabolas.
    let mut heights = vec![0i64; width];
    // The columns whose parabolas form the envelope, each with the first column where it is the lowest.
    let mut envelope: Vec<(i32, i32)> = Vec::with_capacity(width);
    let none = far(width, height);
    for row in distances.chunks_exact_mut(width) {
        // Beyond the outermost pixels that are not set themselves, and one beside each, nothing changes.
        let Some(first) = row.iter().position(|d| *d > 0) else { continue };
        let last = row.iter().rposition(|d| *d > 0).unwrap_or(first);
        let row = &mut row[first.saturating_sub(1)..(last + 2).min(width)];
        let columns = row.len() as i32;
        heights.iter_mut().zip(row.iter()).for_each(|(h, d)| *h = i64::from(*d) * i64::from(*d));
        let value = |x: i32, from: i32| {
            let apart = i64::from(x - from);
            apart * apart + heights[from as usize]
        };
        envelope.clear();
        // A column without a set pixel is the nearest nowhere.
        for x in (0..columns).filter(|x| row[*x as usize] < none) {
            while envelope.last().is_some_and(|&(top, start)| value(start, top) > value(start, x)) {
                envelope.pop();
            }
            let start = envelope.last().map_or(0, |&(top, _)| {
                let rise = heights[x as usize] - heights[top as usize];
                // Most pixels of a filled area.
                if rise == 0 && x == top + 1 {
                    return x;
                }
                // The first column where x is lower than top, which is right of the start of top. f64 holds both integers
                // exactly and divides faster; quotients of this size are never rounded up to the next integer.
                let [x, top] = [i64::from(x), i64::from(top)];
                let last = (x * x - top * top + rise) as f64 / (2 * (x - top)) as f64;
                if last < f64::from(columns) { last as i32 + 1 } else { columns }
            });
            if start < columns {
                envelope.push((x, start));
            }
        }
        let mut end = columns;
        for &(top, start) in envelope.iter().rev() {
            for (x, out) in (start..end).zip(&mut row[start as usize..end as usize]) {
                *out = value(x, top).min(i64::from(NO_PIXEL - 1)) as u32;
            }
            end = start;
        }
    }
    distances
}

/// Whether each pixel is at most `radius` pixels from a set pixel. Gives the same answer as [`squared_distances`], several
/// times faster.
pub fn within(radius: u32, set: &[bool], width: usize, height: usize) -> Vec<bool> {
    let mut near = vec![false; set.len()];
    if width == 0 || height == 0 || set.len() != width * height {
        return near;
    }
    let far = far(width, height);
    // Half the width of the disc, by rows from its centre.
    let squared = u64::from(radius) * u64::from(radius);
    let half = |row: u32| (squared - u64::from(row) * u64::from(row)).isqrt() as usize;
    let halves: Vec<usize> = (0..=radius.min(far - 1)).map(half).collect();
    // Number of discs that begin in each column, less those that have ended.
    let mut change = vec![0i32; width + 1];
    for (row, near) in column_distances(set, width, height).chunks_exact(width).zip(near.chunks_exact_mut(width)) {
        change.fill(0);
        for (u, distance) in row.iter().enumerate() {
            if let Some(half) = halves.get(*distance as usize) {
                change[u.saturating_sub(*half)] += 1;
                change[(u + half + 1).min(width)] -= 1;
            }
        }
        let mut open = 0;
        for (near, change) in near.iter_mut().zip(&change) {
            open += change;
            *near = open > 0;
        }
    }
    near
}

/// A distance larger than any in the image.
fn far(width: usize, height: usize) -> u32 {
    (width + height) as u32
}

/// Distance to the nearest set pixel of the same column; [`far`] in a column without one.
fn column_distances(set: &[bool], width: usize, height: usize) -> Vec<u32> {
    let far = far(width, height);
    let mut distances: Vec<u32> = set.iter().map(|set| if *set { 0 } else { far }).collect();
    let carry = |from: &[u32], to: &mut [u32]| {
        to.iter_mut().zip(from).for_each(|(to, from)| *to = (*to).min(*from + 1));
    };
    for v in 1..height {
        let (above, below) = distances.split_at_mut(v * width);
        carry(&above[(v - 1) * width..], &mut below[..width]);
    }
    for v in (1..height).rev() {
        let (above, below) = distances.split_at_mut(v * width);
        carry(&below[..width], &mut above[(v - 1) * width..]);
    }
    distances
}
