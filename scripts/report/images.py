"""Pictures of a run, packed for the page: float pixels for the viewer, small pictures for pointing at rows.

A value v becomes sign(v) round(4095 sqrt(|v| / s)), where s is white at the scene's exposure: 0.05 % of white at white, and
finer below. The planes G, R - G and B - G are predicted from their neighbours (the median edge detector of JPEG-LS), and
what is left is deflated; js/codec.js undoes that.
"""

import base64
import io
import pathlib
import zlib

import numpy
import OpenEXR
from PIL import Image

LEVELS = 4095
LARGEST_LEVEL = 16383  # so that differences of channels fit into 16 bits
THUMBNAIL = 144        # pixels, of the longer side
LUMINANCE = numpy.array([0.2126, 0.7152, 0.0722], numpy.float32)


def read_exr(path: pathlib.Path) -> numpy.ndarray:
    """height x width x 3 floats; grey is repeated, alpha is passed over."""
    with OpenEXR.File(str(path), separate_channels=True) as file:
        channels = {name: channel.pixels for name, channel in file.channels().items()}
    names = ["R", "G", "B"] if "G" in channels else ["Y"] * 3
    return numpy.stack([channels[name] for name in names], axis=-1).astype(numpy.float32)


def encode_srgb(linear: numpy.ndarray) -> numpy.ndarray:
    linear = numpy.clip(numpy.nan_to_num(linear), 0.0, 1.0)
    return numpy.where(linear <= 0.0031308, 12.92 * linear, 1.055 * linear ** (1 / 2.4) - 0.055)


def exposure_of(truth: numpy.ndarray, picture: pathlib.Path) -> float:
    """What the run exposed this truth by: read off the picture beside it, which knows the receivers that count; without one,
    its rule over all pixels (the brightest percentile becomes 0.8 of white)."""
    luminance = numpy.nan_to_num(truth) @ LUMINANCE
    try:
        shown = numpy.asarray(Image.open(picture).convert("RGB"), numpy.float32) / 255
        if shown.shape == truth.shape:
            linear = numpy.where(shown <= 0.04045, shown / 12.92, ((shown + 0.055) / 1.055) ** 2.4)
            middle = (shown > 0.25) & (shown < 0.95) & (truth > 0)
            if middle.sum() >= 16:
                return float(linear[middle].sum() / truth[middle].sum())
    except (OSError, ValueError):
        pass
    white = float(numpy.quantile(luminance, 0.99)) or float(luminance.max())
    return 0.8 / white if white > 0 else 1.0


def halved(image: numpy.ndarray) -> numpy.ndarray:
    h, w = image.shape[0] // 2 * 2, image.shape[1] // 2 * 2
    return image[:h, :w].reshape(h // 2, 2, w // 2, 2, -1).mean(axis=(1, 3))


def residuals(plane: numpy.ndarray) -> numpy.ndarray:
    """What the median of left, upper, and left + upper - corner does not foretell."""
    left, upper, corner = (numpy.zeros_like(plane) for _ in range(3))
    left[:, 1:], upper[1:], corner[1:, 1:] = plane[:, :-1], plane[:-1], plane[:-1, :-1]
    least, most = numpy.minimum(left, upper), numpy.maximum(left, upper)
    foretold = numpy.where(corner >= most, least, numpy.where(corner <= least, most, left + upper - corner))
    return plane - foretold


def packed(image: numpy.ndarray, white: float) -> tuple[bytes, float]:
    """The deflated pixels and their scale s; what is not finite is 0."""
    image = numpy.nan_to_num(image, nan=0.0, posinf=0.0, neginf=0.0)
    scale = max(white, float(numpy.abs(image).max(initial=0.0)) * (LEVELS / LARGEST_LEVEL) ** 2) or 1.0
    levels = numpy.rint(numpy.sign(image) * numpy.sqrt(numpy.abs(image) / scale) * LEVELS).astype(numpy.int32)
    red, green, blue = levels[..., 0], levels[..., 1], levels[..., 2]
    out = []
    for plane in (green, red - green, blue - green):
        left = residuals(plane).astype(numpy.int16)  # modulo 2^16, as the reader adds
        zigzag = ((left.astype(numpy.int32) << 1) ^ (left.astype(numpy.int32) >> 15)).astype(numpy.uint16)
        out += [(zigzag & 255).astype(numpy.uint8), (zigzag >> 8).astype(numpy.uint8)]
    return zlib.compress(b"".join(p.tobytes() for p in out), 6), scale


def thumbnail(image: numpy.ndarray, exposure: float) -> str:
    """A data URI of the exposed picture."""
    picture = Image.fromarray((encode_srgb(image * exposure) * 255 + 0.5).astype(numpy.uint8))
    picture.thumbnail((THUMBNAIL, THUMBNAIL), Image.BOX)
    file = io.BytesIO()
    picture.save(file, "WEBP", quality=82, method=2)
    return "data:image/webp;base64," + base64.b64encode(file.getvalue()).decode()


class Picture:
    """One image of the page."""

    def __init__(self, pixels: numpy.ndarray, exposure: float):
        self.exposure = exposure
        self.height, self.width = pixels.shape[:2]
        finite = numpy.isfinite(pixels).all(axis=2)
        self.non_finite = int((~finite).sum())
        self.bad = [int(k) for k in numpy.flatnonzero(~finite)[:4096]]
        self.thumbnail = thumbnail(pixels, exposure)
        self.halvings = 0
        self.pixels = pixels
        self._pack()

    def _pack(self) -> None:
        self.data, self.scale = packed(self.pixels, 1.0 / self.exposure if self.exposure > 0 else 1.0)

    @property
    def size(self) -> int:
        """Bytes on the page."""
        return len(self.data) * 4 // 3

    def halve(self) -> None:
        self.pixels = halved(numpy.nan_to_num(self.pixels, nan=0.0, posinf=0.0, neginf=0.0))
        self.halvings += 1
        self.bad = []
        self._pack()

    def about(self) -> dict:
        h, w = self.pixels.shape[:2]
        return {"w": w, "h": h, "full": [self.width, self.height], "halvings": self.halvings, "scale": self.scale,
                "exposure": self.exposure, "bad": self.bad, "non_finite": self.non_finite, "thumbnail": self.thumbnail}


def fit(pictures: list[Picture], budget: int) -> int:
    """Halves the largest pictures until all are within so many bytes. Returns how many were."""
    total = sum(p.size for p in pictures)
    while total > budget:
        largest = max(pictures, key=lambda p: p.size)
        if min(largest.pixels.shape[:2]) < 32:
            break
        # Equally large ones together: panels side by side keep one resolution where they can.
        for p in [p for p in pictures if p.pixels.shape == largest.pixels.shape]:
            total -= p.size
            p.halve()
            total += p.size
    return sum(p.halvings > 0 for p in pictures)
