"""The workbench in the browser: the door to trame. It shows what the desk says and computes nothing."""
