"""What `massline excite` does: an article on a table driven in time, and what came of it."""
