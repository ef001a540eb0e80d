"""Spatial beam frames: elements and their sections, the frame they are put together to, and the built-in articles as frames."""
