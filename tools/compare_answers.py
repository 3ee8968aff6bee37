#!/usr/bin/env python3
"""Whether two builds of pickcell give the same answers on a set of pictures (bench's format): ./check --preset arm64.

compare_answers.py SET PROGRAM OTHER... [--every N]   where OTHER is a program with its words in front, one argument each:
    'qemu-aarch64 -cpu max build/arm64/pickcell'
With --every only each N-th picture of the set is searched.
Models are taught by PROGRAM and read by all; each other program also teaches one part itself. Exits 1 unless every
place agrees within 0.01 px, every angle within 0.01 degrees and every scale within 0.0001.
"""
import argparse
import json
import pathlib
import subprocess
import sys
import tempfile

PIXELS, DEGREES, SCALE = 0.01, 0.01, 0.0001


def run(program, *words):
    done = subprocess.run([*program, *map(str, words)], capture_output=True, text=True)
    if done.returncode not in (0, 1) or done.stderr:
        sys.exit(f"compare_answers: {' '.join(program)} {' '.join(map(str, words))}: exit {done.returncode}: {done.stderr}")
    return [json.loads(line) for line in done.stdout.splitlines()]


def turn(a, b):
    return abs((a - b + 180) % 360 - 180)


class Worst:
    def __init__(self):
        self.pixels = self.degrees = self.scale = self.score = 0.0
        self.matches, self.breaches = 0, []

    def add(self, image, ours, theirs):
        if len(ours) != len(theirs):
            self.breaches.append(f"{image}: {len(ours)} and {len(theirs)} matches")
        for a, b in zip(ours, theirs):
            px = ((a["x_px"] - b["x_px"]) ** 2 + (a["y_px"] - b["y_px"]) ** 2) ** 0.5
            deg, scale = turn(a["angle_deg"], b["angle_deg"]), abs(a["scale"] - b["scale"])
            self.matches += 1
            self.pixels, self.degrees = max(self.pixels, px), max(self.degrees, deg)
            self.scale, self.score = max(self.scale, scale), max(self.score, abs(a["score"] - b["score"]))
            if px > PIXELS or deg > DEGREES or scale > SCALE:
                self.breaches.append(f"{image}: {px:.4f} px, {deg:.4f} degrees, scale {scale:.5f} apart")


def teach(program, template, folder, scale, where):
    model = where / (template["id"].replace("/", "_") + ".pcm")
    mask = ["--mask", folder / template["mask"]] if template.get("mask") else []
    run(program, "teach", folder / template["file"], "-o", model, "--scale", scale, *mask, "--json")
    return model


def main():
    words = argparse.ArgumentParser(description="Whether builds of pickcell give the same answers on a set.")
    words.add_argument("set", type=pathlib.Path)
    words.add_argument("program")
    words.add_argument("others", nargs="+", metavar="OTHER")
    words.add_argument("--every", type=int, default=1)
    options = words.parse_args()
    folder, ours = options.set, [options.program]
    others = [other.split() for other in options.others]
    truth = json.loads((folder / "truth.json").read_text())
    images = truth["images"][::options.every]
    scale = ",".join(map(str, truth.get("scale_range", (0.9, 1.1))))
    templates = {t["id"]: t for t in truth["templates"]}
    failed = False
    with tempfile.TemporaryDirectory() as scratch:
        where = pathlib.Path(scratch)
        used = list(dict.fromkeys(image["template"] for image in images))
        models = {name: teach(ours, templates[name], folder, scale, where) for name in used}
        searches = [(models[i["template"]], folder / i["file"], 20 if "instances" in i else 1) for i in images]
        answers = [run(ours, "match", m, i, "--max", n, "--threads", 1, "--json")[0] for m, i, n in searches]
        for other in others:
            (where / "own").mkdir(exist_ok=True)
            own = teach(other, templates[used[0]], folder, scale, where / "own")
            worst = Worst()
            for number, (model, image, count) in enumerate(searches):
                # The part that the other program taught itself must be found alike.
                model = own if model == models[used[0]] else model
                said = run(other, "match", model, image, "--max", count, "--threads", 1, "--json")[0]
                worst.add(image.name, answers[number]["matches"], said["matches"])
            print(f"{' '.join(other)}: {len(searches)} pictures, {worst.matches} matches: at most {worst.pixels:.6f} px, "
                  f"{worst.degrees:.6f} degrees, scale {worst.scale:.7f}, score {worst.score:.6f} apart")
            for breach in worst.breaches:
                print(f"  {breach}")
            failed = failed or bool(worst.breaches) or worst.matches == 0
    sys.exit(failed)


if __name__ == "__main__":
    main()
