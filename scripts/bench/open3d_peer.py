"""FPFH, RANSAC and ICP by Open3D, the way of its tutorial on global registration: one JSON request a line on standard
input, one JSON answer a line on standard output. What reads files and makes Open3D's mesh is not timed."""

import json
import os
import sys
import time

import numpy as np
import open3d as o3d

from peers import open3d_stages
from peers.frames import SURFACE_SAMPLES, VOXEL_DIVISIONS, back_project, diagonal


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


def align(case, with_scaling, thinned, seed):
    """Camera from mesh, and the milliseconds of each stage."""
    o3d.utility.random.seed(seed)
    stages, last = {}, time.perf_counter()

    def done(stage):
        nonlocal last
        now = time.perf_counter()
        stages[stage], last = 1000 * (now - last), now

    points = back_project(case["depth"], case["mask"], case["camera"])
    target = open3d_stages.point_cloud(points)
    done("observe")
    source = open3d_stages.sample_surface(case["mesh"], SURFACE_SAMPLES)
    done("sample")
    scale = diagonal(points) / diagonal(np.asarray(source.points))
    source.scale(scale, center=np.zeros(3))
    voxel = diagonal(points) / VOXEL_DIVISIONS
    down = [open3d_stages.thin(source, voxel), open3d_stages.thin(target, voxel, viewpoint=np.zeros(3))]
    done("normals")
    features = [open3d_stages.describe(cloud, voxel) for cloud in down]
    done("features")
    coarse = open3d_stages.ransac(down, features, voxel, with_scaling)
    done("ransac")
    # The tutorial refines on the clouds as they came; the plane of each point has to be estimated first. On the thinned
    # clouds that is done, but points a voxel apart are no nearer to each other than that.
    if not thinned:
        open3d_stages.estimate_normals(target, voxel)
    done("planes")
    reach = voxel if thinned else open3d_stages.FINE_REACH_VOXELS * voxel
    fine = open3d_stages.refine(down if thinned else [source, target], reach, coarse)
    done("icp")
    matrix = np.array(fine) @ np.diag([scale, scale, scale, 1.0])
    return matrix, stages


def main():
    # Open3D writes its warnings to standard output: they go to standard error, out of the answers.
    answers = os.fdopen(os.dup(1), "w")
    os.dup2(2, 1)
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
