"""Make the HEIC and AVIF files of this folder: ``pip install pillow-heif; python tests/data/heif/make_heif.py``.

Needs ffmpeg with libaom, and avifenc, for AVIF. HEIC is lossless, so tests compare codes. pillow-heif is not needed
by the tests: its wheel holds x265, which is under the GPL.
"""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pillow_heif
from PIL import Image, ImageCms

HERE = Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parents[2]))

from tests.helpers.colored_ramp import colored_ramp  # noqa: E402

#: Name -> bits, matrix coefficients and full range flag (ITU-T H.273).
FILES = {"rgb8": (8, 0, 1), "full8": (8, 1, 1), "limited8": (8, 1, 0), "rgb10": (10, 0, 1), "limited10": (10, 9, 0)}


def heic(bits: int) -> pillow_heif.HeifFile:
    """Return the ramp, ready to be saved."""
    codes = colored_ramp(bits)
    mode, samples = ("RGB", codes) if bits == 8 else ("RGB;16", codes << (16 - bits))
    height, width, _ = codes.shape
    return pillow_heif.from_bytes(mode=mode, size=(width, height), data=samples.tobytes())


def exif() -> bytes:
    """Return the EXIF of a phone that was held upright."""
    tags = Image.Exif()
    tags[0x010F], tags[0x0110], tags[0x0112] = "Apple", "iPhone 15", 6
    return tags.tobytes()


def main() -> None:
    """Write all files."""
    for name, (bits, matrix, full) in FILES.items():
        options = {"quality": -1, "chroma": 444, "matrix_coefficients": matrix, "full_range_flag": full}
        options |= {"color_primaries": 12, "transfer_characteristic": 13}
        heic(bits).save(HERE / f"{name}.heic", **options)
    phone = Image.fromarray(colored_ramp(8))
    profile = ImageCms.ImageCmsProfile(ImageCms.createProfile("sRGB")).tobytes()
    pillow_heif.register_heif_opener()
    phone.save(HERE / "phone.heic", quality=-1, chroma=444, matrix_coefficients=0, exif=exif(), icc_profile=profile)
    avif10(HERE / "limited10.avif")
    phone.putalpha(128)
    phone.save(HERE / "ramp.png")
    avifenc = ["avifenc", "--speed", "8", "--max", "20", str(HERE / "ramp.png")]
    subprocess.run([*avifenc, "--depth", "10", str(HERE / "alpha10.avif")], check=True)
    subprocess.run([*avifenc, "--clap", "32,1,24,1,0,1,0,1", "--ignore-alpha", str(HERE / "cropped8.avif")], check=True)
    (HERE / "ramp.png").unlink()


def avif10(path: Path) -> None:
    """Write the ramp as AVIF of 10 bits and limited range."""
    codes = colored_ramp(10)
    size = f"{codes.shape[1]}x{codes.shape[0]}"
    command = ["ffmpeg", "-y", "-v", "error", "-f", "rawvideo", "-pix_fmt", "rgb48le", "-s", size, "-i", "-"]
    command += ["-vf", "scale=out_color_matrix=bt709:out_range=tv,format=yuv444p10le", "-c:v", "libaom-av1"]
    command += ["-still-picture", "1", "-crf", "0", "-color_range", "tv", "-colorspace", "bt709"]
    command += ["-color_primaries", "smpte432", "-color_trc", "iec61966-2-1", str(path)]
    subprocess.run(command, input=(codes << 6).tobytes(), check=True)


if __name__ == "__main__":
    main()
