"""ICC profiles and EXIF data made by hand, and pictures that carry them."""

import struct

import numpy as np
from PIL import ExifTags, Image

from crfnet_core.colorimetry import D50, Primaries, adaptation, xyz_of
from tests.helpers.images import write_image

#: Primaries of a display that is none of the named ones, with the white of an old lamp.
OWN = Primaries("own", (0.66, 0.34), (0.24, 0.67), (0.145, 0.055), (0.333, 0.342))

#: The element of a curve of gamma 2.2.
GAMMA = b"curv" + struct.pack(">IIHH", 0, 1, round(2.2 * 256), 0)


def matrix_profile(primaries, *, version=4, states_adaptation=True, curves=(GAMMA,) * 3, **more):
    """Return an ICC profile of a matrix and of curves of R, G and B; `more` are further tags, or others in their place.

    Version 4 says by the tag `chad` how it was adapted to D50; version 2 without it by the media white `wtpt`.
    """
    to_d50 = adaptation(primaries.white, D50)
    columns = to_d50 @ primaries.to_xyz()
    white = xyz_of(D50) if version >= 4 else xyz_of(primaries.white)
    tags = {
        **{f"{name}XYZ": numbers(b"XYZ ", column) for name, column in zip("rgb", columns.T, strict=True)},
        **{f"{name}TRC": curve for name, curve in zip("rgb", curves, strict=True)},
        "wtpt": numbers(b"XYZ ", white),
        **({"chad": numbers(b"sf32", to_d50.ravel())} if states_adaptation else {}),
        **more,
    }
    return profile(tags, version=version)


def profile(tags, *, version=4, color=b"RGB ", pcs=b"XYZ "):
    """Return an ICC profile of these tagged elements."""
    table, content = struct.pack(">I", len(tags)), b""
    start = 128 + 4 + 12 * len(tags)
    for name, element in tags.items():
        table += struct.pack(">4sII", name.encode(), start + len(content), len(element))
        content += element.ljust(-(-len(element) // 4) * 4, b"\0")
    size = start + len(content)
    head = struct.pack(">I4sB3s4s4s4s12s4s", size, b"test", version, bytes(3), b"mntr", color, pcs, bytes(12), b"acsp")
    return head.ljust(128, b"\0") + table + content


def numbers(kind, values):
    """Return an element of s15Fixed16 numbers."""
    fixed = np.rint(np.ravel(values) * 65536).astype(int).tolist()
    return kind + bytes(4) + struct.pack(f">{len(fixed)}i", *fixed)


def sampled_curve(light):
    """Return the element of a curve of 4096 entries: light in [0, 1] of codes in [0, 1]."""
    entries = np.clip(np.rint(light(np.linspace(0, 1, 4096)) * 65535), 0, 65535).astype(">u2")
    return b"curv" + struct.pack(">II", 0, 4096) + entries.tobytes()


def named(name):
    """Return the tag that describes a profile."""
    text = name.encode("utf-16-be")
    return {"desc": b"mluc" + struct.pack(">4xII4sII", 1, 12, b"enUS", len(text), 28) + text}


def write_tagged(path, codes, icc, **attributes):
    """Write code values with an ICC profile; JPEG without chroma subsampling."""
    import OpenImageIO as oiio

    content = (oiio.TypeDesc(f"uint8[{len(icc)}]"), np.frombuffer(icc, np.uint8))
    return write_image(
        path, codes, ICCProfile=content, Compression="jpeg:100" if path.suffix == ".jpg" else "none", **attributes
    )


def exif_segment(index):
    """Return an EXIF segment of JPEG with an uncalibrated ColorSpace and an InteroperabilityIndex."""
    exif = Image.Exif()
    exif.get_ifd(ExifTags.IFD.Exif).update({0xA001: 65535, 0xA005: {1: index}})
    return exif.tobytes()
