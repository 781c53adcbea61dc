"""Prints what was found of all variants as a table, and keeps it as FOLDER/table.md and FOLDER/table.json.

table.py FOLDER VARIANT...
"""

import json
import sys
from pathlib import Path

COLUMNS = [
    ("frames tracked", lambda row: f"{row['tracked']:.1%}"),
    ("ATE, cm", lambda row: f"{row['ate_cm']:.1f}"),
    ("RPE, cm/m", lambda row: f"{row['rpe_cm_per_m']:.2f}"),
    ("RPE, °/m", lambda row: f"{row['rpe_deg_per_m']:.2f}"),
    ("end off by, cm", lambda row: f"{row['end_cm']:.1f}"),
    ("loop closed at frame", lambda row: ", ".join(map(str, row["loops"])) or "no"),
    ("points tracked", lambda row: f"{row['points']:.0f}"),
    ("corners", lambda row: f"{row['corners']:.0f}"),
    ("inliers a second later", lambda row: f"{row['inliers']:.0f} ({row['inlier_share']:.0%})"),
    ("CPU s a frame", lambda row: f"{row['cpu_s_per_frame']:.3f}"),
]


def table(rows):
    titles = ["variant", *(title for title, _ in COLUMNS)]
    lines = [titles, ["---", *("---:" for _ in COLUMNS)]]
    lines += [[row["variant"], *(cell(told, row) for _, told in COLUMNS)] for row in rows]
    return "".join(f"| {' | '.join(line)} |\n" for line in lines)


def cell(told, row):
    """Of what some variants do not have, a dash."""
    try:
        return told(row)
    except KeyError:
        return "–"


def main():
    folder, *variants = sys.argv[1:]
    folder = Path(folder)
    files = [folder / "results" / f"{variant}.json" for variant in variants]
    rows = [json.loads(file.read_text(encoding="ascii")) for file in files if file.exists()]
    text = table(rows)
    (folder / "table.md").write_text(text, encoding="utf-8")
    (folder / "table.json").write_text(json.dumps(rows, indent=2) + "\n", encoding="ascii")
    print(text)


if __name__ == "__main__":
    main()
