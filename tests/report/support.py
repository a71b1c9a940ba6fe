"""What the tests of the report share: pages made from made-up runs, and a browser that has no network."""

import json
import pathlib
import shutil
import subprocess
import sys
import tempfile
import unittest

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent
sys.path.insert(0, str(ROOT / "scripts" / "report"))
sys.path.insert(0, str(ROOT / "tests" / "report"))

import made_results
from playwright.sync_api import sync_playwright

BROWSERS = ("/usr/bin/chromium", "/usr/bin/chromium-browser", "/usr/bin/google-chrome")


def browser_path() -> str | None:
    return next((path for path in BROWSERS if pathlib.Path(path).exists()), None)


def run_report(folder, *more, figures=None, results=None) -> subprocess.CompletedProcess:
    """The script as `penumbra report` calls it."""
    folder = pathlib.Path(folder)
    command = [sys.executable, ROOT / "scripts/report/report.py", "--results", results or folder / "results.json",
               "--figures", figures or folder / "figures.json", "--out", folder / "report.html", *more]
    return subprocess.run([str(word) for word in command], capture_output=True, text=True, timeout=120)


def small_run(seed: int = 1) -> made_results.Made:
    """Two scenes, one in motion, with pictures, a failed, a skipped and an untimed row."""
    made = made_results.Made(seed)
    made.scene("bunny-city", 24, 64, 10)
    made.scene("lamp", 12, 48, 4, moves=True)
    made.row("lamp", "wavelet", "simd", {"terms": 7}, None, None, status="failed: receiver 17 has the radiance nan")
    made.row("lamp", "pcss", "simd", {"samples": 7}, None, None, status="skipped: cannot shade an environment")
    made.row("lamp", "other-renderer", "external", {}, None, 0.03, image=48)
    # As fast within the noise of both, and nearer; nearer still, and slower by more than that.
    for ms, spread, error in ((0.010, 0.001, 0.018), (0.011, 0.001, 0.012), (0.0125, 0.0001, 0.005)):
        made.row("lamp", "sh-lighting", "simd", {"order": 3, "error": error}, ms, error, moves=True).update(frame_ms=ms, frame_spread_ms=spread)
    return made


class BrowserCase(unittest.TestCase):
    """A browser for all tests of a class; every page must be silent and ask no network for anything."""

    @classmethod
    def setUpClass(cls):
        if not browser_path():
            raise unittest.SkipTest(f"no browser: {', '.join(BROWSERS)} are not there")
        cls.folder = pathlib.Path(tempfile.mkdtemp(prefix="penumbra-report-"))
        cls.addClassCleanup(shutil.rmtree, cls.folder, ignore_errors=True)
        cls.playwright = sync_playwright().start()
        cls.addClassCleanup(cls.playwright.stop)
        cls.browser = cls.playwright.chromium.launch(executable_path=browser_path())
        cls.addClassCleanup(cls.browser.close)

    def open(self, file, fragment="", **options):
        """A page of its own, whose faults are looked at in the end."""
        context, page = self.new_page(file, fragment, **options)
        self.addCleanup(context.close)
        self.addCleanup(self.assert_silent, page)
        return page

    def shared(self, file):
        """One page for all tests of a class that leave it as it was, for opening takes longest."""
        cls = type(self)
        if not getattr(cls, "shared_page", None):
            context, cls.shared_page = self.new_page(file, "")
            cls.addClassCleanup(context.close)
        self.addCleanup(self.assert_silent, cls.shared_page)
        return cls.shared_page

    def new_page(self, file, fragment, **options):
        options.setdefault("viewport", {"width": 1280, "height": 900})
        context = self.browser.new_context(accept_downloads=True, **options)
        faults, requests = [], []

        def route(request_route):
            url = request_route.request.url
            if url.startswith(("file:", "data:", "blob:")):
                return request_route.continue_()
            requests.append(url)
            request_route.abort()

        context.route("**/*", route)
        page = context.new_page()
        page.faults, page.asked = faults, requests
        page.set_default_timeout(20000)
        page.on("console", lambda message: faults.append(message.text) if message.type in ("error", "warning") else None)
        page.on("pageerror", lambda error: faults.append(str(error)))
        page.on("request", lambda request: requests.append(request.url) if request.url.startswith(("http", "ws", "ftp")) else None)
        page.on("dialog", lambda dialog: (faults.append("a dialog: " + dialog.message), dialog.dismiss()))
        page.goto(f"file://{file}{fragment}")
        page.wait_for_selector("html[data-ready]")
        return context, page

    def assert_silent(self, page):
        self.assertEqual(page.faults, [], "the page complains")
        self.assertEqual(page.asked, [], "the page asks a network")

    def drawn(self, page, selector):
        """Waits until a plot is drawn."""
        page.locator(selector.split(" ")[0]).first.scroll_into_view_if_needed()
        page.wait_for_selector(f"{selector}[data-drawn] .main-svg", timeout=20000)


def write_json(path, value) -> pathlib.Path:
    path = pathlib.Path(path)
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(json.dumps(value))
    return path
