"""Holds a recording in all layouts to the triangles of target `ply`, met by rays of Embree, and its layouts to each other.

    check_recording.py RECORDING_DIR PLY_DIR

The recording has a folder for each layout, and noise of nothing but images: `tests/python/test_record_checks.py` has the rig.

- evo reads the true poses of all layouts, and they are the same path.
- Depth, normals and labels of every pixel are those of a ray through it (999 of 1000 pixels beside silhouettes, within 1 mm).
- Depth of a frame, moved by the true poses, is that of the fifth frame after it; flow leads to where its points are in the next.
- Points of the lidar, moved by the path at their times, are on the surfaces; KITTI's scans have the same points.
- The IMU integrates to the path.
- ROS 2 messages, decoded by mcap-ros2-support, tell the same.
- Images are neither dark nor flat nor burnt out, and lists and calibrations name what is there.
"""

import json
import sys
import zlib
from pathlib import Path

import numpy as np
import plyfile
import trimesh
import yaml
from evo.core.trajectory import PoseTrajectory3D
from evo.tools import file_interface
from mcap.reader import make_reader
from mcap_ros2.decoder import DecoderFactory
from PIL import Image
from scipy.spatial.transform import Rotation, Slerp

WITHIN_M = 0.001
MOST_OTHER = 0.001
UNITS_PER_M = 5000
KITTI_UNITS_PER_M = 256
GRAVITY = 9.81
LATER = 5
# Where the depth jumps by more than this share from one pixel to the next there may be a silhouette.
JUMP = 0.05


class Failure(Exception):
    """What is wrong with a recording."""


def require(truth, message):
    if not truth:
        raise Failure(message)


class Camera:
    """A pinhole from ORB-SLAM3's settings."""

    def __init__(self, folder):
        self.settings = opencv_yaml(folder / "orbslam3.yaml")
        self.size = [int(self.settings[f"Camera.{side}"]) for side in ("width", "height")]
        self.focal = np.array([self.settings["Camera1.fx"], self.settings["Camera1.fy"]])
        self.centre = np.array([self.settings["Camera1.cx"], self.settings["Camera1.cy"]])
        x, y = np.meshgrid(*[np.arange(side) for side in self.size])
        places = (np.stack([x, y], axis=-1) - self.centre) / self.focal
        self.rays = np.concatenate([places, np.ones_like(places[..., :1])], axis=-1)

    def pixels(self, points):
        return points[..., :2] / points[..., 2:] * self.focal + self.centre


class Recording:
    """The layout `tum` of a recording."""

    def __init__(self, folder):
        self.folder = folder / "tum"
        self.about = json.loads((folder / "recording.json").read_text(encoding="utf-8"))
        self.camera = Camera(self.folder)
        self.truth = file_interface.read_tum_trajectory_file(self.folder / "groundtruth.txt")
        lines = (self.folder / "associations.txt").read_text(encoding="utf-8").split("\n")
        rows = [line.split() for line in lines if line]
        self.times, self.images, self.depths = (
            [row[0] for row in rows],
            [row[1] for row in rows],
            [row[3] for row in rows],
        )
        require(len(rows) == self.about["counts"]["left"], f"associations.txt has {len(rows)} frames")

    def pose(self, time):
        """Rotation and place of the camera, which evo has read."""
        [index] = np.flatnonzero(np.abs(self.truth.timestamps - float(time)) < 2e-6)
        pose = self.truth.poses_se3[index]
        return pose[:3, :3], pose[:3, 3]

    def depth(self, number):
        return self.array(self.depths[number]) / UNITS_PER_M

    def array(self, path):
        image = Image.open(self.folder / path)
        require(image.size == tuple(self.camera.size), f"{path} is of {image.size} pixels")
        return np.asarray(image).astype(float)


def deep(path):
    """A PNG of three channels with 16 bits, of which Pillow keeps only 8."""
    data = path.read_bytes()
    width = int.from_bytes(data[16:20])
    require(data[24:26] == bytes([16, 2]), f"{path.name} has no 16 bits of red, green and blue")
    rows = zlib.decompress(b"".join(body for kind, body in chunks(data) if kind == b"IDAT"))
    rows = np.frombuffer(rows, np.uint8).reshape(-1, 1 + 6 * width)
    above, lines = np.zeros(6 * width, np.uint8), []
    for row in rows:
        above = unfiltered(row[0], row[1:].copy(), above)
        lines.append(above)
    return np.stack(lines).reshape(-1, width, 3, 2) @ np.array([256, 1])


def chunks(data):
    at = 8
    while at < len(data):
        length = int.from_bytes(data[at : at + 4])
        yield data[at + 4 : at + 8], data[at + 8 : at + 8 + length]
        at += 12 + length


def unfiltered(kind, row, above):
    """The bytes of a row of six a pixel, by the filters of PNG."""
    if kind in (0, 2):
        return row + above if kind else row
    for at in range(len(row)):
        left, corner = (int(row[at - 6]), int(above[at - 6])) if at >= 6 else (0, 0)
        upper = int(above[at])
        guess = left + upper - corner
        paeth = min((left, upper, corner), key=lambda value: abs(guess - value))
        row[at] = (int(row[at]) + {1: left, 3: (left + upper) // 2, 4: paeth}[int(kind)]) % 256
    return row


class World:
    """The triangles of a PLY and their labels."""

    def __init__(self, folder):
        [path] = folder.glob("*.ply")
        data = plyfile.PlyData.read(path)
        face = data["face"].data
        corners = np.stack([data["vertex"][axis] for axis in "xyz"], axis=1)
        self.labels = np.asarray(face["label"])
        self.mesh = trimesh.Trimesh(corners, np.stack(face["vertex_indices"]).astype(np.int64), process=False)

    def meet(self, origins, rays):
        """Distance along each ray and the face there; infinite where there is none."""
        faces = self.mesh.ray.intersects_first(origins, rays)
        away = np.full(len(rays), np.inf)
        met = faces >= 0
        normals, first = self.mesh.face_normals[faces[met]], self.mesh.triangles[faces[met], 0]
        slope = np.einsum("ij,ij->i", normals, rays[met])
        away[met] = np.einsum("ij,ij->i", normals, first - origins[met]) / np.where(slope == 0, np.nan, slope)
        return away, faces


def opencv_yaml(path):
    """YAML as OpenCV writes it: its directive is not that of YAML, and it has matrices."""

    class Loader(yaml.SafeLoader):
        pass

    Loader.add_constructor(
        "tag:yaml.org,2002:opencv-matrix", lambda loader, node: loader.construct_mapping(node, deep=True)
    )
    text = path.read_text(encoding="utf-8")
    require(text.startswith("%YAML:1.0\n"), f"{path.name} is not what OpenCV reads")
    return yaml.load(text.split("\n", 1)[1], Loader)


def verify(folder, world):
    recording = Recording(folder)
    check_images(recording)
    other = check_surfaces(recording, world)
    moved = check_later(recording)
    check_flow(recording)
    check_layouts(recording, folder)
    check_lidar(recording, folder, world)
    check_inertia(recording, folder)
    check_messages(recording, folder)
    return f"recording: {len(recording.times)} frames, {other:.4%} of pixels unlike the rays, {moved:.2%} unlike five frames later"


def check_images(recording):
    for path in recording.images:
        image = Image.open(recording.folder / path)
        require(image.mode == "RGB", f"{path} is of mode {image.mode}")
        grey = np.asarray(image.convert("L")).astype(float)
        require(40 < grey.mean() < 120, f"{path} has a mean of {grey.mean()}")
        require(grey.std() > 15, f"{path} is flat")
        require((grey > 250).mean() < 0.1, f"{path} is burnt out")


def silhouettes(depth):
    """Pixels beside which the depth jumps, or nothing is."""
    beside = np.zeros(depth.shape, bool)
    for axis in (0, 1):
        steps = np.abs(np.diff(depth, axis=axis)) > JUMP * np.minimum(*halves(depth, axis))
        before, after = [(slice(None, -1), slice(1, None))[k] for k in (0, 1)]
        for side in (before, after):
            index = (side, slice(None)) if axis == 0 else (slice(None), side)
            beside[index] |= steps
    return beside | (depth == 0)


def halves(depth, axis):
    return (depth[:-1], depth[1:]) if axis == 0 else (depth[:, :-1], depth[:, 1:])


def check_surfaces(recording, world):
    """The share of pixels at which a ray meets something else."""
    other = []
    for number, time in enumerate(recording.times):
        turn, place = recording.pose(time)
        rays = recording.camera.rays.reshape(-1, 3) @ turn.T
        away, faces = world.meet(np.tile(place, (len(rays), 1)), rays)
        depth = recording.depth(number)
        apart = np.abs(away.reshape(depth.shape) - depth)
        plain = ~silhouettes(depth) & (depth > 0)
        require(plain.mean() > 0.5, f"{time}: there is depth at {plain.mean():.0%} of pixels")
        other.append((apart[plain] > WITHIN_M).mean())
        labels = recording.array(f"label/{time}.png")
        unlike = (labels != world.labels[faces].reshape(depth.shape))[plain].mean()
        require(unlike < 2 * MOST_OTHER, f"{time}: labels of {unlike:.2%} of pixels are others")
        if number == 0:
            check_normals(recording, time, plain, world.mesh.face_normals[faces] @ turn)
    require(np.mean(other) < MOST_OTHER, f"depth of {np.mean(other):.2%} of pixels is not that of a ray")
    return np.mean(other)


def check_normals(recording, time, plain, expected):
    normals = deep(recording.folder / f"normal/{time}.png") / 32767.5 - 1
    cosines = np.einsum("ijk,ijk->ij", normals, expected.reshape(normals.shape))
    unlike = (np.abs(cosines - 1) > 1e-3)[plain].mean()
    require(unlike < 2 * MOST_OTHER, f"normals of {unlike:.2%} of pixels are others")


def points(recording, number):
    """The points of a depth image in the scene."""
    turn, place = recording.pose(recording.times[number])
    return (recording.camera.rays * recording.depth(number)[..., None]) @ turn.T + place


def seen_at(recording, number, points):
    """Points in the frame of the camera at another frame, and their pixels."""
    turn, place = recording.pose(recording.times[number])
    there = (points - place) @ turn
    return there, recording.camera.pixels(np.where(there[..., 2:] > 0.05, there, np.nan))


def check_later(recording):
    """The share of points of a frame that are not where they should be in the fifth after it."""
    require(len(recording.times) > LATER, "there are too few frames")
    unlike = []
    for number in range(len(recording.times) - LATER):
        there, pixels = seen_at(recording, number + LATER, points(recording, number))
        depth = recording.depth(number + LATER)
        inside = (
            np.isfinite(pixels).all(axis=-1)
            & (pixels > 1).all(axis=-1)
            & (pixels < np.array(recording.camera.size) - 2).all(axis=-1)
        )
        inside &= ~silhouettes(recording.depth(number))
        x, y = np.floor(np.where(inside[..., None], pixels, 1)).astype(int).transpose(2, 0, 1)
        corners = np.stack([depth[y + j, x + i] for j in (0, 1) for i in (0, 1)])
        z, near, far = there[..., 2], corners.min(axis=0), corners.max(axis=0)
        # Behind what has come in front of it, a point is hidden.
        visible = inside & (z < far * (1 + JUMP)) & (near > 0) & (far < near * (1 + JUMP))
        require(visible.mean() > 0.3, f"only {visible.mean():.0%} of frame {number} is seen later")
        unlike.append(((z < near * 0.995) | (z > far * 1.005))[visible].mean())
    require(np.mean(unlike) < 0.01, f"{np.mean(unlike):.2%} of points are elsewhere five frames later")
    return np.mean(unlike)


def check_flow(recording):
    for number, time in enumerate(recording.times[:2]):
        flow = deep(recording.folder / f"flow/{time}.png")
        valid = flow[..., 2] == 1
        moved = (flow[..., :2] - 32768) / 64
        _, pixels = seen_at(recording, number + 1, points(recording, number))
        x, y = np.meshgrid(*[np.arange(side) for side in recording.camera.size])
        expected = pixels - np.stack([x, y], axis=-1)
        apart = np.linalg.norm(moved - expected, axis=-1)[valid & np.isfinite(expected).all(axis=-1)]
        require(valid.mean() > 0.5, f"{time}: there is flow at {valid.mean():.0%} of pixels")
        require(np.quantile(apart, 0.999) < 0.03, f"{time}: flow is {apart.max()} pixels off")


def check_layouts(recording, folder):
    """All layouts have the same path, images and depth."""
    times = [int(float(time) * 1e6 + 0.5) * 1000 for time in recording.times]
    states = file_interface.read_euroc_csv_trajectory(folder / "euroc/mav0/state_groundtruth_estimate0/data.csv")
    kitti = file_interface.read_kitti_poses_file(folder / "kitti/poses/00.txt")
    about = yaml.safe_load((folder / "euroc/mav0/cam0/sensor.yaml").read_text(encoding="utf-8"))
    mount = np.array(about["T_BS"]["data"]).reshape(4, 4)
    first = None
    for number, (time_ns, time) in enumerate(zip(times, recording.times, strict=True)):
        turn, place = recording.pose(time)
        pose = np.vstack([np.column_stack([turn, place]), [0, 0, 0, 1]])
        first = pose if first is None else first
        [state] = np.flatnonzero(np.abs(states.timestamps - time_ns * 1e-9) < 2e-6)
        alike(pose, states.poses_se3[state] @ mount, f"EuRoC's state at {time}")
        alike(np.linalg.inv(first) @ pose, kitti.poses_se3[number], f"KITTI's pose {number}")
        images = [
            recording.folder / recording.images[number],
            folder / f"euroc/mav0/cam0/data/{time_ns}.png",
            folder / f"kitti/sequences/00/image_2/{number:06}.png",
        ]
        one, *others = [np.asarray(Image.open(path)) for path in images]
        require(all(np.array_equal(one, other) for other in others), f"image {number} differs by layout")
        scaled = (
            np.asarray(Image.open(folder / f"kitti/sequences/00/image_2_depth/{number:06}.png")) / KITTI_UNITS_PER_M
        )
        require(np.abs(scaled - recording.depth(number)).max() < 0.003, f"depth {number} differs by layout")
    rows = (folder / "euroc/mav0/cam0/data.csv").read_text(encoding="utf-8").strip().split("\n")[1:]
    require(rows == [f"{time},{time}.png" for time in times], "EuRoC lists other images")
    rows = (folder / "kitti/sequences/00/calib.txt").read_text(encoding="utf-8").strip().split("\n")
    calibration = {row.split(":")[0]: np.array(row.split(":")[1].split(), dtype=float).reshape(3, 4) for row in rows}
    camera = recording.camera
    require(np.allclose(calibration["P2"][[0, 1], [2, 2]], camera.centre), "KITTI's principal point is another")
    baseline = -calibration["P3"][0, 3] / calibration["P3"][0, 0]
    told = [camera.settings["Stereo.b"], camera.settings["Stereo.T_c1_c2"]["data"][3]]
    require(np.abs(np.subtract(told, baseline)).max() < 1e-6 and baseline > 0.01, f"the baseline is {baseline} m")
    check_stereo(recording, folder, baseline)


def alike(one, other, what):
    require(np.abs(one - other).max() < 2e-6, f"{what} is off by {np.abs(one - other).max()}")


def check_stereo(recording, folder, baseline):
    """Points of the left image look the same in the right one."""
    left, right = [
        np.asarray(Image.open(folder / f"kitti/sequences/00/image_{k}/000000.png").convert("L")).astype(float)
        for k in (2, 3)
    ]
    depth = recording.depth(0)
    plain = ~silhouettes(depth)
    y, x = np.nonzero(plain)
    apart = recording.camera.focal[0] * baseline / depth[plain]
    shown = np.round(x - apart).astype(int)
    inside = shown >= 0
    here, there = left[y, x][inside], right[y[inside], shown[inside]]
    likeness = np.corrcoef(here, there)[0, 1]
    require(likeness > 0.7, f"left and right image are alike by {likeness}")


def check_lidar(recording, folder, world):
    path = recording.folder / "lidar0"
    mount = np.array(yaml.safe_load((folder / "euroc/mav0/lidar0/sensor.yaml").read_text())["T_BS"]["data"]).reshape(
        4, 4
    )
    states = body(folder)
    for number, time in enumerate(recording.times[:2]):
        cloud = pcd(path / f"{time}.pcd")
        place = np.column_stack([cloud["x"], cloud["y"], cloud["z"]]).astype(float)
        require(
            len(place) > 1000 and cloud["ring"].max() == 15,
            f"{time}: {len(place)} points of {cloud['ring'].max() + 1} rings",
        )
        require(
            (cloud["intensity"] >= 0).all() and 0.02 < cloud["intensity"].mean() < 0.8, f"{time}: intensities are odd"
        )
        turns, places = states(float(time) + cloud["time"].astype(float))
        origins = turns.apply(mount[:3, 3]) + places
        range_m = np.linalg.norm(place, axis=1)
        rays = turns.apply(place @ mount[:3, :3].T) / range_m[:, None]
        away, _ = world.meet(origins, rays)
        unlike = (np.abs(away - range_m) > 2 * WITHIN_M).mean()
        require(unlike < 0.01, f"{time}: {unlike:.1%} of points are not on a surface")
        scan = np.fromfile(folder / f"kitti/sequences/00/velodyne/{number:06}.bin", np.float32).reshape(-1, 4)
        require(np.allclose(scan[:, :3], place, atol=1e-6), f"KITTI's scan {number} has other points")


def pcd(path):
    data = path.read_bytes()
    head, body = data.split(b"DATA binary\n", 1)
    about = dict(line.split(" ", 1) for line in head.decode().split("\n") if " " in line and line[0] != "#")
    kinds = [f"<{kind.lower()}{size}" for kind, size in zip(about["TYPE"].split(), about["SIZE"].split(), strict=True)]
    cloud = np.frombuffer(body, np.dtype(list(zip(about["FIELDS"].split(), kinds, strict=True))))
    require(len(cloud) == int(about["POINTS"]), f"{path.name} does not have the points that it names")
    return cloud


def body(folder):
    """Turns and places of the body at any times, between the states of EuRoC."""
    rows = np.loadtxt(folder / "euroc/mav0/state_groundtruth_estimate0/data.csv", delimiter=",", comments="#")
    times = rows[:, 0] * 1e-9
    turns = Slerp(times, Rotation.from_quat(rows[:, [5, 6, 7, 4]]))

    def at(asked):
        asked = np.clip(asked, times[0], times[-1])
        return turns(asked), np.column_stack([np.interp(asked, times, rows[:, axis]) for axis in (1, 2, 3)])

    return at


def check_inertia(recording, folder):
    """By steps of the midpoint from the first state, for as long as the recording lasts."""
    rows = np.loadtxt(folder / "euroc/mav0/imu0/data.csv", delimiter=",", comments="#")
    states = np.loadtxt(folder / "euroc/mav0/state_groundtruth_estimate0/data.csv", delimiter=",", comments="#")
    times = (rows[:, 0] - rows[0, 0]) * 1e-9
    require(np.allclose(rows[:, 0], states[:, 0]), "the IMU and the states have other times")
    turn, place, speed = Rotation.from_quat(states[0, [5, 6, 7, 4]]), states[0, 1:4].copy(), states[0, 8:11].copy()
    for step, mean in zip(np.diff(times), (rows[1:, 1:] + rows[:-1, 1:]) / 2, strict=True):
        force = (turn * Rotation.from_rotvec(mean[:3] * step / 2)).apply(mean[3:]) - [0, 0, GRAVITY]
        place += speed * step + force * step**2 / 2
        speed += force * step
        turn = turn * Rotation.from_rotvec(mean[:3] * step)
    apart = np.linalg.norm(place - states[-1, 1:4])
    angle = np.degrees((turn.inv() * Rotation.from_quat(states[-1, [5, 6, 7, 4]])).magnitude())
    require(apart < 0.002 and angle < 0.05, f"the IMU leads {apart} m and {angle}° astray")
    wheels = file_interface.read_tum_trajectory_file(recording.folder / "odometry.txt")
    require(isinstance(wheels, PoseTrajectory3D) and wheels.path_length > 0.1, "the wheels did not turn")
    ratio = wheels.path_length / np.linalg.norm(np.diff(states[:, 1:4], axis=0), axis=1).sum()
    require(abs(ratio - 1) < 0.02, f"the wheels went {ratio} of the way")


def check_messages(recording, folder):
    """ROS 2 messages, decoded by their own definitions, tell the same as the files of the other layouts."""
    told = {}
    with (folder / "mcap/recording.mcap").open("rb") as file:
        reader = make_reader(file, decoder_factories=[DecoderFactory()])
        require(reader.get_header().profile == "ros2", "the profile is not that of ROS 2")
        last = 0
        for _, channel, message, decoded in reader.iter_decoded_messages():
            require(message.log_time >= last, f"a message of {channel.topic} comes late")
            last = message.log_time
            told.setdefault(channel.topic, []).append(decoded)
    counts = {name: recording.about["counts"][name] for name in ("left", "right", "lidar0", "imu", "odometry")}
    topics = {"/left/image_raw": "left", "/left/camera_info": "left", "/right/image_raw": "right", "/imu": "imu"}
    topics |= {"/left/depth": "left", "/lidar0/points": "lidar0", "/odom": "odometry", "/tf": "odometry"}
    for topic, name in topics.items():
        require(len(told.get(topic, [])) == counts[name], f"{topic} has {len(told.get(topic, []))} messages")
    for number, time in enumerate(recording.times):
        image, depth = told["/left/image_raw"][number], told["/left/depth"][number]
        require(stamp(image.header) == time, f"{time} is another time")
        expected = np.asarray(Image.open(recording.folder / recording.images[number]))
        require(np.array_equal(pixels_of(image, np.uint8, 3), expected), f"image {number} differs by layout")
        metres = np.nan_to_num(pixels_of(depth, np.float32, 1)[..., 0])
        require(np.abs(metres - recording.depth(number)).max() < 0.6 / UNITS_PER_M, f"depth {number} differs by layout")
    info, camera = told["/left/camera_info"][0], recording.camera
    require(
        np.allclose(info.k, [camera.focal[0], 0, camera.centre[0], 0, camera.focal[1], camera.centre[1], 0, 0, 1]),
        "another k",
    )
    require([info.width, info.height] == camera.size, "CameraInfo has another size")
    rows = np.loadtxt(folder / "euroc/mav0/imu0/data.csv", delimiter=",", comments="#")
    felt = [[*axes(told.angular_velocity), *axes(told.linear_acceleration)] for told in told["/imu"]]
    require(np.allclose(felt, rows[:, 1:], atol=1e-8), "the IMU differs by layout")
    check_clouds(recording, told["/lidar0/points"])
    check_frames(recording, told)


def check_clouds(recording, clouds):
    for cloud, time in zip(clouds, recording.times, strict=False):
        file = pcd(recording.folder / f"lidar0/{time}.pcd")
        kinds = {4: "<u2", 7: "<f4"}
        names, formats = [field.name for field in cloud.fields], [kinds[field.datatype] for field in cloud.fields]
        layout = {"names": names, "formats": formats, "offsets": [field.offset for field in cloud.fields]}
        told = np.frombuffer(cloud.data, np.dtype({**layout, "itemsize": cloud.point_step}))
        alike = len(told) == cloud.width and all(np.array_equal(told[name], file[name]) for name in names)
        require(alike, f"the points at {time} differ by layout")


def check_frames(recording, told):
    """The true pose and the place of the camera on the body give the pose of the camera."""
    [mounts] = told["/tf_static"]
    mount = {mount.child_frame_id: mount.transform for mount in mounts.transforms}
    truth = {stamp(pose.header): pose.pose.pose for pose in told["/truth"]}
    for time in recording.times:
        pose = truth[time]
        turn, place = Rotation.from_quat(axes(pose.orientation, "xyzw")), np.array(axes(pose.position))
        optical = mount["left"]
        turned = turn * Rotation.from_quat(axes(optical.rotation, "xyzw"))
        expected_turn, expected_place = recording.pose(time)
        alike(turned.as_matrix(), expected_turn, f"the frame of the camera at {time}")
        alike(place + turn.apply(axes(optical.translation)), expected_place, f"the place of the camera at {time}")
    wheels = file_interface.read_tum_trajectory_file(recording.folder / "odometry.txt")
    places = [axes(pose.pose.pose.position) for pose in told["/odom"]]
    require(np.allclose(places, wheels.positions_xyz, atol=1e-6), "the wheels differ by layout")


def stamp(header):
    return f"{header.stamp.sec}.{header.stamp.nanosec // 1000:06}"


def axes(value, names="xyz"):
    return [getattr(value, name) for name in names]


def pixels_of(image, kind, channels):
    require(image.step == image.width * channels * np.dtype(kind).itemsize, "rows of an image have another length")
    return np.frombuffer(image.data, kind).reshape(image.height, image.width, channels)


def main():
    try:
        print(verify(Path(sys.argv[1]), World(Path(sys.argv[2]))))
    except Failure as failure:
        sys.exit(str(failure))


if __name__ == "__main__":
    main()
