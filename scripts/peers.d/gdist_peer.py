"""gdist: Kirsanov's MMP. It offers one function, which sets up its mesh each time; that is part of the
time of a solve."""

import gdist
import numpy
from session import serve


def prepare(positions, triangles):
    triangles = triangles.astype(numpy.int32)

    def solve(source):
        return gdist.compute_gdist(positions, triangles, numpy.array([source], numpy.int32))

    return solve


serve(prepare)
