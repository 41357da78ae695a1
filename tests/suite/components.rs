//! Connected components against a search from every pixel.

use sim3align::geometry::components::components;

use crate::prelude::*;

/// The components by flooding, as sorted indices, in the order of their first pixels, and whether they touch the border.
fn by_flooding(set: &[bool], width: usize, height: usize) -> Vec<(Vec<usize>, bool)> {
    let mut seen = vec![false; set.len()];
    let mut list = Vec::new();
    for start in 0..set.len() {
        let mut open = vec![start];
        let mut pixels = Vec::new();
        while let Some(i) = open.pop().filter(|_| set[start]) {
            if !set[i] || core::mem::replace(&mut seen[i], true) {
                continue;
            }
            pixels.push(i);
            let (u, v) = (i % width, i / width);
            open.extend((u > 0).then(|| i - 1));
            open.extend((u + 1 < width).then(|| i + 1));
            open.extend((v > 0).then(|| i - width));
            open.extend((v + 1 < height).then(|| i + width));
        }
        if !pixels.is_empty() {
            let at_border = |i: &usize| [0, width - 1].contains(&(i % width)) || [0, height - 1].contains(&(i / width));
            let touches = pixels.iter().any(at_border);
            pixels.sort_unstable();
            list.push((pixels, touches));
        }
    }
    list
}

#[wasm_bindgen_test(unsupported = test)]
fn components_are_those_of_flooding() {
    let mut most = 0;
    for seed in 0..400 {
        let mut random = Random::new(seed, 917);
        let (width, height) = (1 + random.below(24), 1 + random.below(24));
        let density = [0.1, 0.5, 0.6, 0.9][seed as usize % 4];
        let set: Vec<bool> = (0..width * height).map(|_| random.uniform() < density).collect();
        let found: Vec<_> = components(&set, width, height)
            .iter()
            .map(|component| {
                let pixels: Vec<usize> = component.pixels().collect();
                assert_eq!(component.count(), pixels.len(), "seed {seed}");
                let mut image = vec![false; set.len()];
                component.set(&mut image);
                assert!(image.iter().enumerate().all(|(i, set)| *set == pixels.contains(&i)), "seed {seed}");
                (pixels, component.touches_border)
            })
            .collect();
        assert_eq!(found, by_flooding(&set, width, height), "seed {seed}, {width} × {height}");
        most = most.max(found.iter().map(|(pixels, _)| pixels.len()).max().unwrap_or(0));
    }
    assert!(most > 300);
    assert!(components(&[], 0, 0).is_empty());
}
