"""Declarations and robot files to compiled libraries, which are kept."""

import difflib
import errno
import functools
import hashlib
import json
import os
import re
import shutil
import subprocess
import sys
import tempfile
import threading
import time
from pathlib import Path

import numpy as np

from ._mechanism import Mechanism, load
from ._names import Error, UnknownName, checked

_HERE = Path(__file__).resolve().parent


class ToolchainError(Error):
    """There is no toolchain of Rust, or it cannot build."""


def toolchain() -> str:
    """The version of the Rust compiler that is used, as it prints it.

    Raises:
        ToolchainError: there is none; the message says how to install one.
    """
    cargo = _cargo()
    rustc = os.environ.get("RUSTC") or shutil.which("rustc") or str(cargo.with_name("rustc"))
    return _run([rustc, "-vV"], "cannot run rustc").strip()


@checked
def compile(
    source: str | os.PathLike,
    *,
    options: str = "",
    name: str | None = None,
    tables: dict | None = None,
    native: bool = True,
    batch: bool = True,
    derivatives: bool = True,
    quiet: bool = False,
) -> type[Mechanism]:
    """Compiles a mechanism to a class.

    The first call builds Linkwork's command, which takes a minute (the environment variable ``LINKWORK_COMMAND`` names one of the
    same version that is there already); every mechanism takes some seconds to half a minute, and is found at once when it is asked
    for again.

    Args:
        source: the path of a robot file (URDF, MJCF, SDF) or of a Rust file with a struct that has ``#[mechanism]``; or such a
            declaration as text.
        options: further arguments of the attribute, as in ``"base = free, inertia = trust"``.
        name: the struct, of a Rust file that has several.
        tables: the figures of fields that are tables, by name: a path of a file of comma-separated values (for each point of the grid
            a line with the variables, then the value), or ``(axes, values)`` with the points of each axis and an array that has as many
            sides. Behind either may stand ``"smooth"`` and ``"extrapolated"``: ``(axes, values, "smooth")``, ``(path, "smooth")``.
            The figures become constants of the library.
        native: for the processor at hand rather than for all of its kind.
        batch: also functions of eight states at once, for arrays of states. Takes longer to compile.
        derivatives: also derivatives of the dynamics, linear systems, and steps with Jacobians. Takes longer to compile.
        quiet: says nothing while it builds.

    Returns:
        A subclass of :class:`Mechanism`; its instances are mechanisms with values of the parameters.

    Raises:
        ToolchainError: there is no toolchain of Rust, or it cannot build.
        Error: the mechanism has mistakes, all of which the message has with their places; or the text is no declaration.
        FileNotFoundError: there is no such file.
    """
    text, path = _source(source)
    written = {key: _table(key, table) for key, table in (tables or {}).items()}
    command = _command(quiet)
    with tempfile.TemporaryDirectory(prefix="linkwork-") as folder:
        if path is None:
            path = Path(folder) / "mechanism.rs"
            path.write_text(text, encoding="utf-8")
        words = _words(path, text, options, batch, derivatives)
        arguments = [command, "export", "library", path, "--out", Path(folder) / "crate"]
        arguments += ["--prefix", "mechanism", "--linkwork", _sources()]
        if words:
            arguments += ["--with", words]
        if name is not None:
            arguments += ["--struct", name]
        arguments += _table_arguments(written, folder)
        _run(arguments, None)
        origin = {"text": text, "path": None if text else str(path), "options": words, "name": name}
        origin["tables"] = written
        return _built(Path(folder) / "crate", origin, native, quiet)


def gallery(name: str | None = None, **settings):
    """The mechanisms of Linkwork's gallery: their names; or the class of one of them, compiled as :func:`compile` does.

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


def view(origin, run, path):
    """Writes a page of a motion."""
    with tempfile.TemporaryDirectory(prefix="linkwork-") as folder:
        file = origin["path"]
        if file is None:
            file = Path(folder) / "mechanism.rs"
            file.write_text(origin["text"], encoding="utf-8")
        motion = Path(folder) / "motion.csv"
        run.csv(motion)
        arguments = [_command(quiet=True), "view", file, "--motion", motion, "--out", path]
        if origin["options"]:
            arguments += ["--with", origin["options"]]
        if origin["name"]:
            arguments += ["--struct", origin["name"]]
        for name, value in run.mechanism.parameters.items():
            arguments += ["--set", f"{name}={value!r}"]
        arguments += _table_arguments(origin.get("tables", {}), folder)
        _run(arguments, None)


def command(arguments: list[str]) -> int:
    """Runs Linkwork's command, as `python -m linkwork` does; its exit status."""
    return subprocess.run([str(_command(quiet=False)), *arguments], check=False).returncode


def _table(name, given):
    """A table as comma-separated values, and the words behind it."""
    parts = list(given) if isinstance(given, (tuple, list)) else [given]
    words = []
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


def _table_arguments(written, folder):
    arguments = []
    for k, (name, (text, words)) in enumerate(written.items()):
        file = Path(folder) / f"table_{k}.csv"
        file.write_text(text, encoding="utf-8")
        arguments += ["--table", ",".join([f"{name}={file}", *words])]
    return arguments


def _source(source):
    """The text of a declaration, or the path of a file."""
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


def _meant(path):
    """What a path that there is not may stand for."""
    if re.fullmatch(r"\w+", str(path)) and str(path) in gallery():
        return f"; `linkwork.gallery({str(path)!r})` is the one of the gallery"
    beside = [file.name for file in path.parent.iterdir() if file.is_file()] if path.parent.is_dir() else []
    near = difflib.get_close_matches(path.name, beside, n=3)
    return f": did you mean {', '.join(near)}?" if near else ""


def _words(path, text, options, batch, derivatives):
    """Arguments of the attribute that are not there yet."""
    if path.suffix == ".rs":
        text = text if text is not None else path.read_text(encoding="utf-8")
        written = " ".join(re.findall(r"#\[(?:\w+::)*mechanism\((.*?)\)\]", text, flags=re.DOTALL))
    else:
        written = ""
    given = options.strip().strip(",")
    has = lambda word: re.search(rf"\b{word}\b", f"{written} {given}") is not None
    bare = has("inertia\\s*=\\s*none")
    words = [given] if given else []
    words += ["derivatives"] if derivatives and not bare and not has("derivatives") else []
    words += ["batch"] if batch and not bare and not has("batch") else []
    return ", ".join(words)


def _built(crate, origin, native, quiet):
    """The class of a crate, which is compiled unless that has been done before."""
    key = hashlib.sha256()
    for file in ("Cargo.toml", "src/lib.rs"):
        key.update((crate / file).read_bytes())
    key.update(_files_named(crate / "src" / "lib.rs"))
    key.update(toolchain().encode())
    key.update(_fingerprint())
    flags = os.environ.get("RUSTFLAGS", "")
    if native:
        flags = f"{flags} -C target-cpu=native".strip()
        key.update(_processor())
    key.update(flags.encode())
    kept = _cache() / "libraries" / (key.hexdigest()[:32] + _suffix())
    if not kept.is_file():
        described = json.loads((crate / "description.json").read_text(encoding="utf-8"))
        if not quiet:
            print(f"linkwork: compiling {described['name']} …", file=sys.stderr, flush=True)
        target = _cache() / "target"
        environment = {**os.environ, "CARGO_TARGET_DIR": str(target), "RUSTFLAGS": flags}
        lock = _sources() / "Cargo.lock"
        if lock.is_file():
            shutil.copy(lock, crate / "Cargo.lock")
        # A name of its own: others may be built in this folder at the same time.
        own = "mechanism_" + kept.stem
        manifest = crate / "Cargo.toml"
        text = manifest.read_text(encoding="utf-8")
        manifest.write_text(text.replace('name = "mechanism"', f'name = "{own}"'), encoding="utf-8")
        arguments = [_cargo(), "build", "--release", "--quiet", "--manifest-path", manifest]
        _run(arguments, "the library cannot be built", environment)
        kept.parent.mkdir(parents=True, exist_ok=True)
        unfinished = kept.with_suffix(f".{os.getpid()}.{threading.get_ident()}")
        shutil.copy(target / "release" / (_stem() + own + _suffix()), unfinished)
        os.replace(unfinished, kept)
        for folder in (target / "release", target / "release" / "deps"):
            for left in folder.glob(f"*{own}*"):
                left.unlink(missing_ok=True)
    kept.with_suffix(".json").write_text(json.dumps(origin), encoding="utf-8")
    return load(kept)


def _files_named(source):
    """The contents of files that a crate names: when one of them changes, it is another library."""
    named = re.findall(r'"((?:/|[A-Za-z]:)[^"\n]*)"', source.read_text(encoding="utf-8")[:20000])
    found = [Path(path) for path in named]
    return b"".join(path.read_bytes() for path in found if path.is_file())


# One thread compiles the command, the others find it.
_COMMAND = threading.Lock()


def _command(quiet):
    """Linkwork's command: the one that `LINKWORK_COMMAND` names, or one that is compiled once."""
    own = os.environ.get("LINKWORK_COMMAND")
    if own:
        return _own_command(own)
    with _COMMAND:
        return _compiled_command(quiet)


@functools.cache
def _own_command(path):
    said = _run([path, "--version"], "`LINKWORK_COMMAND` names no command that runs").split()
    manifest = (_sources() / "Cargo.toml").read_text(encoding="utf-8")
    wanted = re.search(r'^version = "(.*)"', manifest, re.MULTILINE).group(1)
    if said != ["linkwork", wanted]:
        raise ToolchainError(f"`LINKWORK_COMMAND` names {' '.join(said)!r}, and this package needs 'linkwork {wanted}'")
    return Path(path)


def _compiled_command(quiet):
    target = _cache() / "target"
    suffix = ".exe" if os.name == "nt" else ""
    key = hashlib.sha256(_fingerprint() + toolchain().encode()).hexdigest()[:16]
    kept = _cache() / f"linkwork-{key}{suffix}"
    if kept.is_file():
        return kept
    if not quiet:
        print("linkwork: compiling the compiler, once …", file=sys.stderr, flush=True)
    manifest = _sources() / "macros" / "cli" / "Cargo.toml"
    environment = {**os.environ, "CARGO_TARGET_DIR": str(target)}
    arguments = [_cargo(), "build", "--release", "--quiet", "--manifest-path", manifest]
    _run(arguments, "Linkwork's command cannot be built", environment)
    kept.parent.mkdir(parents=True, exist_ok=True)
    unfinished = kept.with_suffix(f".{os.getpid()}.{threading.get_ident()}")
    shutil.copy(target / "release" / f"linkwork{suffix}", unfinished)
    os.replace(unfinished, kept)
    return kept


def _sources():
    """The folder of Linkwork's sources: those of the package, or of the repository that it is in."""
    own = os.environ.get("LINKWORK_SOURCE")
    candidates = [Path(own)] if own else [_HERE / "_source", *_HERE.parents]
    for folder in candidates:
        if (folder / "runtime" / "library" / "Cargo.toml").is_file():
            return folder
    raise ToolchainError("the sources of Linkwork are missing: install the package again")


def _fingerprint():
    """What tells these sources from others."""
    folder = _sources()
    key = hashlib.sha256()
    files = [f for part in ("macros", "runtime") for f in sorted((folder / part).rglob("*.rs"))]
    for file in files:
        about = file.stat()
        key.update(f"{file.relative_to(folder)} {about.st_size} {about.st_mtime_ns}\n".encode())
    return key.digest()


def _cache():
    """Where libraries are kept: `LINKWORK_CACHE`, or a folder of the user's."""
    own = os.environ.get("LINKWORK_CACHE")
    if own:
        return Path(own)
    if sys.platform == "win32":
        return Path(os.environ.get("LOCALAPPDATA", Path.home())) / "linkwork"
    if sys.platform == "darwin":
        return Path.home() / "Library" / "Caches" / "linkwork"
    return Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache") / "linkwork"


def _cargo():
    found = os.environ.get("CARGO") or shutil.which("cargo")
    own = Path.home() / ".cargo" / "bin" / ("cargo.exe" if os.name == "nt" else "cargo")
    if found:
        return Path(found)
    if own.is_file():
        return own
    raise ToolchainError(
        "compiling a mechanism needs Rust, and there is no `cargo`: install it as https://rustup.rs says, then try again"
    )


def _processor():
    """What native code is compiled for."""
    try:
        return b"".join(l for l in Path("/proc/cpuinfo").read_bytes().splitlines() if l.startswith(b"flags"))[:4096]
    except OSError:
        import platform

        return platform.processor().encode()


def _suffix():
    return {"win32": ".dll", "darwin": ".dylib"}.get(sys.platform, ".so")


def _stem():
    return "" if sys.platform == "win32" else "lib"


def _run(arguments, failure, environment=None):
    """What a command prints. Its complaints are the error."""
    for pause in (0.05, 0.2, 1.0, None):
        try:
            done = subprocess.run(
                [str(a) for a in arguments],
                capture_output=True,
                text=True,
                encoding="utf-8",
                env=environment,
                check=False,
            )
            break
        except OSError as error:
            # A process that another thread starts at this moment has the new file open a little longer.
            if error.errno != errno.ETXTBSY or pause is None:
                raise ToolchainError(f"cannot run {arguments[0]}: {error}") from None
            time.sleep(pause)
    if done.returncode == 0:
        return done.stdout
    complaints = done.stderr.strip() or f"exit status {done.returncode}"
    if failure is None:
        error = Error(complaints.replace("`--struct NAME`", "`name=`"))
        error.status = done.returncode
        raise error
    raise ToolchainError(f"{failure}:\n{complaints}")
