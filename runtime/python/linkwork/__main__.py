"""`python -m linkwork`: runs Linkwork's command, which checks, shows, converts and exports mechanisms."""

import sys

from . import Error, ToolchainError, command
from ._package import export

try:
    if sys.argv[1:3] == ["export", "python"]:
        export(sys.argv[3:])
    else:
        sys.exit(command(sys.argv[1:]))
except (ToolchainError, OSError) as error:
    print(f"linkwork: {error}", file=sys.stderr)
    sys.exit(2)
except Error as error:
    print(error.complaints or error, file=sys.stderr)
    sys.exit(error.status)
