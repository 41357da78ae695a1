//! The materials of a glTF scene: base colours, or those of emitted light, and their textures.
//!
//! They are parsed apart from the geometry, and only for colours: a mesh with a broken material can still be read.

use std::borrow::Cow;

use serde::Deserialize;
use serde_json::Value;

use crate::gltf::accessor::AccessorReader;
use crate::guard::{corrupt, missing};
use crate::painted_mesh::Material;
use crate::resources::at_uri;
use crate::texture::{TextureLoader, Wrap, unsupported_texture};
use sim3align_geometry::angle::sin_cos;
use sim3align_runtime::error::Result;

const CLAMP_TO_EDGE: u32 = 33_071;
const MIRRORED_REPEAT: u32 = 33_648;

/// Factor below which a base colour is black.
const BLACK: f32 = 0.002;

/// The parts of a glTF file that define its colours.
#[derive(Debug, Default, Deserialize)]
#[serde(default, rename_all = "camelCase")]
pub(super) struct Materials {
    materials: Vec<MaterialJson>,
    textures: Vec<TextureJson>,
    images: Vec<ImageJson>,
    samplers: Vec<Sampler>,
}

#[derive(Debug, Default, Deserialize)]
#[serde(default, rename_all = "camelCase")]
struct MaterialJson {
    pbr_metallic_roughness: Option<BaseColor>,
    emissive_factor: Option<[f32; 3]>,
    emissive_texture: Option<TextureInfo>,
    extensions: Option<MaterialExtensions>,
}

#[derive(Debug, Default, Deserialize)]
#[serde(default)]
struct MaterialExtensions {
    #[serde(rename = "KHR_materials_pbrSpecularGlossiness")]
    specular_glossiness: Option<BaseColor>,
}

/// The base colour, or the diffuse colour of `KHR_materials_pbrSpecularGlossiness`.
#[derive(Debug, Default, Deserialize)]
#[serde(default, rename_all = "camelCase")]
struct BaseColor {
    #[serde(alias = "diffuseFactor")]
    base_color_factor: Option<[f32; 4]>,
    #[serde(alias = "diffuseTexture")]
    base_color_texture: Option<TextureInfo>,
}

/// A reference to a texture and its coordinates.
#[derive(Debug, Default, Deserialize)]
#[serde(default, rename_all = "camelCase")]
pub(super) struct TextureInfo {
    index: usize,
    tex_coord: u32,
    extensions: Option<TextureExtensions>,
}

#[derive(Debug, Default, Deserialize)]
#[serde(default)]
struct TextureExtensions {
    #[serde(rename = "KHR_texture_transform")]
    transform: Option<TextureTransform>,
}

#[derive(Debug, Default, Deserialize)]
#[serde(default, rename_all = "camelCase")]
struct TextureTransform {
    offset: Option<[f32; 2]>,
    rotation: f32,
    scale: Option<[f32; 2]>,
    tex_coord: Option<u32>,
}

#[derive(Debug, Default, Deserialize)]
#[serde(default)]
struct TextureJson {
    source: Option<usize>,
    sampler: Option<usize>,
    extensions: Option<TextureSources>,
}

/// Images of a texture in further formats.
#[derive(Debug, Default, Deserialize)]
#[serde(default)]
struct TextureSources {
    #[serde(rename = "EXT_texture_webp")]
    webp: Option<TextureSource>,
    #[serde(rename = "KHR_texture_basisu")]
    ktx2: Option<TextureSource>,
}

#[derive(Debug, Deserialize)]
struct TextureSource {
    source: usize,
}

impl TextureJson {
    /// The image, of a format that can be read, if there is one.
    fn image(&self) -> Option<usize> {
        let further = || {
            let TextureSources { webp, ktx2 } = self.extensions.as_ref()?;
            Some(webp.as_ref().or(ktx2.as_ref())?.source)
        };
        self.source.or_else(further)
    }
}

#[derive(Debug, Default, Deserialize)]
#[serde(default, rename_all = "camelCase")]
struct ImageJson {
    uri: Option<String>,
    buffer_view: Option<usize>,
}

#[derive(Debug, Default, Deserialize)]
#[serde(default, rename_all = "camelCase")]
struct Sampler {
    wrap_s: u32,
    wrap_t: u32,
}

impl Materials {
    /// Parses the JSON of a glTF file.
    pub fn parse(json: &Value) -> Result<Self> {
        Self::deserialize(json)
            .map_err(|error| corrupt("mesh", format!("glTF materials that can't be read: {error}"), "glTF 2.0"))
    }

    /// The factor and the texture of a material's colour: of its base colour, or of the light that it emits if that is black, as of
    /// materials without shading.
    fn color(&self, material: usize) -> Option<([f32; 3], Option<&TextureInfo>)> {
        let material = self.materials.get(material)?;
        let extension = material.extensions.as_ref().and_then(|extensions| extensions.specular_glossiness.as_ref());
        let base = material.pbr_metallic_roughness.as_ref().or(extension);
        let [r, g, b, _] = base.and_then(|base| base.base_color_factor).unwrap_or([1.0; 4]);
        let emitted = material.emissive_factor.filter(|light| light.iter().any(|x| *x > 0.0));
        match emitted.filter(|_| [r, g, b].iter().all(|x| *x < BLACK)) {
            Some(light) => Some((light, material.emissive_texture.as_ref())),
            None => Some(([r, g, b], base?.base_color_texture.as_ref())),
        }
    }

    /// The texture of a material, if it has one.
    pub fn texture_of(&self, material: Option<usize>) -> Option<&TextureInfo> {
        self.color(material?)?.1
    }

    /// The URIs of the external images of base colours, as written.
    pub fn external_images(&self) -> impl Iterator<Item = &str> {
        (0..self.materials.len()).filter_map(|material| {
            let texture = self.textures.get(self.texture_of(Some(material))?.index)?;
            let uri = self.images.get(texture.image()?)?.uri.as_deref()?;
            (!uri.starts_with("data:")).then_some(uri)
        })
    }

    /// The materials with their textures; those that no part `used` are left at the default.
    pub fn load(&self, used: &[usize], reader: &mut AccessorReader<'_>) -> Result<Vec<Material>> {
        let mut loader = TextureLoader::new(reader.images);
        let mut loaded: Vec<Material> = vec![Material::default(); self.materials.len()];
        for &index in used {
            let Some(slot) = loaded.get_mut(index) else {
                return Err(missing("material", index, self.materials.len()));
            };
            let Some((factor, texture)) = self.color(index) else { continue };
            slot.factor = factor;
            let Some(info) = texture else { continue };
            let Some(texture) = self.textures.get(info.index) else {
                return Err(missing("texture", info.index, self.textures.len()));
            };
            // The images of further formats are in extensions.
            let source = texture.image().ok_or_else(|| unsupported_texture("a texture of another format"))?;
            let sampler = texture.sampler.and_then(|sampler| self.samplers.get(sampler));
            slot.wrap = sampler.map_or_else(Default::default, |s| [s.wrap_s, s.wrap_t].map(wrap));
            slot.texture = Some(loader.load(&source.to_string(), || self.image_bytes(source, reader))?);
        }
        Ok(loaded)
    }

    fn image_bytes<'r>(&self, index: usize, reader: &'r mut AccessorReader<'_>) -> Result<Cow<'r, [u8]>> {
        let image = self.images.get(index).ok_or_else(|| missing("image", index, self.images.len()))?;
        match (&image.uri, image.buffer_view) {
            (_, Some(view)) => reader.bytes_of_view(view).map(Cow::Borrowed),
            (Some(uri), None) => at_uri(uri, reader.buffers.resources(), || format!("image {index}")),
            (None, None) => Err(corrupt("mesh", format!("image {index} without data"), "a buffer view or a URI")),
        }
    }
}

impl TextureInfo {
    /// The number of the set of texture coordinates.
    pub fn coordinate_set(&self) -> u32 {
        self.transform().and_then(|transform| transform.tex_coord).unwrap_or(self.tex_coord)
    }

    fn transform(&self) -> Option<&TextureTransform> {
        self.extensions.as_ref()?.transform.as_ref()
    }

    /// Applies `KHR_texture_transform`: scale, then a counter-clockwise rotation as the image is viewed, then the offset.
    pub fn transform_coordinates(&self, coordinates: &mut [[f32; 2]]) {
        let Some(transform) = self.transform() else { return };
        let ([dx, dy], [sx, sy]) = (transform.offset.unwrap_or_default(), transform.scale.unwrap_or([1.0; 2]));
        let (sin, cos) = sin_cos(transform.rotation.into());
        let (sin, cos) = (sin as f32, cos as f32);
        for [u, v] in coordinates {
            let (x, y) = (*u * sx, *v * sy);
            (*u, *v) = (cos * x + sin * y + dx, cos * y - sin * x + dy);
        }
    }
}

fn wrap(mode: u32) -> Wrap {
    match mode {
        CLAMP_TO_EDGE => Wrap::Clamp,
        MIRRORED_REPEAT => Wrap::Mirror,
        _ => Wrap::Repeat,
    }
}
