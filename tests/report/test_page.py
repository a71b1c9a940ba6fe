"""What a person does with the page, in a browser."""

import json
import pathlib
import unittest

from axe_playwright_python.sync_playwright import Axe

import made_results
from support import BrowserCase, run_report, small_run, write_json


class Page(BrowserCase):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.made = small_run()
        cls.made.write(cls.folder)
        done = run_report(cls.folder)
        assert done.returncode == 0, done.stderr
        cls.file = cls.folder / "report.html"
        cls.figures = json.loads((cls.folder / "figures.json").read_text())

    def sentences(self, page):
        return page.locator("#sentences li").all_inner_texts()

    def point_at(self, page, scene, row):
        """Moves the mouse over a row of a scene's plot."""
        x, y = page.evaluate("""([scene, row]) => {
            const plot = document.querySelector(`#scene-${scene} .plot`), graph = plot.querySelector(".js-plotly-plot"), box = plot.getBoundingClientRect();
            const {xaxis, yaxis} = graph._fullLayout, r = report.data.rows[row];
            return [box.left + xaxis._offset + xaxis.d2p(r.frame), box.top + yaxis._offset + yaxis.d2p(100 * r.error)];
        }""", [scene, row])
        page.mouse.move(x - 3, y)
        page.mouse.move(x, y)
        page.wait_for_timeout(80)
        return x, y

    def test_plots_are_drawn(self):
        page = self.shared(self.file)
        for selector in ("#scene-0 .plot", "#scene-1 .plot", "[data-figure=scaling] .plot", "[data-figure=parts] .plot",
                         "[data-figure=stages] .plot", "[data-figure=memory] .plot"):
            self.drawn(page, selector)
        scene = json.loads(page.evaluate("JSON.stringify(report.data.scenes[0].rows)"))
        self.assertEqual(page.locator("#scene-0 .plot .scatterlayer .points path.point").count(), len(scene) + 8)  # and published times
        self.assertGreater(page.locator("#scene-0 .plot .errorbar").count(), 0)
        self.assertIn("ties", page.locator("#scene-0 .plot").text_content())
        self.assertIn("slope 0.8 (0.7 to 0.9)", page.locator("[data-figure=scaling]").text_content())
        equal = page.locator("[data-figure=equal] tbody tr").first
        self.assertEqual(equal.locator("th, td").all_inner_texts(), ["wavelet simd", "–", "2.5", "–", "2"])
        self.assertEqual(equal.locator("td").first.get_attribute("title"), "1 % is below <b>")

    def test_slider_agrees_with_the_derived_figures(self):
        page = self.shared(self.file)
        for limit in self.figures["limits"]:
            page.locator(f".ticks button[data-limit='{limit:g}']").click()
            page.wait_for_timeout(60)
            chosen = page.evaluate("report.chosen.map((row) => row && row.name)")
            expected = [next(c["row"] for c in s["cheapest"] if c["limit"] == limit) for s in self.figures["scenes"]]
            self.assertEqual(chosen, expected, f"at {limit}")
        page.locator("#limit").evaluate("(s) => { s.value = 0; s.dispatchEvent(new Event('input')); }")
        page.wait_for_timeout(100)
        self.assertIn("nothing is within 0.1 %", self.sentences(page)[0])

    def test_ring_and_line_follow_the_slider(self):
        page = self.open(self.file)
        self.drawn(page, "#scene-0 .plot")
        where = lambda: page.evaluate("[...document.querySelectorAll('#scene-0 .mark.limit, #scene-0 .mark.chosen')].map((m) => m.style.transform + m.style.visibility)")
        before = where()
        page.locator(".ticks button").last.click()
        page.wait_for_timeout(100)
        for a, b in zip(before, where()):
            self.assertNotEqual(a, b)

    def test_filters(self):
        page = self.open(self.file)
        self.drawn(page, "#scene-0 .plot")
        page.locator(".ticks button").last.click()
        page.wait_for_timeout(60)
        fastest = page.evaluate("report.chosen[0].technique")
        page.locator("#technique-filter summary").click()
        page.locator(f"input[name=technique][value={fastest}]").uncheck()
        page.wait_for_timeout(150)
        self.assertNotEqual(page.evaluate("report.chosen[0].technique"), fastest)
        faded = page.evaluate("document.querySelector('#scene-0 .js-plotly-plot').data.flatMap((t) => t.marker?.opacity ?? []).filter((o) => o < 1).length")
        self.assertEqual(faded, page.evaluate("report.data.scenes[0].rows.filter((k) => report.data.rows[k].technique === %s).length" % json.dumps(fastest)))
        page.locator("#reset").click()
        page.select_option("#memory", "100000")
        page.wait_for_timeout(60)
        self.assertTrue(page.evaluate("report.chosen.every((row) => !row || row.bytes <= 1e5)"))
        page.select_option("#memory", "")
        page.select_option("#prepare", "100")
        page.wait_for_timeout(60)
        self.assertTrue(page.evaluate("report.chosen.every((row) => !row || row.prepare <= 100)"))

    def test_a_moving_mesh_pays_for_preparation(self):
        page = self.open(self.file)
        page.locator("#moves").check()
        page.wait_for_timeout(60)
        self.assertTrue(page.locator("#moves-note").is_visible())
        rows = [r for r in self.made.lists["rows"] if r["scene"] == "bunny-city" and r["errors"]["truth"]["rel_rmse"] <= 0.02]
        cheapest = min(rows, key=lambda r: r["frame_ms"] + r["prepare_ms"])
        self.assertAlmostEqual(page.evaluate("report.chosen[0].frame + report.chosen[0].prepare"), cheapest["frame_ms"] + cheapest["prepare_ms"], 6)
        self.assertEqual(page.evaluate("report.chosen[1].name"), next(c["row"] for c in self.figures["scenes"][1]["cheapest"] if c["limit"] == 0.02))

    def test_pointing_shows_the_picture_and_two_picks_stand_side_by_side(self):
        page = self.open(self.file)
        self.drawn(page, "#scene-0 .plot")
        x, y = self.point_at(page, 0, 2)
        card = page.locator("#card")
        self.assertTrue(card.is_visible())
        self.assertIn(page.evaluate("report.data.rows[2].label"), card.inner_text())
        self.assertEqual(page.locator("#card img").get_attribute("src"), page.evaluate("report.data.images[report.data.rows[2].image].thumbnail"))
        page.mouse.click(x, y)
        x, y = self.point_at(page, 0, 0)
        page.mouse.click(x, y)
        page.mouse.move(5, 5)
        self.assertEqual(page.locator("#scene-0 .picked img").count(), 2)
        page.wait_for_function("location.hash.includes('picked=2-0')")
        self.assertTrue(page.locator("#card").is_hidden())
        page.locator("#scene-0 .open-viewer").click()
        page.wait_for_function("document.querySelector('#view-a').value === '2' && document.querySelector('#view-b').value === '0'")

    def test_keyboard_walks_and_picks(self):
        page = self.open(self.file)
        self.drawn(page, "#scene-0 .plot")
        page.locator("#scene-0 .plot").focus()
        page.keyboard.press("ArrowRight")
        page.keyboard.press("ArrowRight")
        spoken = page.locator("#scene-0 .live").inner_text()
        self.assertIn("error", spoken)
        page.keyboard.press("Enter")
        self.assertEqual(page.locator("#scene-0 .picked figure").count(), 1)
        self.assertIn(spoken, page.locator("#scene-0 .picked figcaption").inner_text())

    def test_viewer(self):
        page = self.open(self.file)
        page.locator("#viewer").scroll_into_view_if_needed()
        page.wait_for_selector(".panel[data-mean]", timeout=20000)
        self.assertEqual(page.locator("#view-a").input_value(), "truth")
        drawn = lambda k: page.locator(".panel > canvas").nth(k).evaluate("(c) => c.toDataURL().length")
        for k in range(4):
            self.assertGreater(drawn(k), 2000, f"panel {k} is empty")
        page.select_option("#view-b", "0")
        page.wait_for_function("document.querySelector('#regions').innerText.includes(report.data.rows[0].label)")
        box = page.locator(".panel > canvas").nth(1).bounding_box()
        page.mouse.move(box["x"] + box["width"] / 2, box["y"] + box["height"] / 2)
        page.wait_for_timeout(100)
        text = page.locator("#pixel").inner_text()
        self.assertRegex(text, r"pixel 3[12], 3[12]: A [\d.]+ [\d.]+ [\d.]+; B .*; B − A .*; FLIP 0?\.\d+")
        self.assertTrue(all(page.locator(".panel .value").all_inner_texts()))
        part = lambda: page.locator(".panel > canvas").first.evaluate("(c) => [...c.toDataURL()].reduce((h, x) => (31 * h + x.charCodeAt(0)) | 0, 0)")
        whole = part()
        page.locator("#zoom-in").click()
        page.wait_for_timeout(100)
        self.assertNotEqual(part(), whole)
        page.locator("#zoom-reset").click()
        page.locator("#exposure").evaluate("(s) => { s.value = 2; s.dispatchEvent(new Event('input')); }")
        page.wait_for_timeout(300)
        self.assertEqual(page.locator("#exposure-text").inner_text(), "+2 EV")
        self.assertNotEqual(part(), whole)
        for mode in ("slider", "flip"):
            page.select_option("#view-mode", mode)
            page.wait_for_timeout(200)
            self.assertTrue(page.locator(".panel").nth(1).is_hidden())
        for letter in "BAB":
            page.wait_for_function(f"document.querySelector('.panel .title').textContent.startsWith('{letter}:')")
        for word in ("umbra", "penumbra", "lit", "not finite"):
            self.assertIn(word, page.locator("#regions").inner_text())

    def test_tables_sort(self):
        page = self.shared(self.file)
        page.locator("#scene-0 details.data summary").click()
        page.wait_for_selector("#scene-0 table tbody tr", state="attached")
        column = lambda k: page.locator(f"#scene-0 table tbody tr :nth-child({k})").all_inner_texts()
        times = [float(t) for t in column(2)]
        self.assertEqual(times, sorted(times))
        page.locator("#scene-0 table thead button", has_text="error %").click()
        errors = [float(t) for t in column(4)]
        self.assertEqual(errors, sorted(errors))
        page.locator("#scene-0 table thead button", has_text="error %").click()
        self.assertEqual([float(t) for t in column(4)], sorted(errors, reverse=True))
        page.locator("#scene-1 details.data summary").click()
        page.wait_for_selector("#scene-1 table tbody tr", state="attached")
        self.assertEqual(page.locator("#scene-1 table tbody tr.grey").count(), 2)

    def test_selection_lives_in_the_address(self):
        page = self.open(self.file)
        page.locator(".ticks button").first.click()
        page.locator("#backend-filter summary").click()
        page.locator("input[name=backend][value=scalar]").uncheck()
        page.locator("#moves").check()
        page.select_option("#memory", "100000000")
        page.wait_for_function("location.hash.includes('memory')")
        fragment = page.evaluate("location.hash")
        again = self.open(self.file, fragment + "&picked=0-2&b=2&mode=slider")
        self.assertEqual(again.locator("#limit-text").inner_text(), "1 %")
        self.assertFalse(again.locator("input[name=backend][value=scalar]").is_checked())
        self.assertTrue(again.locator("#moves").is_checked())
        self.assertEqual(again.locator("#memory").input_value(), "100000000")
        self.assertEqual(again.locator("#scene-0 .picked figure").count(), 2)
        again.locator("#viewer").scroll_into_view_if_needed()
        again.wait_for_function("document.querySelector('#view-mode').value === 'slider' && document.querySelector('#view-b').value === '2'")
        again.evaluate("location.hash = '#error=0.1&picked=1'")
        again.wait_for_function("document.querySelector('#limit-text').textContent === '10 %'")
        strange = self.open(self.file, "#error=-5&picked=99999-x&scene=99&a=%3Cb%3E&mode=zzz&ev=1e9&technique=")
        self.assertEqual(strange.locator("#limit-text").inner_text(), "2 %")

    def test_links_of_the_page_keep_the_selection(self):
        page = self.open(self.file, "#error=0.1")
        page.locator("nav a", has_text="viewer").click()
        page.wait_for_timeout(400)
        self.assertEqual(page.evaluate("location.hash"), "#error=0.1")
        self.assertLess(abs(page.locator("#viewer").bounding_box()["y"]), 200)

    def test_dark_and_light(self):
        paper = "getComputedStyle(document.body).backgroundColor"
        light, dark = self.open(self.file, color_scheme="light"), None
        self.assertEqual(light.evaluate(paper), "rgb(255, 255, 255)")
        light.locator("#theme").click()
        self.assertEqual(light.evaluate(paper), "rgb(20, 24, 29)")
        dark = self.open(self.file, color_scheme="dark")
        self.assertEqual(dark.evaluate(paper), "rgb(20, 24, 29)")
        self.drawn(dark, "#scene-0 .plot")
        ink = dark.evaluate("getComputedStyle(document.querySelector('#scene-0 .xtick text')).fill")
        self.assertEqual(ink, "rgb(169, 179, 190)")

    def test_phone(self):
        page = self.open(self.file, viewport={"width": 360, "height": 740}, has_touch=True, is_mobile=True)
        self.drawn(page, "#scene-0 .plot")
        self.drawn(page, "[data-figure=parts] .plot")
        page.locator("#viewer").scroll_into_view_if_needed()
        page.wait_for_selector(".panel[data-mean]", timeout=20000)
        self.assertLessEqual(page.evaluate("document.documentElement.scrollWidth"), 360, "the page is wider than the phone")
        wide = page.evaluate("[...document.querySelectorAll('.main-svg')].filter((s) => s.getBoundingClientRect().right > 361).length")
        self.assertEqual(wide, 0)

    def test_published_tables_have_the_papers_layout(self):
        page = self.shared(self.file)
        heads = page.locator("table.published thead th").all_inner_texts()
        self.assertEqual(heads, ["terms", "device", "measured here", "32 spheres", "64 spheres", "96 spheres", "128 spheres"])
        cell = page.locator("table.published tbody tr").first.locator("td").nth(1).inner_text()
        for word in ("170", "11", "× 15.5"):
            self.assertIn(word, cell)
        lines = page.locator("table.published tbody tr")
        self.assertEqual(lines.count(), 4)
        self.assertEqual(lines.nth(0).locator("td").first.inner_text(), "ray-traced simd rays=4, 2 threads")
        self.assertEqual(lines.nth(2).locator("td").all_inner_texts()[:2], ["–", "11 published"])

    def test_rows_without_a_result_are_greyed_with_their_reason(self):
        page = self.shared(self.file)
        text = page.locator("#unmeasured").inner_text()
        self.assertIn("failed: receiver 17 has the radiance nan", text)
        self.assertIn("skipped: cannot shade an environment", text)
        self.assertEqual(page.locator("#unmeasured table.grey tbody tr").count(), 2)

    def test_an_image_without_a_time_is_compared(self):
        page = self.open(self.file)
        said = self.sentences(page)[1]
        self.assertIn("other-renderer · external, an image without a time, errs by 3 %", said)
        lamp = [r for r in self.made.lists["rows"] if r["scene"] == "lamp" and r["errors"]["truth"]["rel_rmse"] <= 0.03]
        label = page.evaluate("(name) => report.data.rows.find((r) => r.name === name).label", made_results.cheapest(lamp, 0.03))
        self.assertIn(f"the fastest that is as near is {label}", said)
        self.drawn(page, "#scene-1 .plot")
        self.assertIn("other-renderer · external: no time", page.locator("#scene-1 .plot").text_content())
        page.locator("#scene-1 .untimed button").click()
        page.wait_for_function("document.querySelector('#view-b').selectedOptions[0]?.textContent.includes('other-renderer')")

    def test_downloads(self):
        page = self.shared(self.file)
        with page.expect_download() as waiting:
            page.locator("#download-json").click()
        self.assertEqual(pathlib.Path(waiting.value.path()).read_bytes(), (self.folder / "results.json").read_bytes())
        with page.expect_download() as waiting:
            page.locator("#download-csv").click()
        import pandas
        rows = pandas.read_csv(waiting.value.path())
        measured = sum(len(rows_) for rows_ in self.made.lists.values())
        self.assertEqual(len(rows), measured)
        first = self.made.lists["rows"][0]
        self.assertAlmostEqual(rows["frame"][0], first["frame_ms"])
        self.assertAlmostEqual(rows["rungs.truth.rel_rmse"][0], first["errors"]["truth"]["rel_rmse"])

    def test_accessible(self):
        """All parts of a page, changes and history too, of few rows."""
        made = made_results.Made()
        made.scene("bunny-city", 9, 32, 3)
        made.row("bunny-city", "wavelet", "simd", {"terms": 7}, None, None, status="failed: receiver 17 has the radiance nan")
        folder = made.write(self.folder / "accessible")
        rows = [{"name": row["name"], "regressed": row is made.lists["rows"][0], "time": {"verdict": "slower", "base_ms": 1.0, "new_ms": 1.2, "ratio": 1.2},
                 "error": {"verdict": "worse", "rung": "truth", "base": 0.01, "new": 0.02, "factor": 2.0}} for row in made.lists["rows"][:3]]
        comparison = write_json(folder / "comparison.json", {"exit_code": 1, "verdict": "REGRESSION", "notes": ["a note"], "rows": rows})
        results = folder / "results.json"
        self.assertEqual(run_report(folder, "--base", results, "--comparison", comparison, "--history", results).returncode, 0)
        for scheme in ("light", "dark"):
            page = self.open(folder / "report.html", "#picked=0", color_scheme=scheme)
            for selector in ("#scene-0 .plot", "[data-figure=scaling] .plot", "[data-figure=memory] .plot", "[data-figure=history] .plot"):
                self.drawn(page, selector)
            page.locator("#viewer").scroll_into_view_if_needed()
            page.wait_for_selector(".panel[data-mean]")
            for details in page.locator("details:not(.filter)").all():
                details.evaluate("(d) => d.open = true")
            page.wait_for_timeout(300)
            found = Axe().run(page, options={} if scheme == "light" else {"runOnly": ["color-contrast"]})
            self.assertEqual(found.violations_count, 0, found.generate_report())


if __name__ == "__main__":
    unittest.main()
