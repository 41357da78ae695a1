//! The parts of the baselines against slow oracles: cliques, votes, graduated non-convexity, and the solvers on matches.

use sim3align::register::matching::Match;
use sim3align::register::umeyama::ScaleMode;
use sim3align_lab::baselines::clique::{Clique, Graph};
use sim3align_lab::baselines::fgr::{self, FgrSettings};
use sim3align_lab::baselines::gnc::{Turns, gnc_tls};
use sim3align_lab::baselines::measurements::links;
use sim3align_lab::baselines::teaser::{self, InlierSelection, TeaserSettings};
use sim3align_lab::baselines::voting::vote;

use crate::support::{Draw, rotation_defect};
use sim3align_lab::prelude::*;

fn random_graph(draw: &mut Draw, count: usize, density: f64) -> Graph {
    let mut graph = Graph::new(count);
    for i in 0..count {
        for j in 0..i {
            if draw.between(0.0, 1.0) < density {
                graph.connect(i, j);
            }
        }
    }
    graph
}

fn is_clique(graph: &Graph, vertices: &[usize]) -> bool {
    vertices.iter().all(|&a| vertices.iter().all(|&b| a == b || graph.is_connected(a, b)))
}

#[test]
fn cliques_are_as_large_as_any() {
    for seed in 0..60 {
        let draw = &mut Draw::new(seed);
        let count = draw.below(13);
        let density = draw.between(0.1, 1.0);
        let graph = random_graph(draw, count, density);
        let members = |set: usize| (0..count).filter(|i| set >> i & 1 == 1).collect::<Vec<_>>();
        let largest = (0..1 << count).map(members).filter(|set| is_clique(&graph, set)).map(|set| set.len()).max();
        let found = graph.largest_clique(u64::MAX);
        assert!(found.is_largest && is_clique(&graph, &found.vertices), "seed {seed}: {found:?}");
        assert_eq!(Some(found.vertices.len()), largest, "seed {seed}: {found:?}");
        assert!(found.vertices.is_sorted(), "seed {seed}: {found:?}");
    }
}

#[test]
fn cores_are_what_is_left_when_poor_vertices_are_taken_away() {
    for seed in 0..40 {
        let draw = &mut Draw::new(seed);
        let count = 1 + draw.below(90);
        let density = draw.between(0.02, 0.5);
        let graph = random_graph(draw, count, density);
        let (cores, mut order) = graph.cores();
        let mut expected = vec![0; count];
        for core in 1..count {
            let mut left: Vec<usize> = (0..count).collect();
            loop {
                let degree = |&v: &usize| left.iter().filter(|&&w| w != v && graph.is_connected(v, w)).count();
                let kept: Vec<usize> = left.iter().copied().filter(|v| degree(v) >= core).collect();
                if kept.len() == left.len() {
                    break;
                }
                left = kept;
            }
            left.into_iter().for_each(|v| expected[v] = core);
        }
        assert_eq!(cores, expected, "seed {seed}");
        let most = expected.iter().copied().max().unwrap();
        let innermost: Vec<usize> = (0..count).filter(|&v| expected[v] == most).collect();
        assert_eq!(graph.innermost_core(), innermost, "seed {seed}");
        order.sort_unstable();
        assert!(order.into_iter().eq(0..count), "seed {seed}");
    }
}

#[test]
fn cliques_that_were_planted_are_found() {
    let draw = &mut Draw::new(7);
    let mut graph = random_graph(draw, 700, 0.2);
    let mut planted = draw.permutation(700);
    planted.truncate(25);
    for &a in &planted {
        planted.iter().for_each(|&b| graph.connect(a, b));
    }
    planted.sort_unstable();
    assert_eq!(graph.largest_clique(300_000_000), Clique { vertices: planted, is_largest: true });
}

#[test]
fn the_search_for_a_clique_ends_with_its_budget() {
    let draw = &mut Draw::new(8);
    // Dense and without structure: beyond any exact search.
    let graph = random_graph(draw, 2000, 0.8);
    let found = graph.largest_clique(20_000_000);
    assert!(!found.is_largest && found.vertices.len() > 20 && is_clique(&graph, &found.vertices), "{found:?}");
    let at_once = graph.largest_clique(0);
    assert!(!at_once.is_largest && is_clique(&graph, &at_once.vertices), "{at_once:?}");
    assert!(at_once.vertices.len() <= found.vertices.len());
    // All connected: the first guess is the answer, and the core proves it.
    let full = random_graph(draw, 1500, 2.0);
    assert_eq!(full.largest_clique(1), Clique { vertices: (0..1500).collect(), is_largest: true });
    assert_eq!(Graph::new(0).largest_clique(1), Clique { vertices: Vec::new(), is_largest: true });
    assert_eq!(Graph::new(3).largest_clique(1).vertices.len(), 1);
}

#[test]
fn votes_cost_as_little_as_any_number() {
    for seed in 0..200 {
        let draw = &mut Draw::new(seed);
        let count = 1 + draw.below(20);
        let far = if seed % 2 == 0 { 0.0 } else { 1e4 };
        let values: Vec<f64> = (0..count).map(|_| far + draw.between(-1.0, 1.0)).collect();
        let ranges: Vec<f64> = (0..count).map(|_| draw.between(0.02, 0.6)).collect();
        let cost = |x: f64| -> f64 { values.iter().zip(&ranges).map(|(v, r)| ((v - x) / r).powi(2).min(1.0)).sum() };
        // The best x is the weighted mean of those that some point stabs; every pair of ends has such a point between.
        let mut ends: Vec<f64> = values.iter().zip(&ranges).flat_map(|(v, r)| [v - r, v + r]).collect();
        ends.sort_by(f64::total_cmp);
        let stabbed = ends.windows(2).filter_map(|pair| {
            let at = 0.5 * (pair[0] + pair[1]);
            let (mut sum, mut weight) = (0.0, 0.0);
            for (v, r) in values.iter().zip(&ranges).filter(|(v, r)| (*v - at).abs() <= **r) {
                sum += v / (r * r);
                weight += 1.0 / (r * r);
            }
            (weight > 0.0).then(|| cost(sum / weight))
        });
        let least = stabbed.fold(f64::INFINITY, f64::min);
        let found = vote(&values, &ranges).unwrap();
        // The ends are compared as f32.
        assert!((found.cost - least).abs() < 1e-3, "seed {seed}: {found:?}, {least}");
        assert!((found.cost - cost(found.value)).abs() < 1e-6, "seed {seed}: {found:?}");
        for ((v, r), agrees) in values.iter().zip(&ranges).zip(&found.agreeing) {
            assert_eq!((v - found.value).abs() <= *r, *agrees, "seed {seed}");
        }
    }
    assert_eq!(vote(&[], &[]), None);
    assert_eq!(vote(&[1.0, f64::NAN], &[1.0, 1.0]), None);
    assert_eq!(vote(&[1.0], &[0.0]), None);
}

#[test]
fn links_reach_across_the_whole_set() {
    // One is a chain.
    assert_eq!(links(5, 1, 3), [[0, 1], [1, 2], [2, 3], [3, 4], [4, 0]]);
    for n in 0..24_usize {
        for count in 1..14 {
            let mut pairs: Vec<[usize; 2]> =
                links(n, count, 3).into_iter().map(|[i, j]| [i.min(j), i.max(j)]).collect();
            let all = pairs.len();
            assert!(pairs.iter().all(|[i, j]| i < j && *j < n), "{n} {count}");
            pairs.sort_unstable();
            pairs.dedup();
            assert_eq!(pairs.len(), all, "{n} {count}: a pair twice");
            if count >= n / 2 {
                assert_eq!(all, n * n.saturating_sub(1) / 2, "{n} {count}: not all pairs");
            } else {
                // Of an even round, the step over half of it gives half as many.
                let fewer = if n % 2 == 0 { n / 2 } else { 0 };
                assert!(all == n * count || all == n * count - fewer, "{n} {count}: {all}");
            }
        }
    }
}

#[test]
fn rotations_are_found_among_wrong_vectors() {
    for seed in 0..10 {
        let draw = &mut Draw::new(seed);
        let up = draw.direction();
        for turns in [Turns::All, Turns::About(up)] {
            let truth = match turns {
                Turns::All => draw.rotation(),
                Turns::About(up) => Rotation3::new(up * draw.between(-3.0, 3.0)),
            };
            let pairs: Vec<_> = (0..300)
                .map(|i| {
                    let a = draw.cube(1.0);
                    let b = if i % 10 < 7 { draw.cube(1.0) } else { truth * a + draw.cube(0.01) };
                    [a, b]
                })
                .collect();
            let found = gnc_tls(&pairs, 0.02, turns).unwrap();
            let off = (found.rotation.inverse() * truth).angle().to_degrees();
            assert!(off < 0.3 && rotation_defect(found.rotation.matrix()) < 1e-9, "seed {seed}, {turns:?}: {off}°");
            let (right, wrong): (Vec<_>, Vec<_>) = found.weights.iter().enumerate().partition(|(i, _)| i % 10 >= 7);
            assert!(right.iter().all(|(_, w)| **w > 0.5), "seed {seed}, {turns:?}");
            assert!(wrong.iter().filter(|(_, w)| **w > 0.5).count() < 10, "seed {seed}, {turns:?}");
        }
    }
    let line: Vec<_> = (1..9).map(|i| [Vector3::x() * f64::from(i), Vector3::y() * f64::from(i)]).collect();
    assert_eq!(gnc_tls(&line, 0.1, Turns::All), None);
    assert_eq!(gnc_tls(&line, 0.1, Turns::About(Vector3::x())), None);
    assert_eq!(gnc_tls(&[], 0.1, Turns::All), None);
}

/// Points with counterparts of which `wrong` of ten are anywhere.
fn matched(draw: &mut Draw, truth: &Similarity, count: usize, wrong: usize) -> [Vec<Vector3<f64>>; 2] {
    let source: Vec<_> = (0..count).map(|_| draw.cube(1.0)).collect();
    let target = source.iter().enumerate().map(|(i, p)| {
        let stray = truth.translation + draw.cube(truth.scale);
        let noise = draw.cube(0.005 * truth.scale);
        if i % 10 < wrong { stray } else { truth.apply(*p) + noise }
    });
    let target = target.collect();
    [source, target]
}

#[test]
fn teaser_finds_poses_among_nine_wrong_matches_in_ten() {
    for seed in 0..6 {
        let draw = &mut Draw::new(seed);
        let truth = draw.similarity([0.3, 3.0], 5.0);
        // Every tenth is right; in the larger set only a share of the ratios votes.
        let count = if seed == 0 { 2000 } else { 400 };
        let [source, target] = matched(draw, &truth, count, 9);
        for scale in [ScaleMode::Free, ScaleMode::Fixed(truth.scale)] {
            for selection in [InlierSelection::LargestClique, InlierSelection::InnermostCore] {
                let settings = TeaserSettings { selection, ..TeaserSettings::new(0.01 * truth.scale, scale) };
                let found = teaser::solve(&source, &target, &settings, Turns::All).unwrap();
                let pose = found.target_from_source;
                let what = format!("seed {seed}, {scale:?}, {selection:?}: {pose:?} for {truth:?}");
                assert!((pose.scale / truth.scale - 1.0).abs() < 0.01, "{what}");
                assert!(pose.rotation_angle_to(&truth) < 0.02, "{what}");
                assert!((pose.translation - truth.translation).norm() < 0.02 * truth.scale, "{what}");
                let right = found.inliers.iter().filter(|i| *i % 10 == 9).count();
                assert!(
                    10 * right >= count * 3 / 4 && found.inliers.len() - right <= count / 80,
                    "{right} right, {what}"
                );
                assert_eq!(found.is_largest_clique, selection == InlierSelection::LargestClique, "{what}");
            }
        }
    }
}

#[test]
fn quatro_keeps_up_up() {
    for seed in 0..6 {
        let draw = &mut Draw::new(seed);
        let (up, angle) = (draw.direction(), draw.between(-3.0, 3.0));
        let truth = Similarity { scale: 1.0, rotation: Rotation3::new(up * angle), translation: draw.cube(4.0) };
        let [source, target] = matched(draw, &truth, 300, 8);
        let settings = TeaserSettings::new(0.01, ScaleMode::Fixed(1.0));
        let pose = teaser::solve(&source, &target, &settings, Turns::About(up)).unwrap().target_from_source;
        assert!(pose.rotation_angle_to(&truth) < 0.02, "seed {seed}: {pose:?} for {truth:?}");
        assert!((pose.translation - truth.translation).norm() < 0.02, "seed {seed}: {pose:?} for {truth:?}");
        assert!((pose.rotation * up - up).norm() < 1e-9, "seed {seed}");
    }
}

fn one_to_one(count: usize) -> Vec<Match> {
    (0..count as u32).map(|i| Match { source: i, target: i }).collect()
}

#[test]
fn matches_without_an_answer_are_errors() {
    let draw = &mut Draw::new(3);
    let settings = TeaserSettings::new(0.01, ScaleMode::Fixed(1.0));
    let points: Vec<_> = (0..40).map(|_| draw.cube(1.0)).collect();
    let line: Vec<_> = (0..40).map(|i| Vector3::x() * f64::from(i)).collect();
    let solve = |source: &[Vector3<f64>], target: &[Vector3<f64>], settings: &TeaserSettings| {
        teaser::solve(source, target, settings, Turns::All).unwrap_err().code
    };
    assert_eq!(solve(&[], &[], &settings), ErrorCode::NoConsensus);
    assert_eq!(solve(&points, &points[1..], &settings), ErrorCode::WrongLength);
    assert_eq!(solve(&line, &line, &settings), ErrorCode::NoConsensus);
    assert_eq!(
        solve(&[points[0]; 40], &points, &TeaserSettings { scale: ScaleMode::Free, ..settings }),
        ErrorCode::NoConsensus
    );
    for noise_bound in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        assert_eq!(solve(&points, &points, &TeaserSettings { noise_bound, ..settings }), ErrorCode::InvalidOption);
    }
    let scale = ScaleMode::Fixed(0.0);
    assert_eq!(solve(&points, &points, &TeaserSettings { scale, ..settings }), ErrorCode::InvalidOption);
    let mut broken = points.clone();
    broken[3].y = f64::NAN;
    assert_eq!(solve(&points, &broken, &settings), ErrorCode::NonFinite);

    let fgr = |source: &[Vec3], target: &[Vec3], count: usize| {
        fgr::solve(source, target, &one_to_one(count), &FgrSettings::default()).unwrap_err().code
    };
    let (source, target) = (draw.points(60, 1.0), draw.points(60, 1.0));
    assert_eq!(fgr(&[], &[], 0), ErrorCode::NoConsensus);
    assert_eq!(fgr(&source, &source, 0), ErrorCode::NoConsensus);
    // Numbers beyond the points are passed over; two points are no triangle.
    assert_eq!(fgr(&source[..2], &source[..2], 60), ErrorCode::NoConsensus);
    assert_eq!(fgr(&[source[0]; 60], &[target[0]; 60], 60), ErrorCode::NoConsensus);
    let broken = vec![Vec3::NAN; 60];
    assert_eq!(fgr(&source, &broken, 60), ErrorCode::NonFinite);
}

#[test]
fn many_matches_are_bounded() {
    let draw = &mut Draw::new(5);
    let truth = draw.similarity([1.0, 1.0], 1.0);
    // Of 12 000, at most 1500 take part here; a bound as wide as the cloud connects nearly all.
    let [source, target] = matched(draw, &truth, 12_000, 5);
    for noise_bound in [0.01, 0.3] {
        let settings = TeaserSettings { max_matches: 1500, ..TeaserSettings::new(noise_bound, ScaleMode::Fixed(1.0)) };
        let found = teaser::solve(&source, &target, &settings, Turns::All).unwrap();
        assert!(found.selected.len() <= 1500 && found.selected.iter().all(|i| *i < 12_000), "{noise_bound}");
        assert!(found.target_from_source.rotation_angle_to(&truth) < 0.1, "{noise_bound}");
    }
}
