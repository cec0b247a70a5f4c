"""potpourri3d: the heat method, which is approximate. Its factorisation is set-up; a solve is two
back substitutions."""

import potpourri3d
from session import serve


def prepare(positions, triangles):
    solver = potpourri3d.MeshHeatMethodDistanceSolver(positions, triangles)
    return solver.compute_distance


serve(prepare)
