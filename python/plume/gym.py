"""Environments of Gymnasium: `pip install plume-caves[gym]`.

    import gymnasium
    import plume.gym

    gymnasium.make("plume/Drive-v0", dataset="drive", difficulty=(0.0, 0.5))

Importing this module registers them; `gymnasium.make("plume.gym:plume/Drive-v0")` imports it too. What they do is said where they are:
`plume.drive.Drive`.
"""

import gymnasium

STEPS = 600
"""The default limit of an episode: a minute of driving."""

gymnasium.register(id="plume/Drive-v0", entry_point="plume.drive:Drive", max_episode_steps=STEPS)
