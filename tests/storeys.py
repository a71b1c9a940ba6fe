#!/usr/bin/env python3
"""Reads every #include of our own files against the table "Who may know whom" of docs/design.md.

    tests/storeys.py [--root DIR]        exit 1, and one line for every include that points the wrong way
"""
import argparse
import pathlib
import re
import sys

SUFFIXES = {".h", ".cpp", ".cu"}
FOLDERS = ["scenes", "techniques", "cuda", "harness"]
INCLUDE = re.compile(r'^\s*#\s*include\s*"([^"]+)"', re.MULTILINE)


def read_table(text):
    """The rooms, each with those that it may know."""
    section = text.split("## Who may know whom", 1)[1].split("\n## ", 1)[0]
    may_know = {}
    for line in section.splitlines():
        cells = [cell.strip() for cell in line.strip("|").split("|")]
        if line.startswith("| `") and len(cells) == 3:
            may_know[cells[0].strip("`")] = set(re.findall(r"`([^`]+)`", cells[2]))
    unknown = set().union(*may_know.values()) - may_know.keys() if may_know else set()
    if not may_know or unknown:
        sys.exit(f"storeys: docs/design.md: no table, or rooms that it does not list: {sorted(unknown)}")
    return may_know


def room_of(path, rooms):
    """The longest room that the path begins with, and the folder it stands for; None outside of all rooms."""
    found = [(len(room.split("/")), room) for room in rooms if path.startswith(room)]
    family = "/".join(path.split("/")[:2]) + "/"
    for room in rooms:
        if room.endswith("*/") and path.startswith(room[:-2]) and path.count("/") >= 2:
            if family not in rooms:
                return room, family
    return (max(found)[1],) * 2 if found else None


def wrong_includes(root, may_know):
    """(file, line, included, why) of every include that points the wrong way."""
    for folder in FOLDERS:
        for file in sorted((root / folder).rglob("*")):
            if file.suffix not in SUFFIXES:
                continue
            name, text = file.relative_to(root).as_posix(), file.read_text()
            room = room_of(name, may_know)
            for match in INCLUDE.finditer(text):
                included, line = match[1], text.count("\n", 0, match.start(1)) + 1
                if included.startswith("generated/"):
                    continue
                other = room_of(included, may_know)
                if other is None or room is None:
                    yield name, line, included, "lies in no room of docs/design.md"
                elif other != room and not (other[0] in may_know[room[0]] and other[0] != room[0]):
                    yield name, line, included, f"{room[1]} may not know {other[1]}"


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--root", type=pathlib.Path, default=pathlib.Path(__file__).resolve().parent.parent)
    root = parser.parse_args().root
    wrong = list(wrong_includes(root, read_table((root / "docs/design.md").read_text())))
    for name, line, included, why in wrong:
        print(f'{name}:{line}: includes "{included}": {why}', file=sys.stderr)
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
