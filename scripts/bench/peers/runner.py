"""Runs methods over cases or pairs and writes one JSON file per answer.

An answer is written beside its place and renamed, so that an interrupted run can be resumed. A library that
takes its process down with it leaves the file it had begun: that item is tried once more in a process of its own, and
what ends that one too counts as the method's error.
"""

from __future__ import annotations

import contextlib
import json
import multiprocessing
import os
import sys
import time
from concurrent.futures import ProcessPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, TextIO

import numpy as np

from .frames import Problem, unified
from .inputs import Case, read_case, read_cloud, surface
from .methods import METHODS, SEED, SEED_VARIABLE

_progress: TextIO = sys.stdout


@dataclass(frozen=True)
class Task:
    """A case folder or a pair of clouds, and the methods that are still to be run on it."""

    name: str
    out: Path
    methods: tuple[str, ...]
    folder: Path | None = None
    source: Path | None = None
    target: Path | None = None
    voxel_m: float = 0.0

    def answer(self, method: str) -> Path:
        return self.out / method / f"{self.name}.json"

    def begun(self, method: str) -> Path:
        return self.out / method / f"{self.name}.json.begun"

    def left(self) -> Task:
        """The task without what is answered."""
        missing = tuple(method for method in self.methods if not self.answer(method).is_file())
        return replace(self, methods=missing)


def run_tasks(tasks: list[Task], jobs: int, threads: int, seed: int) -> None:
    for task in tasks:
        for method in task.methods:
            task.begun(method).parent.mkdir(parents=True, exist_ok=True)
            # Of a run that was stopped.
            task.begun(method).unlink(missing_ok=True)
    # The processes inherit them.
    os.environ["OMP_NUM_THREADS"] = f"{threads}"
    os.environ[SEED_VARIABLE] = f"{seed}"
    while tasks := [left for task in tasks if (left := task.left()).methods]:
        if _run_all(tasks, jobs):
            continue
        for task in tasks:
            for method in task.methods:
                if not task.begun(method).exists():
                    continue
                task.begun(method).unlink()
                alone = replace(task, methods=(method,))
                if not _run_all([alone], 1):
                    _write(alone, method, {"error": "the library ended its process"})


def _run_all(tasks: list[Task], jobs: int) -> bool:
    """Whether all processes lived."""
    context = multiprocessing.get_context("spawn")
    cores = context.Queue()
    available = sorted(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else [0]
    for job in range(jobs):
        cores.put(available[job % len(available)])
    with ProcessPoolExecutor(min(jobs, len(tasks)), context, initializer=_begin, initargs=(cores,)) as pool:
        futures = [pool.submit(_run, task) for task in tasks]
        try:
            for future in futures:
                future.result()
        except BrokenProcessPool:
            return False
    return True


def _begin(cores: Any) -> None:
    """
    Puts a process of one thread on one core. Leaves standard output to the progress: what libraries print goes to
    standard error.
    """
    if hasattr(os, "sched_setaffinity") and os.environ["OMP_NUM_THREADS"] == "1":
        os.sched_setaffinity(0, {cores.get()})
    global _progress
    _progress = os.fdopen(os.dup(1), "w", buffering=1)
    os.dup2(2, 1)


def _run(task: Task) -> None:
    case: Any = None
    unreadable = None
    task.begun(task.methods[0]).touch()
    try:
        case = _read(task)
    except Exception as error:  # It is the answer of every method.
        unreadable = error
    for method in task.methods:
        task.begun(method).touch()
        # Importing a library is no part of its method.
        METHODS[method].load()
        begun = time.perf_counter()
        try:
            if unreadable is not None:
                raise unreadable
            answer = _answer(task, case, method)
        except Exception as error:  # Whatever it is, the next method may go well.
            answer = {"error": f"{type(error).__name__}: {error}"}
        answer["seconds"] = time.perf_counter() - begun
        _write(task, method, answer)


def _read(task: Task) -> Case | tuple[np.ndarray, np.ndarray]:
    if task.folder is None:
        return read_cloud(task.source), read_cloud(task.target)
    return read_case(task.folder)


def _answer(task: Task, case: Any, method: str) -> dict[str, Any]:
    run = METHODS[method].run
    if task.folder is None:
        source, target = case
        return {"targetFromSource": similarity(run(Problem(source, target, task.voxel_m)))}
    problem, unit_from_mesh, unit_from_camera = unified(case.depth, case.mask, case.camera, surface(case.mesh, SEED))
    camera_from_mesh = np.linalg.inv(unit_from_camera) @ run(problem) @ unit_from_mesh
    return {"cameraFromMesh": similarity(camera_from_mesh)}


def similarity(matrix: np.ndarray) -> dict[str, Any]:
    """A 4×4 matrix as scale, rotation (rows) and translation; a library's f32 rounding is taken out of the rotation."""
    if not np.isfinite(matrix).all():
        raise ValueError("a transform that is not finite")
    linear = np.asarray(matrix, dtype=np.float64)[:3, :3]
    determinant = float(np.linalg.det(linear))
    if not determinant > 0:
        raise ValueError(f"a transform of determinant {determinant}")
    scale = determinant ** (1 / 3)
    u, _, vt = np.linalg.svd(linear)
    if np.abs(u @ vt - linear / scale).max() > 1e-3:
        raise ValueError("a transform that is no similarity")
    return {"scale": scale, "rotation": (u @ vt).tolist(), "translation": matrix[:3, 3].tolist()}


def _write(task: Task, method: str, answer: dict[str, Any]) -> None:
    begun = task.begun(method)
    answer = {**answer, "software": METHODS[method].software}
    begun.write_text(json.dumps(answer, allow_nan=False) + "\n", encoding="utf-8")
    begun.replace(task.answer(method))
    line = {"method": method, "case": task.name, "seconds": answer.get("seconds")}
    if "error" in answer:
        line["error"] = answer["error"]
    # In one piece: several processes write here.
    with contextlib.suppress(BrokenPipeError):
        _progress.write(json.dumps(line) + "\n")
        _progress.flush()
