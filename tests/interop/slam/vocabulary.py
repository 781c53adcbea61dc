"""Trains the vocabulary by which ORB-SLAM3 recognises places.

    vocabulary.py OUT.txt IMAGE...

The one that comes with ORB-SLAM3 has 139 MB and is not on PyPI; ORB-SLAM3 takes any other. This one is made from images of
passages that no run goes through: a tree of medians of ORB features under Hamming distance (Gálvez-López and Tardós, Bags of
Binary Words for Fast Place Recognition in Image Sequences, 2012), in the text format of DBoW2, weighted by how few images have a
word. The same images give the same tree.
"""

import sys
from pathlib import Path

import cv2
import numpy as np

BRANCHES, LEVELS = 10, 6
FEATURES = 1000  # of an image, as in the settings of the runs
FAST = 10
ROUNDS = 6  # medians hardly move after that
FEWEST = 4  # features that are not divided any more
SEED = 1


class Tree:
    """Nodes in the order of the file: parent (0 is the root), whether it is a word, median, weight."""

    def __init__(self, features, images):
        self.features, self.images, self.count = features, images, images.max() + 1
        self.random = np.random.default_rng(SEED)
        self.nodes = []
        self.divide(np.arange(len(features)), 0, 1)

    def divide(self, members, parent, level):
        medians, nearest = self.medians(members)
        for branch, median in enumerate(medians):
            below = members[nearest == branch]
            if not len(below):
                continue
            is_word = level == LEVELS or len(below) < FEWEST or len(medians) == 1
            weight = np.log(self.count / len(np.unique(self.images[below]))) if is_word else 0.0
            self.nodes.append((parent, is_word, median, weight))
            if not is_word:
                self.divide(below, len(self.nodes), level + 1)

    def medians(self, members):
        """Of at most BRANCHES groups, and to which each member belongs."""
        features = self.features[members]
        distinct = np.unique(features, axis=0)
        if len(distinct) <= BRANCHES:
            return distinct, nearest(features, distinct)
        medians = distinct[self.random.choice(len(distinct), BRANCHES, replace=False)]
        for _ in range(ROUNDS):
            groups = nearest(features, medians)
            moved = [median_of(features[groups == k], medians[k]) for k in range(BRANCHES)]
            if np.array_equal(moved, medians):
                break
            medians = np.array(moved)
        return medians, nearest(features, medians)

    def text(self):
        """`k L`, the L1 score and weights by tf-idf, then a node a line."""
        lines = [f"{BRANCHES} {LEVELS} 0 0"]
        for parent, is_word, median, weight in self.nodes:
            lines.append(f"{parent} {is_word:d} {' '.join(map(str, median))} {weight:.6f}")
        return "\n".join(lines) + "\n"


def nearest(features, medians):
    one, other = features.view(np.uint64), np.ascontiguousarray(medians).view(np.uint64)
    return np.bitwise_count(one[:, None] ^ other[None]).sum(axis=2, dtype=np.int32).argmin(axis=1)


def median_of(features, otherwise):
    """The bits that most have."""
    if not len(features):
        return otherwise
    return np.packbits(np.unpackbits(features, axis=1).sum(axis=0, dtype=np.int64) * 2 >= len(features))


def features_of(images):
    """All features, and the number of the image that each is from."""
    orb = cv2.ORB_create(FEATURES, 1.2, 8, fastThreshold=FAST)
    found = [orb.detectAndCompute(cv2.imread(str(image), cv2.IMREAD_GRAYSCALE), None)[1] for image in images]
    found = [features for features in found if features is not None]
    return np.concatenate(found), np.repeat(np.arange(len(found)), [len(features) for features in found])


def main():
    out, *images = map(Path, sys.argv[1:])
    tree = Tree(*features_of(images))
    part = out.with_suffix(".part")
    part.write_text(tree.text(), encoding="ascii")
    part.replace(out)
    print(f"{sum(is_word for _, is_word, _, _ in tree.nodes)} words from {len(images)} images")


if __name__ == "__main__":
    main()
