"""Protocol 2 of docs/protocol.md for adapters in Python: an adapter gives `serve` a function
that prepares its library for a mesh and returns another one that solves."""

import json
import os
import sys
import time

import numpy

# Redirects library output to stderr; stdout carries replies only.
_answers = os.fdopen(os.dup(1), "w")
os.dup2(2, 1)


def _say(**answer):
    print(json.dumps(answer), file=_answers, flush=True)


def _load(path):
    """Positions and triangles of an OBJ file as geobench hands it over: `v x y z` and `f a b c`."""
    positions, triangles = [], []
    with open(path, encoding="ascii") as lines:
        for line in lines:
            words = line.split()
            if words and words[0] == "v":
                positions.append([float(word) for word in words[1:4]])
            elif words and words[0] == "f":
                triangles.append([int(word) - 1 for word in words[1:4]])
    return numpy.array(positions), numpy.array(triangles)


def serve(prepare):
    """Answers requests. `prepare(positions, triangles)` returns `solve(source)`, which returns the distances
    of all vertices; only `solve` is timed as the solve."""
    for line in sys.stdin:
        request, _, rest = line.rstrip("\n").partition(" ")
        if request == "load":
            positions, triangles = _load(rest)
            start = time.perf_counter()
            solve = prepare(positions, triangles)
            _say(setup_seconds=time.perf_counter() - start)
        elif request == "ping":
            _say()
        elif request == "solve":
            source = int(rest)
            start = time.perf_counter()
            distances = solve(source)
            _say(seconds=time.perf_counter() - start)
        elif request == "write":
            with open(rest, "w", encoding="ascii") as file:
                file.write("vertex,distance\n")
                for vertex, distance in enumerate(distances):
                    file.write(f"{vertex},{float(distance)!r}\n")
            _say()
        else:
            sys.exit(f"unknown request: {line}")
