import json
import re
import shutil

import numpy as np
import OpenImageIO as oiio
import pytest

from crfnet.configs.files import load_config
from crfnet_core.library import CameraLibrary
from crfnet_core.photograph.image_io import read_photo
from tests.helpers.cameras import photograph
from tests.helpers.folders import listed
from tests.helpers.images import write_image
from tests.helpers.movies import write_movie
from tests.helpers.pairs import PairOptions, make_pair
from tests.helpers.stacks import StackOptions, light_of, make_stack


def header(path):
    source = oiio.ImageInput.open(str(path))
    try:
        return source.spec()
    finally:
        source.close()


@pytest.fixture
def folder(root, plate, true_response, tmp_path):
    for name in ("day1/a", "day1/b", "photographs/plate01", "photographs/plate02"):
        (tmp_path / name).parent.mkdir(exist_ok=True)
        shutil.copy(plate, tmp_path / f"{name}.jpg")
    photograph(plate, tmp_path / "plate01.jpg")
    codes = (read_photo(plate).pixels * 255).round().astype(np.uint8)
    for name in ("scan", "shot.0001", "shot.0002", "shot.0003"):
        write_image(tmp_path / f"{name}.png", codes)
    height, width = (side // 2 * 2 for side in codes.shape[:2])
    images = [np.ascontiguousarray(codes[:height, :width])] * 6
    write_movie(tmp_path / "clip.mp4", size=(width, height), images=images, tags={"color_range": 1, "colorspace": 1})
    (tmp_path / "stack").mkdir()
    light = light_of(root / "tests" / "data" / "lights" / "interior.exr")[::2, ::2]
    camera = {"Make": "SONY", "Model": "ILCE-7M3", "Exif__PhotographicSensitivity": 100}
    make_stack(tmp_path / "stack", light, true_response, StackOptions(frames=6, quality=95), **camera)
    make_pair(tmp_path, light_of(root / "tests" / "data" / "lights" / "interior.exr"), true_response, PairOptions())
    return tmp_path


def test_the_jobs_run(root, folder, run_page):
    page = root / "docs" / "USAGE.md"
    printed = run_page(page)
    assert json.loads(next(text for text in printed if text.startswith("{")))["estimates"][0]["verdict"]
    assert listed(folder / "estimated") == [f"shot.{number:04d}.exr" for number in (1, 2, 3)]
    frames = sorted((folder / "linear").glob("clip.*.exr"))
    assert len(frames) == 6
    assert header(frames[0]).getattribute("FramesPerSecond") is not None
    assert header(folder / "aces" / "plate01_linear.exr").get_string_attribute("colorInteropID") == "lin_ap1_scene"
    config = load_config(folder / "show2" / "config.ocio")
    assert config.getColorSpaceFromFilepath("/anywhere/plate01.jpg")[0] == "CRF plate01"
    same = read_photo(folder / "comp.png").pixels - read_photo(folder / "plate01.jpg").pixels
    assert not same.any()
    names: dict[str, object] = {}
    (snippet,) = re.findall(r"^```python\n(.*?)^```", page.read_text(encoding="utf-8"), re.MULTILINE | re.DOTALL)
    exec(snippet, names)
    assert (len(names["records"]), names["failed"], names["linear"].shape) == (2, [], (256,))


def test_the_commands_of_cameras_run(root, folder, run_page):
    page = root / "docs" / "CAMERAS.md"
    run_page(page)
    assert (folder / "linear" / "plate01.exr").is_file()
    assert (folder / "a7.spi1d").is_file()
    cameras = CameraLibrary.shipped().cameras()
    models = {camera.settings.camera for camera in cameras}
    assert f"{len(models)} measured cameras ({len(cameras)} settings)" in page.read_text(encoding="utf-8")
