//! Mutual nearest descriptors against a table of all distances.

use sim3align::register::at_once::nearest;
use sim3align::register::fpfh::{DIMENSION, Descriptor};
use sim3align::register::matching::Match;

use crate::prelude::*;

/// Index of the nearest that is not empty, from all distances, in f32 (as the descriptors are), so that ties are
/// the same.
fn best(of: &Descriptor, among: &[Descriptor]) -> Option<usize> {
    let distance = |a: &Descriptor, b: &Descriptor| -> f32 {
        let third = |k: usize| (11 * k..11 * k + 11).map(|i| (a[i] - b[i]) * (a[i] - b[i])).sum::<f32>();
        third(0) + third(1) + third(2)
    };
    let something = |d: &Descriptor| d.iter().any(|&x| x != 0.0);
    let candidates = (0..among.len()).filter(|&i| something(&among[i]) && something(of));
    candidates.min_by(|&i, &j| distance(of, &among[i]).total_cmp(&distance(of, &among[j])).then(i.cmp(&j)))
}

fn brute_force(source: &[Descriptor], target: &[Descriptor]) -> Vec<Match> {
    let mut matches = Vec::new();
    for (s, descriptor) in source.iter().enumerate() {
        if let Some(t) = best(descriptor, target)
            && best(&target[t], source) == Some(s)
        {
            matches.push(Match { source: s as u32, target: t as u32 });
        }
    }
    matches
}

fn random(draw: &mut Draw, n: usize) -> Vec<Descriptor> {
    (0..n).map(|_| [0.0; DIMENSION].map(|_: f32| draw.between(0.0, 1.0) as f32)).collect()
}

#[wasm_bindgen_test(unsupported = test)]
fn matches_are_those_of_the_table() {
    for seed in 0..20 {
        let mut draw = Draw::new(seed);
        let (n, m) = (5 + draw.below(80), 5 + draw.below(80));
        let (source, mut target) = (random(&mut draw, n), random(&mut draw, m));
        // Some true counterparts, some copies that tie, some without neighbours.
        for descriptor in &mut target {
            match draw.below(4) {
                0 => *descriptor = source[draw.below(n)],
                1 => *descriptor = source[draw.below(n)].map(|x| x + draw.between(-0.01, 0.01) as f32),
                2 if draw.below(3) == 0 => *descriptor = [0.0; DIMENSION],
                _ => {}
            }
        }
        let found = nearest(&source, &target).mutual();
        assert_eq!(found, brute_force(&source, &target), "seed {seed}");
        let one_way: Vec<Match> = (target.iter().zip(0..))
            .filter_map(|(d, t)| Some(Match { source: best(d, &source)? as u32, target: t }))
            .collect();
        assert_eq!(nearest(&source, &target).one_way(), one_way, "seed {seed}");
        assert!(found.iter().all(|m| one_way.contains(m)) && found.len() < one_way.len(), "seed {seed}");
        // The other way round, the same pairs.
        let mut back: Vec<Match> = nearest(&target, &source)
            .mutual()
            .into_iter()
            .map(|m| Match { source: m.target, target: m.source })
            .collect();
        back.sort_by_key(|m| m.source);
        assert_eq!(found, back, "seed {seed}");
    }
}

#[wasm_bindgen_test(unsupported = test)]
fn nothing_matches_nothing() {
    let some = random(&mut Draw::new(1), 5);
    assert_eq!(nearest(&[], &some).one_way(), []);
    assert_eq!(nearest(&some, &[]).one_way(), []);
    let empty = [[0.0; DIMENSION]; 4];
    for source in [&[][..], &some, &empty] {
        for target in [&[][..], &empty] {
            assert_eq!(nearest(source, target).mutual(), []);
            assert_eq!(nearest(target, source).mutual(), []);
        }
    }
    // Even where the empty one is the nearest.
    let small = [0.01; DIMENSION];
    let large = [1.0; DIMENSION];
    assert_eq!(nearest(&[small], &[empty[0], large]).mutual(), [Match { source: 0, target: 1 }]);
}
