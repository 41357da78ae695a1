//! A street of simple bodies that rays are cast against: metres, z up, the ground at z = 0.

use crate::prelude::*;

/// Random stream of houses, cars and trees.
const STREET_STREAM: u64 = 0x7374_7265;

/// What a ray can hit.
#[derive(Debug, Clone, Copy)]
pub enum Body {
    /// A box turned about the vertical.
    Block {
        /// Its middle.
        center: DVec3,
        /// Half its edges.
        half: DVec3,
        /// Cosine and sine of its turn.
        turn: DVec2,
    },
    /// An upright cylinder.
    Post {
        /// Its middle.
        center: DVec3,
        /// Radius.
        radius: f64,
        /// Half its height.
        half_height: f64,
    },
    /// Foliage, which a ray goes through for a while.
    Crown {
        /// Its middle.
        center: DVec3,
        /// Half its axes.
        radii: DVec3,
    },
}

impl Body {
    /// Where the body is.
    pub fn center(&self) -> DVec3 {
        match self {
            Self::Block { center, .. } | Self::Post { center, .. } | Self::Crown { center, .. } => *center,
        }
    }

    /// How far it reaches from there.
    pub fn reach(&self) -> f64 {
        match self {
            Self::Block { half, .. } => half.length(),
            Self::Post { radius, half_height, .. } => radius + half_height,
            Self::Crown { radii, .. } => radii.max_element(),
        }
    }

    /// How far along a ray of unit direction the body begins, and how far it goes on.
    pub fn hit(&self, origin: DVec3, direction: DVec3) -> Option<[f64; 2]> {
        let from = origin - self.center();
        let (near, far) = match self {
            Self::Block { half, turn, .. } => {
                let own = |v: DVec3| DVec3::new(turn.x * v.x + turn.y * v.y, turn.x * v.y - turn.y * v.x, v.z);
                let (o, d) = (own(from), own(direction));
                let (a, b) = ((-half - o) / d, (half - o) / d);
                (a.min(b).max_element(), a.max(b).min_element())
            }
            Self::Post { radius, half_height, .. } => {
                let (o, d) = (from.truncate(), direction.truncate());
                let (near, far) = roots(d.length_squared(), o.dot(d), o.length_squared() - radius * radius)?;
                let (low, high) = ((-half_height - from.z) / direction.z, (half_height - from.z) / direction.z);
                (near.max(low.min(high)), far.min(low.max(high)))
            }
            Self::Crown { radii, .. } => {
                let (o, d) = (from / *radii, direction / *radii);
                roots(d.length_squared(), o.dot(d), o.length_squared() - 1.0)?
            }
        };
        (near > 0.0 && near < far).then_some([near, far])
    }
}

/// Roots of a x² + 2 b x + c.
fn roots(a: f64, b: f64, c: f64) -> Option<(f64, f64)> {
    let root = b * b - a * c;
    (root > 0.0 && a > 0.0).then(|| ((-b - root.sqrt()) / a, (-b + root.sqrt()) / a))
}

/// A street with a bend, and a car's way along its middle.
#[derive(Debug, Clone)]
pub struct Street {
    /// What stands still.
    pub bodies: Vec<Body>,
    /// Length before the bend, and the bend's radius and sense.
    straight: f64,
    radius: f64,
    sense: f64,
}

/// Where the street goes on after the bend, as a share of a turn.
const BEND: f64 = FRAC_PI_2;

impl Street {
    /// The street of a seed, for a drive of this length.
    pub fn new(seed: u64, length: f64) -> Self {
        let random = &mut Random::new(seed, STREET_STREAM);
        let mut street = Self {
            bodies: Vec::new(),
            straight: between(random, 0.3, 0.9) * length,
            radius: between(random, 12.0, 20.0),
            sense: sign(random),
        };
        for side in [-1.0, 1.0] {
            street.facades(random, side, length);
            street.beside(random, side, length);
        }
        street
    }

    /// Place and heading after this way.
    pub fn pose(&self, way: f64) -> (DVec2, f64) {
        let along = (way - self.straight).max(0.0);
        let angle = (along / self.radius).min(BEND);
        let (sine, cosine) = libm::sincos(angle);
        let after = (along - BEND * self.radius).max(0.0);
        let x = way.min(self.straight) + self.radius * sine + after * cosine;
        let y = self.radius * (1.0 - cosine) + after * sine;
        (DVec2::new(x, self.sense * y), self.sense * angle)
    }

    /// A point beside the way, to its left.
    fn beside_at(&self, way: f64, left: f64) -> (DVec2, f64) {
        let (at, heading) = self.pose(way);
        let (sine, cosine) = libm::sincos(heading);
        (at + left * DVec2::new(-sine, cosine), heading)
    }

    /// Adds a body unless it stands in the way.
    fn add(&mut self, body: Body) {
        let (center, reach) = (body.center(), body.reach());
        let mut way = -60.0;
        while way < 200.0 && center.z - reach < 3.0 {
            if self.pose(way).0.distance(center.truncate()) < 2.2 + reach.min(2.6) {
                return;
            }
            way += 2.0;
        }
        self.bodies.push(body);
    }

    fn block(&mut self, (at, turn): (DVec2, f64), low: f64, size: DVec3) {
        let half = 0.5 * size;
        let (sine, cosine) = libm::sincos(turn);
        self.add(Body::Block { center: at.extend(low + half.z), half, turn: DVec2::new(cosine, sine) });
    }

    fn facades(&mut self, random: &mut Random, side: f64, length: f64) {
        let mut way = -60.0;
        while way < length + 60.0 {
            let size = DVec3::new(between(random, 6.0, 16.0), between(random, 6.0, 10.0), between(random, 3.5, 14.0));
            let set_back = between(random, 7.5, 13.0);
            let middle = way + 0.5 * size.x;
            self.block(self.beside_at(middle, side * (set_back + 0.5 * size.y)), 0.0, size);
            // Bays, balconies, steps and doors.
            for _ in 0..random.below(7) + 3 {
                let part = DVec3::new(between(random, 0.6, 2.5), between(random, 0.3, 1.2), between(random, 0.2, 2.2));
                let (along, low) = (between(random, -0.45, 0.45) * size.x, between(random, 0.0, size.z - 1.0));
                self.block(self.beside_at(middle + along, side * set_back), low, part);
            }
            way += size.x + if chance(random, 0.35) { between(random, 3.0, 12.0) } else { 0.0 };
        }
    }

    /// Cars, poles, trees, hedges, bins and walkways.
    fn beside(&mut self, random: &mut Random, side: f64, length: f64) {
        let mut way = -60.0;
        while way < length + 60.0 {
            self.block(self.beside_at(way, side * 6.3), 0.0, DVec3::new(4.0, 2.6, 0.14));
            way += 4.0;
        }
        way = -60.0;
        while way < length + 60.0 {
            let jitter = between(random, -0.15, 0.15);
            let place = |street: &Self, left: f64| {
                let (at, heading) = street.beside_at(way, side * left);
                (at, heading + jitter)
            };
            match random.below(10) {
                0..=3 => {
                    let at = place(self, 3.9);
                    let tall = if chance(random, 0.2) { 2.0 } else { 1.0 };
                    let length = between(random, 3.8, 4.8);
                    self.block(at, 0.25, DVec3::new(length, 1.75, 0.6 * tall));
                    self.block(at, 0.25 + 0.6 * tall, DVec3::new(0.55 * length, 1.55, 0.55 * tall));
                }
                4 | 5 => {
                    let (at, _) = place(self, between(random, 5.2, 6.8));
                    let height = between(random, 2.2, 7.0);
                    let radius = between(random, 0.05, 0.16);
                    self.add(Body::Post { center: at.extend(0.5 * height), radius, half_height: 0.5 * height });
                    if chance(random, 0.5) {
                        self.block(place(self, 6.0), height - 0.8, DVec3::new(0.08, 0.7, 0.7));
                    }
                }
                6 | 7 => {
                    let (at, _) = place(self, between(random, 5.5, 7.2));
                    let trunk = between(random, 1.6, 3.2);
                    let radii =
                        DVec3::new(between(random, 1.0, 2.6), between(random, 1.0, 2.6), between(random, 1.0, 2.4));
                    let radius = between(random, 0.1, 0.3);
                    self.add(Body::Post { center: at.extend(0.6 * trunk), radius, half_height: 0.6 * trunk });
                    self.add(Body::Crown { center: at.extend(trunk + 0.8 * radii.z), radii });
                }
                8 => {
                    let size = DVec3::new(between(random, 2.0, 6.0), 0.5, between(random, 0.8, 1.6));
                    self.block(place(self, 7.0), 0.0, size);
                }
                _ => {
                    let size =
                        DVec3::new(between(random, 0.5, 1.6), between(random, 0.4, 1.0), between(random, 0.8, 1.8));
                    self.block(place(self, between(random, 5.3, 6.5)), 0.14, size);
                }
            }
            way += between(random, 3.0, 8.0);
        }
    }

    /// Cars that drive: where they are in the frame of this number.
    pub fn moving(&self, seed: u64, frame: u32) -> Vec<Body> {
        let random = &mut Random::new(seed ^ TAU.to_bits(), STREET_STREAM);
        let car = |_| {
            let lane = sign(random);
            let way = between(random, -40.0, 120.0) - lane * between(random, 2.0, 7.0) * f64::from(frame);
            let (at, heading) = self.beside_at(way, 1.6 * lane - 0.9);
            let (sine, cosine) = libm::sincos(heading);
            let half = DVec3::new(2.1, 0.85, 0.7);
            Body::Block { center: at.extend(0.95), half, turn: DVec2::new(cosine, sine) }
        };
        (0..4).map(car).collect()
    }
}
