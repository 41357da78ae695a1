//! sRGB encoding of colours (IEC 61966-2-1).

use std::sync::LazyLock;

use sim3align_geometry::surface_colors::Rgb;

/// White.
pub(crate) const WHITE: Rgb = [255; 3];

struct Tables {
    /// Linear light of each code, 0 to 1.
    linear: [f32; 256],
    /// Linear light half-way, in codes, between each code and the next.
    bounds: [f32; 255],
}

static TABLES: LazyLock<Box<Tables>> = LazyLock::new(|| {
    let decode = |code: f64| {
        let x = code / 255.0;
        (if x <= 0.04045 { x / 12.92 } else { libm::pow((x + 0.055) / 1.055, 2.4) }) as f32
    };
    Box::new(Tables {
        linear: core::array::from_fn(|code| decode(code as f64)),
        bounds: core::array::from_fn(|code| decode(code as f64 + 0.5)),
    })
});

/// Linear light, 0 to 1, of an sRGB-encoded colour.
pub(crate) fn linear(color: Rgb) -> [f32; 3] {
    color.map(|code| TABLES.linear[usize::from(code)])
}

/// The nearest sRGB-encoded colour of linear light. Values beyond 0 to 1 are clamped; NaN is 0.
pub(crate) fn srgb(linear: [f32; 3]) -> Rgb {
    linear.map(|x| TABLES.bounds.partition_point(|bound| x >= *bound) as u8)
}
