"""Plots and tables for a paper."""

import json
import pathlib
import re
import shutil
import tempfile
import unittest
import xml.etree.ElementTree

import paper
from support import run_report, small_run, write_json


class Paper(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = pathlib.Path(tempfile.mkdtemp(prefix="penumbra-paper-"))
        cls.addClassCleanup(shutil.rmtree, cls.folder)
        made = small_run()
        made.lists["rows"][0]["parameters"] = {"50%_of $x$": "{a}\\b~^&#"}
        made.write(cls.folder)
        figures = json.loads((cls.folder / "figures.json").read_text())
        figures["citations"] = {"ray-traced": "Embree: Wald & others 2014", "wavelet": "Zhao & Che 2011", "pcss": "none; a template"}
        write_json(cls.folder / "figures.json", figures)
        done = run_report(cls.folder, "--paper", cls.folder / "out")
        assert done.returncode == 0, done.stderr
        cls.out = cls.folder / "out"

    def test_all_files_are_there(self):
        names = {file.name for file in self.out.iterdir()}
        for stem in ("time-error-bunny-city", "time-error-lamp", "scaling-bunny-city-spheres", "parts-bunny-city", "stages-lamp"):
            self.assertLessEqual({stem + ".svg", stem + ".pdf"}, names)
        self.assertLessEqual({"rows-bunny-city.tex", "rows-lamp.tex", "answers.tex", "published-1.tex", "citations.bib"}, names)
        for file in self.out.glob("*.svg"):
            xml.etree.ElementTree.parse(file)
        for file in self.out.glob("*.pdf"):
            self.assertTrue(file.read_bytes().startswith(b"%PDF"))

    def test_tables_are_latex(self):
        for file in self.out.glob("*.tex"):
            text = file.read_text()
            self.assertIn("\\toprule", text)
            self.assertEqual(text.count("{") - text.count("\\{"), text.count("}") - text.count("\\}"), file.name)
            body = re.findall(r"^.*\\\\$", text, re.M)
            plain = [line for line in body if "multicolumn" not in line]
            self.assertEqual({len(re.findall(r"(?<!\\)&", line)) for line in plain}.__len__(), 1, file.name)
        rows = (self.out / "rows-bunny-city.tex").read_text()
        self.assertIn(r"50\%\_of \$x\$=\{a\}\textbackslash{}b\textasciitilde{}\textasciicircum{}\&\#", rows)

    def test_what_is_cited_is_explained(self):
        cited = {key for file in self.out.glob("*.tex") for key in re.findall(r"\\cite\{([^}]*)\}", file.read_text())}
        known = set(re.findall(r"@misc\{([^,]*),", (self.out / "citations.bib").read_text()))
        self.assertEqual(cited, known)
        self.assertIn("embree2014", known)
        self.assertNotIn("cite", next(line for line in (self.out / "rows-bunny-city.tex").read_text().splitlines() if line.startswith("pcss")))

    def test_the_same_run_gives_the_same_bytes(self):
        self.assertEqual(run_report(self.folder, "--paper", self.folder / "again").returncode, 0)
        for file in self.out.iterdir():
            self.assertEqual(file.read_bytes(), (self.folder / "again" / file.name).read_bytes(), file.name)

    def test_no_text_becomes_a_command(self):
        self.assertEqual(paper.tex("\\input{x}%\n$&"), r"\textbackslash{}input\{x\}\% \$\&")
        self.assertEqual([paper.tex(text) for text in ("[ours]", "*", "a[b]*")], ["{}[ours]", "{}*", "a[b]*"])
        taken = set()
        self.assertEqual([paper.slug("../../x", taken), paper.slug("x", taken), paper.slug("!", taken)], ["x", "x-2", "unnamed"])
