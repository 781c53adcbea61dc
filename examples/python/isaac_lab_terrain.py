"""A cave as the terrain of Isaac Lab 2: environments start at its start poses.

    plume export --target isaac -o cave
    ./isaaclab.sh -p isaac_lab_terrain.py cave/cave.usda --num_envs 64 --headless

A ball takes the place of a robot in each environment. All environments share the one cave; balls of different ones pass through each
other.

Isaac Lab is not at hand where Plume is tested: there, only `start_poses` is run, on a package. Everything else was written by what
documentation and source of Isaac Lab 2 say, and has not run. Version 3 differs.

The height scanner of most tasks, `RayCasterCfg`, reads the first mesh under its path, which is one chunk. For the whole cave take
`MultiMeshRayCasterCfg` (2.3 and later).
"""

import argparse
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

RADIUS_M = 0.2
FALL_S = 2.0


def main() -> None:
    """Lets a ball fall at each start pose, and says how many stayed there."""
    from isaaclab.app import AppLauncher

    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("stage", type=Path, help="the stage of a package of target isaac")
    parser.add_argument("--num_envs", type=int, default=16)
    AppLauncher.add_app_launcher_args(parser)
    wanted = parser.parse_args()
    app = AppLauncher(wanted).app
    drop(wanted.stage, wanted.num_envs, wanted.device)
    app.close()


def drop(stage: Path, num_envs: int, device: str) -> None:
    """Makes the scene and simulates it. What it imports can be imported once the app runs."""
    from isaaclab.scene import InteractiveScene
    from isaaclab.sim import SimulationCfg, SimulationContext

    sim = SimulationContext(SimulationCfg(dt=1 / 120, device=device))
    scene = InteractiveScene(scene_of(stage, num_envs))
    positions, turns = start_poses(stage)
    # One row of origins, so that there are no levels of difficulty: the environments are spread evenly over the columns.
    scene.terrain.configure_env_origins(positions[None])
    sim.reset()
    ball = scene["ball"]
    state = ball.data.default_root_state.clone()
    state[:, :3] = scene.env_origins
    state[:, 2] += RADIUS_M
    state[:, 3:7] = state.new_tensor(turns)[scene.terrain.terrain_types]
    ball.write_root_state_to_sim(state)
    scene.reset()
    for _ in range(round(FALL_S / sim.get_physics_dt())):
        sim.step()
        scene.update(sim.get_physics_dt())
    sunk_m = state[:, 2] - ball.data.root_pos_w[:, 2]
    print(f"{int((sunk_m < RADIUS_M).sum())} of {num_envs} balls did not sink in")


def scene_of(stage: Path, num_envs: int) -> Any:
    """The cave, once, and a ball in each environment."""
    from isaaclab import sim as sim_utils
    from isaaclab.assets import RigidObjectCfg
    from isaaclab.scene import InteractiveSceneCfg
    from isaaclab.terrains import TerrainImporterCfg

    # The importer wants a spacing for its grid of origins; those of the cave replace it.
    scene = InteractiveSceneCfg(num_envs=num_envs, env_spacing=1.0)
    scene.terrain = TerrainImporterCfg(prim_path="/World/cave", terrain_type="usd", usd_path=str(stage.resolve()))
    scene.ball = RigidObjectCfg(
        prim_path="{ENV_REGEX_NS}/Ball",
        spawn=sim_utils.SphereCfg(
            radius=RADIUS_M,
            rigid_props=sim_utils.RigidBodyPropertiesCfg(),
            mass_props=sim_utils.MassPropertiesCfg(mass=1.0),
            collision_props=sim_utils.CollisionPropertiesCfg(),
        ),
    )
    return scene


def start_poses(stage: Path) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Where robots may start: points on the floor, (k, 3) in metres, and rotations, (k, 4) as w, x, y, z.

    +X of a rotation points along the passage. Chunks are not loaded for it.
    """
    from pxr import Usd, UsdGeom  # type: ignore[import-untyped]

    opened = Usd.Stage.Open(str(stage), Usd.Stage.LoadNone)
    spawns = opened.GetDefaultPrim().GetChild("Spawns").GetChildren()
    places = UsdGeom.XformCache()
    poses = [places.GetLocalToWorldTransform(spawn) for spawn in spawns]
    turns = [pose.ExtractRotationQuat() for pose in poses]
    positions = np.array([pose.ExtractTranslation() for pose in poses])
    return positions, np.array([[turn.GetReal(), *turn.GetImaginary()] for turn in turns])


if __name__ == "__main__":
    main()
