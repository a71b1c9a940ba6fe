"""A picture of a run's page, as the README shows it; Debian's chromium takes it.

    build/release/penumbra report results/runs/latest && .venv/bin/python scripts/report/screenshot.py results/runs/latest
        [--out docs/report.png] [--part "#scene-0"] [--address "picked=4-1"] [--width 1200] [--height 990] [--dark]
"""

import argparse
import io
import pathlib

from PIL import Image
from playwright.sync_api import sync_playwright

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("run", help="a folder with a report.html")
    parser.add_argument("--out", default=ROOT / "docs" / "report.png")
    parser.add_argument("--part", default="#scene-0", help="what stands on top, as a CSS selector")
    parser.add_argument("--address", default="picked=4-1", help="what is chosen, as it stands behind the # of the page's address")
    parser.add_argument("--width", type=int, default=1200)
    parser.add_argument("--height", type=int, default=990)
    parser.add_argument("--dark", action="store_true")
    options = parser.parse_args()
    file = (pathlib.Path(options.run) / "report.html").resolve()
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path="/usr/bin/chromium")
        page = browser.new_page(viewport={"width": options.width, "height": options.height}, color_scheme="dark" if options.dark else "light")
        page.goto(f"file://{file}#{options.address}")
        page.wait_for_selector("html[data-ready]")
        part = page.locator(options.part).first
        for _ in range(3):  # parts above it may grow while they are drawn
            part.evaluate("(node) => node.scrollIntoView()")
            page.wait_for_timeout(1200)
        picture = Image.open(io.BytesIO(page.screenshot()))
        browser.close()
    picture.convert("RGB").save(options.out, optimize=True)
    print(options.out)


if __name__ == "__main__":
    main()
