"""`crfnet estimate` into the folder of an earlier run."""

import json

import pytest

from tests.helpers.configs import loaded


def test_color_spaces_that_a_replaced_config_no_longer_has_are_named(estimate, crfnet, plate, tmp_path):
    other, out = tmp_path / "other.jpg", tmp_path / "out"
    other.write_bytes(plate.read_bytes())
    assert "was replaced" not in estimate(plate, "--no-linear").out
    assert "was replaced" not in estimate(plate, "--no-linear", "--overwrite").out
    words = 'Warning: config.ocio was replaced and no longer has "CRF plate"; '
    assert words in estimate(other, "--no-linear", "--overwrite").out
    both = tmp_path / "both"
    assert crfnet("config", "add", "--base", out / "config.ocio", "--out", both, out / "plate.json").code == 0
    config = loaded(both / "config.ocio")
    assert {"CRF plate", "CRF other"} < set(config.getColorSpaceNames())
    printed = estimate(plate, "--no-linear", "--overwrite", "--json").out
    assert json.loads(printed)["dropped"] == ["CRF other"]


@pytest.mark.parametrize("content", [b"no config", b"ocio_profile_version: \xe4\xff"])
def test_a_config_that_nobody_can_read_is_replaced(estimate, plate, out, content):
    (out / "config.ocio").write_bytes(content)
    done = estimate(plate, "--no-linear", "--overwrite")
    assert (done.code, done.err) == (0, "")
    assert "CRF plate" in loaded(out / "config.ocio").getColorSpaceNames()


def test_a_config_with_names_that_are_not_utf_8_is_replaced(estimate, plate, tmp_path):
    estimate(plate, "--no-linear")
    config = tmp_path / "out" / "config.ocio"
    config.write_bytes(config.read_bytes().replace(b"CRF plate", b"CRF pl\xe4te"))
    assert estimate(plate, "--no-linear", "--overwrite").code == 0
    assert "CRF plate" in loaded(config).getColorSpaceNames()
