#!/usr/bin/env python3
"""What scripts/instruction_counts.py says of counts that differ, and its exit codes. Nothing is counted here."""
import os
import pathlib
import shutil
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

    def file(self, text, name="new.csv"):
        path = pathlib.Path(self.folder.name) / name
        path.write_text(text)
        return path

    def run_script(self, *arguments, columns=80, **streams):
        base = self.file(HEAD + "\n".join(ROWS.values()) + "\n", "base.csv")
        done = subprocess.run([sys.executable, SCRIPT, "--baseline", base, *arguments], text=True,
                              env={"COLUMNS": str(columns), "PATH": os.environ["PATH"]},
                              **{"stdout": subprocess.PIPE, "stderr": subprocess.PIPE, **streams})
        self.assertNotIn("Traceback", done.stderr or "")
        return done

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
                                         (",3000,", ",3600,", ",3800,", "--fail-touched"),
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

    def test_a_wrong_line_is_said_by_its_number(self):
        whole = HEAD + "\n".join(ROWS.values()) + "\n"
        for text, said in ((whole.replace("\npcss", "\n\npcss"), "base.csv, line 10: empty"),
                           (whole + "\n", "base.csv, line 11: empty"),
                           (whole.replace("135,8", "135,x"), "base.csv, line 10: wrong: pcss,"),
                           (whole + ROWS["pcss"], "base.csv, line 11: twice there: pcss,"),
                           (whole.replace("pcss,", '"pcss,'), "base.csv, line 10: wrong")):
            code, words = self.compare(whole, base=text)
            self.assertEqual(code, 2, words)
            self.assertIn(said, words)

    def test_nothing_in_a_file_moves_the_cursor(self):
        whole = HEAD + "\n".join(ROWS.values()) + "\n"
        hostile = "p\x1b[2J\rcss\x07\u202e"
        for text in (whole.replace("410", "900").replace("pcss", hostile), whole + hostile + "\n",
                     whole.replace("Embree 3", "Embree \x1b]0;3\x07")):
            code, said = self.compare(text)
            self.assertNotEqual(code, 0)
            self.assertTrue(all(line.isprintable() for line in said.splitlines()), repr(said))
            self.assertIn("\\x", said)

    def test_a_narrow_screen_is_kept_to_where_it_can_be(self):
        for columns, most in ((2, 20), (40, 40)):
            done = self.run_script("--counts", self.file(HEAD + ROWS["wavelet"] + "\n"), columns=columns)
            self.assertEqual(done.returncode, 1)
            self.assertEqual(max(map(len, done.stdout.splitlines())), most)

    def test_no_folder_is_made_where_a_path_has_a_slip(self):
        counts, folder = self.file(HEAD + ROWS["pcss"] + "\n", "kept.csv"), pathlib.Path(self.folder.name)
        root = pathlib.Path("/penumbra-no-such-folder")
        for target, parent in ((root / "counts.csv", root), (folder / "a/b/counts.csv", folder / "a")):
            for options in (("--save", target), ("--baseline", target, "--renew", "--why", "a slip")):
                done = self.run_script("--counts", counts, *options)
                self.assertEqual(done.returncode, 2)
                self.assertIn("there is no folder", done.stderr)
                self.assertFalse(parent.exists())
        done = self.run_script("--counts", counts, "--save", folder / "new/counts.csv")
        self.assertEqual(done.returncode, 1)  # the other kernel is gone
        self.assertTrue((folder / "new/counts.csv").is_file())

    def test_only_a_kernel_that_grew_ends_with_1(self):
        whole = HEAD + "\n".join(ROWS.values()) + "\n"
        same = self.file(whole, "same.csv")
        with open("/dev/full", "w") as full:
            for streams in ({"stdout": full}, {"stdout": full, "stderr": full}):
                self.assertEqual(self.run_script("--counts", same, **streams).returncode, 2)
            self.assertEqual(self.run_script("--counts", "/nowhere/counts.csv", stderr=full).returncode, 2)
        self.assertEqual(self.run_script("--counts", same, "--save", "/dev/full").returncode, 2)
        self.assertEqual(self.run_script("--counts", self.folder.name).returncode, 2)

    @unittest.skipUnless(shutil.which("valgrind"), "needs valgrind")
    def test_another_program_is_wrong_input(self):
        for program in ("/bin/true", "/bin/false", "/nowhere/program", "/dev/null"):
            done = self.run_script("--program", program)
            self.assertEqual(done.returncode, 2, done.stderr)
            self.assertTrue(done.stderr.startswith("instruction counts: "), done.stderr)

    def test_what_a_program_prints_is_read_with_care(self):
        sys.path.insert(0, str(SCRIPT.parent))
        import instruction_counts
        for text in ("", "[]", "{}", "3", '{"context": 1, "variants": 2}', '{"context": {}, "variants": {}}',
                     '{"context": {"compiler": "", "flags": "", "instruction set": "", "libraries": ""}, "variants": {"1": {}}}'):
            with self.assertRaises(instruction_counts.Stop) as stopped:
                instruction_counts.read_said("program", text)
            self.assertEqual(stopped.exception.code, 2)

    def test_a_fault_of_the_script_ends_with_2_and_a_sentence(self):
        code = ("import sys; sys.path.insert(0, sys.argv.pop(1)); import instruction_counts as c\n"
                "def main(): return {}['x']\n"
                "c.main = main; sys.exit(c.exit_code())")
        done = subprocess.run([sys.executable, "-c", code, SCRIPT.parent], capture_output=True, text=True)
        self.assertEqual(done.returncode, 2)
        self.assertIn("KeyError: 'x'", done.stderr)
        self.assertNotIn("Traceback", done.stderr)

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
