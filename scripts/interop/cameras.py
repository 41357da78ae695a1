"""Programs of cameras, poses and recordings."""

import dataclasses
import os
from pathlib import Path

import numpy as np

from .cells import dump

# COLMAP counts from the outer corner of the first pixel: half a pixel more than OpenCV.
HALF_PIXEL = np.array([[0, 0, 0.5], [0, 0, 0.5], [0, 0, 0]])


def pycolmap(c, t):
    import pycolmap

    def camera(model, numbers):
        return pycolmap.Camera(model=model, width=t.width, height=t.height, params=numbers, camera_id=1)

    def save(path, model, numbers):
        reconstruction = pycolmap.Reconstruction()
        reconstruction.add_camera_with_trivial_rig(camera(model, numbers))
        reconstruction.write_text(os.path.dirname(path))
        reconstruction.write_binary(os.path.dirname(path))

    # Its matrix counts from the corner, too; a matrix alone does not say so.
    matrix = camera("PINHOLE", [t.fx, t.fy, t.cx + 0.5, t.cy + 0.5]).calibration_matrix() - HALF_PIXEL
    turn = pycolmap.Rotation3d(t.quaternion)
    similar = np.vstack([pycolmap.Sim3d(1.0, turn, t.translation).matrix(), [0, 0, 0, 1]])
    rotation = pycolmap.Rigid3d(turn, t.translation).rotation.quat
    c.writes(
        save=save,
        matrix=lambda path: np.savetxt(path, matrix),
        similar=lambda path: np.savetxt(path, similar),
        rigid=lambda path, **pose: dump(path, pose | {"rotation": rotation}),
    )

    ours = t.read("poses.json")["opencv"]
    turn, position = pycolmap.Rotation3d(np.array(ours["rotation"])), np.array(ours["translation"])
    c.loads("pose", placed=[pycolmap.Sim3d(ours["scale"], turn, position) * each for each in t.points / 0.25])
    new = pycolmap.Camera.create_from_model_name(1, "PINHOLE", t.fx, t.width, t.height)
    c.loads("pixel", new=new.principal_point_x - (t.width - 1) / 2)


def open3d_cameras(c, t):
    import open3d as o3d

    intrinsic = o3d.camera.PinholeCameraIntrinsic(t.width, t.height, t.fx, t.fy, t.cx, t.cy)
    parameters = o3d.camera.PinholeCameraParameters()
    parameters.intrinsic, parameters.extrinsic = intrinsic, t.matrix
    trajectory = o3d.camera.PinholeCameraTrajectory()
    trajectory.parameters = [parameters]
    metadata = o3d.t.io.RGBDVideoMetadata()
    metadata.intrinsics, metadata.width, metadata.height = intrinsic, t.width, t.height
    metadata.depth_scale = 1000.0

    scene = o3d.t.geometry.RaycastingScene()
    scene.add_triangles(t.points.astype(np.float32), t.triangles.astype(np.uint32))
    # Rays go through (u + .5, v + .5) in the numbers of K.
    rays = o3d.t.geometry.RaycastingScene.create_rays_pinhole(t.K + HALF_PIXEL, t.matrix, t.width, t.height)
    hit = scene.cast_rays(rays)["t_hit"].numpy()
    c.writes(
        intrinsic=lambda path: o3d.io.write_pinhole_camera_intrinsic(path, intrinsic),
        parameters=lambda path: o3d.io.write_pinhole_camera_parameters(path, parameters),
        trajectory=lambda path: o3d.io.write_pinhole_camera_trajectory(path, trajectory),
        # What RSBagReader.save_frames writes.
        metadata=lambda path: Path(path).write_text(str(metadata)),
        image=lambda path, array: o3d.io.write_image(path, o3d.geometry.Image(array)),
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
        message = make(header, *size, distortion_model="plumb_bob", roi=roi, **bins, **numbers)
        dump(path, dataclasses.asdict(message))

    def compressed(path):
        # image_transport: twelve bytes of the configuration, then the PNG.
        Path(path).write_bytes(bytes(12) + cv2.imencode(".png", t.mm)[1].tobytes())

    def bag(path):
        store = get_typestore(Stores.ROS1_NOETIC)
        with rosbag1.Writer(path) as recording:
            text = store.types["std_msgs/msg/String"](data="depth")
            topic = recording.add_connection("/depth", text.__msgtype__, typestore=store)
            recording.write(topic, 1, store.serialize_ros1(text, text.__msgtype__))

    c.writes(info=info, compressed=compressed, bag=bag)


def mcap(c, t):
    from mcap.writer import Writer

    def save(path):
        with open(path, "wb") as file:
            writer = Writer(file)
            writer.start()
            channel = writer.register_channel(topic="/depth", message_encoding="cdr", schema_id=0)
            writer.add_message(channel, log_time=0, publish_time=0, data=t.mm.tobytes())
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
        lens.model, lens.coeffs = getattr(rs.distortion, model), coefficients
        numbers = {name: getattr(lens, name) for name in [*names, "coeffs"]}
        dump(path, numbers | {"model": str(lens.model)})

    c.loads("pixel", deproject=rs.rs2_deproject_pixel_to_point(lens, [0, 0], 1.0)[0] * t.fx + t.cx)
    c.writes(save=save)


def scipy(c, t):
    from scipy.spatial.transform import Rotation

    turn = Rotation.from_quat(t.quaternion)
    turns = {"xyzw": turn.as_quat(), "wxyz": np.roll(turn.as_quat(scalar_first=True), -1), "matrix": turn.as_matrix()}
    c.writes(save=lambda path, rotation, **pose: dump(path, pose | {"rotation": turns[rotation]}))
    ours = Rotation.from_quat(t.read("poses.json")["opencv"]["rotation"])
    cuboid = t.read("cuboid.json")
    drawn = Rotation.from_euler("XYZ", cuboid["points"][3:6])
    difference = (drawn.inv() * Rotation.from_quat(cuboid["cuboid"]["quaternion"])).magnitude()
    c.loads("pose", rotation=ours.as_matrix())
    c.loads("cuboid", radians=difference)
