"""Named results: tuples whose fields have names."""

from __future__ import annotations

from typing import Literal, NamedTuple, Union

import numpy as np
from numpy.typing import NDArray

_Triple = tuple[float, float, float]


class Nearest(NamedTuple):
    """Distances, and the index of the nearest source of each; -1 where the distance is ``inf``.

    Examples
    --------
    >>> import geodesics as gd
    >>> gd.generate("grid,n=4").distance([0, 24], nearest=True).sources[:3]
    array([0, 0, 0])
    """

    distances: NDArray[np.float64]
    sources: NDArray[np.int64]


class Location(NamedTuple):
    """Where a point is, or where several are: then all fields are arrays.

    Examples
    --------
    >>> import geodesics as gd
    >>> gd.generate("grid,n=4").locate(gd.face(3, 0.2, 0.3, 0.5)).face
    3
    """

    face: Union[int, NDArray[np.int64]]
    barycentric: Union[_Triple, NDArray[np.float64]]
    position: Union[_Triple, NDArray[np.float64], None]
    distance: Union[float, NDArray[np.float64]]


class Counted(NamedTuple):
    """Distances, and the counts of the operations of the search.

    Examples
    --------
    >>> import geodesics as gd
    >>> solver = gd.Solver(gd.generate("grid,n=4"))
    >>> distances, counters = solver.count(0)
    """

    distances: NDArray[np.float64]
    counters: dict[str, int]


class Profiled(NamedTuple):
    """Distances, and the seconds in each phase of the search.

    Examples
    --------
    >>> import geodesics as gd
    >>> solver = gd.Solver(gd.generate("grid,n=4"))
    >>> distances, seconds = solver.profile(0)
    """

    distances: NDArray[np.float64]
    seconds: dict[str, float]


class Failure(NamedTuple):
    """A place where a distance is not proven.

    Examples
    --------
    >>> import geodesics as gd
    >>> mesh = gd.generate("grid,n=4")
    >>> gd.certify(mesh, 0, 2 * mesh.distance(0)).failures[0].kind
    'vertex'
    """

    kind: Literal["vertex", "face"]
    number: int
    amount: float

