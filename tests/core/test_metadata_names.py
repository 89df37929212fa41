import pytest

from crfnet_core.photograph.metadata.devices import Device, camera_name, device_of
from crfnet_core.photograph.metadata.editors import editor_name

#: Kind of device -> make -> models.
CAMERAS: dict[Device, dict[str, tuple[str, ...]]] = {
    Device.PHONE: {
        **{"Apple": ("iPhone 13 Pro",), "LGE": ("Nexus 5",), "Panasonic": ("DMC-CM1",), "KYOCERA": ("KYV47",)},
        **{"samsung": ("SM-G960U", "SAMSUNG-SM-G920A", "SAMSUNG_SM-G900A", "Nexus S", "404SC", "YP-G70")},
        **{"Sony": ("D6503", "G8341", "SO-01J", "XQ-CT72"), "Sony Ericsson": ("LT26i",)},
        **{"Google": ("Pixel 4",), "KODAK": ("EKTRA",), "CASIO": ("CA007",), "LG Electronics": ("LG-H870",)},
    },
    Device.COMPACT: {
        **{"CASIO COMPUTER CO.,LTD.": ("EX-Z750",), "Canon": ("Canon DIGITAL IXUS 60", "Canon PowerShot G7")},
        **{"EASTMAN KODAK COMPANY": ("KODAK DC240 ZOOM DIGITAL CAMERA",), "JK Imaging, Ltd.": ("KODAK PIXPRO AZ421",)},
        **{"LEICA": ("SOFORT 2",), "FUJIFILM": ("FinePix S5000", "FinePix X100", "X-S1", "X100V", "X20", "XF10")},
        **{"Hewlett-Packard": ("HP PhotoSmart 735",), "Leica Camera AG": ("LEICA Q2",)},
        **{"NIKON": ("COOLPIX P900", "E990"), "OLYMPUS IMAGING CORP.": ("SP570UZ",)},
        **{"OLYMPUS OPTICAL CO.,LTD": ("E-20,E-20N,E-20P",), "Panasonic": ("DC-TZ90", "DMC-LC1", "DMC-LX7")},
        **{"PENTAX Corporation": ("PENTAX Optio S4",), "RICOH IMAGING COMPANY, LTD.": ("RICOH GR III",)},
        **{"RICOH      ": ("Caplio GX100   ",), "SAMSUNG": ("EX2F ", "WB150F"), "SIGMA": ("SIGMA DP2 Merrill",)},
        **{"SONY": ("DSC-RX100M3", "ZV-1"), "Minolta Co., Ltd.": ("DiMAGE 7i",), "Apple": ("QuickTake 150",)},
    },
    Device.CAMERA: {
        **{"Canon": ("Canon EOS 350D DIGITAL", "Canon EOS R5", "Canon EOS-1D X")},
        **{"FUJIFILM": ("GFX 50S", "FinePix S5Pro", "X-E1", "X-Pro3", "X-S10"), "Hasselblad": ("X1D II 50C",)},
        **{"Kodak": ("DCS Pro SLR/n",), "LEICA CAMERA AG": ("LEICA M10",)},
        **{"NIKON CORPORATION": ("NIKON D90", "NIKON Z 6", "NIKON Z6_2", "NIKON 1 J5")},
        **{"OLYMPUS CORPORATION": ("E-M10MarkII",), "OM Digital Solutions": ("OM-1",)},
        **{"Panasonic": ("DC-GH5", "DC-S5", "DMC-GF7", "DMC-L10"), "PENTAX": ("PENTAX *ist DS", "PENTAX K-5")},
        **{"RICOH IMAGING COMPANY, LTD.": ("PENTAX K-3 Mark III",), "SAMSUNG": ("NX300",), "SIGMA": ("SIGMA fp L",)},
        **{"SONY": ("DSLR-A700", "ILCE-7RM2", "NEX-5N", "SLT-A77V", "ZV-E10"), "": ("NIKON D90",)},
    },
    Device.SCANNER: {
        **{"Nikon": ("SUPER COOLSCAN 5000 ED",), "NORITSU KOKI": ("QSS-32_33",), "FUJIFILM": ("SP-3000",)},
        **{"EPSON": ("Perfection V700",), "Canon": ("CanoScan 9000F",), "Hewlett-Packard": ("HP Scanjet G4050",)},
        **{"Hasselblad": ("Flextight X5",), "FUJITSU": ("ScanSnap iX500",), "HP": ("Officejet 6600",)},
        **{
            **{"Samsung": ("M2070 Series",), "RICOH": ("Aficio MP C3002",), "SHARP": ("MX-2640N",)},
            "Kodak": ("i2600", "HR 500"),
            "KONICA MINOLTA": ("bizhub C364e", "DiMAGE Scan Dual4"),
        },
    },
    Device.UNKNOWN: {
        **{"": ("",), "Hasselblad": ("L1D-20c",), "RICOH": ("RICOH THETA S",), "NIKON": ("KeyMission 170",)},
        **{"Canon": ("Canon LEGRIA HF R86", "Canon EOS C70"), "Panasonic": ("HC-V770",), "Nobody": ("D90",)},
        **{"Google": ("Street View", "Glass 1"), "LGE": ("LG-R105",), "Apple": ("Apple Vision Pro",)},
        **{"Leica Microsystems": ("MC190 HD",), "OLYMPUS": ("DP74",), "Motorola Solutions": ("V700",)},
        "EPSON": ("MOVERIO BT-40",),
    },
}


@pytest.mark.parametrize(
    ("make", "model", "device"),
    [(make, model, device) for device, makes in CAMERAS.items() for make, models in makes.items() for model in models],
)
def test_kind_of_device(make, model, device):
    assert device_of(make, model) == device


@pytest.mark.parametrize(
    ("make", "model", "name"),
    [
        *(("Canon", "Canon EOS 20D", "Canon EOS 20D"), ("NIKON CORPORATION", "NIKON D90", "NIKON D90")),
        *(("OLYMPUS IMAGING CORP.", "E-PL1", "OLYMPUS E-PL1"), ("", "NIKON D90", "NIKON D90")),
        *(("Apple", "", "Apple"), ("", "", "")),
    ],
)
def test_the_makers_name_is_said_once(make, model, name):
    assert camera_name(make, model) == name


EDITORS = (
    *("Adobe Photoshop CS6 (Windows)", "Capture One 20 Windows", "DxO PhotoLab 4.0", "easyHDR 3.13", "GIMP 2.10.8"),
    *("Google", "Photos 3.0", "SIGMA Photo Pro 5.5", "Windows Photo Editor 10.0.10011.16384", "paint.net 4.2"),
    *("Siril 1.2.4", "Samsung Photo Editor", "PhotoNinja 1.4"),
)

#: Firmware, and a viewer.
OTHERS = (
    *("", "15.3.1", "305224", "Digital Camera X-E1 Ver2.00", "G960USQS9FUG2", "HDR+ 1.0.345618096zd"),
    *("MediaTek Camera Application", "Microsoft Windows Photo Viewer 6.1.7600.16385"),
)


@pytest.mark.parametrize(
    ("software", "editor"), [*zip(EDITORS, EDITORS, strict=True), *((name, "") for name in OTHERS)]
)
def test_programs_that_edit(software, editor):
    assert editor_name(software) == editor


def test_the_last_editor_of_the_history_counts_where_the_software_is_firmware():
    assert editor_name("Ver.1.0", ("GIMP 2.8", "Adobe Photoshop CS4", "Ver.2")) == "Adobe Photoshop CS4"
