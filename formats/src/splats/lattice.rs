//! A regular lattice of nodes, and the regions on it.

use glam::Vec3;

/// Empty layers of nodes around what a lattice holds.
const MARGIN: f32 = 3.0;

/// Nodes at integer coordinates, in multiples of a spacing from an origin.
#[derive(Debug, Clone)]
pub(super) struct Lattice {
    origin: Vec3,
    spacing: f32,
    /// Number of nodes along x, y and z; x is the fastest.
    pub size: [usize; 3],
}

impl Lattice {
    /// A lattice around a box, with a margin.
    pub fn new(min: Vec3, max: Vec3, spacing: f32) -> Self {
        let origin = min - Vec3::splat(MARGIN * spacing);
        let size = ((max - origin) / spacing + Vec3::splat(MARGIN + 1.0)).to_array().map(|x| x as usize + 1);
        Self { origin, spacing, size }
    }

    /// Number of nodes.
    pub fn len(&self) -> usize {
        self.size.iter().product()
    }

    /// The index of a node less that of its predecessor along each axis.
    pub fn steps(&self) -> [usize; 3] {
        [1, self.size[0], self.size[0] * self.size[1]]
    }

    /// A point in the coordinates of the lattice.
    pub fn coordinates(&self, point: Vec3) -> Vec3 {
        (point - self.origin) / self.spacing
    }

    /// The point at coordinates of the lattice.
    pub fn point(&self, coordinates: Vec3) -> Vec3 {
        self.origin + coordinates * self.spacing
    }

    /// The node nearest to coordinates.
    pub fn nearest(&self, coordinates: Vec3) -> usize {
        let at = coordinates.to_array().map(|x| (x + 0.5) as usize);
        let [x, y, z] = [0, 1, 2].map(|axis| at[axis].min(self.size[axis] - 1));
        (z * self.size[1] + y) * self.size[0] + x
    }

    /// The nodes that are set or next to a set one, in a cube of three nodes.
    pub fn dilated(&self, set: &[bool]) -> Vec<bool> {
        let mut dilated = set.to_vec();
        for step in self.steps() {
            let before = dilated.clone();
            for (node, _) in before.iter().enumerate().filter(|(_, set)| **set) {
                for near in [node.wrapping_sub(step), node + step] {
                    if let Some(near) = dilated.get_mut(near) {
                        *near = true;
                    }
                }
            }
        }
        dilated
    }

    /// The 6 neighbours of a node that share a face with it, as differences of indices.
    pub fn faces(&self) -> Vec<isize> {
        self.steps().iter().flat_map(|&step| [-(step as isize), step as isize]).collect()
    }

    /// The 26 neighbours of a node.
    pub fn corners(&self) -> Vec<isize> {
        let [x, y, z] = self.steps().map(|step| step as isize);
        let cube = (-1..=1).flat_map(|k| (-1..=1).flat_map(move |j| (-1..=1).map(move |i| i * x + j * y + k * z)));
        cube.filter(|&difference| difference != 0).collect()
    }
}

/// Moves the region of a node that is set from `set` to the result: the nodes connected with it over `neighbors`.
pub(super) fn take_region(set: &mut [bool], first: usize, neighbors: &[isize]) -> Vec<u32> {
    let mut region = Vec::new();
    let mut take = |node: usize, region: &mut Vec<u32>| {
        if let Some(is_set) = set.get_mut(node).filter(|is_set| **is_set) {
            *is_set = false;
            region.push(node as u32);
        }
    };
    take(first, &mut region);
    let mut next = 0;
    while let Some(&node) = region.get(next) {
        next += 1;
        neighbors.iter().for_each(|&difference| take((node as usize).wrapping_add_signed(difference), &mut region));
    }
    region
}

/// Clears the connected regions of `set` that have less than `least` of the total weight of all.
pub(super) fn clear_light_regions(set: &mut [bool], weights: &[f32], neighbors: &[isize], least: f64) {
    let mut left = set.to_vec();
    let mut regions: Vec<(f64, Vec<u32>)> = Vec::new();
    for first in 0..left.len() {
        if left[first] {
            let region = take_region(&mut left, first, neighbors);
            let weight = region.iter().filter_map(|&node| weights.get(node as usize)).map(|w| f64::from(*w)).sum();
            regions.push((weight, region));
        }
    }
    let total: f64 = regions.iter().map(|(weight, _)| weight).sum();
    for (_, region) in regions.iter().filter(|(weight, _)| *weight < least * total) {
        region.iter().for_each(|&node| set[node as usize] = false);
    }
}
