//! Cores and maximum cliques of graphs stored as bitsets. Matches that pairwise preserve distances form a clique.

/// An undirected graph without loops.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Graph {
    count: usize,
    words: usize,
    /// Adjacency matrix, one bit per pair of vertices.
    rows: Vec<u64>,
}

/// The largest clique found.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Clique {
    /// Vertices, in ascending order.
    pub vertices: Vec<usize>,
    /// Whether it is proven to be maximum: the search ended within its budget.
    pub is_largest: bool,
}

/// A node of the search: the candidates for extending the current clique, and their order.
struct Level {
    candidates: Vec<u64>,
    /// Vertices and colours, by ascending colour: with those before it, a vertex adds at most its colour to a clique
    /// at most. Without those that so can not make it large enough.
    order: Vec<[u32; 2]>,
}

impl Graph {
    /// A graph of `count` vertices without edges.
    pub fn new(count: usize) -> Self {
        let words = count.div_ceil(64);
        Self { count, words, rows: vec![0; count * words] }
    }

    /// Number of vertices.
    pub fn len(&self) -> usize {
        self.count
    }

    /// Whether the graph has no vertices.
    pub fn is_empty(&self) -> bool {
        self.count == 0
    }

    /// Adds an edge between two different vertices.
    pub fn connect(&mut self, a: usize, b: usize) {
        if a != b && a < self.count && b < self.count {
            self.rows[a * self.words + b / 64] |= 1 << (b % 64);
            self.rows[b * self.words + a / 64] |= 1 << (a % 64);
        }
    }

    /// Whether there is an edge.
    pub fn is_connected(&self, a: usize, b: usize) -> bool {
        self.row(a)[b / 64] >> (b % 64) & 1 == 1
    }

    fn row(&self, vertex: usize) -> &[u64] {
        &self.rows[vertex * self.words..(vertex + 1) * self.words]
    }

    fn degree(&self, vertex: usize) -> usize {
        self.row(vertex).iter().map(|word| word.count_ones() as usize).sum()
    }

    /// The subgraph induced by some vertices.
    fn induced(&self, vertices: &[usize]) -> Self {
        let mut graph = Self::new(vertices.len());
        for (i, &a) in vertices.iter().enumerate() {
            for (j, &b) in vertices.iter().enumerate().take(i) {
                if self.is_connected(a, b) {
                    graph.connect(i, j);
                }
            }
        }
        graph
    }

    /// The core number of each vertex (the largest k such that it belongs to a subgraph of minimum degree k), and the
    /// vertices in degeneracy order (repeatedly removing a vertex of minimum degree).
    pub fn cores(&self) -> (Vec<usize>, Vec<usize>) {
        // Batagelj & Zaveršnik 2003: the vertices stay sorted by remaining degree.
        let mut left: Vec<usize> = (0..self.count).map(|v| self.degree(v)).collect();
        let mut begins = vec![0; self.count + 1];
        left.iter().for_each(|&degree| begins[degree + 1] += 1);
        (0..self.count).for_each(|degree| begins[degree + 1] += begins[degree]);
        let (mut order, mut places) = (vec![0; self.count], vec![0; self.count]);
        let mut free = begins.clone();
        for vertex in 0..self.count {
            places[vertex] = free[left[vertex]];
            order[places[vertex]] = vertex;
            free[left[vertex]] += 1;
        }
        for i in 0..self.count {
            let vertex = order[i];
            for near in bits(self.row(vertex)) {
                if left[near] > left[vertex] {
                    // Moves to the front of the vertices of equal degree, which then begin behind it.
                    let (place, front) = (places[near], begins[left[near]]);
                    let other = order[front];
                    order.swap(place, front);
                    (places[near], places[other]) = (front, place);
                    begins[left[near]] += 1;
                    left[near] -= 1;
                }
            }
        }
        (left, order)
    }

    /// The vertices of the innermost core, in ascending order: it contains most large cliques, and is found in linear
    /// time.
    pub fn innermost_core(&self) -> Vec<usize> {
        let (cores, _) = self.cores();
        let innermost = cores.iter().copied().max().unwrap_or_default();
        (0..self.count).filter(|&v| cores[v] == innermost).collect()
    }

    /// The largest clique, by branch and bound: vertices in the order of their cores, bounds by colouring (San Segundo
    /// et al. 2011). `budget` limits the work, in words of bitsets visited.
    pub fn largest_clique(&self, budget: u64) -> Clique {
        let (cores, order) = self.cores();
        let mut best = self.greedy_clique(&cores, &order);
        let mut left = budget;
        let mut is_largest = true;
        let mut later = vec![0; self.words];
        // From the innermost core outwards; a clique is found at its first vertex in degeneracy order.
        for &vertex in order.iter().rev() {
            if cores[vertex] >= best.len() {
                let near = self.row(vertex).iter().zip(&later).map(|(a, b)| a & b).collect::<Vec<_>>();
                let near: Vec<usize> = bits(&near).filter(|&v| cores[v] >= best.len()).collect();
                let work = (near.len() * near.len()) as u64;
                if near.len() >= best.len() {
                    is_largest = work <= left;
                    left = left.saturating_sub(work);
                    if !is_largest {
                        break;
                    }
                    let within = self.induced(&near);
                    if let Some(found) = within.clique_above(best.len() - 1, &mut left) {
                        best = found.into_iter().map(|i| near[i]).chain([vertex]).collect();
                    }
                    if left == 0 {
                        is_largest = false;
                        break;
                    }
                }
            }
            later[vertex / 64] |= 1 << (vertex % 64);
        }
        let mut is_in = vec![false; self.count];
        best.into_iter().for_each(|v| is_in[v] = true);
        Clique { vertices: (0..self.count).filter(|&v| is_in[v]).collect(), is_largest }
    }

    /// From the innermost vertices on, always the candidate of the largest core.
    fn greedy_clique(&self, cores: &[usize], order: &[usize]) -> Vec<usize> {
        const STARTS: usize = 16;
        let mut best = Vec::new();
        for &start in order.iter().rev().take(STARTS) {
            let mut clique = vec![start];
            let mut candidates = self.row(start).to_vec();
            while let Some(next) = bits(&candidates).max_by_key(|&v| (cores[v], self.count - v)) {
                clique.push(next);
                candidates.iter_mut().zip(self.row(next)).for_each(|(word, near)| *word &= near);
            }
            if clique.len() > best.len() {
                best = clique;
            }
        }
        best
    }

    /// The largest clique of more than `size` vertices, or the largest found when the budget `left` is exhausted.
    fn clique_above(&self, size: usize, left: &mut u64) -> Option<Vec<usize>> {
        let (mut best, mut best_size) = (None, size);
        let mut everything = vec![0; self.words];
        (0..self.count).for_each(|v| everything[v / 64] |= 1 << (v % 64));
        let mut clique = Vec::new();
        let mut levels = vec![self.level(everything, best_size, left)];
        while let Some(level) = levels.last_mut() {
            let next = level.order.pop().filter(|[_, colour]| clique.len() + *colour as usize > best_size);
            let Some(vertex) = next.filter(|_| *left > 0).map(|[vertex, _]| vertex as usize) else {
                levels.pop();
                clique.pop();
                continue;
            };
            level.candidates[vertex / 64] &= !(1 << (vertex % 64));
            let candidates: Vec<u64> = level.candidates.iter().zip(self.row(vertex)).map(|(a, b)| a & b).collect();
            clique.push(vertex);
            if clique.len() > best_size {
                (best, best_size) = (Some(clique.clone()), clique.len());
            }
            levels.push(self.level(candidates, best_size - clique.len(), left));
        }
        best
    }

    /// Colours the candidates: vertices of one colour are not connected, so that a clique has one of each at most.
    /// More than `size` are wanted.
    fn level(&self, candidates: Vec<u64>, size: usize, left: &mut u64) -> Level {
        let mut order = Vec::new();
        let mut uncoloured = candidates.clone();
        let (mut colour, mut work) = (0_u32, 0);
        let mut class = vec![0; self.words];
        while uncoloured.iter().any(|word| *word != 0) {
            colour += 1;
            class.copy_from_slice(&uncoloured);
            for word in 0..self.words {
                while class[word] != 0 {
                    let bit = class[word].trailing_zeros() as usize;
                    let vertex = 64 * word + bit;
                    class[word] &= !(1 << bit);
                    uncoloured[word] &= !(1 << bit);
                    class[word..].iter_mut().zip(&self.row(vertex)[word..]).for_each(|(word, near)| *word &= !near);
                    work += self.words;
                    if colour as usize > size {
                        order.push([vertex as u32, colour]);
                    }
                }
            }
            work += self.words;
        }
        *left = left.saturating_sub(work as u64 + 1);
        Level { candidates, order }
    }
}

/// Indices of the set bits, in ascending order.
fn bits(words: &[u64]) -> impl Iterator<Item = usize> + '_ {
    words.iter().enumerate().flat_map(|(i, &word)| {
        let mut rest = word;
        core::iter::from_fn(move || {
            let bit = (rest != 0).then(|| 64 * i + rest.trailing_zeros() as usize);
            rest &= rest.wrapping_sub(1);
            bit
        })
    })
}
