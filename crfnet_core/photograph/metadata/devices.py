"""Recognize phones, compacts and cameras with interchangeable lenses by the maker and the model in EXIF.

Makers of one kind are known by name; of the others the first pattern that fits the model decides. Drones, action
cameras, camcorders and cinema cameras stay unknown: they have no family of responses.
"""

import re
from enum import StrEnum


class Device(StrEnum):
    """A kind of device that takes photographs."""

    PHONE = "phone"
    COMPACT = "compact"
    CAMERA = "camera"
    SCANNER = "scanner"
    THERMAL = "thermal camera"
    UNKNOWN = ""


_PHONE, _COMPACT, _CAMERA, _SCANNER, _THERMAL, _UNKNOWN = Device

#: Kind -> beginnings of the makes, in lower case, of makers of this kind alone, as far as photographs of them are seen.
#: Phones include tablets, cameras digital backs; behind a scanner, the photograph is on film or paper.
MAKERS = {
    Device.UNKNOWN: ("leica microsystems", "motorola solutions"),
    Device.PHONE: (
        *("iphone", "ipad", "huawei", "honor", "xiaomi", "redmi", "poco", "oneplus"),
        *("motorola", "htc", "nokia", "hmd", "microsoft", "blackberry", "rim", "research in motion"),
        *("zte", "nubia", "lenovo", "asus", "acer", "tcl", "alcatel", "meizu", "sony ericsson", "sonyericsson", "palm"),
        *("essential", "fairphone", "wiko", "tecno", "infinix", "itel", "nothing", "razer", "bq", "ulefone", "doogee"),
        *("oppo", "realme", "vivo", "iqoo", "asustek", "tct", "cat", "caterpillar", "oukitel", "cubot", "hisense"),
        *("umidigi", "blackview", "sharp", "fujitsu", "gionee", "coolpad", "letv", "leeco", "micromax", "amazon"),
    ),
    Device.SCANNER: (
        *("noritsu", "plustek", "pacific image", "reflecta", "imacon", "microtek", "umax", "mustek", "pakon"),
        *("brother", "pfu", "xerox", "lexmark", "avision", "visioneer", "heidelberg", "creo", "czur", "pie"),
    ),
    Device.THERMAL: (
        *("flir", "teledyne flir", "fluke", "seek", "testo", "hikmicro", "infratec", "infiray", "guide", "wuhan guide"),
        *("optris", "workswell", "topdon"),
    ),
    Device.COMPACT: (
        *("vivitar", "benq", "polaroid", "concord", "jenoptik", "medion", "rollei", "agfa", "agfaphoto"),
        *("general imaging", "ge", "gedsc", "toshiba", "sanyo", "traveler", "aiptek", "praktica"),
    ),
    Device.CAMERA: ("phase one", "leaf", "mamiya", "pixii", "zenit"),
}

#: Parts of the models of scanners, and of printers that scan, of all makers.
_SCANNER_MODEL = (
    r"scan(?!pal)|(office|desk|laser|page)jet|\b(mfc|dcp|fi|kv|scx)-|\bmx-\d{3}|series$|aficio|bizhub|e-studio|taskalfa"
    r"|\bd-lab"
)

#: Beginning of the make, in lower case -> (pattern at the beginning of the model without the make, kind), first first.
PATTERNS: dict[str, tuple[tuple[str, Device], ...]] = {
    "apple": ((r"quicktake", _COMPACT), (r"vision", _UNKNOWN), (r"", _PHONE)),
    "google": ((r"street view|glass", _UNKNOWN), (r"", _PHONE)),
    "lg": ((r"r105", _UNKNOWN), (r"", _PHONE)),
    "casio": ((r"ca\d", _PHONE), (r"", _COMPACT)),
    "canon": (
        (r"eos c\d", _UNKNOWN),
        (r"eos", _CAMERA),
        (r"powershot|ixus|digital ixus|ixy|digital ixy|pro\d|ivy", _COMPACT),
        (r"m[gpx]\d|ts\d|lide|ir-adv|dr-|image(class|runner)", _SCANNER),
    ),
    "nikon": ((r"ls-\d", _SCANNER), (r"d\d|df\b|z|1 [a-z]", _CAMERA), (r"coolpix|e\d", _COMPACT)),
    "sony": (
        (r"ilce|ilca|ilme|ilx|slt|dslr|nex|zv-e", _CAMERA),
        (r"dsc|cyber-?shot|mvc|zv-", _COMPACT),
        (r"xq-|so-?\d|so[vg]\d|sgp|pm-\d|[a-z]{2}\d\d[aip]|pro-i|[a-j]\d{4}\b|a?\d{3}so|xperia", _PHONE),
    ),
    "samsung": (
        (r"nx|gx-?\d|ek-gn|galaxy nx", _CAMERA),
        (r"[sv]mx|hmx|sm-(c200|r210)", _UNKNOWN),
        (r"(sm|gt|sgh|sch|sph|shv|shw|sc|scv|yp)-?\w|\d{3}sc\b|galaxy(?! (nx|camera))|nexus", _PHONE),
        (r"ek-|ex\d|wb|st\d|es\d|pl\d|nv|dv|mv|l\d|tl\d|sl\d|hz|p\d|s\d|i\d|it\d|galaxy camera", _COMPACT),
        (r"digimax|kenox|u-ca|vluu|<|techwin", _COMPACT),
    ),
    "panasonic": ((r"dmc-(g|l10?$)|dc-([gs]|bgh|bs1)", _CAMERA), (r"dmc-cm|p-\d", _PHONE), (r"dm?c-|lumix", _COMPACT)),
    "fuji": (
        (r"sp-?\d|slp|frontier", _SCANNER),
        (r"x-s1$|x-hf|(finepix )?x\d|xf|xq|x half|gfx100rf", _COMPACT),
        (r"x-|gfx|finepix ?s[1235] ?pro|is[- ]?pro|dbp", _CAMERA),
        (r"", _COMPACT),
    ),
    "olympus": ((r"dp\d", _UNKNOWN), (r"e-?[12]0\b|e-100rs", _COMPACT), (r"e-|om-|pen|air", _CAMERA), (r"", _COMPACT)),
    "om digital": ((r"om-|e-|pen", _CAMERA), (r"", _COMPACT)),
    "pentax": ((r"optio|x\d|x-\d|wg|mx-1|i-10|efina|vs\d|rs\d|rz\d|ei", _COMPACT), (r"k|\*|645|q", _CAMERA)),
    "ricoh": ((r"pentax (k|\*|645|q)|k-|gxr", _CAMERA), (r"(ricoh )?theta", _UNKNOWN), (r"", _COMPACT)),
    "leica": (
        (r"leitz phone", _PHONE),
        (r"[dvc]-lux|c \(|digilux( [12])?$|digilux 4|x|q|sofort", _COMPACT),
        (r"", _CAMERA),
    ),
    "sigma": ((r"dp", _COMPACT), (r"sd|fp|bf", _CAMERA)),
    "minolta": ((r"dimage|revio|kd", _COMPACT), (r"", _CAMERA)),
    "kodak": (
        (r"rfs|pakon|f-135|i\d{4}|hr ?\d", _SCANNER),
        (r"ektra", _PHONE),
        (r"pixpro (sp|orbit)", _UNKNOWN),
        (r"dcs|pixpro s-1|s-1", _CAMERA),
        (r"", _COMPACT),
    ),
    "hasselblad": ((r"flextight", _SCANNER), (r"l\dd", _UNKNOWN), (r"stellar", _COMPACT), (r"", _CAMERA)),
    "contax": ((r"n digital", _CAMERA), (r"", _COMPACT)),
    "hp": ((r"slate|touchpad", _PHONE), (r"", _COMPACT)),
    "kyocera": ((r"finecam|fc-", _COMPACT), (r"", _PHONE)),
    "epson": ((r"r-d1", _CAMERA), (r"photopc|l-\d", _COMPACT), (r"moverio|bt-\d", _UNKNOWN), (r"", _SCANNER)),
}

#: Makes that begin in another way than the patterns' names.
_OTHER_NAMES = {"hewlett": "hp", "eastman kodak": "kodak", "jk imaging": "kodak", "asahi": "pentax"}
_OTHER_NAMES |= {"seiko epson": "epson", "leitz": "leica", "konica": "minolta"}

#: The makers of drones with thermal cameras, and the sizes of such pictures: other cameras of drones have other sizes.
_DRONES, _THERMAL_SIZES = ("dji", "autel"), ((640, 512), (1280, 1024))


def device_of(make: str, model: str, size: tuple[int, int] = (0, 0)) -> Device:
    """Return the kind of device by EXIF Make and Model, which may begin with the make; else UNKNOWN.

    `size` is the width and the height of the picture.
    """
    maker = (make or model).casefold().strip()
    if maker.startswith(_DRONES) and size in _THERMAL_SIZES:
        return _THERMAL
    for begin, name in _OTHER_NAMES.items():
        maker = name if maker.startswith(begin) else maker
    if re.search(_SCANNER_MODEL, model.casefold().strip()):
        return _SCANNER
    for device, makers in MAKERS.items():
        if any(re.match(rf"{re.escape(name)}\b", maker) for name in makers):
            return device
    name = next((name for name in PATTERNS if maker.startswith(name)), "")
    front = rf"^(?:{name}[^\W_]*|fujifilm|ricoh)(?![^\W_])[ _-]*"  # the maker
    plain = re.sub(front, "", model.casefold().strip())
    return next((device for pattern, device in PATTERNS.get(name, ()) if re.match(pattern, plain)), _UNKNOWN)


def camera_name(make: str, model: str) -> str:
    """Return make and model in one name: "Canon EOS 20D", "FUJIFILM X-E1"; empty where both are."""
    if make.split() and model.casefold().startswith(make.split()[0].casefold()):
        return " ".join(model.split())
    legal_form = r",? *(corporation|corp\.?|co\.?,? *ltd\.?|company,? *ltd\.?|imaging corp\.?|inc\.?|ag)\.?$"
    return " ".join(f"{re.sub(legal_form, '', make.strip(), flags=re.IGNORECASE)} {model}".split())
