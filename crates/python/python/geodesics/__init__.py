"""Exact geodesic distances on triangle meshes.

>>> import geodesics as gd
>>> mesh = gd.generate("grid,n=4")
>>> float(mesh.distance(0)[24])
5.656854249492381

`Mesh` has distances, paths and Voronoi diagrams. `Solver` keeps the set-up of one of the
`algorithms`. `run` measures them, `certify` proves distances right.
"""

from ._core import (
    Arc,
    Cell,
    Certificate,
    Curve,
    Field,
    Isoline,
    IsolineLine,
    Mesh,
    MeshError,
    Path,
    Point,
    PrecisionWarning,
    Solver,
    Voronoi,
    VoronoiVertex,
    __version__,
    algorithms,
    at,
    certify,
    edge,
    face,
    generate,
    read,
    vertex,
)
from ._results import Table, read_results, run
from ._types import Counted, Failure, Location, Nearest, Profiled

__all__ = [
    "Arc",
    "Cell",
    "Certificate",
    "Counted",
    "Curve",
    "Failure",
    "Field",
    "Isoline",
    "IsolineLine",
    "Location",
    "Mesh",
    "MeshError",
    "Nearest",
    "Path",
    "Point",
    "PrecisionWarning",
    "Profiled",
    "Solver",
    "Table",
    "Voronoi",
    "VoronoiVertex",
    "__version__",
    "algorithms",
    "at",
    "certify",
    "edge",
    "face",
    "generate",
    "read",
    "read_results",
    "run",
    "vertex",
]
