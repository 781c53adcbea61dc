"""The `plume` command of the Python package: the same as the binary, and the faults of what only it can do."""

import importlib.metadata
import json
import os
import re
import signal
import subprocess
import sys
import time

import plume
import pytest

SMALL = ["--set", "graph.nodes=12", "--set", "texture.size_px=256"]


def run(*arguments, **options):
    command = [sys.executable, "-m", "plume", *map(str, arguments)]
    return subprocess.run(command, capture_output=True, text=True, timeout=120, **options)


def export(target, folder, *arguments, **options):
    return run("export", "--target", target, "--output", folder, *SMALL, *arguments, **options)


def files(folder):
    return {path.relative_to(folder): path.read_bytes() for path in sorted(folder.rglob("*")) if path.is_file()}


def hidden(folder, text):
    """An environment in which `import pxr` finds this text first."""
    (folder / "pxr").mkdir(parents=True)
    (folder / "pxr/__init__.py").write_text(text)
    return {**os.environ, "PYTHONPATH": str(folder)}


def test_the_command_tells_its_version():
    assert run("--version").stdout == f"plume {plume.__version__}\n"


def test_usage_is_told_with_2():
    result = run("export", "--target", "isac")
    assert result.returncode == 2
    assert "isaac" in result.stderr


@pytest.mark.parametrize("target", ["gazebo", "gltf", "urdf"])
def test_plain_targets_are_those_of_the_binary(target, binary, tmp_path):
    assert export(target, tmp_path / "package").returncode == 0
    arguments = ["export", "--target", target, "--output", tmp_path / "binary", *SMALL]
    subprocess.run([binary, *arguments], check=True, capture_output=True)
    assert files(tmp_path / "package") == files(tmp_path / "binary")


@pytest.mark.parametrize("target", ["isaac", "usd", "usdz"])
def test_the_same_cave_gives_the_same_bytes(target, tmp_path):
    once = export(target, tmp_path / "once", "--threads", "1")
    assert once.returncode == 0, once.stderr
    # A ZIP archive counts time in steps of two seconds.
    time.sleep(2.1)
    again = export(target, tmp_path / "again", "--threads", "4", env={**os.environ, "TZ": "Asia/Tokyo"})
    assert again.returncode == 0, again.stderr
    assert files(tmp_path / "once") == files(tmp_path / "again")


def test_the_binary_hands_over(binary, tmp_path):
    arguments = ["export", "--target", "isaac", "--output", tmp_path / "cave", "--json", *SMALL]
    environment = {**os.environ, "PLUME_PYTHON": sys.executable}
    result = subprocess.run([binary, *arguments], capture_output=True, text=True, env=environment, timeout=120)
    assert result.returncode == 0, result.stderr
    assert json.loads(result.stdout)["isaac"]["files"] == len(files(tmp_path / "cave"))


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ("raise ModuleNotFoundError(\"No module named 'pxr'\")", "which cannot be loaded: ModuleNotFoundError"),
        (
            "class Usd:\n    GetVersion = lambda: (0, 25, 5)\nimport sys\nsys.modules['pxr.Usd'] = Usd",
            "fake/pxr has the unsupported version 25.05",
        ),
        (
            "class Usd:\n    GetVersion = lambda: (0, 27, 2)\nimport sys\nsys.modules['pxr.Usd'] = Usd",
            "fake/pxr has the unsupported version 27.02",
        ),
        (
            "class Usd:\n    GetVersion = lambda: (0, 26, 11)\nimport sys\nsys.modules['pxr.Usd'] = Usd",
            "which cannot be used: ImportError",
        ),
    ],
)
def test_a_missing_or_unsupported_usd_core_exits_with_69(text, told, tmp_path):
    result = export("gltf,isaac", tmp_path / "out", env=hidden(tmp_path / "fake", text))
    assert result.returncode == 69, result.stderr
    assert told in result.stderr
    assert " hint: pip install 'plume-caves[usd]'" in result.stderr
    assert not (tmp_path / "out").exists()


def test_the_extra_installs_the_versions_of_usd_that_are_told(tmp_path):
    old = "class Usd:\n    GetVersion = lambda: (0, 22, 11)\nimport sys\nsys.modules['pxr.Usd'] = Usd"
    result = export("isaac", tmp_path / "out", env=hidden(tmp_path / "fake", old))
    first, end = re.search(r"versions from (\d+\.\d+) to before (\d+)\.0 are supported", result.stderr).groups()
    [extra] = [line for line in importlib.metadata.requires("plume-caves") if line.startswith("usd-core")]
    needed, marker = extra.split(";")
    assert set(needed.removeprefix("usd-core").strip().split(",")) == {f">={first}", f"<{end}"}
    assert marker.strip().replace("'", '"') == 'extra == "usd"'


def test_targets_without_usd_do_not_load_it(tmp_path):
    result = export("gltf", tmp_path / "out", env=hidden(tmp_path / "fake", "raise SystemExit('loaded')"))
    assert result.returncode == 0, result.stderr


def test_a_folder_that_cannot_be_written_is_told(tmp_path):
    (tmp_path / "file").write_text("a file")
    result = export("isaac", tmp_path / "file/cave")
    assert result.returncode == 2
    assert "file/" in result.stderr
    assert [path.name for path in tmp_path.iterdir()] == ["file"]


def test_names_that_are_no_prim_names_are_refused(tmp_path):
    result = export("isaac", tmp_path / "out", "--set", "name=My Cave")
    assert result.returncode == 2
    assert "name" in result.stderr
    made = export("isaac", tmp_path / "out", "--set", "name=a-7th-cave")
    assert made.returncode == 0, made.stderr
    assert (tmp_path / "out/a_7th_cave.usda").exists()


def wait_for(folder, pattern, process):
    while not any(folder.glob(pattern)):
        assert process.poll() is None, f"ended before {pattern} was there"
        time.sleep(0.01)


@pytest.mark.parametrize("sign", [".cave.cave/chunks", ".plume-*/package/chunks"], ids=["mesh", "export"])
def test_ctrl_c_stops_with_130_and_the_next_run_goes_on(sign, tmp_path):
    arguments = ["export", "--target", "isaac", "--output", str(tmp_path / "cave"), "--set", "graph.nodes=40"]
    command = [sys.executable, "-m", "plume", *arguments, "--threads", "1", "--set", "texture.density_px_per_m=8"]
    process = subprocess.Popen(command, stderr=subprocess.PIPE, text=True)
    wait_for(tmp_path, sign, process)
    process.send_signal(signal.SIGINT)
    _, stderr = process.communicate(timeout=60)
    assert process.returncode == 130, stderr
    assert "error: interrupted" in stderr and "resumes where it stopped" in stderr
    assert [path.name for path in tmp_path.iterdir()] == [".cave.cave"]
    again = subprocess.run(command, capture_output=True, text=True)
    assert again.returncode == 0, again.stderr
    assert [path.name for path in tmp_path.iterdir()] == ["cave"]


def test_a_killed_export_leaves_no_package_and_the_next_one_makes_it(tmp_path):
    command = [sys.executable, "-m", "plume", "export", "--target", "isaac", "--output", str(tmp_path / "cave"), *SMALL]
    whole = subprocess.run([*command[: -len(SMALL) - 1], str(tmp_path / "whole"), *SMALL], capture_output=True)
    assert whole.returncode == 0, whole.stderr
    for sign in [".cave.cave/journal.jsonl", ".cave.cave/textures", ".plume-*/package"]:
        process = subprocess.Popen(command, stderr=subprocess.DEVNULL)
        wait_for(tmp_path, sign, process)
        process.kill()
        process.wait()
        assert not (tmp_path / "cave").exists()
    again = subprocess.run([*command, "--force"], capture_output=True, text=True)
    assert again.returncode == 0, again.stderr
    assert files(tmp_path / "cave") == files(tmp_path / "whole")
    assert sorted(path.name for path in tmp_path.iterdir()) == ["cave", "whole"]
