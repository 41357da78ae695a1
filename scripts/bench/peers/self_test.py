"""Whether every method is driven rightly: each has to recover a motion that is known, on clouds that overlap fully."""

from __future__ import annotations

import json

import numpy as np
import trimesh
from scipy.spatial.transform import Rotation

from .frames import Problem, apply, unit_from_own
from .inputs import surface
from .methods import METHODS, PAIR_METHODS
from .runner import similarity

MAX_TURN_DEG = 2.0
# Without refinement, a method is as exact as its voxels: it gets smaller ones.
MAX_COARSE_TURN_DEG = 4.0
VOXEL_DIVISIONS, COARSE_VOXEL_DIVISIONS = 30, 60
# Shares of the diagonal, and of the scale.
MAX_SHIFT = 0.02
MAX_STRETCH = 0.02
# Global methods are given any turn; local ones start this far away.
FAR_DEG, NEAR_DEG = 140.0, 8.0
# Of the scale that the true one differs by, for methods that estimate it. RANSAC checks edges before it does.
STRETCH = {"open3d-ransac-scale": 1.04, "probreg-cpd": 1.15}
# Metres of the test on pairs, whose frames have nothing of the unit box.
PAIR_DIAGONAL_M = 4.0


def model() -> trimesh.Trimesh:
    """A body without any symmetry."""
    tilted = trimesh.creation.box((0.5, 0.15, 0.2)).apply_transform(motion(35.0, 1.0, (0.2, -0.35, 0.2)))
    parts = [
        trimesh.creation.box((1.0, 0.6, 0.3)),
        trimesh.creation.cylinder(0.1, 0.5).apply_translation((0.3, 0.1, 0.3)),
        trimesh.creation.icosphere(3, 0.2).apply_translation((-0.4, 0.2, 0.2)),
        trimesh.creation.cone(0.2, 0.4).apply_translation((-0.15, -0.1, 0.1)),
        trimesh.creation.torus(0.15, 0.05).apply_translation((0.45, -0.1, -0.15)),
        tilted,
    ]
    return trimesh.util.concatenate(parts)


def motion(turn_deg: float, scale: float, shift: tuple[float, float, float]) -> np.ndarray:
    axis = np.array([0.4, 0.8, -0.3])
    matrix = np.eye(4)
    turn = Rotation.from_rotvec(axis / np.linalg.norm(axis) * np.radians(turn_deg))
    matrix[:3, :3], matrix[:3, 3] = scale * turn.as_matrix(), shift
    return matrix


def moved_problem(truth: np.ndarray, size: float, voxel: float) -> Problem:
    """The model in a box of diagonal `size`, and other points of it, moved."""
    mesh = model()
    (source, source_normals), (target, target_normals) = surface(mesh, 1), surface(mesh, 2)
    unit = unit_from_own(source)
    turn = truth[:3, :3] / np.cbrt(np.linalg.det(truth[:3, :3]))
    return Problem(
        source=size * apply(unit, source),
        target=apply(truth, size * apply(unit, target)),
        voxel=voxel,
        source_normals=source_normals,
        target_normals=target_normals @ turn.T,
    )


def difference(found: np.ndarray, truth: np.ndarray, size: float) -> dict[str, float]:
    a, b = similarity(found), similarity(truth)
    turn = Rotation.from_matrix(np.array(a["rotation"]) @ np.array(b["rotation"]).T)
    return {
        "turnDeg": float(np.degrees(turn.magnitude())),
        "shift": float(np.linalg.norm(np.subtract(a["translation"], b["translation"]))) / size,
        "stretch": abs(a["scale"] / b["scale"] - 1),
    }


def check(name: str, test: str, truth: np.ndarray, size: float) -> bool:
    line: dict[str, object] = {"method": name, "test": test}
    try:
        divisions = COARSE_VOXEL_DIVISIONS if METHODS[name].is_coarse else VOXEL_DIVISIONS
        found = METHODS[name].run(moved_problem(truth, size, size / divisions))
        off = difference(found, truth, size)
        max_turn_deg = MAX_COARSE_TURN_DEG if METHODS[name].is_coarse else MAX_TURN_DEG
        holds = off["turnDeg"] <= max_turn_deg and off["shift"] <= MAX_SHIFT and off["stretch"] <= MAX_STRETCH
        line |= {key: round(value, 4) for key, value in off.items()}
    except Exception as error:  # A library that fails here fails the test.
        holds = False
        line["error"] = f"{type(error).__name__}: {error}"
    print(json.dumps({**line, "holds": holds}), flush=True)
    return holds


def self_test(names: list[str]) -> int:
    holds = []
    for name in names:
        if METHODS[name].is_global:
            truth = motion(FAR_DEG, STRETCH.get(name, 1.0), (0.3, -0.2, 0.5))
        else:
            truth = motion(NEAR_DEG, STRETCH.get(name, 1.0), (0.02, -0.01, 0.015))
        holds.append(check(name, "cases", truth, 1.0))
    for name in PAIR_METHODS:
        if name in names:
            truth = motion(FAR_DEG, 1.0, (3.0, -2.0, 1.0))
            holds.append(check(name, "pairs", truth, PAIR_DIAGONAL_M))
    failed = holds.count(False)
    print(f"{len(holds) - failed} of {len(holds)} hold")
    return 1 if failed else 0
