"""A solver to be replaced: Dijkstra's algorithm on the edges of a mesh.

Requests come as lines on standard input: load MODEL, ping, solve SOURCE, write FILE. Each is
answered with a line of JSON on standard output; print nothing else there. Only `solve` is timed.
"""

import heapq
import json
import math
import sys
import time


def load(path):
    """Positions, and the neighbours of each vertex, of an OBJ file of `v x y z` and `f a b c`."""
    positions, neighbours = [], []
    with open(path, encoding="ascii") as lines:
        for line in lines:
            kind, *words = line.split()
            if kind == "v":
                positions.append(tuple(map(float, words[:3])))
                neighbours.append(set())
            elif kind == "f":
                corners = [int(word) - 1 for word in words]
                for one in corners:
                    neighbours[one].update(other for other in corners if other != one)
    return positions, neighbours


def solve(mesh, source):
    """The distances of all vertices from the vertex `source`, counted from 0."""
    positions, neighbours = mesh
    distances = [math.inf] * len(positions)
    distances[source] = 0.0
    queue = [(0.0, source)]
    while queue:
        distance, vertex = heapq.heappop(queue)
        if distance > distances[vertex]:
            continue
        for other in neighbours[vertex]:
            further = distance + math.dist(positions[vertex], positions[other])
            if further < distances[other]:
                distances[other] = further
                heapq.heappush(queue, (further, other))
    return distances


def main():
    mesh, distances = None, []
    for line in sys.stdin:
        request, _, rest = line.rstrip("\n").partition(" ")
        answer = {}
        if request == "load":
            mesh = load(rest)
        elif request == "solve":
            start = time.perf_counter()
            distances = solve(mesh, int(rest))
            answer["seconds"] = time.perf_counter() - start
        elif request == "write":
            with open(rest, "w", encoding="ascii") as file:
                for vertex, distance in enumerate(distances):
                    file.write(f"{vertex},{distance!r}\n")
        print(json.dumps(answer), flush=True)


main()
