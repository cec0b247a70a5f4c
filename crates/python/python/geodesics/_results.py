"""Results of benchmarks as rows and as frames of pandas."""

from __future__ import annotations

import json
import operator
import os
from collections.abc import Iterable, Mapping, Sequence
from typing import TYPE_CHECKING, Any, SupportsIndex, Union

from . import _core

if TYPE_CHECKING:
    import pandas

Row = dict[str, Any]
_Path = Union[str, "os.PathLike[str]"]
_Source = Union[str, SupportsIndex, _core.Point]

_SCHEMA = "geobench/1"

# Fields of a cell that hold lists: they are rows of the frame of samples.
_SAMPLES = ("time_samples", "time_places", "time_solves")


def _flat(record: Row, prefix: str = "") -> Row:
    """Flattens nested dictionaries. Their keys are joined by `_`, as in the CSV form."""
    row: Row = {}
    for name, value in record.items():
        if isinstance(value, dict):
            row.update(_flat(value, f"{prefix}{name}_"))
        else:
            row[prefix + name] = value
    return row


def _rows(result: Row) -> list[Row]:
    """One row per cell, with the columns of its model.

    A column of the model that the cell has too gets the prefix `model_`.
    """
    models = {model["name"]: model for model in result["models"]}
    rows: list[Row] = []
    for cell in result["cells"]:
        row = _flat(cell)
        for name, value in models.get(cell["model"], {}).items():
            if name != "name":
                row[f"model_{name}" if name in ("path", "sha256") or name in row else name] = value
        rows.append(row)
    return rows


def _sample_rows(result: Row) -> list[Row]:
    """One row per sample."""
    rows: list[Row] = []
    for cell in _rows(result):
        places, solves = cell.get("time_places") or [], cell.get("time_solves") or []
        for number, seconds in enumerate(cell.get("time_samples") or []):
            rows.append(
                {
                    "model": cell["model"],
                    "algorithm": cell["algorithm"],
                    "source": cell["source"],
                    "threads": cell["threads"],
                    "group": cell.get("group"),
                    "sample": number,
                    "place": places[number] if number < len(places) else None,
                    "solves": solves[number] if number < len(solves) else 1,
                    "seconds": seconds,
                    "vertices": cell.get("vertices"),
                    "faces": cell.get("faces"),
                }
            )
    return rows


def _frame(rows: list[Row]) -> pandas.DataFrame:
    try:
        import pandas
    except ImportError as error:
        raise ImportError("pandas is needed for frames: pip install pandas") from error
    frame: pandas.DataFrame = pandas.DataFrame(rows)
    return frame


class Table(Sequence[Row]):
    """The cells of a benchmark, as a sequence of rows. Each row is a dictionary.

    The keys are the columns of the CSV form: ``model``, ``algorithm``, ``source``, ``status``,
    ``time_median`` (seconds), ``counters_propagated``, ``memory_heap_peak_bytes`` and so on, and
    those of the model: ``vertices``, ``faces``, ``genus``, ... A value that an algorithm does not
    have is ``None``.

    Attributes
    ----------
    result : dict
        The whole result file, with the machine and the models.

    Examples
    --------
    >>> import geodesics as gd
    >>> table = gd.run("vtp,dijkstra", ["gen:cube,n=2"], repeat=1)
    >>> [(row["algorithm"], row["status"]) for row in table]
    [('vtp', 'ok'), ('dijkstra', 'ok')]
    """

    result: Row

    def __init__(self, result: Row) -> None:
        self.result = result
        self._rows = _rows(result)

    def __len__(self) -> int:
        return len(self._rows)

    def __getitem__(self, place: Any) -> Any:
        return self._rows[place]

    def __repr__(self) -> str:
        lines = [f"<geodesics.Table of {len(self)} cells>"]
        for row in self._rows:
            median = row.get("time_median")
            time = f"{median:.4g} s" if median is not None else row["message"] or ""
            lines.append(f"  {row['model']}  {row['algorithm']}  {row['status']}  {time}")
        return "\n".join(lines)

    def to_pandas(self, samples: bool = False) -> pandas.DataFrame:
        """A frame with one row per cell, or one row per sample.

        Parameters
        ----------
        samples : bool
            Whether to return one row per timed run: ``sample``, ``seconds``, ``place`` in the
            order of runs, and the number of ``solves`` whose mean time ``seconds`` is.

        Returns
        -------
        pandas.DataFrame

        Examples
        --------
        >>> import geodesics as gd
        >>> table = gd.run("vtp", ["gen:cube,n=2"], repeat=3)
        >>> len(table.to_pandas()), len(table.to_pandas(samples=True))
        (1, 3)
        """
        if samples:
            return _frame(_sample_rows(self.result))
        rows = [{k: v for k, v in row.items() if k not in _SAMPLES} for row in self._rows]
        return _frame(rows)

    def write(self, path: _Path) -> None:
        """Writes the result file (JSON), which ``geobench report`` and ``compare`` read.

        Examples
        --------
        >>> import geodesics as gd
        >>> import tempfile, pathlib
        >>> with tempfile.TemporaryDirectory() as folder:
        ...     path = pathlib.Path(folder, "result.json")
        ...     gd.run("vtp", ["gen:cube,n=2"], repeat=1).write(path)
        ...     len(gd.read_results(path))
        1
        """
        with open(path, "w", encoding="utf-8") as file:
            json.dump(self.result, file)
            file.write("\n")


def _refuse_mapping(value: Any, name: str) -> None:
    """Refuses what yields keys or bytes."""
    if isinstance(value, (Mapping, bytes, bytearray, memoryview)):
        raise TypeError(f"{name}: {value!r} is no list")


def _words(value: Any, name: str) -> str:
    """Joins names by commas. A string is returned as it is."""
    if isinstance(value, str):
        return value
    _refuse_mapping(value, name)
    try:
        words = list(value)
    except TypeError:
        words = [value]
    for word in words:
        if not isinstance(word, str):
            raise TypeError(f"{name}: {word!r} is not a name")
    if not words:
        raise ValueError(f"{name}: none is given")
    return ",".join(words)


def _sources(value: Any) -> str:
    """The sources as text of the command line, such as ``"0,edge:4-9,0.25"``."""
    if isinstance(value, str):
        return value
    _refuse_mapping(value, "sources")
    if isinstance(value, (_core.Point, bool)):
        value = [value]
    else:
        try:
            value = [operator.index(value)]
        except TypeError:  # Several; arrays have `__index__`, too.
            pass
    words = []
    for source in value:
        if isinstance(source, (_core.Point, str)):
            words.append(str(source))
        elif hasattr(source, "__index__") and not isinstance(source, bool):
            words.append(str(source.__index__()))
        else:
            raise TypeError(f"sources: {source!r} is no point")
    if not words:
        raise ValueError("sources: none is given")
    return ",".join(words)


def run(
    algorithms: str | Iterable[str],
    models: _core.Mesh | _Path | Iterable[_core.Mesh | _Path],
    *,
    sources: _Source | Iterable[_Source] = "largest",
    sources_together: bool = False,
    repeat: int | None = None,
    warmup: int = 1,
    check: str | None = None,
    tolerance: float = 1e-9,
    threads: int = 1,
    simd: str = "auto",
) -> Table:
    """Measures algorithms on models, in this process, and checks every answer.

    The algorithms run in turns, with warm-ups, as with the command ``geobench run``. One more run
    counts events, and one measures memory and phases. Limits of time and memory need a process per
    cell, which only the command has. Ctrl-C ends a benchmark.

    Parameters
    ----------
    algorithms : str or sequence of str
        Names, families, ``"exact"`` or ``"all"``, as of ``--algo``.
    models : Mesh, path or str, or a sequence of these
        Meshes, files, directories or ``"gen:torus,faces=5000"``.
    sources : int, Point, str or a sequence of these
        Each source is a cell of its own. ``"random:5"`` draws five vertices. The default is the
        first vertex of the component with the most vertices.
    sources_together : bool
        Whether each run starts from all sources together.
    repeat : int, optional
        Timed runs of a cell. By default, runs are repeated until the median is known to 3 %.
    warmup : int
        Untimed runs before the timed ones.
    check : str, optional
        The algorithm whose answers the others must match, or ``"none"``. The default is
        ``mmp-fast`` if it is among the algorithms, else the first exact one.
    tolerance : float
        Largest relative difference that passes.
    threads : int
        Threads of parallel algorithms.
    simd : {"auto", "scalar", "avx2", "avx512"}
        Vector instructions of all algorithms. ``"auto"``: scalar for the algorithms of papers, the
        widest of the processor for the fast forms.

    Returns
    -------
    Table
        One row per cell. A wrong answer is a row of status ``"wrong"`` and never a time.

    Examples
    --------
    >>> import geodesics as gd
    >>> table = gd.run(["mmp", "vtp"], "gen:grid,n=4", sources=0, repeat=1)
    >>> [(row["algorithm"], row["status"]) for row in table]
    [('mmp', 'ok'), ('vtp', 'ok')]
    """
    if isinstance(models, (str, os.PathLike, _core.Mesh)):
        models = [models]
    _refuse_mapping(models, "models")
    models = [os.fspath(model) if isinstance(model, os.PathLike) else model for model in models]
    algorithms, sources = _words(algorithms, "algorithms"), _sources(sources)
    command = ["geodesics.run", f"algorithms={algorithms}", f"sources={sources}"]
    if repeat is not None:
        command.append(f"repeat={repeat}")
    text = _core.run_to_json(
        algorithms,
        models,
        sources,
        sources_together,
        repeat,
        warmup,
        check,
        tolerance,
        threads,
        simd,
        command,
    )
    return Table(json.loads(text))


def read_results(path: _Path, samples: bool = False) -> pandas.DataFrame:
    """Reads a result file that ``geobench run -o FILE.json`` or `Table.write` wrote.

    Parameters
    ----------
    path : path
    samples : bool
        Whether to return one row per timed run instead of one per cell.

    Returns
    -------
    pandas.DataFrame
        One row per cell, with the columns of the CSV form and those of its model, or one row per
        sample. Times are in seconds, memory in bytes.

    Examples
    --------
    >>> import geodesics as gd
    >>> import tempfile, pathlib
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     path = pathlib.Path(folder, "result.json")
    ...     gd.run("mmp", "gen:grid,n=4", sources=0, repeat=1).write(path)
    ...     list(gd.read_results(path)["algorithm"])
    ['mmp']
    """
    with open(path, encoding="utf-8") as file:
        try:
            result = json.load(file)
        except ValueError as error:
            raise ValueError(f"{path}: not a result file: {error}") from error
    schema = result.get("schema") if isinstance(result, dict) else None
    if schema != _SCHEMA:
        raise ValueError(f"{path}: not a result file of `{_SCHEMA}`: its schema is {schema!r}")
    return Table(result).to_pandas(samples)
