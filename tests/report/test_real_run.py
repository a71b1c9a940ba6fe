"""A run that `penumbra run` wrote, with what `penumbra report --figures` derives from it: RUN=DIR, with DIR/figures.json."""

import json
import os
import pathlib
import shutil
import unittest

from support import BrowserCase, run_report


@unittest.skipUnless(os.environ.get("RUN"), "RUN names no folder of results")
class RealRun(BrowserCase):
    def test_the_page_agrees_with_the_program(self):
        run = pathlib.Path(os.environ["RUN"])
        shutil.copytree(run, self.folder, dirs_exist_ok=True)
        done = run_report(self.folder, "--paper", self.folder / "paper")
        self.assertEqual(done.returncode, 0, done.stderr)
        figures = json.loads((self.folder / "figures.json").read_text())
        scenes = {scene["scene"]: scene for scene in figures["scenes"]}
        page = self.open(self.folder / "report.html")
        for limit in figures["limits"]:
            page.locator(f".ticks button[data-limit='{limit:g}']").click()
            page.wait_for_function(f"report.state.limit === {limit}")
            page.wait_for_timeout(50)
            for name, row in page.evaluate("report.data.scenes.map((s, k) => [s.name, report.chosen[k] && report.chosen[k].name])"):
                expected = next((c["row"] for c in scenes[name]["cheapest"] if c["limit"] == limit), None) if name in scenes else None
                self.assertEqual(row, expected, f"{name} at {limit}")
        if page.locator(".panel").count():
            page.locator("#viewer").scroll_into_view_if_needed()
            page.wait_for_selector(".panel[data-mean]")
            mean, row = page.evaluate("[Number(document.querySelector('.panel[data-mean]').dataset.mean), report.data.rows[document.querySelector('#view-b').value]]")
            if page.locator("#view-a").input_value() == "truth" and row["rungs"]["truth"]["flip"]:
                self.assertAlmostEqual(mean, row["rungs"]["truth"]["flip"], delta=0.02 * mean + 2e-4)
