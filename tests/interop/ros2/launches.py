"""Runs launch files on the stand-ins, and lists what they would start."""

import runpy
from dataclasses import dataclass, field
from pathlib import Path

import stand_in
from failure import Failure, require

# Launch files of other packages that are included, with their arguments in Jazzy.
OF_OTHERS = {"ros_gz_sim/launch/gz_sim.launch.py": {"gz_args", "gz_version", "on_exit_shutdown", "debugger"}}


@dataclass
class Process:
    """A node as it would be started."""

    package: str
    executable: str
    name: str
    parameters: list
    remappings: dict
    arguments: list
    shared: dict


@dataclass
class Started:
    """What a launch file starts with some arguments."""

    nodes: list = field(default_factory=list)
    included: list = field(default_factory=list)
    environment: dict = field(default_factory=dict)
    parameters: dict = field(default_factory=dict)
    arguments: dict = field(default_factory=dict)


def start(path, arguments):
    """Runs a launch file of a package."""
    started = Started()
    _run(path, dict(arguments), started)
    return started


def _run(path, scope, started):
    require(path.is_file(), f"there is no launch file {path.name}")
    try:
        with stand_in.installed():
            description = runpy.run_path(str(path))["generate_launch_description"]()
    except Exception as reason:  # noqa: BLE001 - whatever a launch file does wrong
        raise Failure(f"{path.name} fails: {type(reason).__name__}: {reason}") from reason
    declared = {each.name for each in description.entities if isinstance(each, stand_in.DeclareLaunchArgument)}
    unknown = set(scope) - declared
    require(not unknown, f"{path.name} has no argument {unknown}")
    for entity in description.entities:
        _visit(entity, path, scope, started)
    started.arguments[path.name] = declared


def _visit(entity, path, scope, started):
    condition = getattr(entity, "condition", None)
    if condition and _text(condition.predicate, scope, path) != condition.wanted:
        return
    match entity:
        case stand_in.DeclareLaunchArgument(name, default, _, choices):
            value = scope.setdefault(name, default)
            require(not choices or value in choices, f"{path.name}: {name} cannot be {value}")
        case stand_in.SetParameter(name, value):
            started.parameters[name] = value
        case stand_in.AppendEnvironmentVariable(name, value):
            started.environment[name] = _text(value, scope, path)
        case stand_in.IncludeLaunchDescription(source, arguments):
            place = _text(source.location, scope, path)
            given = {name: _text(value, scope, path) for name, value in arguments}
            _include(place, given, path, started)
        case stand_in.Node():
            started.nodes.append(_process(entity, scope, path, started.parameters))
        case _:
            raise Failure(f"{path.name} has a {type(entity).__name__}, which this check does not know")


def _include(place, given, path, started):
    share = "share:"
    if place.startswith(share):
        known = OF_OTHERS.get(place.removeprefix(share))
        require(known is not None, f"{path.name} includes {place}, which this check does not know")
        require(set(given) <= known, f"{place} has no argument {set(given) - known}")
        started.included.append((place, given))
        return
    _run(Path(place), given, started)


def _process(node, scope, path, shared):
    parameters = [
        {key: _text(value, scope, path) for key, value in each.items()} if isinstance(each, dict) else each
        for each in node.parameters
    ]
    arguments = [_text(word, scope, path) for word in node.arguments]
    require(all(isinstance(word, str) for word in arguments), f"{node.executable} has arguments that are no text")
    name = node.name or node.executable
    return Process(node.package, node.executable, name, parameters, dict(node.remappings), arguments, dict(shared))


def _text(value, scope, path):
    match value:
        case stand_in.LaunchConfiguration(name):
            require(name in scope, f"{path.name} uses {name}, which it has not declared before")
            return scope[name]
        case stand_in.PathJoinSubstitution(parts):
            return "/".join(_text(part, scope, path) for part in parts)
        case stand_in.FindPackageShare(package):
            return f"share:{package}"
        case stand_in.ParameterValue(inner, _):
            return _text(inner, scope, path)
        case _:
            return value
