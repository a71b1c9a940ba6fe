#!/usr/bin/env python3
"""What the scripts of docs/ci.md do around penumbra and gh, which are stubs here. Nothing is built or measured."""
import json
import os
import pathlib
import subprocess
import sys
import tempfile
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[1]
sys.path.insert(0, str(ROOT / "scripts"))
import comment  # noqa: E402
import gate_trial  # noqa: E402

# Of a suite `NAME-CODE.toml`: writes a results.json unless NAME is "nothing", and ends with CODE.
PENUMBRA = """#!/usr/bin/env bash
if [ "$1" = run ]; then
  name="$(basename "$2" .toml)"
  mkdir -p "$4"
  [ "${name%-*}" = nothing ] || echo "$2" >"$4/results.json"
  exit "${name##*-}"
fi
echo "compared $(cat "$2/results.json") $(cat "$3/results.json") ${*:4}"
exit 3
"""

# Keeps what it was called with; its comments are in comments.json, and it refuses to write where `denied` is.
GH = """#!/usr/bin/env python3
import json, pathlib, sys
folder = pathlib.Path(__file__).parent
words = sys.argv[2:]
if "--method" in words:
    if (folder / "denied").exists():
        sys.exit("HTTP 403: Resource not accessible\\n100% of it")
    (folder / "written.json").write_text(json.dumps({"words": words, "body": json.load(sys.stdin)["body"]}))
else:
    (folder / "listed.json").write_text(json.dumps(words))
    print((folder / "ours").read_text() if (folder / "ours").exists() else "", end="")
"""


class InAFolder(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)

    def program(self, name, text):
        path = self.folder / name
        path.write_text(text)
        path.chmod(0o755)
        return path


class CompareSuites(InAFolder):
    def compare(self, base, new, *options):
        stub = self.program("penumbra", PENUMBRA)
        done = subprocess.run([ROOT / "scripts/compare_suites.sh", base, new, self.folder / "out", *options],
                              capture_output=True, text=True, env={**os.environ, "PENUMBRA": str(stub)})
        return done.returncode, done.stdout

    def test_both_are_measured_and_compared_with_the_exit_code_of_compare(self):
        out = self.folder / "out/changed"
        self.assertEqual(self.compare("base-0.toml", "new-0.toml", "--fail-error", "2%"),
                         (3, f"compared base-0.toml new-0.toml --markdown --pictures {out} --fail-error 2%\n"))

    def test_a_failed_row_is_for_compare_to_tell(self):
        self.assertEqual(self.compare("base-1.toml", "new-1.toml")[0], 3)

    def test_what_could_not_be_measured_is_not_compared(self):
        for base, new, code in (("nothing-2", "new-0", 2), ("base-0", "nothing-2", 2), ("nothing-1", "new-0", 2),
                                ("base-0", "nothing-0", 2), ("base-130", "new-0", 130), ("base-0", "new-139", 139)):
            self.assertEqual(self.compare(f"{base}.toml", f"{new}.toml"), (code, ""), (base, new))

    def test_results_of_an_earlier_run_do_not_stand_in(self):
        self.assertEqual(self.compare("base-0.toml", "new-0.toml")[0], 3)
        picture = self.folder / "out/changed/row.png"
        picture.parent.mkdir()
        picture.touch()
        for base, new, code in (("nothing-2", "new-0", 2), ("base-0", "nothing-1", 2), ("nothing-0", "nothing-0", 2)):
            self.assertEqual(self.compare(f"{base}.toml", f"{new}.toml"), (code, ""), (base, new))
        self.assertFalse(picture.exists())

    def test_too_few_words_are_wrong_input(self):
        done = subprocess.run([ROOT / "scripts/compare_suites.sh", "a.toml"], capture_output=True, text=True)
        self.assertEqual(done.returncode, 2)


class Comment(InAFolder):
    def comment(self, markdown="### penumbra: fine\n", code="0"):
        self.program("gh", GH)
        (self.folder / "comparison.md").write_text(markdown)
        done = subprocess.run([sys.executable, ROOT / "scripts/comment.py", self.folder / "comparison.md", code, "12"],
                              capture_output=True, text=True,
                              env={"PATH": f"{self.folder}:{os.environ['PATH']}", "GITHUB_REPOSITORY": "a/b"})
        self.assertEqual((done.returncode, done.stderr), (0, ""))
        written = self.folder / "written.json"
        return done.stdout, json.loads(written.read_text()) if written.exists() else None

    def test_the_first_is_new(self):
        said, written = self.comment()
        self.assertEqual(said, "")
        self.assertEqual(written, {"words": ["--method", "POST", "repos/a/b/issues/12/comments", "--input", "-"],
                                   "body": f"{comment.MARKER}\n### penumbra: fine\n"})
        listed = json.loads((self.folder / "listed.json").read_text())
        self.assertIn("repos/a/b/issues/12/comments?per_page=100", listed)
        self.assertIn("--paginate", listed)
        self.assertIn(comment.MARKER, listed[-1])

    def test_ours_is_found_and_edited(self):
        (self.folder / "ours").write_text("7\n8\n")
        self.assertEqual(self.comment()[1]["words"][:3], ["--method", "PATCH", "repos/a/b/issues/comments/8"])

    def test_without_a_comparison_it_says_so(self):
        for markdown in ("", "\n"):
            body = self.comment(markdown, "2")[1]["body"]
            self.assertTrue(body.startswith(comment.MARKER))
            self.assertIn("nothing was compared", body)
            self.assertIn("Exit code 2", body)

    def test_one_that_may_not_be_written_is_a_warning_of_one_line(self):
        (self.folder / "denied").touch()
        said, written = self.comment()
        self.assertIsNone(written)
        self.assertTrue(said.startswith("::warning"), said)
        self.assertIn("HTTP 403: Resource not accessible 100%25 of it", said)
        self.assertEqual(said.count("\n"), 1)

    def test_a_long_one_is_cut_between_rows(self):
        row = "| `scène` | 1.00 |\n"
        head = "### penumbra: REGRESSION\n\n"
        fold = "<details><summary>many</summary>\n\n"
        for text, folds in ((head + row * 9000, 0), (head + fold + row * 9000 + "</details>\n", 1)):
            body = self.comment(text)[1]["body"]
            self.assertLessEqual(len(body.encode()), 65536)
            self.assertGreater(len(body.encode()), 65000)
            self.assertEqual((body.count("<details>"), body.count("</details>")), (folds, folds))
            self.assertTrue(body.endswith(comment.CUT))
            rows = [line for line in body.splitlines() if "scène" in line]
            self.assertEqual(set(rows), {row.strip()})
        self.assertLessEqual(len(comment.body_of("x" * 99999, "0").encode()), 65536)
        self.assertGreater(len(comment.body_of("x" * 99999, "0").encode()), 65000)

    def test_one_that_just_fits_is_whole(self):
        room = comment.MOST_BYTES - len(comment.MARKER) - 1
        self.assertEqual(comment.body_of("x" * room, "0"), f"{comment.MARKER}\n{'x' * room}")
        self.assertIn("Cut here", comment.body_of("x" * (room + 1), "0"))


class Gate(InAFolder):
    def test_help_builds_nothing(self):
        for word in ("-h", "--help"):
            done = subprocess.run([ROOT / "scripts/gate.sh", word], capture_output=True, text=True, cwd=self.folder,
                                  env={"PATH": "/usr/bin:/bin"}, timeout=20)
            self.assertEqual((done.returncode, done.stderr), (0, ""))
            self.assertIn("usage: scripts/gate.sh", done.stdout)
            self.assertIn("--renew", done.stdout)

    def test_a_trial_finds_the_places_of_its_plants(self):
        self.assertFalse(gate_trial.check())
        for name, plants in gate_trial.PLANTS.items():
            for plant in plants:
                path = self.folder / plant["file"]
                path.parent.mkdir(parents=True, exist_ok=True)
                path.write_text((ROOT / plant["file"]).read_text())
            gate_trial.plant_in(self.folder, name)
            for plant in plants:
                text = (self.folder / plant["file"]).read_text()
                self.assertEqual(text.count(plant["replace"]), 1, name)

    def test_the_error_of_a_trial_is_in_what_both_backends_use(self):
        for file in ("sh_exponentiation.cpp", "kernel.cpp"):
            text = (ROOT / "techniques/sh_exponentiation" / file).read_text()
            self.assertEqual(text.count(" guarded("), 1, file)
        kernel = (ROOT / gate_trial.DARK["file"]).read_text()
        body = kernel[kernel.index("float guarded("):]
        self.assertIn(gate_trial.DARK["find"], body[:body.index("\n}\n") + 1])

    def test_a_trial_takes_a_failed_row_for_no_verdict_on_errors(self):
        def trial(*rows):
            return {"found": {"rows": rows}}
        worse = {"error": {"verdict": "worse", "regressed": True}}
        self.assertTrue(gate_trial.called_worse(trial(worse)))
        for rows in ((), ({"status": "failed: parity"},), ({**worse, "status": "failed: parity"},), (worse, {}),
                     ({"error": {"verdict": "worse", "regressed": False}},),
                     ({"error": {"verdict": "better", "regressed": True}},)):
            self.assertFalse(gate_trial.called_worse(trial(*rows)), rows)


if __name__ == "__main__":
    unittest.main()
