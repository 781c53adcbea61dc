"""Stand-ins of `launch` and `launch_ros`, which are not on PyPI: they take the arguments that those of ROS 2 Jazzy document and
no others, and remember them."""

import contextlib
import sys
import types
from dataclasses import dataclass
from typing import Any


@dataclass
class LaunchDescription:
    entities: list


@dataclass
class DeclareLaunchArgument:
    name: str
    default_value: str = None
    description: str = None
    choices: list = None


@dataclass
class AppendEnvironmentVariable:
    name: str
    value: Any


@dataclass
class IncludeLaunchDescription:
    launch_description_source: Any
    launch_arguments: Any = ()
    condition: Any = None


@dataclass
class IfCondition:
    predicate: Any
    wanted = "true"


@dataclass
class UnlessCondition:
    predicate: Any
    wanted = "false"


@dataclass
class PythonLaunchDescriptionSource:
    location: Any


@dataclass
class LaunchConfiguration:
    variable_name: str


@dataclass
class PathJoinSubstitution:
    substitutions: list


@dataclass
class FindPackageShare:
    package: str


@dataclass
class SetParameter:
    name: str
    value: Any


@dataclass
class ParameterValue:
    value: Any
    value_type: Any = None


@dataclass(kw_only=True)
class Node:
    package: str
    executable: str
    name: str = None
    parameters: list = ()
    remappings: list = ()
    arguments: list = ()
    output: str = "log"
    condition: Any = None


MODULES = {
    "launch": [LaunchDescription],
    "launch.actions": [AppendEnvironmentVariable, DeclareLaunchArgument, IncludeLaunchDescription],
    "launch.conditions": [IfCondition, UnlessCondition],
    "launch.launch_description_sources": [PythonLaunchDescriptionSource],
    "launch.substitutions": [LaunchConfiguration, PathJoinSubstitution],
    "launch_ros": [],
    "launch_ros.actions": [Node, SetParameter],
    "launch_ros.parameter_descriptions": [ParameterValue],
    "launch_ros.substitutions": [FindPackageShare],
}


@contextlib.contextmanager
def installed():
    """While this lasts, the stand-ins are what launch files import."""
    before = {name: sys.modules.get(name) for name in MODULES}
    for name, classes in MODULES.items():
        module = types.ModuleType(name)
        module.__dict__.update({each.__name__: each for each in classes})
        sys.modules[name] = module
    try:
        yield
    finally:
        for name, module in before.items():
            del sys.modules[name]
            if module:
                sys.modules[name] = module
