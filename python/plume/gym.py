"""Environments of Gymnasium: `pip install plume-caves[gym]`.

    gymnasium.make("plume/Drive-v0", dataset="drive", difficulty=(0.0, 0.5))

Gymnasium finds them by itself; what they do is said where they are: `plume.drive.Drive`.
"""

import gymnasium

STEPS = 600
"""The default limit of an episode: a minute of driving."""


def register() -> None:
    """Registers all environments; Gymnasium calls this when it is imported, in the namespace `plume`."""
    gymnasium.register(id="Drive-v0", entry_point="plume.drive:Drive", max_episode_steps=STEPS)
