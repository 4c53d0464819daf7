#!/usr/bin/env python3
"""Every dependency is used: no crate lists one that none of its sources names, and the workspace's table holds none that
no crate lists. The lint `unused_crate_dependencies` cannot tell: it takes what only some of a crate's tests use for unused.

Usage: check_dependencies.py; from anywhere, needs Python 3.11.
"""

import pathlib
import re
import sys
import tomllib

ROOT = pathlib.Path(__file__).resolve().parents[2]


def tables(package):
    """All tables of dependencies of a package, those of single targets too."""
    for part in [package, *package.get("target", {}).values()]:
        for kind in ["dependencies", "dev-dependencies", "build-dependencies"]:
            yield from part.get(kind, {}).items()


def main():
    workspace = tomllib.loads((ROOT / "Cargo.toml").read_text())["workspace"]
    folders = [folder for pattern in workspace["members"] for folder in ROOT.glob(pattern)]
    listed, faults = set(), []
    for folder in sorted(folders):
        manifest = folder / "Cargo.toml"
        sources = "\n".join(path.read_text() for path in sorted(folder.rglob("*.rs")))
        for name, entry in tables(tomllib.loads(manifest.read_text())):
            listed.add(name)
            if not (isinstance(entry, dict) and entry.get("workspace")):
                faults.append(f"{manifest.relative_to(ROOT)}: {name} is not taken from the workspace's table")
            if not re.search(rf"\b{re.escape(name.replace('-', '_'))}\b", sources):
                faults.append(f"{manifest.relative_to(ROOT)}: no source of the crate names {name}")
    for name in workspace["dependencies"]:
        if name not in listed:
            faults.append(f"Cargo.toml: no crate lists {name}")
    print("\n".join(faults) or f"{len(listed)} dependencies, all used")
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
