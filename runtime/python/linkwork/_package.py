"""Writes compiled mechanisms as separate packages, which need neither Linkwork nor Rust."""

import argparse
import keyword
import os
import platform
import re
import shutil
from pathlib import Path
from typing import Any

from ._functions import digest_file
from ._mechanism import Mechanism

_HERE = Path(__file__).resolve().parent
_MODULE = '''"""{name}, compiled by Linkwork: needs NumPy alone, and a machine of the kind that it was compiled on ({machine})."""

from pathlib import Path

from ._mechanism import Mechanism, load
from ._names import Error
from ._results import LinearSystem, Run

{name} = load(Path(__file__).with_name("{library}"))
{name}.__module__ = __name__

__all__ = ["Error", "LinearSystem", "Mechanism", "Run", "{name}"]
'''

#: Modules of Linkwork that a package contains.
_PARTS = ("_equilibrium.py", "_functions.py", "_mechanism.py", "_names.py", "_results.py")


def module_name(name: str) -> str:
    """Returns the package name for a struct: `cart_pole` for `CartPole`."""
    words = re.sub(r"(?<=[a-z0-9])(?=[A-Z])|(?<=[A-Z])(?=[A-Z][a-z])", "_", name).lower()
    return f"{words}_" if keyword.iskeyword(words) else words


def save(kind: type[Mechanism], folder: str | os.PathLike[str]) -> Path:
    """Writes the package of a class to a folder."""
    library = Path(kind._path)
    package = Path(folder) / module_name(kind.name)
    if package.exists() and not (package / "_mechanism.py").is_file() and any(package.iterdir()):
        raise FileExistsError(f"{package} is there already, and is no package of a mechanism")
    package.mkdir(parents=True, exist_ok=True)
    own = "mechanism" + library.suffix
    machine = f"{platform.system()} {platform.machine()}"
    # The library may be loaded, so the file is replaced instead of overwritten.
    shutil.copyfile(library, package / (own + ".new"))
    shutil.copyfile(digest_file(library), digest_file(package / own))
    (package / (own + ".new")).replace(package / own)
    for part in _PARTS:
        shutil.copy(_HERE / part, package / part)
    text = _MODULE.format(name=kind.name, machine=machine, library=own)
    (package / "__init__.py").write_text(text, encoding="utf-8")
    imports = "from ._mechanism import Mechanism as Mechanism\nfrom ._names import Error as Error\n"
    imports += "from ._results import LinearSystem as LinearSystem, Run as Run\n"
    stub = kind.stub().replace("import linkwork\n", imports)
    stub = stub.replace("(linkwork.Mechanism)", "(Mechanism)")
    (package / "__init__.pyi").write_text(stub, encoding="utf-8")
    (package / "py.typed").write_text("", encoding="utf-8")
    return package


def export(arguments: list[str]) -> None:
    """`linkwork export python`: compiles a mechanism and writes its package."""
    from ._build import compile

    parser = argparse.ArgumentParser(
        prog="linkwork export python",
        description="A package for Python: a module, its library and its stubs, for machines without Rust",
    )
    parser.add_argument("file", metavar="FILE", help="a robot file (URDF, MJCF or SDF), or a Rust file")
    parser.add_argument("--struct", metavar="NAME", help="the struct in a Rust file that has several")
    parser.add_argument("--with", dest="options", metavar="OPTIONS", default="", help="further arguments of the attribute")
    parser.add_argument("--table", metavar="NAME=FILE", action="append", default=[], help="figures of a table")
    parser.add_argument("--native", action="store_true", help="for the very processor at hand, not for all of its kind")
    parser.add_argument("--out", "-o", metavar="FOLDER", default=".", help="where the package goes [default: .]")
    given = parser.parse_args(arguments)
    tables: dict[str, Any] = {}
    for table in given.table:
        name, _, words = table.partition("=")
        tables[name] = tuple(words.split(","))
    kind = compile(Path(given.file), options=given.options, name=given.struct, tables=tables, native=given.native)
    package = save(kind, given.out)
    for file in sorted(package.iterdir()):
        if file.is_file():
            print(file)
