"""Loads declarations and robot files."""

import difflib
import functools
import os
import re
from collections.abc import Callable
from pathlib import Path
from typing import Any, overload

import numpy as np
from numpy.typing import NDArray

from . import _native
from ._mechanism import Compiled, kind
from ._names import Error, UnknownName, checked, hint
from ._origin import locate


@checked
def compile(
    source: str | os.PathLike[str],
    *,
    options: str = "",
    name: str | None = None,
    tables: dict[str, Any] | None = None,
    derivatives: bool = True,
) -> type[Compiled]:
    """Returns the class of a mechanism, in milliseconds. The machine code of a function is generated when it is
    first called.

    Args:
        source: the path of a robot file (URDF, MJCF, SDF), the path of a Rust file that contains a struct
            with the attribute ``#[mechanism]``, or the text of such a struct.
        options: further arguments of the attribute, as in ``"base = free, inertia = trust"``.
        name: the name of the struct, for a text or Rust file with several.
        tables: the values of the tables, by the name of the field. A table is the path of a file with
            comma-separated values (one line per grid point: the variables, then the value), or a tuple
            ``(axes, values)`` of the grid points along each axis and an array of this shape. The options
            ``"smooth"`` and ``"extrapolated"`` may follow: ``(axes, values, "smooth")``,
            ``(path, "smooth")``.
        derivatives: whether to derive derivatives of the dynamics, linear systems, and steps with Jacobians;
            this takes longer.

    Returns:
        A subclass of :class:`Mechanism`; its instances are mechanisms with values of the parameters.

    Raises:
        Error: the mechanism has errors, all of which the message lists with their positions; or the text is
            not a declaration.
        FileNotFoundError: the file does not exist.
    """
    text, path = _source(source)
    words = _words(path, text, options, derivatives)
    written = {key: _table(key, table) for key, table in (tables or {}).items()}
    return load({"text": text, "path": path, "options": words, "name": name, "gallery": False, "tables": written})


def load(origin: dict[str, Any]) -> type[Compiled]:
    """Returns the class of a source."""
    try:
        robot = _native.load(**locate(origin))
    except UnknownName as error:
        raise UnknownName(_translate(str(error))) from None
    except Error as error:
        raise Error(_translate(str(error))) from None
    known = dict(robot.describe()["tables"])
    for key, (axes, values, smooth, extrapolated) in origin["tables"].items():
        if key not in known:
            raise UnknownName(f"there is no table {key!r}{hint(key, list(known))}")
        if len(axes) != known[key]:
            raise ValueError(f"table {key!r}: expected {known[key]} axes, found {len(axes)}")
        robot = robot.with_table(key, axes, values, smooth, extrapolated)
    missing = [key for key in known if key not in origin["tables"]]
    if missing:
        raise Error(f"tables without values: tables={{{', '.join(f'{key!r}: …' for key in missing)}}}")
    return kind(robot, origin)


def restore(origin: dict[str, Any]) -> type[Compiled]:
    """Returns the class of a source that another process has loaded."""
    path = origin["path"]
    stamp = None
    if path is not None:
        status = os.stat(path)
        stamp = (status.st_mtime_ns, status.st_size)
    key = (repr(origin), stamp)
    if key not in _RESTORED:
        if len(_RESTORED) >= 256:
            _RESTORED.clear()
        _RESTORED[key] = load(origin)
    return _RESTORED[key]


#: Classes that were restored, by their sources and the states of their files.
_RESTORED: dict[Any, type[Compiled]] = {}


@overload
def gallery(name: None = None) -> list[str]: ...
@overload
def gallery(name: str, **settings: Any) -> type[Compiled]: ...
def gallery(name: str | None = None, **settings: Any) -> list[str] | type[Compiled]:
    """Returns the names of the mechanisms in Linkwork's gallery, or the class of one of them, loaded as by
    :func:`compile`.

    >>> "CartPole" in linkwork.gallery()
    True
    """
    found = _gallery()
    if name is None:
        if settings:
            raise TypeError(f"{', '.join(settings)}: settings are of one mechanism, which is named first")
        return sorted(found)
    if name not in found:
        near = difflib.get_close_matches(str(name), found, n=3)
        meant = f": did you mean {', '.join(near)}?" if near else ""
        raise UnknownName(f"the gallery has no mechanism {name!r}{meant}")
    return _of_gallery(found[name], name, **settings)


@checked
def _of_gallery(
    text: str,
    name: str,
    *,
    options: str = "",
    tables: dict[str, Any] | None = None,
    derivatives: bool = True,
) -> type[Compiled]:
    words = _words(None, text, options, derivatives)
    written = {key: _table(key, table) for key, table in (tables or {}).items()}
    return load({"text": text, "path": None, "options": words, "name": name, "gallery": True, "tables": written})


@functools.cache
def _gallery() -> dict[str, str]:
    """Returns the text that declares each mechanism of the gallery."""
    pattern = re.compile(r"^#\[mechanism\b.*?^pub struct (\w+)", flags=re.DOTALL | re.MULTILINE)
    return {one[1]: text for _, text in _native.gallery_files()[0] for one in pattern.finditer(text)}


def _table(name: str, given: Any) -> tuple[list[list[float]], list[float], bool, bool]:
    """Returns axes and values of a table, and its options."""
    parts = list(given) if isinstance(given, (tuple, list)) else [given]
    words: list[str] = []
    while parts and isinstance(parts[-1], str) and parts[-1] in ("smooth", "extrapolated"):
        words.insert(0, parts.pop())
    if len(parts) == 1 and isinstance(parts[0], (str, os.PathLike)):
        axes, values = _table_file(name, Path(parts[0]).expanduser())
    elif len(parts) == 2:
        axes = [np.asarray(axis, dtype=float) for axis in parts[0]]
        values = np.asarray(parts[1], dtype=float)
    else:
        raise TypeError(f"table {name!r}: expected a path or (axes, values), found {given!r}")
    shape = tuple(axis.size for axis in axes)
    if any(axis.ndim != 1 for axis in axes) or values.shape != shape:
        raise ValueError(f"table {name!r}: the axes have {shape} points, but the values the shape {values.shape}")
    return [axis.tolist() for axis in axes], values.ravel().tolist(), "smooth" in words, "extrapolated" in words


def _table_file(name: str, path: Path) -> tuple[list[NDArray[Any]], NDArray[Any]]:
    """Returns axes and values of a file with one grid point per line."""
    if not path.is_file():
        raise FileNotFoundError(f"table {name!r}: there is no file {path}")
    rows: list[list[float]] = []
    for number, line in enumerate(path.read_text(encoding="utf-8").splitlines(), 1):
        if not line.strip():
            continue
        try:
            rows.append([float(field) for field in line.split(",")])
        except ValueError:
            # The first line may contain names.
            if number > 1:
                raise ValueError(f"table {name!r}: {path}, line {number}: expected numbers, found {line!r}") from None
    if not rows or any(len(row) != len(rows[0]) or len(row) < 2 for row in rows):
        raise ValueError(f"table {name!r}: {path}: each line has the variables of a grid point, and its value")
    points = np.array(rows)
    axes = [np.unique(column) for column in points.T[:-1]]
    values = np.full([axis.size for axis in axes], np.nan)
    places = tuple(np.searchsorted(axis, column) for axis, column in zip(axes, points.T))
    values[places] = points[:, -1]
    if len(points) != values.size or np.isnan(values).any():
        raise ValueError(f"table {name!r}: {path}: {len(points)} grid points for a grid of {values.size}, each once")
    return axes, values


def _source(source: Any) -> tuple[str, None] | tuple[None, str]:
    """Returns the text of a declaration, or the path of a file."""
    if isinstance(source, os.PathLike):
        path = Path(source)
    elif not isinstance(source, str):
        raise TypeError(f"expected a path or a declaration, found {type(source).__name__}")
    elif "#[" in source or "\n" in source or not source.strip():
        if "struct" not in source or "mechanism" not in source:
            found = "" if source.strip() else ", found an empty text"
            raise Error(f"expected a path, or a declaration: a struct with the attribute `#[mechanism(…)]`{found}")
        return source, None
    else:
        path = Path(source).expanduser()
    if path.is_dir():
        raise FileNotFoundError(f"expected a file, but {path} is a folder")
    if not path.is_file():
        raise FileNotFoundError(f"there is no file {path}{_meant(path)}")
    return None, str(path.resolve())


def _meant(path: Path) -> str:
    """Returns a suggestion for a path that does not exist."""
    if re.fullmatch(r"\w+", str(path)) and str(path) in gallery():
        return f"; `linkwork.gallery({str(path)!r})` is the one of the gallery"
    beside = [file.name for file in path.parent.iterdir() if file.is_file()] if path.parent.is_dir() else []
    near = difflib.get_close_matches(path.name, beside, n=3)
    return f": did you mean {', '.join(near)}?" if near else ""


def _words(path: str | None, text: str | None, options: str, derivatives: bool) -> str:
    """Returns the options to add to those of the declaration."""
    if not isinstance(options, str):
        raise TypeError(f"`options` is a text with arguments of the attribute, found {options!r}")
    if path is not None and path.endswith(".rs"):
        text = Path(path).read_text(encoding="utf-8")
    written = " ".join(re.findall(r"#\[(?:\w+::)*mechanism\((.*?)\)\]", text or "", flags=re.DOTALL))
    given = options.strip().strip(",")
    has: Callable[[str], bool] = lambda word: re.search(rf"\b{word}\b", f"{written} {given}") is not None
    words = [given] if given else []
    words += ["derivatives"] if derivatives and not has("inertia\\s*=\\s*none") and not has("derivatives") else []
    return ", ".join(words)


def _translate(message: str) -> str:
    """Replaces options of the attribute in error messages by arguments of Python."""
    message = re.sub(r"`#\[mechanism\((?:…|(?:urdf|mjcf|sdf) = \"[^\"]*\"), ([^`]*)\)\]`", r"`options='\1'`", message)
    message = re.sub(r"^options `", "`options=`: `", message)
    return message.replace("by its name", "with `name=`")
