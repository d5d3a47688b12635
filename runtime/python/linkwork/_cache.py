"""Cache of compiled files, shared by any number of processes.

Processes build one at a time, under a lock that the operating system releases when the process that holds it
ends, even if it is killed. A file is written under a unique name and then renamed, so that readers find a
complete file or none.
"""

import contextlib
import errno
import os
import secrets
import sys
import tempfile
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import IO

from ._functions import digest, digest_file, is_intact
from ._names import Error


class ToolchainError(Error):
    """The Rust toolchain is missing or cannot build."""


def cache_folder() -> Path:
    """Returns the folder of the cache: `LINKWORK_CACHE`, or the user's cache folder."""
    chosen = os.environ.get("LINKWORK_CACHE")
    if chosen:
        return Path(chosen).expanduser().absolute()
    if sys.platform == "win32":
        return Path(os.environ.get("LOCALAPPDATA", Path.home())) / "linkwork"
    if sys.platform == "darwin":
        return Path.home() / "Library" / "Caches" / "linkwork"
    return Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache") / "linkwork"


def build_once(path: Path, build: Callable[[Path], Path], quiet: bool) -> Path:
    """Returns a file of the cache, and builds it if it is missing or damaged. `build` takes cargo's target
    folder and returns the path of the built file."""
    with contextlib.suppress(OSError):
        if is_intact(path):
            return path
    with report_write_errors(), hold_lock(quiet) as target:
        # Another process may have built the file in the meantime.
        if not is_intact(path):
            path.parent.mkdir(parents=True, exist_ok=True)
            # Remnants of killed processes: only the holder of the lock writes such files.
            for unfinished in path.parent.glob(f"*{path.suffix}.*unfinished"):
                unfinished.unlink(missing_ok=True)
            content = build(target).read_bytes()
            write(digest_file(path), digest(content).encode())
            write(path, content, mode=0o755)
    return path


def write(path: Path, content: bytes, mode: int = 0o644) -> None:
    """Writes a file atomically: readers find either the old or the new content."""
    unfinished = path.with_name(f"{path.name}.{secrets.token_hex(8)}.unfinished")
    try:
        unfinished.write_bytes(content)
        unfinished.chmod(mode)
        unfinished.replace(path)
    except BaseException:
        with contextlib.suppress(OSError):
            unfinished.unlink(missing_ok=True)
        raise


@contextlib.contextmanager
def report_write_errors() -> Iterator[None]:
    """Raises errors of writing to the cache with its folder, and with the variable that changes it."""
    try:
        yield
    except OSError as error:
        raise ToolchainError(
            f"cannot write to the cache folder {cache_folder()}: {error}; the environment variable `LINKWORK_CACHE` names another folder"
        ) from error


@contextlib.contextmanager
def hold_lock(quiet: bool) -> Iterator[Path]:
    """Holds the lock of the cache, which admits one thread of one process at a time. Yields cargo's target
    folder, or a temporary folder if the file system of the cache does not support locks."""
    folder = cache_folder()
    folder.mkdir(parents=True, exist_ok=True)
    with open(folder / "lock", "a+b") as file:
        if not _acquire(file, quiet):
            with tempfile.TemporaryDirectory(prefix="linkwork-") as target:
                yield Path(target)
            return
        _HELD.add(file)
        try:
            yield folder / "target"
        finally:
            _HELD.discard(file)
            _release(file)


#: Lock files that this process holds.
_HELD: set[IO[bytes]] = set()


def _close_inherited() -> None:
    """Closes lock files in a forked process, which would otherwise hold its parent's locks after the parent
    has ended."""
    for file in _HELD:
        file.close()
    _HELD.clear()


if sys.platform == "win32":
    import msvcrt

    def _acquire(file: IO[bytes], quiet: bool) -> bool:
        """Waits for the lock."""
        reported = quiet
        while True:
            try:
                file.seek(0)
                msvcrt.locking(file.fileno(), msvcrt.LK_NBLCK, 1)
                return True
            except OSError as error:
                if error.errno not in (errno.EACCES, errno.EDEADLOCK):
                    raise
            if not reported:
                _report_waiting()
                reported = True
            time.sleep(0.1)

    def _release(file: IO[bytes]) -> None:
        file.seek(0)
        msvcrt.locking(file.fileno(), msvcrt.LK_UNLCK, 1)

else:
    import fcntl

    def _acquire(file: IO[bytes], quiet: bool) -> bool:
        """Waits for the lock; returns false if the file system does not support locks."""
        try:
            fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            if not quiet:
                _report_waiting()
            fcntl.flock(file, fcntl.LOCK_EX)
        except OSError as error:
            if error.errno not in (errno.ENOLCK, errno.ENOSYS, errno.EOPNOTSUPP, errno.EINVAL):
                raise
            return False
        return True

    def _release(file: IO[bytes]) -> None:
        fcntl.flock(file, fcntl.LOCK_UN)

    os.register_at_fork(after_in_child=_close_inherited)


def _report_waiting() -> None:
    print("linkwork: waiting for another process that compiles …", file=sys.stderr, flush=True)
