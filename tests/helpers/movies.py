"""Tiny movies that FFmpeg makes, and its own frames of them."""

from __future__ import annotations

import functools
import shutil
import subprocess
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray

#: A test picture that moves, with noise; its chroma changes from pixel to pixel.
SOURCE = "testsrc2=size=128x96:rate=24:duration={seconds},noise=alls=20:allf=t"

#: Options by which FFmpeg encodes what users have.
CODECS = {
    "h264": ("h264.mp4", "-c:v libx264 -preset ultrafast -pix_fmt yuv420p"),
    "h264 full range": ("h264_full.mp4", "-c:v libx264 -preset ultrafast -pix_fmt yuv420p -color_range pc"),
    "h264 4:2:2": ("h264_422.mp4", "-c:v libx264 -preset ultrafast -pix_fmt yuv422p"),
    "hevc": ("hevc.mp4", "-c:v libx265 -preset ultrafast -x265-params log-level=error -pix_fmt yuv420p"),
    "hevc 10 bits": ("hevc10.mp4", "-c:v libx265 -preset ultrafast -x265-params log-level=error -pix_fmt yuv420p10le"),
    "prores": ("prores.mov", "-c:v prores_ks -profile:v 3 -pix_fmt yuv422p10le"),
    "prores 4444": ("prores4444.mov", "-c:v prores_ks -profile:v 4444 -pix_fmt yuv444p10le"),
    "vp9": ("vp9.webm", "-c:v libvpx-vp9 -deadline realtime -cpu-used 8 -pix_fmt yuv420p"),
    "av1": ("av1.mp4", "-c:v libaom-av1 -cpu-used 8 -usage realtime -pix_fmt yuv420p"),
    "av1 10 bits": ("av1_10.mkv", "-c:v libaom-av1 -cpu-used 8 -usage realtime -pix_fmt yuv420p10le"),
    "motion jpeg": ("mjpeg.mov", "-c:v mjpeg -q:v 2 -pix_fmt yuvj420p"),
    "uncompressed": ("raw.mov", "-c:v rawvideo -pix_fmt uyvy422 -tag:v 2vuy"),
    "animation": ("rle.mov", "-c:v qtrle -pix_fmt rgb24"),
}


#: Options by which FFmpeg encodes two fields a frame.
INTERLACED = "-vf interlace -c:v libx264 -preset ultrafast -flags +ildct+ilme -pix_fmt yuv420p"


def run_ffmpeg(*arguments: object) -> bytes:
    """Run FFmpeg and return what it writes to its standard output; skip the test where it, or an encoder, is absent."""
    if shutil.which("ffmpeg") is None:
        pytest.skip("needs ffmpeg")
    command = ["ffmpeg", "-v", "error", "-nostdin", "-y", *map(str, arguments)]
    done = subprocess.run(command, capture_output=True)
    message = done.stderr.decode(errors="replace")
    if "Unknown encoder" in message or "No such filter" in message:
        pytest.skip(f"needs an ffmpeg with more: {message.splitlines()[0]}")
    assert done.returncode == 0, message
    return done.stdout


def make_movie(
    path: Path, options: str = "-c:v libx264 -preset ultrafast", *, seconds: float = 0.25, source: str = SOURCE
) -> Path:
    """Write a movie of a moving test picture, 24 frames per second, and return its path."""
    run_ffmpeg("-f", "lavfi", "-i", source.format(seconds=seconds), *options.split(), path)
    return path


@functools.cache
def ffmpeg_frames(
    path: Path, matrix: str, full: bool, centered: bool, bits: int, size: tuple[int, int], crop: str = "null"
) -> NDArray[np.integer]:
    """Return FFmpeg's own frames as RGB codes of `bits`, converted by zimg, shape (frames, H, W, 3)."""
    form = "gbrp" if bits == 8 else f"gbrp{bits}le"
    options = (
        f"matrixin={matrix}:rangein={'full' if full else 'limited'}:matrix=gbr:range=full:filter=bilinear"
        f":dither=none:chromalin={'center' if centered else 'left'}"
    )
    convert = "null" if matrix == "gbr" else f"zscale={options}"
    filters = f"{crop},{convert},format={form}"
    raw = run_ffmpeg("-i", path, "-vsync", "passthrough", "-vf", filters, "-f", "rawvideo", "-")
    width, height = size
    planes = np.frombuffer(raw, np.uint8 if bits == 8 else "<u2").reshape(-1, 3, height, width)  # G, B, R
    return planes[:, [2, 0, 1]].transpose(0, 2, 3, 1)
