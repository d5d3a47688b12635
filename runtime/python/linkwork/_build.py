"""Compiles declarations and robot files to libraries, which are stored in the cache."""

import contextlib
import difflib
import errno
import functools
import hashlib
import json
import os
import re
import secrets
import shutil
import subprocess
import sys
import tempfile
import threading
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any, overload

import numpy as np

from ._cache import ToolchainError, build_once, cache_folder, write
from ._functions import digest, is_intact
from ._mechanism import Compiled, load
from ._names import Error, UnknownName, checked
from ._results import Run

_HERE = Path(__file__).resolve().parent


#: Crates of the command that are compiled without optimisation, which would take minutes. Without it, the
#: command derives the equations of an arm in a second, and those of a humanoid in four seconds.
_UNOPTIMISED = (
    "clap clap_builder clap_complete linkwork-cli linkwork-compiler linkwork-view prettyplease proc-macro2 quote roxmltree serde_json syn"
).split()
#: Flags that omit the attribute from the crate `linkwork`, which avoids a second build of the compiler.
_EXPANDED = "--cfg linkwork_expanded"


def toolchain() -> str:
    """Returns the version of the Rust compiler that is used, as the compiler prints it.

    Raises:
        ToolchainError: no Rust compiler is installed; the message contains instructions.
    """
    cargo = _cargo()
    rustc = os.environ.get("RUSTC") or shutil.which("rustc") or str(cargo.with_name("rustc"))
    return _version(rustc)


@functools.cache
def _version(rustc: str) -> str:
    return _run([rustc, "-vV"], "cannot run rustc").strip()


@checked
def compile(
    source: str | os.PathLike[str],
    *,
    options: str = "",
    name: str | None = None,
    tables: dict[str, Any] | None = None,
    native: bool = True,
    batch: bool = True,
    derivatives: bool = True,
    quiet: bool = False,
) -> type[Compiled]:
    """Compiles a mechanism to a class.

    The first call builds Linkwork's command, which takes about 80 s of processor time; the environment
    variable ``LINKWORK_COMMAND`` may contain the path of an existing command of the same version. A mechanism
    takes between some seconds and half a minute, and is loaded from the cache if it is compiled again. Any
    number of processes can compile at the same time: one builds, and the others wait for the library.

    Args:
        source: the path of a robot file (URDF, MJCF, SDF), the path of a Rust file that contains a struct
            with the attribute ``#[mechanism]``, or the text of such a struct.
        options: further arguments of the attribute, as in ``"base = free, inertia = trust"``.
        name: the name of the struct, for a Rust file with several.
        tables: the values of the tables, by the name of the field. A table is the path of a file with
            comma-separated values (one line per grid point: the variables, then the value), or a tuple
            ``(axes, values)`` of the grid points along each axis and an array of this shape. The options
            ``"smooth"`` and ``"extrapolated"`` may follow: ``(axes, values, "smooth")``,
            ``(path, "smooth")``. The values become constants of the library.
        native: whether to compile for the processor of this machine instead of all processors of its kind.
        batch: whether to compile functions that evaluate eight states at once, for arrays of states; this
            takes longer.
        derivatives: whether to compile derivatives of the dynamics, linear systems, and steps with Jacobians;
            this takes longer.
        quiet: whether to omit progress messages.

    Returns:
        A subclass of :class:`Mechanism`; its instances are mechanisms with values of the parameters.

    Raises:
        ToolchainError: the Rust toolchain is missing, or the build fails.
        Error: the mechanism has errors, all of which the message lists with their locations; or the text is
            not a declaration.
        FileNotFoundError: the file does not exist.
    """
    text, path = _source(source)
    written = {key: _table(key, table) for key, table in (tables or {}).items()}
    words = _words(path, text, options, batch, derivatives)
    origin: dict[str, Any] = {"text": text, "path": path and str(path), "options": words, "name": name, "tables": written}
    request = hashlib.sha256(json.dumps([origin, native]).encode() + _environment(native)).hexdigest()[:32]
    record = cache_folder() / "requests" / f"{request}.json"
    library = _find_recorded(record)
    if library is None:
        library, files = _compile_source(origin, native, quiet)
        if files is not None:
            with contextlib.suppress(OSError):
                record.parent.mkdir(exist_ok=True)
                write(record, json.dumps({"library": library.name, "files": files}).encode())
    _keep_origin(library, origin)
    kind = load(library)
    kind._source = origin
    return kind


def _compile_source(origin: dict[str, Any], native: bool, quiet: bool) -> tuple[Path, dict[str, str] | None]:
    """Returns the compiled library of a source, and digests of the source files, or `None` if one of them
    cannot be read."""
    command, path = _command(quiet), origin["path"]
    with tempfile.TemporaryDirectory(prefix="linkwork-") as folder:
        if path is None:
            path = Path(folder) / "mechanism.rs"
            path.write_text(origin["text"], encoding="utf-8")
        arguments = [command, "export", "library", path, "--out", Path(folder) / "crate"]
        arguments += ["--expanded", "--prefix", "mechanism", "--linkwork", _sources()]
        if origin["options"]:
            arguments.append(f"--with={origin['options']}")
        if origin["name"] is not None:
            arguments.append(f"--struct={origin['name']}")
        arguments += _table_arguments(origin["tables"], folder)
        _run(arguments, None)
        crate = Path(folder) / "crate"
        files = _digests(crate / "src" / "lib.rs", origin["path"])
        return _build_library(crate, native, quiet), files


def _digests(code: Path, path: str | None) -> dict[str, str] | None:
    """Returns digests of the files that the code of a mechanism includes; `None` if one cannot be read."""
    included = re.findall(r'include_bytes\s*!\s*\(\s*("(?:[^"\\]|\\.)*")', code.read_text(encoding="utf-8"))
    try:
        files = [json.loads(literal) for literal in included] + ([path] if path else [])
        return {file: digest(Path(file).read_bytes()) for file in files}
    except (OSError, ValueError):
        return None


def _find_recorded(record: Path) -> Path | None:
    """Returns the library of an earlier call, unless a file of the mechanism has changed since."""
    try:
        found = json.loads(record.read_bytes())
        if any(digest(Path(file).read_bytes()) != before for file, before in found["files"].items()):
            return None
        library: Path = record.parents[1] / "libraries" / found["library"]
        return library if is_intact(library) else None
    except (OSError, ValueError, TypeError, KeyError, AttributeError):
        return None


def _environment(native: bool) -> bytes:
    """Returns data of the sources, toolchain, flags and processor, on which libraries also depend."""
    about = f"{toolchain()}\n{_flags(native)}\n{os.environ.get('LINKWORK_COMMAND', '')}\n"
    return about.encode() + _fingerprint() + (_processor() if native else b"")


@overload
def gallery(name: None = None) -> list[str]: ...
@overload
def gallery(name: str, **settings: Any) -> type[Compiled]: ...
def gallery(name: str | None = None, **settings: Any) -> list[str] | type[Compiled]:
    """Returns the names of the mechanisms in Linkwork's gallery, or the class of one of them, compiled as by
    :func:`compile`.

    >>> "CartPole" in linkwork.gallery()
    True
    """
    found = {}
    for path in sorted((_sources() / "models" / "src").rglob("*.rs")):
        text = path.read_text(encoding="utf-8")
        for one in re.finditer(r"^#\[mechanism\b.*?^pub struct (\w+)", text, flags=re.DOTALL | re.MULTILINE):
            found[one[1]] = path
    if name is None:
        if settings:
            raise TypeError(f"{', '.join(settings)}: settings are of one mechanism, which is named first")
        return sorted(found)
    if name not in found:
        near = difflib.get_close_matches(str(name), found, n=3)
        meant = f": did you mean {', '.join(near)}?" if near else ""
        raise UnknownName(f"the gallery has no mechanism {name!r}{meant}")
    return compile(found[name], name=name, **settings)


def view(origin: dict[str, Any], run: Run, path: Path) -> None:
    """Writes a page that shows a motion."""
    with tempfile.TemporaryDirectory(prefix="linkwork-") as folder:
        file = origin["path"]
        if file is None:
            file = Path(folder) / "mechanism.rs"
            file.write_text(origin["text"], encoding="utf-8")
        motion = Path(folder) / "motion.csv"
        run.csv(motion)
        arguments = [_command(quiet=True), "view", file, "--motion", motion, "--out", path]
        if origin["options"]:
            arguments.append(f"--with={origin['options']}")
        if origin["name"]:
            arguments.append(f"--struct={origin['name']}")
        for name, value in run.mechanism.parameters.items():
            arguments.append(f"--set={name}={value!r}")
        arguments += _table_arguments(origin.get("tables", {}), folder)
        _run(arguments, None)


def command(arguments: list[str]) -> int:
    """Runs Linkwork's command, as `python -m linkwork` does, and returns its exit status."""
    return subprocess.run([str(_command(quiet=False)), *arguments], check=False).returncode


def _table(name: str, given: Any) -> tuple[str, list[str]]:
    """Returns a table as comma-separated values, and its options."""
    parts = list(given) if isinstance(given, (tuple, list)) else [given]
    words: list[str] = []
    while parts and isinstance(parts[-1], str) and parts[-1] in ("smooth", "extrapolated"):
        words.insert(0, parts.pop())
    if len(parts) == 1 and isinstance(parts[0], (str, os.PathLike)):
        path = Path(parts[0]).expanduser()
        if not path.is_file():
            raise FileNotFoundError(f"table {name!r}: there is no file {path}")
        return path.read_text(encoding="utf-8"), words
    if len(parts) != 2:
        raise TypeError(f"table {name!r}: expected a path or (axes, values), found {given!r}")
    axes = [np.asarray(axis, dtype=float) for axis in parts[0]]
    values = np.asarray(parts[1], dtype=float)
    shape = tuple(axis.size for axis in axes)
    if any(axis.ndim != 1 for axis in axes) or values.shape != shape:
        raise ValueError(f"table {name!r}: the axes have {shape} points, but the values the shape {values.shape}")
    points = np.stack([grid.ravel() for grid in np.meshgrid(*axes, indexing="ij")] + [values.ravel()], axis=1)
    return "\n".join(",".join(repr(float(x)) for x in row) for row in points), words


def _table_arguments(written: dict[str, Any], folder: str) -> list[Any]:
    arguments: list[Any] = []
    for k, (name, (text, words)) in enumerate(written.items()):
        file = Path(folder) / f"table_{k}.csv"
        file.write_text(text, encoding="utf-8")
        arguments += ["--table", ",".join([f"{name}={file}", *words])]
    return arguments


def _source(source: Any) -> tuple[str, None] | tuple[None, Path]:
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
    return None, path.resolve()


def _meant(path: Path) -> str:
    """Returns a suggestion for a path that does not exist."""
    if re.fullmatch(r"\w+", str(path)) and str(path) in gallery():
        return f"; `linkwork.gallery({str(path)!r})` is the one of the gallery"
    beside = [file.name for file in path.parent.iterdir() if file.is_file()] if path.parent.is_dir() else []
    near = difflib.get_close_matches(path.name, beside, n=3)
    return f": did you mean {', '.join(near)}?" if near else ""


def _words(path: Path | None, text: str | None, options: str, batch: bool, derivatives: bool) -> str:
    """Returns the options to add to those of the declaration."""
    if path is None or path.suffix == ".rs":
        text = text or (path.read_text(encoding="utf-8") if path else "")
        written = " ".join(re.findall(r"#\[(?:\w+::)*mechanism\((.*?)\)\]", text, flags=re.DOTALL))
    else:
        written = ""
    given = options.strip().strip(",")
    has: Callable[[str], bool] = lambda word: re.search(rf"\b{word}\b", f"{written} {given}") is not None
    bare = has("inertia\\s*=\\s*none")
    words = [given] if given else []
    words += ["derivatives"] if derivatives and not bare and not has("derivatives") else []
    words += ["batch"] if batch and not bare and not has("batch") else []
    return ", ".join(words)


def _build_library(crate: Path, native: bool, quiet: bool) -> Path:
    """Returns the library of a crate, and compiles it if it is not in the cache."""
    key = hashlib.sha256(_environment(native))
    for file in ("Cargo.toml", "src/lib.rs"):
        key.update((crate / file).read_bytes())
    path = cache_folder() / "libraries" / (key.hexdigest()[:32] + _suffix())

    def build(target: Path) -> Path:
        name = json.loads((crate / "description.json").read_text(encoding="utf-8"))["name"]
        lock = _sources() / "Cargo.lock"
        if lock.is_file():
            shutil.copyfile(lock, crate / "Cargo.lock")
        # A unique name, since the cargo of a killed process may still be running.
        own = f"mechanism_{secrets.token_hex(8)}"
        manifest = crate / "Cargo.toml"
        text = manifest.read_text(encoding="utf-8")
        manifest.write_text(text.replace('name = "mechanism"', f'name = "{own}"'), encoding="utf-8")
        progress = Progress(f"compiling {name}", quiet)
        _cargo_build(manifest, [], _flags(native), target, progress, "the library cannot be built")
        folder = target / _host() / "release"
        own_library = folder / (_stem() + own + _suffix())
        library = own_library.rename(folder / f"newest{_suffix()}")
        for leftovers in (folder, folder / "deps", folder / ".fingerprint"):
            for leftover in leftovers.glob("*mechanism*"):
                shutil.rmtree(leftover) if leftover.is_dir() else leftover.unlink(missing_ok=True)
        return library

    return build_once(path, build, quiet)


def _keep_origin(path: Path, origin: dict[str, Any]) -> None:
    """Writes the source of a library next to it, for other processes that unpickle the class."""
    file, content = path.with_suffix(".json"), json.dumps(origin).encode()
    try:
        if file.read_bytes() == content:
            return
    except OSError:
        pass
    # A read-only cache still provides the libraries that it contains.
    with contextlib.suppress(OSError):
        write(file, content)


def _command(quiet: bool) -> Path:
    """Returns the path of Linkwork's command: that of `LINKWORK_COMMAND`, or that in the cache, which is
    compiled if necessary."""
    own = os.environ.get("LINKWORK_COMMAND")
    if own:
        return _own_command(own)
    key = hashlib.sha256(_environment(native=True)).hexdigest()[:16]

    def build(target: Path) -> Path:
        sources = _sources()
        if sources == _HERE / "_source":
            # Cargo writes to the folder of a workspace, but an installed package may be read-only.
            sources = target / "source"
            shutil.rmtree(sources, ignore_errors=True)
            shutil.copytree(_sources(), sources, ignore=shutil.ignore_patterns("models"))
        manifest = sources / "macros" / "cli" / "Cargo.toml"
        # Libraries reuse the other crates, which are compiled with the same flags.
        profile = [f'profile.release.package."{name}".opt-level=0' for name in _UNOPTIMISED]
        progress = Progress("compiling the compiler, once", quiet)
        _cargo_build(manifest, profile, _flags(native=True), target, progress, "Linkwork's command cannot be built")
        return target / _host() / "release" / f"linkwork{_program_suffix()}"

    return build_once(cache_folder() / f"linkwork-{key}{_program_suffix()}", build, quiet)


@functools.cache
def _own_command(path: str) -> Path:
    said = _run([path, "--version"], "`LINKWORK_COMMAND` names no command that runs").split()
    manifest = (_sources() / "Cargo.toml").read_text(encoding="utf-8")
    found = re.search(r'^version = "(.*)"', manifest, re.MULTILINE)
    wanted = found[1] if found else ""
    if said != ["linkwork", wanted]:
        raise ToolchainError(f"`LINKWORK_COMMAND` names {' '.join(said)!r}, and this package needs 'linkwork {wanted}'")
    return Path(path)


def _flags(native: bool) -> str:
    """Returns the flags of rustc for the processor of this machine, or for all processors of its kind."""
    return " ".join([os.environ.get("RUSTFLAGS", ""), _EXPANDED, *(["-C target-cpu=native"] if native else [])]).strip()


def _cargo_build(
    manifest: Path, profile: list[str], flags: str, target: Path, progress: "Progress", failure: str
) -> None:
    """Runs `cargo build` and shows its progress."""
    arguments = [str(_cargo()), "build", "--release", "--target", _host(), "--manifest-path", str(manifest)]
    for setting in profile:
        arguments += ["--config", setting]
    environment = {
        **os.environ,
        "CARGO_TARGET_DIR": str(target),
        "CARGO_TERM_COLOR": "never",
        "CARGO_TERM_PROGRESS_WHEN": "always",
        "CARGO_TERM_PROGRESS_WIDTH": "80",
        "CARGO_TERM_QUIET": "false",
        "CARGO_TERM_VERBOSE": "false",
        "RUSTFLAGS": flags,
    }
    # This variable would take precedence over `RUSTFLAGS`.
    environment.pop("CARGO_ENCODED_RUSTFLAGS", None)
    complaints = []
    try:
        process = subprocess.Popen(
            arguments,
            stdin=subprocess.DEVNULL,
            stdout=subprocess.DEVNULL,
            stderr=subprocess.PIPE,
            text=True,
            encoding="utf-8",
            errors="replace",
            env=environment,
        )
    except OSError as error:
        raise ToolchainError(f"cannot run {arguments[0]}: {error}") from None
    with process, progress:
        try:
            # Cargo ends progress lines with carriage returns, which text mode treats as line ends.
            for line in process.stderr or ():
                step = re.match(r"\s*Building \[.*\] (\d+)/(\d+)", line)
                if step:
                    progress.show(step[1], step[2])
                elif not re.match(r"\s*(Compiling|Building|Finished|Locking|Updating|Download\w+|Adding|Blocking) ", line):
                    complaints.append(line)
        except BaseException:
            process.kill()
            raise
    if process.returncode != 0:
        text = "".join(complaints).strip() or f"exit status {process.returncode}"
        raise ToolchainError(f"{failure}:\n{text}\n(cargo's files are in {target}, which can be deleted)")


class Progress:
    """Shows the progress of a build: on a terminal in one line that is updated every second, otherwise in a
    new line every ten seconds."""

    def __init__(self, task: str, quiet: bool) -> None:
        self.task, self.quiet, self.crates = f"linkwork: {task}", quiet, ""
        self.terminal = sys.stderr is not None and sys.stderr.isatty()
        self.start = time.monotonic()
        self.ended = threading.Event()
        self.thread = threading.Thread(target=self._repeat, daemon=True)

    def __enter__(self) -> "Progress":
        self._write(f"{self.task} …")
        self.thread.start()
        return self

    def __exit__(self, *_: object) -> None:
        self.ended.set()
        self.thread.join()
        if self.terminal:
            self._write(f"{self.task}: {time.monotonic() - self.start:.0f} s", end="\n")

    def show(self, done: str, count: str) -> None:
        """Sets the number of compiled crates and the number of all crates."""
        self.crates = f"{done} of {count} crates, "

    def _repeat(self) -> None:
        while not self.ended.wait(1.0 if self.terminal else 10.0):
            self._write(f"{self.task}: {self.crates}{time.monotonic() - self.start:.0f} s")

    def _write(self, text: str, end: str = "") -> None:
        if not self.quiet:
            print(f"\r{text:78}" if self.terminal else text, end=end if self.terminal else "\n", file=sys.stderr, flush=True)


@functools.cache
def _host() -> str:
    """Returns the target triple of this machine, as rustc names it."""
    found = re.search(r"^host: (\S+)", toolchain(), re.MULTILINE)
    if found is None:
        raise ToolchainError(f"`rustc -vV` names no host:\n{toolchain()}")
    return found[1]


def _sources() -> Path:
    """Returns the folder of Linkwork's sources: in the package, or in the repository that contains the
    package."""
    own = os.environ.get("LINKWORK_SOURCE")
    candidates = [Path(own)] if own else [_HERE / "_source", *_HERE.parents]
    for folder in candidates:
        if (folder / "runtime" / "library" / "Cargo.toml").is_file():
            return folder
    raise ToolchainError("the sources of Linkwork are missing: install the package again")


def _fingerprint() -> bytes:
    """Returns a digest of the sources."""
    folder = _sources()
    key = hashlib.sha256()
    files = [*folder.glob("Cargo.*")]
    for crate in ("macros", "macros/cli", "macros/compiler", "runtime", "runtime/library", "runtime/view"):
        files += [folder / crate / "Cargo.toml", *(folder / crate / "src").rglob("*.*")]
    for file in sorted(files):
        key.update(f"{file.relative_to(folder)} {digest(file.read_bytes())}\n".encode())
    return key.digest()


def _cargo() -> Path:
    """Returns the path of cargo."""
    found = os.environ.get("CARGO") or shutil.which("cargo")
    own = Path.home() / ".cargo" / "bin" / ("cargo.exe" if os.name == "nt" else "cargo")
    if found:
        return Path(found)
    if own.is_file():
        return own
    raise ToolchainError(
        "compiling a mechanism needs Rust, and there is no `cargo`: install it as https://rustup.rs says, then try again"
    )


def _processor() -> bytes:
    """Returns the features of the processor, on which native code depends."""
    try:
        return b"".join(l for l in Path("/proc/cpuinfo").read_bytes().splitlines() if l.startswith(b"flags"))[:4096]
    except OSError:
        import platform

        return platform.processor().encode()


def _suffix() -> str:
    return {"win32": ".dll", "darwin": ".dylib"}.get(sys.platform, ".so")


def _stem() -> str:
    return "" if sys.platform == "win32" else "lib"


def _program_suffix() -> str:
    return ".exe" if sys.platform == "win32" else ""


def _run(arguments: list[Any], failure: str | None) -> str:
    """Runs a command and returns its output. If it fails, its error messages are raised: as a
    `ToolchainError` with the text `failure`, or without it as an `Error` of the mechanism."""
    pauses = [1.0, 0.2, 0.05]
    while True:
        try:
            done = subprocess.run(
                [str(a) for a in arguments],
                capture_output=True,
                text=True,
                encoding="utf-8",
                check=False,
            )
            break
        except OSError as error:
            # A process started by another thread may inherit the open file of a new program for a short time.
            if error.errno != errno.ETXTBSY or not pauses:
                raise ToolchainError(f"cannot run {arguments[0]}: {error}") from None
            time.sleep(pauses.pop())
    if done.returncode == 0:
        return done.stdout
    complaints = done.stderr.strip() or f"exit status {done.returncode}"
    if failure is None:
        reported = Error(_translate_complaints(complaints))
        reported.complaints, reported.status = complaints, done.returncode
        raise reported
    raise ToolchainError(f"{failure}:\n{complaints}")


def _translate_complaints(complaints: str) -> str:
    """Replaces options of the command and of the attribute in error messages by arguments of Python."""
    complaints = re.sub(r"\S*linkwork-\w+[/\\]mechanism\.rs", "mechanism.rs", complaints)
    complaints = re.sub(r"`#\[mechanism\((?:…|(?:urdf|mjcf|sdf) = \"[^\"]*\"), ([^`]*)\)\]`", r"`options='\1'`", complaints)
    complaints = re.sub(r"`--with[ =]([\"'])([^`]*)\1`", r"`options='\2'`", complaints)
    complaints = re.sub(r"`--with[ =]([^`]*)`", r"`options='\1'`", complaints)
    complaints = complaints.replace("`--with`", "`options=`").replace("--with", "options=")
    complaints = re.sub(r"--table (\w+)=FILE", r"tables={'\1': …}", complaints)
    complaints = re.sub(r"`--table (\w+)=[^`]*`", r"`tables`, '\1'", complaints)
    return complaints.replace("`--struct NAME`", "`name=`")
