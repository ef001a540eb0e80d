"""One file a command; each holds a click command called `command` and imports what is heavy inside it."""
