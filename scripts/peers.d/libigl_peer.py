"""libigl: Kirsanov's MMP. It offers one function, which sets up its mesh each time; that is part of
the time of a solve."""

import igl
import numpy
from session import serve


def prepare(positions, triangles):
    nothing = numpy.array([], dtype=numpy.int64)
    targets = numpy.arange(len(positions), dtype=numpy.int64)
    triangles = triangles.astype(numpy.int64)

    def solve(source):
        sources = numpy.array([source], dtype=numpy.int64)
        return igl.exact_geodesic(positions, triangles, sources, nothing, targets, nothing)

    return solve


serve(prepare)
