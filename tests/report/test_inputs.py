"""Files that are hostile, broken, old, or of another machine: handled, and said."""

import json
import pathlib
import shutil

import made_results
from support import BrowserCase, run_report, small_run, write_json

HOSTILE = ['<script>alert(1)</script>', '"><img src=x onerror=alert(1)>', "'); alert(1); ('", "</script><script>alert(1)</script>",
           "<!--<script>", "\u2028\u2029\x00\x07", "{{ 7 * 7 }}", "=HYPERLINK(\"http://x\")", "$\\mathrm{x}$ \\input{/etc/passwd}", "x" * 10240]


class Inputs(BrowserCase):
    def fresh(self, name: str) -> pathlib.Path:
        folder = self.folder / name
        shutil.rmtree(folder, ignore_errors=True)
        return folder

    def test_hostile_names(self):
        made = made_results.Made()
        for k, text in enumerate(HOSTILE):
            scene = HOSTILE[[0, 3, 9][k % 3]]
            for technique in ("ray-traced", text):
                made.row(scene, technique, "simd", {"rays": 4 + k, text: text}, 1.0 + k, 0.05 / (k + 1))
            made.row(scene, "pcss", text, {"k": k}, None, None, status=f"failed: {text}")
        made.context.update(suite=HOSTILE[0], cpu_name=HOSTILE[3], commit=HOSTILE[1], date=HOSTILE[4], compiler=HOSTILE[9])
        folder = made.write(self.fresh("hostile"))
        figures = json.loads((folder / "figures.json").read_text())
        figures["published"][0]["title"] = HOSTILE[3]
        figures["published"][0]["lines"][0]["device"] = HOSTILE[0]
        figures["scenes"][0]["scaling"] = [{"axis": HOSTILE[0], "technique": HOSTILE[1], "backend": HOSTILE[3], "fixed": HOSTILE[0], "rows": [],
                                            "points": [[1, 2], [2, 3]], "refused": HOSTILE[3]}]
        figures["scenes"][0]["speed_up"] = [{"row": made.lists["rows"][0]["name"], "error": 0.1, "refused": HOSTILE[3]}]
        figures["citations"] = {"ray-traced": HOSTILE[8]}
        write_json(folder / "figures.json", figures)
        done = run_report(folder, "--paper", folder / "paper")
        self.assertEqual(done.returncode, 0, done.stderr)
        page = self.open(folder / "report.html")
        self.drawn(page, "#scene-0 .plot")
        self.drawn(page, "[data-figure=scaling] .plot")
        for details in page.locator("details").all():
            details.evaluate("(d) => d.open = true")
        page.wait_for_timeout(300)
        self.assertEqual(page.locator("img[src=x], main script, header script").count(), 0)
        self.assertIn("<script>alert(1)</script>", page.locator("h1").inner_text())
        self.assertLessEqual(page.evaluate("document.documentElement.scrollWidth"), 1280)
        names = page.evaluate("report.data.rows.map((r) => r.name)")
        self.assertIn(made.lists["rows"][-1]["name"], names)  # whole, for the file to download
        self.assertIn("'=HYPERLINK", page.evaluate("report.csvOf([{...report.data.rows[0], technique: '=HYPERLINK(1)'}])"))

    def test_missing_broken_and_outside_images(self):
        made = small_run()
        folder = made.write(self.fresh("images"))
        rows = [r for r in made.lists["rows"] if r.get("image")]
        (folder / f"{rows[0]['image']}.exr").unlink()
        (folder / f"{rows[1]['image']}.exr").write_bytes(b"no image")
        shutil.rmtree(folder / "images/lamp")
        document = json.loads((folder / "results.json").read_text())
        document["rows"][2]["image"] = "../../../etc/passwd"
        document["rows"][3]["image"] = "/etc/passwd"
        document["rows"][4]["image"] = "images/" + "a" * 5000
        write_json(folder / "results.json", document)
        self.assertEqual(run_report(folder).returncode, 0)
        lamp = next(k for k, r in enumerate(made.lists["rows"]) if r["scene"] == "lamp" and r.get("image"))
        page = self.open(folder / "report.html", f"#picked={lamp}")
        page.locator("header details summary").click()
        said = page.locator("header details").inner_text()
        for text in ("is missing", "cannot be read", "lies outside of the folder of results", "no image was kept", "cannot be looked for"):
            self.assertIn(text, said)
        self.drawn(page, "#scene-1 .plot")
        self.assertIn("is missing", page.locator("#scene-1 .picked").inner_text())

    def test_what_is_made_of_an_image_alone(self):
        """Of an external image nobody knows whether it saw spheres; what is left out, and errors of any size, give a page."""
        made = small_run()
        folder = made.write(self.fresh("external"))
        document = json.loads((folder / "results.json").read_text())
        row = document["rows"][0]
        row["backend"], row["reads_spheres"] = "external", True
        errors = {rung: dict(row["errors"]["truth"]) for rung in ("truth", "cube", "spheres")}
        for rung, value in (("truth", 0.00744), ("cube", 0.015), ("spheres", 0.0241)):
            errors[rung]["rel_rmse"] = value
        row["errors"] = errors
        document["rows"][1]["errors"]["truth"]["rel_rmse"] = 1e300
        write_json(folder / "results.json", document)
        figures = json.loads((folder / "figures.json").read_text())
        figures["scenes"][0]["rows"].append("of another version")
        write_json(folder / "figures.json", figures)
        target = folder / "target.html"
        target.write_text("before")
        (folder / "report.html").symlink_to(target)
        done = run_report(folder)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertIn("<html", target.read_text()[:500])  # where the link leads
        page = self.open(folder / "report.html")
        parts = page.evaluate("report.data.rows[0].parts")
        self.assertEqual([[name, round(value, 5)] for name, value in parts], [["the technique itself", 0.00744]])
        self.assertIn("names of another version", page.locator("header").inner_text())

    def test_no_images_at_all(self):
        made = made_results.Made()
        made.scene("plain", 8)
        folder = made.write(self.fresh("plain"))
        self.assertEqual(run_report(folder).returncode, 0)
        page = self.open(folder / "report.html")
        self.assertIn("no pictures", page.locator("#viewer-note").inner_text())

    def test_pixels_that_are_not_finite_are_counted_and_seen(self):
        made = small_run()
        stem = next(r["image"] for r in made.lists["rows"] if r.get("image"))
        made.images[stem][10:12, 20] = float("nan")
        made.images[stem][13, 20] = float("inf")
        folder = made.write(self.fresh("nan"))
        self.assertEqual(run_report(folder).returncode, 0)
        page = self.open(folder / "report.html", "#b=0")
        page.locator("#viewer").scroll_into_view_if_needed()
        page.wait_for_selector(".panel[data-mean]")
        self.assertIn("3 pixels are not finite", page.locator("#viewer-note").inner_text())
        self.assertEqual(page.locator("#regions tbody tr").nth(1).locator("td").last.inner_text(), "3")
        magenta = page.locator(".panel > canvas").nth(1).evaluate("""(c) => { const d = c.getContext('2d').getImageData(0, 0, c.width, c.height).data;
            let n = 0; for (let k = 0; k < d.length; k += 4) n += d[k] > 250 && d[k + 1] < 5 && d[k + 2] > 250; return n; }""")
        self.assertGreater(magenta, 10)

    def test_nulls(self):
        made = small_run()
        for k, row in enumerate(made.lists["rows"]):
            if k % 3 == 0:
                for key in ("prepare_ms", "update_ms", "shade_ms", "bytes", "geometry_rel_rmse", "threads", "spheres"):
                    row[key] = None
            if k % 3 == 1:
                row["errors"]["truth"].update(rel_rmse=None, psnr=None, ssim=None, flip=None, rel_noise=None)
                row["errors"]["truth"]["regions"]["umbra"] = {key: None for key in row["errors"]["truth"]["regions"]["umbra"]}
            if k % 7 == 0:
                row["stages"], row["footprint"], row["counters"], row["steps"], row["errors"]["cube"] = None, None, None, None, None
        known = [r for r in made.lists["rows"] if r["errors"]["truth"]["rel_rmse"] is not None]
        folder = self.fresh("nulls")
        write_json(folder / "results.json", made.document())
        write_json(folder / "figures.json", {**made_results.figures(known), "receivers_scaling": None})
        self.assertEqual(run_report(folder, "--paper", folder / "paper").returncode, 0)
        page = self.open(folder / "report.html", "#moves=1&memory=1000000000")
        for selector in ("#scene-0 .plot", "[data-figure=parts] .plot", "[data-figure=memory] .plot"):
            self.drawn(page, selector)
        page.locator("#scene-0 details.data summary").click()
        page.wait_for_selector("#scene-0 table tbody tr:nth-child(24)", state="attached")

    def test_no_figures_and_no_rows(self):
        made = made_results.Made()
        folder = made.write(self.fresh("empty"))
        write_json(folder / "figures.json", {"format_version": 1})
        self.assertEqual(run_report(folder, "--paper", folder / "paper").returncode, 0)
        self.assertIn("This run has no row", self.open(folder / "report.html").locator("#answer").inner_text())
        made = small_run()
        made.write(folder)
        write_json(folder / "figures.json", {"format_version": 1, "scenes": None, "limits": "x", "published": 7})
        self.assertEqual(run_report(folder).returncode, 0)
        page = self.open(folder / "report.html")
        self.drawn(page, "#scene-0 .plot")

    def test_broken_files_are_refused_with_a_sentence(self):
        folder = small_run().write(self.fresh("broken"))
        whole = (folder / "results.json").read_text()
        cases = {"cut off": (whole[:len(whole) // 2], "no JSON, or cut off"), "empty": ("", "no JSON"), "a list": ("[]", "no JSON object"),
                 "foreign": ('{"a": 1}', "not a results file"), "deep": ("[" * 200000, "nested too deep"), "no rows": ('{"context": {}, "format_version": 2}', "not a results file"),
                 "twice": (json.dumps({**json.loads(whole), "skipped": json.loads(whole)["rows"][:1]}), "twice")}
        for name, (text, said) in cases.items():
            (folder / "results.json").write_text(text)
            done = run_report(folder)
            self.assertEqual(done.returncode, 2, name)
            self.assertIn(said, done.stderr, name)
            self.assertNotIn("Traceback", done.stderr, name)
            self.assertFalse((folder / "report.html").exists())
        (folder / "results.json").write_bytes(b"\xff\xfe{}")
        self.assertIn("no UTF-8", run_report(folder).stderr)
        with open(folder / "results.json", "wb") as file:
            file.truncate(200 << 20)  # a hole, which takes no room
        done = run_report(folder)
        self.assertEqual(done.returncode, 2)
        self.assertIn("200 MiB are more than a page can hold", done.stderr)
        self.assertEqual(run_report(folder, results=folder / "none.json").returncode, 2)
        (folder / "results.json").write_text(whole)
        write_json(folder / "figures.json", {"format_version": 99})
        self.assertIn("another version", run_report(folder).stderr)

    def test_old_files_are_read(self):
        made = small_run()
        document = {"context": made.context, "benchmarks": made.lists["rows"]}
        folder = made.write(self.fresh("old"))
        write_json(folder / "results.json", document)
        self.assertEqual(run_report(folder).returncode, 0)
        page = self.open(folder / "report.html")
        self.drawn(page, "#scene-0 .plot")


class Compared(BrowserCase):
    def setUp(self):
        self.base, self.new = small_run(), small_run()
        self.new.context.update(date="2026-11-28T10:00:00+00:00", commit="f" * 16)
        self.changed = [r for r in self.new.lists["rows"] if r.get("image")][3]
        self.new.images[self.changed["image"]] = self.new.images[self.changed["image"]] * 1.1
        self.base.write(self.folder / "base")
        self.new.write(self.folder / "new")

    def comparison(self):
        rows = []
        for k, row in enumerate(self.new.lists["rows"]):
            slower = {4: 1.06, 7: 1.5}.get(k, 1.0)
            worse = row is self.changed
            rows.append({"name": row["name"], "regressed": slower > 1 or worse,
                         "time": {"verdict": "slower" if slower > 1 else "same", "base_ms": 1.0, "new_ms": slower, "ratio": slower,
                                  "interval": [slower - 0.01, slower + 0.01], "p": 1e-5, "regressed": slower > 1, "why": ""},
                         "error": {"verdict": "worse" if worse else "same", "rung": "truth", "base": 0.02, "new": 0.024 if worse else 0.02,
                                   "factor": 1.2 if worse else 1.0, "regressed": worse, "why": ""}})
        return write_json(self.folder / "comparison.json", {"exit_code": 1, "verdict": "REGRESSION: 3 regressions", "notes": ["a note <b>"], "added": ["a"],
                                                            "removed": ["<i>r</i>"], "rows": rows})

    def test_what_got_slower(self):
        done = run_report(self.folder / "new", "--base", self.folder / "base/results.json", "--comparison", self.comparison())
        self.assertEqual(done.returncode, 0, done.stderr)
        page = self.open(self.folder / "new/report.html")
        heads = page.locator("#changes > .scroll table tbody th").all_inner_texts()
        self.assertEqual(len(heads), 3)
        ratios = page.locator("#changes > .scroll table tbody tr td:nth-child(5)").all_inner_texts()
        self.assertEqual(ratios, ["1.500×", "1.000×", "1.060×"], "worst first")
        pictures = page.locator("#changes button.pictures")
        self.assertEqual(pictures.count(), 1)
        self.assertEqual(pictures.locator("img").count(), 3)
        self.assertEqual(len(set(pictures.locator("img").evaluate_all("(all) => all.map((i) => i.src)"))), 3)
        pictures.click()
        page.wait_for_function("document.querySelector('#view-a').value.startsWith('base')")
        self.assertTrue(page.locator("#view-a").input_value().startswith("base"))
        self.assertEqual(page.locator("#view-b").input_value(), str(self.new.lists["rows"].index(self.changed)))
        page.locator("#changes thead button", has_text="ratio").first.click()
        ratios = page.locator("#changes > .scroll table tbody tr td:nth-child(5)").all_inner_texts()
        self.assertEqual(ratios, ["1.000×", "1.060×", "1.500×"])

    def test_another_machine_is_said(self):
        self.base.context["cpu_name"] = "Another CPU"
        self.base.write(self.folder / "base")
        self.assertEqual(run_report(self.folder / "new", "--base", self.folder / "base/results.json", "--comparison", self.comparison()).returncode, 0)
        page = self.open(self.folder / "new/report.html")
        self.assertIn("two machines", page.locator("#changes").inner_text())

    def test_history_never_mixes_machines(self):
        other = small_run()
        other.context.update(cpu_name="Another CPU", date="2026-11-26T10:00:00+00:00")
        other.write(self.folder / "other")
        files = [self.folder / name / "results.json" for name in ("other", "base", "new")]
        self.assertEqual(run_report(self.folder / "new", "--history", *files).returncode, 0)
        page = self.open(self.folder / "new/report.html")
        past = page.evaluate("report.data.history")
        self.assertEqual([run["date"][:10] for run in past["runs"]], ["2026-11-27", "2026-11-28"])
        self.assertTrue(all(len(points) <= 2 for points in past["series"].values()))
        self.assertIn("Another CPU", page.locator("#history .note").inner_text())
        self.drawn(page, "[data-figure=history] .plot")

    def test_base_and_comparison_belong_together(self):
        self.assertEqual(run_report(self.folder / "new", "--base", self.folder / "base/results.json").returncode, 2)
