#!/usr/bin/env python3
"""Installs a build into a folder and uses it there, without the sources.

    tests/installed.py --build build/release --program build/release/tests/penumbra_without_sources

The installed program gets its data from its own share/penumbra, although the sources are there. Then PROGRAM takes its
place, which equals it but for the folder of the sources: that is nowhere. It runs a suite with published figures;
$PENUMBRA_DATA comes before its own data, and without any data there is one line and exit code 2.
"""
import argparse
import pathlib
import shutil
import subprocess
import sys
import tempfile

SUITE = """
name = "installed"
scenes = ["tiny.toml"]
repetitions = 1
truth_noise = 0.1
published = "zhao-che-2011-table2"
[[technique]]
name = "ray-traced"
backend = "scalar"
parameters = { rays = 4 }
"""
SCENE = """
name = "tiny"
[occluder]
mesh = "box"
[receivers]
plane = { half_extent = 2.0, resolution = 8 }
[light]
environment = "constant"
"""


def run(program, *arguments, expect=0, **environment):
    """Output of the program, which sees no variable but those given. Exits if its exit code is not the expected one."""
    done = subprocess.run(["env", "-i", *(f"{k}={v}" for k, v in environment.items()), program, *arguments],
                          capture_output=True, text=True, check=False, cwd="/")
    if done.returncode != expect:
        sys.exit(f"{arguments}: exit code {done.returncode}, not {expect}:\n{done.stdout}{done.stderr}")
    return done.stdout + done.stderr


def expect(condition, what, text):
    if not condition:
        sys.exit(f"{what}:\n{text}")


def install(options, prefix):
    subprocess.run(["cmake", "--install", options.build, "--prefix", prefix], check=True, stdout=subprocess.DEVNULL)
    program = prefix / "bin" / "penumbra"
    expect(program.exists(), "an installation should have a program", prefix)
    return program


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    parser.add_argument("--build", required=True, type=pathlib.Path)
    parser.add_argument("--program", required=True, type=pathlib.Path)
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        place = pathlib.Path(folder).resolve()
        program = install(options, place / "a prefix")
        data = place / "a prefix" / "share" / "penumbra" / "scenes"

        shutil.copy(data / "suites" / "quick.toml", data / "suites" / "of-this-installation.toml")
        for _ in ("with the sources", "without"):
            listing = run(program, "list")
            for name in ("bunny-city", "of-this-installation"):
                expect(name in listing, f"list should name {name}", listing)
            shutil.copy(options.program, program)

        (place / "suite.toml").write_text(SUITE, encoding="utf-8")
        (place / "tiny.toml").write_text(SCENE, encoding="utf-8")
        cache = {"PENUMBRA_CACHE": place / "cache"}
        output = run(program, "run", place / "suite.toml", "--out", place / "out", **cache)
        expect("ray-traced" in output and (place / "out" / "results.json").exists(), "a run should print its row", output)

        other = place / "other" / "scenes"
        shutil.move(data, other)
        shutil.copy(other / "suites" / "quick.toml", other / "suites" / "of-the-variable.toml")
        listing = run(program, "list", PENUMBRA_DATA=other)
        expect("of-the-variable" in listing, "PENUMBRA_DATA should name the data", listing)

        for environment in ({}, {"PENUMBRA_DATA": place}):
            message = run(program, "run", "quick", "--out", place / "none", expect=2, **environment)
            expect(message.count("\n") == 1 and "PENUMBRA_DATA" in message and "assets.toml" in message,
                   "one line should say where the data is missing", message)
    print("installed: fine")


if __name__ == "__main__":
    main()
