//! Connected components of binary images.

use core::ops::Range;

use super::disjoint_sets::DisjointSets;

/// A connected component (four neighbours).
pub struct Component {
    /// The pixels as runs of indices within rows, row-major.
    runs: Vec<Range<u32>>,
    /// Whether a pixel is on the border of the image.
    pub touches_border: bool,
}

impl Component {
    /// Number of pixels.
    pub fn count(&self) -> usize {
        self.runs.iter().map(Range::len).sum()
    }

    /// Indices of the pixels, row-major.
    pub fn pixels(&self) -> impl Iterator<Item = usize> {
        self.runs.iter().flat_map(|run| run.start as usize..run.end as usize)
    }

    /// Sets the pixels of an image of the same size.
    pub fn set(&self, image: &mut [bool]) {
        self.runs.iter().for_each(|run| image[run.start as usize..run.end as usize].fill(true));
    }
}

/// The connected components of the set pixels of an image, in the order of their first pixels.
///
/// Runs of pixels are joined with those that they touch in the row above (union-find), so that the time is one pass over
/// the image.
pub fn components(set: &[bool], width: usize, height: usize) -> Vec<Component> {
    let mut runs: Vec<Range<u32>> = Vec::new();
    let mut sets = DisjointSets::default();
    let mut above = 0..0;
    for (v, row) in set.chunks_exact(width.max(1)).enumerate() {
        let first = runs.len();
        let mut from = 0;
        while let Some(start) = row[from..].iter().position(|set| *set).map(|skipped| from + skipped) {
            let end = row[start..].iter().position(|set| !*set).map_or(width, |length| start + length);
            let id = sets.push();
            runs.push((v * width + start) as u32..(v * width + end) as u32);
            // The runs above are disjoint and in order: those that end before this one touch no later one.
            let column = |index: u32| index as usize - (v - 1) * width;
            while above.start < above.end && column(runs[above.start].end) <= start {
                above.start += 1;
            }
            let touching = above.clone().take_while(|&other| column(runs[other].start) < end);
            touching.for_each(|other| sets.join(other as u32, id));
            from = end;
        }
        above = first..runs.len();
    }
    let (numbers, count) = sets.numbered();
    let mut list: Vec<Component> = Vec::new();
    list.resize_with(count, || Component { runs: Vec::new(), touches_border: false });
    for (run, number) in runs.into_iter().zip(numbers) {
        let component = &mut list[number as usize];
        let [first, end] = [run.start, run.end].map(|i| i as usize);
        component.touches_border |=
            first < width || first + width >= width * height || first % width == 0 || end % width == 0;
        component.runs.push(run);
    }
    list
}
