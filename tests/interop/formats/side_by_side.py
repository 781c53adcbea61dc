"""Joins pictures of the same size from left to right: side_by_side.py OUT.jpg IN.png…"""

import sys

from PIL import Image

GAP = 4

out, *names = sys.argv[1:]
pictures = [Image.open(name).convert("RGB") for name in names]
width, height = pictures[0].size
strip = Image.new("RGB", (len(pictures) * (width + GAP) - GAP, height), "white")
for place, picture in enumerate(pictures):
    strip.paste(picture, (place * (width + GAP), 0))
strip.save(out, quality=86, optimize=True)
