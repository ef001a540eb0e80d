"""The command line: one function a command, heavy imports inside it."""
