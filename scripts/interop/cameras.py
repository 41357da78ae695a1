"""Programs of cameras, poses and recordings."""

import dataclasses
import os
from pathlib import Path

import numpy as np

from .cells import dump


def pycolmap(c, t):
    import pycolmap

    def save(path, model, numbers):
        reconstruction = pycolmap.Reconstruction()
        camera = pycolmap.Camera(model=model, width=t.width, height=t.height, params=numbers, camera_id=1)
        reconstruction.add_camera_with_trivial_rig(camera)
        reconstruction.write_text(os.path.dirname(path))
        reconstruction.write_binary(os.path.dirname(path))

    c.writes(save=save)
    ours = t.read("poses.json")["opencv"]
    turn, position = pycolmap.Rotation3d(np.array(ours["rotation"])), np.array(ours["translation"])
    c.loads("pose", placed=[pycolmap.Sim3d(ours["scale"], turn, position) * each for each in t.points / 0.25])
    new = pycolmap.Camera.create_from_model_name(1, "PINHOLE", t.fx, t.width, t.height)
    c.loads("pixel", new=new.principal_point_x - (t.width - 1) / 2)


def open3d(c, t):
    import open3d as o3d

    parameters = o3d.camera.PinholeCameraParameters()
    parameters.intrinsic = o3d.camera.PinholeCameraIntrinsic(t.width, t.height, t.K)
    parameters.extrinsic = t.matrix
    trajectory = o3d.camera.PinholeCameraTrajectory()
    trajectory.parameters = [parameters]
    metadata = o3d.t.io.RGBDVideoMetadata()
    metadata.intrinsics, metadata.width, metadata.height = parameters.intrinsic, t.width, t.height
    metadata.depth_scale = 1000.0

    scene = o3d.t.geometry.RaycastingScene()
    scene.add_triangles(t.points.astype(np.float32), t.triangles.astype(np.uint32))
    # Rays go through (u + .5, v + .5) in the numbers of K.
    middles = t.K + [[0, 0, 0.5], [0, 0, 0.5], [0, 0, 0]]
    rays = o3d.t.geometry.RaycastingScene.create_rays_pinhole(middles, t.matrix, t.width, t.height)
    hit = scene.cast_rays(rays)["t_hit"].numpy()
    c.writes(
        parameters=lambda path: o3d.io.write_pinhole_camera_parameters(path, parameters),
        trajectory=lambda path: o3d.io.write_pinhole_camera_trajectory(path, trajectory),
        # What RSBagReader.save_frames writes.
        metadata=lambda path: Path(path).write_text(str(metadata)),
        depth=lambda path: np.save(path, hit),
        mask=lambda path: np.save(path, np.isfinite(hit)),
    )


def rosbags(c, t):
    import cv2
    from rosbags import rosbag1
    from rosbags.typesys import Stores, get_typestore

    def info(path, store, size, crop):
        """A message of a camera whose pictures have this size, and are cropped to x, y, height and width."""
        types = get_typestore(Stores[store]).types
        is_first = store == "ROS1_NOETIC"
        stamp = types["builtin_interfaces/msg/Time"](sec=1, nanosec=2)
        header = types["std_msgs/msg/Header"](stamp=stamp, frame_id="camera", **({"seq": 0} if is_first else {}))
        roi = types["sensor_msgs/msg/RegionOfInterest"](*crop, do_rectify=False)
        matrix = t.K + [[0, 0, crop[0]], [0, 0, crop[1]], [0, 0, 0]]
        numbers = {"d": np.zeros(5), "k": matrix.ravel(), "r": np.eye(3).ravel(), "p": np.c_[matrix, np.zeros(3)].ravel()}
        numbers = {key.upper() if is_first else key: each for key, each in numbers.items()}
        bins = {"binning_x": 0, "binning_y": 0}
        make = types["sensor_msgs/msg/CameraInfo"]
        dump(path, dataclasses.asdict(make(header, *size, distortion_model="plumb_bob", roi=roi, **bins, **numbers)))

    def compressed(path):
        # image_transport: twelve bytes of the configuration, then the PNG.
        Path(path).write_bytes(bytes(12) + cv2.imencode(".png", t.mm)[1].tobytes())

    def bag(path):
        with rosbag1.Writer(path):
            pass

    c.writes(info=info, compressed=compressed, bag=bag)


def mcap(c, t):
    from mcap.writer import Writer

    def save(path):
        with open(path, "wb") as file:
            writer = Writer(file)
            writer.start()
            writer.finish()

    c.writes(save=save)


def depthai(c, t):
    import depthai

    handler, socket = depthai.CalibrationHandler(), depthai.CameraBoardSocket.CAM_A
    handler.setCameraIntrinsics(socket, t.K.tolist(), t.width, t.height)
    handler.setDistortionCoefficients(socket, [0.0] * 14)
    c.writes(
        eeprom=lambda path: dump(path, handler.eepromToJson()),
        intrinsics=lambda path: dump(path, handler.getCameraIntrinsics(socket, t.width, t.height)),
    )


def realsense(c, t):
    import pyrealsense2 as rs

    lens = rs.intrinsics()
    names = {"width": "width", "height": "height", "fx": "fx", "fy": "fy", "ppx": "cx", "ppy": "cy"}
    for name, known in names.items():
        setattr(lens, name, getattr(t, known))

    def save(path, model, coefficients):
        lens.model, lens.coeffs = model, coefficients
        numbers = {name: getattr(lens, name) for name in [*names, "coeffs"]}
        dump(path, numbers | {"model": str(lens.model)})

    c.loads("pixel", deproject=rs.rs2_deproject_pixel_to_point(lens, [0, 0], 1.0)[0] * t.fx + t.cx)
    c.writes(save=save)


def scipy(c, t):
    from scipy.spatial.transform import Rotation

    cuboid = t.read("cuboid.json")
    drawn = Rotation.from_euler("XYZ", cuboid["points"][3:6])
    difference = (drawn.inv() * Rotation.from_quat(cuboid["cuboid"]["quaternion"])).magnitude()
    c.loads("cuboid", radians=difference)
    c.loads("pose", rotation=Rotation.from_quat(t.read("poses.json")["opencv"]["rotation"]).as_matrix())
