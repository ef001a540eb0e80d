"""The workbench in the browser: the door to trame."""
