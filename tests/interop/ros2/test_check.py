"""What is broken in the ROS 2 part of a package must be noticed: `cargo xtask interop` runs this, with the scene in PLUME_SCENE."""

import os
import re
import shutil
import sys
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

sys.path.insert(0, str(Path(__file__).parent))

import check  # noqa: E402 - the check itself

SAMPLE = Path(os.environ["PLUME_SCENE"]) / "gazebo_ros2"
SDF = "models/chamber_rover/model.sdf"
URDF = "ros2/urdf/rover.urdf"
BRIDGE = "ros2/config/bridge.yaml"
CAVE = "ros2/launch/cave.launch.py"


@pytest.fixture
def package(tmp_path):
    shutil.copytree(SAMPLE, tmp_path / "package", ignore=shutil.ignore_patterns("*.obj", "*_0_0_*.png"))
    return tmp_path / "package"


def test_a_good_package_passes(package):
    assert "32 ways to launch" in check.verify(package)


def replace(file, old, new, count=1):
    def change(package):
        path = package / file
        text, found = re.subn(old, new, path.read_text(encoding="utf-8"), count=count, flags=re.MULTILINE)
        assert found, f"{file} has no {old}"
        path.write_text(text, encoding="utf-8")

    return change


def remove(file):
    return lambda package: (package / file).unlink()


def blacken(package):
    path = package / "ros2/maps/map_0.png"
    Image.fromarray(np.zeros_like(np.asarray(Image.open(path)))).save(path)


FAULTS = {
    "a launch file that fails": (replace(CAVE, "def frame", "def flame"), "NameError"),
    "an argument that nodes do not have": (replace(CAVE, "executable=", "executabel="), "executabel"),
    "an argument that is not declared": (replace(CAVE, 'argument\\("nav2"', 'argument("nav3"'), "nav2"),
    "an argument of an included file": (replace(CAVE, "slam=slam", "sram=slam"), "has no argument"),
    "an argument of Gazebo's launch file": (replace(CAVE, '"gz_args"', '"args"'), "gz_sim.launch.py has no argument"),
    "a program that is not in its package": (
        replace(CAVE, 'package="rtabmap_util"', 'package="rtabmap_slam"'),
        "are no programs",
    ),
    "another world": (replace(CAVE, '"chamber.sdf"', '"cave.sdf"'), "cave.sdf is named and not there"),
    "another name of the world": (replace(CAVE, '"-world", "chamber"', '"-world", "cave"'), "in world cave"),
    "another start": (replace(CAVE, '"-z": "-1', '"-z": "-2'), "m from the first start pose"),
    "models elsewhere": (replace(CAVE, "str\\(MODELS\\)\\)", "str(ROS2))"), "looks for models"),
    "the clock of the system": (replace(CAVE, "SetParameter\\(.*\\),", ""), "does not use the time of the simulation"),
    "a missing file of parameters": (remove("ros2/config/nav2.yaml"), "nav2.yaml is named and not there"),
    "a missing launch file": (remove("ros2/launch/rtabmap.launch.py"), "there is no launch file rtabmap.launch.py"),
    "a missing map": (remove("ros2/maps/map_0.yaml"), "map_0.yaml is named and not there"),
    "a missing image of the map": (remove("ros2/maps/map_0.png"), "map_0.png is named and not there"),
    "a map without floor": (blacken, "where the map is not free"),
    "a map elsewhere": (replace("ros2/maps/map_0.yaml", "origin: \\[-5", "origin: [95"), "outside the map"),
    "another threshold of the map": (
        replace("ros2/maps/map_0.yaml", "free_thresh: 0.196", "free_thresh: 0.001"),
        "is not free",
    ),
    "a key that bridges do not have": (replace(BRIDGE, "ros_topic_name", "ros_topic"), "bridge.yaml"),
    "a direction that bridges do not have": (replace(BRIDGE, "GZ_TO_ROS", "GZ_TO_ROS2"), "bridge.yaml"),
    "a pair of types that no bridge knows": (
        replace(BRIDGE, "sensor_msgs/msg/Imu", "sensor_msgs/msg/IMU"),
        "types of /imu",
    ),
    "a topic that Gazebo does not have": (replace(BRIDGE, "/rover/imu", "/rover/imus"), "no topic /rover/imus"),
    "another topic of a sensor": (replace(SDF, "rover/camera", "rover/kamera"), "no topic /rover/camera/image"),
    "a bridge the wrong way": (replace(BRIDGE, "ROS_TO_GZ", "GZ_TO_ROS"), "no topic /rover/cmd_vel"),
    "a topic under another name": (
        replace(BRIDGE, '"/camera/image"', '"/camera/picture"'),
        "listens to {'/camera/image'}",
    ),
    "a topic bridged twice": (replace(BRIDGE, '"/ground_truth"', '"/wheel_odometry"'), "bridged twice"),
    "a remapping of nothing": (replace("ros2/launch/rtabmap.launch.py", '"rgb/image"', '"rgb/images"'), "has no topic"),
    "parameters of nothing": (
        replace("ros2/config/nav2.yaml", "^bt_navigator:", "bt_navigators:"),
        "no parameters of bt_navigator",
    ),
    "parameters that nothing reads": (
        replace("ros2/config/rtabmap.yaml", "^rtabmap_viz:", "rtabmap_vis:"),
        "rtabmap_v",
    ),
    "a number for RTAB-Map": (
        replace("ros2/config/rtabmap.yaml", 'Grid/RangeMax: "6"', "Grid/RangeMax: 6"),
        "is no text",
    ),
    "a plugin of an older Nav2": (
        replace("ros2/config/nav2.yaml", "nav2_behaviors::Spin", "nav2_behaviors/Spin"),
        "behaviors/Spin",
    ),
    "odometry that nothing publishes": (
        replace("ros2/config/nav2.yaml", "odom_topic: wheel_odometry", "odom_topic: wheels"),
        "listens to wheels",
    ),
    "YAML that is none": (replace("ros2/config/nav2.yaml", "^planner_server:", "planner_server: ]"), "is no YAML"),
    "a frame with two parents": (
        replace(CAVE, 'bridge\\("bridge_truth", unless_slam\\)', 'bridge("bridge_truth")'),
        "two parents",
    ),
    "two trees of frames": (
        replace(CAVE, 'frame\\("world", "map", \\[', 'frame("earth", "map", ['),
        "roots of the frames",
    ),
    "another frame of the rover": (
        replace("ros2/config/rtabmap.yaml", "frame_id: base_link", "frame_id: base"),
        "base",
    ),
    "ground truth of another frame": (replace(SDF, "<robot_base_frame>base_link", "<robot_base_frame>rover"), "frames"),
    "an optical frame that is none": (
        replace(URDF, "-1.5707963267948966 0 -1.5707963267948966", "0 0 0"),
        "look along the camera",
    ),
    "a camera elsewhere": (replace(URDF, 'xyz="0.36 0 0.65"', 'xyz="0.36 0 0.6"'), "camera_link is at"),
    "a wheel elsewhere": (replace(SDF, "<pose>0.25 0.28 0.18", "<pose>0.25 0.38 0.18"), "wheel_front_left is at"),
    "an axle the other way": (replace(URDF, 'axis xyz="0 1 0"', 'axis xyz="0 -1 0"'), "another axis"),
    "a joint under another name": (
        replace(URDF, "wheel_rear_left_joint", "wheel_rear_joint"),
        "no joint wheel_rear_left_joint",
    ),
    "a URDF with two roots": (
        replace(URDF, '<link name="imu_link"/>', '<link name="imu_link"/><link name="lost"/>'),
        "urdfdom",
    ),
    "a sensor in no frame": (replace(SDF, "<gz_frame_id>imu_link", "<gz_frame_id>imu"), "no frame imu"),
    "a world without an IMU": (
        replace("worlds/chamber.sdf", "<plugin.*systems::Imu.*$", ""),
        "the world lacks {'Imu'}",
    ),
    "a panel without a place": (
        replace("ros2/config/foxglove.json", '"first": "Image!colour"', '"first": "Image!color"'),
        "layout of Foxglove",
    ),
    "a view of nothing": (replace("ros2/config/foxglove.json", '"/odom.pose', '"/odometry.pose'), "Foxglove shows"),
    "a display of nothing": (
        replace("ros2/config/cave.rviz", "Value: /odom$", "Value: /odometry"),
        "RViz shows /odometry",
    ),
    "a README of another topic": (
        replace("ros2/README.md", "/ground_truth /odom ", "/truth /odom "),
        "README tells of {'/truth'}",
    ),
}


@pytest.mark.parametrize("fault", FAULTS)
def test_a_faulty_package_fails(fault, package):
    change, message = FAULTS[fault]
    change(package)
    with pytest.raises(check.Failure) as noticed:
        check.verify(package)
    assert message in str(noticed.value)
