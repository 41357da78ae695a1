//! Flattens the node hierarchy.

use glam::{DMat4, DVec3, Vec3};

use crate::colored_mesh::ColoredMesh;
use crate::gltf::accessor::AccessorReader;
use crate::gltf::document::{Document, Node, Primitive};
use crate::gltf::instancing::unit;
use crate::gltf::materials::Materials;
use crate::gltf::skin::Skin;
use crate::guard::{corrupt, missing};
use crate::mesh_builder::MeshBuilder;
use crate::painted_mesh::PaintedMesh;
use sim3align_runtime::error::{Error, ErrorCode, Result};

/// The modes of primitives of triangles; those before are points and lines.
const TRIANGLES: usize = 4;
const TRIANGLE_STRIP: usize = 5;
const TRIANGLE_FAN: usize = 6;

/// All triangles of the scene, in the frame of the scene, with colours if there are `materials`.
pub(super) fn read_scene(reader: &mut AccessorReader<'_>, materials: Option<Result<Materials>>) -> Result<ColoredMesh> {
    let document = reader.document;
    let mut parts: Vec<Option<Vec<PaintedMesh>>> = document.meshes.iter().map(|_| None).collect();
    let (materials, mut problem) = match materials.transpose() {
        Ok(materials) => (materials, None),
        Err(problem) => (None, Some(problem)),
    };
    let mut builder = MeshBuilder::default();
    let mut skipped = 0;
    // How often each mesh is placed.
    let mut copies_of = vec![0; document.meshes.len()];
    let (order, scene_from_node) = placed(document)?;
    for index in order {
        let (Some(node), Some(Some(transform))) = (document.nodes.get(index), scene_from_node.get(index)) else {
            continue;
        };
        let Some(mesh_index) = node.mesh else { continue };
        let (Some(mesh), Some(slot)) = (document.meshes.get(mesh_index), parts.get_mut(mesh_index)) else {
            return Err(missing("mesh", mesh_index, document.meshes.len()));
        };
        let weights = if node.weights.is_empty() { &mesh.weights } else { &node.weights };
        let is_shared = node.skin.is_none() && node.weights.is_empty();
        let skin = node.skin.map(|skin| Skin::read(skin, reader, &scene_from_node)).transpose()?;
        let parts = match slot.take().filter(|_| is_shared) {
            Some(parts) => parts,
            None => {
                let mut parts = Vec::new();
                for primitive in &mesh.primitives {
                    let deformation = Deformation { weights, skin: skin.as_ref() };
                    match read_primitive(reader, primitive, &deformation, materials.as_ref(), &mut problem)? {
                        Some(part) => parts.push(part),
                        None => skipped += 1,
                    }
                }
                parts
            }
        };
        let copies = match &node.extensions.instancing {
            Some(instances) => {
                instances.transforms(reader)?.into_iter().map(|node_from_copy| *transform * node_from_copy).collect()
            }
            // A skin has the joints' places in the scene already.
            None if skin.is_some() => vec![DMat4::IDENTITY],
            None => vec![*transform],
        };
        copies_of[mesh_index] += copies.len();
        for copy in copies {
            // Instances of a mesh without triangles are not bounded by the limit on vertices.
            reader.spend(mesh.primitives.len())?;
            for part in &parts {
                builder.append(part, &copy)?;
            }
        }
        if is_shared {
            *slot = Some(parts);
        }
    }
    if builder.vertex_count() == 0 {
        document.refuse_gaussians()?;
        return Err(Error::new(
            ErrorCode::EmptyMesh,
            "mesh",
            format!(
                "{} nodes, {} meshes, {skipped} parts of points, lines or nothing",
                document.nodes.len(),
                document.meshes.len()
            ),
            "triangles in the default scene",
            "A point cloud can't be rendered: mesh it first.",
        ));
    }
    let painted = builder.finish()?;
    // One mesh is an object, several are its parts.
    copies_of.retain(|count| *count > 0);
    let copies = match copies_of[..] {
        [count] if count > 1 => count,
        _ => 0,
    };
    let read = match materials.filter(|_| problem.is_none()) {
        Some(materials) => {
            let loaded = materials.load(&painted.paint.used_materials(), reader);
            painted.colored(loaded)
        }
        None => painted.plain(problem),
    };
    Ok(ColoredMesh { copies, unread: document.unread(), ..read })
}

/// The nodes of the scene that are shown, from the roots on, and scene_from_node of all; `None` for nodes outside the scene.
fn placed(document: &Document) -> Result<(Vec<usize>, Vec<Option<DMat4>>)> {
    let mut stack: Vec<_> = roots(document)?.into_iter().map(|node| (node, DMat4::IDENTITY, true)).collect();
    stack.reverse();
    let mut scene_from_node = vec![None; document.nodes.len()];
    let mut order = Vec::new();
    while let Some((index, scene_from_parent, is_shown)) = stack.pop() {
        let (Some(node), Some(place)) = (document.nodes.get(index), scene_from_node.get_mut(index)) else {
            return Err(missing("node", index, document.nodes.len()));
        };
        let transform = scene_from_parent * parent_from_node(node)?;
        if place.replace(transform).is_some() {
            let found = format!("node {index} twice in the hierarchy");
            return Err(corrupt("mesh", found, "a tree: each node below one parent, and no cycle"));
        }
        let is_shown = is_shown && node.extensions.visibility.as_ref().is_none_or(|node| node.visible);
        if is_shown {
            order.push(index);
        }
        stack.extend(node.children.iter().rev().map(|&child| (child, transform, is_shown)));
    }
    Ok((order, scene_from_node))
}

fn roots(document: &Document) -> Result<Vec<usize>> {
    if !document.scenes.is_empty() || document.scene.is_some() {
        let index = document.scene.unwrap_or(0);
        let scene = document.scenes.get(index).ok_or_else(|| missing("scene", index, document.scenes.len()))?;
        return Ok(scene.nodes.clone());
    }
    let mut is_root = vec![true; document.nodes.len()];
    for &child in document.nodes.iter().flat_map(|node| &node.children) {
        if let Some(is_root) = is_root.get_mut(child) {
            *is_root = false;
        }
    }
    Ok(is_root.iter().enumerate().filter(|(_, is_root)| **is_root).map(|(i, _)| i).collect())
}

fn parent_from_node(node: &Node) -> Result<DMat4> {
    if !node.matrix.is_empty() {
        return Ok(DMat4::from_cols_array(&numbers(&node.matrix, [0.0; 16])?));
    }
    let rotation = unit(numbers(&node.rotation, [0.0, 0.0, 0.0, 1.0])?);
    let scale = DVec3::from_array(numbers(&node.scale, [1.0; 3])?);
    let translation = DVec3::from_array(numbers(&node.translation, [0.0; 3])?);
    Ok(DMat4::from_scale_rotation_translation(scale, rotation, translation))
}

/// The numbers of a property, or its default.
fn numbers<const N: usize>(stored: &[f32], default: [f64; N]) -> Result<[f64; N]> {
    if stored.is_empty() {
        return Ok(default);
    }
    let numbers = <[f32; N]>::try_from(stored).map(|numbers| numbers.map(f64::from));
    numbers.map_err(|_| corrupt("mesh", format!("{} numbers in a transform", stored.len()), format!("{N}")))
}

/// The deformation of a primitive: weights of its morph targets, then a skin.
struct Deformation<'a> {
    weights: &'a [f32],
    skin: Option<&'a Skin>,
}

impl Deformation<'_> {
    fn apply(&self, positions: &mut [Vec3], primitive: &Primitive, reader: &mut AccessorReader<'_>) -> Result<()> {
        for (target, &weight) in primitive.targets.iter().zip(self.weights) {
            let Some(&accessor) = target.get("POSITION").filter(|_| weight != 0.0) else { continue };
            let offsets = reader.positions(accessor)?;
            if offsets.len() != positions.len() {
                let found = format!("a morph target of {} elements for {} vertices", offsets.len(), positions.len());
                return Err(corrupt("mesh", found, "one per vertex"));
            }
            positions.iter_mut().zip(offsets).for_each(|(position, offset)| *position += weight * offset);
        }
        self.skin.map_or(Ok(()), |skin| skin.apply(positions, primitive, reader))
    }
}

/// The triangles of a primitive in its mesh's frame, those of a skin in the scene's frame; `None` for points, lines and empty ones. `problem` is set if its
/// colours can't be read.
fn read_primitive(
    reader: &mut AccessorReader<'_>,
    primitive: &Primitive,
    deformation: &Deformation<'_>,
    materials: Option<&Materials>,
    problem: &mut Option<Error>,
) -> Result<Option<PaintedMesh>> {
    let mode = primitive.mode.unwrap_or(TRIANGLES);
    if mode > TRIANGLE_FAN {
        return Err(corrupt("mesh", "a primitive of an unknown mode", "0 to 6"));
    }
    if mode < TRIANGLES {
        return Ok(None);
    }
    let Some(&positions) = primitive.attributes.get("POSITION") else {
        reader.document.refuse_draco()?;
        return Ok(None);
    };
    for accessor in primitive.indices.iter().chain([&positions]) {
        let accessor = reader.document.accessors.get(*accessor);
        if accessor.is_some_and(|accessor| accessor.buffer_view.is_none() && accessor.sparse.is_none()) {
            reader.document.refuse_draco()?;
        }
    }
    let mut positions = reader.positions(positions)?;
    deformation.apply(&mut positions, primitive, reader)?;
    let corners = match primitive.indices {
        Some(indices) => reader.indices(indices)?,
        None => (0..positions.len() as u32).collect(),
    };
    let mut builder = MeshBuilder::with_positions(positions);
    builder.use_material(primitive.material);
    match mode {
        TRIANGLE_STRIP => builder.push_strip(&corners)?,
        TRIANGLE_FAN => builder.push_fan(&corners)?,
        _ => {
            let (triangles, rest) = corners.as_chunks::<3>();
            if !rest.is_empty() {
                let found = format!("{} indices of a triangle list", corners.len());
                return Err(corrupt("mesh", found, "a multiple of 3"));
            }
            triangles.iter().try_for_each(|&triangle| builder.push_triangle(triangle))?;
        }
    }
    if builder.triangle_count() == 0 {
        return Ok(None);
    }
    if let Some(materials) = materials
        && problem.is_none()
    {
        *problem = paint(&mut builder, reader, primitive, materials).err();
    }
    builder.finish().map(Some)
}

/// Reads the vertex colours and texture coordinates of a primitive whose triangles have been read.
fn paint(
    builder: &mut MeshBuilder,
    reader: &mut AccessorReader<'_>,
    primitive: &Primitive,
    materials: &Materials,
) -> Result<()> {
    let check = |name: &str, count: usize, builder: &MeshBuilder| {
        let vertices = builder.vertex_count();
        let found = || format!("{name} of {count} elements for {vertices} vertices");
        if count == vertices { Ok(()) } else { Err(corrupt("mesh", found(), "one per vertex")) }
    };
    if let Some(&accessor) = primitive.attributes.get("COLOR_0") {
        let colors = reader.colors(accessor)?;
        check("COLOR_0", colors.len(), builder)?;
        builder.color_vertices(colors);
    }
    if let Some(texture) = materials.texture_of(primitive.material) {
        let set = texture.coordinate_set();
        let Some(&accessor) = primitive.attributes.get(&format!("TEXCOORD_{set}")) else {
            return Err(corrupt("mesh", format!("a textured part without TEXCOORD_{set}"), "texture coordinates"));
        };
        let mut coordinates = reader.coordinates(accessor)?;
        check("texture coordinates", coordinates.len(), builder)?;
        texture.transform_coordinates(&mut coordinates);
        builder.map_vertices(&coordinates);
    }
    Ok(())
}
