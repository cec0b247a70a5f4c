"""pygeodesic: Kirsanov's MMP. The mesh is set up before; a solve is the propagation and the query of
the distance of every vertex."""

import numpy
from pygeodesic.geodesic import PyGeodesicAlgorithmExact
from session import serve


def prepare(positions, triangles):
    algorithm = PyGeodesicAlgorithmExact(positions, triangles)

    def solve(source):
        distances, _ = algorithm.geodesicDistances(numpy.array([source]), None)
        return distances

    return solve


serve(prepare)
