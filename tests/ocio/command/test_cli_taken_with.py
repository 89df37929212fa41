"""`crfnet estimate --taken-with`."""

import json


def test_the_device_may_be_told(crfnet, plate, fixed_model, tmp_path):
    arguments = ("estimate", plate, "--out", tmp_path / "look", "--model", fixed_model, "--taken-with", "phone")
    assert "\nPrior: camera; you and the file say: taken with a phone, " in crfnet(*arguments).out
    assert "; you and the file say: taken with a camera, " in crfnet(*arguments[:-1], "other", "--overwrite").out
    crfnet(*arguments, "--overwrite")
    (metadata,) = json.loads((tmp_path / "look" / "plate.json").read_text(encoding="utf-8"))["metadata"]
    assert (metadata["device"], metadata["is_told"]) == ("phone", True)
