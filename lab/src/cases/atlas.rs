//! Texture atlases in which each triangle has a square cell of its own.

use sim3align_geometry::surface_colors::Rgb;

/// Widths of textures, in texels, and the number of triangles up to which the smaller one is used.
const SIZES: [usize; 2] = [1024, 2048];
const FEW: usize = 2048;
/// Multiple of the width of a cell: when the texture is halved twice, no texel lies in two cells.
const STEP: usize = 4;
/// Maximum number of texels around a triangle that have its colours, so that averages near its edges do.
const MARGIN: usize = 4;

/// The layout of an atlas.
#[derive(Debug, Clone, Copy)]
pub struct Atlas {
    /// Width and height of the texture.
    pub size: usize,
    triangles: usize,
    columns: usize,
    /// Width of a cell.
    cell: usize,
    margin: usize,
}

impl Atlas {
    /// For so many triangles, at most 2^18.
    pub fn new(triangles: usize) -> Self {
        let size = SIZES[usize::from(triangles > FEW)];
        let columns = triangles.isqrt() + usize::from(triangles.isqrt().pow(2) < triangles);
        let cell = (size / columns.max(1) / STEP * STEP).max(STEP);
        Self { size, triangles, columns, cell, margin: (cell / 8).clamp(1, MARGIN) }
    }

    /// Length of the two shorter sides of a triangle, texels.
    fn side(&self) -> usize {
        self.cell - 2 * self.margin
    }

    /// Texture coordinates of the corners of each triangle, 0 to 1 from the upper left corner.
    pub fn coordinates(&self) -> Vec<[[f64; 2]; 3]> {
        let side = self.side();
        let of_triangle = |triangle| {
            let [u, v] = self.corner(triangle).map(|x| x + self.margin);
            [[u, v], [u + side, v], [u, v + side]].map(|corner| corner.map(|x| x as f64 / self.size as f64))
        };
        (0..self.triangles).map(of_triangle).collect()
    }

    /// Paints the cells. `color_at` returns the colour at a point of a triangle, given the weights of its second and third
    /// corner; in the margin, one is negative or their sum exceeds 1.
    pub fn paint(&self, color_at: &mut dyn FnMut(usize, [f64; 2]) -> Rgb) -> Vec<Rgb> {
        let mut texels = vec![[128; 3]; self.size * self.size];
        let side = self.side() as f64;
        let beyond = 1.0 + 2.0 * self.margin as f64 / side;
        for triangle in 0..self.triangles {
            let [left, top] = self.corner(triangle);
            for row in 0..self.cell {
                for column in 0..self.cell {
                    let weights = [column, row].map(|x| (x as f64 + 0.5 - self.margin as f64) / side);
                    if weights[0] + weights[1] < beyond {
                        texels[(top + row) * self.size + left + column] = color_at(triangle, weights);
                    }
                }
            }
        }
        texels
    }

    /// The first column and row of a cell.
    fn corner(&self, triangle: usize) -> [usize; 2] {
        [triangle % self.columns * self.cell, triangle / self.columns * self.cell]
    }
}
