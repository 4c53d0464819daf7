#!/usr/bin/env python3
"""No line of a comment in Rust is longer than 120 columns. rustfmt holds code to that, but leaves comments as they are.

Usage: check_columns.py; from anywhere.
"""

import pathlib
import re
import sys

ROOT = pathlib.Path(__file__).resolve().parents[2]
WIDTH = 120


def main():
    faults = []
    for folder in ["crates", "tests", "fuzz"]:
        for path in sorted((ROOT / folder).rglob("*.rs")):
            for number, line in enumerate(path.read_text().splitlines(), 1):
                if len(line) > WIDTH and re.match(r"\s*//", line):
                    faults.append(f"{path.relative_to(ROOT)}:{number}: {len(line)} columns")
    print("\n".join(faults) or f"no comment is wider than {WIDTH} columns")
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
