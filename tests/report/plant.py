"""Plants slips in a copy of the report, one at a time, and runs the tests that must notice.

    .venv/bin/python tests/report/plant.py [--only REGEX]      exit 1: a slip survived, or its text is no longer there
"""

import argparse
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent
# Name, file below scripts/report, text that stands there once, what replaces it, test.
FAULTS = [
    ("names are not escaped in the page", "page.py", "autoescape=True", "autoescape=False", "test_inputs.Inputs.test_hostile_names"),
    ("data may end its script", "page.py", 'for character in "<>&\\u2028\\u2029":', 'for character in "":', "test_inputs.Inputs.test_hostile_names"),
    ("a picture from the network", "templates/head.html", "<header>", '<header><img alt="" src="https://example.org/x.png">', "test_page.Page.test_published_tables_have_the_papers_layout"),
    ("a script complains", "js/main.js", "function start() {", 'function start() { console.error("x");', "test_page.Page.test_published_tables_have_the_papers_layout"),
    ("ties take the fastest", "js/choice.js", "if (!faster(fastest, row) && nearer(row, best)) best = row;", "", "test_page.Page.test_slider_agrees_with_the_derived_figures"),
    ("noise counts once", "js/choice.js", "costOf(a) + a.spread + b.spread", "costOf(a) + 40 * a.spread", "test_page.Page.test_slider_agrees_with_the_derived_figures"),
    ("the ring stays", "js/main.js", 'if (what === "limit") plots.forEach((plot) => plot.choose());', "", "test_page.Page.test_ring_and_line_follow_the_slider"),
    ("filters are not told to plots", "js/main.js", 'if (what === "filter" || what === "all") plots', 'if (what === "all") plots', "test_page.Page.test_filters"),
    ("preparation is free", "js/choice.js", "row.prepare ?? 0 : 0", "0 : 0", "test_page.Page.test_a_moving_mesh_pays_for_preparation"),
    ("points lie elsewhere", "js/pointer.js", "xaxis._offset + xaxis.d2p", "xaxis.d2p", "test_page.Page.test_pointing_shows_the_picture_and_two_picks_stand_side_by_side"),
    ("a pick is forgotten by the address", "js/state.js", 'if (state.picks.length) q.set("picked", state.picks.join("-"));', "", "test_page.Page.test_pointing_shows_the_picture_and_two_picks_stand_side_by_side"),
    ("any address is believed", "js/state.js", "Number(x) < data.rows.length", "true", "test_page.Page.test_selection_lives_in_the_address"),
    ("texts are sorted as numbers", "js/tables.js", "return down ? -order : order;", "return order;", "test_page.Page.test_tables_sort"),
    ("skipped rows are left out", "page.py", 'if row["status"] != "ok"]', 'if row["status"].startswith("failed")]', "test_page.Page.test_rows_without_a_result_are_greyed_with_their_reason"),
    ("too wide for a phone", "css/parts.css", ".scroll { overflow-x: auto;", ".scroll { min-width: 700px;", "test_page.Page.test_phone"),
    ("grey on grey", "css/page.css", "--soft: #55606e;", "--soft: #b5bcc4;", "test_page.Page.test_accessible"),
    ("a field without a name", "templates/answer.html", "<label>memory <select", "<label></label><select", "test_page.Page.test_accessible"),
    ("images without a time are not said", "js/answer.js", "untimed(scene).slice(0, 4)", "[]", "test_page.Page.test_an_image_without_a_time_is_compared"),
    ("flip does not turn", "js/viewer.js", "viewer.turned = !viewer.turned;", "", "test_page.Page.test_viewer"),
    ("a channel is lost", "js/codec.js", "rgb[3 * i + 2] = value(green[i] + blue[i]);", "rgb[3 * i + 2] = value(green[i]);", "test_pixels.Pixels.test_pixels_arrive"),
    ("another corner", "js/codec.js", "plane[i - w - 1]", "plane[i - w + 1]", "test_pixels.Pixels.test_pixels_arrive"),
    ("no edges in FLIP", "js/flip.js", "colour ** (1 - feature)", "colour", "test_pixels.Pixels.test_flip_is_the_authors"),
    ("linear pictures", "images.py", "linear = numpy.where(shown <= 0.04045, shown / 12.92, ((shown + 0.055) / 1.055) ** 2.4)", "linear = shown", "test_pixels.Pixels.test_exposure_is_read_off_the_picture"),
    ("halving is not said", "templates/head.html", "{% if halved %}", "{% if false %}", "test_pixels.Pixels.test_too_many_pixels_are_halved_and_said"),
    ("any path is read", "load.py", 'path.is_absolute() or ".." in path.parts', "False", "test_inputs.Inputs.test_missing_broken_and_outside_images"),
    ("bad pixels are black", "js/codec.js", "for (const i of about.bad)", "for (const i of [])", "test_inputs.Inputs.test_pixels_that_are_not_finite_are_counted_and_seen"),
    ("files of any size", "load.py", "if size > LARGEST_FILE:", "if False:", "test_inputs.Inputs.test_broken_files_are_refused_with_a_sentence"),
    ("machines are mixed", "history.py", "if r.machine == run.machine)", ")", "test_inputs.Compared.test_history_never_mixes_machines"),
    ("best first", "compare.py", "key=severity, reverse=True", "key=severity", "test_inputs.Compared.test_what_got_slower"),
    ("base is new", "compare.py", '"base": gallery.pictures[numbers[0]].thumbnail', '"base": gallery.pictures[numbers[1]].thumbnail', "test_inputs.Compared.test_what_got_slower"),
    ("another machine is not said", "compare.py", "bool(base and base.machine != run.machine)", "False", "test_inputs.Compared.test_another_machine_is_said"),
    ("LaTeX commands in names", "paper.py", '"".join(SPECIAL.get(c, c) for c in plain)', "plain", "test_paper.Paper.test_tables_are_latex"),
    ("files with a date", "paper_plots.py", "metadata={date: None}", "metadata={}", "test_paper.Paper.test_the_same_run_gives_the_same_bytes"),
    ("a citation without a source", "paper.py", "for text, key in self.keys.items())", "for text, key in list(self.keys.items())[1:])", "test_paper.Paper.test_what_is_cited_is_explained"),
]


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--only", default="")
    options = parser.parse_args()
    survived = []
    with tempfile.TemporaryDirectory(prefix="penumbra-plant-") as name:
        copy = pathlib.Path(name)
        shutil.copy(ROOT / "scripts/results_file.py", copy.joinpath("scripts").mkdir() or copy / "scripts")
        shutil.copytree(ROOT / "tests/report", copy / "tests/report")
        for what, file, text, instead, test in FAULTS:
            if not re.search(options.only, what):
                continue
            shutil.rmtree(copy / "scripts/report", ignore_errors=True)
            shutil.copytree(ROOT / "scripts/report", copy / "scripts/report")
            path = copy / "scripts/report" / file
            source = path.read_text()
            if source.count(text) != 1:
                print(f"{what}: {source.count(text)} times in {file}", flush=True)
                survived.append(what)
                continue
            path.write_text(source.replace(text, instead))
            done = subprocess.run([sys.executable, "-m", "unittest", test], cwd=copy / "tests/report", capture_output=True, text=True)
            print(f"{'found' if done.returncode else 'SURVIVED'}: {what}", flush=True)
            if not done.returncode:
                survived.append(what)
    print(f"{len(survived)} survived" + "".join(f"\n  {what}" for what in survived))
    return 1 if survived else 0


if __name__ == "__main__":
    sys.exit(main())
