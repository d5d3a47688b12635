"""`python -m linkwork`: Linkwork's command, for checking, showing, converting and exporting mechanisms."""

import sys

from . import ToolchainError, command

try:
    sys.exit(command(sys.argv[1:]))
except ToolchainError as error:
    sys.exit(f"linkwork: {error}")
