"""`python -m eccentric` is the command `eccentric`."""

import sys

from eccentric.cli import main

if __name__ == "__main__":
    sys.exit(main())
