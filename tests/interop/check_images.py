"""Slices and stacks of images, written by Pillow and read by wavelift, and the other way round.

python check_images.py --wavelift BIN [--data DIR], in a scratch folder. Ends with a message and not 0 if values differ.
"""

import argparse
import pathlib
import subprocess

import numpy as np
from PIL import Image, PngImagePlugin


def arguments():
    parser = argparse.ArgumentParser()
    parser.add_argument("--wavelift", required=True)
    parser.add_argument("--data")
    return parser.parse_args()


def same(name, found, expected):
    """Stops unless two arrays have the same type, shape and values."""
    if found.dtype != expected.dtype or found.shape != expected.shape or not np.array_equal(found, expected):
        raise SystemExit(f"{name}: {found.dtype} {found.shape} is not as expected, {expected.dtype} {expected.shape}")


class Check:
    def __init__(self, wavelift):
        self.wavelift = wavelift
        self.count = 0

    def convert(self, source, target):
        subprocess.run([self.wavelift, "convert", str(source), str(target)], check=True)
        self.count += 1

    def refuse(self, source, target, message):
        """wavelift says no, and why."""
        run = subprocess.run([self.wavelift, "convert", str(source), str(target)], capture_output=True, text=True)
        if run.returncode == 0 or message not in run.stderr:
            raise SystemExit(f"{source} to {target}: no {message!r} in {run.returncode} {run.stderr!r}")
        self.count += 1

    def png_slices(self, volume):
        """A stack by pattern, by folder, to NumPy and back to PNG and PGM."""
        folder = pathlib.Path("png")
        folder.mkdir()
        for z, plane in enumerate(volume):
            Image.fromarray(plane).save(folder / f"s{z + 1}.png")
        for number, source in enumerate([folder / "s%d.png", folder / "*.png", folder]):
            self.convert(source, f"from_png{number}.npy")
            same(f"{source}", np.load(f"from_png{number}.npy"), volume)
        for pattern in ["new/out_%03d.png", "new/out_###.pgm"]:
            self.convert("from_png0.npy", pattern)
            extension = pattern[-3:]
            files = sorted(pathlib.Path("new").glob(f"out_*.{extension}"))
            planes = [np.asarray(Image.open(file)).astype(volume.dtype) for file in files]
            same(pattern, np.stack(planes), volume)
        self.refuse("from_png0.npy", "new/out_%03d.png", "there already")
        (folder / "s2.png").unlink()
        self.refuse(folder, "gap.npy", "s2.png")

    def png_metadata(self):
        """Texts and the size of pixels come back."""
        texts = PngImagePlugin.PngInfo()
        texts.add_text("Title", "Größe")
        texts.add_itxt("Author", "Ωmega")
        picture = Image.fromarray(np.arange(60, dtype=np.uint8).reshape(5, 4, 3))
        picture.save("a.png", pnginfo=texts, dpi=(300, 150))
        self.convert("a.png", "b.png")
        with Image.open("a.png") as a, Image.open("b.png") as b:
            same("a.png", np.asarray(b), np.asarray(a))
            if a.info != b.info or "Title" not in a.info:
                raise SystemExit(f"a.png has {a.info}, b.png {b.info}")

    def png_modes(self):
        """Bits, alpha and palettes."""
        grey = np.arange(64, dtype=np.uint8).reshape(8, 8)
        for mode in ["1", "L", "LA", "RGB", "RGBA", "P", "I;16"]:
            picture = Image.fromarray(grey.astype(np.uint16) * 999) if mode == "I;16" else Image.fromarray(grey).convert(mode)
            picture.save("mode.png")
            self.convert("mode.png", "again.png")
            expected = picture.convert("RGB") if mode == "P" else picture
            with Image.open("again.png") as again:
                same(f"mode {mode}", np.asarray(again), np.asarray(expected))


def main():
    given = arguments()
    check = Check(given.wavelift)
    random = np.random.default_rng(7)
    check.png_slices(random.integers(0, 65536, (11, 6, 7), dtype=np.uint16))
    check.png_metadata()
    check.png_modes()
    print(f"images: {check.count} conversions right")


main()
