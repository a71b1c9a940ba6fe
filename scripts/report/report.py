"""One offline page of a run, and its plots and tables for a paper. `penumbra report` calls this with the figures that it derives.

    .venv/bin/python scripts/report/report.py --results DIR/results.json --figures FIGURES.json --out DIR/report.html
        [--base BASE/results.json --comparison COMPARISON.json] [--history RESULTS.json ...] [--paper FOLDER]
"""

import argparse
import os
import pathlib
import sys

import page
from load import BadInput, Run, read_json

FIGURES_VERSION = 1


def read_figures(path) -> dict:
    figures = read_json(path)
    if figures.get("format_version") != FIGURES_VERSION:
        raise BadInput(f"{path}: its format_version is not {FIGURES_VERSION}: it is of another version of penumbra")
    return figures


def write(path: pathlib.Path, text: str) -> None:
    """Whole or not at all, where a link leads; into what is no file, a pipe or a device, as it is."""
    path = path.resolve()
    path.parent.mkdir(parents=True, exist_ok=True)
    if path.exists() and not path.is_file():
        path.write_text(text, encoding="utf-8")
        return
    unfinished = path.with_name(path.name + ".unfinished")
    unfinished.write_text(text, encoding="utf-8")
    os.replace(unfinished, path)


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--results", required=True)
    parser.add_argument("--figures", required=True)
    parser.add_argument("--out", required=True)
    parser.add_argument("--base", help="results.json that the run is compared with")
    parser.add_argument("--comparison", help="what `penumbra compare BASE NEW --json` printed")
    parser.add_argument("--history", nargs="+", default=[], help="results.json of other runs")
    parser.add_argument("--paper", help="folder for SVG, PDF and LaTeX")
    options = parser.parse_args()
    if bool(options.base) != bool(options.comparison):
        parser.error("--base and --comparison belong together")
    try:
        run, figures = Run(options.results), read_figures(options.figures)
        base = Run(options.base) if options.base else None
        comparison = read_json(options.comparison) if options.comparison else None
        text = page.build(run, figures, base, comparison, [Run(path) for path in options.history])
        write(pathlib.Path(options.out), text)
        if options.paper:
            import paper
            paper.write(run, figures, pathlib.Path(options.paper))
    except BadInput as e:
        print(f"report: {e}", file=sys.stderr)
        return 2
    except OSError as e:
        print(f"report: {e.filename or options.out}: {e.strerror}", file=sys.stderr)
        return 2
    return 0


if __name__ == "__main__":
    sys.exit(main())
