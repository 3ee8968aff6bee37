#!/usr/bin/env python3
"""Keeps the house's layers: who may include whom, which third-party header may appear where, and no cycles of files.

The table is the one of docs/architecture.md. Run from anywhere; exits 1 and names every breach.
"""
import pathlib
import re
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent

MATCH = "pickcell/matches/match.hpp"
MODEL = "pickcell/matches/model.hpp"
PART_POSE = "pickcell/poses/part_pose.hpp"
PICK = "pickcell/picks/pick.hpp"
FRAME = "pickcell/frames/frame.hpp"

# module -> (whole modules it may include, single headers it may include beyond them)
LAYERS = {
    "core": ((), ()),
    "image": (("core",), ()),
    "frames": (("core", "image"), ()),
    "matches": (("core", "image"), ()),
    "poses": (("core", "image"), (MATCH, MODEL)),
    "picks": (("core",), (PART_POSE,)),
    "robot": (("core",), (PICK,)),
    "cell": (("core", "image", "frames", "matches", "poses", "picks", "robot"), ()),
    "sim": (("core", "image", "frames"), ("pickcell/robot/*_codec.hpp",)),
    "server": (("core", "image", "cell"), (FRAME, MATCH, PART_POSE, PICK)),
    "cli": (("core", "image", "frames", "matches", "poses", "picks", "robot", "cell", "sim", "server"), ()),
}

# folder within a module -> folders beside it that it may include; what lies in the module itself serves all of them
FOLDERS = {
    "matches": {
        "fields": (), "coarse": ("fields",), "fit": ("fields",), "learn": ("fields", "fit"),
        "best": ("fields", "coarse", "fit"), "rst": ("fields", "coarse", "fit", "best"),
    },
}

# third-party header pattern -> modules that may use it in .cpp files
THIRD_PARTY = {
    r"nlohmann/": ("core",), r"toml\+\+": ("core",),
    r"hwy/": ("image", "matches"), r"png\.h|jpeglib\.h": ("image",),
    r"opencv2/": ("poses", "sim", "cli"), r"ceres/": ("poses",),
    r"sqlite3\.h": ("cell",), r"boost/asio": ("robot", "sim", "server"), r"boost/beast": ("server",),
    r"zlib\.h": ("server",), r"CLI/": ("cli",), r"arv\.h|arv": ("frames", "sim"), r"linux/videodev2\.h": ("frames",),
}
IN_HEADERS = re.compile(r"^(Eigen/|tl/expected\.hpp)")
INCLUDE = re.compile(r'^\s*#\s*include\s*([<"])([^>"]+)[>"]', re.M)


def allowed(module, header):
    if header.split("/")[1] == module:
        return True
    modules, singles = LAYERS[module]
    return header.split("/")[1] in modules or any(pathlib.PurePath(header).match(s) for s in singles)


def allowed_within(path, header):
    """Of a header of the same module: by the table of its folders, tests excepted."""
    folders = FOLDERS.get(path.parts[1])
    target = pathlib.PurePath(header).parts
    if folders is None or len(path.parts) < 4 or len(target) < 4 or target[1] != path.parts[1]:
        return True
    here, there = path.parts[2], target[2]
    return here == there or there in folders.get(here, ())


def breaches_of(path, graph):
    module = path.parts[1]
    is_test = path.stem.endswith("_test") or path.stem.endswith("_fuzz")
    found = []
    for kind, header in INCLUDE.findall((ROOT / path).read_text()):
        if header.startswith("pickcell/"):
            if not (ROOT / header).exists():
                found.append(f"{path}: includes {header}, which does not exist")
                continue
            graph.setdefault(str(path), []).append(header)
            if not allowed(module, header):
                found.append(f"{path}: {module} may not include {header}")
            elif not is_test and not allowed_within(path, header):
                found.append(f"{path}: {'/'.join(path.parts[1:3])} may not include {header}")
        elif kind == '"':
            found.append(f"{path}: \"{header}\": project headers are included by their path from the root (pickcell/...)")
        else:
            for pattern, modules in THIRD_PARTY.items():
                if not re.match(pattern, header) or is_test:
                    continue
                if module not in modules:
                    found.append(f"{path}: {module} may not use <{header}>")
                elif path.suffix == ".hpp" and not IN_HEADERS.match(header) and not path.stem.endswith("-inl"):
                    found.append(f"{path}: <{header}> belongs in a .cpp file")
    return found


def cycles(graph):
    state, found = {}, []

    def visit(node, trail):
        state[node] = "open"
        for to in graph.get(node, ()):
            if state.get(to) == "open":
                found.append("cycle: " + " -> ".join(trail[trail.index(to):] + [to] if to in trail else trail + [to]))
            elif to not in state:
                visit(to, trail + [to])
        state[node] = "done"

    for node in sorted(graph):
        if node not in state:
            visit(node, [node])
    return found


def main():
    graph, found = {}, []
    files = sorted(p.relative_to(ROOT) for s in ("*.hpp", "*.cpp") for p in (ROOT / "pickcell").rglob(s))
    for path in files:
        if path.parts[1] not in LAYERS:
            found.append(f"{path}: no such module in the table of layers")
            continue
        found += breaches_of(path, graph)
    found += cycles(graph)
    print("\n".join(found) if found else f"layers: {len(files)} files, no breach")
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
