"""Checks of names and numbers, and their errors."""

import difflib
import functools
import inspect
import keyword
import operator
from collections.abc import Callable, Sequence
from typing import Any, ParamSpec, TypeVar

import numpy as np
from numpy.typing import NDArray

P = ParamSpec("P")
R = TypeVar("R")


class Error(Exception):
    """An error of Linkwork: of a declaration, a file, or a call without a result."""

    #: The complaints and the exit status of the command that reported it.
    complaints: str | None = None
    status = 1
    #: The samples before the error, of a simulation.
    run: Any = None
    #: Configurations and velocities before the error, of rollouts.
    q: Any = None
    v: Any = None


class UnknownName(KeyError):
    """An unknown name; the message has the nearest names."""

    def __str__(self) -> str:
        return str(self.args[0])


def hint(name: object, names: Sequence[str]) -> str:
    """Returns the nearest of some names, or all of them."""
    near = difflib.get_close_matches(str(name), names, n=3)
    return f": did you mean {', '.join(map(repr, near))}?" if near else f"; there are {', '.join(names) or 'none'}"


def index(names: Sequence[str], name: str, what: str) -> int:
    """Returns the index of a name in a list of names."""
    if name in names:
        return names.index(name)
    raise UnknownName(f"there is no {what} {name!r}{hint(name, names)}")


def checked(function: Callable[P, R]) -> Callable[P, R]:
    """Reports unknown keywords with the nearest argument."""
    parameters = inspect.signature(function).parameters.values()
    known = [p.name for p in parameters if p.kind in (p.KEYWORD_ONLY, p.POSITIONAL_OR_KEYWORD) and p.name != "self"]

    @functools.wraps(function)
    def called(*given: P.args, **named: P.kwargs) -> R:
        for name in named:
            if name not in known:
                raise TypeError(f"{function.__name__}() has no argument {name!r}{hint(name, known)}")
        return function(*given, **named)

    return called


def number(value: Any, what: str) -> float:
    """Returns a single number."""
    try:
        if isinstance(value, (str, bytes)) or np.ndim(value) != 0:
            raise TypeError
        return float(value)
    except (TypeError, ValueError):
        raise TypeError(f"{what} is a number, found {value!r}") from None


def count(value: Any, what: str) -> int:
    """Returns a whole number that is not negative."""
    try:
        found = operator.index(value)
    except TypeError:
        raise TypeError(f"`{what}` is a whole number, found {value!r}") from None
    if not 0 <= found < 2**48:
        raise ValueError(f"`{what}` is a whole number that is not negative, found {value!r}")
    return found


def numbers(value: Any, dtype: Any, what: str) -> NDArray[Any]:
    """Returns an array of numbers. Rejects conversions that lose data silently."""
    if np.iscomplexobj(value):
        raise TypeError(f"{what} has complex numbers")
    if isinstance(value, np.ma.MaskedArray) and np.ma.is_masked(value):
        raise TypeError(f"{what} has masked entries")
    try:
        array = np.asarray(value)
        # NumPy would convert texts and dates.
        if array.dtype.kind not in "biufO":
            raise ValueError
        return np.asarray(array, dtype)
    except (TypeError, ValueError) as error:
        raise type(error)(f"{what} is an array of numbers, found {value!r:.100}") from None


def safe(name: str) -> str:
    """Returns the name, with an underscore if it is a keyword."""
    return f"{name}_" if keyword.iskeyword(name) else name
