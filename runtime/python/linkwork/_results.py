"""Results of mechanisms: motions, pages and linear systems."""

import csv
import html
import importlib
import os
import webbrowser
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _native
from ._names import checked, index
from ._origin import locate

if TYPE_CHECKING:
    from ._mechanism import Mechanism


@dataclass(frozen=True)
class Page:
    """HTML page that shows a motion and opens offline. Notebooks display it inline."""

    #: Path of the file.
    path: Path

    def _repr_html_(self) -> str:
        text = html.escape(Path(self.path).read_text(encoding="utf-8"), quote=True)
        return f'<iframe srcdoc="{text}" width="100%" height="560" frameborder="0"></iframe>'

    def open(self) -> None:
        """Opens the page in the default browser."""
        webbrowser.open(Path(self.path).resolve().as_uri())


@dataclass(frozen=True, eq=False, repr=False)
class Run:
    """Motion: samples of time, configuration, velocity and inputs, with one row per sample."""

    mechanism: "Mechanism"
    #: Times, s.
    t: NDArray[Any]
    #: Configurations, one row per time.
    q: NDArray[Any]
    #: Velocities, one row per time.
    v: NDArray[Any]
    #: Inputs, one row per time.
    u: NDArray[Any]
    #: States of first order, one row per time.
    x: NDArray[Any]

    def __len__(self) -> int:
        return len(self.t)

    def __repr__(self) -> str:
        times = f", t = {self.t[0]:g} … {self.t[-1]:g} s" if len(self) else ""
        m = self.mechanism
        return f"Run({m.name}: {len(self)} samples{times}; t, q[{m.nq}], v[{m.nv}], u[{m.nu}])"

    def csv(self, path: str | os.PathLike[str]) -> None:
        """Writes the samples as comma-separated values with the columns t, q.…, v.…, u.…. The file can be
        shown with `linkwork view --motion`."""
        m = self.mechanism
        head = ["t"] + [f"q.{n}" for n in m.configuration]
        head += [f"v.{n}" for n in m.velocities] + [f"u.{n}" for n in m.inputs]
        with open(path, "w", newline="", encoding="utf-8") as file:
            writer = csv.writer(file)
            writer.writerow(head)
            writer.writerows(np.column_stack([self.t, self.q, self.v, self.u]).tolist())

    @checked
    def view(self, path: str | os.PathLike[str] | None = None, *, meshes: str | os.PathLike[str] | None = None) -> Page:
        """Writes an HTML page that shows the motion and opens offline, to `path` or by default to a file with
        the mechanism's name and the extension `.html`. The meshes of a robot file are read from the folder
        `meshes`, by default from that of the file."""
        m = self.mechanism
        path = Path(path if path is not None else f"{m.name}.html")
        source = locate(m._origin)
        if meshes is None and source["is_file"]:
            meshes = Path(source["source"]).parent
        times, q, u = self.t.tolist(), np.ascontiguousarray(self.q), np.ascontiguousarray(self.u)
        _native.write_page(m._robot, **source, meshes=meshes, times=times, q=q, u=u, path=path)
        return Page(path)

    @checked
    def plot(self, *names: str, ax: Any = None) -> Any:
        """Plots entries of the motion over time with matplotlib: the named ones (`"hinge"`, `"v.hinge"`,
        `"u.motor"`), by default all entries of the configuration. There is one plot per unit, one below the
        other; if `ax` is specified, all curves are drawn there.

        Returns:
            The axes, or an array of several axes.
        """
        m = self.mechanism
        kinds = {
            "q": ("coordinate", m.configuration, m.units.configuration),
            "v": ("velocity", m.velocities, m.units.velocities),
            "u": ("input", m.inputs, m.units.inputs),
        }
        groups: dict[str, list[tuple[str, str, NDArray[Any]]]] = {}
        for name in names or m.configuration:
            kind, rest = name.split(".", 1) if name[:2] in ("q.", "v.", "u.") else ("q", name)
            what, known, units = kinds[kind]
            k = index(known, rest, what)
            groups.setdefault(units[k], []).append((name, kind, getattr(self, kind)[:, k]))

        plt: Any = importlib.import_module("matplotlib.pyplot")

        if ax is None:
            rows = max(len(groups), 1)
            size = (6.4, 1.6 + 2.4 * rows)
            axes = plt.subplots(rows, sharex=True, squeeze=False, figsize=size, layout="constrained")[1][:, 0]
            axes[0].set_title(m.name)
        else:
            axes = np.array([ax])
        for k, (unit, curves) in enumerate(groups.items()):
            own = axes[min(k, len(axes) - 1)]
            shares = len(groups) > len(axes)
            for name, _, values in curves:
                own.plot(self.t, values, label=f"{name} [{unit}]" if shares and unit else name)
            said = " and ".join(dict.fromkeys(_MANY[kind] for _, kind, _ in curves))
            own.set_ylabel("" if shares else f"{said} [{unit}]" if unit else said)
        for own in axes:
            # A legend with many names is placed next to the curves.
            beside: dict[str, Any] = {"loc": "upper left", "bbox_to_anchor": (1.0, 1.0)} if len(own.get_lines()) > 6 else {}
            own.legend(**beside)
        axes[-1].set_xlabel("t [s]")
        return axes[0] if len(axes) == 1 else axes


_MANY = {"q": "coordinates", "v": "velocities", "u": "inputs"}


@dataclass(frozen=True, eq=False)
class LinearSystem:
    """Linear system x' = A x + B u about a state. The entries of x are displacements of the configuration,
    then changes of the velocity, each in the order of `v`."""

    a: NDArray[Any]
    b: NDArray[Any]
    #: Names of the states.
    states: list[str]
    #: Names of the inputs.
    inputs: list[str]

    @checked
    def control(self, c: ArrayLike | None = None, d: ArrayLike | None = None) -> Any:
        """Returns the system as a `StateSpace` of the package python-control, for functions such as `lqr`. By
        default, the outputs are all states."""
        control: Any = importlib.import_module("control")

        c = np.eye(len(self.a)) if c is None else c
        d = np.zeros((np.shape(c)[0], self.b.shape[1])) if d is None else d
        return control.ss(self.a, self.b, c, d)


@dataclass(frozen=True)
class Units:
    """Units of all entries, in the order of the entries."""

    configuration: list[str]
    velocities: list[str]
    inputs: list[str]
    parameters: list[str]
