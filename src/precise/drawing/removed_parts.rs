//! Surplus: parts that generators add to the mesh of an object, although no image of it shows them.
//!
//! Floaters hang in the air beside it, inner shells lie within it. Both move its box and its centre, and take triangles from
//! its decimations. A part is left out only if it is far from all others and small, or if it is seen from nowhere.

use crate::geometry::cloud::Bounds;
use crate::geometry::disjoint_sets::DisjointSets;
use crate::geometry::mesh::Mesh;
use crate::geometry::mesh_parts::{MeshPart, MeshParts};
use crate::geometry::pinhole::Pinhole;
use crate::geometry::rasteriser::{NO_TRIANGLE, Rasteriser};
use crate::geometry::rotations::{matrix_of, super_fibonacci};
use crate::geometry::similarity::Similarity;
use crate::geometry::surface::{check_shape, each_surface_sample};

/// Edge of the cells in which parts are neighbours, relative to the diagonal: parts in the same or in adjacent cells hang
/// together. Legs, lids and handles that are modelled apart touch, or nearly.
const REACH: f32 = 0.03;
/// Largest share of the surface of a floater, and of all of them, and their largest diagonal relative to that of the rest.
const FLOATER_AREA: f64 = 0.05;
const FLOATERS_AREA: f64 = 0.1;
const FLOATER_SIZE: f32 = 0.3;
/// Growth of the box by floaters, relative to the diagonal, and share of the surface below which they do no harm.
const HARMLESS_GROWTH: f32 = 0.02;
const HARMLESS_FLOATERS: f64 = 0.01;
/// Share of the surface below which inner shells do no harm.
const HARMLESS_SHELLS: f64 = 0.03;
/// Passes in which floaters are found: those far out make the cells of the first one large.
const PASSES: usize = 3;
/// Points spread over triangles larger than a cell, by which parts are neighbours beside the vertices.
const POINTS: usize = 16_384;
/// Images in which a part that is not hidden is seen, their width, and the distance of their camera in diagonals.
const VIEWS: usize = 48;
const WIDTH: usize = 160;
const DISTANCE: f64 = 8.0;
/// Number of triangles above which no inner shells are looked for, which would take seconds.
const MAX_TRIANGLES: usize = 500_000;

/// The parts left out of a mesh: their number, and their share of its surface.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct RemovedParts {
    /// Parts far from all others.
    pub floating: (usize, f64),
    /// Parts inside, which are seen from nowhere.
    pub inside: (usize, f64),
    /// The share of a plate below, as if the object stood on it.
    pub ground: f64,
}

/// A mesh without its surplus.
#[derive(Debug, Clone)]
pub struct Trimmed {
    /// The rest.
    pub mesh: Mesh,
    /// The triangles that were left out.
    pub surplus: Mesh,
    /// The parts left out.
    pub removed_parts: RemovedParts,
}

impl Trimmed {
    /// A mesh, whose vertices are all used, without floaters and inner shells; `None` if it has neither.
    pub fn of(mesh: &Mesh) -> Option<Self> {
        let parts = MeshParts::of(mesh)?;
        let mut is_removed = floaters(mesh, &parts)?;
        let mut removed_parts = RemovedParts::default();
        let all = sum(&parts, &|_| true).area;
        let shells = shells(mesh, &parts, &is_removed).unwrap_or_default();
        for (k, part) in parts.parts.iter().enumerate() {
            let is_shell = shells.get(k).is_some_and(|shell| *shell);
            let (count, share) = if is_shell { &mut removed_parts.inside } else { &mut removed_parts.floating };
            if is_shell || is_removed[k] {
                is_removed[k] = true;
                *count += 1;
                *share += part.area / all;
            }
        }
        if !is_removed.contains(&true) {
            return None;
        }
        Self::split(mesh, removed_parts, &|triangle| is_removed[parts.of_triangle(mesh.triangles()[triangle])])
    }

    /// A mesh without these of its triangles; `None` if they are none, or the rest is no shape.
    pub fn split(mesh: &Mesh, removed_parts: RemovedParts, is_surplus: &dyn Fn(usize) -> bool) -> Option<Self> {
        let [mut kept, mut surplus] = [Vec::new(), Vec::new()];
        for (index, triangle) in mesh.triangles().iter().enumerate() {
            if is_surplus(index) { &mut surplus } else { &mut kept }.push(*triangle);
        }
        if surplus.is_empty() || kept.is_empty() {
            return None;
        }
        let rest = mesh.of_triangles(&kept);
        check_shape(&rest).ok()?;
        Some(Self { mesh: rest, surplus: mesh.of_triangles(&surplus), removed_parts })
    }
}

/// The area and the box of some parts together.
#[inline(never)]
fn sum(parts: &MeshParts, is_counted: &dyn Fn(usize) -> bool) -> MeshPart {
    let mut sum = MeshPart { area: 0.0, bounds: Bounds::NOTHING };
    for (_, part) in parts.parts.iter().enumerate().filter(|(k, _)| is_counted(*k)) {
        sum = MeshPart { area: sum.area + part.area, bounds: sum.bounds.union(part.bounds) };
    }
    sum
}

/// Finds the floaters among the parts; none, if they do no harm. `None` for a mesh without area.
fn floaters(mesh: &Mesh, parts: &MeshParts) -> Option<Vec<bool>> {
    let mut is_floater = vec![false; parts.parts.len()];
    let all = sum(parts, &|_| true);
    let is_small = |part: &MeshPart| part.area <= FLOATER_AREA * all.area;
    if !parts.parts.iter().any(is_small) {
        return Some(is_floater);
    }
    for _ in 0..PASSES {
        let cluster = clusters(mesh, parts, &is_floater)?;
        let count = cluster.iter().max().map_or(0, |most| *most + 1);
        let sums: Vec<MeshPart> = (0..count).map(|own| sum(parts, &|k| cluster[k] == own && !is_floater[k])).collect();
        let body = sums.iter().filter(|part| !is_small(part)).fold(Bounds::NOTHING, |all, p| all.union(p.bounds));
        let before = is_floater.clone();
        for (floater, own) in is_floater.iter_mut().zip(cluster) {
            let own = &sums[own as usize];
            *floater |= is_small(own) && own.bounds.diagonal() <= FLOATER_SIZE * body.diagonal();
        }
        if is_floater == before {
            break;
        }
    }
    let [floating, body] = [true, false].map(|side| sum(parts, &|k| is_floater[k] == side));
    let growth = (body.bounds.min - all.bounds.min).max(all.bounds.max - body.bounds.max).max_element();
    let is_harmless = growth < HARMLESS_GROWTH * body.bounds.diagonal() && floating.area < HARMLESS_FLOATERS * all.area;
    if is_harmless || floating.area > FLOATERS_AREA * all.area {
        is_floater.fill(false);
    }
    Some(is_floater)
}

/// The cluster of each part: parts that are neighbours, or neighbours of neighbours.
fn clusters(mesh: &Mesh, parts: &MeshParts, is_floater: &[bool]) -> Option<Vec<u32>> {
    let kept = || parts.parts.iter().zip(is_floater).filter(|(_, floater)| !**floater);
    let Bounds { min, max } = kept().fold(Bounds::NOTHING, |all, (part, _)| all.union(part.bounds));
    let cell = REACH * (max - min).length();
    if !(cell > 0.0 && cell.is_finite()) {
        return None;
    }
    let size = ((max - min) / cell).to_array().map(|x| x as usize + 1);
    let mut part_in = vec![u32::MAX; size.iter().product()];
    let mut sets = DisjointSets::new(parts.parts.len());
    let mut occupy = |point: glam::Vec3, part: u32| {
        if is_floater[part as usize] {
            return;
        }
        let at = ((point - min) / cell).to_array();
        let at = [0, 1, 2].map(|i| (at[i] as usize).min(size[i] - 1));
        let known = &mut part_in[(at[2] * size[1] + at[1]) * size[0] + at[0]];
        if *known == u32::MAX {
            *known = part;
        } else if *known != part {
            sets.join(*known, part);
        }
    };
    mesh.positions().iter().zip(&parts.of_vertex).for_each(|(position, part)| occupy(*position, *part));
    // Other triangles are in the cells around their first corner.
    let is_long = |triangle: &[u32; 3]| {
        let [a, b, c] = mesh.corners(*triangle);
        (b - a).length_squared().max((c - a).length_squared()) > cell * cell
    };
    let long: Vec<[u32; 3]> = mesh.triangles().iter().copied().filter(is_long).collect();
    if !long.is_empty() {
        let part_of = |triangle: usize| parts.of_triangle(long[triangle]) as u32;
        let surface = mesh.of_triangles(&long);
        // Those without area have no points.
        each_surface_sample(&surface, POINTS, 0, &mut |sample| occupy(sample.point, part_of(sample.triangle))).ok();
    }
    let at = |[x, y, z]: [usize; 3]| part_in[(z * size[1] + y) * size[0] + x];
    for z in 0..size[2] {
        for y in 0..size[1] {
            for x in 0..size[0] {
                let own = at([x, y, z]);
                // Each pair once: of the 26 cells around, those that follow.
                for step in (14..27).filter(|_| own != u32::MAX) {
                    let [i, j, k] = [x + step % 3, y + step / 3 % 3, z + step / 9];
                    let is_within = (1..=size[0]).contains(&i) && (1..=size[1]).contains(&j) && k <= size[2];
                    let other = if is_within { at([i - 1, j - 1, k - 1]) } else { u32::MAX };
                    if other != u32::MAX {
                        sets.join(own, other);
                    }
                }
            }
        }
    }
    Some(sets.numbered().0)
}

/// Finds the parts inside all others that no view shows; `None` if they do no harm.
fn shells(mesh: &Mesh, parts: &MeshParts, is_floater: &[bool]) -> Option<Vec<bool>> {
    let MeshPart { area, bounds: all } = sum(parts, &|k| !is_floater[k]);
    let is_inside = |part: &Bounds| part.min.cmpgt(all.min).all() && part.max.cmplt(all.max).all();
    let mut is_hidden: Vec<bool> =
        parts.parts.iter().zip(is_floater).map(|(part, floater)| !floater && is_inside(&part.bounds)).collect();
    let is_harmless = |hidden: &[bool]| sum(parts, &|k| hidden[k]).area < HARMLESS_SHELLS * area;
    if mesh.triangles().len() > MAX_TRIANGLES || is_harmless(&is_hidden) {
        return None;
    }
    let per_unit = 1.0 / f64::from(all.diagonal());
    let middle = 0.5 * (WIDTH as f64 - 1.0);
    let focal = 0.9 * WIDTH as f64 * DISTANCE;
    let camera = Pinhole::new(focal, focal, middle, middle).ok()?;
    let mut rasteriser = Rasteriser::new();
    for view in 0..VIEWS {
        let rotation = super_fibonacci(view, VIEWS);
        let center = glam::DVec3::Z * DISTANCE - rotation * all.center().as_dvec3() * per_unit;
        let camera_from_mesh = Similarity {
            scale: per_unit,
            rotation: matrix_of(rotation),
            translation: nalgebra::Vector3::from(center.to_array()),
        };
        rasteriser.render(mesh, &camera_from_mesh, &camera, WIDTH, WIDTH);
        for &triangle in rasteriser.triangles().iter().filter(|triangle| **triangle != NO_TRIANGLE) {
            is_hidden[parts.of_triangle(mesh.triangles()[triangle as usize])] = false;
        }
        if !rasteriser.is_complete() || is_harmless(&is_hidden) {
            return None;
        }
    }
    Some(is_hidden)
}
