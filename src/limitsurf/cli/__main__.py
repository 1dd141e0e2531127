"""``python -m limitsurf.cli``: the command."""

import sys

from limitsurf.cli.main import main

sys.exit(main())
