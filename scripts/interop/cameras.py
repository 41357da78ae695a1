"""Programs that write cameras and poses."""

import json
import os

import numpy as np

from .cells import program
from .masks import dump

# COLMAP counts from the outer corner of the first pixel: half a pixel more than OpenCV.
HALF_PIXEL = np.array([0, 0, 0.5, 0.5])


@program("pycolmap")
def pycolmap_(c, t):
    import pycolmap

    four = np.array([t.fx, t.fy, t.cx, t.cy]) + HALF_PIXEL
    one = (t.fx, four[2], four[3])
    models = [
        ("SIMPLE_PINHOLE", one, "fx"),
        ("PINHOLE", four, None),
        ("SIMPLE_RADIAL", (*one, 0.0), "fx"),
        ("RADIAL", (*one, 0.02, -0.01), "fx"),
        ("OPENCV", (*four, 0.02, -0.01, 0, 0), None),
        ("FULL_OPENCV", (*four, 0.02, -0.01, 0, 0, 0.01, 0, 0, 0), None),
    ]

    def save(model, parameters):
        def write(path):
            reconstruction = pycolmap.Reconstruction()
            camera = pycolmap.Camera(
                model=model, width=t.width, height=t.height, params=list(map(float, parameters)), camera_id=1
            )
            if hasattr(reconstruction, "add_camera_with_trivial_rig"):
                reconstruction.add_camera_with_trivial_rig(camera)
            else:
                reconstruction.add_camera(camera)
            reconstruction.write_text(os.path.dirname(path))

        return write

    for model, parameters, square in models:
        expect = {"warns": "distortion"} if any(parameters[3 if square else 4 :]) else {}
        expect |= {"camera": {"fy": t.fx}} if square else {}
        c.write("camera", f"cameras.txt, {model}", "cameras.txt", save(model, parameters), **expect)
    for model in ("OPENCV_FISHEYE", "SIMPLE_RADIAL_FISHEYE"):
        fisheye = {"warns": "fisheye", "camera": {} if "OPENCV" in model else {"fy": t.fx}}
        parameters = (*four, 0.1, 0, 0, 0) if model == "OPENCV_FISHEYE" else (*one, 0.1)
        c.write("camera", f"cameras.txt, {model}", "cameras.txt", save(model, parameters), **fisheye)

    def binary(path):
        save("PINHOLE", four)(path)
        reconstruction = pycolmap.Reconstruction(os.path.dirname(path))
        reconstruction.write_binary(os.path.dirname(path))

    c.write("camera", "cameras.bin", "cameras.bin", binary, refused="UNSUPPORTED_FORMAT")
    camera = pycolmap.Camera(model="PINHOLE", width=t.width, height=t.height, params=four.tolist())
    # Its matrix counts from the corner, too; a matrix alone does not say so.
    matrix = lambda p: np.savetxt(p, camera.calibration_matrix() - [[0, 0, 0.5], [0, 0, 0.5], [0, 0, 0]])
    c.write("camera", "calibration_matrix() less half a pixel", "K.txt", matrix)

    def pose(path):
        rigid = pycolmap.Rigid3d(pycolmap.Rotation3d(t.quaternion), t.translation)
        quat = rigid.rotation.quat
        dump({"scale": 1, "rotation": list(map(float, quat)), "translation": list(map(float, rigid.translation))})(path)

    c.write("pose", "Rigid3d: quat and translation", "gt.json", pose)
    similar = pycolmap.Sim3d(1.0, pycolmap.Rotation3d(t.quaternion), t.translation)
    c.write("pose", "Sim3d.matrix()", "gt.txt", lambda p: np.savetxt(p, np.vstack([similar.matrix(), [0, 0, 0, 1]])))


@program("Open3D cameras", distribution="open3d")
def open3d_(c, t):
    import open3d as o3d

    intrinsic = o3d.camera.PinholeCameraIntrinsic(t.width, t.height, t.fx, t.fy, t.cx, t.cy)
    c.write("camera", "PinholeCameraIntrinsic", "camera.json", lambda p: o3d.io.write_pinhole_camera_intrinsic(p, intrinsic))
    parameters = o3d.camera.PinholeCameraParameters()
    parameters.intrinsic, parameters.extrinsic = intrinsic, t.matrix()
    c.write("camera", "PinholeCameraParameters", "camera.json", lambda p: o3d.io.write_pinhole_camera_parameters(p, parameters))
    trajectory = o3d.camera.PinholeCameraTrajectory()
    trajectory.parameters = [parameters]
    c.write("camera", "PinholeCameraTrajectory", "camera.json", lambda p: o3d.io.write_pinhole_camera_trajectory(p, trajectory))
    metadata = o3d.t.io.RGBDVideoMetadata()
    metadata.intrinsics, metadata.width, metadata.height = intrinsic, t.width, t.height
    metadata.depth_scale = 1000.0

    def video(path):
        with open(path, "w") as file:
            # What RSBagReader.save_frames writes.
            file.write(str(metadata)) if str(metadata).startswith("{") else o3d.io.write_pinhole_camera_intrinsic(path, intrinsic)

    c.write("camera", "RGBDVideoMetadata", "intrinsic.json", video)
    c.write("depth", "Image of millimetres, PNG", "depth.png", lambda p: o3d.io.write_image(p, o3d.geometry.Image(t.mm)), limitM=0.0005001)
    scene = o3d.t.geometry.RaycastingScene()
    scene.add_triangles(t.points.astype(np.float32), t.triangles.astype(np.uint32))
    # Rays go through (u + .5, v + .5) in the numbers of K.
    shifted = t.K + [[0, 0, 0.5], [0, 0, 0.5], [0, 0, 0]]
    rays = o3d.t.geometry.RaycastingScene.create_rays_pinhole(shifted, t.matrix(), t.width, t.height)
    hit = lambda: scene.cast_rays(rays)["t_hit"].numpy()
    c.write("depth", "t_hit of RaycastingScene, K with half a pixel more", "depth.npy", lambda p: np.save(p, hit()), only="mask", share=0.995, limitM=1e-5)
    c.write("mask", "t_hit of RaycastingScene", "mask.npy", lambda p: np.save(p, np.isfinite(hit())), limitPixels=4)


@program("rosbags")
def rosbags_(c, t):
    import cv2
    from rosbags.typesys import Stores, get_typestore

    stores = {"ROS 1": Stores.ROS1_NOETIC, "ROS 2": Stores.ROS2_HUMBLE}
    for name, store in stores.items():
        types = get_typestore(store).types
        info, roi = types["sensor_msgs/msg/CameraInfo"], types["sensor_msgs/msg/RegionOfInterest"]
        upper = name == "ROS 1"

        def message(cropped):
            matrix = t.K + ([[0, 0, 30], [0, 0, 20], [0, 0, 0]] if cropped else 0)
            size = [t.height + 50, t.width + 70] if cropped else [t.height, t.width]
            fields = {"height": size[0], "width": size[1], "distortion_model": "plumb_bob", "binning_x": 0, "binning_y": 0}
            numbers = {"d": np.zeros(5), "k": matrix.ravel(), "r": np.eye(3).ravel(), "p": np.c_[matrix, np.zeros(3)].ravel()}
            fields |= {(key.upper() if upper else key): each for key, each in numbers.items()}
            crop = (30, 20, t.height, t.width, False) if cropped else (0, 0, 0, 0, False)
            fields["roi"] = roi(x_offset=crop[0], y_offset=crop[1], height=crop[2], width=crop[3], do_rectify=crop[4])
            header = types["std_msgs/msg/Header"]
            stamp = types["builtin_interfaces/msg/Time"](sec=1, nanosec=2)
            extra = {"seq": 0} if upper else {}
            return info(header=header(stamp=stamp, frame_id="camera", **extra), **fields)

        def plain(value):
            if hasattr(value, "__dataclass_fields__"):
                return {key: plain(getattr(value, key)) for key in value.__dataclass_fields__ if not key.startswith("__")}
            return value.tolist() if isinstance(value, np.ndarray) else value

        for cropped in (False, True):
            variant = f"CameraInfo of {name}{', region of interest' if cropped else ''}"
            c.write("camera", f"{variant}, JSON", "camera_info.json", dump(lambda: plain(message(cropped))))

        def depth(path):
            # image_transport: twelve bytes of the configuration, then the PNG.
            packed = types["sensor_msgs/msg/CompressedImage"]
            header = message(False).header
            data = np.frombuffer(bytes(12) + cv2.imencode(".png", t.mm)[1].tobytes(), np.uint8)
            image = packed(header=header, format="16UC1; compressedDepth png", data=data)
            with open(path, "wb") as file:
                file.write(image.data.tobytes())

        c.write("depth", f"compressedDepth of {name}", "depth.png", depth, refused="UNSUPPORTED_FORMAT", says="compressedDepth")

    def bag(path):
        from rosbags import rosbag1

        store = get_typestore(Stores.ROS1_NOETIC)
        with rosbag1.Writer(path) as recording:
            text = store.types["std_msgs/msg/String"](data="depth")
            topic = recording.add_connection("/depth", text.__msgtype__, typestore=store)
            recording.write(topic, 1, store.serialize_ros1(text, text.__msgtype__))

    c.write("depth", "a bag of ROS 1", "depth.bag", bag, **RECORDING)


RECORDING = {"refused": "UNSUPPORTED_FORMAT", "says": "a recording of ROS"}


@program("MCAP", distribution="mcap")
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

    c.write("depth", "a recording", "depth.mcap", save, **RECORDING)


@program("DepthAI", distribution="depthai")
def depthai_(c, t):
    import depthai

    handler = depthai.CalibrationHandler()
    socket = depthai.CameraBoardSocket.CAM_A
    handler.setCameraIntrinsics(socket, t.K.tolist(), t.width, t.height)
    handler.setDistortionCoefficients(socket, [0.0] * 14)
    c.write("camera", "eepromToJson", "calib.json", dump(lambda: handler.eepromToJson()))
    c.write("camera", "getCameraIntrinsics", "K.json", dump(lambda: handler.getCameraIntrinsics(socket, t.width, t.height)))


@program("RealSense", distribution="pyrealsense2")
def realsense_(c, t):
    import pyrealsense2 as rs

    intrinsics = rs.intrinsics()
    intrinsics.width, intrinsics.height = t.width, t.height
    intrinsics.fx, intrinsics.fy, intrinsics.ppx, intrinsics.ppy = t.fx, t.fy, t.cx, t.cy
    names = ("width", "height", "ppx", "ppy", "fx", "fy", "coeffs")
    fields = lambda: {name: getattr(intrinsics, name) for name in names} | {"model": str(intrinsics.model)}
    c.write("camera", "fields of rs.intrinsics", "intrinsics.json", dump(fields))
    intrinsics.model, intrinsics.coeffs = rs.distortion.brown_conrady, [0.1, -0.2, 0.001, 0.0, 0.0]
    c.write("camera", "fields of rs.intrinsics, distorted", "intrinsics.json", dump(fields), warns="distortion")


@program("SciPy", distribution="scipy")
def scipy_(c, t):
    from scipy.spatial.transform import Rotation

    turn = Rotation.from_quat(t.quaternion)
    pose = lambda rotation: {"scale": 1.0, "rotation": np.asarray(rotation).tolist(), "translation": t.translation.tolist()}
    c.write("pose", "as_quat()", "gt.json", dump(lambda: pose(turn.as_quat())))
    c.write("pose", "as_matrix()", "gt.json", dump(lambda: pose(turn.as_matrix())))
    first = turn.as_quat(scalar_first=True) if c.version >= "1.14" else None
    if first is not None:
        c.write("pose", "as_quat(scalar_first=True), reordered", "gt.json", dump(lambda: pose(np.roll(first, -1))))
