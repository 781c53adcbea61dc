"""The environment of Gymnasium: its own checker, episodes that can be solved, and caves drawn as asked for."""

import gymnasium
import numpy as np
import plume
import plume.gym
import pytest
from gymnasium.utils.env_checker import check_env
from plume.drive import Drive

SPEC = """
name = "drive"
seeds = [1, 3]
targets = ["mujoco"]
robot = "rover"
sheet = 0
set = ["graph.nodes=6", "mesh.voxel_m=0.25", "texture.size_px=256"]
[split]
train = 2
validation = 0
test = 1
[[vary]]
key = "difficulty"
draw = "uniform"
values = [0.0, 0.4]
"""


@pytest.fixture(scope="module")
def dataset(tmp_path_factory):
    folder = tmp_path_factory.mktemp("gym")
    (folder / "drive.toml").write_text(SPEC, encoding="utf-8")
    return plume.dataset(folder / "drive.toml", folder / "drive")


@pytest.mark.parametrize("sensor", ["lidar", "depth"])
@pytest.mark.filterwarnings("error")
def test_gymnasium_accepts_it(dataset, sensor):
    check_env(gymnasium.make("plume/Drive-v0", dataset=dataset.path, sensor=sensor).unwrapped)


def test_episodes_can_be_solved(dataset):
    drive = Drive(dataset.path)
    for seed in range(4):
        drive.reset(seed=seed)
        total, info = driven_along_its_path(drive)
        assert info["is_success"], (seed, info)
        assert total > 5.0


def test_who_stands_still_gets_nothing(dataset):
    drive = gymnasium.make("plume/Drive-v0", dataset=dataset.path)
    drive.reset(seed=1)
    for _ in range(600):
        _, reward, terminated, truncated, _ = drive.step(np.zeros(2, dtype=np.float32))
        assert reward < 0.005 and not terminated
    assert truncated


def test_the_same_seed_draws_the_same_episode(dataset):
    episodes = []
    for _ in range(2):
        drive = Drive(dataset.path)
        observed = [drive.reset(seed=5)[0]]
        observed += [drive.step(np.array([0.5, 0.2], dtype=np.float32))[0] for _ in range(20)]
        episodes.append(observed)
    for one, other in zip(*episodes, strict=True):
        assert all(np.array_equal(one[key], other[key]) for key in one)


def test_rays_meet_what_is_ahead(dataset):
    drive = Drive(dataset.path, sensor="depth")
    observed, _ = drive.reset(seed=2)
    floor_m, level_m = observed["depth"][-1].mean() * 10, observed["depth"][12].mean() * 10
    # A row 29 degrees down, from 0.72 m above the floor.
    assert 1.0 < floor_m < 2.2 and level_m > floor_m


def test_caves_are_those_of_the_part_and_the_difficulty(dataset):
    rows = {row["item"]: row for row in dataset.caves}
    drive = Drive(dataset.path, part="test")
    assert {rows[number]["part"] for number in drive._caves} == {"test"}
    easiest = min(row["difficulty"] for row in rows.values() if row["part"] == "train")
    drive = Drive(dataset.path, difficulty=(0.0, easiest))
    assert [rows[number]["difficulty"] for number in drive._caves] == [easiest]


def test_what_is_no_such_dataset_is_told(dataset, tmp_path):
    with pytest.raises(plume.InputError, match="is no finished dataset"):
        Drive(tmp_path)
    with pytest.raises(plume.InputError, match=r"no cave of part train .* difficulty \(0.9, 1.0\)"):
        Drive(dataset.path, difficulty=(0.9, 1.0))
    with pytest.raises(plume.InputError, match="there is no cave 77"):
        Drive(dataset.path).reset(options={"cave": 77})


def driven_along_its_path(drive):
    """Pursues a point half a metre ahead, as the drives that certificates are held to."""
    total, is_over = 0.0, False
    while not is_over:
        rover, path = drive._rover, drive._path
        away = (path.at(min(drive._passed_m + 0.5, path.length_m)) - rover.position) @ rover.axes
        bearing = np.arctan2(away[1], away[0])
        action = [0.5 * (abs(bearing) < 0.4), np.clip(2 * bearing, -1, 1)]
        _, reward, is_over, _, info = drive.step(np.array(action, dtype=np.float32))
        total += reward
    return total, info
