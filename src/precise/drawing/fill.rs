//! Fills triangles on the cells of a grid, four triangles or four cells at a time.
//!
//! A lane computes what one triangle or one cell alone would, so that the bits are the same where there are no vector
//! instructions.

use wide::bytemuck::cast;
use wide::{f32x4, i32x4, u32x4};

use super::lanes::LANES;

/// Subpixel steps per cell to which vertices are snapped, 2⁶.
pub const STEPS: i32 = 64;
const SHIFT: i32 = 6;
/// Boxes of triangles at least this many cells wide are drawn row by row from where the triangle begins.
const WIDE: i32 = 32;
/// Steps below which the box of a triangle is so small that the areas its cells span fit 32 bits.
const SMALL: i32 = 1 << 12;

/// A vertex on the grid, u and v in steps, and its 1/z, which is 0 if it cannot be rendered; as bits, in the order u, v, 1/z.
pub type Vertex = f32x4;

/// Vertices in lanes.
#[derive(Clone, Copy)]
pub struct Corners {
    /// u in steps.
    pub u: i32x4,
    /// v in steps.
    pub v: i32x4,
    /// 1/z.
    pub w: f32x4,
}

impl Corners {
    #[inline(always)]
    fn gather(vertices: &[Vertex], [a, b, c, d]: [u32; LANES]) -> Self {
        let four = [vertices[a as usize], vertices[b as usize], vertices[c as usize], vertices[d as usize]];
        let [u, v, w, _] = f32x4::transpose(four);
        Self { u: cast(u), v: cast(v), w }
    }

    /// The vertices one by one.
    #[inline(always)]
    pub fn vertices(self) -> [Vertex; LANES] {
        f32x4::transpose([cast(self.u), cast(self.v), self.w, f32x4::ZERO])
    }

    #[inline(always)]
    fn select(mask: i32x4, one: Self, zero: Self) -> Self {
        let w = cast::<i32x4, f32x4>(mask).bitselect(one.w, zero.w);
        Self { u: mask.bitselect(one.u, zero.u), v: mask.bitselect(one.v, zero.v), w }
    }
}

/// The first cell whose centre is at least this many steps from the first one's.
#[inline(always)]
fn first_cell(low: i32x4) -> i32x4 {
    (low.max(i32x4::ZERO) + i32x4::splat(STEPS - 1)) >> SHIFT
}

/// Four triangles, ready to be filled. The areas are twice those that a cell centre spans with an edge; the third follows
/// from the total.
struct Setup {
    columns: [[i32; LANES]; 2],
    rows: [[i32; LANES]; 2],
    /// At the first cell.
    b: [i32; LANES],
    c: [i32; LANES],
    /// Changes per column and per row.
    b_change: [[i32; LANES]; 2],
    c_change: [[i32; LANES]; 2],
    area: [i32; LANES],
    w: [f32; LANES],
    w_b: [f32; LANES],
    w_c: [f32; LANES],
}

/// Renders four triangles, in order, until more than `most` cells are visited, and returns about the number of cells visited,
/// and the number of triangles that are filled. `ids` are those that cells get. Takes slices of one length instead of the canvas, so that
/// addresses and length stay in registers.
#[inline(always)]
pub fn fill(
    inverse_depth: &mut [f32],
    drawn: &mut [u32],
    size: [usize; 2],
    ids: [u32; LANES],
    vertices: &[Vertex],
    triangles: [[u32; 3]; LANES],
    most: usize,
) -> (usize, u32) {
    let [i, j, k, l] = triangles;
    let a = Corners::gather(vertices, [i[0], j[0], k[0], l[0]]);
    let mut b = Corners::gather(vertices, [i[1], j[1], k[1], l[1]]);
    let mut c = Corners::gather(vertices, [i[2], j[2], k[2], l[2]]);
    let corners = [a, b, c];
    // The first and last cell whose centre is in the box of the triangle.
    let (u_low, u_high) = (a.u.min(b.u).min(c.u), a.u.max(b.u).max(c.u));
    let (v_low, v_high) = (a.v.min(b.v).min(c.v), a.v.max(b.v).max(c.v));
    let last = |size: usize| i32x4::splat(size as i32 - 1);
    let (u0, u1) = (first_cell(u_low), (u_high >> SHIFT).min(last(size[0])));
    let (v0, v1) = (first_cell(v_low), (v_high >> SHIFT).min(last(size[1])));
    let is_hidden: i32x4 = cast((a.w * b.w * c.w).simd_eq(f32x4::ZERO));
    let is_empty: i32x4 = u0.simd_gt(u1) | v0.simd_gt(v1) | is_hidden;
    let is_large = (u_high - u_low).max(v_high - v_low).simd_gt(i32x4::splat(SMALL - 1))
        | (u1 - u0).simd_gt(i32x4::splat(WIDE - 2));
    let large = if size[0] < LANES { 0xf } else { is_large.to_bitmask() };
    let area = (b.u - a.u) * (c.v - a.v) - (c.u - a.u) * (b.v - a.v);
    let is_line: i32x4 = area.simd_eq(i32x4::ZERO);
    let mut left = !is_empty.to_bitmask() & (large | !is_line.to_bitmask()) & 0xf;
    let filled = left.count_ones();
    if left == 0 {
        return (0, 0);
    }
    let is_turned: i32x4 = area.simd_lt(i32x4::ZERO);
    (b, c) = (Corners::select(is_turned, c, b), Corners::select(is_turned, b, c));
    let area = area.abs();
    let (b_du, b_dv) = (c.v - a.v, a.u - c.u);
    let (c_du, c_dv) = (a.v - b.v, b.u - a.u);
    let inverse = f32x4::ONE / f32x4::from_i32x4(area);
    let (w_b, w_c) = ((b.w - a.w) * inverse, (c.w - a.w) * inverse);
    // Cells beside the box are outside the triangle or, where the grid ends, begin before it.
    let u_first = u0.min(i32x4::splat(size[0] as i32 - LANES as i32));
    let (du, dv) = ((u_first << SHIFT) - a.u, (v0 << SHIFT) - a.v);
    let setup = Setup {
        columns: [u_first.to_array(), u1.to_array()],
        rows: [v0.to_array(), v1.to_array()],
        b: (b_du * du + b_dv * dv).to_array(),
        c: (c_du * du + c_dv * dv).to_array(),
        b_change: [(b_du << SHIFT).to_array(), (b_dv << SHIFT).to_array()],
        c_change: [(c_du << SHIFT).to_array(), (c_dv << SHIFT).to_array()],
        area: area.to_array(),
        w: a.w.to_array(),
        w_b: w_b.to_array(),
        w_c: w_c.to_array(),
    };
    let boxes = ((u1 - u0 + i32x4::ONE) * (v1 - v0 + i32x4::ONE)).to_array();
    let mut visited = 0;
    while left != 0 && visited <= most {
        let lane = left.trailing_zeros() as usize & (LANES - 1);
        left &= left - 1;
        let id = ids[lane];
        if large >> lane & 1 == 1 {
            visited += fill_large(inverse_depth, drawn, size[0], id, &corners, [[u0, u1], [v0, v1]], lane);
        } else {
            fill_small(inverse_depth, drawn, size[0], id, &setup, lane);
            visited += boxes[lane] as usize;
        }
    }
    (visited, filled)
}

/// A triangle whose box is small: in 32 bits, four cells of a row at once, and without a branch per cell.
#[inline(always)]
fn fill_small(inverse_depth: &mut [f32], drawn: &mut [u32], width: usize, id: u32, setup: &Setup, lane: usize) {
    let ramp = |at: i32, change: i32| i32x4::splat(at) + i32x4::splat(change) * i32x4::new([0, 1, 2, 3]);
    let (b_du, c_du) = (setup.b_change[0][lane], setup.c_change[0][lane]);
    let (b_down, c_down) = (i32x4::splat(setup.b_change[1][lane]), i32x4::splat(setup.c_change[1][lane]));
    let (first, last) = (setup.columns[0][lane], setup.columns[1][lane]);
    let (top, bottom) = (setup.rows[0][lane], setup.rows[1][lane]);
    let total = i32x4::splat(setup.area[lane]);
    let w_a = f32x4::splat(setup.w[lane]);
    let (w_b, w_c) = (f32x4::splat(setup.w_b[lane]), f32x4::splat(setup.w_c[lane]));
    let end = (width - LANES) as i32;
    let mut from = first;
    while from <= last {
        let column = from.min(end);
        let mut b = ramp(setup.b[lane] + b_du * (column - first), b_du);
        let mut c = ramp(setup.c[lane] + c_du * (column - first), c_du);
        let mut at = top as usize * width + column as usize;
        for _ in 0..bottom - top + 1 {
            let cells = inverse_depth.get_mut(at..).and_then(|cells| cells.first_chunk_mut::<LANES>());
            let drawn = drawn.get_mut(at..).and_then(|drawn| drawn.first_chunk_mut::<LANES>());
            let Some((cells, drawn)) = cells.zip(drawn) else { break };
            let w = w_a + f32x4::from_i32x4(b) * w_b + f32x4::from_i32x4(c) * w_c;
            let (far, other) = (f32x4::new(*cells), u32x4::new(*drawn));
            let is_inside: i32x4 = (b | c | (total - b - c)).simd_gt(i32x4::splat(-1));
            let is_drawn = is_inside & cast::<f32x4, i32x4>(w.simd_gt(far));
            *cells = cast::<i32x4, f32x4>(is_drawn).bitselect(w, far).to_array();
            *drawn = cast::<i32x4, u32x4>(is_drawn).bitselect(u32x4::splat(id), other).to_array();
            (b, c, at) = (b + b_down, c + c_down, at + width);
        }
        from += LANES as i32;
    }
}

/// Any triangle, in 64 bits.
#[inline(never)]
fn fill_large(
    inverse_depth: &mut [f32],
    drawn: &mut [u32],
    width: usize,
    id: u32,
    corners: &[Corners; 3],
    cells: [[i32x4; 2]; 2],
    lane: usize,
) -> usize {
    let [[u0, u1], [v0, v1]] = cells.map(|range| range.map(|cell| cell.to_array()[lane]));
    let [a, mut b, mut c] = corners.map(|corner| Corner::of(&corner, lane));
    let mut area = (b.u - a.u) * (c.v - a.v) - (c.u - a.u) * (b.v - a.v);
    if area == 0 {
        return 0;
    }
    if area < 0 {
        area = -area;
        core::mem::swap(&mut b, &mut c);
    }
    // Twice the areas that a cell centre spans with two edges; the third follows from the total.
    let (b_du, b_dv) = (c.v - a.v, a.u - c.u);
    let (c_du, c_dv) = (a.v - b.v, b.u - a.u);
    let steps = i64::from(STEPS);
    let (du, dv) = (i64::from(u0) * steps - a.u, i64::from(v0) * steps - a.v);
    let (mut b_row, mut c_row) = (b_du * du + b_dv * dv, c_du * du + c_dv * dv);
    let (b_du, b_dv, c_du, c_dv) = (b_du * steps, b_dv * steps, c_du * steps, c_dv * steps);
    let inverse = 1.0 / area as f32;
    let (wb, wc) = ((b.w - a.w) * inverse, (c.w - a.w) * inverse);
    let cells = (u1 - u0) as usize + 1;
    let is_wide = u1 - u0 + 1 >= WIDE;
    let rows = (v1 - v0) as usize + 1;
    // Twice the area in steps² is 2¹³ times that in cells.
    let visited = if is_wide { (cells * rows).min((area >> 13) as usize + 2 * rows) } else { cells * rows };
    for v in v0..=v1 {
        let start = v as usize * width + u0 as usize;
        let (mut eb, mut ec, mut entered) = (b_row, c_row, false);
        // A long thin triangle fills little of its box.
        let skipped = if is_wide { first_inside([(eb, b_du), (ec, c_du), (area - eb - ec, -b_du - c_du)]) } else { 0 };
        let skipped = skipped.min(cells as i64);
        (eb, ec) = (eb + b_du * skipped, ec + c_du * skipped);
        let (from, to) = (start + skipped as usize, start + cells);
        let row = inverse_depth[from..to].iter_mut().zip(&mut drawn[from..to]);
        for (cell, drawn) in row {
            if (eb | ec | (area - eb - ec)) >= 0 {
                entered = true;
                let w = a.w + eb as f32 * wb + ec as f32 * wc;
                if w > *cell {
                    *cell = w;
                    *drawn = id;
                }
            } else if entered {
                break;
            }
            eb += b_du;
            ec += c_du;
        }
        b_row += b_dv;
        c_row += c_dv;
    }
    visited
}

/// A vertex for the coverage test.
#[derive(Clone, Copy)]
struct Corner {
    u: i64,
    v: i64,
    w: f32,
}

impl Corner {
    fn of(corners: &Corners, lane: usize) -> Self {
        let [u, v] = [corners.u, corners.v].map(|steps| i64::from(steps.to_array()[lane]));
        Self { u, v, w: corners.w.to_array()[lane] }
    }
}

/// The first cell of a row in which no edge is negative, `i64::MAX` if there is none: each edge is its value at the first
/// cell and its growth per cell.
#[inline]
fn first_inside(edges: [(i64, i64); 3]) -> i64 {
    edges.into_iter().fold(0, |first, (value, growth)| {
        if value >= 0 {
            first
        } else if growth <= 0 {
            i64::MAX
        } else {
            first.max((growth - 1 - value) / growth)
        }
    })
}
