//! Material libraries of OBJ files.

use std::borrow::Cow;
use std::collections::BTreeMap;

use crate::color::linear;
use crate::guard::Unknown;
use crate::mesh_format::MeshReadOptions;
use crate::painted_mesh::Material;
use crate::resources::external;
use crate::text::{is_listed, lines, number, words};
use crate::texture::{TextureLoader, Wrap};
use sim3align_runtime::error::Result;

/// Maximum number of options before a file name; there are twelve kinds.
const MAX_OPTIONS: usize = 24;

/// The materials of the libraries that an OBJ names.
#[derive(Debug, Default)]
pub(crate) struct MaterialLibrary {
    entries: Vec<Entry>,
    /// Statements that are not known.
    pub unknown: Unknown,
    /// The last entry of each name.
    places: BTreeMap<Vec<u8>, usize>,
}

/// What may give a surface its colour: a colour and a texture. Shadeless materials are black and emit theirs; some exporters write the
/// ambient one only.
const SOURCES: [[&[u8]; 2]; 3] = [[b"kd", b"map_kd"], [b"ke", b"map_ke"], [b"ka", b"map_ka"]];

/// Statements of no matter for the colour: gloss, transparency, relief, and those of physically based rendering.
const HARMLESS: &str = "ks ns ni d tr tf illum sharpness map_ks map_ns map_ni map_d map_tr map_opacity map_aat map_bump bump \
    map_disp disp decal map_decal map_refl refl norm map_norm map_kn pr pm ps pc pcr aniso anisor map_pr map_pm map_ps map_pc \
    map_pcr map_rma map_orm map_ao map_refl_* km bm";

#[derive(Debug, Default)]
struct Entry {
    /// The colours of [`SOURCES`], and their textures with options.
    colors: [Option<[f64; 3]>; SOURCES.len()],
    maps: [Option<Map>; SOURCES.len()],
}

impl Entry {
    /// The source of the colour.
    fn map(&self) -> Option<&Map> {
        let is_black = |color: &Option<[f64; 3]>| color.is_some_and(|color| color == [0.0; 3]);
        let [diffuse, emitted, ambient] = self.maps.each_ref().map(Option::as_ref);
        // Beside a diffuse colour, what is emitted are lights.
        diffuse.or(if is_black(&self.colors[0]) { emitted.or(ambient) } else { ambient })
    }

    /// The colour where there is no texture.
    fn color(&self) -> Option<[f64; 3]> {
        let [diffuse, emitted, ambient] = self.colors;
        let has_light = |color: &[f64; 3]| *color != [0.0; 3];
        // Blender writes the same ambient colour for all materials.
        diffuse.filter(has_light).or(emitted.filter(has_light)).or(diffuse).or(ambient)
    }
}

#[derive(Debug, Default)]
struct Map {
    file: String,
    is_clamped: bool,
    offset: [f32; 2],
    scale: [f32; 2],
}

impl MaterialLibrary {
    /// Adds the materials of an MTL file.
    pub fn add(&mut self, bytes: &[u8]) {
        for line in lines(bytes) {
            let line = uncommented(line);
            let mut parts = words(line);
            let Some(word) = parts.next().map(<[u8]>::to_ascii_lowercase) else { continue };
            if word == b"newmtl" {
                self.places.insert(parts.collect::<Vec<_>>().join(&b' '), self.entries.len());
                self.entries.push(Entry::default());
                continue;
            }
            let Some(entry) = self.entries.last_mut() else { continue };
            match SOURCES.iter().position(|names| names.contains(&word.as_slice())) {
                Some(source) if word.starts_with(b"map_") => entry.maps[source] = Map::parse(line),
                Some(source) => {
                    let numbers: Vec<f64> = parts.map_while(number).collect();
                    // One number stands for all three channels.
                    entry.colors[source] = match *numbers {
                        [r, g, b, ..] => Some([r, g, b]),
                        [grey] => Some([grey; 3]),
                        _ => entry.colors[source],
                    };
                }
                None if is_listed(&word, HARMLESS) => {}
                None => self.unknown.insert(&word),
            }
        }
    }

    /// The index of the material of this name; the last one of its name counts.
    pub fn index_of(&self, name: &[u8]) -> Option<usize> {
        self.places.get(name).copied()
    }

    /// Offset and scale of the texture coordinates of a material; `None` without a texture.
    pub fn mapping(&self, material: Option<usize>) -> Option<[[f32; 2]; 2]> {
        let map = self.entries.get(material?)?.map()?;
        Some([map.offset, map.scale])
    }

    /// The files of the textures, as written.
    pub fn files(&self) -> impl Iterator<Item = &str> {
        self.entries.iter().filter_map(|entry| Some(entry.map()?.file.as_str()))
    }

    /// The materials with their textures; those that no part `used` are left at the default.
    pub fn load(&self, used: &[usize], options: &MeshReadOptions<'_>) -> Result<Vec<Material>> {
        let mut loader = TextureLoader::new(options.images);
        let mut loaded: Vec<Material> = vec![Material::default(); self.entries.len()];
        for &index in used {
            let (Some(slot), Some(entry)) = (loaded.get_mut(index), self.entries.get(index)) else { continue };
            let Some(map) = entry.map() else {
                // Viewers take the numbers as they are for display, sRGB-encoded.
                slot.factor = entry.color().map_or([1.0; 3], |color| linear(color.map(|x| (x * 255.0).round() as u8)));
                continue;
            };
            // With a texture, Kd is ignored: exporters write 0, 0.8 or 1 there, whatever the texture.
            slot.texture = Some(loader.load(&map.file, || external(&map.file, options.resources).map(Cow::Owned))?);
            slot.wrap = [if map.is_clamped { Wrap::Clamp } else { Wrap::Repeat }; 2];
        }
        Ok(loaded)
    }
}

/// A line without its comment. In the names of materials and files, the sign of comments is a letter.
pub(crate) fn uncommented(line: &[u8]) -> &[u8] {
    let first = words(line).next().unwrap_or_default().to_ascii_lowercase();
    let has_name = is_listed(&first, "newmtl usemtl mtllib map_*");
    if has_name { line } else { line.split(|&b| b == b'#').next().unwrap_or_default() }
}

/// All after the first word of a line.
fn rest_of(line: &[u8]) -> Vec<u8> {
    let line = line.trim_ascii();
    let end = line.iter().position(u8::is_ascii_whitespace).unwrap_or(line.len());
    line.get(end..).unwrap_or_default().trim_ascii().to_vec()
}

impl Map {
    /// `map_Kd -option values… file name`.
    fn parse(line: &[u8]) -> Option<Self> {
        let mut map = Self { scale: [1.0; 2], ..Self::default() };
        let mut rest = rest_of(line);
        for _ in 0..MAX_OPTIONS {
            if !rest.starts_with(b"-") {
                break;
            }
            let parts: Vec<&[u8]> = words(&rest).collect();
            let numbers = |from: usize| parts.iter().skip(from).map_while(|word| number(word)).take(3);
            let count = match parts.first().copied().unwrap_or_default() {
                b"-o" | b"-s" | b"-t" => numbers(1).count(),
                b"-mm" => 2,
                _ => 1,
            };
            let pair = |default: f32| {
                let mut values = numbers(1).map(|x| x as f32);
                [values.next().unwrap_or(default), values.next().unwrap_or(default)]
            };
            match parts.first().copied().unwrap_or_default() {
                b"-o" => map.offset = pair(0.0),
                b"-s" => map.scale = pair(1.0),
                b"-clamp" => map.is_clamped = parts.get(1) == Some(&b"on".as_slice()),
                _ => {}
            }
            for _ in 0..=count {
                rest = rest_of(&rest);
                if rest.is_empty() {
                    return None;
                }
            }
        }
        map.file = String::from_utf8_lossy(&rest).replace('\\', "/");
        (!map.file.is_empty()).then_some(map)
    }
}
