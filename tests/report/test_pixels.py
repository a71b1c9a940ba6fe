"""Pixels on their way to the page, and FLIP as the page computes it."""

import json
import math

import flip_evaluator
import numpy

import images
import made_results
from support import BrowserCase, run_report, small_run


class Pixels(BrowserCase):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.made = small_run()
        row = [r for r in cls.made.lists["rows"] if r.get("image")][1]
        odd = made_results.shadow(64, 0.02, numpy.random.default_rng(5), 0.3)
        odd[5:9, 7] = [[-0.25, 0.5, 20.0]]  # truncated bases are negative in places, and a firefly is bright
        odd[:, 40:] *= numpy.array([1.0, 0.1, 0.001], numpy.float32)
        cls.made.images[row["image"]] = cls.odd = odd
        cls.number = cls.made.lists["rows"].index(row)
        cls.truth = cls.made.images["images/bunny-city/truth"]
        cls.made.write(cls.folder)
        assert run_report(cls.folder).returncode == 0
        cls.file = cls.folder / "report.html"

    def pixels(self, page, number):
        flat = page.evaluate("async (k) => [...(await report.imageOf(k)).rgb]", number)
        return numpy.array(flat, numpy.float64).reshape(64, 64, 3)

    def test_pixels_arrive(self):
        page = self.open(self.file)
        number = page.evaluate("(k) => report.data.rows[k].image", self.number)
        back, scale = self.pixels(page, number), page.evaluate("(k) => report.data.images[k].scale", number)
        # Half a level: 2 sqrt(v s) / 4095 / 2, and a little for v near 0.
        allowed = (numpy.sqrt(numpy.abs(self.odd) / scale) + 1 / 4095) * scale / 4095
        self.assertTrue((numpy.abs(back - self.odd) <= allowed).all(), float((numpy.abs(back - self.odd) / allowed).max()))
        self.assertLess(back.min(), -0.2)

    def test_flip_is_the_authors(self):
        page = self.open(self.file)
        exposure = 0.9
        here = numpy.array(page.evaluate("""([a, b, e]) => [...report.flip(Float32Array.from(a), Float32Array.from(b), 64, 64, e)]""",
                                         [numpy.maximum(self.odd, 0).ravel().tolist(), self.truth.ravel().tolist(), exposure])).reshape(64, 64)
        stop = math.log2(exposure)
        theirs, _, _ = flip_evaluator.evaluate(self.truth, numpy.maximum(self.odd, 0), "HDR", applyMagma=False, computeMeanError=False, parameters={
            "startExposure": stop, "stopExposure": stop, "numExposures": 2, "tonemapper": "aces"})
        self.assertLess(float(numpy.abs(here - theirs[..., 0]).max()), 2e-3)
        self.assertGreater(float(here.max()), 0.2)

    def test_exposure_is_read_off_the_picture(self):
        from PIL import Image
        exposure = 0.37
        shown = images.encode_srgb(self.truth * exposure)
        Image.fromarray((shown * 255 + 0.5).astype(numpy.uint8)).save(self.folder / "truth.png")
        self.assertAlmostEqual(images.exposure_of(self.truth, self.folder / "truth.png"), exposure, delta=0.002 * exposure)
        self.assertGreater(images.exposure_of(self.truth, self.folder / "none.png"), 0.5)

    def test_too_many_pixels_are_halved_and_said(self):
        import page as page_maker
        from load import Run
        text = page_maker.build(Run(self.folder / "results.json"), json.loads((self.folder / "figures.json").read_text()), None, None, [], budget=60_000)
        file = self.folder / "halved.html"
        file.write_text(text)
        page = self.open(file)
        self.assertIn("had to be halved", page.locator("header").inner_text())
        page.locator("#viewer").scroll_into_view_if_needed()
        page.wait_for_selector(".panel[data-mean]")
        self.assertIn("shown at 32 × 32 of 64 × 64 pixels", page.locator("#viewer-note").inner_text())
        size = sum(len(t) for t in page.evaluate("[...document.querySelectorAll('script[id^=image-]')].map((s) => s.textContent)"))
        self.assertLessEqual(size, 62_000)
