//! The names in PLY files: what the reader of meshes makes of each element and property.

use crate::guard::Unknown;
use crate::ply_header::Header;
use crate::text::is_listed;

/// Colours of vertices or faces, sRGB-encoded: whole numbers up to the largest of their type, or floats. The first that are
/// there count. MeshLab and most others write the first, older programs the second, others the third.
pub(crate) const COLORS: [[&[u8]; 3]; 3] =
    [[b"red", b"green", b"blue"], [b"diffuse_red", b"diffuse_green", b"diffuse_blue"], [b"r", b"g", b"b"]];

/// Texture coordinates of vertices, from the lower left corner of the image: of BlenderProc and the models of BOP, of Blender,
/// and of others.
pub(crate) const COORDINATES: [[&[u8]; 2]; 4] =
    [[b"texture_u", b"texture_v"], [b"s", b"t"], [b"u", b"v"], [b"texture_s", b"texture_t"]];

/// The vertices of a face or of strips.
pub(crate) const CORNERS: [&[u8]; 2] = [b"vertex_indices", b"vertex_index"];

/// The texture coordinates of the corners of a face, and the number of its texture: of MeshLab and of scanners.
pub(crate) const CORNER_COORDINATES: &[u8] = b"texcoord";
pub(crate) const TEXTURE_NUMBER: &[u8] = b"texnumber";

/// Properties of no matter for shape and colour, of any element: normals, transparency, gloss, and what scanners, simulators,
/// CloudCompare (`scalar_…`) and MeshLab measure or mark.
const HARMLESS: &str = "nx ny nz normal_x normal_y normal_z normalx normaly normalz scalar_* tangent_* alpha a opacity \
    diffuse_alpha diffuse_coeff ambient_* specular_* reflect_coeff refract_coeff refract_index shininess confidence quality \
    intensity reflectance value curvature radius density flags flag selected visible label labels class classification \
    category_id object_id objectid globalid nyu40 segment group id time std_dev area";

/// Elements of no matter: the edges of triangles that are faces, and the cameras of scanners or of a saved view.
const HARMLESS_ELEMENTS: &str = "edge camera range_grid";

/// Whether a property of an element is used, or does not matter.
fn is_known(element: &[u8], name: &[u8]) -> bool {
    let is_color = || COLORS.as_flattened().contains(&name);
    match element {
        b"vertex" if is_color() || name.len() == 1 && b"xyz".contains(&name[0]) => true,
        b"vertex" if COORDINATES.as_flattened().contains(&name) => true,
        b"face" if is_color() || name == CORNER_COORDINATES || name == TEXTURE_NUMBER => true,
        b"face" | b"tristrips" if CORNERS.contains(&name) => true,
        _ => is_listed(name, HARMLESS) || is_listed(element, HARMLESS_ELEMENTS),
    }
}

/// The properties of a PLY file that are not known.
pub(crate) fn unknown(header: &Header) -> Unknown {
    let mut unknown = Unknown::default();
    for element in header.elements.iter().filter(|element| element.count > 0) {
        for property in element.properties.iter().filter(|property| !is_known(&element.name, &property.name)) {
            unknown.insert(&[&*element.name, &*property.name].join(&b'.'));
        }
    }
    unknown
}

/// Whether an unknown name is that of colours.
pub(crate) fn concerns_colors(name: &str) -> bool {
    ["color", "colour", "rgb", "red", "material", "texture", "texcoord"].iter().any(|part| name.contains(part))
}
