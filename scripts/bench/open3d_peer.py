"""FPFH, RANSAC and ICP by Open3D, the way of its tutorial on global registration: one JSON request a line on standard
input, one JSON answer a line on standard output. What reads files and makes Open3D's mesh is not timed."""

import json
import os
import sys
import time

import numpy as np
import open3d as o3d

registration = o3d.pipelines.registration

SURFACE_SAMPLES = 20_000
VOXEL_DIVISIONS = 30
RANSAC_ITERATIONS = 100_000
RANSAC_CONFIDENCE = 0.999


def load(request):
    """The inputs of a case, from files of bare numbers."""
    depth = np.fromfile(request["depth"], np.float32).reshape(request["height"], request["width"])
    mask = np.fromfile(request["mask"], np.uint8).reshape(depth.shape) != 0
    positions = np.fromfile(request["positions"], np.float32).reshape(-1, 3)
    indices = np.fromfile(request["indices"], np.uint32).reshape(-1, 3)
    mesh = o3d.geometry.TriangleMesh(
        o3d.utility.Vector3dVector(positions.astype(np.float64)), o3d.utility.Vector3iVector(indices.astype(np.int32))
    )
    return {"depth": depth, "mask": mask, "camera": request["camera"], "mesh": mesh}


def back_project(case):
    depth, camera = case["depth"], case["camera"]
    v, u = np.nonzero(case["mask"] & np.isfinite(depth) & (depth > 0))
    z = depth[v, u].astype(np.float64)
    x = (u - camera["cx"]) * z / camera["fx"]
    y = (v - camera["cy"]) * z / camera["fy"]
    return o3d.geometry.PointCloud(o3d.utility.Vector3dVector(np.stack([x, y, z], axis=1)))


def diagonal(cloud):
    return float(np.linalg.norm(cloud.get_axis_aligned_bounding_box().get_extent()))


def preprocess(cloud, voxel):
    """As the tutorial has it; normals that point the same way in both clouds are a favour to the descriptors."""
    down = cloud.voxel_down_sample(voxel)
    down.estimate_normals(o3d.geometry.KDTreeSearchParamHybrid(radius=2 * voxel, max_nn=30))
    return down


def describe(down, voxel):
    return registration.compute_fpfh_feature(down, o3d.geometry.KDTreeSearchParamHybrid(radius=5 * voxel, max_nn=100))


def align(case, with_scaling, thinned, seed):
    """Camera from mesh, and the milliseconds of each stage."""
    o3d.utility.random.seed(seed)
    stages, last = {}, time.perf_counter()

    def done(stage):
        nonlocal last
        now = time.perf_counter()
        stages[stage], last = 1000 * (now - last), now

    target = back_project(case)
    done("observe")
    # With the triangles' normals the estimated ones get their sides: outwards here, towards the camera there.
    source = case["mesh"].sample_points_uniformly(SURFACE_SAMPLES, use_triangle_normal=True)
    done("sample")
    scale = diagonal(target) / diagonal(source)
    source.scale(scale, center=np.zeros(3))
    voxel = diagonal(target) / VOXEL_DIVISIONS
    source_down, target_down = preprocess(source, voxel), preprocess(target, voxel)
    target_down.orient_normals_towards_camera_location(np.zeros(3))
    done("normals")
    features = [describe(cloud, voxel) for cloud in (source_down, target_down)]
    done("features")
    reach = 1.5 * voxel
    coarse = registration.registration_ransac_based_on_feature_matching(
        source_down,
        target_down,
        features[0],
        features[1],
        True,
        reach,
        registration.TransformationEstimationPointToPoint(with_scaling),
        3,
        [
            registration.CorrespondenceCheckerBasedOnEdgeLength(0.9),
            registration.CorrespondenceCheckerBasedOnDistance(reach),
        ],
        registration.RANSACConvergenceCriteria(RANSAC_ITERATIONS, RANSAC_CONFIDENCE),
    )
    done("ransac")
    # The tutorial refines on the clouds as they came; the plane of each point has to be estimated first. On the thinned
    # clouds that is done, but points a voxel apart are no nearer to each other than that.
    pair = (source_down, target_down) if thinned else (source, target)
    if not thinned:
        target.estimate_normals(o3d.geometry.KDTreeSearchParamHybrid(radius=2 * voxel, max_nn=30))
    done("planes")
    fine = registration.registration_icp(
        *pair,
        voxel if thinned else 0.4 * voxel,
        coarse.transformation,
        registration.TransformationEstimationPointToPlane(),
    )
    done("icp")
    matrix = np.array(fine.transformation) @ np.diag([scale, scale, scale, 1.0])
    return matrix, stages


def main():
    # Open3D writes its warnings to standard output: they go to standard error, out of the answers.
    answers = os.fdopen(os.dup(1), "w")
    os.dup2(2, 1)
    o3d.utility.set_verbosity_level(o3d.utility.VerbosityLevel.Error)
    cases = {}
    print(json.dumps({"version": o3d.__version__}), file=answers, flush=True)
    for line in sys.stdin:
        request = json.loads(line)
        try:
            if "load" in request:
                cases[request["load"]] = load(request)
                answer = {}
            else:
                begun = time.perf_counter()
                case = cases[request["align"]]
                matrix, stages = align(case, request["withScaling"], request["thinned"], request["seed"])
                ms = 1000 * (time.perf_counter() - begun)
                answer = {"ms": ms, "stages": stages, "matrix": matrix.T.ravel().tolist()}
        except Exception as error:  # Whatever it is, the next request may go well.
            answer = {"error": f"{type(error).__name__}: {error}"}
        print(json.dumps(answer), file=answers, flush=True)


main()
