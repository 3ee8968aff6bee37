#!/usr/bin/env python3
"""Instructions of the board's pickcell per picture and stage, counted by qemu-user, and the times estimated from them.

count_instructions.py SET [--pictures N] [--native PROGRAM] [--board PROGRAM]    SET in bench's format

Models are taught by the native program. A picture's count is that of a run over it three times less that of a run over it
once, halved: start, loading and deriving from the model drop out. Pictures are handed over undecoded (PGM).
Needs ./check --preset arm64 to have run (the programs, qemu-user, g++). Prints a table for docs/matching.md.
"""
import argparse
import json
import pathlib
import re
import statistics
import subprocess
import sys
import tempfile
import zlib

STAGES = (  # the first pattern found in a function's name decides
    (None, r"image::formats::"),  # a camera's pictures need no decoding
    ("pyramid", r"image::(\(anonymous namespace\)::)?(Pyramid|halve)"),
    ("coarse field", r"sum_tensors|build_coarse_scene|share_out"),
    ("coarse search", r"best_of_four|each_of_four|CoarseSearch|CellBlock"),
    ("edge fields", r"LazyField|tensor_row|orientation_field|field_part|smooth_down"),
    ("contour fit", r"find_edges|make_lines|sum_lines|line_residuals|fit_contours|FullPivLU<Eigen::Matrix<double, 5"),
    ("grey fit and scores", r"pickcell::matches|Eigen::"),
)
CORES = {  # qemu's name: what it stands for, GHz, instructions a cycle (lower and upper guess)
    "cortex-a57": ("Cortex-A57", 2.0, 1.0, 1.5),
    "max": ("with dot product, as an Orin's A78AE", 2.2, 2.0, 3.0),
}


def stop(why):
    sys.exit(f"count_instructions: {why}")


def run(*words):
    done = subprocess.run([str(w) for w in words], capture_output=True, text=True)
    if done.returncode not in (0, 1) or done.stderr:
        stop(f"{' '.join(map(str, words))}: exit {done.returncode}: {done.stderr}")


def grey_png(path):
    """Width, height and pixels of a PNG of 8-bit grey without interlace."""
    data, at, packed = path.read_bytes(), 8, b""
    while at + 8 <= len(data):
        size, kind = int.from_bytes(data[at:at + 4], "big"), data[at + 4:at + 8]
        body = data[at + 8:at + 8 + size]
        if kind == b"IHDR":
            width, height = int.from_bytes(body[:4], "big"), int.from_bytes(body[4:8], "big")
            if body[8:13] != b"\x08\x00\x00\x00\x00":
                stop(f"{path} is no PNG of 8-bit grey")
        packed += body if kind == b"IDAT" else b""
        at += size + 12
    raw, out, above = zlib.decompress(packed), bytearray(), bytearray(width)
    for y in range(height):
        kind, line = raw[y * (width + 1)], bytearray(raw[y * (width + 1) + 1:(y + 1) * (width + 1)])
        for x in range(width):
            a, b, c = line[x - 1] if x else 0, above[x], above[x - 1] if x else 0
            paeth = min((abs(b - c), 0, a), (abs(a - c), 1, b), (abs(a + b - 2 * c), 2, c))[2]
            line[x] = (line[x] + (0, a, b, (a + b) // 2, paeth)[kind]) & 255
        out, above = out + line, line
    return width, height, bytes(out)


def stage_of(symbol):
    return next((name for name, pattern in STAGES if re.search(pattern, symbol)), "the rest")


def counted(qemu, board, words, where):
    """Instructions by stage of one run."""
    run(*qemu, board, *words)
    lines = subprocess.run(["c++filt"], input=where.read_text(), capture_output=True, text=True, check=True).stdout
    sums = {}
    for line in lines.splitlines():
        count, symbol = line.split(" ", 1)
        if (stage := stage_of(symbol)) is not None:
            sums[stage] = sums.get(stage, 0) + int(count)
    return sums


def main():
    words = argparse.ArgumentParser(description="Instructions per picture and stage on a board, counted by qemu.")
    words.add_argument("set", type=pathlib.Path)
    words.add_argument("--pictures", type=int, default=15)
    words.add_argument("--native", default="build/dev/pickcell")
    words.add_argument("--board", default="build/arm64/pickcell")
    options = words.parse_args()
    truth = json.loads((options.set / "truth.json").read_text())
    templates = {t["id"]: t for t in truth["templates"]}
    chosen = truth["images"][::max(1, len(truth["images"]) // options.pictures)][:options.pictures]
    table, totals = {core: {} for core in CORES}, {core: [] for core in CORES}
    with tempfile.TemporaryDirectory() as scratch:
        where = pathlib.Path(scratch)
        plugin, counts, model, picture = (where / name for name in ("count.so", "counts", "part.pcm", "picture.pgm"))
        run("g++", "-std=c++20", "-O2", "-shared", "-fPIC", "-o", plugin, pathlib.Path(__file__).parent / "qemu_count.cpp")
        for image in chosen:
            part = templates[image["template"]]
            mask = ["--mask", options.set / part["mask"]] if part.get("mask") else []
            run(options.native, "teach", options.set / part["file"], "-o", model, "--scale", "0.9,1.1", *mask, "--json")
            width, height, pixels = grey_png(options.set / image["file"])
            picture.write_bytes(b"P5\n%d %d\n255\n" % (width, height) + pixels)
            for core, sums in table.items():
                qemu = ["qemu-aarch64", "-cpu", core, "-d", "plugin", "-D", "/dev/null", "-plugin", f"{plugin},out={counts}"]
                once, thrice = (counted(qemu, options.board, ["match", model, *[picture] * n, "--threads", 1, "--json"],
                                        counts) for n in (1, 3))
                own = {stage: (thrice[stage] - once.get(stage, 0)) / 2e6 for stage in thrice}
                totals[core].append(sum(own.values()))
                for stage, count in own.items():
                    sums[stage] = sums.get(stage, 0) + count / len(chosen)
    print(f"million instructions per picture, mean of {len(chosen)} of {options.set.name}\n")
    print("| stage | " + " | ".join(CORES[core][0] for core in table) + " |\n|---|" + "---|" * len(table))
    for stage in [name for name, _ in STAGES if name] + ["the rest"]:
        print(f"| {stage} | " + " | ".join(f"{sums.get(stage, 0):.1f}" for sums in table.values()) + " |")
    for name, over in (("all", statistics.mean), ("all, median picture", statistics.median)):
        print(f"| {name} | " + " | ".join(f"{over(own):.1f}" for own in totals.values()) + " |")
    print()
    for core, (name, ghz, low, high) in CORES.items():
        mean, median = (over(totals[core]) / ghz for over in (statistics.mean, statistics.median))  # ms at one a cycle
        print(f"estimate, {name}: mean {mean / high:.1f} to {mean / low:.1f} ms, median {median / high:.1f} to "
              f"{median / low:.1f} ms ({ghz} GHz, {low} to {high} instructions a cycle)")


if __name__ == "__main__":
    main()
