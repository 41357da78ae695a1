"""Case folders, as the Rust readers take them (src/formats/case.rs, src/formats/camera.rs)."""

from __future__ import annotations

import json
import math
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import trimesh
from PIL import Image

from .frames import SURFACE_SAMPLES
from .methods import SEED

MESH_FILES = ("mesh.glb", "mesh.gltf", "mesh.obj", "mesh.ply", "mesh.stl")
# Of whole-number depth, where the camera file says nothing else.
MILLIMETRE = 0.001


@dataclass
class Case:
    depth: np.ndarray
    mask: np.ndarray
    camera: dict[str, float]
    mesh: trimesh.Trimesh

    def surface(self) -> tuple[np.ndarray, np.ndarray]:
        """Points spread evenly over the mesh, and the normals of their triangles."""
        points, faces = trimesh.sample.sample_surface(self.mesh, SURFACE_SAMPLES, seed=SEED)
        return np.asarray(points), np.asarray(self.mesh.face_normals[faces])


def case_folders(folders: list[Path]) -> list[Path]:
    """Folders of cases stand for the cases in them."""

    def is_case(folder: Path) -> bool:
        return (folder / "camera.json").is_file()

    found: list[Path] = []
    for folder in folders:
        found += [folder] if is_case(folder) else sorted(inner for inner in folder.iterdir() if is_case(inner))
    return found


def read_case(folder: Path) -> Case:
    entry = camera_entry(json.loads((folder / "camera.json").read_text(encoding="utf-8-sig")))
    depth = read_depth(folder, entry)
    mask = read_mask(folder)
    if mask.shape != depth.shape:
        raise ValueError(f"{folder}: a mask of {mask.shape} pixels beside depth of {depth.shape}")
    mesh_path = next((folder / name for name in MESH_FILES if (folder / name).is_file()), None)
    if mesh_path is None:
        raise ValueError(f"{folder}: no {' or '.join(MESH_FILES)}")
    # Nodes' transforms are applied: the mesh's frame is that of the scene.
    mesh = trimesh.load_scene(mesh_path, process=False, skip_materials=True).to_mesh()
    return Case(depth, mask, intrinsics(entry, depth.shape), mesh)


def read_depth(folder: Path, camera: Any) -> np.ndarray:
    """Metres, H×W; 0 and NaN are no reading."""
    if (folder / "depth.npy").is_file():
        depth = np.squeeze(np.load(folder / "depth.npy"))
    else:
        image = Image.open(folder / "depth.png")
        if image.mode in ("1", "L", "P", "RGB", "RGBA"):
            raise ValueError(f"{folder}: depth.png has 8 bits, of which depth has too many steps")
        depth = np.asarray(image)
    if not np.issubdtype(depth.dtype, np.integer):
        return depth.astype(np.float32)
    scale = MILLIMETRE
    if isinstance(camera, dict) and "depthScale" in camera:
        scale = float(camera["depthScale"])
    elif isinstance(camera, dict) and "depth_scale" in camera:
        scale = float(camera["depth_scale"]) * MILLIMETRE
    return (depth * scale).astype(np.float32)


def read_mask(folder: Path) -> np.ndarray:
    """Booleans, H×W. A varying alpha channel is a cut-out; else what has any colour is the object."""
    if (folder / "mask.npy").is_file() and not (folder / "mask.png").is_file():
        return np.squeeze(np.nan_to_num(np.load(folder / "mask.npy")) != 0)
    image = Image.open(folder / "mask.png")
    if image.mode == "P":
        image = image.convert("RGB")
    pixels = np.asarray(image)
    if image.mode in ("LA", "RGBA"):
        alpha, pixels = pixels[..., -1], pixels[..., :-1]
        if alpha.min() != alpha.max():
            return alpha > 0
    return pixels > 0 if pixels.ndim == 2 else (pixels > 0).any(axis=2)


def camera_entry(value: Any) -> Any:
    """The camera's own entry, where the file is a BOP scene_camera.json of one image."""
    if isinstance(value, dict) and len(value) == 1:
        inner = next(iter(value.values()))
        if isinstance(inner, dict) and "cam_K" in inner:
            return inner
    return value


def intrinsics(entry: Any, shape: tuple[int, ...]) -> dict[str, float]:
    """fx, fy, cx, cy in pixels, from the forms that src/formats/camera.rs lists."""

    def of_matrix(numbers: Any, order: str = "C") -> dict[str, float]:
        k = np.asarray(numbers, dtype=np.float64).reshape((3, 3), order=order)
        return {"fx": k[0, 0], "fy": k[1, 1], "cx": k[0, 2], "cy": k[1, 2]}

    if isinstance(entry, list):
        return of_matrix(entry)
    for name in ("K", "k", "cam_K"):
        if name in entry:
            return of_matrix(entry[name])
    if "intrinsic_matrix" in entry:
        return of_matrix(entry["intrinsic_matrix"], "F")
    cx, cy = entry.get("cx", entry.get("ppx")), entry.get("cy", entry.get("ppy"))
    if cx is not None and cy is not None and "fx" in entry and "fy" in entry:
        return {"fx": float(entry["fx"]), "fy": float(entry["fy"]), "cx": float(cx), "cy": float(cy)}
    fov = entry.get("fovYDeg", entry.get("fov_y_deg"))
    if fov is None:
        raise ValueError(f"a camera file with {', '.join(entry)}")
    height, width = shape
    f = 0.5 * height / math.tan(0.5 * math.radians(fov))
    return {"fx": f, "fy": f, "cx": 0.5 * (width - 1), "cy": 0.5 * (height - 1)}
