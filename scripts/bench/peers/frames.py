"""The unified preprocessing of the paper (§3.1): clouds from a case, and the frame in which they are registered."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

SURFACE_SAMPLES = 20_000
VOXEL_DIVISIONS = 30


@dataclass
class Problem:
    """Two clouds to be registered; a method answers with the 4×4 matrix that takes source points to the target."""

    source: np.ndarray
    target: np.ndarray
    voxel: float
    # Outward normals where they are known.
    source_normals: np.ndarray | None = None
    target_normals: np.ndarray | None = None
    # Where the target was seen from: estimated normals are turned towards it.
    viewpoint: np.ndarray | None = None


def back_project(depth: np.ndarray, mask: np.ndarray, camera: dict[str, float]) -> np.ndarray:
    """The points behind the mask's pixels that have a reading, N×3: OpenCV's frame, pixel centres at integers."""
    v, u = np.nonzero(mask & np.isfinite(depth) & (depth > 0))
    z = depth[v, u].astype(np.float64)
    x = (u - camera["cx"]) * z / camera["fx"]
    y = (v - camera["cy"]) * z / camera["fy"]
    return np.stack([x, y, z], axis=1)


def diagonal(points: np.ndarray) -> float:
    """The diagonal of the axis-aligned box."""
    return float(np.linalg.norm(np.ptp(points, axis=0)))


def unit_from_own(points: np.ndarray) -> np.ndarray:
    """The 4×4 matrix that centres a cloud's box and makes its diagonal 1."""
    if len(points) == 0:
        raise ValueError("no points: the mask has no depth reading, or the mesh no surface")
    length = diagonal(points)
    if not length > 0:
        raise ValueError("all points are the same")
    matrix = np.eye(4) / length
    matrix[:3, 3] = -0.5 * (points.min(axis=0) + points.max(axis=0)) / length
    matrix[3, 3] = 1.0
    return matrix


def apply(matrix: np.ndarray, points: np.ndarray) -> np.ndarray:
    """The points, transformed."""
    return points @ matrix[:3, :3].T + matrix[:3, 3]


def unified(
    depth: np.ndarray, mask: np.ndarray, camera: dict[str, float], surface: tuple[np.ndarray, np.ndarray]
) -> tuple[Problem, np.ndarray, np.ndarray]:
    """The registration problem of a case, and the matrices that take mesh and camera frame to its unit frames.

    `surface` holds points sampled on the mesh and their normals.
    """
    target = back_project(depth, mask, camera)
    source, normals = surface
    unit_from_mesh, unit_from_camera = unit_from_own(source), unit_from_own(target)
    problem = Problem(
        source=apply(unit_from_mesh, source),
        target=apply(unit_from_camera, target),
        voxel=1.0 / VOXEL_DIVISIONS,
        source_normals=normals,
        viewpoint=unit_from_camera[:3, 3],
    )
    return problem, unit_from_mesh, unit_from_camera
