"""Inputs as files of bare numbers, which `npm run bench` writes from case folders, and clouds of pairs."""

from __future__ import annotations

import json
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import trimesh

from .frames import SURFACE_SAMPLES


@dataclass
class Case:
    # Metres, H×W; what is not above 0 is no reading.
    depth: np.ndarray
    mask: np.ndarray
    camera: dict[str, float]
    mesh: trimesh.Trimesh


def surface(mesh: trimesh.Trimesh, seed: int) -> tuple[np.ndarray, np.ndarray]:
    """Points spread evenly over a mesh, and the normals of their triangles."""
    points, faces = trimesh.sample.sample_surface(mesh, SURFACE_SAMPLES, seed=seed)
    return np.asarray(points), np.asarray(mesh.face_normals[faces])


def read_case(folder: Path) -> Case:
    facts = json.loads((folder / "case.json").read_text(encoding="utf-8"))
    shape = (facts["height"], facts["width"])
    positions = np.fromfile(folder / "positions", np.float32).reshape(-1, 3)
    indices = np.fromfile(folder / "indices", np.uint32).reshape(-1, 3)
    return Case(
        np.fromfile(folder / "depth", np.float32).reshape(shape),
        np.fromfile(folder / "mask", np.uint8).reshape(shape) != 0,
        facts["camera"],
        trimesh.Trimesh(positions, indices, process=False),
    )


def read_cloud(path: Path) -> np.ndarray:
    """N×3 from a .ply."""
    import open3d

    points = np.asarray(open3d.io.read_point_cloud(str(path)).points)
    points = points[np.isfinite(points).all(axis=1)]
    if len(points) == 0:
        raise ValueError(f"{path}: no points")
    return points
