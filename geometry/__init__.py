"""The nouns: articles, their shapes and materials, and the inertia that follows from them by three routes."""
