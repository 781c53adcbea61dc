"""A short training of examples/python/train_drive.py: it learns something finite, the same twice, and what it saves loads again.

python train.py
"""

import os
import runpy
import subprocess
import sys
import tempfile
from pathlib import Path

import jax
import numpy as np
import plume
from jax.flatten_util import ravel_pytree
from skrl.envs.wrappers.jax import wrap_env
from skrl.utils import set_seed

EXAMPLE = Path(__file__).parents[3] / "examples/python/train_drive.py"
SPEC = """
seeds = [1, 3]
targets = ["mujoco"]
robot = "rover"
sheet = 0
set = ["graph.nodes=4", "mesh.voxel_m=0.4", "texture.size_px=256"]
[split]
train = 2
validation = 0
test = 1
"""
STEPS, ENVS, SEED = 512, 2, 1
LEARNED = ["policy", "value", "observation_preprocessor", "value_preprocessor"]


def main() -> None:
    """Makes caves, trains in this process and in another, and looks at what was learned."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        # What the first training has compiled, the second need not: that is most of the time.
        cache = {"jax_compilation_cache_dir": f"{folder}/jax", "jax_persistent_cache_min_compile_time_secs": 0}
        for key, value in cache.items():
            jax.config.update(key, value)
        os.environ |= {key.upper(): str(value) for key, value in cache.items()}
        check(folder)
    print(f"{STEPS} steps: finite, the same twice, loaded again")


def check(folder: Path) -> None:
    (folder / "drive.toml").write_text(SPEC, encoding="utf-8")
    dataset = str(plume.dataset(folder / "drive.toml", folder / "drive").path)
    example = runpy.run_path(str(EXAMPLE))
    agent = example["trained"](dataset, STEPS, ENVS, SEED)
    losses_are_finite(agent, updates=STEPS // ENVS // example["ROLLOUT"])
    drive = example["drive"](dataset)
    set_seed(SEED)
    fresh = example["driver"](wrap_env(drive, wrapper="gymnasium", verbose=False))
    has_learned(agent, fresh)
    this, other = folder / "this.pickle", folder / "other.pickle"
    agent.save(this)
    command_line(dataset, other)
    assert this.read_bytes() == other.read_bytes(), "two trainings of one seed differ"
    fresh.load(other)
    acts_alike(agent, fresh, example["driven_by"], drive.reset(seed=SEED)[0])


def command_line(dataset: str, checkpoint: Path) -> None:
    """The example, as users run it."""
    counts = {"steps": STEPS, "envs": ENVS, "seed": SEED, "episodes": 1, "save": checkpoint}
    arguments = [str(word) for name, count in counts.items() for word in (f"--{name}", count)]
    subprocess.run([sys.executable, str(EXAMPLE), dataset, *arguments], check=True)


def losses_are_finite(agent, updates):
    for loss in ("Loss / Policy loss", "Loss / Value loss"):
        values = agent.tracking_data[loss]
        assert len(values) == updates and np.isfinite(values).all(), f"{loss}: {values}"


def has_learned(agent, fresh):
    """Everything is finite, and something else than before."""
    for name in LEARNED:
        now, before = numbers(agent, name), numbers(fresh, name)
        assert np.isfinite(now).all(), f"{name} is not finite"
        assert now.shape == before.shape and (now != before).mean() > 0.5, f"{name} has not changed"


def acts_alike(agent, loaded, driven_by, observation):
    for name in LEARNED:
        assert np.array_equal(numbers(agent, name), numbers(loaded, name)), f"{name} was not loaded"
    assert np.array_equal(driven_by(agent, observation), driven_by(loaded, observation))


def numbers(agent, name):
    """All that a part of an agent has learned, in one row."""
    return np.asarray(ravel_pytree(agent.checkpoint_modules[name].state_dict.params)[0])


if __name__ == "__main__":
    main()
