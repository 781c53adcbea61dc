"""PPO, as skrl has it, learns to drive a rover through the caves of a dataset.

    pip install 'plume-caves[gym]' 'skrl[jax]>=2.1'
    plume dataset rover.toml -o drive
    python examples/python/train_drive.py drive --steps 200000 --save driver.pickle

The specification, here `rover.toml`, has `targets = ["mujoco"]` and `robot = "rover"`. It prints how often the trained driver arrives, and one that acts at random, in the same episodes.
"""

import argparse
import time
from collections.abc import Callable
from functools import partial
from typing import Any, NamedTuple

import gymnasium
import numpy as np
from gymnasium.vector import AsyncVectorEnv
from gymnasium.wrappers import FlattenObservation
from numpy.typing import NDArray
from skrl.agents.jax.ppo import PPO, PPO_CFG
from skrl.envs.wrappers.jax import wrap_env
from skrl.memories.jax import RandomMemory
from skrl.resources.preprocessors.jax import RunningStandardScaler
from skrl.trainers.jax import SequentialTrainer
from skrl.utils import set_seed
from skrl.utils.model_instantiators.jax import deterministic_model, gaussian_model

Floats = NDArray[np.float32]
Policy = Callable[[Floats], Floats]

ROLLOUT = 32
"""Steps of each environment between two updates. skrl unrolls the loop over them, and XLA takes a minute to compile 128."""
LAYERS = [{"name": "net", "input": "OBSERVATIONS", "layers": [128, 128], "activations": "elu"}]


class Score(NamedTuple):
    """What a policy gets: the share of episodes that end at the goal, and their mean return."""

    success: float
    mean_return: float


def main() -> None:
    """Trains, saves and compares."""
    wanted = arguments()
    started_s = time.perf_counter()
    agent = trained(wanted.dataset, wanted.steps, wanted.envs, wanted.seed)
    print(f"{wanted.steps / (time.perf_counter() - started_s):.0f} steps per second")
    if wanted.save:
        agent.save(wanted.save)
    for name, policy in (("random", at_random(wanted.seed)), ("trained", partial(driven_by, agent))):
        score = evaluate(policy, drive(wanted.dataset, wanted.part), wanted.episodes)
        print(f"{name:7}  success {score.success:4.0%}  mean return {score.mean_return:6.2f}")


def arguments() -> argparse.Namespace:
    """What is given on the command line."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("dataset", help="folder made by `plume dataset`, of target mujoco, certified for the rover")
    parser.add_argument("--steps", type=int, default=200_000, help="of all environments together")
    parser.add_argument("--envs", type=int, default=16, help="environments that run side by side, a process each")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--save", help="file for what was learned")
    parser.add_argument("--part", choices=["train", "validation", "test"], default="test", help="to be evaluated on")
    parser.add_argument("--episodes", type=int, default=40, help="to be evaluated on")
    return parser.parse_args()


def trained(dataset: str, steps: int, envs: int, seed: int) -> Any:
    """An agent of skrl that has learned from this many steps, of all environments together."""
    set_seed(seed)
    # Processes are forked before JAX starts its threads, which they would not have.
    env = wrap_env(AsyncVectorEnv([partial(drive, dataset)] * envs), wrapper="gymnasium", verbose=False)
    agent = driver(env)
    cfg = {"timesteps": steps // envs, "headless": True, "disable_progressbar": True}
    SequentialTrainer(env=env, agents=agent, cfg=cfg).train()
    env.close()
    return agent


def drive(dataset: str, part: str = "train") -> gymnasium.Env[Floats, Floats]:
    """The environment, with its observations in one row."""
    return FlattenObservation(gymnasium.make("plume.gym:plume/Drive-v0", dataset=dataset, part=part))


def driver(env: Any) -> Any:
    """An agent that knows nothing yet."""
    spaces = {"observation_space": env.observation_space, "action_space": env.action_space}
    models = {
        # Means within what can be commanded, and a spread that leaves most of what is drawn there too.
        "policy": gaussian_model(**spaces, initial_log_std=-0.5, network=LAYERS, output="tanh(ACTIONS)"),
        "value": deterministic_model(**spaces, network=LAYERS, output="ONE"),
    }
    for role, model in models.items():
        model.init_state_dict(role=role)
    settings = PPO_CFG(
        rollouts=ROLLOUT,
        learning_epochs=5,
        mini_batches=4,
        learning_rate=3e-4,
        # Ranges are shares of 10 m and rarely near 1, but speeds are m/s: each number is scaled by what was seen of it.
        observation_preprocessor=RunningStandardScaler,
        observation_preprocessor_kwargs={"size": env.observation_space},
        value_preprocessor=RunningStandardScaler,
        value_preprocessor_kwargs={"size": 1},
        # An episode that the clock cuts off would have gone on.
        time_limit_bootstrap=True,
    )
    settings.experiment.write_interval = settings.experiment.checkpoint_interval = 0
    memory = RandomMemory(memory_size=ROLLOUT, num_envs=env.num_envs)
    return PPO(models=models, memory=memory, cfg=settings, **spaces)


def driven_by(agent: Any, observation: Floats) -> Floats:
    """What the agent thinks best, without the noise that it explores with."""
    agent.enable_training_mode(False)
    _, outputs = agent.act(observation[None], None, timestep=0, timesteps=0)
    action: Floats = np.asarray(outputs["mean_actions"])[0]
    return action


def at_random(seed: int) -> Policy:
    """Any command, each as likely."""
    random = np.random.default_rng(seed)
    return lambda _: random.uniform(-1.0, 1.0, 2).astype(np.float32)


def evaluate(policy: Policy, env: gymnasium.Env[Floats, Floats], episodes: int) -> Score:
    """Drives the episodes of the first seeds, the same for every policy."""
    successes, total = 0, 0.0
    for seed in range(episodes):
        (observation, info), is_over = env.reset(seed=seed), False
        while not is_over:
            observation, reward, terminated, truncated, info = env.step(policy(observation))
            total, is_over = total + float(reward), terminated or truncated
        successes += info["is_success"]
    return Score(successes / episodes, total / episodes)


if __name__ == "__main__":
    main()
