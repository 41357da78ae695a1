//! Contact: what rests on what, and by how much it misses or enters it.

use serde::{Serialize, Serializer};

use super::layers::volumes;
use super::placement::Body;
use super::plane::Plane;
use super::support::{Ground, RestsOn};
use crate::geometry::pinhole::Pinhole;

/// The support of an object, and the volume that it shares with others.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "types", derive(ts_rs::TS))]
#[serde(rename_all = "camelCase")]
pub struct Contact {
    /// Its support: `"support"`, the index of another object, `"level"` for a level surface at another height that
    /// the depth map shows, such as a shelf or a box without a mesh, or `null` if it touches none of them.
    #[cfg_attr(feature = "types", ts(type = "\"support\" | \"level\" | number | null"))]
    #[serde(serialize_with = "by_name")]
    pub rests_on: Option<RestsOn>,
    /// Height of its lowest point over what is below it, in metres; negative where it enters it. `null` without a
    /// support.
    pub gap_m: Option<f64>,
    /// Share of its volume that is inside other objects, 0 to 1.
    pub shared_volume: f64,
    /// How far `snap` has moved it along the normal of the support, in metres.
    pub snapped_m: f64,
}

fn by_name<S: Serializer>(rests_on: &Option<RestsOn>, serializer: S) -> Result<S::Ok, S::Error> {
    match rests_on {
        None => serializer.serialize_none(),
        Some(RestsOn::Support) => serializer.serialize_str("support"),
        Some(RestsOn::Level) => serializer.serialize_str("level"),
        Some(RestsOn::Object(index)) => serializer.serialize_u32(*index as u32),
    }
}

/// Largest gap of an object that touches what is below it: metres, and relative to its size.
const TOUCHES: [f64; 2] = [0.008, 0.03];

/// The contacts of posed objects. `grounds` are those that their search has used: they decide whether an object touches what
/// is below it. Gaps are those to the support itself, or to the top of the object below. With `snap`, what touches
/// something is put exactly onto it.
pub fn contacts(
    bodies: &[Option<Body>],
    grounds: &[Option<Ground>],
    support: Option<&Plane>,
    camera: &Pinhole,
    snap: bool,
) -> Vec<Option<Contact>> {
    let mut shifts = vec![0.0; bodies.len()];
    let mut contacts: Vec<Option<Contact>> = vec![None; bodies.len()];
    // From below, and what carries before what it carries, which moves with it. Of two that carry each other, the lower one.
    let mut order: Vec<usize> = Vec::new();
    let low = |i: &usize| {
        let known = bodies[*i].as_ref().zip(grounds[*i].as_ref());
        // Over the support itself: the ground of what is on top is raised.
        known.map_or(0.0, |(body, ground)| heights(body, &ground.plane)[0] - ground.plane.d)
    };
    for i in 0..bodies.len() {
        let place = order.iter().position(|k| low(k) > low(&i)).unwrap_or(order.len());
        order.insert(place, i);
    }
    let waits = |i: &usize, order: &[usize]| {
        let ground = grounds.get(*i).and_then(Option::as_ref);
        ground.is_some_and(|ground| matches!(ground.on, RestsOn::Object(k) if k != *i && order.contains(&k)))
    };
    while !order.is_empty() {
        let i = order.remove(order.iter().position(|i| !waits(i, &order)).unwrap_or(0));
        let Some(body) = &bodies[i] else { continue };
        let mut contact =
            Contact { rests_on: None, gap_m: None, shared_volume: shared(i, bodies, camera), snapped_m: 0.0 };
        if let Some((ground, support)) = grounds.get(i).copied().flatten().zip(support) {
            let low = heights(body, support)[0];
            let gap = match ground.on {
                RestsOn::Support => low,
                RestsOn::Level => heights(body, &ground.plane)[0],
                RestsOn::Object(k) => {
                    low - bodies[k].as_ref().map_or(0.0, |below| heights(below, support)[1] + shifts[k])
                }
            };
            let seen = if ground.on == RestsOn::Support { heights(body, &ground.plane)[0] } else { gap };
            if seen.abs() <= TOUCHES[0] + TOUCHES[1] * body.diameter() {
                contact.rests_on = Some(ground.on);
                if snap {
                    shifts[i] = -gap;
                    contact.snapped_m = -gap;
                }
            }
            contact.gap_m = Some(gap + contact.snapped_m);
        }
        contacts[i] = Some(contact);
    }
    contacts
}

/// The lowest and the highest point of a body over a plane.
fn heights(body: &Body, plane: &Plane) -> [f64; 2] {
    body.along.map_or_else(|| body.extent(plane), |along| along.map(|h| h + plane.d))
}

/// The share of the volume of an object that is inside others.
fn shared(i: usize, bodies: &[Option<Body>], camera: &Pinhole) -> f64 {
    let Some(body) = &bodies[i] else { return 0.0 };
    let (mut own, mut inside) = (0.0, 0.0);
    for (k, other) in bodies.iter().enumerate() {
        if let Some(other) = other.as_ref().filter(|_| k != i) {
            let [volume, shared] = volumes(&body.layer, &other.layer, camera);
            own = volume;
            inside += shared;
        }
    }
    if own > 0.0 { (inside / own).min(1.0) } else { 0.0 }
}
