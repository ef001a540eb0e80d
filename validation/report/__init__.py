"""One self-contained page of all that is known of a model and its data, to be read, printed and signed."""
