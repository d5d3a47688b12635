"""Sources of mechanisms."""

import atexit
import functools
import os
import shutil
import tempfile
from pathlib import Path
from typing import Any

from . import _native


def locate(origin: dict[str, Any]) -> dict[str, Any]:
    """Returns the arguments of the extension module for a source: a text or a path, its options, the name of the
    struct, and the folder of the files that a text names."""
    path, text = origin["path"], origin["text"]
    return {
        "source": path if text is None else text,
        "is_file": text is None,
        "options": origin["options"],
        "name": origin["name"],
        "folder": _folder() if origin["gallery"] else None,
    }


@functools.cache
def _folder() -> str:
    """Returns a folder with the robot files that the gallery names."""
    folder, process = tempfile.mkdtemp(prefix="linkwork-"), os.getpid()
    for name, text in _native.gallery_files()[1]:
        path = Path(folder) / name
        path.parent.mkdir(exist_ok=True)
        path.write_text(text, encoding="utf-8")

    def remove() -> None:
        # A forked process leaves the files of its parent.
        if os.getpid() == process:
            shutil.rmtree(folder, ignore_errors=True)

    atexit.register(remove)
    return folder
