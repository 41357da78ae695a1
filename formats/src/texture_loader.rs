//! Loads the textures of a mesh file, each once and all within a limit.

use std::borrow::Cow;
use std::collections::BTreeMap;
use std::rc::Rc;

use crate::guard::{MAX_PIXELS, too_large, unsupported};
use crate::photo;
use crate::texture::{MAX_TEXELS, Texture};
use sim3align_geometry::error::{Error, ErrorCode, Result};

/// Maximum number of pixels of all textures of a file together: four of the largest size.
const MAX_TEXTURE_PIXELS: usize = 4 * MAX_PIXELS;

/// The textures loaded so far.
#[derive(Debug, Default)]
pub(crate) struct TextureLoader {
    textures: BTreeMap<String, Rc<Texture>>,
    pixels: usize,
}

impl TextureLoader {
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
        let [width, height] = photo::size("mesh", bytes).map_err(|error| match error.code {
            ErrorCode::UnsupportedFormat => unsupported_texture(&format!("a texture that is {}", error.found)),
            _ => error,
        })?;
        self.pixels = self.pixels.saturating_add(width.saturating_mul(height));
        if self.pixels > MAX_TEXTURE_PIXELS {
            let found = format!("textures of more than {MAX_TEXTURE_PIXELS} pixels together");
            return Err(too_large("mesh", found, "fewer"));
        }
        Texture::new(photo::decode("mesh", bytes, MAX_TEXELS)?.0)
    }
}

/// The error for a texture that is no PNG or JPEG.
pub(crate) fn unsupported_texture(found: &str) -> Error {
    unsupported(
        "mesh",
        found.to_owned(),
        "a base colour texture as PNG or JPEG",
        "Convert the textures, those of glTF with glTF-Transform: npx @gltf-transform/cli png in.glb out.glb.",
    )
}
