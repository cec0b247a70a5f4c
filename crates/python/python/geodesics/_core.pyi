"""The compiled part of the package."""

import os
from collections.abc import Iterable, Iterator, Sequence
from typing import Any, Literal, SupportsIndex, Union, final, overload

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ._types import Counted, Failure, Location, Nearest, Profiled

__all__ = [
    "__version__",
    "MeshError",
    "PrecisionWarning",
    "Mesh",
    "Solver",
    "Field",
    "Point",
    "Curve",
    "Path",
    "Voronoi",
    "Cell",
    "Arc",
    "VoronoiVertex",
    "Certificate",
    "Isoline",
    "IsolineLine",
    "read",
    "generate",
    "vertex",
    "edge",
    "face",
    "at",
    "algorithms",
    "certify",
    "run_to_json",
]

__version__: str

_Point = Union[SupportsIndex, Point]
_Points = Union[
    _Point,
    Iterable[_Point],
    NDArray[Union[np.integer[Any], np.floating[Any], np.bool_]],
    tuple[ArrayLike, NDArray[np.floating[Any]]],
]
_Sources = Union[_Points, Curve, Iterable[Union[_Point, Curve]]]
_Levels = Union[Sequence[float], NDArray[np.floating[Any]]]
_Algorithm = Union[
    Literal[
        "mmp",
        "mmp-edge",
        "ch",
        "ich1",
        "ich",
        "pch",
        "fwp-mmp",
        "fwp-ch",
        "lc-mmp",
        "lc-ch",
        "vtp-mmp",
        "vtp-ch",
        "ftp",
        "opftp",
        "vtp",
        "opvtp",
        "vtp-exhaustive",
        "vtp-trimming",
        "vtp-no-rule1",
        "vtp-no-rules23",
        "edge-based",
        "window-vtp",
        "lct11",
        "xls14",
        "mmp-fast",
        "ich-fast",
        "vtp-fast",
        "pvtp",
        "dijkstra",
        "fmm",
        "fmm-untidy",
        "heat",
        "svg",
        "mmp-approx",
        "avtp",
        "vsp",
    ],
    str,
]
_Path = Union[str, os.PathLike[str]]
_Triple = tuple[float, float, float]

class MeshError(ValueError):
    defects: list[str]

class PrecisionWarning(UserWarning): ...

@final
class Point:
    def __eq__(self, other: object, /) -> bool: ...
    def __ne__(self, other: object, /) -> bool: ...
    def __hash__(self, /) -> int: ...
    def __copy__(self, /) -> Point: ...
    def __deepcopy__(self, _memo: Any, /) -> Point: ...

@final
class Curve:
    def __new__(cls, points: _Points, closed: bool = False) -> Curve: ...
    @property
    def points(self) -> list[Point]: ...
    @property
    def closed(self) -> bool: ...
    def __len__(self, /) -> int: ...
    def __eq__(self, other: object, /) -> bool: ...
    def __ne__(self, other: object, /) -> bool: ...
    __hash__: None  # type: ignore[assignment]

@final
class Mesh:
    def __new__(
        cls,
        vertices: Any,
        faces: ArrayLike | Sequence[Sequence[int]] | None = None,
        *,
        name: str = "mesh",
        weld: bool | float | None = None,
        repair: bool = True,
    ) -> Mesh: ...
    def __copy__(self, /) -> Mesh: ...
    def __deepcopy__(self, _memo: Any, /) -> Mesh: ...
    @staticmethod
    def from_lengths(
        n: int, faces: ArrayLike, lengths: ArrayLike, *, name: str = "mesh"
    ) -> Mesh: ...
    @property
    def vertices(self) -> NDArray[np.float64]: ...
    @property
    def faces(self) -> NDArray[np.int64]: ...
    @property
    def n_vertices(self) -> int: ...
    @property
    def n_faces(self) -> int: ...
    @property
    def name(self) -> str: ...
    @property
    def defects(self) -> list[str]: ...
    def wrong_distances(
        self, found: ArrayLike, reference: ArrayLike, *, tolerance: float = 1e-9
    ) -> NDArray[np.int64]: ...
    def info(self) -> dict[str, float]: ...
    def locate(self, points: _Points) -> Location: ...
    def nearest_vertices(self, positions: ArrayLike) -> NDArray[np.int64]: ...
    def nearest_vertex(self, x: float, y: float, z: float) -> int: ...
    def borders(self) -> list[Curve]: ...
    @overload
    def distance(
        self,
        source: _Sources,
        *,
        radius: float | None = None,
        targets: _Points | None = None,
        nearest: Literal[False] = False,
        algorithm: _Algorithm | None = None,
    ) -> NDArray[np.float64]: ...
    @overload
    def distance(
        self,
        source: _Points,
        *,
        radius: float | None = None,
        targets: _Points | None = None,
        nearest: Literal[True],
        algorithm: _Algorithm | None = None,
    ) -> Nearest: ...
    @overload
    def distances(
        self,
        sources: _Points,
        *,
        threads: int | None = None,
        radius: float | None = None,
        targets: _Points | None = None,
        sparse: Literal[False] = False,
        algorithm: _Algorithm | None = None,
    ) -> NDArray[np.float64]: ...
    @overload
    def distances(
        self,
        sources: _Points,
        *,
        threads: int | None = None,
        radius: float | None = None,
        targets: _Points | None = None,
        sparse: Literal[True],
        algorithm: _Algorithm | None = None,
    ) -> Any: ...
    def distance_matrix(
        self,
        points: _Points,
        *,
        threads: int | None = None,
        algorithm: _Algorithm | None = None,
    ) -> NDArray[np.float64]: ...
    def pairs(
        self,
        sources: _Points,
        targets: _Points,
        *,
        threads: int | None = None,
        algorithm: _Algorithm | None = None,
    ) -> NDArray[np.float64]: ...
    def field(self, source: _Points) -> Field: ...
    def path(
        self,
        source: _Points,
        target: _Point | None = None,
        *,
        closed: bool = False,
        shorten: bool = False,
        algorithm: _Algorithm | None = None,
    ) -> Path | None: ...
    def trace(self, point: _Point, direction: ArrayLike, length: float) -> Path: ...
    def paths(
        self, source: _Points, targets: _Points, *, algorithm: _Algorithm | None = None
    ) -> list[Path | None]: ...
    def log_map(
        self, source: _Point, *, algorithm: _Algorithm | None = None
    ) -> NDArray[np.float64]: ...
    def isolines(
        self,
        source: _Points,
        *,
        every: float | None = None,
        levels: _Levels | None = None,
    ) -> list[Isoline]: ...
    def voronoi(self, sources: _Points) -> Voronoi: ...
    def remesh(self, sites: int, *, lloyd: int = 5, rng: Any = None) -> Mesh: ...
    def write(self, path: _Path) -> None: ...

@final
class Solver:
    def __new__(
        cls,
        mesh: Mesh,
        algorithm: _Algorithm | None = None,
        *,
        threads: int | None = None,
        simd: Literal["auto", "scalar", "avx2", "avx512"] = "auto",
    ) -> Solver: ...
    @property
    def mesh(self) -> Mesh: ...
    @property
    def algorithm(self) -> str: ...
    @property
    def exact(self) -> bool: ...
    @overload
    def distance(
        self,
        source: _Sources,
        *,
        radius: float | None = None,
        targets: _Points | None = None,
        nearest: Literal[False] = False,
    ) -> NDArray[np.float64]: ...
    @overload
    def distance(
        self,
        source: _Points,
        *,
        radius: float | None = None,
        targets: _Points | None = None,
        nearest: Literal[True],
    ) -> Nearest: ...
    @overload
    def distances(
        self,
        sources: _Points,
        *,
        threads: int | None = None,
        radius: float | None = None,
        targets: _Points | None = None,
        sparse: Literal[False] = False,
    ) -> NDArray[np.float64]: ...
    @overload
    def distances(
        self,
        sources: _Points,
        *,
        threads: int | None = None,
        radius: float | None = None,
        targets: _Points | None = None,
        sparse: Literal[True],
    ) -> Any: ...
    def distance_matrix(
        self,
        points: _Points,
        *,
        threads: int | None = None,
    ) -> NDArray[np.float64]: ...
    def pairs(
        self,
        sources: _Points,
        targets: _Points,
        *,
        threads: int | None = None,
    ) -> NDArray[np.float64]: ...
    def field(self, source: _Points) -> Field: ...
    def path(
        self,
        source: _Points,
        target: _Point | None = None,
        *,
        closed: bool = False,
        shorten: bool = False,
    ) -> Path | None: ...
    def paths(self, source: _Points, targets: _Points) -> list[Path | None]: ...
    def log_map(self, source: _Point) -> NDArray[np.float64]: ...
    def count(self, source: _Points) -> Counted: ...
    def profile(self, source: _Points) -> Profiled: ...

@final
class Path:
    @property
    def length(self) -> float: ...
    @property
    def points(self) -> NDArray[np.float64]: ...
    @property
    def faces(self) -> NDArray[np.int64]: ...
    @property
    def barycentric(self) -> NDArray[np.float64]: ...
    @property
    def vertices(self) -> NDArray[np.int64]: ...
    @property
    def start_direction(self) -> NDArray[np.float64] | None: ...
    def __len__(self, /) -> int: ...
    def __iter__(self, /) -> Iterator[NDArray[np.float64]]: ...
    def __array__(self, dtype: Any = None, copy: bool | None = None) -> NDArray[Any]: ...
    def __copy__(self, /) -> Path: ...
    def __deepcopy__(self, _memo: Any, /) -> Path: ...

@final
class Field:
    @property
    def mesh(self) -> Mesh: ...
    @property
    def sources(self) -> list[Point]: ...
    @property
    def distances(self) -> NDArray[np.float64]: ...
    @overload
    def distance(self, points: _Point) -> np.float64: ...  # type: ignore[overload-overlap]
    @overload
    def distance(self, points: _Points) -> NDArray[np.float64]: ...
    def gradient(self, points: _Points) -> NDArray[np.float64]: ...
    def path(self, point: _Point) -> Path | None: ...
    def paths(self, points: _Points) -> list[Path | None]: ...
    def isolines(
        self, *, every: float | None = None, levels: _Levels | None = None
    ) -> list[Isoline]: ...
    def __copy__(self, /) -> Field: ...
    def __deepcopy__(self, _memo: Any, /) -> Field: ...

@final
class Isoline:
    def __len__(self, /) -> int: ...
    def __iter__(self, /) -> Iterator[IsolineLine]: ...
    @property
    def distance(self) -> float: ...
    @property
    def length(self) -> float: ...
    @property
    def gap(self) -> float: ...
    @property
    def lines(self) -> list[IsolineLine]: ...

@final
class IsolineLine:
    @property
    def closed(self) -> bool: ...
    @property
    def length(self) -> float: ...
    @property
    def faces(self) -> NDArray[np.int64]: ...
    def points(self, tolerance: float | None = None) -> NDArray[np.float64]: ...

@final
class Voronoi:
    @property
    def sources(self) -> list[int | Point]: ...
    @property
    def labels(self) -> NDArray[np.int64]: ...
    @property
    def distances(self) -> NDArray[np.float64]: ...
    @property
    def cells(self) -> list[Cell]: ...
    @property
    def arcs(self) -> list[Arc]: ...
    @property
    def vertices(self) -> list[VoronoiVertex]: ...
    def dual(self) -> Mesh: ...
    def __len__(self, /) -> int: ...
    def __iter__(self, /) -> Iterator[Cell]: ...
    def __copy__(self, /) -> Voronoi: ...
    def __deepcopy__(self, _memo: Any, /) -> Voronoi: ...

@final
class Cell:
    @property
    def source(self) -> int: ...
    @property
    def vertex(self) -> int | None: ...
    @property
    def area(self) -> float: ...
    @property
    def perimeter(self) -> float: ...
    @property
    def neighbours(self) -> list[int]: ...
    @property
    def is_disc(self) -> bool: ...
    @property
    def euler(self) -> int: ...

@final
class Arc:
    @property
    def face(self) -> int: ...
    @property
    def sources(self) -> tuple[int, int]: ...
    @property
    def nodes(self) -> tuple[int, int]: ...
    @property
    def kind(self) -> Literal["line", "hyperbola"]: ...
    @property
    def length(self) -> float: ...
    def points(self, parts: int = 8) -> NDArray[np.float64]: ...

@final
class VoronoiVertex:
    @property
    def position(self) -> _Triple | None: ...
    @property
    def face(self) -> int: ...
    @property
    def barycentric(self) -> _Triple: ...
    @property
    def sources(self) -> list[int]: ...
    @property
    def distance(self) -> float: ...

@final
class Certificate:
    @property
    def certified(self) -> bool: ...
    @property
    def absolute(self) -> float: ...
    @property
    def relative(self) -> float: ...
    @property
    def tolerance(self) -> float: ...
    @property
    def failures(self) -> list[Failure]: ...
    @property
    def distances(self) -> NDArray[np.float64]: ...
    def __bool__(self, /) -> bool: ...
    def __copy__(self, /) -> Certificate: ...
    def __deepcopy__(self, _memo: Any, /) -> Certificate: ...

def vertex(v: SupportsIndex) -> Point: ...
def edge(a: SupportsIndex, b: SupportsIndex, t: float) -> Point: ...
def face(f: SupportsIndex, u: float, v: float, w: float) -> Point: ...
def at(x: float, y: float, z: float, *, far: bool = False) -> Point: ...
def read(path: _Path, *, weld: bool | float | None = None) -> Mesh: ...
def generate(spec: str) -> Mesh: ...
def algorithms() -> list[dict[str, Any]]: ...
def certify(
    mesh: Mesh,
    source: _Points,
    distances: ArrayLike | None = None,
    *,
    tolerance: float = 1e-9,
    threads: int | None = None,
) -> Certificate: ...
def run_to_json(
    algorithms: str,
    models: Sequence[Any],
    sources: str,
    sources_together: bool,
    repeat: int | None,
    warmup: int,
    check: str | None,
    tolerance: float,
    threads: int,
    simd: str,
    command: Sequence[str],
) -> str: ...
