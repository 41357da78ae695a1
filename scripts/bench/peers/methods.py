"""The methods by name. Each takes a problem and answers with the 4×4 matrix from source to target.

Rigid methods keep the scale of the problem, s_init. Global ones:

- open3d-ransac: FPFH, RANSAC (100 000 iterations, confidence 0.999, edges within 0.9, inliers within 1.5 voxels), then
  point-to-plane ICP on all points, as Open3D's tutorial has it;
- open3d-ransac-scale: the same, and RANSAC estimates the scale too (`with_scaling=True`);
- open3d-ransac-thinned: open3d-ransac with ICP on one point per voxel, which is faster;
- open3d-fgr: FPFH, Fast Global Registration (half a voxel), no refinement, as in the tutorial;
- kiss-matcher: KISS-Matcher with its defaults, no refinement.

Local ones, which start from the centred, unrotated pose, with correspondences up to 3 voxels apart and at most 100
iterations:

- open3d-icp-point-to-point, open3d-icp-point-to-plane: on all points;
- open3d-gicp, small-gicp: on one point per voxel;
- probreg-cpd: Coherent Point Drift with scale, on at most 1000 points of each thinned cloud, drawn at random, for its
  time grows with their product; 10 % outliers, at most 150 iterations.
"""

from __future__ import annotations

import importlib
import importlib.metadata
import os
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from .frames import Problem

SEED_VARIABLE = "PEERS_SEED"
SEED = int(os.environ.get(SEED_VARIABLE, "0"))
LOCAL_REACH_VOXELS = 3.0
LOCAL_ITERATIONS = 100
CPD_POINTS = 1000
CPD_OUTLIERS = 0.1
CPD_ITERATIONS = 150


@dataclass(frozen=True)
class Method:
    run: Callable[[Problem], np.ndarray]
    # The distributions that it needs, the one that gives it its version first.
    packages: tuple[str, ...]

    def load(self) -> None:
        for package in self.packages:
            importlib.import_module(package)

    @property
    def software(self) -> str:
        return f"{self.packages[0]} {importlib.metadata.version(self.packages[0])}"


def _seed_open3d() -> None:
    import open3d

    open3d.utility.random.seed(SEED)


def _ransac(with_scaling: bool, thinned: bool = False) -> Callable[[Problem], np.ndarray]:
    def run(problem: Problem) -> np.ndarray:
        from .open3d_stages import Clouds, ransac, refine

        _seed_open3d()
        clouds = Clouds(problem)
        coarse = ransac(*clouds.described(), problem.voxel, with_scaling)
        # Points a voxel apart are no nearer to each other than that.
        return refine(clouds.thinned, problem.voxel, coarse) if thinned else clouds.refined(coarse)

    return run


def _fast_global(problem: Problem) -> np.ndarray:
    from .open3d_stages import Clouds, fast_global

    _seed_open3d()
    clouds = Clouds(problem)
    return fast_global(*clouds.described(), problem.voxel)


def _icp(to_plane: bool) -> Callable[[Problem], np.ndarray]:
    def run(problem: Problem) -> np.ndarray:
        from .open3d_stages import estimate_normals, point_cloud, registration

        pair = [point_cloud(problem.source), point_cloud(problem.target, problem.target_normals)]
        estimation = registration.TransformationEstimationPointToPoint()
        if to_plane:
            estimate_normals(pair[1], problem.voxel)
            estimation = registration.TransformationEstimationPointToPlane()
        return registration.registration_icp(
            *pair,
            LOCAL_REACH_VOXELS * problem.voxel,
            np.eye(4),
            estimation,
            registration.ICPConvergenceCriteria(max_iteration=LOCAL_ITERATIONS),
        ).transformation

    return run


def _generalized_icp(problem: Problem) -> np.ndarray:
    from .open3d_stages import Clouds, registration

    return registration.registration_generalized_icp(
        *Clouds(problem).thinned,
        LOCAL_REACH_VOXELS * problem.voxel,
        np.eye(4),
        registration.TransformationEstimationForGeneralizedICP(),
        registration.ICPConvergenceCriteria(max_iteration=LOCAL_ITERATIONS),
    ).transformation


def _small_gicp(problem: Problem) -> np.ndarray:
    import small_gicp

    clouds = [small_gicp.preprocess_points(points, problem.voxel) for points in (problem.target, problem.source)]
    (target, tree), (source, _) = clouds
    return small_gicp.align(
        target,
        source,
        tree,
        registration_type="GICP",
        max_correspondence_distance=LOCAL_REACH_VOXELS * problem.voxel,
        max_iterations=LOCAL_ITERATIONS,
        # The library's own are for metres of a street: at rest means here a thousandth of a voxel.
        rotation_epsilon=1e-4,
        translation_epsilon=1e-3 * problem.voxel,
    ).T_target_source


def _kiss_matcher(problem: Problem) -> np.ndarray:
    import kiss_matcher

    # It is not indifferent to the unit: the same clouds come out twice as exact where a voxel is its default one.
    config = kiss_matcher.KISSMatcherConfig()
    zoom = config.voxel_size / problem.voxel
    matcher = kiss_matcher.KISSMatcher(config)
    # Its normals point to the origin: those of a mesh around it inwards. So that those of a view do too, the origin goes
    # behind it, as far as the camera is in front.
    behind = np.zeros(3) if problem.viewpoint is None else problem.viewpoint
    clouds = [list((zoom * points).astype(np.float32)) for points in (problem.source, problem.target + behind)]
    solution = matcher.estimate(*clouds)
    if not solution.valid:
        matches = len(matcher.get_initial_correspondences())
        raise RuntimeError(f"KISS-Matcher found no valid solution among {matches} matches")
    matrix = np.eye(4)
    matrix[:3, :3], matrix[:3, 3] = solution.rotation, np.ravel(solution.translation) / zoom - behind
    return matrix


def _cpd(problem: Problem) -> np.ndarray:
    from probreg import cpd

    from .open3d_stages import point_cloud

    random = np.random.default_rng(SEED)

    def few(points: np.ndarray) -> np.ndarray:
        thinned = np.asarray(point_cloud(points).voxel_down_sample(problem.voxel).points)
        if len(thinned) <= CPD_POINTS:
            return thinned
        return thinned[np.sort(random.choice(len(thinned), CPD_POINTS, replace=False))]

    found = cpd.registration_cpd(
        few(problem.source), few(problem.target), "rigid", w=CPD_OUTLIERS, maxiter=CPD_ITERATIONS, update_scale=True
    ).transformation
    matrix = np.eye(4)
    matrix[:3, :3], matrix[:3, 3] = found.scale * found.rot, found.t
    return matrix


METHODS: dict[str, Method] = {
    "open3d-ransac": Method(_ransac(False), ("open3d",)),
    "open3d-ransac-scale": Method(_ransac(True), ("open3d",)),
    "open3d-ransac-thinned": Method(_ransac(False, thinned=True), ("open3d",)),
    "open3d-fgr": Method(_fast_global, ("open3d",)),
    "kiss-matcher": Method(_kiss_matcher, ("kiss_matcher",)),
    "open3d-icp-point-to-point": Method(_icp(False), ("open3d",)),
    "open3d-icp-point-to-plane": Method(_icp(True), ("open3d",)),
    "open3d-gicp": Method(_generalized_icp, ("open3d",)),
    "small-gicp": Method(_small_gicp, ("small_gicp",)),
    "probreg-cpd": Method(_cpd, ("probreg", "open3d")),
}

# For pairs of clouds: rigid, and independent of the initial pose.
PAIR_METHODS = ("open3d-ransac", "open3d-fgr", "kiss-matcher")
