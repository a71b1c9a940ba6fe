#!/usr/bin/env python3
"""What scripts/instruction_counts.py says of counts that differ, and its exit codes. Nothing is counted here."""
import pathlib
import subprocess
import sys
import tempfile
import unittest

SCRIPT = pathlib.Path(__file__).resolve().parents[2] / "scripts/instruction_counts.py"
HEAD = """# why: a test
# compiler: GNU 12.2.0
# flags: -O3
# instruction set: AVX2
# libraries: Embree 3
# valgrind: valgrind-3.19.0
# caches: D1 32768,8,64
technique,backend,light,way,stage,instructions,reads,writes,lines,d1_misses
"""
ROWS = {"wavelet": "wavelet,simd,environment,visibility=raster,shade,1000000,200000,50000,3000,4000",
        "pcss": "pcss,scalar,area,,new light,410,112,135,8,15"}


class Compare(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.addCleanup(self.folder.cleanup)

    def compare(self, new, *arguments, base=HEAD + "\n".join(ROWS.values()) + "\n"):
        paths = [pathlib.Path(self.folder.name) / name for name in ("base.csv", "new.csv")]
        for path, text in zip(paths, (base, new)):
            path.write_bytes(text if isinstance(text, bytes) else text.encode())
        done = subprocess.run([sys.executable, SCRIPT, "--baseline", paths[0], "--counts", paths[1], *arguments],
                              capture_output=True, text=True, env={"COLUMNS": "80"})
        self.assertNotIn("Traceback", done.stderr)
        self.assertLessEqual(len(done.stdout.splitlines()), 20)
        if "--renew" not in arguments:  # which prints a command
            self.assertTrue(all(len(line) <= 80 for line in done.stdout.splitlines()), done.stdout)
        return done.returncode, done.stdout + done.stderr

    def changed(self, old, new, *arguments, head=HEAD):
        text = head + "\n".join(ROWS.values()) + "\n"
        self.assertIn(old, text)
        return self.compare(text.replace(old, new), *arguments)

    def test_equals_are_fine(self):
        code, said = self.changed("1000000", "1000000")
        self.assertEqual((code, said), (0, "2 kernels: 0 grew, 0 fell, 0 new, 0 gone\n"))

    def test_one_percent_more_instructions_is_found(self):
        code, said = self.changed("1000000", "1010000")
        self.assertEqual(code, 1)
        self.assertIn("+1.00 % instructions wavelet simd, environment, shade, visibility=raster", said)
        self.assertEqual(self.changed("1000000", "1010000", "--fail-instructions", "2%")[0], 0)

    def test_a_few_instructions_more_are_as_good_as_none(self):
        self.assertEqual(self.changed("410", "413")[0], 0)
        self.assertEqual(self.changed("410", "413", "--few", "0")[0], 1)
        self.assertEqual(self.changed("1000000", "1005000")[0], 0)
        self.assertEqual(self.changed("1000000", "1005200")[0], 1)

    def test_every_count_has_a_tolerance_of_its_own(self):
        for old, fine, grown, option in (("200000", "204000", "204200", "--fail-lines"),
                                         (",3000,", ",3300,", ",3500,", "--fail-touched"),
                                         (",4000", ",6000", ",6200", "--fail-d1")):
            self.assertEqual(self.changed(old, fine)[0], 0, option)
            self.assertEqual(self.changed(old, grown)[0], 1, option)
            self.assertEqual(self.changed(old, fine, option, "1", "--few", "0")[0], 1, option)
        self.assertEqual(self.changed("135,8,15", "135,30,20")[0], 0)
        self.assertEqual(self.changed("135,8,15", "135,30,20", "--few", "0")[0], 1)

    def test_from_none_to_many_grew(self):
        base = HEAD + ROWS["wavelet"].replace(",3000,4000", ",0,4000") + "\n"
        code, said = self.compare(HEAD + ROWS["wavelet"] + "\n", base=base)
        self.assertEqual(code, 1)
        self.assertIn("lines", said)

    def test_less_is_said_and_fine(self):
        code, said = self.changed("1000000", "900000")
        self.assertEqual(code, 0)
        self.assertIn("-10.00 % instructions", said)
        self.assertIn("1 fell", said)
        self.assertIn("--renew", said)

    def test_a_kernel_that_is_gone_fails_and_a_new_one_is_listed(self):
        code, said = self.compare(HEAD + ROWS["wavelet"] + "\n")
        self.assertEqual(code, 1)
        self.assertIn("gone", said)
        self.assertIn("pcss scalar, area, new light", said)
        more = ROWS["pcss"].replace("pcss", "newcomer")
        code, said = self.compare(HEAD + "\n".join([*ROWS.values(), more]) + "\n")
        self.assertEqual(code, 0)
        self.assertIn("newcomer", said)

    def test_many_changes_fit_on_the_screen_worst_first(self):
        rows = [f"t{i},simd,area,{'long=' + 'x' * 90},shade,{20000},1,1,1,1" for i in range(60)]
        grown = [row.replace(",20000,", f",{20000 + 200 * (i + 1)},") for i, row in enumerate(rows)]
        code, said = self.compare(HEAD + "\n".join(grown) + "\n", base=HEAD + "\n".join(rows) + "\n")
        self.assertEqual(code, 1)
        self.assertIn("t59 ", said.splitlines()[0])
        self.assertIn("and 42 more", said)
        self.assertIn("60 grew", said)

    def test_another_compiler_or_valgrind_is_not_compared(self):
        for old, new in (("GNU 12.2.0", "GNU 13.3.0"), ("3.19.0", "3.22.0"), ("Embree 3", "Embree 4"), ("-O3", "-O2")):
            code, said = self.changed(old, new)
            self.assertEqual(code, 3)
            self.assertIn("NOT COMPARED", said)
            self.assertIn(new, said)

    def test_wrong_files_are_refused(self):
        whole = HEAD + "\n".join(ROWS.values()) + "\n"
        for text in ("", "{}", b"\xff\xfe\x00", HEAD, whole[:-10], whole.replace("410", "nan"), whole.replace("410", "-1"),
                     whole + ROWS["pcss"], whole.replace("# compiler: GNU 12.2.0\n", ""), whole.replace(",way,", ",how,"),
                     HEAD + ROWS["pcss"].replace("pcss", "other") + "\n"):
            self.assertEqual(self.compare(text)[0], 2, text[:200])
            self.assertEqual(self.compare(whole, base=text)[0], 2, text[:200])
        self.assertEqual(self.compare(whole, "--baseline", "/nowhere/counts.csv")[0], 2)

    def test_renewing_needs_a_reason_and_keeps_it(self):
        whole = HEAD + "\n".join(ROWS.values()) + "\n"
        self.assertEqual(self.compare(whole, "--renew")[0], 2)
        target = pathlib.Path(self.folder.name) / "renewed.csv"
        code, said = self.compare(whole, "--renew", "--why", "the author's reason", "--baseline", target)
        self.assertEqual(code, 0)
        self.assertIn("-m 'Counts of kernels renewed: the author'\\''s reason'", said)
        self.assertEqual(target.read_text(), whole.replace("a test", "the author's reason"))


if __name__ == "__main__":
    unittest.main()
