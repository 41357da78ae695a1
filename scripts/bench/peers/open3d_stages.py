"""Stages of Open3D's tutorial on global registration, with its settings relative to the voxel."""

from __future__ import annotations

import numpy as np
import open3d as o3d

from .frames import Problem

registration = o3d.pipelines.registration
PointCloud = o3d.geometry.PointCloud

RANSAC_ITERATIONS = 100_000
RANSAC_CONFIDENCE = 0.999
FINE_REACH_VOXELS = 0.4

o3d.utility.set_verbosity_level(o3d.utility.VerbosityLevel.Error)


def point_cloud(points: np.ndarray, normals: np.ndarray | None = None) -> PointCloud:
    cloud = PointCloud(o3d.utility.Vector3dVector(points))
    if normals is not None:
        cloud.normals = o3d.utility.Vector3dVector(normals)
    return cloud


def estimate_normals(cloud: PointCloud, voxel: float) -> None:
    """Over two voxels; normals that the cloud has already tell the sides of the new ones."""
    cloud.estimate_normals(o3d.geometry.KDTreeSearchParamHybrid(radius=2 * voxel, max_nn=30))


def thin(cloud: PointCloud, voxel: float, viewpoint: np.ndarray | None = None) -> PointCloud:
    """One point per voxel, with a normal. Normals that point the same way in both clouds are a favour to the
    descriptors."""
    down = cloud.voxel_down_sample(voxel)
    estimate_normals(down, voxel)
    if viewpoint is not None:
        down.orient_normals_towards_camera_location(viewpoint)
    return down


def describe(down: PointCloud, voxel: float) -> registration.Feature:
    return registration.compute_fpfh_feature(down, o3d.geometry.KDTreeSearchParamHybrid(radius=5 * voxel, max_nn=100))


def ransac(pair: list[PointCloud], features: list, voxel: float, with_scaling: bool) -> np.ndarray:
    reach = 1.5 * voxel
    return registration.registration_ransac_based_on_feature_matching(
        *pair,
        *features,
        True,
        reach,
        registration.TransformationEstimationPointToPoint(with_scaling),
        3,
        [
            registration.CorrespondenceCheckerBasedOnEdgeLength(0.9),
            registration.CorrespondenceCheckerBasedOnDistance(reach),
        ],
        registration.RANSACConvergenceCriteria(RANSAC_ITERATIONS, RANSAC_CONFIDENCE),
    ).transformation


def fast_global(pair: list[PointCloud], features: list, voxel: float) -> np.ndarray:
    """The tutorial's distance, half a voxel, taken for what it is: by default Open3D reads it as a share of the clouds'
    radius. `decrease_mu`, without which nothing is graduated, is off by default in Python but on in C++."""
    return registration.registration_fgr_based_on_feature_matching(
        *pair,
        *features,
        registration.FastGlobalRegistrationOption(
            use_absolute_scale=True, decrease_mu=True, maximum_correspondence_distance=0.5 * voxel
        ),
    ).transformation


def refine(pair: list[PointCloud], reach: float, initial: np.ndarray) -> np.ndarray:
    """Point-to-plane ICP with Open3D's own criteria; the target needs normals."""
    estimation = registration.TransformationEstimationPointToPlane()
    return registration.registration_icp(*pair, reach, initial, estimation).transformation


class Clouds:
    """A problem as Open3D's clouds; what several stages need is computed once."""

    def __init__(self, problem: Problem):
        self.voxel = problem.voxel
        self.full = [
            point_cloud(problem.source, problem.source_normals),
            point_cloud(problem.target, problem.target_normals),
        ]
        viewpoints = [None, problem.viewpoint]
        self.thinned = [
            thin(cloud, self.voxel, viewpoint) for cloud, viewpoint in zip(self.full, viewpoints, strict=True)
        ]

    def described(self) -> tuple[list[PointCloud], list]:
        return self.thinned, [describe(cloud, self.voxel) for cloud in self.thinned]

    def refined(self, initial: np.ndarray) -> np.ndarray:
        """Point-to-plane ICP on the clouds as they came."""
        estimate_normals(self.full[1], self.voxel)
        return refine(self.full, FINE_REACH_VOXELS * self.voxel, initial)
