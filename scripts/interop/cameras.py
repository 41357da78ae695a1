"""Programs of cameras, poses and recordings."""

import os
from pathlib import Path

import numpy as np

from .cells import MM, REFUSED, dump, program, rotation
from .places import PIXEL

RECORDING = REFUSED | {"says": "a recording of ROS"}
# COLMAP counts from the outer corner of the first pixel: half a pixel more than OpenCV.
HALF_PIXEL = np.array([[0, 0, 0.5], [0, 0, 0.5], [0, 0, 0]])


def pose_of(t, turn):
    return {"scale": 1.0, "rotation": turn, "translation": t.translation}


@program("pycolmap")
def pycolmap_(c, t):
    import pycolmap

    four = [t.fx, t.fy, t.cx + 0.5, t.cy + 0.5]
    one = [t.fx, *four[2:]]

    def camera(model, parameters):
        return pycolmap.Camera(model=model, width=t.width, height=t.height, params=parameters, camera_id=1)

    def save(path, model, parameters):
        reconstruction = pycolmap.Reconstruction()
        reconstruction.add_camera_with_trivial_rig(camera(model, parameters))
        reconstruction.write_text(os.path.dirname(path))
        reconstruction.write_binary(os.path.dirname(path))

    square = {"camera": {"fy": t.fx}}
    distorted, fisheye = {"warns": "distortion"}, {"warns": "fisheye"}
    for model, parameters, expect in (
        ("SIMPLE_PINHOLE", one, square),
        ("PINHOLE", four, {}),
        ("SIMPLE_RADIAL", [*one, 0.0], square),
        ("RADIAL", [*one, 0.02, -0.01], distorted | square),
        ("OPENCV", [*four, 0.02, -0.01, 0, 0], distorted),
        ("FULL_OPENCV", [*four, 0.02, -0.01, 0, 0, 0.01, 0, 0, 0], distorted),
        ("OPENCV_FISHEYE", [*four, 0.1, 0, 0, 0], fisheye),
        ("SIMPLE_RADIAL_FISHEYE", [*one, 0.1], fisheye | square),
    ):
        c.write("camera", f"cameras.txt, {model}", "cameras.txt", expect, save, model, parameters)
    c.write("camera", "cameras.bin", "cameras.bin", REFUSED, save, "PINHOLE", four)
    # Its matrix counts from the corner, too; a matrix alone does not say so.
    matrix = camera("PINHOLE", four).calibration_matrix() - HALF_PIXEL
    c.write("camera", "calibration_matrix() less half a pixel", "K.txt", {}, np.savetxt, matrix)
    turn = pycolmap.Rotation3d(t.quaternion)
    rigid = pycolmap.Rigid3d(turn, t.translation)
    c.write("pose", "Rigid3d: quat and translation", "gt.json", {}, dump, pose_of(t, rigid.rotation.quat))
    similar = np.vstack([pycolmap.Sim3d(1.0, turn, t.translation).matrix(), [0, 0, 0, 1]])
    c.write("pose", "Sim3d.matrix()", "gt.txt", {}, np.savetxt, similar)

    ours = t.read("poses.json")["opencv"]
    turn, position = pycolmap.Rotation3d(np.array(ours["rotation"])), np.array(ours["translation"])
    moved = [pycolmap.Sim3d(ours["scale"], turn, position) * each for each in t.points / 0.25]
    c.points("pose", "Sim3d of x, y, z, w", moved, t.placed)
    new = pycolmap.Camera.create_from_model_name(1, "PINHOLE", t.fx, t.width, t.height)
    c.place(PIXEL, "the principal point of a new `Camera`", new.principal_point_x - (t.width - 1) / 2, 0.5)


@program("Open3D cameras")
def open3d_(c, t):
    import open3d as o3d

    intrinsic = o3d.camera.PinholeCameraIntrinsic(t.width, t.height, t.fx, t.fy, t.cx, t.cy)
    parameters = o3d.camera.PinholeCameraParameters()
    parameters.intrinsic, parameters.extrinsic = intrinsic, t.matrix
    trajectory = o3d.camera.PinholeCameraTrajectory()
    trajectory.parameters = [parameters]
    io = o3d.io
    c.write("camera", "PinholeCameraIntrinsic", "camera.json", {}, io.write_pinhole_camera_intrinsic, intrinsic)
    c.write("camera", "PinholeCameraParameters", "camera.json", {}, io.write_pinhole_camera_parameters, parameters)
    c.write("camera", "PinholeCameraTrajectory", "camera.json", {}, io.write_pinhole_camera_trajectory, trajectory)
    metadata = o3d.t.io.RGBDVideoMetadata()
    metadata.intrinsics, metadata.width, metadata.height = intrinsic, t.width, t.height
    metadata.depth_scale = 1000.0
    # What RSBagReader.save_frames writes.
    c.write("camera", "RGBDVideoMetadata", "intrinsic.json", {}, lambda p: Path(p).write_text(str(metadata)))
    image = o3d.geometry.Image(t.mm)
    c.write("depth", "Image of millimetres, PNG", "depth.png", MM, io.write_image, image)
    scene = o3d.t.geometry.RaycastingScene()
    scene.add_triangles(t.points.astype(np.float32), t.triangles.astype(np.uint32))
    # Rays go through (u + .5, v + .5) in the numbers of K.
    rays = o3d.t.geometry.RaycastingScene.create_rays_pinhole(t.K + HALF_PIXEL, t.matrix, t.width, t.height)
    hit = scene.cast_rays(rays)["t_hit"].numpy()
    limits = {"only": "mask", "share": 0.995, "limitM": 1e-5}
    c.write("depth", "t_hit of RaycastingScene, K with half a pixel more", "depth.npy", limits, np.save, hit)
    c.write("mask", "t_hit of RaycastingScene", "mask.npy", {"limitPixels": 4}, np.save, np.isfinite(hit))


@program("rosbags")
def rosbags_(c, t):
    import dataclasses

    import cv2
    from rosbags import rosbag1
    from rosbags.typesys import Stores, get_typestore

    def info(types, size, crop):
        """A message of a camera whose pictures have this size, and are cropped to x, y, height and width."""
        is_first = "seq" in types["std_msgs/msg/Header"].__dataclass_fields__
        stamp = types["builtin_interfaces/msg/Time"](sec=1, nanosec=2)
        header = types["std_msgs/msg/Header"](stamp=stamp, frame_id="camera", **({"seq": 0} if is_first else {}))
        roi = types["sensor_msgs/msg/RegionOfInterest"](*crop, do_rectify=False)
        matrix = t.K + [[0, 0, crop[0]], [0, 0, crop[1]], [0, 0, 0]]
        numbers = {"d": np.zeros(5), "k": matrix.ravel(), "r": np.eye(3).ravel(), "p": np.c_[matrix, np.zeros(3)].ravel()}
        numbers = {key.upper() if is_first else key: each for key, each in numbers.items()}
        bins = {"binning_x": 0, "binning_y": 0}
        make = types["sensor_msgs/msg/CameraInfo"]
        message = make(header, *size, distortion_model="plumb_bob", roi=roi, **bins, **numbers)
        return dataclasses.asdict(message)

    # image_transport: twelve bytes of the configuration, then the PNG.
    compressed = bytes(12) + cv2.imencode(".png", t.mm)[1].tobytes()
    for name, store in {"ROS 1": Stores.ROS1_NOETIC, "ROS 2": Stores.ROS2_HUMBLE}.items():
        types = get_typestore(store).types
        whole = info(types, (t.height, t.width), (0, 0, 0, 0))
        part = info(types, (t.height + 50, t.width + 70), (30, 20, t.height, t.width))
        c.write("camera", f"CameraInfo of {name}, JSON", "camera_info.json", {}, dump, whole)
        c.write("camera", f"CameraInfo of {name}, region of interest, JSON", "camera_info.json", {}, dump, part)
        write = lambda p: Path(p).write_bytes(compressed)
        c.write("depth", f"compressedDepth of {name}", "depth.png", REFUSED | {"says": "compressedDepth"}, write)

    def bag(path):
        store = get_typestore(Stores.ROS1_NOETIC)
        with rosbag1.Writer(path) as recording:
            text = store.types["std_msgs/msg/String"](data="depth")
            topic = recording.add_connection("/depth", text.__msgtype__, typestore=store)
            recording.write(topic, 1, store.serialize_ros1(text, text.__msgtype__))

    c.write("depth", "a bag of ROS 1", "depth.bag", RECORDING, bag)


@program("MCAP")
def mcap_(c, t):
    from mcap.writer import Writer

    def save(path):
        with open(path, "wb") as file:
            writer = Writer(file)
            writer.start()
            schema = writer.register_schema(name="sensor_msgs/msg/Image", encoding="ros2msg", data=b"uint32 height")
            channel = writer.register_channel(topic="/depth", message_encoding="cdr", schema_id=schema)
            writer.add_message(channel, log_time=0, publish_time=0, data=t.mm.tobytes())
            writer.finish()

    c.write("depth", "a recording", "depth.mcap", RECORDING, save)


@program("DepthAI")
def depthai_(c, t):
    import depthai

    handler, socket = depthai.CalibrationHandler(), depthai.CameraBoardSocket.CAM_A
    handler.setCameraIntrinsics(socket, t.K.tolist(), t.width, t.height)
    handler.setDistortionCoefficients(socket, [0.0] * 14)
    c.write("camera", "eepromToJson", "calib.json", {}, dump, handler.eepromToJson())
    c.write("camera", "getCameraIntrinsics", "K.json", {}, dump, handler.getCameraIntrinsics(socket, t.width, t.height))


@program("RealSense")
def realsense_(c, t):
    import pyrealsense2 as rs

    numbers = {"width": t.width, "height": t.height, "fx": t.fx, "fy": t.fy, "ppx": t.cx, "ppy": t.cy}
    lens = rs.intrinsics()
    for name, number in numbers.items():
        setattr(lens, name, number)
    fields = lambda: numbers | {"coeffs": lens.coeffs, "model": str(lens.model)}
    c.write("camera", "fields of rs.intrinsics", "intrinsics.json", {}, dump, fields())
    first = rs.rs2_deproject_pixel_to_point(lens, [0, 0], 1.0)[0] * t.fx + t.cx
    c.place(PIXEL, "`rs2_deproject_pixel_to_point`", first, 0, 1e-4)
    lens.model, lens.coeffs = rs.distortion.brown_conrady, [0.1, -0.2, 0.001, 0.0, 0.0]
    c.write("camera", "fields of rs.intrinsics, distorted", "intrinsics.json", {"warns": "distortion"}, dump, fields())


@program("SciPy")
def scipy_(c, t):
    from scipy.spatial.transform import Rotation

    turn = Rotation.from_quat(t.quaternion)
    reordered = np.roll(turn.as_quat(scalar_first=True), -1)
    c.write("pose", "as_quat()", "gt.json", {}, dump, pose_of(t, turn.as_quat()))
    c.write("pose", "as_matrix()", "gt.json", {}, dump, pose_of(t, turn.as_matrix()))
    c.write("pose", "as_quat(scalar_first=True), reordered", "gt.json", {}, dump, pose_of(t, reordered))
    ours = Rotation.from_quat(t.read("poses.json")["opencv"]["rotation"])
    c.measure("pose", "from_quat", ours.as_matrix() - rotation(t.quaternion), 1e-9)
    cuboid = t.read("cuboid.json")
    drawn = Rotation.from_euler("XYZ", cuboid["points"][3:6])
    difference = (drawn.inv() * Rotation.from_quat(cuboid["cuboid"]["quaternion"])).magnitude()
    c.measure("cuboid", "from_euler XYZ of CVAT's points, radians", difference, 1e-9)
