"""Runs the example of docs/other-renderers.md as the page says: export, the renderer in Python, score, a suite.

    .venv/bin/python scripts/check_renderer_example.py     # exit 1 if it does not do what the page says
"""

import json
import pathlib
import re
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parent.parent
PROGRAM = ROOT / "build" / "release" / "penumbra"
MOST_ERROR = 0.02  # relative RMSE that the page promises


def blocks(language: str) -> list[str]:
    page = (ROOT / "docs" / "other-renderers.md").read_text()
    return re.findall(rf"```{language}\n(.*?)```", page, re.DOTALL)


def run(folder: pathlib.Path, *command: object) -> str:
    return subprocess.run([str(word) for word in command], cwd=folder, check=True, capture_output=True, text=True).stdout


def main() -> int:
    (renderer,) = blocks("python")
    scene, suite = blocks("toml")
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        (folder / "renderer.py").write_text(renderer)
        (folder / "my-scene.toml").write_text(scene)
        (folder / "my-suite.toml").write_text(suite.replace("python3", sys.executable))
        run(folder, PROGRAM, "export", "my-scene.toml", "-o", "exported")
        printed = run(folder, sys.executable, "renderer.py", "exported", "mine.pfm")
        row = json.loads(run(folder, PROGRAM, "score", "my-scene.toml", "mine.pfm", "--json", "--out", "out"))
        run(folder, PROGRAM, "run", "my-suite.toml", "--out", "suite")
        rows = json.loads((folder / "suite" / "results.json").read_text())["benchmarks"]
    measured = next(r for r in rows if r["backend"] == "external")
    error = row["errors"]["truth"]["rel_rmse"]
    print(f"scored: {100 * error:.3f} % of error; in the suite {measured['frame_ms']:.0f} ms of "
          f"{measured['command_ms']:.0f} ms, {100 * measured['errors']['truth']['rel_rmse']:.3f} % of error")
    good = (error < MOST_ERROR and measured["errors"] == row["errors"] and printed.startswith("time_ms: ")
            and 0 < measured["frame_ms"] < measured["command_ms"] and row["frame_ms"] is None)
    return 0 if good else 1


if __name__ == "__main__":
    sys.exit(main())
