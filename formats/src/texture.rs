//! Textures, averaged to the distance of the points where they are read; those of a file are loaded once each, and all within a
//! limit.

use std::borrow::Cow;
use std::collections::BTreeMap;
use std::rc::Rc;

use crate::guard::{MAX_PIXELS, too_large, unsupported};
use crate::photo;
use crate::reducer::{reduce, reduced_size};
use crate::resources::ImageDecoder;
use sim3align_geometry::image::Image;
use sim3align_geometry::surface_colors::Rgb;
use sim3align_runtime::error::{Error, ErrorCode, Result};

/// Maximum number of texels of a texture after reading: the texels of a surface that fills a quarter of it are still
/// several times as dense as the points where colours are read.
const MAX_TEXELS: usize = 1 << 20;

/// Maximum number of pixels of all textures of a file together: four of the largest size.
const MAX_TEXTURE_PIXELS: usize = 4 * MAX_PIXELS;

/// The continuation of a texture beyond its edges.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(crate) enum Wrap {
    #[default]
    Repeat,
    Mirror,
    Clamp,
}

impl Wrap {
    /// The texel of an index beyond the edges.
    fn apply(self, index: i64, count: usize) -> usize {
        let count = count as i64;
        let wrapped = match self {
            Self::Repeat => index.rem_euclid(count),
            Self::Mirror => {
                let index = index.rem_euclid(2 * count);
                index.min(2 * count - 1 - index)
            }
            Self::Clamp => index.clamp(0, count - 1),
        };
        wrapped as usize
    }
}

/// An image and its reductions, each half as wide and high as the one before.
#[derive(Debug)]
pub(crate) struct Texture {
    levels: Vec<Image<Rgb>>,
}

impl Texture {
    fn new(image: Image<Rgb>) -> Result<Self> {
        let mut levels = vec![image];
        while let Some(last) = levels.last()
            && last.width().max(last.height()) > 1
        {
            let half = [last.width(), last.height()].map(|side| (side / 2).max(1));
            levels.push(reduce(last, half)?);
        }
        Ok(Self { levels })
    }

    /// The colour at coordinates u, v: (0, 0) is the upper left corner of the image, (1, 1) the lower right one.
    /// `area`: the fraction of the image that the colour is averaged over.
    pub fn color(&self, [u, v]: [f64; 2], area: f64, wrap: [Wrap; 2]) -> Rgb {
        let Some(finest) = self.levels.first() else { return [0; 3] };
        // Levels of a quarter of the texels each, as long as a texel is no larger than the area.
        let mut texels = area * finest.data().len() as f64;
        let mut level = 0;
        while texels >= 4.0 && level + 1 < self.levels.len() {
            (texels, level) = (texels / 4.0, level + 1);
        }
        let Some(image) = self.levels.get(level) else { return [0; 3] };
        let sides = [image.width(), image.height()];
        // Texel centres are at half-integers. Beyond 2^31 repetitions, coordinates have no sub-texel precision.
        let place = |x: f64, side: usize| {
            let at = if x.abs() < 2_147_483_648.0 { x * side as f64 - 0.5 } else { 0.0 };
            (at.floor() as i64, at - at.floor())
        };
        let [(column, across), (row, down)] = [place(u, sides[0]), place(v, sides[1])];
        let columns = [column, column + 1].map(|i| wrap[0].apply(i, sides[0]));
        let rows = [row, row + 1].map(|i| wrap[1].apply(i, sides[1]));
        let texel = |row: usize, column: usize| image.get(column, row).unwrap_or_default().map(f64::from);
        let [top, bottom] = rows.map(|row| {
            let [left, right] = columns.map(|column| texel(row, column));
            core::array::from_fn::<f64, 3, _>(|i| left[i] + (right[i] - left[i]) * across)
        });
        core::array::from_fn(|i| (top[i] + (bottom[i] - top[i]) * down).round() as u8)
    }
}

/// The textures loaded so far.
pub(crate) struct TextureLoader<'a> {
    textures: BTreeMap<String, Rc<Texture>>,
    pixels: usize,
    decoder: Option<ImageDecoder<'a>>,
}

impl<'a> TextureLoader<'a> {
    /// `decoder`: of images that are neither PNG nor JPEG.
    pub fn new(decoder: Option<ImageDecoder<'a>>) -> Self {
        Self { textures: BTreeMap::new(), pixels: 0, decoder }
    }

    /// The texture of this name in the file.
    pub fn load<'b>(&mut self, name: &str, bytes: impl FnOnce() -> Result<Cow<'b, [u8]>>) -> Result<Rc<Texture>> {
        if let Some(texture) = self.textures.get(name) {
            return Ok(texture.clone());
        }
        let texture = Rc::new(self.decode(&bytes()?)?);
        self.textures.insert(name.to_owned(), texture.clone());
        Ok(texture)
    }

    fn decode(&mut self, bytes: &[u8]) -> Result<Texture> {
        match photo::size("mesh", bytes) {
            Ok(size) => {
                self.count(size)?;
                Texture::new(photo::decode("mesh", bytes, MAX_TEXELS)?.0)
            }
            Err(error) if error.code == ErrorCode::UnsupportedFormat => {
                let Some(image) = self.decoder.and_then(|decode| decode(bytes)) else {
                    return Err(unsupported_texture(&format!("a texture that is {}", error.found)));
                };
                let size = [image.width(), image.height()];
                self.count(size)?;
                let reduced = reduced_size(size, MAX_TEXELS);
                Texture::new(if reduced == size { image } else { reduce(&image, reduced)? })
            }
            Err(error) => Err(error),
        }
    }

    /// Counts a texture against the limit of all.
    fn count(&mut self, [width, height]: [usize; 2]) -> Result<()> {
        self.pixels = self.pixels.saturating_add(width.saturating_mul(height));
        if self.pixels > MAX_TEXTURE_PIXELS {
            let found = format!("textures of more than {MAX_TEXTURE_PIXELS} pixels together");
            return Err(too_large("mesh", found, "fewer"));
        }
        Ok(())
    }
}

/// The error for a texture that can't be decoded.
pub(crate) fn unsupported_texture(found: &str) -> Error {
    unsupported(
        "mesh",
        found.to_owned(),
        "a base colour texture as PNG, JPEG or WebP",
        "Convert the textures, those of glTF with glTF-Transform: npx @gltf-transform/cli png --formats '*' in.glb out.glb (KTX2, with the program ktx: ktxdecompress in.glb out.glb). Or pass decodeImage to readMesh().",
    )
}
