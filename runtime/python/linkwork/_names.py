"""Checks of names and numbers, with their errors."""

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
    """Error of Linkwork: in a declaration, in a file, or in a call that has no result."""

    #: Samples before the error, for a simulation.
    run: Any = None
    #: Configurations and velocities before the error, for a rollout.
    q: Any = None
    v: Any = None


class UnknownName(KeyError):
    """Unknown name; the message contains the nearest existing names."""

    def __str__(self) -> str:
        return str(self.args[0])


def hint(name: object, names: Sequence[str]) -> str:
    """Returns a hint for an unknown name: the nearest of the existing names, or all of them."""
    near = difflib.get_close_matches(str(name), names, n=3)
    return f": did you mean {', '.join(map(repr, near))}?" if near else f"; there are {', '.join(names) or 'none'}"


def index(names: Sequence[str], name: str, what: str) -> int:
    """Returns the index of a name in a list of names."""
    if name in names:
        return names.index(name)
    raise UnknownName(f"there is no {what} {name!r}{hint(name, names)}")


def checked(function: Callable[P, R]) -> Callable[P, R]:
    """Wraps a function so that an unknown keyword argument is reported with the nearest existing one."""
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
    """Converts a value to a single number."""
    try:
        if isinstance(value, (str, bytes)) or np.ndim(value) != 0:
            raise TypeError
        return float(value)
    except (TypeError, ValueError):
        raise TypeError(f"{what} is a number, found {value!r}") from None


def count(value: Any, what: str) -> int:
    """Converts a value to a nonnegative integer."""
    try:
        found = operator.index(value)
    except TypeError:
        raise TypeError(f"`{what}` is a whole number, found {value!r}") from None
    if not 0 <= found < 2**48:
        raise ValueError(f"`{what}` is a whole number that is not negative, found {value!r}")
    return found


def numbers(value: Any, dtype: Any, what: str) -> NDArray[Any]:
    """Converts a value to an array of numbers. Conversions that would lose data silently are errors."""
    if np.iscomplexobj(value):
        raise TypeError(f"{what} has complex numbers")
    if isinstance(value, np.ma.MaskedArray) and np.ma.is_masked(value):
        raise TypeError(f"{what} has masked entries")
    try:
        array = np.asarray(value)
        # NumPy would convert strings and dates.
        if array.dtype.kind not in "biufO":
            raise ValueError
        array = np.asarray(array, dtype)
        return array if array.flags.aligned else array.copy()
    except (TypeError, ValueError) as error:
        raise type(error)(f"{what} is an array of numbers, found {value!r:.100}") from None


def safe(name: str) -> str:
    """Returns a name, with an underscore appended if it is a keyword of Python."""
    return f"{name}_" if keyword.iskeyword(name) else name
