from dataclasses import asdict

import pytest

from crfnet_core.photograph.metadata import Device, FileMetadata, FileOrigin, file_origin, with_stated_device
from crfnet_core.photograph.metadata.color_tags import profile_transfer
from crfnet_core.photograph.metadata.jpeg import ANNEX_K_LUMA, scaled_table
from crfnet_core.photograph.metadata.origin import picture_shape
from crfnet_core.posterior import Family
from crfnet_core.types import plain_values, typed_value

OWN_TABLE = (3,) * 64
OWN_CAMERA = {"make": "Canon", "model": "Canon EOS 20D", "luma_table": OWN_TABLE, "file_format": "JPEG"}
IJG = {"luma_table": scaled_table(ANNEX_K_LUMA, 92)}
IJG_FINE = {"luma_table": scaled_table(ANNEX_K_LUMA, 99)}


def origin(**fields):
    """The origin of a file with these metadata and a picture of 3504 x 2336 pixels."""
    return file_origin(FileMetadata(**{"width": 3504, "height": 2336, "file_format": "JPEG"} | fields))


@pytest.mark.parametrize(
    ("width", "height", "shape"),
    [
        *((3504, 2336, "3:2"), (4000, 3000, "4:3"), (4000, 2252, "16:9"), (4032, 1960, "2:1")),
        *((2538, 1080, "other"), (0, 0, "other")),
    ],
)
def test_shape_of_the_picture(width, height, shape):
    assert picture_shape(width, height) == shape


@pytest.mark.parametrize(
    ("width", "height", "fields", "is_scaled"),
    [
        (3504, 2336, OWN_CAMERA | {"exif_size": (3504, 2336)}, False),
        (2336, 3504, OWN_CAMERA | {"exif_size": (3504, 2336)}, False),  # turned
        (1024, 768, OWN_CAMERA | {"exif_size": (1024, 768)}, False),  # the camera's before small size
        (1280, 853, OWN_CAMERA | {"exif_size": (3504, 2336)}, True),
        (324, 324, OWN_CAMERA | {"exif_size": (2160, 2160)}, True),
        (7008, 4400, OWN_CAMERA | IJG | {"exif_size": (3504, 2336)}, True),  # made larger, and cut
        (7008, 4400, OWN_CAMERA | {"exif_size": (3504, 2336)}, None),  # cameras do not enlarge
        (2000, 2000, OWN_CAMERA | {"exif_size": (3504, 2336)}, None),  # cut
        (3504, 2336, OWN_CAMERA | {"exif_size": (3520, 2346)}, None),  # cut by a few pixels
        (3504, 2336, OWN_CAMERA | {"exif_size": (160, 120)}, False),  # of the thumbnail
        (1024, 768, OWN_CAMERA | {"exif_size": (1024, 768), "software": "GIMP 2.8"}, True),
        (6000, 4000, OWN_CAMERA | {"exif_size": (6000, 4000), "software": "GIMP 2.8"}, False),
        *((5168, 3448, {}, False), (4240, 2830, {}, None), (2048, 1536, {}, True)),
        (2048, 1536, {"make": "Sony", "model": "D6503"}, None),
        *((1280, 720, {}, True), (1280, 720, {"file_format": "DPX"}, None), (0, 0, {}, None)),
        # a program that scales may rewrite the size in EXIF
        (493, 328, OWN_CAMERA | {"exif_size": (493, 328)}, True),
        (640, 480, OWN_CAMERA | IJG | {"exif_size": (640, 480), "has_jfif": True}, True),
        (2048, 1365, OWN_CAMERA | {"exif_size": (2048, 1365)}, None),
        (4000, 3001, OWN_CAMERA | {"exif_size": (4000, 3001)}, False),
    ],
)
def test_scaled_or_not(width, height, fields, is_scaled):
    assert origin(width=width, height=height, **fields).is_scaled is is_scaled


@pytest.mark.parametrize(
    ("fields", "is_resaved"),
    [
        *((OWN_CAMERA, False), (OWN_CAMERA | IJG_FINE, False)),
        (OWN_CAMERA | IJG, None),  # some cameras use the tables of the library
        (OWN_CAMERA | {"has_jfif": True}, None),  # or a program turned it without loss
        (OWN_CAMERA | IJG | {"has_jfif": True}, True),
        (IJG | {"make": "Apple", "model": "iPhone 6", "has_jfif": True}, None),
        *((OWN_CAMERA | {"has_adobe": True}, True), (OWN_CAMERA | {"software": "darktable 3.4"}, True)),
        *((OWN_CAMERA | {"exif_size": (7008, 4672)}, True), (IJG, True), (IJG_FINE, None)),
        (OWN_CAMERA | {"exif_size": (570, 375)}, False),  # of a preview
        (OWN_CAMERA | {"raw_file": "DSC_0001.JPG"}, False),  # named where Lightroom saves its ratings
        (OWN_CAMERA | {"raw_file": "DSC_0001.NEF", "history": ("Adobe DNG Converter",)}, False),
        *(({"luma_table": OWN_TABLE}, None), ({}, None), ({"file_format": "PNG"}, None)),
    ],
)
def test_saved_again_or_not(fields, is_resaved):
    assert origin(**fields).is_resaved is is_resaved


@pytest.mark.parametrize(
    ("fields", "is_developed"),
    [
        ({"software": "Adobe Photoshop Lightroom Classic 9.2 (Macintosh)"}, True),
        ({"software": "darktable 3.4"}, True),
        ({"software": "Ver.1.00", "history": ("Capture One 20 Macintosh",)}, True),
        ({"software": "Adobe Photoshop CC 2015 (Macintosh)"}, False),
        ({"software": "Adobe Photoshop CC 2015 (Macintosh)", "raw_file": "_DSC9957.NEF"}, True),
        ({"software": "Adobe Photoshop Lightroom 5.7 (Windows)", "raw_file": "IMG_0001.JPG"}, False),
        ({"software": "Digital Photo Professional"}, False),  # imitates the camera
        ({"software": "Adobe DNG Converter 15.0 (Macintosh)", "raw_file": "DSC_0001.NEF"}, False),  # keeps its picture
        ({"software": "Ver.1.00"}, False),
        ({"software": "Ver.1.00", "history": ("Adobe DNG Converter 9.8",), "raw_file": "_DSC9957.NEF"}, False),
        ({"software": "Adobe DNG Converter 9.8", "history": ("darktable 3.4",), "raw_file": "_DSC9957.NEF"}, True),
        ({"software": "Adobe Photoshop CC", "history": ("Adobe DNG Converter 9",), "raw_file": "_DSC9957.DNG"}, True),
    ],
)
def test_developed_from_a_raw_file_or_not(fields, is_developed):
    assert origin(**OWN_CAMERA, **fields).is_developed is is_developed


@pytest.mark.parametrize(
    ("profile", "transfer"),
    [
        *(("S-Log_S-Gamut", "Sony S-Log"), ("C-Log_x", "Canon Log"), ("FLog_x", "Fujifilm F-Log")),
        *(("D-Log_x", "DJI D-Log"), ("Rec2100 PQ_x", "PQ"), ("Rec2100 HLG_x", "HLG")),
        *(("RGB_D65_202_Rel_HLG", "HLG"), ("RGB_D65_202_Per_PeQ", "PQ")),  # by libjxl
        *(("ARRI LogC3", "ARRI LogC3"), ("LogC_EI800", "ARRI LogC3"), ("S-Log3 S-Gamut3.Cine", "Sony S-Log3")),
        *(("BMDFilm", "Blackmagic Film Gen 5"), ("REDWideGamutRGB Log3G10", "RED Log3G10"), ("Apple Log", "Apple Log")),
        ("Rec.2100 Hybrid Log curve", "HLG"),
        *(("C-Log1", ""), ("LogC2", ""), ("slogan", "")),  # versions whose curve is not known, and a word
    ],
)
def test_names_of_encodings_in_profiles(profile, transfer):
    assert profile_transfer(profile) == transfer


@pytest.mark.parametrize(
    ("fields", "words"),
    [
        ({}, ()),
        (
            {"software": "GIMP 2.8", "exif_size": (7008, 4672)},
            ("saved by GIMP 2.8", "scaled or cropped from 7008 x 4672 to 3504 x 2336 pixels after the camera wrote it"),
        ),
        ({"exif_size": (1752, 1168)}, ("scaled from 1752 x 1168 to 3504 x 2336 pixels after the camera wrote it",)),
        ({"raw_file": "1.CR2"}, ("developed from a raw file by a program of Adobe",)),
        ({"software": "darktable 4.6"}, ("saved by darktable 4.6, a raw developer",)),
        ({"software": "darktable 4.6", "derived_from": "1.CR2"}, ("developed from a raw file by darktable 4.6",)),
        ({"software": "darktable 4.6", "derived_from": "1.JPG"}, ("saved by darktable 4.6",)),
        ({"software": "GIMP 2.8", "derived_from": "xmp.did:1"}, ("saved by GIMP 2.8",)),
        (IJG, ("encoded again by a program, as JPEG of quality 92",)),
        ({"width": 640, "height": 480}, ("probably scaled after the camera wrote it (640 x 480 pixels)",)),
        ({"file_format": "DPX"}, ("DPX files hold film or video",)),
        ({"file_format": "movie"}, ("a frame of a movie",)),
    ],
)
def test_words(fields, words):
    assert origin(**fields).words == ("the file names no camera", *words)


def test_words_of_a_camera():
    assert origin(make="DJI", model="FC220").words == ("taken by DJI FC220",)
    scan = origin(make="KODAK", model="F-135 Plus", width=1500, height=1000)
    assert scan.words == ("taken by KODAK F-135 Plus, a scanner of film or paper",)
    assert origin(make="FLIR", model="T640", width=640, height=480).words == ("taken by FLIR T640, a thermal camera",)
    assert origin(**OWN_CAMERA).words[0] == "taken by Canon EOS 20D, a camera with interchangeable lenses"
    assert origin(**OWN_CAMERA, exif_size=(3520, 2346)).words[1] == "nothing shows that a program wrote the file"
    cut = "cropped from 4000 x 3001 to 3504 x 2336 pixels"
    assert origin(**OWN_CAMERA, exif_size=(4000, 3001)).words[1] == cut


def test_a_stated_device_takes_the_place_of_the_files():
    before = origin(**OWN_CAMERA, software="GIMP 2.8")
    stated = with_stated_device(before, Device.PHONE)
    assert (stated.device, stated.has_stated_device) == (Device.PHONE, True)
    assert (stated.camera, stated.editor) == (before.camera, before.editor)
    assert stated.words == ("taken with a phone", *before.words[1:])
    assert typed_value(plain_values(asdict(stated)), FileOrigin) == stated
    assert with_stated_device(before, Device.UNKNOWN).words == ("taken with a camera", *before.words[1:])


def test_a_rendering_stays_one_whatever_is_stated():
    rendering = origin(renderer="Blender")
    assert with_stated_device(rendering, Device.CAMERA) == rendering


def test_a_copy_of_what_is_known_is_not_refused():
    sent = origin(width=1280, height=960, luma_table=scaled_table(ANNEX_K_LUMA, 75))
    assert sent.is_sent_copy
    assert not with_stated_device(sent, Device.PHONE).is_sent_copy


@pytest.mark.parametrize("use_metadata", [True, False])
def test_a_stated_device_counts_in_the_estimate(estimate, plate, use_metadata):
    stated, other = estimate(plate, device=Device.PHONE, use_metadata=use_metadata), estimate(plate)
    assert (stated.origins[0].device, stated.origins[0].has_stated_device) == (Device.PHONE, True)
    assert (stated.origins[0].picture_shape == "16:9") is use_metadata
    assert stated.families[Family.PHONE] > 1.2 * other.families[Family.PHONE]
    assert stated.families[Family.CAMERA] < 0.2 * other.families[Family.CAMERA]
