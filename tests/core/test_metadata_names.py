"""Makers, models and programs: what kind of device a camera's name means, and which programs edit."""

import pytest

from crfnet_core.photograph.metadata.devices import Device, camera_name, device_of
from crfnet_core.photograph.metadata.editors import editor_name

PHONES = [
    ("Apple", "iPhone 13 Pro"),
    ("Google", "Pixel 6"),
    ("HUAWEI", "VOG-L29"),
    ("HMD Global", "Nokia 7.2"),
    ("LGE", "Nexus 5"),
    ("LG Electronics", "LG-H870"),
    ("OnePlus", "ONEPLUS A6003"),
    ("Panasonic", "DMC-CM1"),
    ("samsung", "SM-G960U"),
    ("SAMSUNG", "GT-I9300"),
    ("samsung", "SAMSUNG-SM-G920A"),
    ("SAMSUNG", "SAMSUNG-SGH-I747"),
    ("Sony", "D6503"),
    ("Sony", "G8341"),
    ("Sony", "SO-01J"),
    ("Sony", "XQ-CT72"),
    ("Sony Ericsson", "LT26i"),
    ("Xiaomi", "M2007J17C"),
    ("motorola", "moto g(7)"),
    ("vivo", "V2025"),
]

COMPACTS = [
    ("CASIO COMPUTER CO.,LTD.", "EX-Z750"),
    ("Canon", "Canon DIGITAL IXUS 60"),
    ("Canon", "Canon PowerShot G7"),
    ("EASTMAN KODAK COMPANY", "KODAK DC240 ZOOM DIGITAL CAMERA"),
    ("FUJIFILM", "FinePix S5000"),
    ("FUJIFILM", "FinePix X100"),
    ("FUJIFILM", "X-S1"),
    ("FUJIFILM", "X100V"),
    ("FUJIFILM", "X20"),
    ("FUJIFILM", "XF10"),
    ("Hewlett-Packard", "HP PhotoSmart 735"),
    ("Leica Camera AG", "LEICA Q2"),
    ("LEICA", "D-LUX 3"),
    ("NIKON", "COOLPIX P900"),
    ("NIKON", "E990"),
    ("OLYMPUS IMAGING CORP.", "SP570UZ"),
    ("OLYMPUS OPTICAL CO.,LTD", "E-20,E-20N,E-20P"),
    ("Panasonic", "DC-TZ90"),
    ("Panasonic", "DMC-LC1"),
    ("Panasonic", "DMC-LX7"),
    ("PENTAX Corporation", "PENTAX Optio S4"),
    ("RICOH IMAGING COMPANY, LTD.", "RICOH GR III"),
    ("RICOH      ", "Caplio GX100   "),
    ("SAMSUNG", "EX2F "),
    ("SAMSUNG", "WB150F"),
    ("SIGMA", "SIGMA DP2 Merrill"),
    ("SONY", "DSC-RX100M3"),
    ("SONY", "ZV-1"),
    ("Minolta Co., Ltd.", "DiMAGE 7i"),
]

CAMERAS = [
    ("Canon", "Canon EOS 350D DIGITAL"),
    ("Canon", "Canon EOS R5"),
    ("Canon", "Canon EOS-1D X"),
    ("FUJIFILM", "GFX 50S"),
    ("FUJIFILM", "FinePix S5Pro"),
    ("FUJIFILM", "X-E1"),
    ("FUJIFILM", "X-Pro3"),
    ("FUJIFILM", "X-S10"),
    ("Hasselblad", "X1D II 50C"),
    ("KONICA MINOLTA", "DYNAX 5D"),
    ("Kodak", "DCS Pro SLR/n"),
    ("LEICA CAMERA AG", "LEICA M10"),
    ("NIKON CORPORATION", "NIKON D90"),
    ("NIKON CORPORATION", "NIKON Z 6"),
    ("NIKON CORPORATION", "NIKON Z6_2"),
    ("NIKON CORPORATION", "NIKON 1 J5"),
    ("OLYMPUS CORPORATION", "E-M10MarkII"),
    ("OLYMPUS IMAGING CORP.", "E-PL1"),
    ("OM Digital Solutions", "OM-1"),
    ("Panasonic", "DC-GH5"),
    ("Panasonic", "DC-S5"),
    ("Panasonic", "DMC-GF7"),
    ("Panasonic", "DMC-L10"),
    ("PENTAX", "PENTAX *ist DS"),
    ("PENTAX", "PENTAX K-5"),
    ("RICOH IMAGING COMPANY, LTD.", "PENTAX K-3 Mark III"),
    ("SAMSUNG", "NX300"),
    ("SIGMA", "SIGMA fp L"),
    ("SONY", "DSLR-A700"),
    ("SONY", "ILCE-7RM2"),
    ("SONY", "NEX-5N"),
    ("SONY", "SLT-A77V"),
    ("SONY", "ZV-E10"),
    ("", "NIKON D90"),
]

SCANNERS = [
    ("Nikon", "SUPER COOLSCAN 5000 ED"),
    ("NORITSU KOKI", "QSS-32_33"),
    ("FUJIFILM", "SP-3000"),
    ("EPSON", "Perfection V700"),
    ("Canon", "CanoScan 9000F"),
    ("Hewlett-Packard", "HP Scanjet G4050"),
    ("Hasselblad", "Flextight X5"),
]

UNKNOWN = [
    ("", ""),
    ("DJI", "FC220"),
    ("GoPro", "HERO9 Black"),
    ("Hasselblad", "L1D-20c"),
    ("RICOH", "RICOH THETA S"),
    ("SONY", "HDR-CX405"),
    ("Canon", "Canon LEGRIA HF R86"),
    ("Panasonic", "HC-V770"),
    ("ARRI", "ALEXA Mini"),
    ("Nobody", "D90"),
]

KINDS = {
    Device.PHONE: PHONES,
    Device.COMPACT: COMPACTS,
    Device.CAMERA: CAMERAS,
    Device.SCANNER: SCANNERS,
    Device.UNKNOWN: UNKNOWN,
}


@pytest.mark.parametrize(
    ("make", "model", "device"), [(*names, device) for device, cameras in KINDS.items() for names in cameras]
)
def test_kind_of_device(make, model, device):
    assert device_of(make, model) == device


@pytest.mark.parametrize(
    ("make", "model", "name"),
    [
        ("Canon", "Canon EOS 20D", "Canon EOS 20D"),
        ("NIKON CORPORATION", "NIKON D90", "NIKON D90"),
        ("OLYMPUS IMAGING CORP.", "E-PL1", "OLYMPUS E-PL1"),
        ("RICOH      ", "Caplio GX100   ", "RICOH Caplio GX100"),
        ("samsung", "SM-G960U", "samsung SM-G960U"),
        ("", "NIKON D90", "NIKON D90"),
        ("Apple", "", "Apple"),
        ("", "", ""),
    ],
)
def test_the_makers_name_is_said_once(make, model, name):
    assert camera_name(make, model) == name


@pytest.mark.parametrize(
    "software",
    [
        "Adobe Photoshop CS6 (Windows)",
        "Adobe Photoshop Lightroom Classic 9.2 (Macintosh)",
        "Capture One 20 Windows",
        "DxO PhotoLab 4.0",
        "easyHDR 3.13",
        "GIMP 2.10.8",
        "Google",
        "ImageMagick 6.9",
        "Photomatix Pro 4.2",
        "Photos 3.0",
        "Picasa",
        "RawTherapee 5.8",
        "Snapseed 2.0",
        "Windows Photo Editor 10.0.10011.16384",
        "darktable 3.4.0",
        "paint.net 4.2",
    ],
)
def test_programs_that_edit(software):
    assert editor_name(software) == software


@pytest.mark.parametrize(
    "software",
    [
        "",
        "15.3.1",
        "64.2.A.2.134_0_0",
        "305224",
        "Digital Camera X-E1 Ver2.00",
        "Firmware Version 1.1.1",
        "G960USQS9FUG2",
        "HDR+ 1.0.345618096zd",
        "ILCE-6000 v3.21",
        "MediaTek Camera Application",
        "Microsoft Windows Photo Viewer 6.1.7600.16385",
        "Ver.1.02",
    ],
)
def test_firmware_and_viewers_do_not_edit(software):
    assert editor_name(software) == ""


def test_the_last_editor_of_the_history_counts_where_the_software_is_firmware():
    assert editor_name("Ver.1.0", ("GIMP 2.8", "Adobe Photoshop CS4", "Ver.2")) == "Adobe Photoshop CS4"
