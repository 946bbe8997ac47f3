"""From wishes to the dimensions of an arm that has them."""
