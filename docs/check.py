#!/usr/bin/env python3
"""Checks the Markdown documents of the repository.

- Relative links and anchors resolve.
- No line is longer than 200 characters.
- Types, functions, crates, examples and tests that a document names exist in the sources.

Usage: python3 docs/check.py [ROOT]. Prints each fault as FILE:LINE: reason; exit status 1 if there is one.
"""

import re
import subprocess
import sys
from pathlib import Path

MOST_CHARACTERS = 200
LINK = re.compile(r"(?<!\\)\]\(([^()\s]+)\)")
CODE = re.compile(r"`([^`]+)`")
# Names that are not ours: of other libraries, files and standards.
FOREIGN = {"BVHModelOBBRSS", "DistanceResult", "computeCollisions", "computeDistances", "OrbitControls"}
# The glossary lists names that were replaced below this heading.
FORMER = "## Former names"


def prose(text):
    """Numbered lines outside of fenced blocks."""
    fence = None
    for number, line in enumerate(text.split("\n"), 1):
        mark = re.match(r"\s*(```+|~~~+)", line)
        if mark and (fence is None or mark.group(1).startswith(fence)):
            fence = None if fence else mark.group(1)
        elif fence is None:
            yield number, line


def anchors(text):
    """The anchors that GitHub gives to the headings of a document."""
    found = {}
    for _, line in prose(text):
        heading = re.match(r"#{1,6}\s+(.*?)\s*#*$", line)
        if not heading:
            continue
        title = re.sub(r"\[([^\]]*)\]\([^)]*\)", r"\1", heading.group(1))
        slug = re.sub(r"[^\w\- ]", "", title.replace("`", "").lower()).replace(" ", "-")
        count = found.get(slug, 0)
        found[slug] = count + 1
        if count:
            found[f"{slug}-{count}"] = 1
    return set(found)


def links(file, text, texts):
    for number, line in prose(text):
        for target in LINK.findall(CODE.sub("", line)):
            if re.match(r"[a-z]+:", target):
                continue
            path, _, anchor = target.partition("#")
            aim = (file.parent / path).resolve() if path else file
            if not aim.exists():
                yield number, f"{target} does not exist"
            elif anchor and anchor not in anchors(texts.get(aim, "")):
                yield number, f"{target} has no such heading"


def widths(text):
    for number, line in enumerate(text.split("\n"), 1):
        if len(line) > MOST_CHARACTERS:
            yield number, f"{len(line)} characters, {MOST_CHARACTERS} are allowed"


def sources(root, files):
    """Every word of the Rust and Python sources, and the names of their files and folders."""
    words = set()
    for name in files:
        words.update(re.findall(r"\w+", name))
        if name.endswith((".rs", ".toml", ".py")) and name != "docs/check.py":
            words.update(re.findall(r"\w+", Path(root, name).read_text(encoding="utf-8", errors="replace")))
    return words


def looks_like_rust(code):
    return "::" in code or re.fullmatch(r"[A-Z][a-z]\w*(\.\w+)?(\(.*\))?", code)


def names(text, words, files):
    text, paths = text.split(FORMER)[0], "\n".join(files)
    for number, line in enumerate(text.split("\n"), 1):
        for crate in re.findall(r"-p elbowroom-(\w+)", line):
            if f"crates/{crate}/" not in paths:
                yield number, f"there is no crate {crate}"
        for kind, name in re.findall(r"--(example|test) (\w+)", line):
            if not re.search(rf"/{kind}s/{name}(\.rs|/)", paths):
                yield number, f"there is no {kind} {name}"
    for number, line in prose(text):
        for code in CODE.findall(line):
            if looks_like_rust(code):
                for word in re.findall(r"\b[A-Za-z]\w{2,}", code):
                    if word not in words and word not in FOREIGN:
                        yield number, f"`{code}`: no source has the name {word}"


def check(root):
    listed = subprocess.run(["git", "-C", root, "ls-files"], check=True, capture_output=True, text=True).stdout
    files = [name for name in listed.split("\n") if name and Path(root, name).is_file()]
    words = sources(root, files)
    texts = {Path(root, name).resolve(): Path(root, name).read_text(encoding="utf-8") for name in files if name.endswith(".md")}
    faults = []
    for file, text in texts.items():
        name = file.relative_to(Path(root).resolve())
        found = [*widths(text), *links(file, text, texts), *names(text, words, files)]
        faults += [f"{name}:{number}: {what}" for number, what in sorted(found)]
    return len(texts), faults


if __name__ == "__main__":
    documents, faults = check(sys.argv[1] if len(sys.argv) > 1 else ".")
    print("\n".join(faults) if faults else f"{documents} documents: links, anchors, line widths and names are right")
    sys.exit(1 if faults else 0)
