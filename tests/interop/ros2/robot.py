"""The rover as Gazebo and ROS know it: topics, types and frames of the SDF, frames of the URDF."""

import subprocess
import xml.etree.ElementTree as ElementTree

import numpy as np
import yourdfpy
from failure import require

# What sensors publish below their topic.
OF_SENSORS = {
    "rgbd_camera": {
        "/image": "gz.msgs.Image",
        "/depth_image": "gz.msgs.Image",
        "/points": "gz.msgs.PointCloudPacked",
        "/camera_info": "gz.msgs.CameraInfo",
    },
    "imu": {"": "gz.msgs.IMU"},
    "gpu_lidar": {"": "gz.msgs.LaserScan", "/points": "gz.msgs.PointCloudPacked"},
}
# Systems of a model: elements that name topics with their types, those that listen, and elements that name frames.
OF_SYSTEMS = {
    "DiffDrive": (
        {"topic": "gz.msgs.Twist", "odom_topic": "gz.msgs.Odometry", "tf_topic": "gz.msgs.Pose_V"},
        {"topic"},
        ("frame_id", "child_frame_id"),
    ),
    "JointStatePublisher": ({"topic": "gz.msgs.Model"}, set(), ()),
    "OdometryPublisher": (
        {"odom_topic": "gz.msgs.Odometry", "tf_topic": "gz.msgs.Pose_V"},
        set(),
        ("odom_frame", "robot_base_frame"),
    ),
}
# Systems of a world that sensors and `create` need.
NEEDED = {"Physics", "UserCommands", "SceneBroadcaster", "Sensors", "Imu"}
SYSTEM = "gz::sim::systems::"
WITHIN = 1e-5


class Robot:
    def __init__(self, sdf, urdf):
        self.sdf = ElementTree.parse(sdf).find("model")
        said = subprocess.run(["check_urdf", str(urdf)], capture_output=True, text=True)
        require(said.returncode == 0, f"urdfdom: {said.stdout}{said.stderr}")
        self.urdf = yourdfpy.URDF.load(str(urdf), load_meshes=False, build_scene_graph=True)
        require(self.urdf.validate(), f"yourdfpy finds faults: {self.urdf.errors}")
        # Topics of Gazebo with their types, those that it publishes and those that it listens to.
        self.publishes, self.hears = {"/clock": "gz.msgs.Clock"}, {}
        # The two frames of a transform by the topic of Gazebo that tells it.
        self.transforms = {}
        self._add_systems()
        self._add_sensors()

    def _add_systems(self):
        for plugin in self.sdf.iter("plugin"):
            name = plugin.get("name").removeprefix(SYSTEM)
            require(name in OF_SYSTEMS, f"the rover has a system {name}, which this check does not know")
            topics, heard, frames = OF_SYSTEMS[name]
            for tag, kind in topics.items():
                topic = plugin.findtext(tag)
                require(topic, f"{name} has no {tag}")
                (self.hears if tag in heard else self.publishes)[absolute(topic)] = kind
            if frames:
                self.transforms[absolute(plugin.findtext("tf_topic"))] = tuple(plugin.findtext(tag) for tag in frames)

    def _add_sensors(self):
        self.sensor_frames = {}
        for sensor in self.sdf.iter("sensor"):
            topic = absolute(sensor.findtext("topic"))
            self.publishes.update({topic + end: kind for end, kind in OF_SENSORS[sensor.get("type")].items()})
            place = [float(number) for number in sensor.findtext("pose").split()]
            require(not any(place[3:]), f"sensor {sensor.get('name')} is turned, unlike its frame")
            self.sensor_frames[sensor.findtext("gz_frame_id")] = place[:3]
        self.optical_frame = self.sdf.findtext(".//optical_frame_id")

    def edges(self):
        """Parent and child of each joint."""
        return [(joint.parent, joint.child) for joint in self.urdf.robot.joints]

    def check(self):
        """The URDF has the frames of the SDF at their places."""
        require(self.urdf.base_link == "base_link", f"the root of the URDF is {self.urdf.base_link}")
        joints = {joint.name: joint for joint in self.urdf.robot.joints}
        for wheel in self.sdf.findall("joint"):
            joint = joints.get(wheel.get("name"))
            require(joint is not None, f"the URDF has no joint {wheel.get('name')}")
            require((joint.parent, joint.child) == (wheel.findtext("parent"), wheel.findtext("child")), joint.name)
            axis = np.array(wheel.findtext("axis/xyz").split(), dtype=float)
            require(np.allclose(joint.axis, axis), f"{joint.name} has another axis in the URDF")
            place = self.sdf.find(f"link[@name='{joint.child}']/pose").text.split()[:3]
            self.require_at(joint.child, np.array(place, dtype=float))
        for frame, place in self.sensor_frames.items():
            self.require_at(frame, place)
        turn = self.urdf.get_transform(self.optical_frame, "base_link")
        expected = np.array([[0, 0, 1], [-1, 0, 0], [0, -1, 0]])
        require(
            np.allclose(turn[:3, :3], expected, atol=WITHIN), f"{self.optical_frame} does not look along the camera"
        )
        require(
            np.allclose(turn[:3, 3], self.sensor_frames["camera_link"], atol=WITHIN), "the optical frame is elsewhere"
        )

    def require_at(self, frame, place):
        require(frame in self.urdf.link_map, f"the URDF has no frame {frame}")
        found = self.urdf.get_transform(frame, "base_link")[:3, 3]
        require(np.allclose(found, place, atol=WITHIN), f"{frame} is at {found} in the URDF and at {place} in the SDF")


def check_world(world):
    systems = {plugin.get("name").removeprefix(SYSTEM) for plugin in world.findall("plugin")}
    require(systems >= NEEDED, f"the world lacks {NEEDED - systems}")
    require(world.findtext("plugin/render_engine") == "ogre2", "sensors are not drawn by ogre2")


def absolute(topic):
    return topic if topic.startswith("/") else f"/{topic}"
