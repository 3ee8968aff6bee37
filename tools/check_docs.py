#!/usr/bin/env python3
"""Keeps the words whole: what sources and pages name in docs/ exists, links lead somewhere, every page can be reached.

Checked are: each `docs/PAGE` named anywhere in the repository, with the section numbers behind it; each relative link of
each *.md, with its #anchor, and each path such as `tests/cell` in it; that README.md leads to every page of docs/ and something
names every other file there; that docs/architecture.md names every folder of pickcell/ and tests/, HACKING.md every label of a
test, and neither one that is not there.
Run from anywhere; exits 1 and names every breach.
"""
import pathlib
import re
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent
SKIPPED = re.compile(r"^(tools/check_docs\.py$|hmi/(dist|test/fixtures)/|hmi/package-lock\.json$|tests/fuzz/seeds/)")
TEXT = {".hpp", ".cpp", ".md", ".py", ".sh", ".cmake", ".txt", ".ts", ".tsx", ".mjs", ".css", ".json", ".toml", ".JBI", ""}

NAMED = re.compile(r"(?<![\w.-]/)(?<![\w-])docs/([\w./-]*\w)")
PATH = re.compile(r"(?<![\w./-])((?:bench|cmake|hmi|pickcell|tests|tools)/[\w./*-]*\w)")
NUMBER = r"\d+(?:\.\d+)?"
SECTIONS = re.compile(rf"^,? ?\(?(?:sections? )?({NUMBER}(?:(?:, | and |-){NUMBER})*)(?![\w.]*\w)")
COMMENT = re.compile(r"\n[ \t]*(?://[/!]?<?|#|\*)?[ \t]*")
FENCE = re.compile(r"^(```|~~~).*?^\1[^\n]*$", re.M | re.S)
LINK = re.compile(r"\]\(\s*<?([^)\s>]+)>?(?:\s+\"[^\"]*\")?\s*\)")
HEADING = re.compile(r"^#{1,6}\s+(.*?)\s*#*$", re.M)


def files():
    """Every text file of the repository, new ones too."""
    out = subprocess.run(["git", "ls-files", "-co", "--exclude-standard", "-z"], cwd=ROOT, check=True, capture_output=True)
    names = sorted(n for n in out.stdout.decode().split("\0") if n and not SKIPPED.match(n))
    return [pathlib.PurePosixPath(n) for n in names if (ROOT / n).is_file()]


def headings(text):
    return HEADING.findall(FENCE.sub("", text))


def anchors(text):
    """The #names of a page's headings, as GitHub makes them."""
    found = set()
    for heading in headings(text):
        plain = re.sub(r"\[([^\]]*)\]\([^)]*\)", r"\1", heading).lower()
        slug = re.sub(r"[^\w\- ]", "", plain).replace(" ", "-")
        name, n = slug, 0
        while name in found:
            n += 1
            name = f"{slug}-{n}"
        found.add(name)
    return found


def section_numbers(text):
    return {m.group(1) for h in headings(text) if (m := re.match(rf"({NUMBER})\.?\s", h))}


def page_of(name):
    """The file that `docs/NAME` means; pages may be named without their ending."""
    for candidate in (f"docs/{name}", f"docs/{name}.md"):
        if (ROOT / candidate).exists():
            return candidate
    return None


def check_names(path, text, texts, named):
    found = []
    flat = COMMENT.sub(" ", text)
    for match in NAMED.finditer(flat):
        page = page_of(match.group(1))
        if page is None:
            found.append(f"{path}: names docs/{match.group(1)}, which does not exist")
            continue
        named.add(page)
        known = section_numbers(texts.get(page, ""))
        cited = SECTIONS.match(flat[match.end():match.end() + 80]) if known else None
        for number in re.findall(NUMBER, cited.group(1)) if cited else ():
            if number not in known:
                found.append(f"{path}: names section {number} of {page}, which has none")
    return found


def check_links(path, text, texts, named, links):
    found = []
    prose = re.sub(r"`[^`\n]*`", "", FENCE.sub("", text))
    for target in LINK.findall(prose):
        if re.match(r"[a-z][a-z0-9+.-]*:", target):
            continue
        file, _, anchor = target.partition("#")
        full = (ROOT / path.parent / file).resolve() if file else ROOT / path
        if not full.exists() or ROOT not in (full, *full.parents):
            found.append(f"{path}: links to {target}, which does not exist")
            continue
        inside = full.relative_to(ROOT).as_posix()
        named.add(inside)
        links.setdefault(str(path), set()).add(inside)
        if anchor and inside.endswith(".md") and anchor not in anchors(texts.get(inside, "")):
            found.append(f"{path}: links to {target}, but {inside} has no such heading")
    return found


def check_paths(path, text):
    return [f"{path}: names {name}, which does not exist" for name in PATH.findall(text) if not any(ROOT.glob(name))]


def check_reached(all_files, named, links):
    reached, open_pages = {"README.md"}, ["README.md"]
    while open_pages:
        for page in links.get(open_pages.pop(), ()):
            if page not in reached:
                reached.add(page)
                open_pages.append(page)
    found = []
    for path in map(str, all_files):
        if not path.startswith("docs/"):
            continue
        if path.endswith(".md") and path not in reached:
            found.append(f"{path}: no link leads here from README.md")
        elif not path.endswith(".md") and path not in named:
            found.append(f"{path}: nothing names it")
    return found


def rows(text):
    """What stands in the first column of a page's tables, in backquotes."""
    return set(re.findall(r"^\| `([\w/]+)` \|", text, re.M))


def check_house(texts):
    """Folders and labels come and go with code; their tables must follow."""
    house = rows(texts["docs/architecture.md"])
    folders = {p.name for p in (ROOT / "tests").iterdir() if (p / "CMakeLists.txt").exists()}
    folders |= {f"pickcell/{p.name}" for p in (ROOT / "pickcell").iterdir() if p.is_dir()}
    folders |= {f"matches/{p.name}" for p in (ROOT / "pickcell/matches").iterdir() if p.is_dir()}
    cmake = "".join(t for p, t in texts.items() if p.endswith(("CMakeLists.txt", ".cmake")))
    labels, told = set(re.findall(r"\bLABELS? ([a-z]+)\b", cmake)), rows(texts["HACKING.md"])
    return (
        [f"docs/architecture.md: does not name the folder {f}" for f in sorted(folders - house)]
        + [f"docs/architecture.md: names the folder {f}, which does not exist" for f in sorted(house - folders)]
        + [f"HACKING.md: does not name the label {x}" for x in sorted(labels - told)]
        + [f"HACKING.md: names the label {x}, which no test carries" for x in sorted(told - labels)]
    )


def main():
    all_files = files()
    texts = {str(p): (ROOT / p).read_text(errors="replace") for p in all_files if p.suffix in TEXT}
    found, named, links = [], set(), {}
    for path in all_files:
        text = texts.get(str(path))
        if text is None:
            continue
        found += check_names(path, text, texts, named)
        if path.suffix == ".md":
            found += check_links(path, text, texts, named, links) + check_paths(path, text)
    found += check_reached(all_files, named, links) + check_house(texts)
    pages = sum(1 for p in all_files if p.suffix == ".md")
    print("\n".join(found) if found else f"docs: {pages} pages, no breach")
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
