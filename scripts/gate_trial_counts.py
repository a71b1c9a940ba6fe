#!/usr/bin/env python3
"""Plants about one percent of work in kernels and shows whether scripts/instruction_counts.py finds it.

    scripts/gate_trial_counts.py [--tree DIR]      exit 1 if one is not found, or something else is said to have grown

Works in a copy of the tree (build/gate-trial-counts) that it builds as the release preset says, whole and with all planted
at once: each is looked for among the rows of its own technique and backend. How much was planted is measured by the same
counts, of the stage that it was planted in. The same kernels of the whole copy are compared with the baseline: there, nothing may
have grown.
"""
import argparse
import subprocess
import sys
import tempfile
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent))
sys.path.insert(0, str(Path(__file__).resolve().parent.parent / "tests/faults"))
import instruction_counts as counts  # noqa: E402
import plant  # noqa: E402

# kernel, the stage that grows, file, its text, what replaces it
PLANTED = [
    ("pixel-basis", "simd", "shade", "techniques/pixel_basis/kernel.cpp",
     "    search.look(i);\n    radiance[i]",
     "    if (k % 96 == 48) search.look(i), radiance[i] = SumOpen(*job.light, search.horizon, search.blocked);\n"
     "    search.look(i);\n    radiance[i]"),
    ("pixel-basis", "scalar", "shade", "techniques/pixel_basis/pixel_basis.cpp",
     "    visibility_.find_blocked(i, blocked);\n    radiance[i] = pixel_sum",
     "    if (i % 96 == 48)\n"
     "      visibility_.find_blocked(i, blocked),\n"
     "          radiance[i] = pixel_sum(light_, blocked, receivers_->normal[i], receivers_->albedo[i]);\n"
     "    visibility_.find_blocked(i, blocked);\n    radiance[i] = pixel_sum"),
    ("ray-traced", "scalar", "shade", "techniques/ray_traced/ray_traced.cpp",
     "      radiance[i] = receivers_->albedo[i] * estimate_radiance(",
     "      if (i % 48 == 24) radiance[i] = estimate_radiance(rays_, receivers_->ray_origin(i), samples);\n"
     "      radiance[i] += receivers_->albedo[i] * estimate_radiance("),
    ("sh-exponentiation", "scalar", "shade", "techniques/sh_exponentiation/sh_exponentiation.cpp",
     "radiance[i] = shade_one(i, spheres_of(k));",
     "radiance[i] = (i % 96 == 48 ? shade_one(i, spheres_of(k)) : vec3(0)) + shade_one(i, spheres_of(k));"),
    ("shadow-map", "simd", "new shape", "techniques/bases/shadow_map/shadow_map.cpp",
     "      rays.first_hits(packet, count, depth);",
     "      if (by % 4 == 2 && bx % 10 == 5) rays.first_hits(packet, count, depth);\n"
     "      rays.first_hits(packet, count, depth);"),
]


def build(tree):
    for command in (["cmake", "--preset", "release", "-DPENUMBRA_TESTS=ON"],
                    ["cmake", "--build", "--preset", "release", "--target", "instruction_counts"]):
        done = subprocess.run(command, cwd=tree, capture_output=True, text=True)
        if done.returncode:
            sys.exit(f"{' '.join(command)}:\n{(done.stdout + done.stderr)[-3000:]}")
    return tree / "build/release/instruction_counts"


def gate(folder, base, new, technique="", backend=""):
    """Exit code of the gate on the instructions of one technique and backend; what it says first."""
    def chosen(counted):
        rows = {k: v for k, v in counted.rows.items() if technique in ("", k[0]) and backend in ("", k[1])}
        return counted._replace(rows=rows)
    paths = [Path(folder) / name for name in ("base.csv", "new.csv")]
    for path, counted in zip(paths, (base, new)):
        counts.write(path, chosen(counted), "a trial")
    done = subprocess.run([sys.executable, counts.__file__, "--baseline", paths[0], "--counts", paths[1],
                           "--fail-lines", "1000", "--fail-touched", "1000", "--fail-d1", "1000"], env={"COLUMNS": "80"},
                          capture_output=True, text=True)
    return done.returncode, (done.stdout or done.stderr).splitlines()[0].strip()


def plant_all(tree):
    for _, _, _, file, text, replacement in PLANTED:
        path = tree / file
        if path.read_text().count(text) != 1:
            sys.exit(f"{file}: does not have once what is to be replaced: {text}")
        path.write_text(path.read_text().replace(text, replacement))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--tree", type=Path, default=plant.ROOT / "build/gate-trial-counts", metavar="DIR")
    parser.add_argument("--jobs", type=int, default=2, metavar="N")
    options = parser.parse_args()
    tree = options.tree.resolve()
    plant.copy_tree(tree)
    only = [f"{technique} {backend} " for technique, backend, *_ in PLANTED]
    whole = counts.count(build(tree), options.jobs, only)
    plant_all(tree)
    planted = counts.count(build(tree), options.jobs, only)
    plant.copy_tree(tree)

    missed = 0
    with tempfile.TemporaryDirectory() as folder:
        print(f"{'kernel':28} {'stage':10} {'planted':>9}  the gate")
        for technique, backend, stage, *_ in PLANTED:
            before, after = (c.rows[technique, backend, light(c, technique), "", stage] for c in (whole, planted))
            code, said = gate(folder, whole, planted, technique, backend)
            missed += code != 1
            change = after["instructions"] / before["instructions"] - 1
            print(f"{technique + ' ' + backend:28} {stage:10} {100 * change:+8.2f} %  {code}: {said}")
        here = counts.read(counts.ROOT / "results/baseline/counts.csv")
        here = here._replace(rows={key: here.rows[key] for key in here.rows.keys() & whole.rows.keys()})
        code, said = gate(folder, here, whole)
    print(f"nothing planted, another folder: {code}: {said}")
    return 1 if missed or code else 0


def light(counted, technique):
    """The light that the technique was counted under: environment if under both."""
    return max(key[2] for key in counted.rows if key[0] == technique)


if __name__ == "__main__":
    try:
        sys.exit(main())
    except counts.Stop as stop:
        sys.exit(f"gate_trial_counts: {stop}")
