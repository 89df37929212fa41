"""Tiny movies that PyAV writes."""

import shutil
import subprocess

import numpy as np
import pytest


def run_ffmpeg(*arguments):
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


def pictures(count, size=(128, 96)):
    """Yield RGB pictures, shape (H, W, 3): a texture that moves, and frame n has a bar of code 8 n at its top."""
    width, height = size
    x, y = np.meshgrid(np.arange(width), np.arange(height))
    for number in range(1, count + 1):
        waves = [127 + 110 * np.sin((x + 7 * number) / (9 + k)) * np.cos(y / (11 + 2 * k)) for k in range(3)]
        picture = np.stack(waves, 2).astype(np.uint8)
        picture[: height // 8] = 8 * number % 256
        yield picture


def write_movie(
    path,
    count=6,
    *,
    codec="libx264",
    form="yuv420p",
    size=(128, 96),
    options=None,
    tags=None,
    metadata=None,
    images=None,
    times=None,
    is_interlaced=False,
    degrees=0,
    muxer=None,
    **stream_attributes,
):
    """Write a movie of 24 frames per second and return its path, whose suffix names the container.

    `tags` are attributes of the codec's context: "color_range", "colorspace", "color_trc", "color_primaries".
    `images` are uint8, shape (H, W, 3), by default `pictures`; `times` are in 1/24 second, by default consecutive.
    `options` and `muxer` go to the encoder and the container; an interlaced movie has frames of two fields. `degrees`
    are those by which a player turns the frames.
    """
    av = pytest.importorskip("av", reason="needs PyAV: the extra video")
    if codec not in av.codecs_available:
        pytest.skip(f"needs a PyAV with {codec}")
    options = {"preset": "ultrafast", **(options or {})} if codec.startswith("libx26") else dict(options or {})
    if codec == "libx265":
        options = {"x265-params": "log-level=error", **options}
    with av.open(str(path), "w", options=dict(muxer or {})) as container:
        container.metadata.update(metadata or {})
        stream = container.add_stream(codec, rate=24, options=options)
        (stream.width, stream.height), stream.pix_fmt = size, form
        for name, value in {**(tags or {}), **({"flags": 1 << 18 | 1 << 29} if is_interlaced else {})}.items():
            setattr(stream.codec_context, name, value)
        for name, value in stream_attributes.items():
            setattr(stream, name, value)
        color = {f"dst_{name}": value for name, value in (tags or {}).items() if name in ("color_range", "colorspace")}
        if degrees:
            stream.set_display_rotation(degrees)
        images = pictures(count, size) if images is None else images
        for time, image in zip(range(count) if times is None else times, images, strict=False):
            frame = av.VideoFrame.from_ndarray(image, format="rgb24").reformat(format=form, **color)
            frame.pts = time
            container.mux(stream.encode(frame))
        container.mux(stream.encode())
    return path
