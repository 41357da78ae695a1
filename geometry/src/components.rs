//! Connected components of binary images.

/// A connected component (four neighbours).
pub struct Component {
    /// Indices of the pixels, row-major.
    pub pixels: Vec<u32>,
    /// Whether a pixel is on the border of the image.
    pub touches_border: bool,
}

/// The connected components of the set pixels of an image, in the order of their first pixels.
pub fn components(set: &[bool], width: usize, height: usize) -> Vec<Component> {
    let mut seen = vec![false; set.len()];
    let mut list = Vec::new();
    for start in 0..set.len() {
        if !set[start] || seen[start] {
            continue;
        }
        seen[start] = true;
        let mut component = Component { pixels: vec![start as u32], touches_border: false };
        let mut next = 0;
        while let Some(&i) = component.pixels.get(next) {
            next += 1;
            let (u, v) = (i as usize % width, i as usize / width);
            component.touches_border |= u == 0 || v == 0 || u + 1 == width || v + 1 == height;
            let mut visit = |j: usize| {
                if set[j] && !seen[j] {
                    seen[j] = true;
                    component.pixels.push(j as u32);
                }
            };
            if u > 0 {
                visit(i as usize - 1);
            }
            if u + 1 < width {
                visit(i as usize + 1);
            }
            if v > 0 {
                visit(i as usize - width);
            }
            if v + 1 < height {
                visit(i as usize + width);
            }
        }
        list.push(component);
    }
    list
}
