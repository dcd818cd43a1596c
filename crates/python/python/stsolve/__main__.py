"""`python -m stsolve`: the command."""

from . import main

main()
