"""Whether our baselines agree with the originals: the same seeded inputs to both, and a table of what differs.

    python -m venv venv
    venv/bin/pip install numpy==2.4.6 open3d==0.20.0 small_gicp==1.0.1 kiss_matcher==1.0.2
    venv/bin/python scripts/bench/agreement.py --problems 20

Writes problems with the originals' answers as JSON, and has the test `baselines_agreement` read them, which prints the
table. The problems that are kept in `tests/fixtures/baselines/` are made by `tests/fixtures/make_baselines.py`.
"""

import argparse
import importlib.metadata
import json
import os
import pathlib
import subprocess
import tempfile

import kiss_matcher
import numpy as np
import open3d as o3d
import small_gicp

registration = o3d.pipelines.registration
KINDS = ("local", "matched", "upright")
PACKAGES = ("open3d", "small_gicp", "kiss_matcher", "numpy")


def versions():
    return {name: importlib.metadata.version(name) for name in PACKAGES}


# --- problems -------------------------------------------------------------------------------------------------------
def surface(rng, count, low):
    """Points and normals of a wavy sheet, six metres long, from x = `low` on: it fits itself in one place only."""
    x, y = rng.uniform([low, -3], 3, size=(count, 2)).T
    z = 0.8 * np.sin(1.2 * x) + 0.6 * np.cos(1.5 * y + 0.3) + 0.15 * x * y
    slope = np.stack([0.96 * np.cos(1.2 * x) + 0.15 * y, -0.9 * np.sin(1.5 * y + 0.3) + 0.15 * x], axis=1)
    normals = np.concatenate([-slope, np.ones((count, 1))], axis=1)
    return np.stack([x, y, z], axis=1), normals / np.linalg.norm(normals, axis=1, keepdims=True)


def rotation(rng, angle, axis=None):
    axis = rng.normal(size=3) if axis is None else np.asarray(axis, float)
    x, y, z = axis / np.linalg.norm(axis)
    k = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    return np.eye(3) + np.sin(angle) * k + (1 - np.cos(angle)) * k @ k


def rigid(r, t):
    matrix = np.eye(4)
    matrix[:3, :3], matrix[:3, 3] = r, t
    return matrix


def rounded(values):
    """As the JSON file holds them, and as a float32 does: both sides see the same numbers."""
    return np.round(np.asarray(values, np.float64), 3).astype(np.float32).astype(np.float64)


def local(rng):
    """Two samplings of one surface, the source partial, and a start some degrees and decimetres off."""
    target, target_normals = surface(rng, 400, -3)
    source, source_normals = surface(rng, 300, -1)
    truth = rigid(rotation(rng, 0.4), rng.uniform(-1, 1, 3))
    inverse = np.linalg.inv(truth)
    source = (source + rng.normal(scale=0.02, size=source.shape)) @ inverse[:3, :3].T + inverse[:3, 3]
    source_normals = source_normals @ inverse[:3, :3].T
    off = rigid(rotation(rng, 0.06), rng.uniform(-0.1, 0.1, 3))
    return {
        "source": rounded(source),
        "sourceNormals": rounded(source_normals),
        "target": rounded(target),
        "targetNormals": rounded(target_normals),
        "start": off @ truth,
        "reach": 1.0,
        "truth": truth,
    }


def matched(rng, upright=False):
    """Matches of which a third is wrong: as many as a solver without a look at their consistency withstands."""
    count = 240
    source = rng.uniform(-5, 5, size=(count, 3)) * [1, 0.8, 0.5]
    axis = [0, 0, 1] if upright else None
    truth = rigid(rotation(rng, rng.uniform(0.5, 2.5), axis), rng.uniform(-10, 10, 3))
    target = source @ truth[:3, :3].T + truth[:3, 3] + rng.uniform(-0.03, 0.03, size=source.shape)
    wrong = rng.permutation(count)[: count // 3]
    target[wrong] = rng.uniform(-5, 5, size=(len(wrong), 3)) + truth[:3, 3]
    return {"source": rounded(source), "target": rounded(target), "noiseBound": 0.1, "truth": truth}


def problem(kind, seed):
    rng = np.random.default_rng([KINDS.index(kind), seed])
    made = local(rng) if kind == "local" else matched(rng, upright=kind == "upright")
    return {"kind": kind, "seed": seed, **made}


# --- the originals --------------------------------------------------------------------------------------------------
def cloud(points, normals=None):
    made = o3d.geometry.PointCloud(o3d.utility.Vector3dVector(points))
    if normals is not None:
        made.normals = o3d.utility.Vector3dVector(normals)
    return made


def open3d_icp(p, estimation, register=registration.registration_icp, neighbors=None):
    source, target = cloud(p["source"], p["sourceNormals"]), cloud(p["target"], p["targetNormals"])
    if neighbors is not None:
        for side in (source, target):
            side.normals = o3d.utility.Vector3dVector()
            side.estimate_normals(o3d.geometry.KDTreeSearchParamKNN(neighbors))
    # Until nothing changes: an optimum is compared, not a stopping rule.
    criteria = registration.ICPConvergenceCriteria(1e-14, 1e-14, 300)
    return register(source, target, p["reach"], p["start"], estimation, criteria).transformation


def small_gicp_by(p, kind):
    """Not its PLANE_ICP: that multiplies normal and offset axis by axis and squares all three products, which is no
    distance to a plane."""
    source, target = small_gicp.PointCloud(p["source"]), small_gicp.PointCloud(p["target"])
    for side in (source, target):
        small_gicp.estimate_normals_covariances(side, num_neighbors=20)
    return small_gicp.align(
        target,
        source,
        init_T_target_source=p["start"],
        registration_type=kind,
        max_correspondence_distance=p["reach"],
        max_iterations=300,
        rotation_epsilon=1e-10,
        translation_epsilon=1e-10,
    ).T_target_source


def pairs_of(p):
    numbers = np.arange(len(p["source"]))
    return o3d.utility.Vector2iVector(np.stack([numbers, numbers], axis=1))


def open3d_fgr(p, tuple_test):
    o3d.utility.random.seed(p["seed"])
    option = registration.FastGlobalRegistrationOption(decrease_mu=True, tuple_test=tuple_test)
    clouds = (cloud(p["source"]), cloud(p["target"]))
    return registration.registration_fgr_based_on_correspondence(*clouds, pairs_of(p), option).transformation


def open3d_ransac(p):
    o3d.utility.random.seed(p["seed"])
    return registration.registration_ransac_based_on_correspondence(
        cloud(p["source"]),
        cloud(p["target"]),
        pairs_of(p),
        p["noiseBound"],
        registration.TransformationEstimationPointToPoint(False),
        3,
        [registration.CorrespondenceCheckerBasedOnEdgeLength(0.9)],
        registration.RANSACConvergenceCriteria(100_000, 0.999),
    ).transformation


def kiss(p, use_quatro):
    """Its solver on the matches as they are, without its pruning."""
    config = kiss_matcher.KISSMatcherConfig(voxel_size=p["noiseBound"], use_quatro=use_quatro)
    config.solver_noise_bound = p["noiseBound"]
    answer = kiss_matcher.KISSMatcher(config).solve(p["source"].T.copy(), p["target"].T.copy())
    return rigid(np.array(answer.rotation), np.array(answer.translation).ravel())


def without_disagreement(p, found):
    """Without small_gicp's answers where Open3D has another: its steps are not the closed form's, and nearest points may
    come to rest in several pairings. There is no one optimum to compare then."""
    for method in ("icp-point-to-point", "gicp"):
        off = np.abs(np.array(found[f"open3d {method}"]) - np.array(found[f"small_gicp {method}"])).max()
        if off > 1e-3:
            print(f"{p['kind']} {p['seed']}: small_gicp's {method} is {off:.1e} off Open3D's, and left out")
            del found[f"small_gicp {method}"]
    return found


def answers(p):
    if p["kind"] == "local":
        found = {
            "open3d icp-point-to-plane": open3d_icp(p, registration.TransformationEstimationPointToPlane()),
            "open3d icp-point-to-point": open3d_icp(p, registration.TransformationEstimationPointToPoint()),
            "open3d gicp": open3d_icp(
                p,
                registration.TransformationEstimationForGeneralizedICP(1e-3),
                registration.registration_generalized_icp,
                neighbors=20,
            ),
            "small_gicp icp-point-to-point": small_gicp_by(p, "ICP"),
            "small_gicp gicp": small_gicp_by(p, "GICP"),
        }
        return without_disagreement(p, found)
    if p["kind"] == "upright":
        return {"kiss_matcher quatro": kiss(p, True)}
    return {
        "open3d fgr": open3d_fgr(p, False),
        "open3d fgr, tuple test": open3d_fgr(p, True),
        "open3d ransac": open3d_ransac(p),
        "kiss_matcher teaser": kiss(p, False),
    }


# --- files ----------------------------------------------------------------------------------------------------------
def plain(value):
    """What JSON can hold: points one after the other, matrices column by column."""
    if isinstance(value, np.ndarray):
        flat = value.T.ravel() if value.shape == (4, 4) else value.ravel()
        # A point has three decimals; a float32's digits beyond them are noise that reading gives back.
        return [round(float(x), 12 if value.shape == (4, 4) else 3) for x in flat]
    return value


def write(folder, kind, seed):
    made = problem(kind, seed)
    made["answers"] = {name: plain(np.array(matrix)) for name, matrix in answers(made).items()}
    made["versions"] = versions()
    text = json.dumps({name: plain(value) for name, value in made.items()}, separators=(",", ":"))
    (folder / f"{kind}-{seed}.json").write_text(text + "\n")


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--problems", type=int, default=20, help="of each kind")
    parser.add_argument("--first-seed", type=int, default=100)
    arguments = parser.parse_args()
    print(versions())
    with tempfile.TemporaryDirectory() as folder:
        for kind in KINDS:
            for seed in range(arguments.first_seed, arguments.first_seed + arguments.problems):
                write(pathlib.Path(folder), kind, seed)
        command = ["cargo", "test", "--features", "bench", "--test", "suite", "baselines_agreement"]
        environment = {**os.environ, "SIM3ALIGN_AGREEMENT": folder}
        raise SystemExit(subprocess.run([*command, "--", "--nocapture"], env=environment).returncode)


if __name__ == "__main__":
    o3d.utility.set_verbosity_level(o3d.utility.VerbosityLevel.Error)
    main()
