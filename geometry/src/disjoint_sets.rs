//! Disjoint sets (union-find). The smallest element of a set stands for it.

/// Sets of the elements 0 to n − 1.
#[derive(Debug, Clone, Default)]
pub struct DisjointSets {
    /// A smaller element of the same set; itself in the smallest one.
    parents: Vec<u32>,
}

impl DisjointSets {
    /// `count` sets of one element each.
    pub fn new(count: usize) -> Self {
        Self { parents: (0..count as u32).collect() }
    }

    /// Adds an element in a set of its own, and returns it.
    pub fn push(&mut self) -> u32 {
        let element = self.parents.len() as u32;
        self.parents.push(element);
        element
    }

    /// The smallest element of the set of an element.
    pub fn find(&mut self, mut element: u32) -> u32 {
        let parents = &mut self.parents;
        while parents[element as usize] != element {
            let above = parents[parents[element as usize] as usize];
            parents[element as usize] = above;
            element = above;
        }
        element
    }

    /// Joins the sets of two elements.
    pub fn join(&mut self, a: u32, b: u32) {
        let [a, b] = [self.find(a), self.find(b)];
        self.parents[a.max(b) as usize] = a.min(b);
    }

    /// The number of the set of each element, in the order of the smallest elements, and the number of sets.
    pub fn numbered(mut self) -> (Vec<u32>, usize) {
        let mut count = 0;
        let mut numbers = vec![u32::MAX; self.parents.len()];
        for element in 0..self.parents.len() {
            let root = self.find(element as u32) as usize;
            if numbers[root] == u32::MAX {
                numbers[root] = count;
                count += 1;
            }
            numbers[element] = numbers[root];
        }
        (numbers, count as usize)
    }
}
