"""Pairs of point clouds for general registration."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np

from .runner import Task


def read_cloud(path: Path) -> np.ndarray:
    """N×3 from a .ply, or from KITTI's .bin: x, y, z, reflectance as f32."""
    if path.suffix == ".bin":
        points = np.fromfile(path, np.float32).reshape(-1, 4)[:, :3].astype(np.float64)
    else:
        import open3d

        points = np.asarray(open3d.io.read_point_cloud(str(path)).points)
    points = points[np.isfinite(points).all(axis=1)]
    if len(points) == 0:
        raise ValueError(f"{path}: no points")
    return points


def pair_tasks(path: Path, out: Path, methods: tuple[str, ...]) -> list[Task]:
    """The tasks of a list [{"id", "source", "target", "voxelSizeM"}]; relative paths start at the list's folder."""
    tasks = []
    for pair in json.loads(path.read_text(encoding="utf-8")):
        source, target = (path.parent / pair[name] for name in ("source", "target"))
        voxel_m = float(pair["voxelSizeM"])
        if not voxel_m > 0:
            raise ValueError(
                f"{path}: pair {pair['id']}: found voxelSizeM {voxel_m}, expected a number above 0, metres"
            )
        tasks.append(Task(str(pair["id"]), out, methods, source=source, target=target, voxel_m=voxel_m))
    return tasks
