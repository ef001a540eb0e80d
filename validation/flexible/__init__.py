"""The prediction side of the command line: flexible models of articles, their modes and dynamic masses, in words and figures.

`model` turns a name and a model into `fem`'s nouns; everything else shows or compares them."""
