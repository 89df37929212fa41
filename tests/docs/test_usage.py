"""docs/USAGE.md: the first commands run in the order in which they stand."""

import json
import re
import shlex
import shutil

from tests.helpers.folders import listed
from tests.helpers.images import read_image, write_image


def test_the_first_commands_run_one_after_the_other(root, crfnet, plate, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "day1").mkdir()
    for name in ("plate01", "cam_a", "cam_b", "day1/a", "day1/b"):
        shutil.copy(plate, tmp_path / f"{name}.jpg")
    for number in range(1, 4):
        write_image(tmp_path / f"shot.{number:04d}.png", read_image(plate))
    page = (root / "docs" / "USAGE.md").read_text(encoding="utf-8").partition("\n## Many photographs\n")[0]
    printed = []
    for line in "".join(re.findall(r"^```\n(.*?)^```", page, re.MULTILINE | re.DOTALL)).splitlines():
        program, *arguments = shlex.split(re.split(r" [|>] ", line)[0], comments=True)
        assert program == "crfnet"
        expanded = (sorted(tmp_path.glob(word)) if "*" in word else [word] for word in arguments)
        done = crfnet(*(path for paths in expanded for path in paths))
        assert (done.code, done.err) == (0, ""), line
        printed.append(done.out)
    assert json.loads(printed[-2])["estimates"][0]["verdict"]
    assert listed(tmp_path / "linear") == listed(tmp_path / "own") == [f"shot.{n:04d}.exr" for n in (1, 2, 3)]
