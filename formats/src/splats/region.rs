//! The part of space that the opaque Gaussians of an object take, without floaters, and its lattice.

use glam::Vec3;

use super::gaussian::Gaussian;
use super::lattice::{Lattice, clear_light_regions};
use sim3align_geometry::cloud::Bounds;
use sim3align_geometry::surface::DIAGONALS;
use sim3align_geometry::surface_colors::Rgb;
use sim3align_runtime::error::{Error, ErrorCode, Result};
use sim3align_runtime::number::number;

/// Opacity below which a Gaussian is not part of a surface.
const MIN_OPACITY: f32 = 0.1;

/// Density of a surface: half of what an opaque Gaussian has in its centre. Transparent ones reach it only together.
pub(super) const LEVEL: f32 = 0.5;

/// Share of the opacity of all below which a separate group of Gaussians is a floater.
pub(super) const FLOATER: f64 = 0.01;

/// Nodes along the longest side of the lattice, at most; its spacing is then 0.8 % of that side.
const MAX_NODES: f32 = 128.0;
const MIN_NODES: f32 = 24.0;

/// Cells along the longest side in the search for floaters, at most, and rounds of it. Floaters may be so far away that the
/// object is in one cell.
const MAX_CELLS: f32 = 64.0;
const MAX_ROUNDS: usize = 16;

/// Largest standard deviation, in spacings of the lattice, and the number of nodes that all Gaussians together may reach.
const MAX_DEVIATION: f32 = 12.0;
const MAX_REACHED: f64 = 6e7;

/// Standard deviation, in spacings, by which Gaussians are widened so that neighbours overlap, and standard deviations
/// that they then reach.
pub(super) const WIDENING: f32 = 0.75;
pub(super) const REACH: f32 = 2.0;

/// A Gaussian in the coordinates of a lattice.
#[derive(Debug, Clone)]
pub(super) struct Blob {
    pub center: Vec3,
    /// Upper triangle of the covariance: xx, xy, xz, yy, yz, zz.
    pub covariance: [f32; 6],
    pub opacity: f32,
    pub color: Rgb,
}

/// The opaque Gaussians without floaters, and a lattice around them. `None` if there are none.
///
/// # Errors
/// [`ErrorCode::DegenerateMesh`] for Gaussians that have no extent, or none that is finite.
pub(super) fn blobs_of(mut gaussians: Vec<Gaussian>) -> Result<Option<(Lattice, Vec<Blob>)>> {
    gaussians.retain(|gaussian| gaussian.opacity >= MIN_OPACITY);
    let mut side = 0.0;
    for round in 0..MAX_ROUNDS {
        let centers: Vec<Vec3> = gaussians.iter().map(|gaussian| gaussian.center).collect();
        let Some(bounds) = Bounds::of(&centers) else { return Ok(None) };
        let last = side;
        side = bounds.extent().max_element();
        if side == 0.0 {
            // All in one place.
            side = gaussians.iter().map(|gaussian| gaussian.scales.max_element()).fold(f32::INFINITY, f32::min);
        }
        let farthest = bounds.max.abs().max(bounds.min.abs()).max_element();
        if !((DIAGONALS[0]..=DIAGONALS[1]).contains(&f64::from(side)) && farthest < side * 1e6) {
            return Err(Error::new(
                ErrorCode::DegenerateMesh,
                "mesh",
                format!("Gaussians in a box with a longest side of {}", number(f64::from(side))),
                "an object with an extent that 32-bit numbers can hold",
                "Move the splat to the origin, and scale it to any usual unit, such as metres.",
            ));
        }
        if round > 0 && side > 0.9 * last {
            break;
        }
        // About nine Gaussians for each cell of a surface.
        let cells = (gaussians.len() as f32 / 27.0).sqrt().clamp(4.0, MAX_CELLS);
        drop_floaters(&mut gaussians, &Lattice::new(bounds.min, bounds.max, side / cells));
    }
    if gaussians.is_empty() {
        return Ok(None);
    }
    // A Gaussian for two cells of a surface, or more.
    let spacing = side / (gaussians.len() as f32 / 2.0).sqrt().clamp(MIN_NODES, MAX_NODES);
    Ok(Some(lattice_of(&gaussians, spacing)))
}

/// Keeps the Gaussians in, or next to, connected groups of opaque cells that are no floaters.
fn drop_floaters(gaussians: &mut Vec<Gaussian>, cells: &Lattice) {
    let mut opacities = vec![0.0; cells.len()];
    let cell = |gaussian: &Gaussian| cells.nearest(cells.coordinates(gaussian.center));
    gaussians.iter().for_each(|gaussian| opacities[cell(gaussian)] += gaussian.opacity);
    let mut kept: Vec<bool> = opacities.iter().map(|opacity| *opacity >= LEVEL).collect();
    clear_light_regions(&mut kept, &opacities, &cells.corners(), FLOATER);
    let kept = cells.dilated(&kept);
    gaussians.retain(|gaussian| kept[cell(gaussian)]);
}

/// A lattice that holds these Gaussians, and them in its coordinates.
fn lattice_of(gaussians: &[Gaussian], spacing: f32) -> (Lattice, Vec<Blob>) {
    let reaches = |most: f32| {
        gaussians.iter().map(move |gaussian| {
            let [xx, _, _, yy, _, zz] = gaussian.covariance(1.0 / spacing, most);
            Vec3::from_array([xx, yy, zz].map(|variance| REACH * (variance + WIDENING * WIDENING).sqrt()))
        })
    };
    let mut most = MAX_DEVIATION;
    while most > WIDENING && reaches(most).map(|r| 8.0 * f64::from(r.x * r.y * r.z)).sum::<f64>() > MAX_REACHED {
        most *= 0.8;
    }
    let mut bounds = Bounds::NOTHING;
    for (gaussian, reach) in gaussians.iter().zip(reaches(most)) {
        let reach = reach * spacing;
        bounds = bounds.union(Bounds { min: gaussian.center - reach, max: gaussian.center + reach });
    }
    let lattice = Lattice::new(bounds.min, bounds.max, spacing);
    let blob = |gaussian: &Gaussian| Blob {
        center: lattice.coordinates(gaussian.center),
        covariance: gaussian.covariance(1.0 / spacing, most),
        opacity: gaussian.opacity,
        color: gaussian.color,
    };
    let blobs = gaussians.iter().map(blob).collect();
    (lattice, blobs)
}
