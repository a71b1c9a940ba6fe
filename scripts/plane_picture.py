"""Draws how a plane of receivers lies in its image: the truth of a scene, its mesh from above, and the axes.

    .venv/bin/python scripts/plane_picture.py      # writes docs/plane.png
"""

import json
import pathlib
import subprocess
import tempfile

import numpy
from PIL import Image, ImageDraw

ROOT = pathlib.Path(__file__).resolve().parent.parent
SCENE = "bunny-lamp-small"
SIZE, MARGIN = 512, 64  # pixels


def positions(path: pathlib.Path) -> numpy.ndarray:
    """x, y and z of the vertices of an exported PLY."""
    head, data = path.read_bytes().split(b"end_header\n", 1)
    words = [line.split() for line in head.decode().splitlines()]
    floats = numpy.dtype([(w[2], "<f4") for w in words if w[:2] == ["property", "float"]])
    count = next(int(w[2]) for w in words if w[:2] == ["element", "vertex"])
    points = numpy.frombuffer(data, floats, count)
    return numpy.stack([points["x"], points["y"], points["z"]], axis=1)


def arrow(draw: ImageDraw.ImageDraw, begin: tuple, end: tuple, colour: str) -> None:
    draw.line([begin, end], fill=colour, width=3)
    along = numpy.subtract(end, begin) / numpy.linalg.norm(numpy.subtract(end, begin))
    beside = numpy.array([-along[1], along[0]])
    tips = [end, tuple(end - 12 * along + 6 * beside), tuple(end - 12 * along - 6 * beside)]
    draw.polygon([tuple(tip) for tip in tips], fill=colour)


def main() -> None:
    program = ROOT / "build" / "release" / "penumbra"
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        scene = folder / "scene.toml"  # without its spheres, which would be fitted first
        lines = (ROOT / "scenes" / "library" / f"{SCENE}.toml").read_text().splitlines()
        scene.write_text("\n".join(line for line in lines if not line.startswith("spheres")) + "\n")
        subprocess.run([program, "export", scene, "-o", folder], check=True, stdout=subprocess.DEVNULL)
        subprocess.run([program, "reference", scene, "-o", folder / "truth.png"], check=True, stdout=subprocess.DEVNULL)
        exported = json.loads((folder / "scene.json").read_text())
        plane, lamp = exported["receivers"], exported["light"]["centre"]
        mesh = positions(folder / "mesh.ply")
        truth = Image.open(folder / "truth.png").convert("RGB").resize((SIZE, SIZE), Image.NEAREST)

    half, (centre_x, _, centre_z) = plane["half_extent"], plane["centre"]

    def place(x: float, z: float) -> tuple:
        """Where a point of the plane lies on the sheet."""
        return (MARGIN + SIZE * (0.5 + 0.5 * (x - centre_x) / half), MARGIN + SIZE * (0.5 + 0.5 * (z - centre_z) / half))

    sheet = Image.new("RGB", (SIZE + 2 * MARGIN, SIZE + 2 * MARGIN), "white")
    sheet.paste(truth, (MARGIN, MARGIN))
    shade = Image.new("L", sheet.size, 0)
    dots = ImageDraw.Draw(shade)
    for x, _, z in mesh:
        dots.ellipse([*(v - 1.5 for v in place(x, z)), *(v + 1.5 for v in place(x, z))], fill=170)
    sheet.paste(Image.new("RGB", sheet.size, "orange"), mask=shade)

    draw = ImageDraw.Draw(sheet)
    arrow(draw, place(0, 0), place(0.7 * half, 0), "red")
    arrow(draw, place(0, 0), place(0, 0.7 * half), "blue")
    draw.text(place(0.73 * half, -0.02 * half), "+x", fill="red", font_size=18)
    draw.text(place(0.03 * half, 0.68 * half), "+z", fill="blue", font_size=18)
    draw.text(place(0.03 * half, -0.1 * half), "+y towards you", fill="black", font_size=16)
    for x, z, anchor, where in [(-1, -1, "lb", "pixel (0, 0): "), (1, -1, "rb", ""), (-1, 1, "lt", ""), (1, 1, "rt", "last pixel: ")]:
        draw.text(place(centre_x + x * half, centre_z + z * half), f"{where}x = {centre_x + x * half:g}, z = {centre_z + z * half:g}",
                  fill="black", anchor=anchor, font_size=14)
    x, z = place(lamp[0], lamp[2])
    draw.ellipse([x - 9, z - 9, x + 9, z + 9], fill="yellow", outline="black")
    draw.text((x + 14, z - 8), "lamp", fill="black", font_size=16)
    draw.text((MARGIN, 10), f"{SCENE}, its mesh (orange) and its lamp from above", fill="black", font_size=16)
    sheet.quantize(128).save(ROOT / "docs" / "plane.png", optimize=True)


if __name__ == "__main__":
    main()
