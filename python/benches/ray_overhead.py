"""What Ray costs: the same dataset by local processes and by a Ray cluster of two nodes on this machine; seconds, best of three.

    python python/benches/ray_overhead.py      (or: cargo xtask bench ray)

Needs Ray (`pip install 'plume-caves[ray]'`) and an idle machine. Both have as many workers as there are cores, and both are warm:
the cluster is started before, and tasks of Ray keep their processes. Stops if the two datasets differ.
"""

import logging
import os
import tempfile
import time
from pathlib import Path

import plume
import plume.ray
import ray
from ray.cluster_utils import Cluster

ROUNDS = 3
CAVES_PER_CORE = 8
SPEC = """
name = "bench"
seeds = [1, {caves}]
targets = ["mujoco"]
sheet = 0
set = ["graph.nodes=8", "mesh.voxel_m=0.25", "texture.density_px_per_m=4", "lod.levels=0"]
"""


def main():
    cores = len(os.sched_getaffinity(0))
    caves = CAVES_PER_CORE * cores
    cluster = Cluster(initialize_head=True, head_node_args={"num_cpus": max(1, cores // 2)})
    cluster.add_node(num_cpus=max(1, cores - cores // 2))
    ray.init(address=cluster.address, log_to_driver=False, logging_level=logging.ERROR)
    with tempfile.TemporaryDirectory() as folder:
        spec = Path(folder) / "bench.toml"
        spec.write_text(SPEC.format(caves=caves), encoding="utf-8")
        took = {"processes": [], "ray": []}
        for number in range(ROUNDS):
            for engine, times in took.items():
                out = Path(folder) / f"{engine}-{number}"
                began_s = time.perf_counter()
                plume.dataset(spec, out, engine=engine)
                times.append(time.perf_counter() - began_s)
        sums = {(Path(folder) / f"{engine}-0/SHA256SUMS").read_bytes() for engine in took}
        assert len(sums) == 1, "the datasets differ"
    ray.shutdown()
    cluster.shutdown()
    alone_s, ray_s = (min(times) for times in took.values())
    per_minute = 60 * caves / alone_s
    print(
        f"{caves} caves on {cores} cores: processes {alone_s:.1f} s ({per_minute:.0f} caves per minute), ray {ray_s:.1f} s"
    )
    print(f"ratio {ray_s / alone_s:.3f}; all rounds: {took}")


if __name__ == "__main__":
    main()
