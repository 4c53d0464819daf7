#!/usr/bin/env python3
"""Opens a page of `fissure preview --html` in headless Chromium, goes through its frames and looks at what it shows: the number
of the frame, as many fragments as its meshes have objects, and a picture that is not empty.

Usage: check_page.py PAGE MANIFEST [SCREENSHOT]; needs `chromium` and Pillow. MANIFEST is the list beside the meshes of the same run.
"""

import json
import pathlib
import re
import subprocess
import sys
import tempfile

from PIL import Image, ImageChops

FLAGS = ["--headless=new", "--no-sandbox", "--use-angle=swiftshader", "--enable-unsafe-swiftshader",
         "--window-size=1280,800", "--virtual-time-budget=10000"]


def open_page(address, *flags):
    return subprocess.run(["chromium", *FLAGS, *flags, address], capture_output=True, text=True, timeout=120).stdout


def main():
    page, manifest = pathlib.Path(sys.argv[1]).resolve(), json.loads(pathlib.Path(sys.argv[2]).read_text())
    pieces = {f["frame"]: f["pieces"] for f in manifest["files"] if f["part"] == "cracked"}
    facts = json.loads(re.search(r'id="facts">(.*?)</script>', page.read_text()).group(1))
    frames = [frame["number"] for frame in facts["frames"]]
    for number in sorted({frames[0], frames[len(frames) // 2], frames[-1]}):
        address = f"{page.as_uri()}#frame={number}&explode=0.2"
        shown = open_page(address, "--dump-dom")
        assert 'data-ready="true"' in shown, f"frame {number} is not shown"
        found = re.search(r'id="moment">frame (-?\d+) .*? (\d+) fragments? ', shown)
        assert found, f"frame {number}: nothing is said of it"
        assert int(found[1]) == number and int(found[2]) == pieces[number], f"frame {number}: {found[0]}, not {pieces[number]}"
        with tempfile.TemporaryDirectory() as folder:
            picture = pathlib.Path(sys.argv[3]) if len(sys.argv) > 3 else pathlib.Path(folder) / "page.png"
            open_page(address, f"--screenshot={picture}")
            view = Image.open(picture).convert("RGB").crop((0, 40, 940, 700))
            paper = Image.new("RGB", view.size, view.getpixel((0, 0)))
            drawn = ImageChops.difference(view, paper).convert("L").point(bool).histogram()[1] / (view.width * view.height)
            assert drawn > 0.05, f"frame {number}: {drawn:.1%} of the picture is drawn"
        print(f"frame {number}: {pieces[number]} fragments, {drawn:.0%} of the picture drawn")


if __name__ == "__main__":
    main()
