"""Checks the ROS 2 part of a Gazebo package, without ROS.

    check.py PACKAGE_DIR

Launch files run on stand-ins of `launch` and `launch_ros`, with every combination of their arguments. What they start must find
its files, topics, types and frames in what the others have. Facts about programs of ROS are in the tables here: what each
listens to and publishes, and which pairs of types ros_gz_bridge knows. Whether it works in ROS is not known from this.
"""

import itertools
import json
import re
import sys
import xml.etree.ElementTree as ElementTree
from pathlib import Path

import jsonschema
import launches
import numpy as np
import yaml
from failure import Failure, require
from PIL import Image
from robot import Robot, absolute, check_world

ARGUMENTS = ["slam", "nav2", "rviz", "foxglove", "headless"]
START_HEIGHT_M = 0.05

# Pairs of types of the topics here, and the keys of a bridge, by the README of ros_gz_bridge.
PAIRS = {
    ("geometry_msgs/msg/Twist", "gz.msgs.Twist"),
    ("nav_msgs/msg/Odometry", "gz.msgs.Odometry"),
    ("rosgraph_msgs/msg/Clock", "gz.msgs.Clock"),
    ("sensor_msgs/msg/CameraInfo", "gz.msgs.CameraInfo"),
    ("sensor_msgs/msg/Image", "gz.msgs.Image"),
    ("sensor_msgs/msg/Imu", "gz.msgs.IMU"),
    ("sensor_msgs/msg/JointState", "gz.msgs.Model"),
    ("sensor_msgs/msg/LaserScan", "gz.msgs.LaserScan"),
    ("sensor_msgs/msg/PointCloud2", "gz.msgs.PointCloudPacked"),
    ("tf2_msgs/msg/TFMessage", "gz.msgs.Pose_V"),
}
BRIDGES = jsonschema.Draft202012Validator(
    {
        "type": "array",
        "minItems": 1,
        "items": {
            "type": "object",
            "required": ["ros_topic_name", "gz_topic_name", "ros_type_name", "gz_type_name", "direction"],
            "additionalProperties": False,
            "properties": {
                "ros_topic_name": {"type": "string", "pattern": "^/[a-z0-9_/]+$"},
                "gz_topic_name": {"type": "string", "pattern": "^/[a-z0-9_/]+$"},
                "ros_type_name": {"type": "string"},
                "gz_type_name": {"type": "string"},
                "direction": {"enum": ["BIDIRECTIONAL", "GZ_TO_ROS", "ROS_TO_GZ"]},
                "lazy": {"type": "boolean"},
                "publisher_queue": {"type": "integer"},
                "subscriber_queue": {"type": "integer"},
            },
        },
    }
)
CAMERA = {"rgb/image", "rgb/camera_info", "depth/image"}
# What programs of ROS listen to and what they publish, before remapping, so far as it matters here.
PROGRAMS = {
    "foxglove_bridge/foxglove_bridge": (set(), set()),
    "nav2_behaviors/behavior_server": (set(), {"cmd_vel"}),
    "nav2_bt_navigator/bt_navigator": (set(), set()),
    "nav2_controller/controller_server": (set(), {"cmd_vel"}),
    "nav2_lifecycle_manager/lifecycle_manager": (set(), set()),
    "nav2_map_server/map_server": (set(), {"map"}),
    "nav2_planner/planner_server": (set(), {"plan"}),
    "nav2_velocity_smoother/velocity_smoother": ({"cmd_vel"}, {"cmd_vel_smoothed"}),
    "nav2_waypoint_follower/waypoint_follower": (set(), set()),
    "robot_state_publisher/robot_state_publisher": ({"joint_states"}, {"tf", "tf_static", "robot_description"}),
    "ros_gz_bridge/parameter_bridge": (set(), set()),
    "ros_gz_sim/create": (set(), set()),
    "rtabmap_odom/rgbd_odometry": (CAMERA | {"imu"}, {"odom", "tf"}),
    "rtabmap_slam/rtabmap": (CAMERA | {"imu", "odom"}, {"map", "mapPath", "tf"}),
    "rtabmap_util/point_cloud_xyzrgb": (CAMERA, {"cloud"}),
    "rtabmap_viz/rtabmap_viz": (CAMERA | {"imu", "odom"}, set()),
    "rviz2/rviz2": (set(), {"goal_pose"}),
    "tf2_ros/static_transform_publisher": (set(), {"tf_static"}),
}
# Nodes with parameters of their own inside others.
COSTMAPS = {"controller_server": "local_costmap", "planner_server": "global_costmap"}
PLUGINS = {
    "nav2_behaviors::BackUp",
    "nav2_behaviors::Spin",
    "nav2_behaviors::Wait",
    "nav2_bt_navigator::NavigateThroughPosesNavigator",
    "nav2_bt_navigator::NavigateToPoseNavigator",
    "nav2_controller::SimpleGoalChecker",
    "nav2_controller::SimpleProgressChecker",
    "nav2_costmap_2d::InflationLayer",
    "nav2_costmap_2d::StaticLayer",
    "nav2_navfn_planner::NavfnPlanner",
    "nav2_regulated_pure_pursuit_controller::RegulatedPurePursuitController",
    "nav2_waypoint_follower::WaitAtWaypoint",
}
FRAMES = {"frame_id", "odom_frame_id", "map_frame_id", "global_frame", "local_frame", "robot_base_frame"}
TOPICS = {"odom_topic", "map_topic"}
# What RTAB-Map and Nav2 publish only while they work.
BASIC = ["/tf", "/tf_static"]


class Package:
    def __init__(self, folder):
        self.folder, self.ros2 = folder, folder / "ros2"
        [self.world_file] = (folder / "worlds").glob("*.sdf")
        self.world = ElementTree.parse(self.world_file).find("world")
        self.name = self.world.get("name")
        self.cave = ElementTree.parse(folder / "models" / self.name / "model.sdf").find("model")
        self.model = folder / "models" / f"{self.name}_rover" / "model.sdf"
        self.read = {}
        self.robot = Robot(self.model, self.ros2 / "urdf" / "rover.urdf")

    def file(self, path):
        path = Path(path)
        require(path.is_relative_to(self.folder), f"{path} is outside the package")
        require(path.is_file(), f"{path.relative_to(self.folder)} is named and not there")
        return path

    def yaml(self, path):
        if path not in self.read:
            self.read[path] = self.parsed(path)
        return self.read[path]

    def parsed(self, path):
        try:
            return yaml.load(self.file(path).read_text(encoding="utf-8"), yaml.CSafeLoader)
        except yaml.YAMLError as reason:
            raise Failure(f"{Path(path).name} is no YAML: {reason}") from reason


class Running:
    """What runs with some arguments of cave.launch.py."""

    def __init__(self, package, arguments):
        self.package, self.arguments = package, arguments
        self.started = launches.start(package.ros2 / "launch" / "cave.launch.py", arguments)
        unknown = {f"{node.package}/{node.executable}" for node in self.started.nodes} - set(PROGRAMS)
        require(not unknown, f"{unknown} are no programs that this check knows")
        self.parameters = {node.name: self.parameters_of(node) for node in self.started.nodes}
        self.bridges = [bridge for node in self.of("parameter_bridge") for bridge in self.bridges_of(node)]
        to_ros = {bridge["ros_topic_name"] for bridge in self.bridges if bridge["direction"] != "ROS_TO_GZ"}
        self.published = to_ros.union(*(self.topics(node, 1) for node in self.started.nodes))

    def of(self, executable):
        return [node for node in self.started.nodes if node.executable == executable]

    def parameters_of(self, node):
        """The parameters of a node from its files and its launch file, those of costmaps inside it too."""
        known = {}
        for each in node.parameters:
            if isinstance(each, dict):
                known.update(each)
                continue
            text = self.package.yaml(each)
            own = [text[name]["ros__parameters"] for name in ("/**", node.name) if name in text]
            require(own, f"{Path(each).name} has no parameters of {node.name}")
            for parameters in own:
                known.update(parameters)
            costmap = COSTMAPS.get(node.name)
            if costmap:
                known[costmap] = text[costmap][costmap]["ros__parameters"]
        return known

    def bridges_of(self, node):
        bridges = self.package.yaml(self.parameters[node.name]["config_file"])
        fault = next(BRIDGES.iter_errors(bridges), None)
        require(fault is None, f"{node.name}.yaml: {fault and fault.message}")
        return bridges

    def topics(self, node, which):
        topics = PROGRAMS[f"{node.package}/{node.executable}"][which]
        return {absolute(node.remappings.get(topic, topic)) for topic in topics}

    def edges(self):
        edges = self.package.robot.edges()
        for node in self.of("static_transform_publisher"):
            words = dict(zip(node.arguments[::2], node.arguments[1::2], strict=True))
            edges.append((words["--frame-id"], words["--child-frame-id"]))
        for bridge in self.bridges:
            if bridge["ros_topic_name"] == "/tf":
                edges.append(self.package.robot.transforms[bridge["gz_topic_name"]])
        odometry, slam = self.parameters.get("rgbd_odometry"), self.parameters.get("rtabmap")
        if odometry and odometry["publish_tf"]:
            edges.append((odometry["odom_frame_id"], odometry["frame_id"]))
        if slam and slam["publish_tf"]:
            edges.append((slam["map_frame_id"], odometry["odom_frame_id"]))
        return edges

    def check(self):
        for node in self.started.nodes:
            self.check_node(node)
        self.check_bridges()
        self.check_frames()
        self.check_start()

    def check_node(self, node):
        program = f"{node.package}/{node.executable}"
        require(node.shared.get("use_sim_time") is True, f"{node.name} does not use the time of the simulation")
        known = set().union(*PROGRAMS[program])
        require(set(node.remappings) <= known, f"{program} has no topic {set(node.remappings) - known}")
        unheard = self.topics(node, 0) - self.published
        require(not unheard, f"{node.name} listens to {unheard}, which nothing publishes")
        for key, value in leaves(self.parameters[node.name]):
            if key in TOPICS:
                require(absolute(value) in self.published, f"{node.name} listens to {value}, which nothing publishes")
            if "/" in key:
                require(isinstance(value, str), f"{key} of {node.name} is no text, as parameters of RTAB-Map are")
            if key == "plugin":
                require(value in PLUGINS, f"{node.name} has a plugin {value}, which this check does not know")

    def check_bridges(self):
        robot = self.package.robot
        for bridge in self.bridges:
            ros, gz, kind = bridge["ros_topic_name"], bridge["gz_topic_name"], bridge["gz_type_name"]
            require((bridge["ros_type_name"], kind) in PAIRS, f"ros_gz_bridge does not know the types of {ros}")
            ends = robot.hears if bridge["direction"] == "ROS_TO_GZ" else robot.publishes
            require(ends.get(gz) == kind, f"Gazebo has no topic {gz} of type {kind} for {bridge['direction']}")
        names = [bridge["ros_topic_name"] for bridge in self.bridges]
        require(len(set(names)) == len(names), "a topic is bridged twice")

    def check_frames(self):
        edges = self.edges()
        children = [child for _, child in edges]
        twice = {child for child in children if children.count(child) > 1}
        require(not twice, f"frames {twice} have two parents with {self.arguments}")
        frames = {frame for edge in edges for frame in edge}
        roots = frames - set(children)
        require(roots == {"world"}, f"the roots of the frames are {roots} with {self.arguments}")
        robot = self.package.robot
        used = {*robot.sensor_frames, robot.optical_frame}
        for parameters in self.parameters.values():
            used |= {value for key, value in leaves(parameters) if key in FRAMES}
        require(used <= frames, f"{used - frames} are used as frames and are in no tree with {self.arguments}")

    def check_start(self):
        package = self.package
        [create] = self.of("create")
        words = dict(zip(create.arguments[::2], create.arguments[1::2], strict=True))
        require(words["-world"] == package.name, f"the rover is created in world {words['-world']}")
        require(package.file(words["-file"]) == package.model, f"{words['-file']} is created")
        spawn = np.array(package.cave.find("frame[@name='spawn_0']/pose").text.split(), dtype=float)
        place = np.array([float(words[flag]) for flag in ("-x", "-y", "-z", "-R", "-P", "-Y")])
        up = np.linalg.norm(place[:3] - spawn[:3])
        require(abs(up - START_HEIGHT_M) < 1e-4, f"the rover starts {up} m from the first start pose")
        require(np.allclose(place[3:], spawn[3:], atol=1e-5), "the rover starts with another heading")
        [(_, arguments)] = self.started.included
        [world] = re.findall(r'"([^"]+)"', arguments["gz_args"])
        require(package.file(world) == package.world_file, f"Gazebo opens {world}")
        is_headless = " -s " in arguments["gz_args"]
        require(is_headless == (self.arguments["headless"] == "true"), f"Gazebo is started as {arguments['gz_args']}")
        models = Path(self.started.environment["GZ_SIM_RESOURCE_PATH"])
        require(models == package.folder / "models", f"Gazebo looks for models in {models}")
        for node in self.of("map_server"):
            check_map(package, self.parameters[node.name]["yaml_filename"], spawn)


def leaves(tree):
    for key, value in tree.items():
        if isinstance(value, dict):
            yield from leaves(value)
        else:
            yield key, value


def check_map(package, path, spawn):
    """By the formula of the map server of Nav2, the rover starts where it is free."""
    about = package.yaml(path)
    image = package.file(Path(path).with_name(about["image"]))
    require(about["mode"] == "trinary" and about["negate"] == 0, f"{image.name} is of another mode")
    occupancy = (255 - np.asarray(Image.open(image).convert("L"), dtype=float)) / 255
    column, row = ((spawn[:2] - about["origin"][:2]) / about["resolution"]).astype(int)
    height, width = occupancy.shape
    require(0 <= column < width and 0 <= row < height, "the rover starts outside the map")
    require(occupancy[height - 1 - row, column] < about["free_thresh"], "the rover starts where the map is not free")


def check_parameters_are_used(package, runs):
    """Parameters of nodes that do not run have no effect, mostly because of a wrong name."""
    viewer = launches.start(package.ros2 / "launch" / "rtabmap.launch.py", {"viewer": "true"})
    names = {node.name for started in [viewer, *(running.started for running in runs)] for node in started.nodes}
    names.update(COSTMAPS.values())
    for name in ("rtabmap", "nav2"):
        unused = set(package.yaml(package.ros2 / "config" / f"{name}.yaml")) - names
        require(not unused, f"{name}.yaml has parameters of {unused}, which no launch file starts")


def check_views(package, topics, frames):
    layout = json.loads((package.ros2 / "config" / "foxglove.json").read_text(encoding="utf-8"))
    panels = set(layout["configById"])
    placed = {value for _, value in leaves(layout["layout"]) if isinstance(value, str) and "!" in value}
    require(placed == panels, f"the layout of Foxglove places {placed ^ panels} not or without settings")
    shown = set()
    for panel in layout["configById"].values():
        shown |= set(panel.get("topics", {}))
        shown |= {value for key, value in panel.get("imageMode", {}).items() if key.endswith("Topic")}
        values = [path["value"] for path in panel.get("paths", [])] + [panel.get("xAxisPath", {}).get("value", "")]
        shown |= {value.split(".")[0] for value in values if value}
    require(shown <= topics, f"Foxglove shows {shown - topics}, which nothing publishes")
    require(layout["configById"]["3D!cave"]["fixedFrame"] in frames, "the frame of Foxglove is in no tree")
    view = package.yaml(package.ros2 / "config" / "cave.rviz")["Visualization Manager"]
    for display in view["Displays"] + view["Tools"]:
        topic = display.get("Topic", display.get("Description Topic", {})).get("Value")
        require(topic is None or topic in topics, f"RViz shows {topic}, which nothing publishes")
    require(view["Global Options"]["Fixed Frame"] in frames, "the frame of RViz is in no tree")
    readme = (package.ros2 / "README.md").read_text(encoding="utf-8")
    told = set(re.findall(r"(?<= |`)(/[a-z][A-Za-z_]*(?:/[a-z_]+)?)(?=[ `\n])", readme)) - {"/opt"}
    require(told <= topics, f"the README tells of {told - topics}, which nothing publishes")
    require(len(told) > 10, "the README tells of no topics")


def verify(folder):
    package = Package(folder.resolve())
    package.robot.check()
    check_world(package.world)
    runs = [Running(package, dict(zip(ARGUMENTS, values, strict=True))) for values in all_choices()]
    for running in runs:
        running.check()
    declared = runs[0].started.arguments["cave.launch.py"]
    require(declared == set(ARGUMENTS), f"cave.launch.py has the arguments {declared}")
    check_parameters_are_used(package, runs)
    heard = {bridge["ros_topic_name"] for bridge in runs[0].bridges}
    topics = heard.union(BASIC, *(running.published for running in runs))
    frames = {frame for running in runs for edge in running.edges() for frame in edge}
    check_views(package, topics, frames)
    nodes = max(len(running.started.nodes) for running in runs)
    return f"ROS 2 without ROS: {len(runs)} ways to launch, up to {nodes} nodes, {len(topics)} topics, {len(frames)} frames"


def all_choices():
    return itertools.product(["false", "true"], repeat=len(ARGUMENTS))


def main():
    try:
        print(verify(Path(sys.argv[1])))
    except Failure as failure:
        sys.exit(f"error: {failure}")


if __name__ == "__main__":
    main()
