"""The tests; a package, so that they can import `tests.helpers`.

The folders beside `helpers` have no `__init__.py`: pytest would import the tests of `tests/ocio` as `ocio`, which is
the name of the package that they test.
"""
