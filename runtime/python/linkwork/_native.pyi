"""Types of the extension module."""

from collections.abc import Callable, Sequence
from os import PathLike
from typing import Any, final

from numpy.typing import NDArray

@final
class Robot:
    """A loaded mechanism with values of its parameters."""

    def describe(self) -> dict[str, Any]: ...
    @property
    def equations(self) -> str: ...
    def functions(self) -> list[Function]: ...
    def limits(self) -> list[tuple[int, float, float, float, float]]: ...
    @property
    def parameter_set_count(self) -> int | None: ...
    def parameters(self) -> NDArray[Any]: ...
    def with_parameters(self, sets: NDArray[Any], many: bool) -> Robot: ...
    def with_table(
        self, name: str, axes: list[list[float]], values: list[float], smooth: bool, extrapolated: bool
    ) -> Robot: ...
    def roll_out(
        self,
        q: NDArray[Any],
        v: NDArray[Any],
        inputs: NDArray[Any] | None,
        *,
        start: float,
        h: float,
        threads: int,
    ) -> None: ...

@final
class Function:
    """A function of a mechanism."""

    @property
    def name_and_documentation(self) -> tuple[str, str]: ...
    @property
    def arguments(self) -> list[tuple[str, list[int] | None]]: ...
    @property
    def results(self) -> list[tuple[str, list[int]]]: ...
    def __get__(self, instance: Any, owner: Any) -> Any: ...
    def __call__(self, *given: Any, **named: Any) -> Any: ...
    def evaluate(
        self,
        robot: Robot,
        frame: int,
        arguments: Sequence[NDArray[Any]],
        results: Sequence[NDArray[Any]],
        states: int,
        threads: int,
    ) -> None: ...

    def pull_back(
        self,
        robot: Robot,
        frame: int,
        arguments: Sequence[NDArray[Any]],
        factors: NDArray[Any],
        out: NDArray[Any],
        states: int,
        threads: int,
    ) -> None: ...

@final
class BoundFunction:
    """A function of a mechanism with values of its parameters."""

    def __call__(self, *given: Any, **named: Any) -> Any: ...

def load(
    source: str, *, is_file: bool, options: str, name: str | None, folder: str | None, equations: bool = False
) -> Robot: ...
def gallery_files() -> list[list[tuple[str, str]]]: ...
def write_page(
    robot: Robot,
    source: str,
    *,
    is_file: bool,
    options: str,
    name: str | None,
    folder: str | None,
    meshes: str | PathLike[str] | None,
    times: list[float],
    q: NDArray[Any],
    u: NDArray[Any],
    path: str | PathLike[str],
) -> None: ...
def simulate(
    robot: Robot,
    q: list[float],
    v: list[float],
    *,
    start: float,
    duration: float,
    every: float,
    method: str,
    setting: float,
    period: float | None,
    inputs: list[float],
    control: Callable[[float, NDArray[Any], NDArray[Any]], list[float]] | None,
) -> tuple[NDArray[Any], str | None, BaseException | None]: ...
def roll_back(
    robot: Robot,
    q: NDArray[Any],
    v: NDArray[Any],
    inputs: NDArray[Any],
    by_q: NDArray[Any],
    by_v: NDArray[Any],
    by_inputs: NDArray[Any],
    by_parameters: NDArray[Any],
    *,
    start: float,
    h: float,
    threads: int,
) -> None: ...
