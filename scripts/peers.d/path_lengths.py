"""Compares the lengths of paths that `geobench path` wrote with those of pygeodesic and
geometry-central, and prints a table in Markdown. Arguments: models, each with its file of paths."""

import json
import sys

import numpy as np
import potpourri3d
from pygeodesic import geodesic

# Lengths that differ by less, relatively, are equal: the sum of some hundred segments.
EQUAL = 1e-9

# By how much lengths of pygeodesic may differ: it traces paths edge by edge.
TRACED = 1e-6


def length(points):
    return float(np.linalg.norm(np.diff(np.asarray(points), axis=0), axis=1).sum())


def compare(model, file):
    """A row of the table, and whether all is as it must be."""
    with open(file, encoding="utf-8") as stream:
        document = json.load(stream)
    paths = [p for p in document["paths"] if p["length"]]
    vertices, faces = potpourri3d.read_mesh(model)
    exact = geodesic.PyGeodesicAlgorithmExact(vertices, faces)
    flips = potpourri3d.EdgeFlipGeodesicSolver(vertices, faces)
    distances, traced, flipped, failed = [], [], [], 0
    for path in paths:
        source, target, ours = path["source"], path["target"], path["length"]
        distance, points = exact.geodesicDistance(source, target)
        distances.append(distance / ours - 1)
        traced.append(length(points) / ours - 1)
        try:
            flipped.append(length(flips.find_geodesic_path(source, target)) / ours - 1)
        except RuntimeError:
            failed += 1
    distances, traced, flipped = map(np.array, (distances, traced, flipped))
    longer = flipped[flipped > EQUAL]
    worst = f"{longer.max():.1%}" if longer.size else "0"
    row = [
        document["model"],
        f"{len(vertices):,}",
        str(len(paths)),
        f"{np.abs(distances).max():.1e}",
        f"{np.abs(traced).max():.1e}",
        f"{np.sum(np.abs(flipped) <= EQUAL)} of {len(flipped)}",
        worst,
        str(int(np.sum(flipped < -EQUAL))),
    ]
    if failed:
        row[5] += f" ({failed} failed)"
    good = np.abs(distances).max() <= EQUAL and np.abs(traced).max() <= TRACED
    return row, bool(good and not np.any(flipped < -EQUAL))


def main():
    heads = [
        "model",
        "vertices",
        "paths",
        "pygeodesic: distance off by",
        "its paths off by",
        "geometry-central: as short",
        "longest is longer by",
        "shorter",
    ]
    print("| " + " | ".join(heads) + " |")
    print("|" + "---|" * len(heads), flush=True)
    arguments = iter(sys.argv[1:])
    all_good = True
    for model, file in zip(arguments, arguments):
        row, good = compare(model, file)
        all_good &= good
        print("| " + " | ".join(row) + " |", flush=True)
    return 0 if all_good else 1


sys.exit(main())
