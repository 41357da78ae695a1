//! The files that a mesh file refers to.

use std::borrow::Cow;

use crate::data_uri;
use crate::guard::corrupt;
use sim3align_geometry::image::Image;
use sim3align_geometry::surface_colors::Rgb;
use sim3align_runtime::error::{Error, ErrorCode, Result};

/// Returns the content of a file that a mesh file refers to, by the URI or name in it.
pub type Resources<'a> = &'a dyn Fn(&str) -> Option<Vec<u8>>;

/// Decodes an image in a format that is neither PNG nor JPEG; `None` if it cannot.
pub type ImageDecoder<'a> = &'a dyn Fn(&[u8]) -> Option<Image<Rgb>>;

/// The files that a mesh file refers to, by the URIs or names in it.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct ExternalResources {
    /// Without these, the mesh can't be read: the buffers of a `.gltf`.
    pub shape: Vec<String>,
    /// Without these, it has no colours: the images of base colours, and the libraries of an `.obj` with their textures.
    pub colors: Vec<String>,
}

/// The bytes at a URI, in it or in a file. `what` refers to it in errors.
pub(crate) fn at_uri(
    uri: &str,
    resources: Option<Resources<'_>>,
    what: impl FnOnce() -> String,
) -> Result<Cow<'static, [u8]>> {
    let bytes = if uri.starts_with("data:") {
        let broken = || corrupt("mesh", format!("{} with a broken data URI", what()), "data:…;base64,…");
        data_uri::decode(uri).ok_or_else(broken)?
    } else {
        external(uri, resources)?
    };
    Ok(Cow::Owned(bytes))
}

/// The bytes of a file that a mesh file refers to.
pub(crate) fn external(uri: &str, resources: Option<Resources<'_>>) -> Result<Vec<u8>> {
    let find = resources.and_then(|find| {
        find(uri).or_else(|| find(core::str::from_utf8(&data_uri::percent_decode(uri.as_bytes())).ok()?))
    });
    find.ok_or_else(|| {
        Error::new(
            ErrorCode::InvalidArgument,
            "options.resources",
            format!("no bytes for {uri:?}"),
            "the bytes of every external file, by the name in the mesh file",
            "Pass them in resources, or put them beside the mesh in its folder, or pack a .gltf into one file: npx @gltf-transform/cli copy in.gltf out.glb.",
        )
    })
}

/// The distinct names, sorted.
pub(crate) fn distinct<'a>(names: impl Iterator<Item = &'a str>) -> Vec<String> {
    let mut names: Vec<String> = names.map(str::to_owned).collect();
    names.sort();
    names.dedup();
    names
}
