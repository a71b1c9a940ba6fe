"""Reads what a run wrote, and refuses what is no run with a sentence that says why."""

import json
import math
import pathlib
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent))
import results_file

# A page of more would not open; 10,000 rows of nine repetitions are 54 MiB.
LARGEST_FILE = 128 << 20
MACHINE = ("cpu_name", "num_cpus", "cuda_device")


class BadInput(Exception):
    """What is wrong with a file, for people."""


def read_json(path) -> dict:
    """The object in a file. Throws BadInput naming the file."""
    path = pathlib.Path(path)
    try:
        size = path.stat().st_size
        if size > LARGEST_FILE:
            raise BadInput(f"{path}: its {size >> 20} MiB are more than a page can hold ({LARGEST_FILE >> 20} MiB); "
                           "run the suite in parts (--filter), and report each")
        document = json.loads(path.read_text(encoding="utf-8"))
    except OSError as e:
        raise BadInput(f"{path}: cannot be read: {e.strerror}") from e
    except UnicodeDecodeError as e:
        raise BadInput(f"{path}: no JSON: no UTF-8 at byte {e.start}") from e
    except json.JSONDecodeError as e:
        raise BadInput(f"{path}: no JSON, or cut off: {e.msg} in line {e.lineno}, column {e.colno}") from e
    except RecursionError as e:
        raise BadInput(f"{path}: no run: it is nested too deep") from e
    if not isinstance(document, dict):
        raise BadInput(f"{path}: it is no JSON object")
    return document


class Run:
    """A results.json: its context and its rows, in the order of the run."""

    def __init__(self, path):
        self.path = pathlib.Path(path)
        self.folder = self.path.parent
        document = read_json(path)
        self.context = document.get("context")
        if not isinstance(self.context, dict):
            raise BadInput(f"{path}: not a results file: its 'context' is no object")
        try:
            lists = [document["benchmarks"]] if "format_version" not in document else [document[name] for name in results_file.LISTS]
            names = [row["name"] for rows in lists for row in rows]
            if len(set(names)) != len(names):
                raise BadInput(f"{path}: a row stands there twice")
            self.rows = results_file.rows_of(document)
            for row in self.rows:
                for key in ("scene", "technique", "backend", "status"):
                    row[key] = str(row[key])
        except (KeyError, TypeError, AttributeError) as e:
            raise BadInput(f"{path}: not a results file of this version: {type(e).__name__} {e}") from e

    @property
    def machine(self) -> tuple:
        """Equal for runs whose times may stand in one plot."""
        return tuple(str(self.context.get(key, "")) for key in MACHINE)

    @property
    def machine_text(self) -> str:
        name, cores, device = self.machine
        text = f"{cores} cores of {name}" if cores else name or "unknown machine"
        return f"{text}, {device}" if device else text

    @property
    def date(self) -> str:
        return str(self.context.get("date", ""))

    @property
    def commit(self) -> str:
        return str(self.context.get("commit", "unknown"))[:10]


def number(value):
    """A finite number, or None."""
    if isinstance(value, bool) or not isinstance(value, (int, float)):
        return None
    return value if math.isfinite(value) else None


def mapping(value) -> dict:
    return value if isinstance(value, dict) else {}


def listing(value) -> list:
    return value if isinstance(value, list) else []


def within(folder: pathlib.Path, stem) -> pathlib.Path | None:
    """A path below the folder, or None: a file that people pass on may name any."""
    path = pathlib.PurePosixPath(str(stem))
    return None if path.is_absolute() or ".." in path.parts or "\0" in str(stem) else folder / path
