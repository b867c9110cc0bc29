"""The programs that make and check what is stored."""

import signal
import sys

if sys.argv[0] == "-m":  # a command is about to be loaded, which takes seconds: see tools.command
    signal.signal(signal.SIGINT, signal.SIG_DFL)
