"""Adds the sources of Linkwork to the wheel: the crates that mechanisms in Python are compiled with."""

import re
import tempfile
from pathlib import Path

from hatchling.builders.hooks.plugin.interface import BuildHookInterface

MEMBERS = ["macros", "macros/cli", "macros/compiler", "runtime", "runtime/library", "runtime/view"]
FOLDERS = [*(f"{member}/src" for member in MEMBERS), "models/src", "models/urdf"]
ENDS = {".rs", ".md", ".toml", ".js", ".css", ".html", ".c", ".h", ".urdf", ".sdf", ".xml", ".stl", ".obj", ".csv"}


class Sources(BuildHookInterface):
    """Build hook of hatchling."""

    def initialize(self, version, build_data):
        """Lists the files to include."""
        root = Path(self.root).parents[1]
        self.folder = tempfile.TemporaryDirectory()
        trimmed = Path(self.folder.name)
        included = build_data["force_include"]

        def add(name, text):
            path = trimmed / name
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_text(text, encoding="utf-8")
            included[str(path)] = f"linkwork/_source/{name}"

        members = ", ".join(f'"{member}"' for member in MEMBERS)
        workspace = (root / "Cargo.toml").read_text(encoding="utf-8")
        workspace = re.sub(r"^members = .*$", f"members = [{members}]", workspace, flags=re.MULTILINE)
        add("Cargo.toml", re.sub(r"^linkwork-(models|design) = .*\n", "", workspace, flags=re.MULTILINE))
        included[str(root / "Cargo.lock")] = "linkwork/_source/Cargo.lock"
        included[str(root / "README.md")] = "linkwork/_source/README.md"
        for member in MEMBERS:
            # Tests and their dependencies are omitted.
            text = (root / member / "Cargo.toml").read_text(encoding="utf-8")
            text = re.sub(r"^\[dev-dependencies\]\n.*?(?=^\[|\Z)", "", text, flags=re.DOTALL | re.MULTILINE)
            text = re.sub(r"^\[\[(?:test|bench|example)\]\]\n.*?(?=^\[|\Z)", "", text, flags=re.DOTALL | re.MULTILINE)
            add(f"{member}/Cargo.toml", text)
            readme = root / member / "README.md"
            if readme.is_file():
                included[str(readme)] = f"linkwork/_source/{member}/README.md"
        # Paths in the gallery are relative to the folder of its package.
        add("models/Cargo.toml", "[package]\nname = \"gallery\"\nversion = \"0.1.0\"\nedition = \"2024\"\n\n[workspace]\n")
        for folder in [*FOLDERS, "runtime/guide"]:
            for path in sorted((root / folder).rglob("*")):
                if path.is_file():
                    included[str(path)] = f"linkwork/_source/{path.relative_to(root).as_posix()}"

    def finalize(self, version, build_data, artifact_path):
        """Removes the temporary files."""
        self.folder.cleanup()
