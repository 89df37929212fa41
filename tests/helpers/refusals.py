"""Refusals: errors by their kind, code and facts, whatever their sentences are."""

import contextlib
from collections.abc import Iterator

import pytest

from crfnet_core.errors import CRFNetError


@contextlib.contextmanager
def refused(kind: type[CRFNetError], code: str, **facts: object) -> Iterator[None]:
    """Check that the block raises an error of this kind and code, with these facts among its own, said on one line."""
    with pytest.raises(kind) as caught:
        yield
    found = {name: caught.value.facts.get(name) for name in facts}
    assert (caught.value.code, found) == (code, facts)
    assert str(caught.value).isprintable()


def refusal_of(kind, call, *arguments, **options):
    """Return the error of this kind that a call raises, which is said on one line."""
    with pytest.raises(kind) as caught:
        call(*arguments, **options)
    assert str(caught.value).isprintable()
    assert str(caught.value) != caught.value.code
    return caught.value
