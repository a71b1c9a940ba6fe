"""Runs the example of docs/other-renderers.md as the page says: export, the renderer in Python, score, a suite.
Then docs/ci.md: the renderer against a copy of itself whose shadows are gone.

    .venv/bin/python scripts/check_renderer_example.py     # exit 1 if it does not do what the page says
"""

import json
import pathlib
import re
import subprocess
import sys
import tempfile

import results_file

ROOT = pathlib.Path(__file__).resolve().parent.parent
PROGRAM = ROOT / "build" / "release" / "penumbra"
MOST_ERROR = 0.02  # relative RMSE that the page promises


def blocks(language: str) -> list[str]:
    page = (ROOT / "docs" / "other-renderers.md").read_text()
    return re.findall(rf"```{language}\n(.*?)```", page, re.DOTALL)


def run(folder: pathlib.Path, *command: object) -> str:
    return subprocess.run([str(word) for word in command], cwd=folder, check=True, capture_output=True, text=True).stdout


def notices_a_wrong_shadow(folder: pathlib.Path) -> bool:
    """Does scripts/compare_suites.sh tell a renderer without shadows from the one that it was?"""
    wrong = folder / "wrong"
    wrong.mkdir()
    for file in ("my-scene.toml", "my-suite.toml"):
        (wrong / file).write_text((folder / file).read_text())
    renderer = (folder / "renderer.py").read_text()
    (wrong / "renderer.py").write_text(re.sub(r"return ~np.any\(.*", "return np.ones(len(ray), bool)", renderer))
    command = [ROOT / "scripts/compare_suites.sh", folder / "my-suite.toml", wrong / "my-suite.toml", folder / "compared"]
    done = subprocess.run([str(word) for word in command], capture_output=True, text=True)
    told = [line for line in done.stdout.splitlines() if "brute-force" in line]
    print(f"without shadows: exit code {done.returncode}, {told[0] if told else done.stdout + done.stderr}")
    pictures = list((folder / "compared/changed").glob("*brute-force*.png"))
    return done.returncode == 1 and bool(told) and "WORSE" in told[0] and len(pictures) == 1


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
        rows = results_file.read_rows(folder / "suite")
        noticed = notices_a_wrong_shadow(folder)
    measured = next(r for r in rows if r["backend"] == "external")
    error = row["errors"]["truth"]["rel_rmse"]
    print(f"scored: {100 * error:.3f} % of error; in the suite {measured['frame_ms']:.0f} ms of "
          f"{measured['command_ms']:.0f} ms, {100 * measured['errors']['truth']['rel_rmse']:.3f} % of error")
    good = (error < MOST_ERROR and measured["errors"] == row["errors"] and printed.startswith("time_ms: ")
            and 0 < measured["frame_ms"] < measured["command_ms"] and row["frame_ms"] is None)
    return 0 if good and noticed else 1


if __name__ == "__main__":
    sys.exit(main())
