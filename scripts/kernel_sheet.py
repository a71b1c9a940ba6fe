#!/usr/bin/env python3
"""What the compiler and the host execution say about every kernel, and what follows for a device.

Per kernel: registers, shared memory and spills (ptxas), theoretical occupancy, operations and bytes per receiver
(kernel_counts), and from them the least time that a device could need: a bound, not a measurement. With --times (of
kernel_times, on a device) also the measured time and the share of the device's peak that it reaches.

    scripts/kernel_sheet.py [--counts FILE] [--times FILE] [--out DIR] [--device NAME:GB/S:TFLOP/S ...]
"""
import argparse
import csv
import json
import math
import re
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
ARCHITECTURES = [75, 80, 90, 120]

# Vendors' data sheets: GB/s of device memory, TFLOP/s of single precision with a multiply-add as two operations.
DEVICES = {"GeForce 8800 GTX": (86.4, 0.3456), "H100 SXM": (3350.0, 66.9)}

# Per multiprocessor: threads, blocks, shared memory in bytes, and what a block takes of it besides (CUDA C++ Programming
# Guide, "Compute Capabilities"). All have 65536 registers, given out 256 at a time to a warp.
LIMITS = {75: (1024, 16, 65536, 0), 80: (2048, 32, 167936, 1024), 90: (2048, 32, 233472, 1024), 120: (1536, 24, 102400, 1024)}


def sources():
    """The files of kernels, from the list that the build makes of cuda/CMakeLists.txt."""
    return re.findall(r"USE\((\w+)\) ?", (ROOT / "build/release/generated/kernel_list.h").read_text().split(") ", 1)[1])


def reasons():
    """Why a kernel does not fill half of an sm_80 multiprocessor: "// Occupancy of KERNEL: ..." in its source."""
    found = {}
    for file in (ROOT / "cuda").glob("*.cu"):
        for name, text in re.findall(r"^// Occupancy of (\w+): (.*(?:\n// .*)*)", file.read_text(), re.MULTILINE):
            found[name] = text.replace("\n// ", " ").rstrip(".")
    return found


def enumerators():
    """{enumeration: its names}, of the enumerations that kernels may have as template arguments."""
    texts = [file.read_text() for folder in ("cuda", "techniques") for file in (ROOT / folder).rglob("*.h")]
    return {name: [word.strip() for word in words.split(",")]
            for text in texts for name, words in re.findall(r"^enum class (\w+) \{ ([\w, ]+) \};", text, re.MULTILINE)}


def compile_resources(source, architecture):
    """{kernel: {registers, shared, spills}} as ptxas prints them."""
    options = ["-DNDEBUG", "-std=c++20", "--expt-relaxed-constexpr", "--diag-suppress=20012", "--fmad=false",
               "-Werror=all-warnings"]
    command = ["nvcc", *options, f"-I{ROOT}", f"-I{ROOT}/build/release", f"-arch=sm_{architecture}", "-cubin",
               "-Xptxas=-v", f"{ROOT}/cuda/{source}.cu", "-o", "/dev/null"]
    done = subprocess.run(command, capture_output=True, text=True)
    if done.returncode:
        sys.exit(f"kernel_sheet: {' '.join(command)}\n{done.stderr}")
    text = subprocess.run(["c++filt"], input=done.stderr, capture_output=True, text=True).stdout
    kernels = {}
    for part in text.split("Compiling entry function '")[1:]:
        used = re.search(r"Used (\d+) registers", part)
        shared = re.search(r"(\d+) bytes smem", part)
        spills = re.search(r"(\d+) bytes spill stores, (\d+) bytes spill loads", part)
        kernels[kernel_name(part)] = {"registers": int(used[1]), "shared": int(shared[1]) if shared else 0,
                                      "spills": int(spills[1]) + int(spills[2])}
    return kernels


ENUMERATORS = enumerators()


def kernel_name(signature):
    """penumbra::cuda::f<(penumbra::cuda::From)0>(...) as f<table>."""
    name = re.search(r"penumbra::cuda::(\w+(?:<[^>]*>)?)\(", signature)[1]
    name = re.sub(r"\((?:\w+::)+(\w+)\)(\d+)", lambda m: ENUMERATORS[m[1]][int(m[2])], name)
    return name.replace("(int)", "").replace("(bool)0", "false").replace("(bool)1", "true")


# Kernels that run once a map, not once a receiver: counted by texel.
PER_TEXEL = {"copy_map": 1024**2, "build_level": 1024**2}


def occupancy(architecture, registers, shared, block_size):
    threads, blocks, memory, reserved = LIMITS[architecture]
    warps = block_size // 32
    by_registers = 65536 // (math.ceil(registers * 32 / 256) * 256) // warps
    by_shared = memory // (math.ceil(shared / 128) * 128 + reserved) if shared + reserved else blocks
    return min(blocks, threads // block_size, by_registers, by_shared) * block_size / threads


def bound_us(row, device):
    """Least microseconds for 2^14 receivers: memory at its peak, or operations at theirs (none is fused)."""
    bandwidth, teraflops = device
    per_receiver = max(row["unique_bytes"] / (bandwidth * 1e9), row["operations"] / (teraflops * 0.5e12))
    return per_receiver * 2**14 * 1e6


def per_receiver(counts):
    """First count of every kernel, default parameters first; sums over a frame's launches, by receiver."""
    rows = {}
    for row in counts:
        if row["kernel"] in rows:
            continue
        n = PER_TEXEL.get(row["kernel"], row["receivers"])
        rows[row["kernel"]] = {**row, "operations": row["operations"] / n, "bytes": row["bytes"] / n,
                               "unique_bytes": row["unique_bytes"] / n}
    return rows


def resources_of(compiled, name):
    """A kernel's; what is counted runs on few normals, and its names leave that argument out."""
    return compiled.get(name) or compiled[name[:-1] + ", false>"]


def sheet(counts, resources, devices, times):
    rows = []
    for name, row in per_receiver(counts).items():
        r = {"kernel": name, "technique": row["technique"], "block": row["block_size"]}
        for a in ARCHITECTURES:
            used = resources_of(resources[a], name)
            r[f"registers sm_{a}"] = used["registers"]
            r[f"spills sm_{a}"] = used["spills"]
            r[f"occupancy sm_{a}"] = round(occupancy(a, used["registers"], used["shared"], row["block_size"]), 3)
        r["shared bytes"] = resources_of(resources[80], name)["shared"]
        r["operations / receiver"] = round(row["operations"], 1)
        r["bytes asked / receiver"] = round(row["bytes"], 1)
        r["bytes unique / receiver"] = round(row["unique_bytes"], 1)
        for device, peak in devices.items():
            r[f"bound {device}, us"] = round(bound_us(row, peak), 3)
        if times:
            measured = [t for t in times["kernels"] if t["kernel"] == name][0]
            elements = PER_TEXEL.get(name, measured["receivers"])
            peaks = times["peaks"]
            r["measured, us"] = round(1e3 * measured["ms"] * 2**14 / elements, 2)
            r["share of peak"] = round(bound_us(row, (peaks["gbs"], peaks["tflops"])) / r["measured, us"], 3)
        rows.append(r)
    return rows


def markdown(rows, devices, times):
    lines = ["# Kernels", "",
             "Made by `scripts/kernel_sheet.py`. Registers, spills and shared memory are ptxas's, operations and bytes are "
             "counted by executing the kernels on the host (`kernel_counts`). Scenes: torus-knot-sunset, 64 spheres, "
             "resolution 32; soft-random, map 1024. *unique* bytes are those of different sectors of 32 bytes in a "
             "launch. Floating-point operations only: index arithmetic, comparisons of integers and table look-ups are "
             "not among them.", "",
             "Operations and bytes are per receiver; those of `copy_map` and `build_level` per texel of the map (1024 x "
             "1024), all levels together. Times are for 16384 receivers (128 x 128) or texels. **The columns of devices are a bound, not a measurement**: the "
             "longer of unique bytes at the peak of the device's memory and operations at the peak of its arithmetic "
             "without fused ones. Real kernels are slower; where a cache of the device keeps what one kernel hands "
             "to the next, the memory part does not hold. The kernels need sm_75; the 8800 GTX stands for the papers' "
             "class of device.", ""]
    if times:
        lines += [f"Measured on {times['context']['cuda_device']}, driver {times['context']['cuda_driver']}.", ""]
    head = ["kernel", "technique", "block", "registers 75/80/90/120", "spills", "shared", "occupancy 75/80/90/120, %",
            "operations", "bytes asked", "unique", *[f"**bound** {d}, us" for d in devices]]
    if times:
        head += ["measured, us", "share of peak"]
    lines += ["| " + " | ".join(head) + " |", "|" + "---|" * len(head)]
    for r in rows:
        cells = [f"`{r['kernel']}`", r["technique"], r["block"], "/".join(str(r[f"registers sm_{a}"]) for a in ARCHITECTURES),
                 sum(r[f"spills sm_{a}"] for a in ARCHITECTURES), r["shared bytes"],
                 "/".join(f"{100 * r[f'occupancy sm_{a}']:.0f}" for a in ARCHITECTURES), f"{r['operations / receiver']:.0f}",
                 f"{r['bytes asked / receiver']:.0f}", f"{r['bytes unique / receiver']:.0f}",
                 *[f"{r[f'bound {d}, us']:.3g}" for d in devices]]
        if times:
            cells += [r["measured, us"], r["share of peak"]]
        lines.append("| " + " | ".join(str(c) for c in cells) + " |")
    low = [r for r in rows if r["occupancy sm_80"] < 0.5]
    if low:
        why = reasons()
        lines += ["", "## Below half occupancy on sm_80", ""]
        for r in low:
            reason = why.get(r["kernel"].split("<")[0])
            if not reason:
                sys.exit(f"kernel_sheet: {r['kernel']} has {r['occupancy sm_80']:.0%} occupancy on sm_80; say why in its source: // Occupancy of {r['kernel'].split('<')[0]}: ...")
            lines.append(f"- `{r['kernel']}` ({100 * r['occupancy sm_80']:.0f} %): {reason}.")
    return "\n".join(lines) + "\n"


def parse_device(text):
    name, bandwidth, teraflops = text.rsplit(":", 2)
    return name, (float(bandwidth), float(teraflops))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--counts", type=Path, default=ROOT / "build/kernel_counts.json")
    parser.add_argument("--times", type=Path, help="JSON of kernel_times")
    parser.add_argument("--out", type=Path, default=ROOT / "results/kernels")
    parser.add_argument("--device", action="append", type=parse_device, default=[],
                        help="NAME:GB/S:TFLOP/S (single precision, multiply-add as two), besides the usual ones")
    args = parser.parse_args()
    if not args.counts.exists():
        subprocess.run(["cmake", "--build", "--preset", "release", "--target", "kernel_counts"], cwd=ROOT, check=True)
        subprocess.run([ROOT / "build/release/kernel_counts", args.counts], check=True)
    counts = json.loads(args.counts.read_text())
    with ThreadPoolExecutor(2) as pool:
        jobs = {(a, s): pool.submit(compile_resources, s, a) for a in ARCHITECTURES for s in sources()}
    resources = {a: {k: v for s in sources() for k, v in jobs[a, s].result().items()} for a in ARCHITECTURES}
    spilled = [(a, k) for a in ARCHITECTURES for k, v in resources[a].items() if v["spills"]]
    devices = {**DEVICES, **dict(args.device)}
    times = json.loads(args.times.read_text()) if args.times else None
    rows = sheet(counts, resources, devices, times)
    args.out.mkdir(parents=True, exist_ok=True)
    (args.out / "sheet.md").write_text(markdown(rows, devices, times))
    with (args.out / "sheet.csv").open("w", newline="") as f:
        writer = csv.DictWriter(f, rows[0].keys(), lineterminator="\n")
        writer.writeheader()
        writer.writerows(rows)
    print(f"{args.out}/sheet.md: {len(rows)} kernels, {len(spilled)} with spills {spilled or ''}")
    if spilled:
        sys.exit(1)


if __name__ == "__main__":
    main()
