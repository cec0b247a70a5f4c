"""The protocol of docs/protocol.md for adapters in Python: an adapter gives `serve` a function
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


def _reset_peak():
    """Lets the system forget the peak of memory until now; false where it cannot."""
    try:
        with open("/proc/self/clear_refs", "w", encoding="ascii") as file:
            file.write("5")
        return True
    except OSError:
        return False


def _peak():
    with open("/proc/self/status", encoding="ascii") as lines:
        for line in lines:
            if line.startswith("VmHWM:"):
                return 1024 * int(line.split()[1])
    return None


def serve(prepare):
    """Loads the model and answers requests. `prepare(positions, triangles)` returns `solve(source)`,
    which returns the distances of all vertices; only `solve` is timed as the solve."""
    model, source, output = sys.argv[1], int(sys.argv[2]), sys.argv[3]
    positions, triangles = _load(model)
    start = time.perf_counter()
    solve = prepare(positions, triangles)
    setup_seconds = time.perf_counter() - start
    _say(ready=True)
    for _ in sys.stdin:
        known = _reset_peak()
        start = time.perf_counter()
        distances = solve(source)
        seconds = time.perf_counter() - start
        peak = _peak() if known else None
        with open(output, "w", encoding="ascii") as file:
            file.write("vertex,distance\n")
            for vertex, distance in enumerate(distances):
                file.write(f"{vertex},{float(distance)!r}\n")
        _say(seconds=seconds, setup_seconds=setup_seconds, rss_peak_bytes=peak)
        setup_seconds = None
