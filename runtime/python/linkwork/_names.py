"""Names and numbers that are given, and what is said of others."""

import difflib
import functools
import inspect
import keyword

import numpy as np


class Error(Exception):
    """What Linkwork cannot do, in its words."""


class UnknownName(KeyError):
    """A name that there is not; the message has the nearest ones."""

    def __str__(self):
        return str(self.args[0])


def hint(name, names):
    """The nearest of some names, or all of them."""
    near = difflib.get_close_matches(str(name), names, n=3)
    return f": did you mean {', '.join(map(repr, near))}?" if near else f"; there are {', '.join(names) or 'none'}"


def index(names, name, what):
    """The index of a name in a list of names."""
    if name in names:
        return names.index(name)
    raise UnknownName(f"there is no {what} {name!r}{hint(name, names)}")


def checked(function):
    """Tells which argument is meant where a keyword is none."""
    parameters = inspect.signature(function).parameters.values()
    known = [p.name for p in parameters if p.kind in (p.KEYWORD_ONLY, p.POSITIONAL_OR_KEYWORD) and p.name != "self"]

    @functools.wraps(function)
    def called(*given, **named):
        for name in named:
            if name not in known:
                raise TypeError(f"{function.__name__}() has no argument {name!r}{hint(name, known)}")
        return function(*given, **named)

    return called


def number(value, what):
    """A single number."""
    try:
        if isinstance(value, (str, bytes)) or np.ndim(value) != 0:
            raise TypeError
        return float(value)
    except (TypeError, ValueError):
        raise TypeError(f"{what} is a number, found {value!r}") from None


def numbers(value, dtype, what):
    """An array of numbers, which nothing is lost of that cannot be seen."""
    if np.iscomplexobj(value):
        raise TypeError(f"{what} has complex numbers")
    if isinstance(value, np.ma.MaskedArray) and np.ma.is_masked(value):
        raise TypeError(f"{what} has masked entries")
    try:
        return np.asarray(value, dtype)
    except (TypeError, ValueError) as error:
        raise type(error)(f"{what} is an array of numbers, found {value!r:.100}") from None


def safe(name):
    """A name that is no keyword."""
    return f"{name}_" if keyword.iskeyword(name) else name
