//! Bodies of everyday things: mass, centre and parts next to exact values.

use core::f64::consts::TAU;
use glam::{DVec3, Vec3};
use sim3align_geometry::mesh::Mesh;
use sim3align_physics::body::Body;
use sim3align_physics::part::convex_parts;
use sim3align_physics::solid::Solid;
use wasm_bindgen_test::wasm_bindgen_test;

use crate::solids::{Draw, cuboid, is_near, moved, outside, together, tray};

const DENSITY: f64 = 500.0;
const SIDES: usize = 48;

fn body(mesh: &Mesh) -> Body {
    Body::new(mesh, &moved(0.0, 0.0, 0.0), 16, DENSITY)
}

/// A surface of revolution about z: a profile of radii and heights that begins and ends on the axis.
fn revolved(profile: &[[f64; 2]]) -> Mesh {
    let mut positions = Vec::new();
    let mut triangles = Vec::new();
    for k in 0..SIDES {
        let (sine, cosine) = libm::sincos(TAU * k as f64 / SIDES as f64);
        positions.extend(profile.iter().map(|[r, z]| DVec3::new(r * cosine, r * sine, *z).as_vec3()));
    }
    let at = |k: usize, i: usize| ((k % SIDES) * profile.len() + i) as u32;
    for k in 0..SIDES {
        for i in 1..profile.len() {
            let [a, b, c, d] = [at(k, i - 1), at(k + 1, i - 1), at(k + 1, i), at(k, i)];
            if profile[i - 1][0] > 0.0 {
                triangles.push([a, b, c]);
            }
            if profile[i][0] > 0.0 {
                triangles.push([a, c, d]);
            }
        }
    }
    Mesh::new(positions, triangles).unwrap()
}

/// The volume of a cylinder of as many sides.
fn cylinder(radius: f64, height: f64) -> f64 {
    0.5 * SIDES as f64 * libm::sin(TAU / SIDES as f64) * radius * radius * height
}

/// A cup with a wall and a bottom of one thickness, and its volume.
fn cup(radius: f64, height: f64, wall: f64) -> (Mesh, f64) {
    let inner = radius - wall;
    let profile = [[0.0, 0.0], [radius, 0.0], [radius, height], [inner, height], [inner, wall], [0.0, wall]];
    (revolved(&profile), cylinder(radius, height) - cylinder(inner, height - wall))
}

#[wasm_bindgen_test]
fn sheets_boxes_and_discs_have_their_mass_centre_and_one_part() {
    let boxes = [
        [0.21, 0.297, 0.0002],
        [0.0856, 0.054, 0.00076],
        [0.21, 0.297, 0.003],
        [1.2, 0.8, 0.02],
        [0.4, 0.25, 0.01],
        [0.155, 0.075, 0.008],
        [0.25, 0.175, 0.006],
        [1.0, 0.6, 0.015],
        [0.3, 0.3, 0.3],
        [0.05, 0.05, 0.5],
        [0.2, 0.1, 0.05],
        [0.01, 0.01, 0.01],
    ];
    for size in boxes {
        for turned in 0..3 {
            let sides = [size[turned], size[(turned + 1) % 3], size[(turned + 2) % 3]];
            let high = DVec3::from_array(sides);
            let found = body(&cuboid(Vec3::ZERO, high.as_vec3()));
            let exact = DENSITY * high.element_product();
            assert!(is_near(found.mass.mass, exact, 1e-3), "{sides:?}: {} and {exact} kg", found.mass.mass);
            assert!(
                (found.mass.center - 0.5 * high).length() < 1e-3 * high.length(),
                "{sides:?}: {}",
                found.mass.center
            );
            assert_eq!(found.parts.len(), 1, "{sides:?}");
            let volume = found.parts[0].volume();
            assert!(is_near(volume, high.element_product(), 1e-2), "{sides:?}: a part of {volume} m³");
        }
    }
    for [radius, height] in [[0.11, 0.002], [0.06, 0.0012], [0.04, 0.12], [0.3, 0.02], [0.03, 0.1], [0.25, 0.0005]] {
        let profile = [[0.0, 0.0], [radius, 0.0], [radius, height], [0.0, height]];
        let found = body(&revolved(&profile));
        let exact = DENSITY * cylinder(radius, height);
        assert!(is_near(found.mass.mass, exact, 1e-3), "disc {radius} × {height}: {} and {exact} kg", found.mass.mass);
        assert_eq!(found.parts.len(), 1, "disc {radius} × {height}");
    }
}

#[wasm_bindgen_test]
fn vessels_have_the_mass_of_their_walls() {
    for (what, [radius, height, wall]) in [("mug", [0.04, 0.1, 0.004]), ("tin", [0.05, 0.11, 0.0005])] {
        let (mesh, volume) = cup(radius, height, wall);
        let found = body(&mesh);
        assert!(is_near(found.mass.mass, DENSITY * volume, 1e-3), "{what}: {} and {volume} m³", found.mass.mass);
        assert!(found.mass.center.truncate().length() < 1e-3 * radius, "{what}: {}", found.mass.center);
        assert!(found.parts.len() > 1, "{what} is hollow");
    }
    let (mesh, volume) = tray();
    let found = body(&mesh);
    assert!(is_near(found.mass.mass, DENSITY * volume, 1e-3), "tray: {} and {volume} m³", found.mass.mass);
    assert!((found.mass.center.truncate() - DVec3::splat(0.1).truncate()).length() < 0.001, "{}", found.mass.center);
}

#[wasm_bindgen_test]
fn only_meshes_that_enclose_a_volume_once_are_solids() {
    let unit = || cuboid(Vec3::ZERO, Vec3::ONE);
    let flipped = |mesh: &Mesh| {
        let triangles = mesh.triangles().iter().map(|[a, b, c]| [*a, *c, *b]).collect();
        Mesh::new(mesh.positions().to_vec(), triangles).unwrap()
    };
    let inner = cuboid(Vec3::splat(0.25), Vec3::splat(0.75));
    let apart = cuboid(Vec3::splat(2.0), Vec3::splat(3.0));
    let open = Mesh::new(unit().positions().to_vec(), unit().triangles()[2..].to_vec()).unwrap();
    let solids: [(&str, Mesh, Option<f64>); 8] = [
        ("a box", unit(), Some(1.0)),
        ("inside out", flipped(&unit()), Some(1.0)),
        ("two boxes", together(&[unit(), apart]), Some(2.0)),
        ("a cavity", together(&[unit(), flipped(&inner)]), Some(0.875)),
        ("one in another", together(&[unit(), inner]), None),
        ("overlapping", together(&[unit(), cuboid(Vec3::splat(0.5), Vec3::splat(1.5))]), None),
        ("from both sides", together(&[unit(), flipped(&unit())]), None),
        ("open", open, None),
    ];
    for (what, mesh, volume) in solids {
        let found = Solid::of(&mesh).map(|solid| solid.volume);
        assert_eq!(found.is_some(), volume.is_some(), "{what}: {found:?}");
        assert!(found.zip(volume).is_none_or(|(found, exact)| is_near(found, exact, 1e-6)), "{what}: {found:?}");
    }
}

#[wasm_bindgen_test]
fn walls_without_thickness_have_parts() {
    let crate_of = |[x, y, z]: [f32; 3], finer: u32| {
        let whole = cuboid(Vec3::ZERO, Vec3::new(x, y, z));
        // Without its top: the triangles whose corners are all up there.
        let is_top = |t: &[u32; 3]| t.iter().all(|i| whole.positions()[*i as usize].z > 0.5 * z);
        let sides = whole.triangles().iter().copied().filter(|t| !is_top(t)).collect();
        (0..finer).fold(Mesh::new(whole.positions().to_vec(), sides).unwrap(), |mesh, _| subdivided(&mesh))
    };
    let sides = [[0.4, 0.25, 0.3], [0.1, 0.1, 0.1], [0.3, 0.25, 0.25], [0.5, 0.4, 0.12]];
    for (sides, finer) in sides.into_iter().flat_map(|sides| [(sides, 0), (sides, 3)]) {
        let mesh = crate_of(sides, finer);
        let parts = convex_parts(&mesh, None, 16);
        let cell = mesh.diagonal() / 64.0;
        let (mut near, mut count) = (0, 0);
        for triangle in mesh.triangles() {
            let [a, b, c] = triangle.map(|i| mesh.positions()[i as usize].as_dvec3());
            for k in 0..4000 / mesh.triangles().len() {
                let (u, v) = ((k as f64 * 0.618_034).fract(), (k as f64 * 0.754_878).fract());
                let (u, v) = if u + v > 1.0 { (1.0 - u, 1.0 - v) } else { (u, v) };
                let p = a + u * (b - a) + v * (c - a);
                near += usize::from(parts.iter().any(|part| outside(part, p) < cell));
                count += 1;
            }
        }
        assert!(
            near as f64 > 0.95 * count as f64,
            "{sides:?}, finer {finer}: {near} of {count}, {} parts",
            parts.len()
        );
        let size = Vec3::from_array(sides).as_dvec3();
        let mut draw = Draw::new(7);
        let inner = (0..500).map(|_| size * draw.vector(0.1, 0.9));
        let joined = |most| Body::new(&mesh, &moved(0.0, 0.0, 0.0), most, DENSITY).walls_joined;
        assert_eq!([joined(5), joined(4), joined(1)], [None, Some(5), Some(5)], "{sides:?}, finer {finer}");
        let filled = inner.filter(|p| parts.iter().any(|part| outside(part, *p) == 0.0)).count();
        assert!(filled <= 10, "{sides:?}, finer {finer}: {filled} of 500 points inside are in parts");
    }
}

/// Each triangle as four.
fn subdivided(mesh: &Mesh) -> Mesh {
    let mut positions = mesh.positions().to_vec();
    let mut triangles = Vec::new();
    for &[a, b, c] in mesh.triangles() {
        let mut middle = |i: u32, j: u32| {
            positions.push(0.5 * (mesh.positions()[i as usize] + mesh.positions()[j as usize]));
            (positions.len() - 1) as u32
        };
        let [ab, bc, ca] = [middle(a, b), middle(b, c), middle(c, a)];
        triangles.extend([[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]);
    }
    Mesh::new(positions, triangles).unwrap()
}
