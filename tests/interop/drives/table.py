"""Sums up what certificates said and what came of drives, from the lines that `drives.py` has written.

    table.py RESULTS.jsonl

For each robot, in default caves and in others, it prints how many passages were called what, each way; how many of their paths were
driven and how many were not; the steepest floor over half a metre on paths that are called go; and recall: the share of what is
called go in all that can be driven, where of each class as large a share of passages is supposed to be drivable as was driven. It
fails if a path that is called go was not driven.
"""

import json
import sys
from collections import Counter
from pathlib import Path

from paths import CLASSES

DEFAULT = "seed_"


def main(results):
    found = [json.loads(line) for line in results.read_text(encoding="utf-8").splitlines()]
    print("| robot | caves | called | passages, each way | paths driven | not driven |")
    print("|---|---|---|---|---|---|")
    groups = sorted({group_of(one) for one in found}, reverse=True)
    said = [line for group in groups for line in rows(group, [one for one in found if group_of(one) == group])]
    print(
        "\n".join([*said, "", *(recall(group, [one for one in found if group_of(one) == group]) for group in groups)])
    )
    failed = [(one["cave"], one["robot"], drive) for one in found for drive in one["drives"] if is_wrong(drive)]
    for cave, robot, drive in failed:
        print(f"{robot} in {cave}: {drive['path']} {drive['fault']} after {drive['passed_m']} of {drive['length_m']} m")
    if failed:
        sys.exit(f"{len(failed)} paths that are called go were not driven")


def group_of(one):
    return one["robot"], "default" if one["cave"].startswith(DEFAULT) else "others"


def is_wrong(drive):
    return drive["said"] == "go" and drive["fault"] is not None


def rows(group, found):
    robot, kind = group
    passages, outcomes = counts(found)
    for said in CLASSES:
        told = [robot, f"{len(found)} {kind}", said, passages[said], outcomes[said, True], outcomes[said, False]]
        yield f"| {' | '.join(map(str, told))} |"


def counts(found):
    """Passages by class, and drives by class and whether they came to the end."""
    passages = Counter()
    for one in found:
        passages.update(one["passages"])
    drives = [drive for one in found for drive in one["drives"]]
    return passages, Counter((drive["said"], drive["fault"] is None) for drive in drives)


def recall(group, found):
    passages, outcomes = counts(found)
    tried = {said: outcomes[said, True] + outcomes[said, False] for said in CLASSES}
    drivable = {said: passages[said] * outcomes[said, True] / max(tried[said], 1) for said in CLASSES}
    everything = max(sum(drivable.values()), 1)
    go, marginal = drivable["go"] / everything, drivable["marginal"] / everything
    drives = [drive for one in found for drive in one["drives"] if drive["said"] == "go"]
    length_m = sum(drive["passed_m"] for drive in drives)
    slope_deg = max((drive["slope_deg"] for drive in drives), default=0)
    return (
        f"{group[0]}, {group[1]}: recall {go:.3f}, with marginal {go + marginal:.3f}; {length_m:.0f} m driven on go, of "
        f"which the floor is {slope_deg:.1f} degrees steep at most"
    )


if __name__ == "__main__":
    main(Path(sys.argv[1]))
