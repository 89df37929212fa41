"""What is read back of an estimate's files."""

import json

import pytest

from crfnet.configs.studio.looks import read_looks
from crfnet.errors import ConfigError


@pytest.mark.parametrize("name", ["", "../plate.spi1d", "a/b.spi1d", 5, None])
def test_a_document_that_names_no_file_beside_it_is_none(tmp_path, root, name):
    document = json.loads((root / "docs" / "sample" / "plate.json").read_text())
    document["files"]["spi1d"] = name
    (tmp_path / "plate.json").write_text(json.dumps(document))
    with pytest.raises(ConfigError, match="is no document of crfnet estimate"):
        read_looks(tmp_path / "plate.json")
