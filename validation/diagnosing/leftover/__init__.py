"""What a fitted hypothesis does not explain: how much there is of it, where it is, and what it looks like."""
