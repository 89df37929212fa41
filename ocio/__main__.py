"""`python -m crfnet`: the same as the command `crfnet`."""

import sys

from .cli.main import main

sys.exit(main())
