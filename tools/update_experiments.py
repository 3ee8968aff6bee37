#!/usr/bin/env python3
"""Puts what the commands printed into docs/experiments.md, so that no figure in it is written by hand.

  pickcell experiment table2 --out OUT/table2      (and fig8, fig9, table3 into OUT/NAME)
  tools/update_experiments.py OUT

A block between `<!-- from FILE -->` and `<!-- end -->` becomes the text of OUT/FILE; pictures that the page shows from
images/NAME are copied from OUT/*/NAME. With --check nothing is written: exits 1 when the page differs.
"""
import pathlib
import re
import shutil
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent
PAGES = ("docs/experiments.md", "docs/experiments-misses.md")
BLOCK = re.compile(r"(<!-- from (\S+) -->\n)(.*?)(<!-- end -->)", re.S)
PICTURE = re.compile(r"\]\(images/([^)]+)\)")


def main(arguments):
    check = "--check" in arguments
    folders = [a for a in arguments if a != "--check"]
    if len(folders) != 1 or not pathlib.Path(folders[0]).is_dir():
        sys.exit("update_experiments: name the folder that holds table2/, fig8/, fig9/ and table3/")
    out = pathlib.Path(folders[0])
    stale = []
    for page in PAGES:
        path = ROOT / page
        old = path.read_text()
        new = BLOCK.sub(lambda m: m[1] + "\n" + (out / m[2]).read_text().strip() + "\n\n" + m[4], old)
        if new != old:
            stale.append(page)
            if not check:
                path.write_text(new)
        for name in PICTURE.findall(new):
            found = sorted(out.glob(f"*/{name}"))
            if not check and found:
                shutil.copy(found[0], path.parent / "images" / name)
            elif not found:
                stale.append(f"images/{name}: no experiment wrote it")
    print("\n".join(f"{'differs' if check else 'written'}: {s}" for s in stale) or "nothing to do")
    return 1 if check and stale else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
